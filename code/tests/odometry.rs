//! The assembled system on simulated flights: each estimator from nothing to the end, and what is wrong with readings
//! and pictures.

mod take_off;

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::Vector3;
use take_off::taking_off;
use vislam::datasets::tracks::Picture;
use vislam::filtering::{Freedom, StateError, absolute_trajectory_error, chi_square_band, nees};
use vislam::inertial::{NavState, StampedSample};
use vislam::initialization::{BeginOptions, Sensors, begin};
use vislam::least_squares::Manifold;
use vislam::msckf::Start;
use vislam::observability::Similarity;
use vislam::odometry::{
    Estimate, Estimator, Lost, Odometry, OdometryError, OdometryOptions, Progress,
};
use vislam::simulation::{Flight, FlightRecording, Trajectory};
use vislam::smoother::{Keyframes, Parametrization};

/// Flights, where many are flown.
const SEEDS: u64 = 12;

fn flown(seconds: f64, seed: u64) -> FlightRecording {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let new = Flight::new(Trajectory::figure_eight()).with_lever(lever);
    let flight = Flight { seconds, picture_rate: 10.0, tracks: 40, ..new };
    flight.record(&flight.room(3.0, 400, seed).unwrap(), seed).unwrap()
}

fn odometry(recording: &FlightRecording, estimator: Estimator) -> Odometry {
    Odometry::new(OdometryOptions::new(Sensors::of_flight(&recording.flight), estimator))
}

/// What came of a recording.
#[derive(Default)]
struct Flown {
    estimates: Vec<Estimate>,
    lost: Vec<Lost>,
    /// Of each estimate, in which world it is.
    worlds: Vec<usize>,
}

fn fly(odometry: &mut Odometry, readings: &[StampedSample], pictures: &[Picture]) -> Flown {
    let mut flown = Flown::default();
    let told = |odometry: &Odometry, progress: Progress| match progress {
        Progress::Following { .. } => {
            flown.estimates.extend(odometry.newest());
            flown.worlds.push(odometry.worlds());
        }
        Progress::Lost(lost) => flown.lost.push(lost),
        Progress::Waiting | Progress::Standing => {}
    };
    odometry.fly(readings, pictures, told).unwrap();
    flown
}

/// The root mean square error of positions after an alignment in four degrees of freedom, in metres.
fn error(recording: &FlightRecording, estimates: &[Estimate]) -> f64 {
    let rig = recording.flight.rig;
    let of = |estimate: &Estimate| {
        let is_it =
            |picture: &Picture| rig.imu_nanoseconds(picture.nanoseconds) == estimate.nanoseconds;
        let picture = recording.pictures.iter().position(is_it).unwrap();
        (estimate.state, recording.truth.states[picture])
    };
    let (states, truth): (Vec<NavState>, Vec<NavState>) = estimates.iter().map(of).unzip();
    absolute_trajectory_error(&states, &truth, Freedom::Four).unwrap().position
}

#[test]
fn a_clock_that_nobody_told_is_found_from_a_start_that_is_known() {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let mut flight = Flight::new(Trajectory::figure_eight()).with_lever(lever);
    (flight.seconds, flight.picture_rate, flight.tracks) = (8.0, 10.0, 40);
    flight.rig.time_offset = 0.01;
    let recording = flight.record(&flight.room(3.0, 400, 2).unwrap(), 2).unwrap();
    let mut sensors = Sensors::of_flight(&recording.flight);
    (sensors.rig.time_offset, sensors.calibrated.time_offset) = (0.0, Some(0.02));
    for estimator in [Estimator::Smoother, Estimator::Msckf] {
        let mut start = Start::at_the_origin(&recording, [0.01, 0.05, 2e-3, 0.02], 5).unwrap();
        (0..9).for_each(|at| start.covariance[(at, at)] += 1e-8);
        start.rig.time_offset = 0.0;
        let options = OdometryOptions::new(sensors, estimator);
        let mut odometry = Odometry::begun(options, &start).unwrap();
        // By its own clock the last picture may be later than all readings.
        let pictures = &recording.pictures[1..recording.pictures.len() - 1];
        let flown = fly(&mut odometry, &recording.readings, pictures);
        assert!(flown.lost.is_empty(), "{estimator}: {:?}", flown.lost);
        let last = flown.estimates.last().unwrap();
        let truth = recording.flight.motion.at(1e-9 * last.nanoseconds as f64).state;
        let off = (last.state.position - truth.position).norm();
        assert!(off < 0.15, "{estimator}: {off} m");
        let offset = odometry.rig().unwrap().time_offset;
        assert!((offset - 0.01).abs() < 2e-3, "{estimator}: {offset} s");
    }
}

