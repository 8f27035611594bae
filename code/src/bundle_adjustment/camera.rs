//! What bundle adjustment needs to know of a camera, and two cameras that know it.

use nalgebra::{
    Isometry3, Matrix2x3, Matrix6, Rotation3, SMatrix, SVector, Vector2, Vector3, Vector6,
};

use crate::manifold::{se3, so3};
use crate::reprojection::{CameraModel, Pinhole};

// ANCHOR: camera
/// A camera that bundle adjustment can move in `D` directions.
///
/// A camera is a value of its own kind: a pose, perhaps with a focal length. What the
/// solver sees of it is a small vector of `D` numbers by which it moves.
pub trait Camera<const D: usize>: Clone + Send + Sync + 'static {
    /// Pixel of a point in world coordinates (metres), or `None` where the camera has no
    /// pixel for it. A pixel is always finite.
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>>;

    /// The pixel of [`Camera::project`] and its derivatives.
    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<LinearizedPixel<D>>;

    /// The camera moved by a small vector, in the directions in which
    /// [`Camera::differentiate`] takes derivatives.
    fn retract(&self, change: &SVector<f64, D>) -> Self;

    /// The small vector that leads from this camera to another one.
    fn local(&self, to: &Self) -> SVector<f64, D>;

    /// The D×D derivative of `self.local(to)` by a small vector that moves `to`.
    fn local_jacobian(&self, to: &Self) -> SMatrix<f64, D, D>;
}
// ANCHOR_END: camera

// ANCHOR: linearized_pixel
/// A pixel and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearizedPixel<const D: usize> {
    /// The pixel.
    pub pixel: Vector2<f64>,
    /// Its 2×D Jacobian with respect to the camera's small vector.
    pub by_camera: SMatrix<f64, 2, D>,
    /// Its 2×3 Jacobian with respect to the point in world coordinates, in pixels by metre.
    pub by_point: Matrix2x3<f64>,
}
// ANCHOR_END: linearized_pixel

// ANCHOR: posed
/// A camera of known intrinsics at a pose that is to be found. Its six numbers are a twist,
/// translation first: `camera_from_world` becomes `camera_from_world * exp(twist)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posed<M> {
    /// The camera model, with intrinsics in pixels. They stay what they are.
    pub intrinsics: M,
    /// The pose: world coordinates to camera coordinates, in metres.
    pub camera_from_world: Isometry3<f64>,
}

/// A pinhole camera of known intrinsics at a pose that is to be found.
pub type PosedPinhole = Posed<Pinhole>;
// ANCHOR_END: posed

// ANCHOR: posed_camera
impl<M: CameraModel> Camera<6> for Posed<M> {
    #[inline(always)]
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        let turned = self.camera_from_world.rotation * point_in_world;
        self.intrinsics.project_cam(&(turned + self.camera_from_world.translation.vector))
    }

    #[inline(always)]
    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<LinearizedPixel<6>> {
        let rotation = self.camera_from_world.rotation.to_rotation_matrix();
        let point = rotation * point_in_world + self.camera_from_world.translation.vector;
        let (pixel, by_camera_point) = self.intrinsics.project_cam_with_jacobian(&point)?;
        let by_point = by_camera_point * rotation.matrix();
        Some(LinearizedPixel { pixel, by_camera: by_twist(&by_point, point_in_world), by_point })
    }

    fn retract(&self, twist: &Vector6<f64>) -> Self {
        let camera_from_world = se3::retract(&self.camera_from_world, twist);
        Self { camera_from_world, ..self.clone() }
    }
    // ANCHOR_END: posed_camera

    fn local(&self, to: &Self) -> Vector6<f64> {
        se3::local(&self.camera_from_world, &to.camera_from_world)
    }

    fn local_jacobian(&self, to: &Self) -> Matrix6<f64> {
        se3::right_jacobian_inverse(&self.local(to))
    }
}

impl<M> Posed<M> {
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
#[inline(always)]
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

/// A point as a BAL camera sees it, before the focal length.
#[derive(Debug, Clone, Copy)]
struct Slopes {
    /// On the plane z = −1.
    x: f64,
    y: f64,
    /// x² + y².
    r2: f64,
    /// By how much the lens stretches x and y.
    stretch: f64,
    /// −1/z.
    inverse_depth: f64,
}

impl BalCamera {
    // ANCHOR: bal_project
    #[inline(always)]
    fn slopes(&self, point_in_world: &Vector3<f64>) -> Slopes {
        let point = self.rotation * point_in_world + self.translation;
        let inverse_depth = -1.0 / point.z;
        let (x, y) = (point.x * inverse_depth, point.y * inverse_depth);
        let r2 = x * x + y * y;
        let stretch = 1.0 + r2 * (self.radial[0] + r2 * self.radial[1]);
        Slopes { x, y, r2, stretch, inverse_depth }
    }

    /// Pixel of a point in world coordinates, or `None` where it would not be finite.
    ///
    /// Implements {eq:bal-pixel}.
    #[inline(always)]
    pub fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        let Slopes { x, y, stretch, .. } = self.slopes(point_in_world);
        let scale = self.focal_length * stretch;
        let pixel = Vector2::new(scale * x, scale * y);
        (pixel.x + pixel.y).is_finite().then_some(pixel)
    }
    // ANCHOR_END: bal_project

