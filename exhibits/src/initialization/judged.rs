//! How a start compares with the truth.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use vislam::filtering::{attitude_in_world, nees};
use vislam::inertial::NavState;
use vislam::initialization::Started;

/// The errors of a start in motion, and what it says of them.
pub struct Judged {
    /// Of the distance from the first state to the farthest one, as a part of it.
    pub scale: f64,
    /// The standard deviation that is reported of it.
    pub scale_sigma: f64,
    pub tilt: Tilt,
}

/// The error of a state's tilt: a turn about the horizontal axes of its world, in radians.
pub struct Tilt {
    pub error: Vector2<f64>,
    pub covariance: Matrix2<f64>,
}

impl Judged {
    /// Compares with the true states at the pictures that were given.
    pub fn of(started: &Started, truth: &[NavState]) -> Self {
        let states: Vec<NavState> =
            started.batch.states.iter().map(|key| started.values[*key]).collect();
        let truth: Vec<NavState> = started.pictures.iter().map(|at| truth[*at]).collect();
        let away =
            |states: &[NavState], at: usize| (states[at].position - states[0].position).norm();
        let farthest =
            (0..states.len()).max_by(|a, b| away(&states, *a).total_cmp(&away(&states, *b)));
        let farthest = farthest.expect("a batch has states");
        let covariance = started.covariance.of(started.batch.states[0]).expect("of a state");
        let turns = covariance.fixed_view::<3, 3>(0, 0).into_owned();
        Self {
            scale: away(&states, farthest) / away(&truth, farthest) - 1.0,
            scale_sigma: started.scale_sigma,
            tilt: Tilt::of(&states[0], &truth[0], &turns),
        }
    }
}

impl Tilt {
    /// That of an estimate with the covariance of its turns in the body. Its heading does not count.
    pub fn of(estimate: &NavState, truth: &NavState, turns: &Matrix3<f64>) -> Self {
        let [was, is] =
            [estimate, truth].map(|state| state.world_from_body.inverse() * Vector3::z());
        let turn = is.cross(&was);
        let size = turn.norm();
        let turn = if size > 0.0 { turn * (is.angle(&was) / size) } else { turn };
        let in_world = attitude_in_world(estimate, turns);
        Self {
            error: (estimate.world_from_body * turn).xy(),
            covariance: in_world.fixed_view::<2, 2>(0, 0).into_owned(),
        }
    }

    /// Its size, in degrees.
    pub fn degrees(&self) -> f64 {
        self.error.norm().to_degrees()
    }

    /// The root of the variances of both axes, in radians.
    pub fn sigma(&self) -> f64 {
        self.covariance.trace().sqrt()
    }

    /// The square of the normalized error, of two degrees of freedom.
    pub fn squared(&self) -> f64 {
        2.0 * nees(&self.error, &self.covariance).expect("a covariance")
    }
}
