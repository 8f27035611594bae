//! The relative pose once more, with rotations compared by the chord.

use nalgebra::{Isometry3, Matrix3, Matrix6, Vector3, Vector6};

use crate::least_squares::{Factor, Key};
use crate::manifold::so3;

// ANCHOR: chordal_pose
/// How the second of two poses stands to the first one, with errors of rotation measured by the
/// chord, R₂ − R₁ R̃, and not by the arc. Twice the cost is κ/2 times the square of the nine entries of
/// that matrix and τ times that of t₂ − t₁ − R₁ t̃. Both are linear in the entries of the poses, which is
/// what a certificate of global optimality needs ([@rosen2019]). Errors that are small cost what they
/// cost by the arc. Implements {eq:chordal-cost}.
///
/// The residual is another vector of the same length: R₁ᵀ (t₂ − t₁) − t̃, and 2 sin(θ/2) a with the angle
/// θ and the axis a of what is left of the rotation, since the nine entries have the norm 2√2 sin(θ/2),
/// {eq:chord-length}.
/// The cost is the same, and Gauss-Newton is not: it leaves out how a residual bends, and these six
/// numbers bend less along the soft directions of a graph than those that are linear in the entries.
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

impl Factor<6> for ChordalPose {
    type Variables = (Isometry3<f64>, Isometry3<f64>);
    type Jacobians = (Matrix6<f64>, Matrix6<f64>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Isometry3<f64>>) {
        (self.first, self.second)
    }

    // ANCHOR: chordal_residual
    fn residual(
        &self,
        (first, second): (&Isometry3<f64>, &Isometry3<f64>),
    ) -> Option<Vector6<f64>> {
        let (_, chord) = self.half_turn(first, second);
        let apart = second.translation.vector - first.translation.vector;
        let shift = first.rotation.inverse() * apart - self.measured.translation.vector;
        let (along, about) = (self.translation_weight * shift, 2.0 * self.rotation_weight * chord);
        Some(Vector6::new(along.x, along.y, along.z, about.x, about.y, about.z))
    }
    // ANCHOR_END: chordal_residual

    // ANCHOR: chordal_slopes
    fn linearize(
        &self,
        values: (&Isometry3<f64>, &Isometry3<f64>),
    ) -> Option<(Vector6<f64>, Self::Jacobians)> {
        let (first, second) = values;
        let (cosine, sine) = self.half_turn(first, second);
        let [cosine, sine] = [Matrix3::from_diagonal_element(cosine), so3::hat(&sine)];
        let measured = self.measured.rotation.to_rotation_matrix();
        let [first, second] = [first, second].map(|pose| pose.rotation.to_rotation_matrix());
        let (along, about) = (self.translation_weight, self.rotation_weight);
        let apart = values.1.translation.vector - values.0.translation.vector;
        let seen = first.transpose() * apart;
        let (mut by_first, mut by_second) = (Matrix6::zeros(), Matrix6::zeros());
        by_first.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(-along);
        by_first.fixed_view_mut::<3, 3>(0, 3).copy_from(&(along * so3::hat(&seen)));
        let by_turn = (sine - cosine) * measured.matrix().transpose();
        by_first.fixed_view_mut::<3, 3>(3, 3).copy_from(&(about * by_turn));
        by_second
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&(along * (first.transpose() * second).matrix()));
        by_second.fixed_view_mut::<3, 3>(3, 3).copy_from(&(about * (cosine + sine)));
        Some((self.residual(values)?, (by_first, by_second)))
    }
    // ANCHOR_END: chordal_slopes
}

impl ChordalPose {
    /// The quaternion of what is left between the rotation of the second pose and the one predicted from
    /// the first: the cosine of half the angle, which is not negative, and the sine times the axis.
    fn half_turn(&self, first: &Isometry3<f64>, second: &Isometry3<f64>) -> (f64, Vector3<f64>) {
        let turn = (first.rotation * self.measured.rotation).inverse() * second.rotation;
        let side = 1.0_f64.copysign(turn.w);
        (side * turn.w, side * turn.imag())
    }
}
