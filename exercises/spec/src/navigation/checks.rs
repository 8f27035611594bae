//! States and readings for checks.

use nalgebra::Vector3;
use vislam::inertial::{ImuBias, NavState};
use vislam::manifold::so3;
use vislam::preintegration::{self, Matrix9, Matrix9x6, Preintegrated};

use super::{Deltas, State};
use crate::check::Failure;
use crate::draw::Draw;

impl State {
    /// The library's state with these numbers.
    pub fn nav(&self) -> NavState {
        let Self { world_from_body, velocity, position } = *self;
        NavState { world_from_body, velocity, position }
    }

    /// The state of the library's.
    pub fn of(state: &NavState) -> Self {
        let NavState { world_from_body, velocity, position } = *state;
        Self { world_from_body, velocity, position }
    }

    /// A state that is turned, moves, and is away from the origin.
    pub(crate) fn drawn(draw: &mut Draw) -> Self {
        Self {
            world_from_body: draw.rotation(0.5..2.5),
            velocity: draw.vector(1.0..6.0),
            position: draw.vector(3.0..12.0),
        }
    }
}

impl Deltas {
    /// The library's sums with these numbers, at a bias of zero and without a covariance.
    pub fn preintegrated(&self) -> Preintegrated {
        let Self { duration, rotation, velocity, position } = *self;
        Preintegrated {
            duration,
            steps: 1,
            deltas: preintegration::Deltas { rotation, velocity, position },
            covariance: Matrix9::zeros(),
            bias_jacobian: Matrix9x6::zeros(),
            bias: ImuBias::default(),
            greatest_force: 0.0,
        }
    }

    /// Any deltas of an interval as long as a number of the range.
    pub(crate) fn drawn(draw: &mut Draw, duration: [f64; 2]) -> Self {
        Self {
            duration: draw.uniform(duration[0]..duration[1]),
            rotation: draw.rotation(0.4..2.0),
            velocity: draw.vector(2.0..9.0),
            position: draw.vector(1.0..8.0),
        }
    }

    /// The state to which they lead.
    pub fn lead(&self, first: &State, gravity: &Vector3<f64>) -> State {
        let sums = self.preintegrated();
        State::of(&sums.predict(&first.nav(), gravity, &ImuBias::default()))
    }
}

/// A failure with readings and the two states that they join; rotations by their logarithms.
pub(crate) fn given(
    failure: Failure,
    deltas: &Deltas,
    states: [&State; 2],
    gravity: &Vector3<f64>,
) -> Failure {
    let [first, second] = states;
    let rotations = [deltas.rotation, first.world_from_body, second.world_from_body];
    let [delta, before, after] = rotations.map(|rotation| so3::log(&rotation));
    failure.given(&[
        ("deltas.duration", &deltas.duration),
        ("log of deltas.rotation", &delta.as_slice()),
        ("deltas.velocity", &deltas.velocity.as_slice()),
        ("deltas.position", &deltas.position.as_slice()),
        ("log of first.world_from_body", &before.as_slice()),
        ("first.velocity", &first.velocity.as_slice()),
        ("first.position", &first.position.as_slice()),
        ("log of second.world_from_body", &after.as_slice()),
        ("second.velocity", &second.velocity.as_slice()),
        ("second.position", &second.position.as_slice()),
        ("gravity", &gravity.as_slice()),
    ])
}
