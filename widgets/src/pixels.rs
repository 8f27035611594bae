//! A least-squares problem of the pixels of a scene.

use nalgebra::Vector3;
use vislam::bundle_adjustment::{PosedPinhole, TinyBa};
use vislam::factors::{MovingCamera, PixelByCamera};
use vislam::least_squares::{Factor, Kernel, Key, Problem, ProblemError};
use vislam::reprojection::ReprojFactor;

/// A camera that moves.
pub type Camera = MovingCamera<PosedPinhole, 6>;
/// A pixel of it.
pub type Pixel = PixelByCamera<PosedPinhole, 6>;

/// The problem as it starts, with any kernel, and of each pixel the factor that is made of it.
pub fn problem<F: Factor<2>>(
    start: &TinyBa<PosedPinhole, 6>,
    kernel: Kernel,
    factor: impl Fn(Pixel) -> F,
) -> Result<Problem, ProblemError> {
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
        problem.add_factor(factor(Pixel { camera, landmark, pixel, inverse_sigma }), kernel)?;
    }
    Ok(problem)
}
