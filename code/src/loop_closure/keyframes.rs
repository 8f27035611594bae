//! What a filter, and what a pair of stereo pictures, says of one keyframe as seen from another.

use nalgebra::{DMatrix, Isometry3, Matrix3, Matrix6, SMatrix, Vector3};

use super::{LoopClosureError, RelativeMeasurement};
use crate::factors::StereoByPose;
use crate::filtering::Belief;
use crate::inertial::BodyPose;
use crate::least_squares::{Fronts, Kernel, Key, Options, Problem};
use crate::manifold::se3;
use crate::two_views::{StereoFactor, StereoPinhole};

type Measurement = RelativeMeasurement<Isometry3<f64>, 6>;

impl Measurement {
    /// The second of two poses as seen from the first one, as a filter believes it that has both. Their
    /// errors have much in common, which is no error of how they stand to each other. Implements
    /// {eq:loop-covariance}.
    ///
    /// # Errors
    ///
    /// [`LoopClosureError::Unsure`] when the belief lacks a pose, or the covariance has no inverse.
    // ANCHOR: believed
    pub fn believed(
        belief: &Belief,
        [from, to]: [Key<BodyPose>; 2],
        numbers: [usize; 2],
    ) -> Result<Self, LoopClosureError> {
        let values = belief.values();
        let known = |key: Key<BodyPose>| values.key::<BodyPose>(key.index());
        let (Some(from), Some(to)) = (known(from), known(to)) else { return Err(unsure(numbers)) };
        let (from_pose, to_pose) = (&values[from], &values[to]);
        let own = |key: Key<BodyPose>| values.coordinates_of(key.index()).unwrap_or_default();
        let both: Vec<usize> = own(from).chain(own(to)).collect();
        let covariance = belief.covariance().select_rows(&both).select_columns(&both);
        let measured = from_pose.at_rest().pose().inv_mul(&to_pose.at_rest().pose());
        let mut by_both = DMatrix::zeros(6, 12);
        let by_from = -se3::adjoint(&measured.inverse()) * twist_by_step(from_pose);
        by_both.view_mut((0, 0), (6, 6)).copy_from(&by_from);
        by_both.view_mut((0, 6), (6, 6)).copy_from(&twist_by_step(to_pose));
        let covariance: SMatrix<f64, 6, 6> =
            (&by_both * covariance * by_both.transpose()).fixed_view::<6, 6>(0, 0).into();
        Self::with_covariance(numbers, measured, &covariance)
    }
    // ANCHOR_END: believed

    // ANCHOR: from_stereo
    /// The second of two poses as seen from the first one, by what a stereo camera saw of the same
    /// landmarks from both: column on the left, row, column on the right. The two poses and all
    /// landmarks are estimated from these pixels alone: an odometry that used them shares their
    /// errors. It begins where both poses are the same, and wants them near each other.
    ///
    /// # Errors
    ///
    /// [`LoopClosureError::Unsure`] when the pixels leave a direction open, [`LoopClosureError::Stereo`]
    /// when a sight has a NaN or `sigma` is none, and those of the solver, also when no sight is near
    /// enough.
    pub fn from_stereo(
        pixels: StereoPixels,
        body_from_camera: &Isometry3<f64>,
        sights: &[[Vector3<f64>; 2]],
        numbers: [usize; 2],
    ) -> Result<Self, LoopClosureError> {
        let (problem, second) = stereo_problem(pixels, sights)?;
        let fronts = Fronts::new(&problem)?;
        let options = Options { max_iterations: MOST_STEPS, ..Options::default() };
        let solution = problem.solve_with(fronts.clone(), &options)?.settled()?;
        let covariance = problem.covariance_with(fronts, &solution.values);
        let covariance = covariance.map_err(|_| unsure(numbers))?.of(second);
        let covariance = covariance.ok_or_else(|| unsure(numbers))?;
        let first_from_second = solution.values[second].inverse();
        let measured = body_from_camera * first_from_second * body_from_camera.inverse();
        // A step of the second camera is one on the side of the first, and the other way round.
        let by_step = se3::adjoint(&(measured.inverse() * body_from_camera));
        let covariance = by_step * covariance.fixed_view::<6, 6>(0, 0) * by_step.transpose();
        Self::with_covariance(numbers, measured, &covariance)
    }
    // ANCHOR_END: from_stereo

    fn with_covariance(
        [first, second]: [usize; 2],
        measured: Isometry3<f64>,
        covariance: &Matrix6<f64>,
    ) -> Result<Self, LoopClosureError> {
        let symmetric = 0.5 * (covariance + covariance.transpose());
        let factor = symmetric.cholesky().ok_or_else(|| unsure([first, second]))?;
        let information = factor.inverse();
        let information = 0.5 * (information + information.transpose());
        Ok(Self { first, second, measured, information })
    }
}

/// Where some landmarks have a disparity of a few standard deviations alone, a step is nine tenths of the
/// last, and hundreds can be needed.
const MOST_STEPS: usize = 1000;

/// What is known of the pixels of a stereo camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StereoPixels {
    /// The camera.
    pub camera: StereoPinhole,
    /// The standard deviation of each of the three numbers of a sight, in pixels.
    pub sigma: f64,
    /// Landmarks of less disparity than this in either sight are left out, in pixels: they are too far
    /// away to have a depth.
    pub least_disparity: f64,
}

// ANCHOR: stereo_problem
/// Two cameras, the first of them held, and the landmarks that both saw. The variable of the second.
fn stereo_problem(
    StereoPixels { camera, sigma, least_disparity }: StereoPixels,
    sights: &[[Vector3<f64>; 2]],
) -> Result<(Problem, Key<Isometry3<f64>>), LoopClosureError> {
    let mut problem = Problem::new();
    let [first, second] = [(); 2].map(|()| problem.add_variable(Isometry3::identity()));
    problem.hold(first)?;
    let is_near = |(_, sight): &(usize, &[Vector3<f64>; 2])| {
        let is_far =
            |seen: &Vector3<f64>| least_disparity.is_nan() || seen.x - seen.z < least_disparity;
        !sight.iter().any(is_far)
    };
    for (point, sight) in sights.iter().enumerate().filter(is_near) {
        let seen_by = |keyframe: usize| StereoFactor::new(keyframe, point, sight[keyframe], sigma);
        let observed = [seen_by(0)?, seen_by(1)?];
        let Some(place) = camera.point(&sight[0]) else { continue };
        let landmark = problem.add_variable(place);
        for (pose, observed) in [first, second].into_iter().zip(observed) {
            let factor = StereoByPose { pose, landmark, camera, observed };
            problem.add_factor(factor, Kernel::Squared)?;
        }
    }
    Ok((problem, second))
}
// ANCHOR_END: stereo_problem

/// The twist of `world_from_body`, translation first, of a step (φ, p) of a pose.
fn twist_by_step(pose: &BodyPose) -> Matrix6<f64> {
    let mut twist = Matrix6::zeros();
    twist.fixed_view_mut::<3, 3>(0, 3).copy_from(&pose.world_from_body.matrix().transpose());
    twist.fixed_view_mut::<3, 3>(3, 0).copy_from(&Matrix3::identity());
    twist
}

fn unsure([first, second]: [usize; 2]) -> LoopClosureError {
    LoopClosureError::Unsure { first, second }
}