#[test]
fn a_camera_that_sits_elsewhere_than_told_is_found() {
    let recording = flown(16.0, 2);
    let truth = recording.flight.rig.body_from_camera;
    let mut sensors = Sensors::of_flight(&recording.flight);
    let off = [0.03, -0.02, 0.02, 0.01, -0.01, 0.015];
    sensors.rig.body_from_camera = truth.retract(&off);
    sensors.calibrated.extrinsics = Some([0.03, 0.015]);
    for estimator in Estimator::ALL {
        let mut odometry = Odometry::new(OdometryOptions::new(sensors, estimator));
        let flown = fly(&mut odometry, &recording.readings, &recording.pictures);
        assert!(flown.lost.is_empty(), "{estimator}: {:?}", flown.lost);
        let mut left = [0.0; 6];
        truth.local(&odometry.rig().unwrap().body_from_camera, &mut left);
        let [shift, turn] = [&left[..3], &left[3..]].map(|of| Vector3::from_row_slice(of).norm());
        assert!(shift < 0.015 && turn < 3e-3, "{estimator}: {shift} m, {turn} rad");
    }
}

#[test]
fn each_estimator_flies_from_nothing_to_the_end() {
    let recording = flown(12.0, 1);
    for estimator in Estimator::ALL {
        let mut odometry = odometry(&recording, estimator);
        let flown = fly(&mut odometry, &recording.readings, &recording.pictures);
        assert!(flown.lost.is_empty(), "{estimator}: {:?}", flown.lost);
        assert!(flown.estimates.len() > 80, "{estimator}: {}", flown.estimates.len());
        let error = error(&recording, &flown.estimates);
        assert!(error < 0.1, "{estimator}: {error} m");
        assert_eq!(odometry.worlds(), 1);
        assert_honest(&recording, &odometry, &estimator);
    }
}

/// The true state at a time.
fn truth_at(recording: &FlightRecording, nanoseconds: i64) -> NavState {
    recording.flight.motion.at(1e-9 * nanoseconds as f64).state
}

/// From the flight's own world to the true one, to which the origin of the beginning ties it.
fn to_truth(recording: &FlightRecording, odometry: &Odometry) -> Similarity {
    let beginning = odometry.beginning().unwrap();
    beginning.to_world_of(&truth_at(recording, beginning.origin.0))
}

/// The newest estimate in the true world, and how far off it is.
fn in_true_world(recording: &FlightRecording, odometry: &Odometry) -> (Estimate, StateError) {
    let newest = odometry.newest().unwrap().in_world(&to_truth(recording, odometry));
    let truth = truth_at(recording, newest.nanoseconds);
    (newest, StateError::between(&newest.state, &truth))
}

/// The NEES of the newest rotation, velocity and position, each divided by three.
fn nees_by_block((newest, error): &(Estimate, StateError)) -> [f64; 3] {
    let in_body = newest.state.world_from_body.inverse() * error.rotation;
    [(in_body, 0), (error.velocity, 3), (error.position, 6)].map(|(error, from)| {
        nees(&error, &newest.covariance.fixed_view::<3, 3>(from, from).into_owned()).unwrap()
    })
}

