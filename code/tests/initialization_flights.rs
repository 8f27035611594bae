//! A real flight from its first picture on, begun by itself. It is no part of the library: `VISLAM_DATA`
//! names the folder in which `euroc/` holds it, and
//! `cargo test --test initialization_flights -- --ignored` runs these tests.

mod measured;

use vislam::datasets::euroc::{read_ground_truth, truth_at};
use vislam::datasets::recording::read_recording;
use vislam::filtering::{Freedom, absolute_trajectory_error};
use vislam::inertial::{Calibrated, CameraImu, GRAVITY, ImuNoise, NavState};
use vislam::initialization::{BeginOptions, Sensors, Whole, WholeOptions, begin};
use vislam::reprojection::Pinhole;

use measured::data;

/// How far the batch of every second picture of V1_01 from some second on is from the truth, in metres,
/// and whether the flight began with a stand.
fn flown_from(second: i64) -> (f64, bool) {
    let recording = read_recording(&data("V1_01_30s_imu_and_tracks.csv")).unwrap();
    let sensors = Sensors {
        camera: Pinhole { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 },
        pixel_sigma: 1.0 / recording.camera.fx,
        noise: ImuNoise::euroc(),
        rig: CameraImu { body_from_camera: recording.body_from_camera, time_offset: 0.0 },
        calibrated: Calibrated::default(),
        gravity: GRAVITY.norm(),
    };
    let from = recording.samples[0].nanoseconds + 1_000_000_000 * second - 1_000;
    let pictures = recording.pictures.iter().filter(|picture| picture.nanoseconds >= from);
    let pictures: Vec<_> = pictures.step_by(2).cloned().collect();
    let readings = &recording.samples;
    let begun = begin(&sensors, readings, &pictures, &BeginOptions::default()).unwrap();
    let stood = !begun.known.standing.is_empty();
    let options = WholeOptions::default();
    let whole = Whole::grown(&sensors, readings, &pictures, begun.known, &options).unwrap();
    let truth = read_ground_truth(&data("V1_01_groundtruth_20hz.csv")).unwrap();
    let at = |time: i64| truth_at(&truth, time).unwrap().state;
    let truth: Vec<NavState> = pictures.iter().map(|picture| at(picture.nanoseconds)).collect();
    let states: Vec<NavState> = whole.batch.states.iter().map(|key| whole.values[*key]).collect();
    let error = absolute_trajectory_error(&states, &truth, Freedom::Four).unwrap();
    (error.position, stood)
}

#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn a_flight_that_begins_with_a_stand_is_known_within_two_centimetres() {
    let (error, stood) = flown_from(0);
    assert!(stood && error < 0.02, "{error} m off");
}

#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn a_flight_taken_up_in_mid_air_is_known_within_two_centimetres() {
    let (error, stood) = flown_from(10);
    assert!(!stood && error < 0.022, "{error} m off");
}