    // ANCHOR: bal_by_point
    /// The 2×3 derivative of the pixel by the point in world coordinates.
    #[inline(always)]
    fn by_point(&self, slopes: &Slopes) -> Matrix2x3<f64> {
        let Slopes { x, y, r2, stretch, inverse_depth } = *slopes;
        let [right, up, back] = [0, 1, 2].map(|axis| self.rotation.matrix().row(axis));
        // How x and y change with the point, times the depth, and how the pixel does with them.
        let (by_x, by_y) = (right + x * back, up + y * back);
        let slope = 2.0 * (self.radial[0] + 2.0 * r2 * self.radial[1]);
        let scale = self.focal_length * inverse_depth;
        let (uu, uv) = (scale * (stretch + slope * x * x), scale * slope * x * y);
        let vv = scale * (stretch + slope * y * y);
        Matrix2x3::from_rows(&[uu * by_x + uv * by_y, uv * by_x + vv * by_y])
    }
    // ANCHOR_END: bal_by_point

    /// The pose moved by a twist: T exp(ξ), with the intrinsics left alone.
    fn turned_and_moved(&self, twist: &Vector6<f64>) -> Self {
        let (rho, phi) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3).into_owned());
        let translation = self.translation + self.rotation * (so3::left_jacobian(&phi) * rho);
        Self { rotation: so3::retract(&self.rotation, &phi), translation, ..*self }
    }

    /// The twist from this camera's pose to another one's.
    fn twist_to(&self, to: &Self) -> Vector6<f64> {
        let phi = so3::local(&self.rotation, &to.rotation);
        let moved = self.rotation.inverse() * (to.translation - self.translation);
        let rho = so3::left_jacobian_inverse(&phi) * moved;
        Vector6::new(rho.x, rho.y, rho.z, phi.x, phi.y, phi.z)
    }
}

/// Everything moves: pose, focal length, k₁ and k₂.
impl Camera<9> for BalCamera {
    #[inline(always)]
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.project(point_in_world)
    }

    // ANCHOR: bal_differentiate
    #[inline(always)]
    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<LinearizedPixel<9>> {
        let slopes = self.slopes(point_in_world);
        let Slopes { x, y, r2, stretch, .. } = slopes;
        let by_point = self.by_point(&slopes);
        let twist = by_twist(&by_point, point_in_world);
        let f = self.focal_length;
        let by_intrinsics = Vector3::new(stretch, f * r2, f * r2 * r2);
        let by_camera = SMatrix::from_fn(|row, axis| match axis {
            0..6 => twist[(row, axis)],
            _ => by_intrinsics[axis - 6] * if row == 0 { x } else { y },
        });
        let pixel = f * stretch * Vector2::new(x, y);
        (pixel.x + pixel.y).is_finite().then_some(LinearizedPixel { pixel, by_camera, by_point })
    }
    // ANCHOR_END: bal_differentiate

    fn retract(&self, change: &SVector<f64, 9>) -> Self {
        let moved = self.turned_and_moved(&change.fixed_rows::<6>(0).into_owned());
        let radial = [self.radial[0] + change[7], self.radial[1] + change[8]];
        Self { focal_length: self.focal_length + change[6], radial, ..moved }
    }

    fn local(&self, to: &Self) -> SVector<f64, 9> {
        let twist = self.twist_to(to);
        SVector::from_fn(|axis, _| match axis {
            0..6 => twist[axis],
            6 => to.focal_length - self.focal_length,
            _ => to.radial[axis - 7] - self.radial[axis - 7],
        })
    }

    fn local_jacobian(&self, to: &Self) -> SMatrix<f64, 9, 9> {
        let mut jacobian = SMatrix::<f64, 9, 9>::identity();
        let by_twist = se3::right_jacobian_inverse(&self.twist_to(to));
        jacobian.fixed_view_mut::<6, 6>(0, 0).copy_from(&by_twist);
        jacobian
    }
}

/// The intrinsics are held: only the pose moves.
impl Camera<6> for BalCamera {
    #[inline(always)]
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.project(point_in_world)
    }

    #[inline(always)]
    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<LinearizedPixel<6>> {
        let slopes = self.slopes(point_in_world);
        let by_point = self.by_point(&slopes);
        let by_camera = by_twist(&by_point, point_in_world);
        let pixel = self.focal_length * slopes.stretch * Vector2::new(slopes.x, slopes.y);
        (pixel.x + pixel.y).is_finite().then_some(LinearizedPixel { pixel, by_camera, by_point })
    }

    fn retract(&self, twist: &Vector6<f64>) -> Self {
        self.turned_and_moved(twist)
    }

    fn local(&self, to: &Self) -> Vector6<f64> {
        self.twist_to(to)
    }

    fn local_jacobian(&self, to: &Self) -> Matrix6<f64> {
        se3::right_jacobian_inverse(&self.twist_to(to))
    }
}