/// What is said last is not off by more than it says, and it says something.
fn assert_honest(recording: &FlightRecording, odometry: &Odometry, who: &dyn std::fmt::Debug) {
    let newest = in_true_world(recording, odometry);
    let nees = nees_by_block(&newest);
    let [_, most] = chi_square_band(2e-4, 3).unwrap();
    assert!(nees.iter().all(|nees| 3.0 * nees < most), "{who:?}: {nees:?}, {newest:?}");
    // Four standard deviations, along whatever axis.
    assert!(3.0 * nees[1] < 16.0, "{who:?}: velocity {nees:?}");
    let sigma = |from: usize| {
        newest.0.covariance.fixed_view::<3, 3>(from, from).symmetric_eigenvalues().max().sqrt()
    };
    let sigmas = [0, 3, 6, 9, 12].map(sigma);
    let most = [0.05, 0.1, 0.3, 0.02, 0.3];
    let is_sure = sigmas.iter().zip(most).all(|(sigma, most)| *sigma < most);
    assert!(is_sure, "{who:?}: {sigmas:?}");
}

/// Few flights make wide bands, so that a miss is no accident: 2 px at a focal length of 250 px hide what a
/// landmark must not be begun with, and after a gap of the readings a flight begins in another place.
#[test]
fn after_each_beginning_errors_are_as_large_as_reported() {
    let cases = [(Estimator::Batch, 3.0, None), (Estimator::Smoother, 1.0, Some([4.0, 4.6]))];
    for (estimator, pixel_sigma, gap) in cases {
        let mut sums = [0.0; 3];
        for seed in 0..SEEDS {
            let lever = Vector3::new(0.1, 0.05, -0.02);
            let new = Flight::new(Trajectory::figure_eight()).with_lever(lever);
            let flight = Flight { seconds: 10.0, pixel_sigma, gap, tracks: 20, ..new };
            let flight = Flight { picture_rate: 5.0, ..flight };
            let recording = flight.record(&flight.room(3.0, 240, seed).unwrap(), seed).unwrap();
            let mut odometry = odometry(&recording, estimator);
            fly(&mut odometry, &recording.readings, &recording.pictures);
            let nees = nees_by_block(&in_true_world(&recording, &odometry));
            sums.iter_mut().zip(nees).for_each(|(sum, nees)| *sum += nees);
        }
        let [low, high] = chi_square_band(1e-4, 3 * SEEDS as usize).unwrap();
        for sum in sums {
            let total = 3.0 * sum;
            assert!(low < total && total < high, "{pixel_sigma} px, {gap:?}: {total}");
        }
    }
}

/// A flight with a gap, whose tracker loses each landmark after twelve pictures and finds it again as another one.
fn flown_with_short_tracks(seed: u64) -> FlightRecording {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let new = Flight::new(Trajectory::figure_eight()).with_lever(lever);
    let gap = Some([12.0, 13.0]);
    let flight = Flight { seconds: 30.5, picture_rate: 5.0, tracks: 20, gap, ..new };
    let mut recording = flight.record(&flight.room(3.0, 240, seed).unwrap(), seed).unwrap();
    let mut seen = BTreeMap::new();
    for picture in &mut recording.pictures {
        for feature in &mut picture.features {
            let before = seen.entry(feature.track).or_insert(0);
            feature.track += 1000 * (*before / 12);
            *before += 1;
        }
        picture.features.sort_by_key(|feature| feature.track);
    }
    recording
}

/// By how many standard deviations the velocity is off, as the body sees it, with which a flight begins from these
/// pictures, when pixels and readings may fit together so badly.
fn off_after(recording: &FlightRecording, pictures: &[Picture], misfit: f64) -> f64 {
    let mut options = BeginOptions::default();
    options.motion.misfit = misfit;
    let sensors = Sensors::of_flight(&recording.flight);
    let begun = begin(&sensors, &recording.readings, pictures, &options).unwrap();
    let (_, start) = &begun.start;
    let truth = recording.flight.motion.at(1e-9 * start.nanoseconds as f64).state;
    let in_body = |state: &NavState| state.world_from_body.inverse() * state.velocity;
    let spread = start.covariance.fixed_view::<3, 3>(3, 3).symmetric_eigenvalues();
    (in_body(&start.state) - in_body(&truth)).norm() / spread.max().sqrt()
}

/// Behind the gap, these flights have a span of pictures that shows another motion than the true one, and a
/// covariance that knows nothing of it.
#[test]
fn a_beginning_that_does_not_fit_would_be_believed_and_is_refused() {
    for (seed, first) in [(2, 65), (2, 67), (14, 66)] {
        let recording = flown_with_short_tracks(seed);
        let pictures = &recording.pictures[first..first + 30];
        let [refused, believed] =
            [1.5, f64::INFINITY].map(|misfit| off_after(&recording, pictures, misfit));
        assert!(refused < 3.0 && believed > 5.0, "{seed}: {refused} and {believed}");
    }
}

