//! One flight that runs through the whole book: at the end of each chapter, how far its methods have brought the
//! estimate of it.
//!
//! There is one recording. A chapter that needs less than a minute takes its beginning.

pub mod beginning;
pub mod followed;
mod from_above;
mod in_and_out;
pub mod many_pictures;
pub mod one_picture;
pub mod readings;
pub mod two_pictures;

use std::sync::OnceLock;

use nalgebra::{Isometry3, Vector2, Vector3};
use vislam::inertial::NavState;
use vislam::simulation::FlightRecording;

use crate::msckf::flights::example::flight;
use crate::msckf::flights::flown;

/// How long the whole flight takes.
const SECONDS: f64 = 60.0;
const SEED: u64 = 0;

/// What the sensors of the flight bring home.
pub fn recording() -> &'static FlightRecording {
    static RECORDING: OnceLock<FlightRecording> = OnceLock::new();
    RECORDING.get_or_init(|| flown(&flight(SECONDS), SEED))
}

/// The number of the picture at a time, in seconds.
fn picture_at(seconds: f64) -> usize {
    (seconds * recording().flight.picture_rate).round() as usize
}

/// The true states from picture to picture of a span of seconds.
fn states(from: f64, to: f64) -> &'static [NavState] {
    &recording().truth.states[picture_at(from)..=picture_at(to)]
}

/// Where the body truly is in a span of seconds.
fn path(from: f64, to: f64) -> impl Iterator<Item = &'static Vector3<f64>> {
    states(from, to).iter().map(|state| &state.position)
}

/// Where the camera truly is at a picture.
fn camera_from_world(picture: usize) -> Isometry3<f64> {
    let recording = recording();
    recording.flight.rig.camera_from_world(&recording.truth.states[picture])
}

/// Where a camera is.
fn centre(camera_from_world: &Isometry3<f64>) -> Vector3<f64> {
    camera_from_world.inverse().translation.vector
}

/// Where the camera truly is in a span of seconds.
fn camera_path(from: f64, to: f64) -> Vec<Vector3<f64>> {
    (picture_at(from)..=picture_at(to)).map(|picture| centre(&camera_from_world(picture))).collect()
}

/// Where the landmark of a track truly is.
fn place_of(track: usize) -> Vector3<f64> {
    let truth = &recording().truth;
    truth.landmarks[truth.landmark_of_track[track]]
}

/// What a picture shows: where each landmark truly is, and the pixel at which it was seen.
fn seen(picture: usize) -> (Vec<Vector3<f64>>, Vec<Vector2<f64>>) {
    let features = &recording().pictures[picture].features;
    features.iter().map(|feature| (place_of(feature.track), feature.pixel)).unzip()
}
