//! The smoother: readings and pictures come in, the window is solved, the oldest leaves.

use std::fmt;

use nalgebra::{DMatrix, DVector, Vector3};

use super::window::{Frame, Window};
use super::{SmootherError, SmootherOptions};
use crate::datasets::tracks::Picture;
use crate::factors::CombinedInertialFactor;
use crate::inertial::{CameraImu, ImuBias, NavState, StampedSample, between};
use crate::initialization::{Sensors, calibrate};
use crate::least_squares::{Fronts, Kernel, LinearPrior, Problem, Search, sqrt_information};
use crate::msckf::Start;
use crate::preintegration::{CombinedPreintegrated, Matrix15, preintegrate_combined};

/// A fixed-lag smoother.
pub struct Smoother {
    pub(super) options: SmootherOptions,
    pub(super) problem: Problem,
    pub(super) window: Window,
    /// From the last keyframe on.
    pub(super) readings: Vec<StampedSample>,
    covariance: Matrix15,
    /// The search of the last picture, whose memory the next one takes.
    search: Option<Search<Fronts>>,
}

impl fmt::Debug for Smoother {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Smoother")
            .field("options", &self.options)
            .field("window", &self.window)
            .field("readings", &self.readings.len())
            .finish_non_exhaustive()
    }
}

/// What a picture led to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Smoothed {
    /// Steps that were tried.
    pub iterations: usize,
    /// Landmarks in the window.
    pub landmarks: usize,
    /// Pixels of this picture that were used, of landmarks known before it.
    pub pixels: usize,
    /// Pixels that are too far off, or not finite.
    pub gated: usize,
    /// How many columns the widest front has.
    pub widest: usize,
    /// States in the window.
    pub states: usize,
    /// Whether the picture is a keyframe. If not, it leaves when the next one comes.
    pub is_keyframe: bool,
    /// Pixels of the picture before that left with it, because it was no keyframe.
    pub dropped: usize,
}

impl Smoother {
    /// A smoother that begins with this. Of the rig that of the options' sensors counts, not that of the
    /// start.
    ///
    /// # Errors
    ///
    /// A [`SmootherError`] when the covariance is none.
    pub fn new(options: SmootherOptions, start: &Start) -> Result<Self, SmootherError> {
        let mut problem = Problem::new();
        let Sensors { rig, .. } = options.sensors;
        let mut window = Window::new(&mut problem, rig.body_from_camera, options.sensors.gravity());
        problem.hold(window.gravity)?;
        calibrate(&mut problem, (window.extrinsics, window.delay), &options.sensors)?;
        let begin = (start.nanoseconds, Vector3::zeros(), true);
        let Frame { state, bias, .. } =
            window.add_frame(&mut problem, begin, (start.state, start.bias))?;
        let root = sqrt_information(&start.covariance)?;
        let root = DMatrix::from_fn(15, 15, |row, column| root[(row, column)]);
        let variables = [state.index(), bias.index()];
        let known = LinearPrior::of_root(problem.values(), &variables, root, DVector::zeros(15))?;
        problem.add_prior(known)?;
        let covariance = start.covariance;
        Ok(Self { options, problem, window, readings: Vec::new(), covariance, search: None })
    }

    /// Takes a reading.
    ///
    /// # Errors
    ///
    /// [`SmootherError::LateReading`] when it is not later than the last one,
    /// [`SmootherError::Reading`] when it is not finite.
    pub fn reading(&mut self, reading: StampedSample) -> Result<(), SmootherError> {
        let nanoseconds = reading.nanoseconds;
        if !reading.sample.is_finite() {
            return Err(SmootherError::Reading { nanoseconds });
        }
        match self.readings.last().map(|last| last.nanoseconds) {
            Some(last) if last >= nanoseconds => {
                Err(SmootherError::LateReading { nanoseconds, last })
            }
            _ => {
                self.readings.push(reading);
                Ok(())
            }
        }
    }

    // ANCHOR: picture
    /// Takes the tracks of a picture, when the readings reach its time.
    ///
    /// # Errors
    ///
    /// A [`SmootherError`].
    pub fn picture(&mut self, picture: &Picture) -> Result<Smoothed, SmootherError> {
        let time = self.options.sensors.rig.imu_nanoseconds(picture.nanoseconds);
        let mut smoothed =
            Smoothed { is_keyframe: self.is_keyframe(time, picture), ..Smoothed::default() };
        let frame = self.carry_to(time, &mut smoothed)?;
        self.see(&frame, picture, &mut smoothed)?;
        if frame.is_keyframe {
            self.place_landmarks(&frame)?;
        }
        self.solve(&mut smoothed)?;
        if frame.is_keyframe {
            self.keep(picture)?;
        }
        smoothed.landmarks = self.window.landmarks.len();
        smoothed.states = self.window.frames.len();
        Ok(smoothed)
    }
    // ANCHOR_END: picture

    // ANCHOR: carry_to
    /// Adds the state at a time, where the readings lead from the last keyframe.
    fn carry_to(
        &mut self,
        nanoseconds: i64,
        smoothed: &mut Smoothed,
    ) -> Result<Frame, SmootherError> {
        let newest = self.newest().nanoseconds;
        if nanoseconds <= newest {
            return Err(SmootherError::LatePicture { nanoseconds, last: newest });
        }
        let last = self.last_keyframe();
        let values = self.problem.values();
        let (state, bias) = (values[last.state], values[last.bias]);
        let readings = between(&self.readings, last.nanoseconds, nanoseconds)?;
        let sensors = &self.options.sensors;
        let sums = preintegrate_combined(&readings, &bias, &sensors.noise)?;
        let next = sums.sums.predict(&state, &sensors.gravity(), &bias);
        let turning = readings.last().map_or(Vector3::zeros(), |r| r.sample.corrected(&bias).gyro);
        smoothed.dropped = self.let_pass();
        let begin = (nanoseconds, turning, smoothed.is_keyframe);
        let frame = self.window.add_frame(&mut self.problem, begin, (next, bias))?;
        self.add_readings(&last, &frame, &sums)?;
        Ok(frame)
    }
    // ANCHOR_END: carry_to

