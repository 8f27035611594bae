//! Scale is a null space.

use exercise_spec::scale_null_space::Scene;
use nalgebra::{DMatrix, DVector, Isometry3, Vector3};

/// The scene with all distances `factor` times as long, and camera 0 exactly where it was.
/// No pixel changes. The factor is positive.
pub fn rescaled(scene: Scene, factor: f64) -> Scene {
    let pinned = centre(&scene.cameras[0]);
    let place = |before: Vector3<f64>| pinned + factor * (before - pinned);
    let pose = |before: &Isometry3<f64>| {
        let translation = -(before.rotation * place(centre(before)));
        Isometry3::from_parts(translation.into(), before.rotation)
    };
    Scene {
        cameras: scene.cameras.iter().map(pose).collect(),
        points: scene.points.iter().copied().map(place).collect(),
    }
}

/// The velocity of all unknowns while the scale of the scene grows so, at a factor of one: the
/// derivative by the factor. For K cameras and L points 6 K + 3 L numbers. First the cameras, each
/// with the twist ξ = (ρ, φ) of T exp(ξ), where T is its camera_from_world; then the
/// points, each with its three coordinates. The six numbers of camera 0 are zero.
pub fn scale_direction(scene: Scene) -> DVector<f64> {
    let pinned = centre(&scene.cameras[0]);
    let twists = scene.cameras.iter().flat_map(|pose| {
        let rho = pinned - centre(pose);
        [rho.x, rho.y, rho.z, 0.0, 0.0, 0.0]
    });
    let velocities = scene.points.iter().flat_map(|point| <[f64; 3]>::from(point - pinned));
    DVector::from_vec(twists.chain(velocities).collect())
}

/// How far a direction is from being a null vector: the length of `hessian * direction` over
/// the product of the lengths of the two. The length of a matrix is the root of the sum of
/// its squared entries. Neither is zero.
pub fn annihilation(hessian: DMatrix<f64>, direction: DVector<f64>) -> f64 {
    (&hessian * &direction).norm() / (hessian.norm() * direction.norm())
}

/// A step of all unknowns, laid out as above, that moves every pixel as the step given does, to
/// first order, and leaves the **distance** between the centres of cameras 0 and 1 as it is,
/// to first order. The step given does not move camera 0, and neither does the one returned.
/// Cameras 0 and 1 do not stand in one place.
pub fn with_distance_held(scene: Scene, step: DVector<f64>) -> DVector<f64> {
    let (pinned, moving) = (centre(&scene.cameras[0]), centre(&scene.cameras[1]));
    let (rho, phi) = (step.fixed_rows::<3>(6), step.fixed_rows::<3>(9));
    let velocity = -rho - phi.cross(&moving);
    let baseline = moving - pinned;
    // The direction of scale lengthens the baseline by its own length, the step by its part along it.
    let share = baseline.dot(&velocity) / baseline.norm_squared();
    step - share * scale_direction(scene)
}

/// The centre of a camera, in the world.
fn centre(camera_from_world: &Isometry3<f64>) -> Vector3<f64> {
    camera_from_world.inverse().translation.vector
}
