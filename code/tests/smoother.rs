//! The fixed-lag smoother on simulated flights: beside the batch, over many flights, and when something is
//! wrong.

use std::sync::LazyLock;

use nalgebra::Vector3;
use vislam::filtering::BlockNees;
use vislam::initialization::{Batch, Sensors};
use vislam::least_squares::{Kernel, Options};
use vislam::msckf::Start;
use vislam::simulation::{Flight, FlightRecording, Trajectory, landmarks_around};
use vislam::smoother::{
    Keyframes, Parametrization, Smoothed, Smoother, SmootherError, SmootherOptions,
};

const SIGMAS: [f64; 4] = [0.01, 0.05, 2e-3, 0.02];

const LEVER: Vector3<f64> = Vector3::new(0.1, 0.05, -0.02);

/// With a second camera beside the first one.
fn flight(seconds: f64) -> Flight {
    let new = Flight::new(Trajectory::figure_eight()).with_lever(LEVER);
    Flight { seconds, picture_rate: 5.0, tracks: 40, baseline: Some(0.2), ..new }
}

fn flown(seconds: f64, seed: u64) -> FlightRecording {
    let flight = flight(seconds);
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
    // The biases at which readings were summed up are not the same.
    is_the_batch(&recording, all, 1e-2);
}

#[test]
fn with_one_step_for_each_of_many_pictures_it_is_nearly_the_batch_and_as_sure() {
    let fast = Flight { picture_rate: 40.0, ..flight(5.0) };
    let recording = fast.record(&fast.room(3.0, 400, 3).unwrap(), 3).unwrap();
    is_the_batch(&recording, SmootherOptions { lag: 100.0, ..options(&recording) }, 0.2);
}

#[test]
fn the_step_of_a_picture_is_taken_however_much_else_the_window_says() {
    let fast = Flight { picture_rate: 10.0, ..flight(20.0) };
    let recording = fast.record(&fast.room(3.0, 400, 3).unwrap(), 3).unwrap();
    let all = SmootherOptions { lag: 100.0, ..options(&recording) };
    let mut smoother = Smoother::new(all, &start(&recording, 7)).unwrap();
    for number in 1..recording.pictures.len() {
        let smoothed = follow(&mut smoother, &recording, number).unwrap();
        assert!(smoothed.pixels == 0 || smoothed.iterations == 1, "picture {number}");
    }
}

#[test]
fn a_place_known_to_ten_metres_is_not_known_better_after_steps_that_see_none() {
    let fast = Flight { picture_rate: 20.0, ..flight(3.0) };
    let recording = fast.record(&fast.room(3.0, 400, 3).unwrap(), 3).unwrap();
    let mut start = start(&recording, 7);
    (6..9).for_each(|at| start.covariance[(at, at)] = 100.0);
    for iterations in [1, 3] {
        let often = SmootherOptions { iterations, ..options(&recording) };
        let mut smoother = Smoother::new(often, &start).unwrap();
        for number in 1..recording.pictures.len() {
            follow(&mut smoother, &recording, number).unwrap();
            let variances = smoother.covariance().diagonal();
            for variance in variances.fixed_rows::<3>(6).iter() {
                assert!((variance.sqrt() - 10.0).abs() < 0.2, "{number}: {}", variance.sqrt());
            }
        }
    }
    (6..9).for_each(|at| start.covariance[(at, at)] = 1e6);
    let mut smoother = Smoother::new(options(&recording), &start).unwrap();
    for number in 1..20 {
        follow(&mut smoother, &recording, number).unwrap();
    }
    assert!(smoother.covariance().iter().all(|number| number.is_nan()), "rounding has lost it");
}

/// After a hundred pictures a second for a second comes one a tenth of a second later.
#[test]
fn what_is_said_of_a_place_is_right_or_it_is_said_to_be_unknown() {
    let fast = Flight { picture_rate: 100.0, ..flight(2.0) };
    let recording = fast.record(&fast.room(3.0, 400, 3).unwrap(), 3).unwrap();
    let (mut known, mut unknown) = (0, 0);
    for sigma in [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 1e4] {
        let mut start = start(&recording, 7);
        (6..9).for_each(|at| start.covariance[(at, at)] = sigma * sigma);
        let mut smoother = Smoother::new(options(&recording), &start).unwrap();
        for number in (1..=100).chain(110..=120) {
            follow(&mut smoother, &recording, number).unwrap();
            let variances = smoother.covariance().diagonal();
            if variances.iter().all(|variance| variance.is_nan()) {
                unknown += 1;
                continue;
            }
            known += 1;
            for variance in variances.fixed_rows::<3>(6).iter() {
                let off = variance.sqrt() / sigma;
                assert!((off - 1.0).abs() < 0.1, "{number}: {off} of {sigma} m");
            }
        }
    }
    assert!(known > 100 && unknown > 400, "{known} and {unknown}");
}

