//! A lens that bends the image: five coefficients, and the way back.
//!
//! All points here are in normalized coordinates, (X/Z, Y/Z) of a point in camera
//! coordinates: slopes, without unit. *Ideal* is where a pinhole would see the point,
//! *distorted* where the lens shows it.

use nalgebra::{Matrix2, SMatrix, Vector2};
use thiserror::Error;

// ANCHOR: radial_tangential
/// Radial and tangential distortion [@brown1971], with the coefficients that OpenCV, Kalibr
/// and the EuRoC data set use, in their order: k1, k2, p1, p2 and, optional there, k3.
///
/// The map is the gradient of a scalar function of the ideal point, so its Jacobian is
/// symmetric; where that is positive definite on a convex set, no two ideal points of
/// the set have one image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadialTangential {
    /// k1, k2, k3: of r², r⁴ and r⁶.
    radial: [f64; 3],
    /// p1 and p2.
    tangential: [f64; 2],
    monotonic_radius: f64,
}
// ANCHOR_END: radial_tangential

impl RadialTangential {
    /// A lens with these coefficients; five zeros are a lens that does not distort.
    ///
    /// # Errors
    ///
    /// [`DistortionError`] names the first coefficient that is not finite.
    pub fn new(k1: f64, k2: f64, p1: f64, p2: f64, k3: f64) -> Result<Self, DistortionError> {
        for (name, value) in [("k1", k1), ("k2", k2), ("p1", p1), ("p2", p2), ("k3", k3)] {
            if !value.is_finite() {
                return Err(DistortionError { name, value });
            }
        }
        let radial = [k1, k2, k3];
        let monotonic_radius = monotonic_radius(&radial);
        Ok(Self { radial, tangential: [p1, p2], monotonic_radius })
    }

    /// The coefficients k1, k2, p1, p2, k3.
    pub fn coefficients(&self) -> [f64; 5] {
        let ([k1, k2, k3], [p1, p2]) = (self.radial, self.tangential);
        [k1, k2, p1, p2, k3]
    }

    /// Up to this radius of the ideal point the distorted radius grows with it; infinity
    /// when it always does. Only the radial coefficients count. Beyond it the model folds
    /// the image over, and what it says there is not what any lens does.
    pub fn monotonic_radius(&self) -> f64 {
        self.monotonic_radius
    }

    // ANCHOR: distort
    /// Where the lens shows an ideal point.
    ///
    /// Implements {eq:distortion}.
    pub fn distort(&self, ideal: &Vector2<f64>) -> Vector2<f64> {
        let [p1, p2] = self.tangential;
        let (x, y) = (ideal.x, ideal.y);
        let (factor, _) = self.radial_factor(ideal.norm_squared());
        // The tangential part is the gradient of (p · ideal) r² with p = (p2, p1).
        let along = p2 * x + p1 * y;
        (factor + 2.0 * along) * ideal + ideal.norm_squared() * Vector2::new(p2, p1)
    }

    /// The factor 1 + k1 r² + k2 r⁴ + k3 r⁶ and its derivative by r².
    fn radial_factor(&self, r_squared: f64) -> (f64, f64) {
        let [k1, k2, k3] = self.radial;
        let factor = 1.0 + r_squared * (k1 + r_squared * (k2 + r_squared * k3));
        (factor, k1 + r_squared * (2.0 * k2 + r_squared * 3.0 * k3))
    }
    // ANCHOR_END: distort

    // ANCHOR: distortion_jacobian
    /// The 2×2 Jacobian of the distorted point by the ideal point. It is symmetric.
    ///
    /// Implements {eq:distortion-jacobian}.
    pub fn jacobian(&self, ideal: &Vector2<f64>) -> Matrix2<f64> {
        let [p1, p2] = self.tangential;
        let (x, y) = (ideal.x, ideal.y);
        let (factor, slope) = self.radial_factor(ideal.norm_squared());
        let across = 2.0 * (slope * x * y + p1 * x + p2 * y);
        Matrix2::new(
            factor + 2.0 * (slope * x * x + p1 * y + 3.0 * p2 * x),
            across,
            across,
            factor + 2.0 * (slope * y * y + 3.0 * p1 * y + p2 * x),
        )
    }
    // ANCHOR_END: distortion_jacobian

    /// The 2×5 Jacobian of the distorted point by k1, k2, p1, p2, k3, for calibration. It
    /// does not depend on the coefficients, since the model is linear in them.
    pub fn coefficient_jacobian(ideal: &Vector2<f64>) -> SMatrix<f64, 2, 5> {
        let (x, y, s) = (ideal.x, ideal.y, ideal.norm_squared());
        let by_p1 = Vector2::new(2.0 * x * y, s + 2.0 * y * y);
        let by_p2 = Vector2::new(s + 2.0 * x * x, 2.0 * x * y);
        SMatrix::from_columns(&[s * ideal, s * s * ideal, by_p1, by_p2, s * s * s * ideal])
    }

