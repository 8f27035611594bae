//! What one image says about a point, what a second one adds, and how to write down a
//! point whose depth is not yet known.
//!
//! Where two cameras appear with a `baseline`, they have the same intrinsics and look
//! in the same direction, and the centre of the second lies `baseline` metres to the
//! right of the first, along its x axis.

use nalgebra::{Isometry3, Matrix2x3, Rotation3, Unit, Vector2, Vector3};

use crate::reprojection::{Pinhole, Z_MIN};

// ANCHOR: bearing
/// Direction, in camera coordinates, in which the camera sees a pixel.
///
/// Implements {eq:bearing}.
pub fn bearing(camera: &Pinhole, pixel: &Vector2<f64>) -> Unit<Vector3<f64>> {
    Unit::new_normalize(back_project(camera, pixel, 1.0))
}
// ANCHOR_END: bearing

// ANCHOR: back_project
/// The point, in camera coordinates, at `depth` metres on the ray of a pixel. Depth is
/// measured along the optical axis: it is the point's z, not its distance.
pub fn back_project(camera: &Pinhole, pixel: &Vector2<f64>, depth: f64) -> Vector3<f64> {
    let x = (pixel.x - camera.cx) / camera.fx;
    let y = (pixel.y - camera.cy) / camera.fy;
    depth * Vector3::new(x, y, 1.0)
}
// ANCHOR_END: back_project

// ANCHOR: pixel_of_direction
/// Pixel at which the camera sees a direction of any length, or `None` when the
/// direction does not point forward.
pub fn pixel_of_direction(camera: &Pinhole, direction: &Vector3<f64>) -> Option<Vector2<f64>> {
    if direction.z > 0.0 {
        // All points of a ray share one pixel, so take the one at a depth of one metre.
        camera.project_cam(&(direction / direction.z))
    } else {
        None
    }
}
// ANCHOR_END: pixel_of_direction

// ANCHOR: infinite_homography
/// Where the infinite homography K R K⁻¹ takes a pixel: where it goes when the camera turns about
/// its own centre [@hartley2004]. `None` when it turns behind the camera.
///
/// `second_from_first` takes directions in the camera before the turn to the camera
/// after it. Implements {eq:rotation-blind}, which holds at every depth.
pub fn transfer_by_infinite_homography(
    camera: &Pinhole,
    second_from_first: &Rotation3<f64>,
    pixel: &Vector2<f64>,
) -> Option<Vector2<f64>> {
    let turned = second_from_first * back_project(camera, pixel, 1.0);
    pixel_of_direction(camera, &turned)
}
// ANCHOR_END: infinite_homography

// ANCHOR: parallax
/// Angle, in radians, between the rays from two camera centres to a point, all three in
/// one frame. It is zero when the point lies in a centre.
///
/// The arc cosine of the scalar product would lose every angle below 1e-8; this form
/// keeps tiny angles.
pub fn parallax(
    point: &Vector3<f64>,
    first_centre: &Vector3<f64>,
    second_centre: &Vector3<f64>,
) -> f64 {
    let first_ray = point - first_centre;
    let second_ray = point - second_centre;
    // Sine and cosine of the angle, both times the lengths of the two rays.
    let sine = first_ray.cross(&second_ray).norm();
    // The scalar product with a ray of length zero may be −0, whose angle is π.
    let cosine = first_ray.dot(&second_ray) + 0.0;
    sine.atan2(cosine)
}
// ANCHOR_END: parallax

// ANCHOR: disparity
/// By how many pixels a point at `depth` metres lies farther to the left in the second
/// camera than in the first.
///
/// Implements {eq:disparity}.
pub fn disparity(camera: &Pinhole, baseline: f64, depth: f64) -> f64 {
    camera.fx * baseline / depth
}

/// Depth in metres of a point with this disparity in pixels, or `None` when the
/// disparity is not positive: such a point would lie at infinity or beyond.
pub fn depth_from_disparity(camera: &Pinhole, baseline: f64, disparity: f64) -> Option<f64> {
    (disparity > 0.0).then(|| camera.fx * baseline / disparity)
}
// ANCHOR_END: disparity

// ANCHOR: stretch_shift
/// By how many pixels the second camera's pixel moves to the right when a point at
/// `depth` metres is moved along the first camera's ray to `stretch` times its depth.
/// The first camera's pixel does not move.
///
/// Implements {eq:stretch}.
pub fn stretch_shift(camera: &Pinhole, baseline: f64, depth: f64, stretch: f64) -> f64 {
    disparity(camera, baseline, depth) * (1.0 - 1.0 / stretch)
}
// ANCHOR_END: stretch_shift

