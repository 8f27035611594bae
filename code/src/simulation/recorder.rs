//! The sensors of a flight at work.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;

use super::flight::nanoseconds;
use super::random::{Purpose, normal, random};
use super::tracker::Tracker;
use super::{Flight, FlightError, FlightRecording, Kinematics, Truth};
use crate::datasets::tracks::Picture;
use crate::inertial::{ImuBias, NavState, StampedSample};

impl Flight {
    // ANCHOR: record
    /// What the sensors bring home from a flight among these landmarks. The same seed makes the same
    /// recording. Readings, biases, pixels and outliers have random numbers of their own: outliers,
    /// a gap, a second camera or fewer tracks leave everything else as it is.
    ///
    /// # Errors
    ///
    /// A [`FlightError`] names the number that can be none of a flight.
    pub fn record(
        &self,
        landmarks: &[Vector3<f64>],
        seed: u64,
    ) -> Result<FlightRecording, FlightError> {
        let mut recorder = Recorder::new(self, landmarks, seed)?;
        while recorder.picture()? {}
        Ok(recorder.recording)
    }
    // ANCHOR_END: record

    /// The motion at a time.
    pub(super) fn at(&self, nanoseconds: i64) -> Result<Kinematics, FlightError> {
        let seconds = nanoseconds as f64 / 1e9;
        let kinematics = self.motion.at(seconds);
        let NavState { velocity, position, .. } = kinematics.state;
        let finite = kinematics.sample(&self.gravity).is_finite()
            && velocity.iter().chain(&position).all(|number| number.is_finite());
        if finite { Ok(kinematics) } else { Err(FlightError::Motion { seconds }) }
    }

    /// Whether the reading at a time is lost.
    fn loses(&self, nanoseconds: i64) -> bool {
        let seconds = nanoseconds as f64 / 1e9;
        self.gap.is_some_and(|[from, to]| (from..to).contains(&seconds))
    }
}

/// A flight under way, for whoever does not want to wait until it has landed.
#[derive(Debug, Clone)]
pub struct Recorder {
    recording: FlightRecording,
    tracker: Tracker,
    /// The time of each reading, those that are lost included, and the biases then.
    walk: Vec<(i64, ImuBias)>,
    biases: ChaCha8Rng,
    readings: ChaCha8Rng,
}

impl Recorder {
    /// A flight among these landmarks that is about to begin; see [`Flight::record`].
    ///
    /// # Errors
    ///
    /// A [`FlightError`] names the number that can be none of a flight.
    pub fn new(
        flight: &Flight,
        landmarks: &[Vector3<f64>],
        seed: u64,
    ) -> Result<Self, FlightError> {
        flight.check()?;
        let truth = Truth { landmarks: landmarks.to_vec(), ..Truth::default() };
        let (readings, pictures) = (Vec::new(), Vec::new());
        let [biases, noise] =
            [Purpose::Biases, Purpose::Readings].map(|purpose| random(seed, purpose));
        Ok(Self {
            recording: FlightRecording { flight: flight.clone(), readings, pictures, truth },
            tracker: Tracker::new(landmarks.len(), seed),
            walk: Vec::new(),
            biases,
            readings: noise,
        })
    }

    /// What there is until now.
    pub fn recording(&self) -> &FlightRecording {
        &self.recording
    }

    /// Takes the next picture, and the readings that reach its time; after the last picture, all
    /// that are left. False when the flight is over.
    ///
    /// # Errors
    ///
    /// [`FlightError::Motion`] when the motion has no place or no direction.
    pub fn picture(&mut self) -> Result<bool, FlightError> {
        let FlightRecording { flight, pictures, .. } = &self.recording;
        let (number, left) = (pictures.len(), flight.pictures() - pictures.len());
        if left == 0 {
            return Ok(false);
        }
        let time = nanoseconds(number, flight.picture_rate);
        let until = if left == 1 { i64::MAX } else { time };
        let (state, readings) = (flight.at(time)?.state, flight.readings());
        while self.walk.len() < readings && self.walk.last().is_none_or(|(last, _)| *last < until) {
            self.reading()?;
        }
        let features = self.tracker.follow(&mut self.recording, &state);
        let FlightRecording { flight, pictures, truth, .. } = &mut self.recording;
        let nanoseconds = flight.rig.camera_nanoseconds(time);
        pictures.push(Picture { nanoseconds, features });
        truth.states.push(state);
        let until = self.walk.partition_point(|(read, _)| *read <= time);
        truth.biases.push(self.walk[until.saturating_sub(1)].1);
        Ok(true)
    }

    /// Takes the next reading, unless it is lost.
    fn reading(&mut self) -> Result<(), FlightError> {
        let FlightRecording { flight, readings, .. } = &mut self.recording;
        let noise = &flight.noise;
        let bias = self.walk.last().map_or(flight.initial_bias, |(_, bias)| {
            noise.walk(bias, flight.step(), || normal(&mut self.biases))
        });
        let nanoseconds = nanoseconds(self.walk.len(), flight.imu_rate);
        let perfect = flight.at(nanoseconds)?.sample(&flight.gravity);
        let sample = noise.corrupt(&perfect, &bias, flight.step(), || normal(&mut self.readings));
        self.walk.push((nanoseconds, bias));
        if !flight.loses(nanoseconds) {
            readings.push(StampedSample { nanoseconds, sample });
        }
        Ok(())
    }
}
