//! Scale is a null space. Edition 1.
//!
//! `cargo test -p exercises scale_null_space`

use exercise_spec::scale_null_space::Scene;
use nalgebra::{DMatrix, DVector};

/// The scene with all distances `factor` times as long, and camera 0 exactly where it was.
/// No pixel changes. The factor is positive.
pub fn rescaled(scene: Scene, factor: f64) -> Scene {
    let _ = (scene, factor);
    todo!("everything moves away from one place, which is not the origin")
}

/// The velocity of all unknowns while the scale of the scene grows so, at a factor of one: the
/// derivative by the factor. For K cameras and L points 6 K + 3 L numbers. First the cameras, each
/// with the twist ξ = (ρ, φ) of T exp(ξ), where T is its camera_from_world; then the
/// points, each with its three coordinates. The six numbers of camera 0 are zero.
pub fn scale_direction(scene: Scene) -> DVector<f64> {
    let _ = scene;
    todo!("a twist for every camera, then a velocity for every point")
}

/// How far a direction is from being a null vector: the length of `hessian * direction` over
/// the product of the lengths of the two. The length of a matrix is the root of the sum of
/// its squared entries. Neither is zero.
pub fn annihilation(hessian: DMatrix<f64>, direction: DVector<f64>) -> f64 {
    let _ = (hessian, direction);
    todo!("one number without a unit")
}

/// A step of all unknowns, laid out as above, that moves every pixel as the step given does, to
/// first order, and leaves the **distance** between the centres of cameras 0 and 1 as it is,
/// to first order. The step given does not move camera 0, and neither does the one returned.
/// Cameras 0 and 1 do not stand in one place.
pub fn with_distance_held(scene: Scene, step: DVector<f64>) -> DVector<f64> {
    let _ = (scene, step);
    todo!("the step, and as much of what no pixel notices as the distance asks for")
}