/// The landmarks of the window are where they truly are, whatever they are estimated as.
fn assert_places(recording: &FlightRecording, odometry: &Odometry) {
    let to_truth = to_truth(recording, odometry);
    let off = |(track, place): (usize, Vector3<f64>)| {
        let landmark = recording.truth.landmark_of_track[track];
        (to_truth.point(&place) - recording.truth.landmarks[landmark]).norm()
    };
    let mut off: Vec<f64> = odometry.points().into_iter().map(off).collect();
    off.sort_by(f64::total_cmp);
    assert!(off.len() > 20 && off[off.len() / 2] < 0.15, "{} landmarks: {off:?}", off.len());
}

#[test]
fn batch_and_smoother_fly_by_inverse_depth_and_keyframes_too() {
    let recording = flown(12.0, 1);
    let carried = Parametrization::InverseDepth { largest_sigma: 0.05, is_carried: true };
    for estimator in [Estimator::Batch, Estimator::Smoother] {
        for landmarks in [Parametrization::Point, Parametrization::INVERSE_DEPTH, carried] {
            let mut options =
                OdometryOptions::new(Sensors::of_flight(&recording.flight), estimator);
            options.smoother.landmarks = landmarks;
            options.smoother.keyframes = Keyframes::Moved { pixels: 40.0, most_seconds: 1.0 };
            let mut odometry = Odometry::new(options);
            let flown = fly(&mut odometry, &recording.readings, &recording.pictures);
            assert!(flown.lost.is_empty(), "{estimator}, {landmarks:?}: {:?}", flown.lost);
            let error = error(&recording, &flown.estimates);
            assert!(error < 0.15, "{estimator}, {landmarks:?}: {error} m");
            assert_honest(&recording, &odometry, &(estimator, landmarks));
            assert_places(&recording, &odometry);
        }
    }
}

#[test]
fn a_second_without_pictures_and_ten_without_tracks_are_flown_through() {
    let recording = flown(12.0, 2);
    for estimator in Estimator::ALL {
        let mut pictures = recording.pictures.clone();
        pictures[60..70].iter_mut().for_each(|picture| picture.features.clear());
        pictures.drain(90..100);
        let mut odometry = odometry(&recording, estimator);
        let flown = fly(&mut odometry, &recording.readings, &pictures);
        assert!(flown.lost.is_empty(), "{estimator}: {:?}", flown.lost);
        assert_honest(&recording, &odometry, &estimator);
        // While nothing is seen, it is less sure with every picture.
        let at = flown.estimates.len() - (recording.pictures.len() - 10 - 60);
        let sigma = |number: usize| flown.estimates[number].covariance[(6, 6)];
        assert!(sigma(at + 9) > sigma(at), "{} {}", sigma(at), sigma(at + 9));
    }
}

#[test]
fn a_missing_reading_is_flown_through_and_a_gap_is_said() {
    let recording = flown(14.0, 3);
    for estimator in [Estimator::Smoother, Estimator::Msckf] {
        let mut readings = recording.readings.clone();
        readings.remove(1200);
        let mut one = odometry(&recording, estimator);
        let flown = fly(&mut one, &readings, &recording.pictures);
        assert!(flown.lost.is_empty(), "{estimator}: {:?}", flown.lost);
        assert_honest(&recording, &one, &estimator);

        readings.drain(1200..1300);
        let mut many = odometry(&recording, estimator);
        let flown = fly(&mut many, &readings, &recording.pictures);
        assert!(matches!(flown.lost[..], [Lost::Gap { .. }]), "{estimator}: {:?}", flown.lost);
        assert_eq!(many.worlds(), 2, "{estimator} begins again");
        assert_honest(&recording, &many, &estimator);
        assert_eq!(flown.worlds.last(), Some(&2));
    }
}