/// The newest position is that of a batch of the same measurements to a part of its standard deviation, and the
/// covariances are the same.
fn is_the_batch(recording: &FlightRecording, all: SmootherOptions, part: f64) {
    let smoother = smoothed(recording, all, 7);
    let (sensors, start) = (Sensors::of_flight(&recording.flight), start(recording, 7));
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
    let sigma = covariance[(6, 6)].sqrt();
    assert!(off.norm() < part * sigma, "{} of {sigma}", off.norm());
    for (own, other) in smoother.covariance().diagonal().iter().zip(covariance.diagonal().iter()) {
        assert!((own / other - 1.0).abs() < 0.02, "{own} {other}");
    }
}

/// Twenty flights: the mean normalized errors of position, tilt, yaw and velocity, the root mean square
/// error of the last position, and that which was expected of it, in metres.
fn twenty(with: impl Fn(&FlightRecording) -> SmootherOptions) -> ([f64; 4], f64, f64) {
    let (mut sums, mut square, mut expected) = ([0.0; 4], 0.0, 0.0);
    for seed in 0..20 {
        let recording = flown(10.0, seed);
        let smoother = smoothed(&recording, with(&recording), 100 + seed);
        let covariance = smoother.covariance().fixed_view::<9, 9>(0, 0).into_owned();
        let truth = recording.truth.states.last().unwrap();
        let state = smoother.state().1;
        let nees = BlockNees::of(&state, truth, &covariance).unwrap();
        let blocks = [nees.position, nees.tilt, nees.yaw, nees.velocity];
        sums.iter_mut().zip(blocks).for_each(|(sum, nees)| *sum += nees / 20.0);
        square += (state.position - truth.position).norm_squared() / 20.0;
        expected += covariance.fixed_view::<3, 3>(6, 6).trace() / 20.0;
    }
    (sums, square.sqrt(), expected.sqrt())
}

/// The same with points, which others are compared with.
fn by_points() -> &'static ([f64; 4], f64, f64) {
    static POINTS: LazyLock<([f64; 4], f64, f64)> = LazyLock::new(|| twenty(options));
    &POINTS
}

/// Twenty of one dimension are inside of .3 and 2.3 with a probability of 99.9 %.
fn are_about_one(means: [f64; 4]) -> bool {
    means.iter().all(|mean| (0.3..2.3).contains(mean))
}

fn with_inverse_depth(recording: &FlightRecording) -> SmootherOptions {
    SmootherOptions { landmarks: Parametrization::INVERSE_DEPTH, ..options(recording) }
}

#[test]
fn normalized_errors_of_twenty_flights_are_about_one() {
    let (means, ..) = *by_points();
    assert!(are_about_one(means), "{means:?}");
}

#[test]
fn by_inverse_depth_they_are_about_one_too() {
    let (means, ..) = twenty(with_inverse_depth);
    assert!(are_about_one(means), "{means:?}");
}

#[test]
fn landmarks_that_are_carried_over_say_as_much_as_points_and_those_begun_anew_say_less() {
    let (_, error, expected) = *by_points();
    let (_, anew, more) = twenty(with_inverse_depth);
    let (means, carried, same) = twenty(|recording| {
        let landmarks = Parametrization::InverseDepth { largest_sigma: 0.0, is_carried: true };
        SmootherOptions { landmarks, ..options(recording) }
    });
    assert!(are_about_one(means), "{means:?}");
    assert!((carried / error - 1.0).abs() < 0.02, "{carried} m, by points {error} m");
    assert!((same / expected - 1.0).abs() < 0.02, "{same} m, by points {expected} m");
    assert!(more > 1.05 * expected && anew > error, "{more} m, by points {expected} m");
}

#[test]
fn a_second_camera_makes_the_error_smaller_and_says_so() {
    let (_, alone, _) = *by_points();
    let carried = Parametrization::InverseDepth { largest_sigma: 0.05, is_carried: true };
    for landmarks in [Parametrization::Point, carried] {
        let right = |recording: &FlightRecording| recording.flight.right();
        let paired = |recording: &FlightRecording| SmootherOptions {
            right: right(recording),
            landmarks,
            ..options(recording)
        };
        let (means, error, _) = twenty(paired);
        assert!(are_about_one(means), "{landmarks:?}: {means:?}");
        assert!(error < 0.8 * alone, "{landmarks:?}: {error} m, and {alone} m with one camera");
    }
}

