//! Where a camera sees a landmark that is known by its anchor, the picture that showed it first.

use nalgebra::{Isometry3, SMatrix, SVector, Vector3};

use crate::inertial::BodyPose;
use crate::manifold::so3;

/// The body at the anchor, the body at the picture, `body_from_camera` of the first camera, and the
/// landmark (x, y, ρ).
pub(super) type Seen<'a> = (&'a BodyPose, &'a BodyPose, &'a Isometry3<f64>, &'a Vector3<f64>);

/// Derivatives by a step of each: (φ, p) of the two bodies, ξ of the extrinsics T_bc exp(ξ), (x, y, ρ).
pub(super) type BySeen<const R: usize> =
    (SMatrix<f64, R, 6>, SMatrix<f64, R, 6>, SMatrix<f64, R, 6>, SMatrix<f64, R, 3>);

// ANCHOR: scaled
/// What leads to the pixel, every vector of it times ρ: nothing is divided by it, and a landmark at
/// infinity is one like any other.
pub(super) struct Scaled {
    /// From the body at the anchor to the landmark, in the body's frame then.
    pub in_anchor: Vector3<f64>,
    /// From the body at the picture to the landmark, in the body's frame then.
    pub in_body: Vector3<f64>,
    /// The same in the first camera.
    pub in_camera: Vector3<f64>,
}

impl Scaled {
    pub fn of((anchor, body, extrinsics, landmark): Seen) -> Self {
        let (ray, inverse_depth) = (landmark.xy().push(1.0), landmark.z);
        let lever = inverse_depth * extrinsics.translation.vector;
        let in_anchor = extrinsics.rotation * ray + lever;
        let moved = inverse_depth * (anchor.position - body.position);
        let in_world = anchor.world_from_body * in_anchor + moved;
        let in_body = body.world_from_body.inverse_transform_vector(&in_world);
        let in_camera = extrinsics.rotation.inverse_transform_vector(&(in_body - lever));
        Self { in_anchor, in_body, in_camera }
    }
    // ANCHOR_END: scaled

    // ANCHOR: scaled_slopes
    /// The derivatives of something that depends on `in_camera` and on ρ, from those by these two.
    pub fn slopes<const R: usize>(
        &self,
        (anchor, body, extrinsics, landmark): Seen,
        by_camera: &SMatrix<f64, R, 3>,
        by_scale: &SVector<f64, R>,
    ) -> BySeen<R> {
        let rotation = extrinsics.rotation.to_rotation_matrix();
        let by_body = by_camera * rotation.matrix().transpose();
        let by_world = by_body * body.world_from_body.matrix().transpose();
        let by_anchor = by_world * anchor.world_from_body.matrix();
        let by_ray = by_anchor * rotation.matrix();
        let turned = landmark.z * by_world;
        let of_anchor = side_by_side(&(-by_anchor * so3::hat(&self.in_anchor)), &turned);
        let of_body = side_by_side(&(by_body * so3::hat(&self.in_body)), &-turned);
        let ray = landmark.xy().push(1.0);
        let by_turn = by_camera * so3::hat(&self.in_camera) - by_ray * so3::hat(&ray);
        let of_extrinsics = side_by_side(&(landmark.z * (by_ray - by_camera)), &by_turn);
        let moved = by_world * (anchor.position - body.position);
        let lever = (by_anchor - by_body) * extrinsics.translation.vector;
        let mut of_landmark = by_ray;
        of_landmark.set_column(2, &(moved + lever + by_scale));
        (of_anchor, of_body, of_extrinsics, of_landmark)
    }
    // ANCHOR_END: scaled_slopes
}

fn side_by_side<const R: usize>(
    left: &SMatrix<f64, R, 3>,
    right: &SMatrix<f64, R, 3>,
) -> SMatrix<f64, R, 6> {
    let mut both = SMatrix::<f64, R, 6>::zeros();
    both.fixed_columns_mut::<3>(0).copy_from(left);
    both.fixed_columns_mut::<3>(3).copy_from(right);
    both
}
