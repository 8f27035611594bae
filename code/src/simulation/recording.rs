//! What the sensors of a flight bring home, and the truth about it.

use nalgebra::{Vector2, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::flight::nanoseconds;
use super::random::{Purpose, normal, random};
use super::{Flight, FlightError, Kinematics};
use crate::datasets::tracks::{Feature, Picture};
use crate::inertial::{ImuBias, NavState, StampedSample};
use crate::manifold::se3;

/// What the sensors of a flight bring home.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightRecording {
    /// The flight, with the noise and the calibration of its sensors.
    pub flight: Flight,
    /// The readings in the order of their times. A reading is what the sensor feels at its time,
    /// and not the mean of a step.
    pub readings: Vec<StampedSample>,
    /// The pictures in the order of their times, on the clock of the camera; on that of the inertial
    /// sensor they are at
    /// [`CameraImu::imu_nanoseconds`](crate::inertial::CameraImu::imu_nanoseconds) of these. Features
    /// are in pixels. A landmark keeps its track for as long as one picture after another shows it;
    /// when it comes back after a picture without it, it has a new one.
    pub pictures: Vec<Picture>,
    /// What an estimator must not know.
    pub truth: Truth,
}

/// The truth about a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Truth {
    /// The state of the body at each picture.
    pub states: Vec<NavState>,
    /// The biases at each picture: those of the last reading until then.
    pub biases: Vec<ImuBias>,
    /// Where the landmarks are, in the world, in metres.
    pub landmarks: Vec<Vector3<f64>>,
    /// Which landmark a track follows.
    pub landmark_of_track: Vec<usize>,
    /// The observations that are outliers, ascending: the index of the picture and the track.
    pub outliers: Vec<(usize, usize)>,
}

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
        self.check()?;
        let walk = self.walk(seed);
        let readings = self.read(&walk, seed)?;
        let mut truth = Truth { landmarks: landmarks.to_vec(), ..Truth::default() };
        let mut tracker = Tracker::new(self, landmarks, seed);
        let mut pictures = Vec::new();
        for k in 0..self.pictures() {
            let time = nanoseconds(k, self.picture_rate);
            let state = self.at(time)?.state;
            let features = tracker.follow(k, &state, &mut truth);
            let nanoseconds = self.rig.camera_nanoseconds(time);
            pictures.push(Picture { nanoseconds, features });
            truth.states.push(state);
            let until = walk.partition_point(|(read, _)| *read <= time);
            truth.biases.push(walk[until.saturating_sub(1)].1);
        }
        Ok(FlightRecording { flight: self.clone(), readings, pictures, truth })
    }
    // ANCHOR_END: record

    /// The motion at a time.
    fn at(&self, nanoseconds: i64) -> Result<Kinematics, FlightError> {
        let seconds = nanoseconds as f64 / 1e9;
        let kinematics = self.motion.at(seconds);
        let NavState { velocity, position, .. } = kinematics.state;
        let finite = kinematics.sample(&self.gravity).is_finite()
            && velocity.iter().chain(&position).all(|number| number.is_finite());
        if finite { Ok(kinematics) } else { Err(FlightError::Motion { seconds }) }
    }

    /// The biases at the time of each reading.
    fn walk(&self, seed: u64) -> Vec<(i64, ImuBias)> {
        let mut random = random(seed, Purpose::Biases);
        let mut bias = self.initial_bias;
        let step = |k| {
            let now = (nanoseconds(k, self.imu_rate), bias);
            bias = self.noise.walk(&bias, self.step(), || normal(&mut random));
            now
        };
        (0..self.readings()).map(step).collect()
    }

    /// The readings with these biases, less those that are lost.
    fn read(&self, walk: &[(i64, ImuBias)], seed: u64) -> Result<Vec<StampedSample>, FlightError> {
        let mut random = random(seed, Purpose::Readings);
        let mut readings = Vec::new();
        for (nanoseconds, bias) in walk {
            let perfect = self.at(*nanoseconds)?.sample(&self.gravity);
            let sample = self.noise.corrupt(&perfect, bias, self.step(), || normal(&mut random));
            let seconds = *nanoseconds as f64 / 1e9;
            if !self.gap.is_some_and(|[from, to]| (from..to).contains(&seconds)) {
                readings.push(StampedSample { nanoseconds: *nanoseconds, sample });
            }
        }
        Ok(readings)
    }
}

