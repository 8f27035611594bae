//! What bundle adjustment needs to know of a camera, and two cameras that know it.

use nalgebra::{Isometry3, Matrix2x3, Rotation3, SMatrix, SVector, Vector2, Vector3, Vector6};

use crate::manifold::{se3, so3};
use crate::reprojection::Pinhole;

// ANCHOR: camera
/// A camera that bundle adjustment can move in `D` directions.
///
/// A camera is a value of its own kind: a pose, perhaps with a focal length. What the
/// solver sees of it is a small vector of `D` numbers by which it moves.
pub trait Camera<const D: usize>: Clone {
    /// Pixel of a point in world coordinates (metres), or `None` where the camera has no
    /// pixel for it. A pixel is always finite.
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>>;

    /// The pixel of [`Camera::project`] and its derivatives.
    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<View<D>>;

    /// The camera moved by a small vector, in the directions in which
    /// [`Camera::differentiate`] takes derivatives.
    fn retract(&self, change: &SVector<f64, D>) -> Self;
}
// ANCHOR_END: camera

// ANCHOR: view
/// A pixel and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View<const D: usize> {
    /// The pixel.
    pub pixel: Vector2<f64>,
    /// Its 2×D Jacobian with respect to the camera's small vector.
    pub by_camera: SMatrix<f64, 2, D>,
    /// Its 2×3 Jacobian with respect to the point in world coordinates, in pixels by metre.
    pub by_point: Matrix2x3<f64>,
}
// ANCHOR_END: view

// ANCHOR: posed_pinhole
/// A pinhole camera with known intrinsics at a pose that is to be found. Its six numbers
/// are a twist, translation first: `camera_from_world` becomes
/// `camera_from_world * exp(twist)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PosedPinhole {
    /// Focal lengths and principal point, in pixels. They stay what they are.
    pub intrinsics: Pinhole,
    /// The pose: world coordinates to camera coordinates, in metres.
    pub camera_from_world: Isometry3<f64>,
}
// ANCHOR_END: posed_pinhole

// ANCHOR: posed_pinhole_camera
impl Camera<6> for PosedPinhole {
    #[inline]
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.intrinsics.project(&self.camera_from_world, point_in_world)
    }

    #[inline]
    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<View<6>> {
        let rotation = self.camera_from_world.rotation.to_rotation_matrix();
        let point = rotation * point_in_world + self.camera_from_world.translation.vector;
        let pixel = self.intrinsics.project_cam(&point)?;
        let (fx, fy) = (self.intrinsics.fx / point.z, self.intrinsics.fy / point.z);
        let (x, y) = (point.x / point.z, point.y / point.z);
        let by_point_in_camera = Matrix2x3::new(fx, 0.0, -fx * x, 0.0, fy, -fy * y);
        let by_point = by_point_in_camera * rotation.matrix();
        Some(View { pixel, by_camera: by_twist(&by_point, point_in_world), by_point })
    }

    fn retract(&self, twist: &Vector6<f64>) -> Self {
        let camera_from_world = se3::retract(&self.camera_from_world, twist);
        Self { camera_from_world, ..*self }
    }
}
// ANCHOR_END: posed_pinhole_camera

impl PosedPinhole {
    /// Where the camera is, in world coordinates (metres).
    pub fn centre(&self) -> Vector3<f64> {
        self.camera_from_world.inverse().translation.vector
    }
}

// ANCHOR: by_twist
/// The 2×6 Jacobian with respect to the twist of a pose, from the 2×3 Jacobian with
/// respect to a point in the world.
///
/// The twist moves the world before the camera looks at it: the point P becomes
/// P + ρ + φ × P. So the first three columns are those of the point, and the derivative by
/// φ of a row a is a (φ × P) = φ (P × a).
#[inline]
fn by_twist(by_point: &Matrix2x3<f64>, point_in_world: &Vector3<f64>) -> SMatrix<f64, 2, 6> {
    let u = by_point.row(0).transpose();
    let v = by_point.row(1).transpose();
    let (u_turned, v_turned) = (point_in_world.cross(&u), point_in_world.cross(&v));
    #[rustfmt::skip]
    let jacobian = SMatrix::<f64, 2, 6>::new(
        u.x, u.y, u.z, u_turned.x, u_turned.y, u_turned.z,
        v.x, v.y, v.z, v_turned.x, v_turned.y, v_turned.z,
    );
    jacobian
}
// ANCHOR_END: by_twist

