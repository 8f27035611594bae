//! Scale is a null space: the one direction that pixels leave free when camera 0 is pinned.

use nalgebra::{DMatrix, DVector, Isometry3, Vector3};
use serde::{Deserialize, Serialize};

pub use crate::camera::Camera;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: scene
/// Cameras and points. Camera 0 is pinned, and does not stand at the origin of the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// camera_from_world of each camera.
    pub cameras: Vec<Isometry3<f64>>,
    /// Points in world coordinates, in metres.
    pub points: Vec<Vector3<f64>>,
}
// ANCHOR_END: scene

crate::signatures! {
    // ANCHOR: rescaled
    /// The scene with all distances `factor` times as long, and camera 0 exactly where it was.
    /// No pixel changes. The factor is positive.
    fn rescaled(scene: Scene, factor: f64) -> Scene;

    /// The velocity of all unknowns while the scale of the scene grows so, at a factor of one: the
    /// derivative by the factor. For K cameras and L points 6 K + 3 L numbers. First the cameras, each
    /// with the twist ξ = (ρ, φ) of T exp(ξ), where T is its camera_from_world; then the
    /// points, each with its three coordinates. The six numbers of camera 0 are zero.
    fn scale_direction(scene: Scene) -> DVector<f64>;
    // ANCHOR_END: rescaled

    // ANCHOR: gauge
    /// How far a direction is from being a null vector: the length of `hessian * direction` over
    /// the product of the lengths of the two. The length of a matrix is the root of the sum of
    /// its squared entries. Neither is zero.
    fn annihilation(hessian: DMatrix<f64>, direction: DVector<f64>) -> f64;

    /// A step of all unknowns, laid out as above, that moves every pixel as the step given does, to
    /// first order, and leaves the **distance** between the centres of cameras 0 and 1 as it is,
    /// to first order. The step given does not move camera 0, and neither does the one returned.
    /// Cameras 0 and 1 do not stand in one place.
    fn with_distance_held(scene: Scene, step: DVector<f64>) -> DVector<f64>;
    // ANCHOR_END: gauge
}
