//! The minimum over all readings and pixels until a time: what any filter can reach at best.

use std::collections::BTreeMap;
use std::error::Error;
use std::time::Instant;

use nalgebra::SMatrix;
use vislam::consistency::Claimed;
use vislam::initialization::{Batch, Sensors, Sighting};
use vislam::least_squares::{Kernel, Options};
use vislam::simulation::FlightRecording;

use crate::flown::{PICTURE_RATE, Setting, start};
use crate::judged::Judged;

/// How well the batch knows what the filters know exactly, in rad and m.
const EXACT: f64 = 1e-7;

/// The batch until each of the times, judged there.
pub fn batches(
    recording: &FlightRecording,
    setting: &Setting,
    times: &[f64],
    seed: u64,
) -> Result<Vec<Judged>, String> {
    let told = |error: &dyn Error| format!("flight {seed}, batch: {error}");
    let one = |time: &f64| {
        let pictures = (time * PICTURE_RATE).round() as usize + 1;
        batch(recording, setting, pictures, seed).map_err(|error| told(&*error))
    };
    times.iter().map(one).collect()
}

/// The batch of the first so many pictures. It begins at the truth and ends at the minimum near it.
fn batch(
    recording: &FlightRecording,
    setting: &Setting,
    pictures: usize,
    seed: u64,
) -> Result<Judged, Box<dyn Error>> {
    let begin = Instant::now();
    let truth = &recording.truth;
    let sensors = Sensors::of_flight(&recording.flight);
    let seen = recording.pictures.get(..pictures).ok_or("the flight is shorter")?;
    let on_sensor = |picture: &vislam::datasets::tracks::Picture| {
        recording.flight.rig.imu_nanoseconds(picture.nanoseconds)
    };
    let times: Vec<i64> = seen.iter().map(on_sensor).collect();
    let guess: Vec<_> =
        truth.states.iter().copied().zip(truth.biases.iter().copied()).take(pictures).collect();
    let mut batch = Batch::new(&sensors, &recording.readings, &times, &guess)?;
    let mut start = start(recording, setting, seed).ok_or("the flight has no picture")?;
    for place in [0, 1, 2, 6, 7, 8] {
        start.covariance[(place, place)] += EXACT * EXACT;
    }
    batch.know_start(0, &start)?;
    let mut tracks: BTreeMap<usize, Vec<Sighting>> = BTreeMap::new();
    for (number, picture) in seen.iter().enumerate() {
        for feature in &picture.features {
            tracks.entry(feature.track).or_default().push((number, feature.pixel));
        }
    }
    for (track, sightings) in tracks.iter().filter(|(_, sightings)| sightings.len() > 2) {
        let place = truth.landmarks[truth.landmark_of_track[*track]];
        batch.add_landmark(*track, place, sightings, Kernel::Squared)?;
    }
    let solution = batch.solve(&Options::default())?;
    let covariance = batch.covariance(&solution.values)?;
    let last = batch.states[pictures - 1];
    let own = covariance.of(last).ok_or("the last state has no covariance")?;
    let own = SMatrix::<f64, 9, 9>::from_fn(|row, column| own[(row, column)]);
    let (estimate, truth) = (&solution.values[last], &truth.states[pictures - 1]);
    let squared = (truth.position - estimate.position).norm_squared();
    let judged = Judged::of(estimate, truth, &own)?;
    Ok(judged.after((squared, 1), begin.elapsed(), Claimed::default()))
}