/// A start that is known, at the first picture of a recording.
fn known(recording: &FlightRecording) -> Start {
    let mut start = Start::at_the_origin(recording, [0.01, 0.05, 2e-3, 0.02], 5).unwrap();
    (0..9).for_each(|at| start.covariance[(at, at)] += 1e-8);
    start
}

#[test]
fn pictures_that_fall_between_two_readings_are_flown_through() {
    let mut recording = flown_at(20.0, 0.0);
    let begins = recording.readings[0].nanoseconds;
    recording.readings.retain(|reading| {
        let milliseconds = (reading.nanoseconds - begins) / 1_000_000;
        !(4002..4088).contains(&milliseconds)
    });
    for estimator in [Estimator::Smoother, Estimator::Msckf] {
        let options = OdometryOptions::new(Sensors::of_flight(&recording.flight), estimator);
        let mut odometry = Odometry::begun(options, &known(&recording)).unwrap();
        let flown = fly(&mut odometry, &recording.readings, &recording.pictures[1..]);
        assert!(flown.lost.is_empty(), "{estimator}: {:?}", flown.lost);
    }
}

/// A recording with so many pictures a second, a clock that is so many seconds off, and a long focal length.
fn flown_at(picture_rate: f64, time_offset: f64) -> FlightRecording {
    let mut flight = Flight::new(Trajectory::figure_eight());
    (flight.camera.fx, flight.camera.fy) = (500.0, 500.0);
    (flight.seconds, flight.picture_rate, flight.tracks) = (8.0, picture_rate, 40);
    (flight.rig.time_offset, flight.pixel_sigma) = (time_offset, 0.3);
    flight.record(&flight.room(3.0, 1200, 2).unwrap(), 2).unwrap()
}

#[test]
fn gates_ask_where_the_camera_was_by_the_clock_that_is_estimated() {
    let recording = flown_at(10.0, 0.04);
    let mut sensors = Sensors::of_flight(&recording.flight);
    (sensors.rig.time_offset, sensors.calibrated.time_offset) = (0.0, Some(0.03));
    let mut start = known(&recording);
    start.rig.time_offset = 0.0;
    let options = OdometryOptions::new(sensors, Estimator::Smoother);
    let mut odometry = Odometry::begun(options, &start).unwrap();
    let (mut used, mut refused) = (0, 0);
    let count = |_: &Odometry, progress: Progress| match progress {
        Progress::Following { used: more, refused: fewer } => {
            used += more;
            refused += fewer;
        }
        other => panic!("{other:?}"),
    };
    let pictures = &recording.pictures[1..recording.pictures.len() - 1];
    odometry.fly(&recording.readings, pictures, count).unwrap();
    assert!(refused * 100 < used, "{refused} of {used}");
    let offset = odometry.rig().unwrap().time_offset;
    assert!((offset - 0.04).abs() < 2e-3, "{offset}");
}

#[test]
fn a_filter_whose_clock_moves_while_it_catches_up_keeps_its_beginning() {
    for seed in 0..3 {
        let recording = taking_off(seed);
        let mut sensors = Sensors::of_flight(&recording.flight);
        (sensors.rig.time_offset, sensors.calibrated.time_offset) = (-0.008, Some(0.01));
        let mut odometry = Odometry::new(OdometryOptions::new(sensors, Estimator::Msckf));
        let pictures = &recording.pictures[..recording.pictures.len() - 1];
        let flown = fly(&mut odometry, &recording.readings, pictures);
        assert!(flown.lost.is_empty(), "{seed}: {:?}", flown.lost);
        assert_eq!(odometry.worlds(), 1, "{seed}");
    }
}

#[test]
fn a_place_of_which_rounding_loses_what_is_known_loses_no_flight() {
    let recording = flown(8.0, 3);
    let mut start = known(&recording);
    (6..9).for_each(|at| start.covariance[(at, at)] = 1e8);
    let options = OdometryOptions::new(Sensors::of_flight(&recording.flight), Estimator::Smoother);
    let mut odometry = Odometry::begun(options, &start).unwrap();
    let flown = fly(&mut odometry, &recording.readings, &recording.pictures[1..]);
    assert!(flown.lost.is_empty(), "{:?}", flown.lost);
    let last = flown.estimates.last().unwrap();
    assert!(last.covariance.iter().all(|number| number.is_nan()));
    assert!(error(&recording, &flown.estimates) < 0.05);
}

