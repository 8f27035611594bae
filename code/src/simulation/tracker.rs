//! Which landmarks the camera of a flight follows, and at which pixels.

use nalgebra::{Vector2, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::random::{Purpose, normal, random};
use super::{Flight, FlightRecording};
use crate::datasets::tracks::Feature;
use crate::inertial::NavState;
use crate::manifold::se3;

/// Follows the landmarks from picture to picture.
#[derive(Debug, Clone)]
pub(super) struct Tracker {
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

impl Tracker {
    pub fn new(landmarks: usize, seed: u64) -> Self {
        let [pixels, outliers] =
            [Purpose::Pixels, Purpose::Outliers].map(|purpose| random(seed, purpose));
        Self { tracks: vec![None; landmarks], pixels, outliers }
    }

    /// What the next picture of a recording shows, taken from this state.
    pub fn follow(&mut self, recording: &mut FlightRecording, state: &NavState) -> Vec<Feature> {
        let FlightRecording { flight, pictures, truth, .. } = recording;
        let camera_from_world = flight.rig.camera_from_world(state);
        let places = truth.landmarks.iter().map(|place| se3::transform(&camera_from_world, place));
        let mut sights: Vec<Sight> =
            places.enumerate().filter_map(|(k, place)| self.sight(flight, k, &place)).collect();
        // Landmarks that are followed come first, in the order of their tracks.
        sights.sort_by_key(|sight| self.tracks[sight.landmark].unwrap_or(usize::MAX));
        sights.truncate(flight.tracks);
        let last = std::mem::replace(&mut self.tracks, vec![None; truth.landmarks.len()]);
        let mut features = Vec::with_capacity(sights.len());
        for Sight { landmark, pixel, right, is_outlier } in sights {
            let track = last[landmark].unwrap_or(truth.landmark_of_track.len());
            if track == truth.landmark_of_track.len() {
                truth.landmark_of_track.push(landmark);
            }
            self.tracks[landmark] = Some(track);
            if is_outlier {
                truth.outliers.push((pictures.len(), track));
            }
            features.push(Feature { track, pixel, right });
        }
        features
    }

    /// A landmark at a place in camera coordinates, if it can be recognized there. Every landmark
    /// draws its numbers in every picture, whether it is seen or not.
    fn sight(&mut self, flight: &Flight, landmark: usize, place: &Vector3<f64>) -> Option<Sight> {
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
