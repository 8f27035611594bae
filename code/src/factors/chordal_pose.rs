//! The relative pose once more, with rotations compared by the chord.

use nalgebra::{Isometry3, Matrix3, SMatrix, SVector, Vector3};

use crate::least_squares::{Factor, Key};
use crate::manifold::so3;

// ANCHOR: chordal_pose
/// How the second of two poses stands to the first one, with errors of rotation measured by the
/// chord, R₂ − R₁ R̃, and not by the arc. Twelve numbers: √(κ/2) times the nine entries of that matrix,
/// and √τ times t₂ − t₁ − R₁ t̃. Both are linear in the entries of the poses, which is what a
/// certificate of global optimality needs ([@rosen2019]).
///
/// For errors that are small, half the square of the chord is that of the arc: the nine entries have
/// the norm 2√2 sin(θ/2) at an angle θ.
#[derive(Debug, Clone)]
pub struct ChordalPose {
    /// `world_from_body` of the first pose.
    pub first: Key<Isometry3<f64>>,
    /// `world_from_body` of the second one.
    pub second: Key<Isometry3<f64>>,
    /// What was measured: `first_from_second`.
    pub measured: Isometry3<f64>,
    /// √κ: one over the standard deviation about each axis, in radians.
    pub rotation_weight: f64,
    /// √τ: one over the standard deviation along each axis, in metres.
    pub translation_weight: f64,
}
// ANCHOR_END: chordal_pose

impl Factor<12> for ChordalPose {
    type Variables = (Isometry3<f64>, Isometry3<f64>);
    type Jacobians = (SMatrix<f64, 12, 6>, SMatrix<f64, 12, 6>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Isometry3<f64>>) {
        (self.first, self.second)
    }

    // ANCHOR: chordal_residual
    fn residual(
        &self,
        (first, second): (&Isometry3<f64>, &Isometry3<f64>),
    ) -> Option<SVector<f64, 12>> {
        let [predicted, found] = self.rotations(first, second);
        let chord = self.chord_weight() * (found - predicted);
        let shift = second.translation.vector
            - first.translation.vector
            - first.rotation * self.measured.translation.vector;
        let mut residual = SVector::<f64, 12>::zeros();
        residual.fixed_rows_mut::<9>(0).copy_from_slice(chord.as_slice());
        residual.fixed_rows_mut::<3>(9).copy_from(&(self.translation_weight * shift));
        Some(residual)
    }
    // ANCHOR_END: chordal_residual

    // ANCHOR: chordal_slopes
    fn linearize(
        &self,
        values: (&Isometry3<f64>, &Isometry3<f64>),
    ) -> Option<(SVector<f64, 12>, Self::Jacobians)> {
        let (first, second) = values;
        let [predicted, found] = self.rotations(first, second);
        let measured = self.measured.rotation.to_rotation_matrix();
        let (chord, along) = (self.chord_weight(), self.translation_weight);
        let (mut by_first, mut by_second) =
            (SMatrix::<f64, 12, 6>::zeros(), SMatrix::<f64, 12, 6>::zeros());
        for axis in 0..3 {
            let turn = so3::hat(&Vector3::ith(axis, 1.0));
            // R₁ a^ R̃ = R₁ R̃ (R̃ᵀ a)^
            let turned = so3::hat(&(measured.transpose() * Vector3::ith(axis, 1.0)));
            set_column(&mut by_first, 3 + axis, -chord * predicted * turned);
            set_column(&mut by_second, 3 + axis, chord * found * turn);
        }
        let [first, second] =
            [first, second].map(|pose| pose.rotation.to_rotation_matrix().into_inner());
        let lever = so3::hat(&self.measured.translation.vector);
        by_first.fixed_view_mut::<3, 3>(9, 0).copy_from(&(-along * first));
        by_first.fixed_view_mut::<3, 3>(9, 3).copy_from(&(along * first * lever));
        by_second.fixed_view_mut::<3, 3>(9, 0).copy_from(&(along * second));
        Some((self.residual(values)?, (by_first, by_second)))
    }
    // ANCHOR_END: chordal_slopes
}

impl ChordalPose {
    fn chord_weight(&self) -> f64 {
        self.rotation_weight * std::f64::consts::FRAC_1_SQRT_2
    }

    /// The rotation of the second pose, as predicted from the first and as it is.
    fn rotations(&self, first: &Isometry3<f64>, second: &Isometry3<f64>) -> [Matrix3<f64>; 2] {
        let predicted = first.rotation * self.measured.rotation;
        [predicted, second.rotation].map(|rotation| rotation.to_rotation_matrix().into_inner())
    }
}

fn set_column(jacobian: &mut SMatrix<f64, 12, 6>, column: usize, slope: Matrix3<f64>) {
    jacobian.fixed_view_mut::<9, 1>(0, column).copy_from_slice(slope.as_slice());
}