#[test]
fn landmarks_that_a_filter_keeps_do_not_contradict_it() {
    let mut flight = Flight::new(Trajectory::about_one_spot());
    (flight.seconds, flight.picture_rate, flight.tracks) = (20.0, 10.0, 24);
    let recording = flight.record(&flight.room(2.5, 250, 4).unwrap(), 4).unwrap();
    let mut options = OdometryOptions::new(Sensors::of_flight(&recording.flight), Estimator::Msckf);
    options.msckf.landmarks = 24;
    let mut odometry = Odometry::begun(options, &known(&recording)).unwrap();
    let flown = fly(&mut odometry, &recording.readings, &recording.pictures[1..]);
    assert!(flown.lost.is_empty(), "{:?}", flown.lost);
}

#[test]
fn a_body_is_seen_to_stand_though_pictures_came_before_the_readings() {
    let mut recording = flown(12.0, 3);
    let hover = Flight { motion: Trajectory::hover(), seconds: 4.0, ..recording.flight.clone() };
    recording = hover.record(&hover.room(3.0, 400, 3).unwrap(), 3).unwrap();
    let readings = &recording.readings[30..];
    let mut odometry = odometry(&recording, Estimator::Smoother);
    let mut standing = 0;
    let count = |_: &Odometry, progress: Progress| {
        standing += usize::from(progress == Progress::Standing);
    };
    odometry.fly(readings, &recording.pictures, count).unwrap();
    assert!(standing > 10, "{standing}");
}

#[test]
fn a_flight_that_is_lost_goes_on_by_the_clock_that_was_told() {
    let recording = flown(12.0, 3);
    let mut sensors = Sensors::of_flight(&recording.flight);
    (sensors.rig.time_offset, sensors.calibrated.time_offset) = (0.03, Some(0.03));
    let mut readings = recording.readings.clone();
    readings[1200].nanoseconds += 3_600_000_000_000;
    let mut start = known(&recording);
    start.rig.time_offset = 0.03;
    let options = OdometryOptions::new(sensors, Estimator::Msckf);
    let mut odometry = Odometry::begun(options, &start).unwrap();
    let pictures = &recording.pictures[1..recording.pictures.len() - 2];
    let flown = fly(&mut odometry, &readings, pictures);
    assert!(matches!(flown.lost[..], [Lost::Gap { .. }, ..]), "{:?}", flown.lost);
}

#[test]
fn one_reading_from_the_future_costs_a_beginning_and_no_more() {
    let recording = flown(12.0, 3);
    for estimator in [Estimator::Smoother, Estimator::Msckf] {
        let mut readings = recording.readings.clone();
        readings[1200].nanoseconds += 3_600_000_000_000;
        let mut odometry = odometry(&recording, estimator);
        let flown = fly(&mut odometry, &readings, &recording.pictures);
        assert!(matches!(flown.lost[..], [Lost::Gap { .. }]), "{estimator}: {:?}", flown.lost);
        assert_eq!(odometry.worlds(), 2, "{estimator} begins again");
        assert_honest(&recording, &odometry, &estimator);
        // Two that agree are believed, and what comes before them is late.
        let last = *recording.readings.last().unwrap();
        let after = |seconds: i64| StampedSample {
            nanoseconds: last.nanoseconds + seconds * 1_000_000_000,
            ..last
        };
        assert!(matches!(odometry.reading(after(50)), Ok(Some(Lost::Gap { .. }))));
        let twice = odometry.reading(after(50));
        assert!(matches!(twice, Err(OdometryError::LateReading { .. })), "{twice:?}");
        assert!(matches!(odometry.reading(after(51)), Ok(Some(Lost::Gap { .. }))));
        assert!(matches!(odometry.reading(after(52)), Ok(Some(Lost::Gap { .. }))));
        assert!(matches!(odometry.reading(after(49)), Err(OdometryError::LateReading { .. })));
    }
}

