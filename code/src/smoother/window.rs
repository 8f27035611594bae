//! What is in the window, and the variables of the problem that stand for it.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::{Isometry3, Vector1, Vector2, Vector3};

use crate::inertial::{Gravity, ImuBias, NavState};
use crate::least_squares::{Key, Manifold, Problem, ProblemError};

/// A picture whose state is in the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub serial: usize,
    pub nanoseconds: i64,
    pub state: Key<NavState>,
    pub bias: Key<ImuBias>,
    /// The body's angular velocity, in its frame, in rad/s.
    pub turning: Vector3<f64>,
}

/// A landmark in the window: the first and the last picture that showed it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub landmark: Key<Vector3<f64>>,
    pub last: usize,
}

/// A track that is no landmark yet: the pictures that showed it, and where.
pub(super) type Waiting = Vec<(usize, Vector2<f64>)>;

/// What is in the window.
#[derive(Debug)]
pub(super) struct Window {
    pub frames: VecDeque<Frame>,
    pub landmarks: BTreeMap<usize, Seen>,
    pub waiting: BTreeMap<usize, Waiting>,
    pub extrinsics: Key<Isometry3<f64>>,
    pub delay: Key<Vector1<f64>>,
    pub gravity: Key<Gravity>,
    states: Spare<NavState>,
    biases: Spare<ImuBias>,
    points: Spare<Vector3<f64>>,
}

/// Variables of a problem that stand for nothing at present.
#[derive(Debug)]
struct Spare<V>(Vec<Key<V>>);

impl<V: Manifold> Spare<V> {
    /// A variable with a value: one that was left, or a new one.
    fn take(&mut self, problem: &mut Problem, value: V) -> Result<Key<V>, ProblemError> {
        match self.0.pop() {
            Some(key) => problem.renew(key, value).map(|()| key),
            None => Ok(problem.add_variable(value)),
        }
    }
}

impl Window {
    pub fn new(problem: &mut Problem, extrinsics: Isometry3<f64>, gravity: Vector3<f64>) -> Self {
        Self {
            frames: VecDeque::new(),
            landmarks: BTreeMap::new(),
            waiting: BTreeMap::new(),
            extrinsics: problem.add_variable(extrinsics),
            delay: problem.add_variable(Vector1::zeros()),
            gravity: problem.add_variable(Gravity(gravity)),
            states: Spare(Vec::new()),
            biases: Spare(Vec::new()),
            points: Spare(Vec::new()),
        }
    }

    /// Adds a picture.
    pub fn add_frame(
        &mut self,
        problem: &mut Problem,
        (nanoseconds, turning): (i64, Vector3<f64>),
        (state, bias): (NavState, ImuBias),
    ) -> Result<Frame, ProblemError> {
        let serial = self.frames.back().map_or(0, |frame| frame.serial + 1);
        let state = self.states.take(problem, state)?;
        let bias = self.biases.take(problem, bias)?;
        let frame = Frame { serial, nanoseconds, state, bias, turning };
        self.frames.push_back(frame);
        Ok(frame)
    }

    /// Adds a landmark.
    pub fn add_landmark(
        &mut self,
        problem: &mut Problem,
        (track, last): (usize, usize),
        place: Vector3<f64>,
    ) -> Result<Key<Vector3<f64>>, ProblemError> {
        let landmark = self.points.take(problem, place)?;
        self.landmarks.insert(track, Seen { landmark, last });
        Ok(landmark)
    }

    /// The picture with a number.
    pub fn frame(&self, serial: usize) -> Option<&Frame> {
        let first = self.frames.front()?.serial;
        self.frames.get(serial.checked_sub(first)?)
    }

    /// Lets the oldest picture go, with the landmarks of these tracks and what waits of it.
    pub fn drop_first(&mut self, ended: &[usize]) {
        let Some(frame) = self.frames.pop_front() else { return };
        self.states.0.push(frame.state);
        self.biases.0.push(frame.bias);
        for track in ended {
            if let Some(seen) = self.landmarks.remove(track) {
                self.points.0.push(seen.landmark);
            }
        }
        for sightings in self.waiting.values_mut() {
            sightings.retain(|(serial, _)| *serial > frame.serial);
        }
        self.waiting.retain(|_, sightings| !sightings.is_empty());
    }
}