/// Follows the landmarks from picture to picture.
struct Tracker<'a> {
    flight: &'a Flight,
    landmarks: &'a [Vector3<f64>],
    /// The track of each landmark that the last picture showed.
    tracks: Vec<Option<usize>>,
    pixels: ChaCha8Rng,
    outliers: ChaCha8Rng,
}

/// A landmark in a picture before it is known whether it is followed.
struct Sight {
    landmark: usize,
    pixel: Vector2<f64>,
    right: Option<Vector2<f64>>,
    is_outlier: bool,
}

impl<'a> Tracker<'a> {
    fn new(flight: &'a Flight, landmarks: &'a [Vector3<f64>], seed: u64) -> Self {
        let [pixels, outliers] =
            [Purpose::Pixels, Purpose::Outliers].map(|purpose| random(seed, purpose));
        Self { flight, landmarks, tracks: vec![None; landmarks.len()], pixels, outliers }
    }

    /// What picture `index`, taken from this state, shows.
    fn follow(&mut self, index: usize, state: &NavState, truth: &mut Truth) -> Vec<Feature> {
        let camera_from_world = self.flight.rig.camera_from_world(state);
        let places = self.landmarks.iter().map(|place| se3::transform(&camera_from_world, place));
        let mut sights: Vec<Sight> =
            places.enumerate().filter_map(|(k, place)| self.sight(k, &place)).collect();
        // Landmarks that are followed come first, in the order of their tracks.
        sights.sort_by_key(|sight| self.tracks[sight.landmark].unwrap_or(usize::MAX));
        sights.truncate(self.flight.tracks);
        let last = std::mem::replace(&mut self.tracks, vec![None; self.landmarks.len()]);
        let mut features = Vec::with_capacity(sights.len());
        for Sight { landmark, pixel, right, is_outlier } in sights {
            let track = last[landmark].unwrap_or(truth.landmark_of_track.len());
            if track == truth.landmark_of_track.len() {
                truth.landmark_of_track.push(landmark);
            }
            self.tracks[landmark] = Some(track);
            if is_outlier {
                truth.outliers.push((index, track));
            }
            features.push(Feature { track, pixel, right });
        }
        features
    }

    /// A landmark at a place in camera coordinates, if it can be recognized there. Every landmark
    /// draws its numbers in every picture, whether it is seen or not.
    fn sight(&mut self, landmark: usize, place: &Vector3<f64>) -> Option<Sight> {
        let flight = self.flight;
        let [noise, noise_right] = [(); 2]
            .map(|()| flight.pixel_sigma * Vector2::from_fn(|_, _| normal(&mut self.pixels)));
        let is_outlier = self.outliers.random::<f64>() < flight.outliers;
        let [wrong, wrong_right] =
            [(); 2].map(|()| flight.image.map(|length| length * self.outliers.random::<f64>()));
        let [nearest, farthest] = flight.depths;
        let pixel = flight.pixel(place).filter(|_| (nearest..=farthest).contains(&place.z))?;
        let right =
            flight.baseline.and_then(|baseline| flight.pixel(&(place - baseline * Vector3::x())));
        let sight = if is_outlier {
            Sight { landmark, pixel: wrong, right: right.map(|_| wrong_right), is_outlier }
        } else {
            let right = right.map(|right| right + noise_right);
            Sight { landmark, pixel: pixel + noise, right, is_outlier }
        };
        Some(sight)
    }
}
