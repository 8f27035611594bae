//! Pictures between which a matrix takes every ray: of a plane, or from one place.

use nalgebra::{DMatrix, Matrix2, Matrix3, Rotation3, SVector, Vector2};

use super::Matches;
use super::consensus::{Correspondences, Effort};
use super::homography::homography_of_four;
use super::rotation::rotation_of_rays;
use crate::factors::{Transfer, Transferred, transfer_covariance};
use crate::least_squares::{Factor, Kernel, Key, Problem};

// ANCHOR: one_plane
/// Matches as data about a homography: points of one plane, or at any depths when the camera only
/// turned. Its nine entries stand column by column, with a length of one.
#[derive(Debug, Clone, Copy)]
pub struct OnePlane<'a>(pub &'a Matches);

/// Matches as data about a rotation, `second_from_first`: the camera only turned, or all points are
/// far away.
#[derive(Debug, Clone, Copy)]
pub struct OnlyTurned<'a>(pub &'a Matches);
// ANCHOR_END: one_plane

// ANCHOR: transfer_error
/// The squared error of the transferred slopes less the measured ones, by the covariance of their
/// difference {eq:transfer-square}.
fn squared_errors(matches: &Matches, matrix: Matrix3<f64>) -> impl Fn(usize, usize) -> f64 + '_ {
    let [first, second] = matches.sigmas.map(|sigma| Matrix3::from_diagonal(&sigma.push(1.0)));
    // In units of the noise: x, y go to X/Z, Y/Z.
    let inverse = Matrix3::from_diagonal(&second.diagonal().map(f64::recip));
    let h = inverse * matrix * first;
    move |here, there| {
        let ([x, y, ..], [.., u, v]) = (matches.scaled[here], matches.scaled[there]);
        let z = h.m31 * x + h.m32 * y + h.m33;
        let is_in_front = z > 0.0;
        if !is_in_front {
            return f64::INFINITY;
        }
        let (to_x, to_y) =
            ((h.m11 * x + h.m12 * y + h.m13) / z, (h.m21 * x + h.m22 * y + h.m23) / z);
        let off = Vector2::new(to_x - u, to_y - v);
        let (a, b) = ((h.m11 - to_x * h.m31) / z, (h.m12 - to_x * h.m32) / z);
        let (c, d) = ((h.m21 - to_y * h.m31) / z, (h.m22 - to_y * h.m32) / z);
        let (p, q, r) = (1.0 + a * a + b * b, a * c + b * d, 1.0 + c * c + d * d);
        (r * off.x * off.x - 2.0 * q * off.x * off.y + p * off.y * off.y) / (p * r - q * q)
    }
}
// ANCHOR_END: transfer_error

/// A problem whose weights are those of the transfer at its start.
fn problem<T: Transfer<D>, const D: usize>(
    matches: &Matches,
    start: &T,
    data: &[usize],
) -> Option<(Problem, Key<T>)>
where
    Transferred<T>: Factor<2>,
{
    let mut problem = Problem::new();
    let transfer = problem.add_variable(start.clone());
    for &datum in data {
        let (first, second) = matches.rays[datum];
        let covariance = transfer_covariance(&start.matrix(), &first, &matches.sigmas)?;
        let sqrt_information = inverse_root(&covariance)?;
        let factor = Transferred { transfer, first, second: second.xy(), sqrt_information };
        problem.add_factor(factor, Kernel::Squared).ok()?;
    }
    Some((problem, transfer))
}

/// A matrix W with Wᵀ W the inverse of a covariance.
fn inverse_root(covariance: &Matrix2<f64>) -> Option<Matrix2<f64>> {
    covariance.cholesky()?.l().try_inverse()
}

impl Correspondences for OnlyTurned<'_> {
    type Estimate = Rotation3<f64>;
    const SAMPLE: usize = 2;
    const DEGREES: usize = 2;
    const PARAMETERS: usize = 3;

    fn count(&self) -> usize {
        self.0.len()
    }

    fn through(&self, sample: &[usize], give: &mut dyn FnMut(Rotation3<f64>)) {
        let Ok(sample) = <&[usize; 2]>::try_from(sample) else { return };
        if let Some(rotation) = rotation_of_rays(&sample.map(|datum| self.0.rays[datum])) {
            give(rotation);
        }
    }

    fn squared_errors(
        &self,
        rotation: &Rotation3<f64>,
        _gate: f64,
    ) -> impl Fn(usize, usize) -> f64 {
        squared_errors(self.0, rotation.into_inner())
    }

    fn refined(
        &self,
        start: &Rotation3<f64>,
        data: &[usize],
        effort: Effort,
    ) -> Option<Rotation3<f64>> {
        let (problem, key) = problem(self.0, start, data)?;
        Some(problem.solve(&effort.options()).ok()?.values[key])
    }

    fn covariance(&self, rotation: &Rotation3<f64>, data: &[usize]) -> Option<DMatrix<f64>> {
        let (problem, key) = problem(self.0, rotation, data)?;
        problem.covariance(problem.values()).ok()?.of(key)
    }
}

impl Correspondences for OnePlane<'_> {
    type Estimate = Matrix3<f64>;
    const SAMPLE: usize = 4;
    const DEGREES: usize = 2;
    const PARAMETERS: usize = 8;

    fn count(&self) -> usize {
        self.0.len()
    }

    fn through(&self, sample: &[usize], give: &mut dyn FnMut(Matrix3<f64>)) {
        let Ok(sample) = <&[usize; 4]>::try_from(sample) else { return };
        if let Ok(plane) = homography_of_four(&sample.map(|datum| self.0.rays[datum])) {
            give(plane);
        }
    }

    fn squared_errors(&self, plane: &Matrix3<f64>, _gate: f64) -> impl Fn(usize, usize) -> f64 {
        squared_errors(self.0, *plane)
    }

    fn refined(
        &self,
        start: &Matrix3<f64>,
        data: &[usize],
        effort: Effort,
    ) -> Option<Matrix3<f64>> {
        let (problem, key) = self.problem(start, data)?;
        let solution = problem.solve(&effort.options()).ok()?;
        Some(solution.values[key].matrix().normalize())
    }

    /// Of all entries but the largest one, which is held.
    fn covariance(&self, plane: &Matrix3<f64>, data: &[usize]) -> Option<DMatrix<f64>> {
        let (problem, key) = self.problem(plane, data)?;
        problem.covariance(problem.values()).ok()?.of(key)
    }
}

impl OnePlane<'_> {
    /// The problem of a homography, of which the largest entry is held: the scale says nothing.
    fn problem(
        &self,
        start: &Matrix3<f64>,
        data: &[usize],
    ) -> Option<(Problem, Key<SVector<f64, 9>>)> {
        let entries = SVector::<f64, 9>::from_column_slice(start.as_slice());
        let (mut problem, key) = problem(self.0, &entries, data)?;
        let largest = entries.map(f64::abs).imax();
        problem.hold_coordinates(key, largest..largest + 1).ok()?;
        Some((problem, key))
    }
}