#[test]
fn in_a_window_that_forgets_nothing_inverse_depths_say_what_points_say() {
    let recording = flown(5.0, 3);
    let all =
        SmootherOptions { lag: 100.0, iterations: 30, tolerance: 1e-12, ..options(&recording) };
    let points = smoothed(&recording, all, 7);
    // Begun by the same rule, so that there are the same ones.
    let landmarks = Parametrization::InverseDepth { largest_sigma: 0.0, is_carried: false };
    let anchored = smoothed(&recording, SmootherOptions { landmarks, ..all }, 7);
    assert!(points.landmarks().eq(anchored.landmarks()));
    let off = points.state().1.position - anchored.state().1.position;
    assert!(off.norm() < 1e-3 * points.covariance()[(6, 6)].sqrt(), "{off}");
    let diagonals = points.covariance().diagonal().component_div(&anchored.covariance().diagonal());
    assert!(diagonals.iter().all(|ratio| (ratio - 1.0).abs() < 1e-3), "{diagonals}");
}

#[test]
fn a_landmark_a_kilometre_away_is_no_trouble_for_inverse_depth() {
    let flight = Flight { depths: [0.3, 3000.0], tracks: 80, ..flight(8.0) };
    let mut places = flight.room(3.0, 150, 4).unwrap();
    let near = places.len();
    let far = landmarks_around(&Vector3::zeros(), 400);
    places.extend(far.iter().map(|place| 1000.0 / place.norm() * place));
    let recording = flight.record(&places, 4).unwrap();
    let is_far = |track: &usize| recording.truth.landmark_of_track[*track] >= near;
    let truth = recording.truth.states.last().unwrap();
    let off = |smoother: &Smoother| (smoother.state().1.position - truth.position).norm();
    let points = smoothed(&recording, options(&recording), 4);
    // Next to none: that rays meet at an angle is nothing but noise.
    assert!(points.landmarks().filter(is_far).count() < 5);
    for right in [None, recording.flight.right()] {
        let anchored = SmootherOptions { right, ..with_inverse_depth(&recording) };
        let anchored = smoothed(&recording, anchored, 4);
        let begun = anchored.landmarks().filter(is_far).count();
        assert!(begun > 40, "{begun} of {}", anchored.landmarks().count());
        assert!(off(&anchored) < 0.1, "{}", off(&anchored));
    }
}

#[test]
fn a_pair_is_a_landmark_at_once_and_may_lose_its_right_pixel() {
    let mut recording = flown(3.0, 5);
    for picture in &mut recording.pictures {
        let some = picture.features.iter_mut().filter(|feature| feature.track % 2 == 0);
        some.for_each(|feature| feature.right = None);
    }
    let right = recording.flight.right();
    let paired = SmootherOptions { right, ..options(&recording) };
    let mut smoother = Smoother::new(paired, &start(&recording, 5)).unwrap();
    let first = follow(&mut smoother, &recording, 1).unwrap();
    assert!(first.landmarks > 5, "{first:?}");
    assert!(smoother.landmarks().all(|track| track % 2 == 1));
    for number in 2..recording.pictures.len() {
        follow(&mut smoother, &recording, number).unwrap();
    }
    assert!(smoother.landmarks().any(|track| track % 2 == 0));
    let truth = recording.truth.states.last().unwrap();
    assert!((smoother.state().1.position - truth.position).norm() < 0.1);
}

fn with_keyframes(recording: &FlightRecording) -> SmootherOptions {
    let keyframes = Keyframes::Moved { pixels: 60.0, most_seconds: 1.0 };
    SmootherOptions { keyframes, lag: 3.0, ..options(recording) }
}

#[test]
fn with_keyframes_alone_normalized_errors_are_about_one() {
    for landmarks in [Parametrization::Point, Parametrization::INVERSE_DEPTH] {
        let (means, error, _) =
            twenty(|recording| SmootherOptions { landmarks, ..with_keyframes(recording) });
        assert!(are_about_one(means), "{landmarks:?}: {means:?}");
        assert!(error < 0.06, "{landmarks:?}: {error} m");
    }
}