/// A recording in which the sensor shows so many times what there is, for half a second.
fn with_a_blow(recording: &FlightRecording, size: f64) -> Vec<StampedSample> {
    let mut readings = recording.readings.clone();
    for StampedSample { sample, .. } in &mut readings[1000..1100] {
        sample.gyro *= size;
        sample.accelerometer *= size;
    }
    readings
}

#[test]
fn a_blow_to_the_sensor_is_noticed_whatever_its_size() {
    let recording = flown(11.0, 6);
    for estimator in [Estimator::Smoother, Estimator::Msckf] {
        for size in [10.0, 1e3, 1e160] {
            let mut odometry = odometry(&recording, estimator);
            let readings = with_a_blow(&recording, size);
            let flown = fly(&mut odometry, &readings, &recording.pictures);
            let is_expected = match flown.lost[..] {
                [Lost::Contradicted { .. }] => size < 1e6,
                [Lost::Estimator(_)] => size > 1e6,
                _ => false,
            };
            assert!(is_expected, "{estimator}, {size:e}: {:?}", flown.lost);
            assert_eq!(odometry.worlds(), 2, "{estimator} begins again");
            assert_honest(&recording, &odometry, &(estimator, size));
        }
    }
}

#[test]
fn what_cannot_be_is_refused_by_name_and_changes_nothing() {
    let recording = flown(6.0, 4);
    let mut flying = odometry(&recording, Estimator::Smoother);
    fly(&mut flying, &recording.readings, &recording.pictures);
    let before = flying.newest();
    let last = recording.readings.iter().rev().find(|r| flying.reading(**r).is_err()).unwrap();
    let back = StampedSample { nanoseconds: last.nanoseconds - 1_000_000_000, ..*last };
    let refused = flying.reading(back).unwrap_err();
    assert!(matches!(refused, OdometryError::LateReading { .. }), "{refused}");
    let mut none = StampedSample { nanoseconds: i64::MAX / 2, ..*last };
    none.sample.gyro.x = f64::NAN;
    let refused = flying.reading(none).unwrap_err();
    assert!(refused.to_string().contains("is not finite; leave it out"), "{refused}");
    let twice = recording.pictures.last().unwrap();
    let refused = flying.picture(twice).unwrap_err();
    assert!(matches!(refused, OdometryError::LatePicture { .. }), "{refused}");
    let mut doubled = twice.clone();
    doubled.nanoseconds += 1_000_000;
    doubled.features[1].track = doubled.features[0].track;
    let refused = flying.picture(&doubled).unwrap_err();
    assert!(matches!(refused, OdometryError::Feature { .. }), "{refused}");
    let mut later = twice.clone();
    later.nanoseconds += 1_000_000;
    later.features[0].pixel.y = f64::INFINITY;
    let refused = flying.picture(&later).unwrap_err();
    assert!(matches!(refused, OdometryError::Feature { .. }), "{refused}");
    later.features.clear();
    later.nanoseconds += 3_600_000_000_000;
    let refused = flying.picture(&later).unwrap_err();
    assert!(matches!(refused, OdometryError::EarlyPicture { .. }), "{refused}");
    assert_eq!(flying.newest(), before);
}

#[test]
fn a_start_that_is_told_outlives_what_does_not_fit_it() {
    let recording = flown(4.0, 5);
    let mut start = Start::at_the_origin(&recording, [0.01, 0.05, 2e-3, 0.02], 5).unwrap();
    (0..9).for_each(|at| start.covariance[(at, at)] += 1e-8);
    for estimator in Estimator::ALL {
        let options = OdometryOptions::new(Sensors::of_flight(&recording.flight), estimator);
        let mut odometry = Odometry::begun(options, &start).unwrap();
        let refused = odometry.reading(recording.readings[10]).unwrap_err();
        assert!(matches!(refused, OdometryError::FirstReading { .. }), "{estimator}: {refused}");
        recording.readings[..100].iter().for_each(|reading| {
            odometry.reading(*reading).unwrap();
        });
        let refused = odometry.picture(&recording.pictures[0]).unwrap_err();
        assert!(matches!(refused, OdometryError::LatePicture { .. }), "{estimator}: {refused}");
        let followed = odometry.picture(&recording.pictures[1]).unwrap();
        assert!(matches!(followed, Progress::Following { .. }), "{estimator}: {followed:?}");
    }
}

