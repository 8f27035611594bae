//! A motion between two pictures of a scene with depth.

use nalgebra::{Cholesky, DMatrix, Matrix3, SMatrix};

use super::consensus::{
    Consensus, ConsensusError, ConsensusOptions, Correspondences, Effort, consensus,
};
use super::five_point::{depth_signs, motions_of_five};
use super::{Matches, RelativeMotion};
use crate::factors::Epipolar;
use crate::least_squares::{Factor, Kernel, Key, Problem};

// ANCHOR: general_motion
/// Matches as data about a [`RelativeMotion`]: points at any depths, seen from two places.
#[derive(Debug, Clone, Copy)]
pub struct GeneralMotion<'a>(pub &'a Matches);

impl Correspondences for GeneralMotion<'_> {
    type Estimate = RelativeMotion;
    const SAMPLE: usize = 5;
    const DEGREES: usize = 1;
    const PARAMETERS: usize = 5;

    fn count(&self) -> usize {
        self.0.len()
    }

    fn through(&self, sample: &[usize], give: &mut dyn FnMut(RelativeMotion)) {
        let Ok(sample) = <&[usize; 5]>::try_from(sample) else { return };
        if let Ok(motions) = motions_of_five(&sample.map(|datum| self.0.rays[datum])) {
            motions.iter().copied().for_each(give);
        }
    }
    // ANCHOR_END: general_motion

    // ANCHOR: epipolar_error
    /// The square of the Sampson distance {eq:epipolar-square}; infinite for two rays that meet behind a camera by more
    /// than their noise.
    fn squared_errors(&self, motion: &RelativeMotion, gate: f64) -> impl Fn(usize, usize) -> f64 {
        let Matches { rays, scaled, sigmas } = self.0;
        let [first, second] = sigmas.map(|sigma| Matrix3::from_diagonal(&sigma.push(1.0)));
        let f = second * motion.essential() * first;
        let motion = *motion;
        let noise = gate * sigmas.iter().map(|sigma| sigma.norm_squared()).sum::<f64>();
        move |here, there| {
            let ([x, y, ..], [.., u, v]) = (scaled[here], scaled[there]);
            let (a, b) = (f.m11 * x + f.m12 * y + f.m13, f.m21 * x + f.m22 * y + f.m23);
            let (c, d) = (f.m11 * u + f.m21 * v + f.m31, f.m12 * u + f.m22 * v + f.m32);
            let volume = u * a + v * b + f.m31 * x + f.m32 * y + f.m33;
            let (square, variance) = (volume * volume, a * a + b * b + c * c + d * d);
            let is_near = square <= gate * variance;
            if !is_near {
                return f64::INFINITY;
            }
            let pair = (rays[here].0, rays[there].1);
            let (near, far) = depth_signs(&motion, &pair);
            if near.min(far) < 0.0 && !is_parallel(&motion, &pair, noise) {
                return f64::INFINITY;
            }
            square / variance
        }
    }
    // ANCHOR_END: epipolar_error

    fn refined(
        &self,
        start: &RelativeMotion,
        data: &[usize],
        effort: Effort,
    ) -> Option<RelativeMotion> {
        let (problem, key) = self.problem(start, data)?;
        Some(problem.solve(&effort.options()).ok()?.values[key])
    }

    fn covariance(&self, motion: &RelativeMotion, data: &[usize]) -> Option<DMatrix<f64>> {
        let (problem, key) = self.problem(motion, data)?;
        problem.covariance(problem.values()).ok()?.of(key)
    }

    // ANCHOR: leverages
    /// A wrong match that fits its line by accident seems near, and what is near turns the baseline.
    fn leverages(&self, motion: &RelativeMotion, data: &[usize]) -> Option<Vec<f64>> {
        let key = Problem::new().add_variable(*motion);
        let row = |datum: &usize| {
            let (first, second) = self.0.rays[*datum];
            let factor = Epipolar { motion: key, first, second, sigmas: self.0.sigmas };
            factor.linearize((motion,)).map(|(_, (row,))| row)
        };
        let rows: Vec<SMatrix<f64, 1, 5>> = data.iter().map(row).collect::<Option<_>>()?;
        let information: SMatrix<f64, 5, 5> = rows.iter().map(|row| row.tr_mul(row)).sum();
        let factor = Cholesky::new(information)?;
        Some(rows.iter().map(|row| row.tr_dot(&factor.solve(&row.transpose()))).collect())
    }
    // ANCHOR_END: leverages
}

// ANCHOR: general_motion_of
/// The motion between two pictures of a scene with depth, whatever the scene is: a plane or a turn
/// is not told from it, as [`motion_of_matches`](super::motion_of_matches) does.
///
/// # Errors
///
/// Those of [`consensus`].
pub fn general_motion(
    matches: &Matches,
    options: &ConsensusOptions,
) -> Result<Consensus<RelativeMotion>, ConsensusError> {
    consensus(&GeneralMotion(matches), options)
}
// ANCHOR_END: general_motion_of

/// Whether the rays of a point are parallel as far as their noise allows: the squared sine of the
/// angle between them is below `noise`.
fn is_parallel(motion: &RelativeMotion, (first, second): &super::RayPair, noise: f64) -> bool {
    let sine = (motion.rotation * first).cross(second).norm_squared();
    sine <= noise * first.norm_squared() * second.norm_squared()
}

impl GeneralMotion<'_> {
    /// The least-squares problem of some matches.
    fn problem(
        &self,
        start: &RelativeMotion,
        data: &[usize],
    ) -> Option<(Problem, Key<RelativeMotion>)> {
        let mut problem = Problem::new();
        let motion = problem.add_variable(*start);
        for &datum in data {
            let (first, second) = self.0.rays[datum];
            let factor = Epipolar { motion, first, second, sigmas: self.0.sigmas };
            problem.add_factor(factor, Kernel::Squared).ok()?;
        }
        Some((problem, motion))
    }
}
