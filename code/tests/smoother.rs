//! The fixed-lag smoother on simulated flights: beside the batch, over many flights, and when something is
//! wrong.

use nalgebra::Vector3;
use vislam::filtering::BlockNees;
use vislam::initialization::{Batch, Sensors};
use vislam::least_squares::{Kernel, Options};
use vislam::msckf::Start;
use vislam::simulation::{Flight, FlightRecording, Trajectory};
use vislam::smoother::{Smoothed, Smoother, SmootherError, SmootherOptions};

const SIGMAS: [f64; 4] = [0.01, 0.05, 2e-3, 0.02];

fn flown(seconds: f64, seed: u64) -> FlightRecording {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let new = Flight::new(Trajectory::figure_eight()).with_lever(lever);
    let flight = Flight { seconds, picture_rate: 5.0, tracks: 40, ..new };
    flight.record(&flight.room(3.0, 400, seed).unwrap(), seed).unwrap()
}

/// Position and heading are known to a tenth of a millimetre and of a milliradian.
fn start(recording: &FlightRecording, seed: u64) -> Start {
    let mut start = Start::at_the_origin(recording, SIGMAS, seed).unwrap();
    [0, 1, 2, 6, 7, 8].into_iter().for_each(|at| start.covariance[(at, at)] += 1e-8);
    start
}

fn options(recording: &FlightRecording) -> SmootherOptions {
    let new = SmootherOptions::new(Sensors::of_flight(&recording.flight));
    SmootherOptions { kernel: Kernel::Squared, gate: f64::INFINITY, ..new }
}

/// Gives a smoother the readings of a recording until a picture, and the picture.
fn follow(
    smoother: &mut Smoother,
    recording: &FlightRecording,
    number: usize,
) -> Result<Smoothed, SmootherError> {
    let rig = recording.flight.rig;
    let picture = &recording.pictures[number];
    let until = rig.imu_nanoseconds(picture.nanoseconds);
    let last = smoother.last_reading();
    let new = recording.readings.iter().filter(|reading| last < Some(reading.nanoseconds));
    for reading in new {
        smoother.reading(*reading)?;
        if reading.nanoseconds >= until {
            break;
        }
    }
    smoother.picture(picture)
}

fn smoothed(recording: &FlightRecording, options: SmootherOptions, seed: u64) -> Smoother {
    let mut smoother = Smoother::new(options, &start(recording, seed)).unwrap();
    for number in 1..recording.pictures.len() {
        follow(&mut smoother, recording, number).unwrap();
    }
    smoother
}

#[test]
fn with_a_lag_as_long_as_the_flight_it_is_the_batch() {
    let recording = flown(5.0, 3);
    let all =
        SmootherOptions { lag: 100.0, iterations: 30, tolerance: 1e-12, ..options(&recording) };
    let smoother = smoothed(&recording, all, 7);
    let (sensors, start) = (Sensors::of_flight(&recording.flight), start(&recording, 7));
    let rig = recording.flight.rig;
    let times = recording.pictures.iter().map(|picture| rig.imu_nanoseconds(picture.nanoseconds));
    let times: Vec<i64> = times.collect();
    let truth = &recording.truth;
    let guess: Vec<_> = truth.states.iter().copied().zip(truth.biases.iter().copied()).collect();
    let mut batch = Batch::new(&sensors, &recording.readings, &times, &guess).unwrap();
    batch.know_start(0, &start).unwrap();
    for track in smoother.landmarks() {
        let seen = recording.pictures.iter().enumerate().skip(1).filter_map(|(number, picture)| {
            let feature = picture.features.iter().find(|feature| feature.track == track)?;
            Some((number, feature.pixel))
        });
        let seen: Vec<_> = seen.collect();
        let place = truth.landmarks[truth.landmark_of_track[track]];
        batch.add_landmark(track, place, &seen, Kernel::Squared).unwrap();
    }
    let solution = batch.solve(&Options::default()).unwrap();
    let last = batch.states[times.len() - 1];
    let covariance = batch.covariance(&solution.values).unwrap().of(last).unwrap();
    let (_, state, _) = smoother.state();
    let off = state.position - solution.values[last].position;
    // The biases at which readings were summed up are not the same.
    assert!(off.norm() < 1e-2 * covariance[(6, 6)].sqrt(), "{off}");
    for (own, other) in smoother.covariance().diagonal().iter().zip(covariance.diagonal().iter()) {
        assert!((own / other - 1.0).abs() < 0.02, "{own} {other}");
    }
}

