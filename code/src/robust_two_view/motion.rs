//! The motion between two pictures, without its length.

use nalgebra::{Isometry3, Matrix3, Rotation3, SMatrix, SVector, Unit, Vector3};

use crate::inertial::Gravity;
use crate::least_squares::Manifold;
use crate::manifold::so3;

// ANCHOR: relative_motion
/// How a second camera stands to the first as far as two pictures say it: a rotation, and the
/// direction of the baseline.
///
/// The coordinates a of a point in the first camera and b in the second satisfy b = R a + s t with an
/// unknown length s. It is moved by five numbers: a rotation vector on the right of R, and two
/// angles that turn t on its sphere as [`Gravity`] turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeMotion {
    /// The rotation R, `second_from_first`.
    pub rotation: Rotation3<f64>,
    /// The direction t of the first camera's centre, in the second camera.
    pub direction: Unit<Vector3<f64>>,
}
// ANCHOR_END: relative_motion

impl RelativeMotion {
    /// That of a rigid motion, or `None` when its translation is zero.
    pub fn of(second_from_first: &Isometry3<f64>) -> Option<Self> {
        let direction = Unit::try_new(second_from_first.translation.vector, 0.0)?;
        Some(Self { rotation: second_from_first.rotation.to_rotation_matrix(), direction })
    }

    /// The rigid motion with a baseline of one.
    pub fn second_from_first(&self) -> Isometry3<f64> {
        Isometry3::from_parts(self.direction.into_inner().into(), self.rotation.into())
    }

    /// The essential matrix for a baseline of one.
    pub fn essential(&self) -> Matrix3<f64> {
        so3::hat(&self.direction) * self.rotation.matrix()
    }

    /// The 3×2 derivative of the direction by a step.
    pub(crate) fn direction_by_step(&self) -> SMatrix<f64, 3, 2> {
        self.sphere().by_step()
    }

    /// The direction as a variable that moves on a sphere.
    fn sphere(&self) -> Gravity {
        Gravity(self.direction.into_inner())
    }
}

/// The right-handed frame with one vector along its first axis and another in the plane of the first two.
pub(crate) fn frame(first: &Vector3<f64>, second: &Vector3<f64>) -> Matrix3<f64> {
    let x = first.normalize();
    let y = (second - x.dot(second) * x).normalize();
    Matrix3::from_columns(&[x, y, x.cross(&y)])
}

impl Manifold for RelativeMotion {
    fn dimension(&self) -> usize {
        5
    }

    fn retract(&self, step: &[f64]) -> Self {
        let (turn, tilt) = step.split_at(3);
        let direction = Unit::new_normalize(self.sphere().retract(tilt).0);
        Self { rotation: self.rotation.retract(turn), direction }
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        let (turn, tilt) = step.split_at_mut(3);
        self.rotation.local(&to.rotation, turn);
        self.sphere().local(&to.sphere(), tilt);
    }

    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        let (mut turn, mut tilt) = (Matrix3::zeros(), SMatrix::<f64, 2, 2>::zeros());
        self.rotation.local_jacobian(&to.rotation, turn.as_mut_slice());
        self.sphere().local_jacobian(&to.sphere(), tilt.as_mut_slice());
        let mut jacobian = SMatrix::<f64, 5, 5>::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
        jacobian.fixed_view_mut::<2, 2>(3, 3).copy_from(&tilt);
        into.copy_from_slice(jacobian.as_slice());
    }
}

/// The two directions in which cameras saw one point, of any length.
pub type RayPair = (Vector3<f64>, Vector3<f64>);

// ANCHOR: epipolar_row
/// The volume that two rays span with the baseline, and its derivative by the five numbers that move
/// the motion.
///
/// With c = R a it is b · (t × c) = (b × t) · c.
pub(super) fn volume_and_row(
    motion: &RelativeMotion,
    direction_by_step: &SMatrix<f64, 3, 2>,
    (first, second): &RayPair,
) -> (f64, SVector<f64, 5>) {
    let turned = motion.rotation * first;
    let normal = second.cross(&motion.direction);
    let by_turn = first.cross(&motion.rotation.inverse_transform_vector(&normal));
    let by_tilt = direction_by_step.tr_mul(&turned.cross(second));
    let row = SVector::from([by_turn.x, by_turn.y, by_turn.z, by_tilt.x, by_tilt.y]);
    (normal.dot(&turned), row)
}
// ANCHOR_END: epipolar_row
