//! Ways to the chapter's results that do not use its formulas.

use nalgebra::{Isometry3, SMatrix, Vector2, Vector3, Vector6};
use vislam::reprojection::{Pinhole, RadialTangential};

use crate::manifold::oracle::exponential_of;

/// Pixel of a point in camera coordinates, by homogeneous coordinates. NaN behind the camera.
pub fn image_of(camera: &Pinhole, point: &Vector3<f64>) -> Vector2<f64> {
    let homogeneous = Vector3::new(
        camera.fx * point.x + camera.cx * point.z,
        camera.fy * point.y + camera.cy * point.z,
        point.z,
    );
    if point.z > 0.0 { homogeneous.xy() / point.z } else { Vector2::repeat(f64::NAN) }
}

/// A point in camera coordinates after a twist on the right of the pose, T exp(ξ).
pub fn moved_on_the_right(
    camera_from_world: &Isometry3<f64>,
    xi: &Vector6<f64>,
    point: &Vector3<f64>,
) -> Vector3<f64> {
    (camera_from_world.to_homogeneous() * exponential_of(xi) * point.push(1.0)).xyz()
}

/// A point in camera coordinates after a twist on the left of the pose, exp(ξ) T.
pub fn moved_on_the_left(
    camera_from_world: &Isometry3<f64>,
    xi: &Vector6<f64>,
    point: &Vector3<f64>,
) -> Vector3<f64> {
    (exponential_of(xi) * camera_from_world.to_homogeneous() * point.push(1.0)).xyz()
}

/// The Jacobian at zero by central differences of fourth order.
pub fn differences<const M: usize, const N: usize>(
    step: f64,
    function: impl Fn(&SMatrix<f64, N, 1>) -> SMatrix<f64, M, 1>,
) -> SMatrix<f64, M, N> {
    let columns = std::array::from_fn::<_, N, _>(|index| {
        let mut change = SMatrix::<f64, N, 1>::zeros();
        change[index] = step;
        let difference = |times: f64| function(&(times * change)) - function(&(-times * change));
        (8.0 * difference(1.0) - difference(2.0)) / (12.0 * step)
    });
    SMatrix::from_columns(&columns)
}

/// The scalar whose gradient the distorted point is.
pub fn lens_potential(lens: &RadialTangential, ideal: &Vector2<f64>) -> f64 {
    let [k1, k2, p1, p2, k3] = lens.coefficients();
    let s = ideal.norm_squared();
    let radial = s / 2.0 + k1 * s.powi(2) / 4.0 + k2 * s.powi(3) / 6.0 + k3 * s.powi(4) / 8.0;
    radial + (p2 * ideal.x + p1 * ideal.y) * s
}
