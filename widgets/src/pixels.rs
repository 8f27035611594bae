//! A least-squares problem of the pixels of a scene.

use nalgebra::Vector3;
use vislam::bundle_adjustment::{PosedPinhole, TinyBa};
use vislam::factors::{MovingCamera, PixelByCamera};
use vislam::least_squares::{Kernel, Key, Problem, ProblemError};
use vislam::reprojection::ReprojFactor;

/// A camera that moves.
pub type Camera = MovingCamera<PosedPinhole, 6>;

/// The problem as it starts, with any kernel.
pub fn problem(start: &TinyBa<PosedPinhole, 6>, kernel: Kernel) -> Result<Problem, ProblemError> {
    let mut problem = Problem::new();
    let cameras: Vec<Key<Camera>> =
        start.cameras.iter().map(|camera| problem.add_variable(MovingCamera(*camera))).collect();
    let points: Vec<Key<Vector3<f64>>> =
        start.points.iter().map(|point| problem.add_variable(*point)).collect();
    for (index, camera) in cameras.iter().enumerate() {
        if start.fixed[index] {
            problem.hold(*camera)?;
        }
        let first = start.rig.iter().position(|rig| *rig == start.rig[index]);
        problem.tie(*camera, cameras[first.unwrap_or(index)])?;
    }
    for &ReprojFactor { keyframe, point, pixel, inverse_sigma } in &start.factors {
        let (camera, landmark) = (cameras[keyframe], points[point]);
        problem.add_factor(PixelByCamera { camera, landmark, pixel, inverse_sigma }, kernel)?;
    }
    Ok(problem)
}
