//! How far an estimate is from the truth.

use vislam::datasets::euroc::{GroundTruth, truth_at};
use vislam::filtering::{
    Freedom, StateError, absolute_trajectory_error, pairs_by_time, relative_pose_errors,
};
use vislam::inertial::NavState;

use super::estimate::{Estimate, Trajectory};

/// The lengths of time over which poses are compared, in seconds.
const INTERVALS: [f64; 3] = [1.0, 5.0, 10.0];
/// Each so manieth state is the first of a pair.
const STRIDE: usize = 5;

/// Roots of mean squares, in metres; NaN where there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Of positions after alignment in four degrees of freedom: of each state when it was the newest,
    /// and when it was two seconds old.
    pub online: [f64; 2],
    /// Of positions after alignment in four and in six degrees of freedom.
    pub absolute: [f64; 2],
    /// Of the position of a pose in an earlier one, over [`INTERVALS`].
    pub relative: [f64; 3],
}

impl Judged {
    pub fn unknown() -> Self {
        Self { online: [f64::NAN; 2], absolute: [f64::NAN; 2], relative: [f64::NAN; 3] }
    }

    /// At the states for whose times the truth says something.
    pub fn of(estimate: &Estimate, truth: &[GroundTruth]) -> Self {
        let whole: Trajectory =
            estimate.nanoseconds.iter().copied().zip(estimate.states.iter().copied()).collect();
        let (times, states, true_states) = known(&whole, truth);
        if states.len() < whole.len() {
            let all = whole.len();
            println!("{} of {all} states have a truth to be compared with", states.len());
        }
        let online = [&estimate.causal, &estimate.delayed].map(|trajectory| {
            let (_, states, truth) = known(trajectory, truth);
            absolute(&states, &truth, Freedom::Four)
        });
        Self {
            online,
            absolute: [Freedom::Four, Freedom::Six]
                .map(|freedom| absolute(&states, &true_states, freedom)),
            relative: INTERVALS.map(|seconds| relative(&times, &states, &true_states, seconds)),
        }
    }
}

/// The states for whose times the truth says something, in seconds after the first one, and the truth.
fn known(
    trajectory: &Trajectory,
    truth: &[GroundTruth],
) -> (Vec<f64>, Vec<NavState>, Vec<NavState>) {
    let (mut times, mut states, mut true_states) = (Vec::new(), Vec::new(), Vec::new());
    for (time, state) in trajectory {
        let Some(truth) = truth_at(truth, *time) else { continue };
        times.push(1e-9 * (time - trajectory[0].0) as f64);
        states.push(*state);
        true_states.push(truth.state);
    }
    (times, states, true_states)
}

fn absolute(states: &[NavState], truth: &[NavState], freedom: Freedom) -> f64 {
    let error = absolute_trajectory_error(states, truth, freedom);
    error.map_or(f64::NAN, |error| error.position)
}

/// The error of the position of a pose in one that is so many seconds earlier: that of the later one when
/// the first ones are laid upon each other. The later one is the nearest in time.
fn relative(times: &[f64], states: &[NavState], truth: &[NavState], seconds: f64) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let half = steps.len() / 2;
    if steps.is_empty() {
        return f64::NAN;
    }
    let step = *steps.select_nth_unstable_by(half, f64::total_cmp).1;
    let Ok(pairs) = pairs_by_time(times, seconds - 0.5 * step) else { return f64::NAN };
    let is_as_long =
        |&(first, last): &(usize, usize)| (times[last] - times[first] - seconds).abs() < step;
    let pairs: Vec<_> = pairs.into_iter().step_by(STRIDE).filter(is_as_long).collect();
    let errors = relative_pose_errors(states, truth, &pairs, Freedom::Six).unwrap_or_default();
    let squares = errors.iter().map(|StateError { position, .. }| position.norm_squared());
    (squares.sum::<f64>() / errors.len() as f64).sqrt()
}