// ANCHOR: bal_camera
/// The camera of the "Bundle Adjustment in the Large" data sets. It looks along its −z
/// axis, its pixels are counted from the centre of the image, and a point at (x, y) on the
/// plane z = −1 has the pixel f (1 + k₁ r² + k₂ r⁴) (x, y) with r² = x² + y².
///
/// It divides by the signed depth: a point behind the camera has a pixel too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BalCamera {
    /// Turns world coordinates into the camera's axes.
    pub rotation: Rotation3<f64>,
    /// Where the world's origin lies in camera coordinates.
    pub translation: Vector3<f64>,
    /// Focal length in pixels.
    pub focal_length: f64,
    /// Radial coefficients k₁ and k₂, without unit.
    pub radial: [f64; 2],
}
// ANCHOR_END: bal_camera

impl BalCamera {
    /// x and y on the plane z = −1, and −1/z.
    #[inline]
    fn image_plane(&self, point_in_world: &Vector3<f64>) -> (f64, f64, f64) {
        let point = self.rotation * point_in_world + self.translation;
        let inverse_depth = -1.0 / point.z;
        (point.x * inverse_depth, point.y * inverse_depth, inverse_depth)
    }

    // ANCHOR: bal_project
    /// Pixel of a point in world coordinates, or `None` where it would not be finite.
    #[inline]
    pub fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        let (x, y, _) = self.image_plane(point_in_world);
        let r2 = x * x + y * y;
        let scale = self.focal_length * (1.0 + r2 * (self.radial[0] + r2 * self.radial[1]));
        let pixel = Vector2::new(scale * x, scale * y);
        (pixel.x + pixel.y).is_finite().then_some(pixel)
    }
    // ANCHOR_END: bal_project

    /// The pose moved by a twist: T exp(ξ), with the intrinsics left alone.
    fn turned_and_moved(&self, twist: &Vector6<f64>) -> Self {
        let (rho, phi) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3).into_owned());
        let translation = self.translation + self.rotation * (so3::left_jacobian(&phi) * rho);
        Self { rotation: so3::retract(&self.rotation, &phi), translation, ..*self }
    }
}

impl Camera<9> for BalCamera {
    #[inline]
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.project(point_in_world)
    }

    // ANCHOR: bal_differentiate
    #[inline]
    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<View<9>> {
        let (f, [k1, k2]) = (self.focal_length, self.radial);
        let (x, y, inverse_depth) = self.image_plane(point_in_world);
        let r2 = x * x + y * y;
        let distortion = 1.0 + r2 * (k1 + r2 * k2);
        let slope = 2.0 * (k1 + 2.0 * r2 * k2);
        // By x and y, a symmetric matrix, and then by the point in camera coordinates.
        let (uu, uv) = (f * (distortion + slope * x * x), f * slope * x * y);
        let vv = f * (distortion + slope * y * y);
        let by_point_in_camera =
            inverse_depth * Matrix2x3::new(uu, uv, uu * x + uv * y, uv, vv, uv * x + vv * y);
        let by_point = by_point_in_camera * self.rotation.matrix();
        let mut by_camera = SMatrix::<f64, 2, 9>::zeros();
        by_camera.fixed_columns_mut::<6>(0).copy_from(&by_twist(&by_point, point_in_world));
        for (row, q) in [x, y].into_iter().enumerate() {
            by_camera[(row, 6)] = distortion * q;
            by_camera[(row, 7)] = f * r2 * q;
            by_camera[(row, 8)] = f * r2 * r2 * q;
        }
        let pixel = Vector2::new(f * distortion * x, f * distortion * y);
        (pixel.x + pixel.y).is_finite().then_some(View { pixel, by_camera, by_point })
    }
    // ANCHOR_END: bal_differentiate

    fn retract(&self, change: &SVector<f64, 9>) -> Self {
        let moved = self.turned_and_moved(&change.fixed_rows::<6>(0).into_owned());
        let radial = [self.radial[0] + change[7], self.radial[1] + change[8]];
        Self { focal_length: self.focal_length + change[6], radial, ..moved }
    }
}

/// The same camera with its intrinsics held: only the pose moves.
impl Camera<6> for BalCamera {
    #[inline]
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.project(point_in_world)
    }

    #[inline]
    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<View<6>> {
        let View { pixel, by_camera, by_point } = Camera::<9>::differentiate(self, point_in_world)?;
        Some(View { pixel, by_camera: by_camera.fixed_columns::<6>(0).into_owned(), by_point })
    }

    fn retract(&self, twist: &Vector6<f64>) -> Self {
        self.turned_and_moved(twist)
    }
}
