//! What is in the window, and the variables of the problem that stand for it.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::{Isometry3, Vector1, Vector3};

use crate::datasets::tracks::Feature;
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
    /// Whether it stays when the next one comes.
    pub is_keyframe: bool,
}

/// A landmark in the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub landmark: Key<Vector3<f64>>,
    /// The picture in whose camera it is known, unless it is a point of the world.
    pub anchor: Option<usize>,
    /// The last keyframe that showed it.
    pub last: usize,
}

/// A track that is no landmark yet: the pictures that showed it, and where.
pub(super) type Waiting = Vec<(usize, Feature)>;

/// What is in the window.
#[derive(Debug)]
pub(super) struct Window {
    pub frames: VecDeque<Frame>,
    pub landmarks: BTreeMap<usize, Seen>,
    pub waiting: BTreeMap<usize, Waiting>,
    /// What the last keyframe showed.
    pub shown: Vec<Feature>,
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
            shown: Vec::new(),
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
        (nanoseconds, turning, is_keyframe): (i64, Vector3<f64>, bool),
        (state, bias): (NavState, ImuBias),
    ) -> Result<Frame, ProblemError> {
        let serial = self.frames.back().map_or(0, |frame| frame.serial + 1);
        let state = self.states.take(problem, state)?;
        let bias = self.biases.take(problem, bias)?;
        let frame = Frame { serial, nanoseconds, state, bias, turning, is_keyframe };
        self.frames.push_back(frame);
        Ok(frame)
    }

    /// Adds a landmark.
    pub fn add_landmark(
        &mut self,
        problem: &mut Problem,
        (track, anchor, last): (usize, Option<usize>, usize),
        place: Vector3<f64>,
    ) -> Result<Seen, ProblemError> {
        let landmark = self.points.take(problem, place)?;
        let seen = Seen { landmark, anchor, last };
        self.landmarks.insert(track, seen);
        Ok(seen)
    }

    /// The picture with a number.
    pub fn frame(&self, serial: usize) -> Option<&Frame> {
        let first = self.frames.front()?.serial;
        self.frames.get(serial.checked_sub(first)?)
    }

    /// Lets the oldest picture go, with the landmarks of these tracks, others that have a new anchor, and
    /// what waits of it.
    pub fn drop_first(&mut self, ended: &[usize], old: &[Key<Vector3<f64>>]) {
        let Some(frame) = self.frames.pop_front() else { return };
        self.points.0.extend(old);
        self.states.0.push(frame.state);
        self.biases.0.push(frame.bias);
        for track in ended {
            if let Some(seen) = self.landmarks.remove(track) {
                self.points.0.push(seen.landmark);
            }
        }
        self.retain_waiting(|serial| serial > frame.serial);
    }

    /// Lets the newest picture go, with what waits of it.
    pub fn drop_last(&mut self) {
        let Some(frame) = self.frames.pop_back() else { return };
        self.states.0.push(frame.state);
        self.biases.0.push(frame.bias);
        self.retain_waiting(|serial| serial < frame.serial);
    }

    /// Keeps what waits of some pictures.
    fn retain_waiting(&mut self, keeps: impl Fn(usize) -> bool) {
        for sightings in self.waiting.values_mut() {
            sightings.retain(|(serial, _)| keeps(*serial));
        }
        self.waiting.retain(|_, sightings| !sightings.is_empty());
    }
}