    // ANCHOR: undistort
    /// The ideal point that the lens shows at `distorted`, by Newton's method from the
    /// centre of the image. A step is shortened until it lowers the error and stays where
    /// the model can be inverted.
    ///
    /// # Errors
    ///
    /// [`UndistortError`] when the model shows no point there, or when the point given is
    /// not finite.
    pub fn undistort(&self, distorted: &Vector2<f64>) -> Result<Vector2<f64>, UndistortError> {
        let mut ideal = Vector2::zeros();
        let mut error = *distorted;
        for _ in 0..MAX_ITERATIONS {
            let rounding = ROUNDING * (ideal.norm() + distorted.norm());
            if error.norm() <= rounding && rounding.is_finite() {
                return Ok(ideal);
            }
            match self.newton_step(&ideal, &error, distorted) {
                Some(better) => (ideal, error) = better,
                None => break,
            }
        }
        Err(self.undistort_error(distorted, &ideal))
    }
    // ANCHOR_END: undistort

    // ANCHOR: newton_step
    /// A better ideal point with the error that is left, or `None` when there is none.
    fn newton_step(
        &self,
        ideal: &Vector2<f64>,
        error: &Vector2<f64>,
        distorted: &Vector2<f64>,
    ) -> Option<(Vector2<f64>, Vector2<f64>)> {
        let step = self.jacobian(ideal).try_inverse()? * error;
        (0..MAX_HALVINGS).find_map(|halvings| {
            let next = ideal + 0.5_f64.powi(halvings) * step;
            let (shown, _) = self.shown(&next)?;
            let left = distorted - shown;
            (left.norm() < error.norm()).then_some((next, left))
        })
    }

    /// Where the lens shows an ideal point, with the Jacobian, if the radius is below the fold and the
    /// Jacobian positive definite.
    pub(super) fn shown(&self, ideal: &Vector2<f64>) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        let jacobian = self.jacobian(ideal);
        let is_definite = jacobian.determinant() > 0.0 && jacobian.trace() > 0.0;
        let is_within = is_definite && ideal.norm() < self.monotonic_radius;
        is_within.then(|| (self.distort(ideal), jacobian))
    }
    // ANCHOR_END: newton_step

    fn undistort_error(&self, distorted: &Vector2<f64>, reached: &Vector2<f64>) -> UndistortError {
        let (x, y) = (distorted.x, distorted.y);
        if x.is_finite() && y.is_finite() {
            UndistortError::NoIdealPoint { x, y, reached: reached.norm() }
        } else {
            UndistortError::NotFinite { x, y }
        }
    }
}

/// Newton needs four or five; a point near the fold up to some dozens.
const MAX_ITERATIONS: usize = 100;
/// After so many halvings a step is lost in rounding.
const MAX_HALVINGS: i32 = 60;
/// The error that evaluating the polynomial leaves, relative to the points.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

// ANCHOR: monotonic_radius
/// The smallest positive r at which r (1 + k1 r² + k2 r⁴ + k3 r⁶) stops growing.
fn monotonic_radius([k1, k2, k3]: &[f64; 3]) -> f64 {
    // The derivative as a function of s = r², and the places where its own slope changes sign.
    let derivative = |s: f64| 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3));
    let turns = positive_roots(21.0 * k3, 10.0 * k2, 3.0 * k1);
    let mut low = 0.0;
    for turn in turns.into_iter().flatten() {
        if derivative(turn) <= 0.0 {
            return sign_change(derivative, low, turn).sqrt();
        }
        low = turn;
    }
    // From here on the derivative falls for ever or rises for ever.
    let mut high = 2.0 * low + 1.0;
    while derivative(high) > 0.0 {
        if high > 1e100 {
            return f64::INFINITY;
        }
        high *= 2.0;
    }
    sign_change(derivative, low, high).sqrt()
}
// ANCHOR_END: monotonic_radius

/// The positive roots of a s² + b s + c in rising order.
fn positive_roots(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let discriminant = b * b - 4.0 * a * c;
    // Adding numbers of one sign loses no digits; the other root follows from the product.
    let sum = -0.5 * (b + discriminant.sqrt().copysign(b));
    let (first, second) = (sum / a, c / sum);
    let is_root = |root: &f64| root.is_finite() && *root > 0.0;
    [first.min(second), first.max(second)].map(|root| Some(root).filter(is_root))
}

/// Where a function that is positive at `low` and not at `high` changes its sign.
fn sign_change(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return low;
        }
        if function(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// A coefficient that no lens has.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("distortion coefficient {name} is {value}; give a finite number")]
pub struct DistortionError {
    /// `k1`, `k2`, `p1`, `p2` or `k3`.
    pub name: &'static str,
    /// The value given.
    pub value: f64,
}

/// Why a distorted point has no ideal point.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum UndistortError {
    /// The lens model shows nothing there: it folds the image over before it gets so far.
    #[error(
        "the lens model shows nothing at ({x}, {y}): it folds over near the ideal radius {reached}; \
         leave pixels so far out away, or calibrate with views that reach them"
    )]
    NoIdealPoint {
        /// X/Z of the distorted point.
        x: f64,
        /// Y/Z of the distorted point.
        y: f64,
        /// Radius of the ideal point at which the search ended.
        reached: f64,
    },
    /// The distorted point is not finite.
    #[error("the distorted point is ({x}, {y}); give finite coordinates")]
    NotFinite {
        /// X/Z given.
        x: f64,
        /// Y/Z given.
        y: f64,
    },
}