#[test]
fn a_picture_that_has_hardly_moved_leaves_with_its_pixels_when_the_next_one_comes() {
    let recording = flown(8.0, 6);
    let mut smoother = Smoother::new(with_keyframes(&recording), &start(&recording, 6)).unwrap();
    let (mut passed, mut last) = (0, Smoothed { is_keyframe: true, ..Smoothed::default() });
    for number in 1..recording.pictures.len() {
        let smoothed = follow(&mut smoother, &recording, number).unwrap();
        let expected = if last.is_keyframe { 0 } else { last.pixels };
        assert_eq!(smoothed.dropped, expected, "{number}");
        assert!(last.states == 0 || smoothed.states <= last.states + 1);
        passed += usize::from(!smoothed.is_keyframe);
        last = smoothed;
    }
    assert!((10..30).contains(&passed), "{passed} of {}", recording.pictures.len());
}

#[test]
fn a_hover_does_not_fill_the_window_whatever_the_lag() {
    let motion = Trajectory::hover();
    let flight = Flight { motion, ..flight(20.0) };
    let recording = flight.record(&landmarks_around(&Vector3::zeros(), 200), 1).unwrap();
    let (lag, right) = (f64::INFINITY, recording.flight.right());
    let keyframes = Keyframes::Moved { pixels: 10.0, most_seconds: 5.0 };
    let still = SmootherOptions { keyframes, lag, right, ..options(&recording) };
    let mut smoother = Smoother::new(still, &start(&recording, 1)).unwrap();
    for number in 1..recording.pictures.len() {
        let states = follow(&mut smoother, &recording, number).unwrap().states;
        // The start, the first picture, which nothing came before, a keyframe every five seconds, and
        // the newest one.
        assert!(states <= 3 + number / 25, "{states} states at picture {number}");
    }
    let truth = recording.truth.states.last().unwrap();
    let off = smoother.state().1.position - truth.position;
    assert!(off.norm() < 0.1, "{off}");
}

#[test]
fn the_window_takes_no_more_memory_when_it_has_slid_for_long() {
    let recording = flown(30.0, 1);
    let carried = Parametrization::InverseDepth { largest_sigma: 0.05, is_carried: true };
    for landmarks in [Parametrization::Point, Parametrization::INVERSE_DEPTH, carried] {
        for each in [options(&recording), with_keyframes(&recording)] {
            let each = SmootherOptions { landmarks, ..each };
            let mut smoother = Smoother::new(each, &start(&recording, 1)).unwrap();
            let mut most = 0;
            for number in 1..recording.pictures.len() {
                follow(&mut smoother, &recording, number).unwrap();
                if number == 75 {
                    most = smoother.variables();
                }
            }
            let variables = smoother.variables();
            assert!(variables < most + 20, "{landmarks:?}: {variables}, and half way {most}");
        }
    }
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
fn a_track_goes_on_after_a_pixel_that_is_no_number() {
    let mut recording = flown(3.0, 1);
    let tracks: Vec<usize> = recording.pictures[3].features.iter().map(|f| f.track).collect();
    recording.pictures[3].features.iter_mut().for_each(|feature| feature.pixel.y = f64::NAN);
    let mut smoother = Smoother::new(options(&recording), &start(&recording, 1)).unwrap();
    let gated: Vec<usize> = (1..recording.pictures.len())
        .map(|number| follow(&mut smoother, &recording, number).unwrap().gated)
        .collect();
    assert_eq!(gated[2], tracks.len());
    assert_eq!(gated.iter().sum::<usize>(), tracks.len());
    assert!(smoother.landmarks().filter(|track| tracks.contains(track)).count() > 10);
    let truth = recording.truth.states.last().unwrap();
    assert!((smoother.state().1.position - truth.position).norm() < 0.1);
}

#[test]
fn half_of_the_pixels_wrong_for_a_second_are_gated() {
    let mut recording = flown(8.0, 2);
    for picture in &mut recording.pictures[20..25] {
        for feature in picture.features.iter_mut().step_by(2) {
            feature.pixel.x += 60.0;
        }
    }
    let truth = recording.truth.states.last().unwrap();
    for landmarks in [Parametrization::Point, Parametrization::INVERSE_DEPTH] {
        let (kernel, gate) = (Kernel::Huber(1.345), 30.0);
        let robust = SmootherOptions { kernel, gate, landmarks, ..options(&recording) };
        let mut smoother = Smoother::new(robust, &start(&recording, 2)).unwrap();
        let mut gated = 0;
        for number in 1..recording.pictures.len() {
            gated += follow(&mut smoother, &recording, number).unwrap().gated;
        }
        assert!(gated > 20, "{landmarks:?}: {gated}");
        assert!((smoother.state().1.position - truth.position).norm() < 0.3, "{landmarks:?}");
    }
}
