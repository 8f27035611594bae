//! The freedom that no picture removes.

use nalgebra::{Isometry3, Vector6};

// ANCHOR: scale_direction
/// The twist by which a camera moves while the world around the origin grows at a rate of
/// one: away from the origin, without turning. The points move by their own coordinates.
///
/// No pixel changes, whatever the camera: this direction and those of all points together
/// are a null vector of every reprojection Jacobian. Implements {eq:scale-null-vector}.
pub fn scale_direction(camera_from_world: &Isometry3<f64>) -> Vector6<f64> {
    let minus_centre =
        camera_from_world.rotation.inverse_transform_vector(&camera_from_world.translation.vector);
    Vector6::new(minus_centre.x, minus_centre.y, minus_centre.z, 0.0, 0.0, 0.0)
}
// ANCHOR_END: scale_direction