#[test]
fn normalized_errors_of_twenty_flights_are_about_one() {
    let mut sums = [0.0; 4];
    for seed in 0..20 {
        let recording = flown(10.0, seed);
        let smoother = smoothed(&recording, options(&recording), 100 + seed);
        let covariance = smoother.covariance().fixed_view::<9, 9>(0, 0).into_owned();
        let truth = recording.truth.states.last().unwrap();
        let nees = BlockNees::of(&smoother.state().1, truth, &covariance).unwrap();
        let blocks = [nees.position, nees.tilt, nees.yaw, nees.velocity];
        sums.iter_mut().zip(blocks).for_each(|(sum, nees)| *sum += nees / 20.0);
    }
    // Twenty of one dimension are inside of .3 and 2.3 with a probability of 99.9 %.
    assert!(sums.iter().all(|mean| (0.3..2.3).contains(mean)), "{sums:?}");
}

#[test]
fn the_window_takes_no_more_memory_when_it_has_slid_for_long() {
    let recording = flown(30.0, 1);
    let mut smoother = Smoother::new(options(&recording), &start(&recording, 1)).unwrap();
    let mut most = 0;
    for number in 1..recording.pictures.len() {
        follow(&mut smoother, &recording, number).unwrap();
        if number == 75 {
            most = smoother.variables();
        }
    }
    assert!(smoother.variables() < most + 20, "{} {most}", smoother.variables());
}

#[test]
fn what_comes_too_late_is_refused_and_changes_nothing() {
    let recording = flown(3.0, 1);
    let mut smoother = smoothed(&recording, options(&recording), 1);
    let before = smoother.state();
    let late = smoother.reading(recording.readings[3]).unwrap_err();
    assert!(matches!(late, SmootherError::LateReading { .. }), "{late}");
    let last = &recording.pictures[recording.pictures.len() - 1];
    let twice = smoother.picture(last).unwrap_err();
    assert!(matches!(twice, SmootherError::LatePicture { .. }), "{twice}");
    assert!(twice.to_string().contains("leave it out"), "{twice}");
    assert_eq!(smoother.state(), before);
}

#[test]
fn a_picture_that_the_readings_do_not_reach_is_refused() {
    let recording = flown(3.0, 1);
    let mut smoother = Smoother::new(options(&recording), &start(&recording, 1)).unwrap();
    let refused = smoother.picture(&recording.pictures[1]).unwrap_err();
    assert!(matches!(refused, SmootherError::Readings(_)), "{refused}");
    follow(&mut smoother, &recording, 1).unwrap();
}

#[test]
fn half_of_the_pixels_wrong_for_a_second_are_gated() {
    let mut recording = flown(8.0, 2);
    for picture in &mut recording.pictures[20..25] {
        for feature in picture.features.iter_mut().step_by(2) {
            feature.pixel.x += 60.0;
        }
    }
    let robust =
        SmootherOptions { kernel: Kernel::Huber(1.345), gate: 30.0, ..options(&recording) };
    let mut smoother = Smoother::new(robust, &start(&recording, 2)).unwrap();
    let mut gated = 0;
    for number in 1..recording.pictures.len() {
        gated += follow(&mut smoother, &recording, number).unwrap().gated;
    }
    let truth = recording.truth.states.last().unwrap();
    assert!(gated > 20, "{gated}");
    assert!((smoother.state().1.position - truth.position).norm() < 0.3);
}