    fn add_readings(
        &mut self,
        last: &Frame,
        frame: &Frame,
        sums: &CombinedPreintegrated,
    ) -> Result<(), SmootherError> {
        let (states, biases) = ([last.state, frame.state], [last.bias, frame.bias]);
        let factor = CombinedInertialFactor::new(states, biases, self.window.gravity, sums)?;
        self.problem.add_factor(factor, Kernel::Squared)?;
        Ok(())
    }

    pub(super) fn newest(&self) -> Frame {
        self.window.frames[self.window.frames.len() - 1]
    }

    /// The newest picture, or the one before if that does not stay. The first one does.
    pub(super) fn last_keyframe(&self) -> Frame {
        let newest = self.newest();
        let before = self.window.frames.len().saturating_sub(2);
        if newest.is_keyframe { newest } else { self.window.frames[before] }
    }

    // ANCHOR: solve
    /// Goes towards the minimum of the window, and notes how sure the newest state is.
    fn solve(&mut self, smoothed: &mut Smoothed) -> Result<(), SmootherError> {
        let search = self.searched()?;
        let (search, problem) = (self.search.insert(search), &self.problem);
        while search.iterate(problem)?.is_none() {}
        smoothed.widest = search.system().widest();
        smoothed.iterations = search.iterations().len();
        let newest = self.window.frames[self.window.frames.len() - 1];
        let newest = [newest.state.index(), newest.bias.index()];
        let covariance = search.system_mut().covariance_of(problem, &newest);
        let covariance = covariance.filter(|matrix| matrix.shape() == (15, 15));
        self.covariance = covariance
            .map_or(Matrix15::repeat(f64::NAN), |m| Matrix15::from_column_slice(m.as_slice()));
        let values = search.values().clone();
        self.problem.set_values(values)?;
        Ok(())
    }
    // ANCHOR_END: solve

    /// A search from where the window stands, in the memory of the last one.
    fn searched(&mut self) -> Result<Search<Fronts>, SmootherError> {
        let order = self.order()?;
        let problem = &self.problem;
        Ok(match self.search.take() {
            Some(mut search) => {
                search.begin_again(problem, |fronts| fronts.arrange(problem, &order))?;
                search
            }
            None => {
                let fronts = Fronts::in_order(problem, &order)?;
                Search::new(problem, fronts, &self.options.search())?.without_end()
            }
        })
    }

    /// The 15×15 covariance of the errors of the newest state and its biases, as of the last
    /// linearization. No numbers where rounding has lost what is known of its place.
    pub fn covariance(&self) -> &Matrix15 {
        &self.covariance
    }

    /// The newest state that is at least so many seconds older than the newest one, or the oldest
    /// in the window.
    pub fn ago(&self, seconds: f64) -> (i64, NavState, ImuBias) {
        let until = self.newest().nanoseconds.saturating_sub((1e9 * seconds) as i64);
        let older = self.window.frames.iter().rev().find(|frame| frame.nanoseconds <= until);
        self.at(older.unwrap_or(&self.window.frames[0]))
    }

    /// The newest state and its biases, with their time on the sensor's clock.
    pub fn state(&self) -> (i64, NavState, ImuBias) {
        self.at(&self.newest())
    }

    /// The time of the last reading, in nanoseconds.
    pub fn last_reading(&self) -> Option<i64> {
        self.readings.last().map(|reading| reading.nanoseconds)
    }

    /// The tracks that are landmarks of the window.
    pub fn landmarks(&self) -> impl Iterator<Item = usize> {
        self.window.landmarks.keys().copied()
    }

    /// The states of the window from the oldest to the newest, and their times on the sensor's clock.
    pub fn states(&self) -> impl Iterator<Item = (i64, NavState)> {
        let values = self.problem.values();
        self.window.frames.iter().map(|frame| (frame.nanoseconds, values[frame.state]))
    }

    /// The tracks that are landmarks of the window, and where in the world those are, in metres. A
    /// landmark that is no nearer than infinity is at no place, and left out.
    pub fn points(&self) -> impl Iterator<Item = (usize, Vector3<f64>)> {
        let landmarks = self.window.landmarks.iter();
        landmarks.filter_map(|(track, seen)| Some((*track, self.in_world(seen)?)))
    }

    /// Where the camera is on the body and what to add to a time of its clock, as it is known or estimated.
    pub fn rig(&self) -> CameraImu {
        let (values, known) = (self.problem.values(), &self.options.sensors.rig);
        let time_offset = known.time_offset + values[self.window.delay].x;
        CameraImu { body_from_camera: values[self.window.extrinsics], time_offset }
    }

    /// How many variables the window has had room for so far.
    pub fn variables(&self) -> usize {
        self.problem.values().len()
    }

    /// The oldest state in the window.
    pub fn oldest(&self) -> (i64, NavState, ImuBias) {
        self.at(&self.window.frames[0])
    }

    fn at(&self, frame: &Frame) -> (i64, NavState, ImuBias) {
        let values = self.problem.values();
        (frame.nanoseconds, values[frame.state], values[frame.bias])
    }
}