// ANCHOR: depth_sigma
/// Standard deviation of depth in metres, to first order, for a disparity with standard
/// deviation `disparity_sigma` in pixels.
///
/// `disparity_sigma` is the noise of the *disparity*. Independent noise of σ pixels in
/// each of the two images makes it √2 σ: see [`disparity_sigma`]. Implements
/// {eq:depth-sigma}.
pub fn depth_sigma(camera: &Pinhole, baseline: f64, depth: f64, disparity_sigma: f64) -> f64 {
    depth * depth * disparity_sigma / (camera.fx * baseline)
}

/// Standard deviation of the disparity for independent noise, all in pixels, in the two
/// images.
///
/// Implements {eq:disparity-noise}.
pub fn disparity_sigma(first_sigma: f64, second_sigma: f64) -> f64 {
    first_sigma.hypot(second_sigma)
}
// ANCHOR_END: depth_sigma

// ANCHOR: inverse_depth_sigma
/// Standard deviation of inverse depth in 1/metre for a disparity with standard
/// deviation `disparity_sigma` in pixels. It is exact and the same at every range.
///
/// Implements {eq:inverse-depth-sigma}.
pub fn inverse_depth_sigma(camera: &Pinhole, baseline: f64, disparity_sigma: f64) -> f64 {
    disparity_sigma / (camera.fx * baseline)
}
// ANCHOR_END: inverse_depth_sigma

// ANCHOR: inverse_depth
/// A point written as the camera that first saw it would: which way, and how near
/// [@civera2008].
///
/// A point at infinity has inverse depth zero. Noise can push the inverse depth below
/// zero, "beyond infinity"; such a value has no point but still has pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseDepth {
    /// x/z of the ray in the first camera, without unit.
    pub x: f64,
    /// y/z of the ray in the first camera, without unit.
    pub y: f64,
    /// 1/z in the first camera, in 1/metre.
    pub inverse_depth: f64,
}
// ANCHOR_END: inverse_depth

impl InverseDepth {
    // ANCHOR: inverse_depth_point
    /// The point that the first camera sees at `pixel`, at an inverse depth in 1/metre.
    pub fn from_pixel(camera: &Pinhole, pixel: &Vector2<f64>, inverse_depth: f64) -> Self {
        let ray = back_project(camera, pixel, 1.0);
        Self { x: ray.x, y: ray.y, inverse_depth }
    }

    /// The point in coordinates of the first camera (metres), or `None` at infinity and
    /// beyond.
    pub fn point(&self) -> Option<Vector3<f64>> {
        (self.inverse_depth > 0.0).then(|| Vector3::new(self.x, self.y, 1.0) / self.inverse_depth)
    }
    // ANCHOR_END: inverse_depth_point

    // ANCHOR: inverse_depth_projection
    /// Pixel in a second camera, or `None` when the point is not farther than [`Z_MIN`]
    /// in front of it.
    ///
    /// Nothing is divided by the inverse depth, so a point at infinity is no special
    /// case. Implements {eq:inverse-depth-projection}.
    pub fn project_into(
        &self,
        camera: &Pinhole,
        second_from_first: &Isometry3<f64>,
    ) -> Option<Vector2<f64>> {
        let h = self.scaled_point_in(second_from_first);
        // The point is h divided by the inverse depth, so this asks for a depth above Z_MIN.
        if h.z > Z_MIN * self.inverse_depth { pixel_of_direction(camera, &h) } else { None }
    }

    /// The point in the second camera's coordinates, times its inverse depth in the
    /// first: h in {eq:inverse-depth-projection}.
    fn scaled_point_in(&self, second_from_first: &Isometry3<f64>) -> Vector3<f64> {
        second_from_first.rotation * Vector3::new(self.x, self.y, 1.0)
            + self.inverse_depth * second_from_first.translation.vector
    }
    // ANCHOR_END: inverse_depth_projection

    // ANCHOR: inverse_depth_jacobian
    /// The pixel of [`InverseDepth::project_into`] and its 2×3 Jacobian with respect to
    /// `x`, `y` and `inverse_depth`. The last column, in pixel metres, stays finite at
    /// infinity.
    ///
    /// Implements {eq:inverse-depth-jacobian}.
    pub fn project_with_jacobian(
        &self,
        camera: &Pinhole,
        second_from_first: &Isometry3<f64>,
    ) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        let pixel = self.project_into(camera, second_from_first)?;
        let h = self.scaled_point_in(second_from_first);
        let (fx, fy) = (camera.fx / h.z, camera.fy / h.z);
        let pixel_by_h = Matrix2x3::new(fx, 0.0, -fx * h.x / h.z, 0.0, fy, -fy * h.y / h.z);
        let mut h_by_parameters = second_from_first.rotation.to_rotation_matrix().into_inner();
        h_by_parameters.set_column(2, &second_from_first.translation.vector);
        Some((pixel, pixel_by_h * h_by_parameters))
    }
    // ANCHOR_END: inverse_depth_jacobian
}