/// Pictures of which so many show every pixel somewhere else, and elsewhere in each.
fn with_wrong_tracks(recording: &FlightRecording, wrong: Range<usize>) -> Vec<Picture> {
    let mut pictures = recording.pictures.clone();
    for (number, picture) in pictures[wrong].iter_mut().enumerate() {
        for (at, feature) in picture.features.iter_mut().enumerate() {
            let turn = (7 * at + 3 * number) as f64;
            feature.pixel.x += 150.0 * turn.sin();
            feature.pixel.y += 150.0 * turn.cos();
        }
    }
    pictures
}

/// A filter sees what contradicts it when a track ends, and so for longer.
#[test]
fn tracks_that_are_all_wrong_for_a_second_are_refused() {
    let recording = flown(14.0, 5);
    let pictures = with_wrong_tracks(&recording, 70..80);
    for estimator in Estimator::ALL {
        let mut odometry = odometry(&recording, estimator);
        let (mut refused, mut lost) = (0, Vec::new());
        let told = |_: &Odometry, progress: Progress| match progress {
            Progress::Following { refused: here, .. } => refused += here,
            Progress::Lost(why) => lost.push(why),
            Progress::Waiting | Progress::Standing => {}
        };
        odometry.fly(&recording.readings, &pictures, told).unwrap();
        assert!(refused > 10, "{estimator}: {refused} refused");
        assert!(lost.is_empty() || estimator == Estimator::Msckf, "{estimator}: {lost:?}");
        assert_honest(&recording, &odometry, &estimator);
    }
}

#[test]
fn tracks_that_are_wrong_for_longer_contradict_and_it_begins_again() {
    let recording = flown(18.0, 5);
    for estimator in Estimator::ALL {
        let mut odometry = odometry(&recording, estimator);
        let pictures = with_wrong_tracks(&recording, 70..86);
        let flown = fly(&mut odometry, &recording.readings, &pictures);
        let is_contradicted =
            matches!(flown.lost[..], [Lost::Contradicted { seconds }, ..] if seconds >= 1.0);
        assert!(is_contradicted, "{estimator}: {:?}", flown.lost);
        assert_eq!(odometry.worlds(), 2, "{estimator}: {:?}", flown.lost);
        assert_honest(&recording, &odometry, &estimator);
    }
}

#[test]
fn a_landmark_at_infinity_tells_of_turns_and_nothing_else() {
    let recording = flown(8.0, 6);
    let rig = recording.flight.rig;
    let camera = recording.flight.camera;
    for estimator in Estimator::ALL {
        let mut pictures = recording.pictures.clone();
        let star = Vector3::new(0.3, 1.0, 0.2) * 1e9;
        for (picture, state) in pictures.iter_mut().zip(&recording.truth.states) {
            let seen = rig.camera_from_world(state) * nalgebra::Point3::from(star);
            let Some(pixel) = camera.project_cam(&seen.coords) else { continue };
            let (track, right) = (1_000_000, None);
            picture.features.push(vislam::datasets::tracks::Feature { track, pixel, right });
        }
        let mut odometry = odometry(&recording, estimator);
        let flown = fly(&mut odometry, &recording.readings, &pictures);
        assert!(flown.lost.is_empty(), "{estimator}: {:?}", flown.lost);
        let error = error(&recording, &flown.estimates);
        assert!(error < 0.1, "{estimator}: {error} m");
        assert_honest(&recording, &odometry, &estimator);
    }
}

#[test]
fn without_a_beginning_no_more_is_kept_than_a_beginning_needs() {
    let recording = flown(20.0, 7);
    let mut waiting = odometry(&recording, Estimator::Smoother);
    let mut nothing = recording.pictures.clone();
    nothing.iter_mut().for_each(|picture| picture.features.clear());
    let mut most = 0;
    let told = |odometry: &Odometry, _: Progress| most = most.max(odometry.waiting());
    waiting.fly(&recording.readings, &nothing, told).unwrap();
    assert!(waiting.newest().is_none());
    // Three times the longest span of a start in motion, at ten pictures a second.
    assert!((100..150).contains(&most), "{most} of {} pictures", nothing.len());
}
