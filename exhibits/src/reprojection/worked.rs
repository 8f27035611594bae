//! The worked example of the chapter, and a real lens.

use nalgebra::{DMatrix, Isometry3, Matrix2x3, Matrix2x6, Vector3};
use vislam::reprojection::{DistortedPinhole, Pinhole, RadialTangential};

// The camera stands at the origin of the world.
pub use crate::bearing::worked::{CAMERA, POINT};

/// The 2×6 pose block and the 2×3 point block of a point that the camera sees.
pub fn blocks(point: &Vector3<f64>) -> (Matrix2x6<f64>, Matrix2x3<f64>) {
    CAMERA.jacobians(&Isometry3::identity(), point).expect("it is in front of the camera")
}

/// Both blocks side by side, 2×9.
pub fn both_blocks(point: &Vector3<f64>) -> DMatrix<f64> {
    let (by_pose, by_point) = blocks(point);
    let mut both = DMatrix::zeros(2, 9);
    both.columns_mut(0, 6).copy_from(&by_pose);
    both.columns_mut(6, 3).copy_from(&by_point);
    both
}

/// Columns and rows of an image of the EuRoC data set.
pub const EUROC_SIZE: (f64, f64) = (752.0, 480.0);

/// The left camera of the EuRoC data set, as its authors calibrated it.
pub fn euroc() -> DistortedPinhole {
    let pinhole = Pinhole { fx: 458.654, fy: 457.296, cx: 367.215, cy: 248.375 };
    let lens = RadialTangential::new(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0);
    DistortedPinhole { pinhole, lens: lens.expect("finite coefficients") }
}

/// The same lens with only its first coefficient, as one would fit to the middle of the image.
pub fn one_coefficient() -> RadialTangential {
    let [k1, ..] = euroc().lens.coefficients();
    RadialTangential::new(k1, 0.0, 0.0, 0.0, 0.0).expect("a finite coefficient")
}
