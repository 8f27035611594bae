//! A start at rest, and the batch of a whole flight.

mod take_off;

use nalgebra::{Matrix3, SMatrix, Vector2, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use take_off::{LEVER, taking_off};
use vislam::filtering::{Freedom, absolute_trajectory_error, chi_square_band, nees};
use vislam::inertial::{Calibrated, ImuBias, NavState, WindowError};
use vislam::initialization::{
    AlignmentRefused, Batch, BatchError, BeginOptions, LandmarkRefused, MotionOptions, NoStart,
    NotAtRest, RestOptions, Sensors, Started, UniformMotion, VisualMotion, Whole, WholeOptions,
    align_motion, at_rest, begin, in_motion, minima_on_sphere,
};
use vislam::least_squares::{Kernel, Manifold, Options};
use vislam::simulation::{EulerAngles, Flight, FlightRecording, ScalarTrajectory, Trajectory};

/// Standing still, tilted, with the nose anywhere.
fn tilted() -> Trajectory {
    let constant = ScalarTrajectory::constant;
    let angles = EulerAngles { yaw: constant(0.0), pitch: constant(0.3), roll: constant(-0.2) };
    Trajectory { position: [ScalarTrajectory::default(); 3], angles, ..Trajectory::default() }
}

fn flown(flight: &Flight, seed: u64) -> FlightRecording {
    flight.record(&flight.room(3.0, 400, seed).unwrap(), seed).unwrap()
}

fn standing(bias: ImuBias, seed: u64) -> FlightRecording {
    let flight = Flight { seconds: 1.0, initial_bias: bias, ..Flight::new(tilted()) };
    let pixel_sigma = 0.5;
    flown(&Flight { pixel_sigma, ..flight.with_lever(LEVER) }, seed)
}

fn normal3(random: &mut ChaCha8Rng, sigma: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| {
        let number: f64 = StandardNormal.sample(random);
        sigma * number
    })
}

#[test]
fn at_rest_tilt_and_bias_are_as_wrong_as_the_covariance_says() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut sum, runs) = (0.0, 100);
    for seed in 0..runs {
        let accelerometer = normal3(&mut random, RestOptions::default().accelerometer_bias);
        let bias = ImuBias { gyro: normal3(&mut random, 0.01), accelerometer };
        let recording = standing(bias, seed);
        let sensors = Sensors::of_flight(&recording.flight);
        let start =
            at_rest(&sensors, &recording.readings, &recording.pictures, &RestOptions::default());
        let start = start.unwrap();
        // The heading is free: the truth's is taken from the estimate's.
        let truth = recording.truth.states.last().unwrap();
        let ahead = |state: &NavState| state.world_from_body * Vector3::x();
        let yaw = |state: &NavState| ahead(state).y.atan2(ahead(state).x);
        let turn = nalgebra::Rotation3::from_axis_angle(
            &Vector3::z_axis(),
            yaw(&start.state) - yaw(truth),
        );
        let world_from_body = turn * truth.world_from_body;
        let mut step = [0.0; 3];
        start.state.world_from_body.local(&world_from_body, &mut step);
        let accelerometer = recording.truth.biases.last().unwrap().accelerometer;
        let off = accelerometer - start.bias.accelerometer;
        // Tilt and accelerometer bias together, without the turn about the vertical.
        let up = start.state.world_from_body.inverse() * Vector3::z();
        let across = nalgebra::Rotation3::rotation_between(&Vector3::z(), &up).unwrap();
        let mut select = SMatrix::<f64, 5, 15>::zeros();
        select
            .fixed_view_mut::<2, 3>(0, 0)
            .copy_from(&across.matrix().transpose().fixed_rows::<2>(0));
        select.fixed_view_mut::<3, 3>(2, 12).copy_from(&Matrix3::identity());
        let mut error = SMatrix::<f64, 15, 1>::zeros();
        error.fixed_rows_mut::<3>(0).copy_from_slice(&step);
        error.fixed_rows_mut::<3>(12).copy_from(&off);
        let covariance = select * start.covariance * select.transpose();
        sum += 5.0 * nees(&(select * error), &covariance).unwrap();
        let gyro = recording.truth.biases.last().unwrap().gyro - start.bias.gyro;
        let sigma = start.covariance[(9, 9)].sqrt();
        assert!(gyro.amax() < 5.0 * sigma, "gyro bias off by {gyro}, sigma {sigma}");
    }
    let [low, high] = chi_square_band(0.003, 5 * runs as usize).unwrap();
    assert!((low..high).contains(&sum), "sum of {sum}, band from {low} to {high}");
}

#[test]
fn a_body_that_stands_is_at_rest_without_noise_too() {
    let flight = Flight { seconds: 1.0, pixel_sigma: 0.0, ..Flight::new(tilted()) };
    let recording = flown(&flight, 1);
    let sensors = Sensors::of_flight(&flight);
    let options = RestOptions::default();
    assert!(at_rest(&sensors, &recording.readings, &recording.pictures, &options).is_ok());
}

#[test]
fn a_place_on_a_sphere_is_least_or_all_are() {
    let anywhere = minima_on_sphere(&Matrix3::identity(), &Vector3::zeros(), 1.0);
    assert_eq!(anywhere, None);
    let on_a_circle = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 2.0));
    let (one, other) = minima_on_sphere(&on_a_circle, &Vector3::zeros(), 1.0).unwrap();
    assert!((one.value - 1.0).abs() < 1e-12 && (other.unwrap().value - 1.0).abs() < 1e-12);
    let no_number = Vector3::new(f64::NAN, 0.0, 0.0);
    assert_eq!(minima_on_sphere(&on_a_circle, &no_number, 1.0), None);
    assert_eq!(minima_on_sphere(&on_a_circle, &Vector3::zeros(), 0.0), None);
}

#[test]
fn a_body_that_moves_is_not_at_rest() {
    let options = RestOptions::default();
    let flight = Flight { seconds: 1.0, ..Flight::new(Trajectory::figure_eight()) };
    let moving = flown(&flight, 1);
    let sensors = Sensors::of_flight(&flight);
    let refused = at_rest(&sensors, &moving.readings, &moving.pictures, &options).unwrap_err();
    assert!(matches!(refused, NotAtRest::Motion { .. }), "{refused}");

    // Pictures of a camera that hangs still, and a force that is not gravity's.
    let still = standing(ImuBias::default(), 2);
    let mut pushed = still.readings.clone();
    pushed.iter_mut().for_each(|reading| reading.sample.accelerometer.z += 2.0);
    let refused = at_rest(&sensors, &pushed, &still.pictures, &options).unwrap_err();
    assert!(matches!(refused, NotAtRest::Force { .. }), "{refused}");

    let mut nothing = still.pictures.clone();
    nothing.iter_mut().for_each(|picture| picture.features.clear());
    let refused = at_rest(&sensors, &still.readings, &nothing, &options).unwrap_err();
    assert!(matches!(refused, NotAtRest::Features { found: 0, .. }), "{refused}");
    let refused = at_rest(&sensors, &still.readings, &[], &options).unwrap_err();
    assert!(matches!(refused, NotAtRest::Features { found: 0, .. }), "{refused}");
    let mut hole = still.readings.clone();
    hole.drain(60..130);
    let refused = at_rest(&sensors, &hole, &still.pictures, &options).unwrap_err();
    assert!(matches!(refused, NotAtRest::Readings(WindowError::Gap { .. })), "{refused}");
    let refused = at_rest(&sensors, &still.readings[..50], &still.pictures, &options).unwrap_err();
    assert!(matches!(refused, NotAtRest::Readings(WindowError::NotCovered { .. })), "{refused}");
}

/// Two seconds in flight, and the truth at each picture.
fn flying(seed: u64) -> (FlightRecording, Vec<i64>, Vec<(NavState, ImuBias)>) {
    let motion = Trajectory::figure_eight();
    let bias = ImuBias {
        gyro: Vector3::new(0.01, -0.02, 0.005),
        accelerometer: Vector3::new(0.05, -0.03, 0.02),
    };
    let flight = Flight {
        seconds: 3.0,
        picture_rate: 5.0,
        tracks: 40,
        initial_bias: bias,
        ..Flight::new(motion).with_lever(LEVER)
    };
    let recording = flown(&flight, seed);
    let times = recording.pictures.iter();
    let times = times.map(|picture| flight.rig.imu_nanoseconds(picture.nanoseconds)).collect();
    let truth = &recording.truth;
    let truth = truth.states.iter().copied().zip(truth.biases.iter().copied()).collect();
    (recording, times, truth)
}

/// Adds each landmark that is seen from three states or more, where it is.
fn add_landmarks(batch: &mut Batch, recording: &FlightRecording) {
    let truth = &recording.truth;
    for (track, landmark) in truth.landmark_of_track.iter().enumerate() {
        let seen = recording.pictures.iter().enumerate().flat_map(|(state, picture)| {
            let of_track = picture.features.iter().filter(move |feature| feature.track == track);
            of_track.map(move |feature| (state, feature.pixel))
        });
        let sightings: Vec<(usize, Vector2<f64>)> = seen.collect();
        if sightings.len() >= 3 {
            let place = truth.landmarks[*landmark];
            batch.add_landmark(track, place, &sightings, Kernel::Squared).unwrap();
        }
    }
}

#[test]
fn the_errors_of_a_batch_are_as_large_as_its_covariance_says() {
    let (mut sum, runs) = (0.0, 30);
    for seed in 0..runs {
        let (recording, times, truth) = flying(seed);
        let sensors = Sensors::of_flight(&recording.flight);
        let guess: Vec<_> = truth
            .iter()
            .map(|(state, bias)| (state.retract(&[0.01; 9]), bias.retract(&[2e-3; 6])))
            .collect();
        let mut batch = Batch::new(&sensors, &recording.readings, &times, &guess).unwrap();
        add_landmarks(&mut batch, &recording);
        let (state, bias) = truth[0];
        let free = f64::INFINITY;
        let state_sigmas = [1e-4, 1e-4, 1e-4, free, free, free, 1e-4, 1e-4, 1e-4];
        batch.know((state, bias), state_sigmas, [free; 6]).unwrap();
        let solution = batch.solve(&Options::default()).unwrap();
        assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
        let covariance = batch.covariance(&solution.values).unwrap();
        let last = *batch.states.last().unwrap();
        let mut error = SMatrix::<f64, 9, 1>::zeros();
        let estimate = solution.values[last];
        estimate.local(&truth.last().unwrap().0, error.as_mut_slice());
        let covariance = covariance.of(last).unwrap();
        sum +=
            9.0 * nees(&error, &SMatrix::<f64, 9, 9>::from_fn(|r, c| covariance[(r, c)])).unwrap();
    }
    let [low, high] = chi_square_band(0.003, 9 * runs as usize).unwrap();
    assert!((low..high).contains(&sum), "sum of {sum}, band from {low} to {high}");
}

#[test]
fn a_batch_finds_the_camera_and_its_clock() {
    let (recording, times, truth) = flying(3);
    let mut sensors = Sensors::of_flight(&recording.flight);
    sensors.calibrated = Calibrated { extrinsics: Some([0.05, 0.05]), time_offset: Some(0.02) };
    let real = sensors.rig.body_from_camera;
    let (shift, turn) = ([0.03, -0.02, 0.02], [0.01, 0.02, -0.01]);
    sensors.rig.body_from_camera = real.retract(&[shift, turn].concat());
    let late = |time: &i64| time - 5_000_000;
    // Five milliseconds early on the sensor's clock, so the pictures were taken five later.
    let times: Vec<i64> = times[1..].iter().map(late).collect();
    let mut early = recording.clone();
    early.pictures.remove(0);
    let mut batch = Batch::new(&sensors, &recording.readings, &times, &truth[1..]).unwrap();
    add_landmarks(&mut batch, &early);
    batch.fix_gauge().unwrap();
    let solution = batch.solve(&Options::default()).unwrap();
    let covariance = batch.covariance(&solution.values).unwrap();
    let delay = solution.values[batch.delay].x;
    let sigma = covariance.of(batch.delay).unwrap()[(0, 0)].sqrt();
    assert!((delay - 0.005).abs() < 4.0 * sigma && sigma < 4e-3, "{delay} s within {sigma}");
    let mut off = [0.0; 6];
    solution.values[batch.extrinsics].local(&real, &mut off);
    let spread = covariance.of(batch.extrinsics).unwrap();
    for (axis, off) in off.iter().enumerate() {
        let sigma = spread[(axis, axis)].sqrt();
        assert!(
            off.abs() < 4.0 * sigma && sigma < 0.049,
            "coordinate {axis}: {off} within {sigma}"
        );
    }
}

#[test]
fn a_start_is_a_prior_of_the_first_state_and_its_bias_together() {
    let (recording, times, truth) = flying(4);
    let sensors = Sensors::of_flight(&recording.flight);
    let mut start = vislam::msckf::Start::drawn(&recording, &[0.05; 15], 4).unwrap();
    start.covariance[(0, 12)] = 2e-3;
    start.covariance[(12, 0)] = 2e-3;
    let mut batch = Batch::new(&sensors, &recording.readings, &times, &truth).unwrap();
    batch.know_start(0, &start).unwrap();
    // Readings alone add nothing to what is known of the first state.
    let solution = batch.solve(&Options::default()).unwrap();
    let mut off = [0.0; 9];
    start.state.local(&solution.values[batch.states[0]], &mut off);
    assert!(off.iter().all(|number| number.abs() < 1e-6), "{off:?}");
    let covariance = batch.covariance(&solution.values).unwrap();
    let known = start.covariance.fixed_view::<9, 9>(0, 0).into_owned();
    let found = covariance.of(batch.states[0]).unwrap();
    assert!((found - known).amax() < 1e-6);
    start.covariance[(3, 3)] = -1.0;
    assert!(matches!(batch.know_start(0, &start), Err(BatchError::Whitening(_))));
}

#[test]
fn what_cannot_be_a_batch_is_refused() {
    let (recording, times, truth) = flying(5);
    let sensors = Sensors::of_flight(&recording.flight);
    let readings = &recording.readings;
    let error = |times: &[i64], guess: &[(NavState, ImuBias)]| {
        Batch::new(&sensors, readings, times, guess).err().expect("this is no batch")
    };
    assert_eq!(error(&times[..1], &truth[..1]), BatchError::States { states: 1, guesses: 1 });
    assert_eq!(error(&times[..3], &truth[..2]), BatchError::States { states: 3, guesses: 2 });
    let backwards = [times[1], times[0]];
    let expected = WindowError::Order { start: times[1], end: times[0] };
    assert_eq!(error(&backwards, &truth[..2]), BatchError::Readings(expected));
    let between_two = [times[1] + 1_000_000, times[1] + 2_000_000];
    assert!(Batch::new(&sensors, readings, &between_two, &truth[..2]).is_ok());

    let with_gap = |gap: [f64; 2]| {
        let lost = flown(&Flight { gap: Some(gap), ..recording.flight.clone() }, 5);
        Batch::new(&sensors, &lost.readings, &times, &truth).err().unwrap()
    };
    for gap in [[1.0, 1.5], [1.05, 1.15]] {
        let error = with_gap(gap);
        assert!(matches!(error, BatchError::Readings(WindowError::Gap { .. })), "{error}");
    }

    let mut batch = Batch::new(&sensors, readings, &times, &truth).unwrap();
    let beyond = [(0, Vector2::zeros()), (99, Vector2::zeros())];
    let error = batch.add_landmark(3, Vector3::zeros(), &beyond, Kernel::Squared).unwrap_err();
    assert_eq!(error, BatchError::Sighting { track: 3, state: 99, states: times.len() });
    let beyond = BatchError::State { state: times.len(), states: times.len() };
    assert_eq!(batch.stand_still(times.len(), 0.1).unwrap_err(), beyond);
    let start = vislam::msckf::Start::drawn(&recording, &[0.05; 15], 5).unwrap();
    assert_eq!(batch.know_start(times.len(), &start).unwrap_err(), beyond);
    let nothing_known = batch.covariance(&batch.problem.values().clone());
    assert!(nothing_known.is_err());
}

/// Two seconds of a motion, ten pictures a second.
fn for_two_seconds(motion: Trajectory, seed: u64) -> FlightRecording {
    let accelerometer = Vector3::new(0.05, -0.08, 0.03);
    let initial_bias = ImuBias { gyro: Vector3::new(0.02, -0.03, 0.05), accelerometer };
    let flight = Flight { seconds: 2.0, picture_rate: 10.0, initial_bias, ..Flight::new(motion) };
    let flight = Flight { pixel_sigma: 0.5, tracks: 60, ..flight };
    flown(&flight.with_lever(LEVER), seed)
}

fn started(recording: &FlightRecording) -> Result<Started, NoStart> {
    let sensors = Sensors::of_flight(&recording.flight);
    in_motion(&sensors, &recording.readings, &recording.pictures, &MotionOptions::default())
}

#[test]
fn a_start_in_motion_knows_its_scale_and_its_tilt_as_well_as_it_says() {
    let (mut scales, runs) = (0.0, 20);
    for seed in 0..runs {
        let recording = for_two_seconds(Trajectory::figure_eight(), seed);
        let found = started(&recording).unwrap_or_else(|error| panic!("flight {seed}: {error}"));
        let states: Vec<NavState> =
            found.batch.states.iter().map(|key| found.values[*key]).collect();
        let truth: Vec<NavState> =
            found.pictures.iter().map(|picture| recording.truth.states[*picture]).collect();
        let away = |states: &[NavState], place: usize| {
            (states[place].position - states[0].position).norm()
        };
        let farthest =
            (0..states.len()).max_by(|a, b| away(&states, *a).total_cmp(&away(&states, *b)));
        let farthest = farthest.unwrap();
        let off = away(&states, farthest) / away(&truth, farthest) - 1.0;
        scales += (off / found.scale_sigma).powi(2);
        let up = |state: &NavState| state.world_from_body.inverse() * Vector3::z();
        let tilt = up(&states[0]).angle(&up(&truth[0]));
        assert!(tilt < 4.0 * found.tilt_sigma, "{tilt} rad within {}", found.tilt_sigma);
        assert!(found.scale_sigma < 0.1 && found.tilt_sigma < 1f64.to_radians());
    }
    let [low, high] = chi_square_band(0.003, runs as usize).unwrap();
    assert!((low..high).contains(&scales), "sum of {scales}, band from {low} to {high}");
}

#[test]
fn motions_that_hide_their_scale_are_refused_by_name() {
    let linear = ScalarTrajectory::linear;
    let straight =
        Trajectory { position: [linear(0.6), linear(0.3), linear(0.1)], ..Trajectory::default() };
    let name = |motion: Trajectory| match started(&for_two_seconds(motion, 1)) {
        Err(NoStart::Uniform { motion, .. }) => Some(motion),
        Err(error) => panic!("{error}"),
        Ok(found) => panic!("the scale is known within {}", found.scale_sigma),
    };
    assert_eq!(name(straight), Some(UniformMotion::ConstantVelocity));
    let pushed = |rate: f64, acceleration: f64| ScalarTrajectory { acceleration, ..linear(rate) };
    let level = Trajectory {
        position: [pushed(0.3, 0.4), pushed(0.2, -0.2), ScalarTrajectory::default()],
        ..Trajectory::default()
    };
    assert_eq!(name(level), Some(UniformMotion::ConstantAcceleration));
    let hover = started(&for_two_seconds(Trajectory::hover(), 1)).err().unwrap();
    assert!(matches!(hover, NoStart::Hover { .. }), "{hover}");
}

#[test]
fn what_does_not_align_is_refused() {
    let recording = for_two_seconds(Trajectory::figure_eight(), 2);
    let sensors = Sensors::of_flight(&recording.flight);
    let motion = VisualMotion::of(&sensors, &recording.pictures).unwrap();
    let align = |motion: &VisualMotion, readings| align_motion(&sensors, readings, motion, 0.1);
    let aligned = align(&motion, &recording.readings).unwrap();
    assert!(aligned.beyond > 0.0);
    let gravity = aligned.gravity.norm();
    assert!((gravity - sensors.gravity).abs() < 1e-9, "gravity of {gravity}");

    let mut few = motion.clone();
    few.pictures.truncate(3);
    few.nanoseconds.truncate(3);
    few.rotations.truncate(3);
    few.centres.truncate(3);
    few.landmarks.clear();
    let refused = align(&few, &recording.readings).unwrap_err();
    assert_eq!(refused, AlignmentRefused::Cameras { found: 3 });
    let refused = align(&motion, &recording.readings[100..]).unwrap_err();
    assert!(matches!(refused, AlignmentRefused::Readings(WindowError::NotCovered { .. })));
    // Everything mirrored: forces point the other way.
    let mut mirrored = motion.clone();
    mirrored.centres.iter_mut().for_each(|centre| *centre = -*centre);
    let refused = align(&mirrored, &recording.readings).unwrap_err();
    assert!(matches!(refused, AlignmentRefused::Scale { .. }), "{refused}");

    let mut broken = recording.readings.clone();
    broken[100].sample.accelerometer.x = f64::NAN;
    let refused = align(&motion, &broken).unwrap_err();
    assert!(matches!(refused, AlignmentRefused::Preintegration(_)), "{refused}");

    let (pictures, mut unlike) = (motion.pictures.len(), motion.clone());
    unlike.rotations.pop();
    let refused = align(&unlike, &recording.readings).unwrap_err();
    let [times, rotations, centres] = [pictures, pictures - 1, pictures];
    assert_eq!(refused, AlignmentRefused::Lists { pictures, times, rotations, centres });
    unlike.nanoseconds.pop();
    assert_eq!(unlike.uniform(&sensors), None);
    let mut beyond = motion.clone();
    let (track, landmark) = beyond.landmarks.iter_mut().next_back().unwrap();
    landmark.sightings[1].0 = pictures;
    let sighting = AlignmentRefused::Sighting { track: *track, place: pictures, pictures };
    assert_eq!(align(&beyond, &recording.readings).unwrap_err(), sighting);
}

/// Begins a flight and makes the batch of all of it.
fn whole(recording: &FlightRecording, options: &WholeOptions) -> (f64, Whole) {
    let sensors = Sensors::of_flight(&recording.flight);
    let (readings, pictures) = (&recording.readings, &recording.pictures);
    let begun = begin(&sensors, readings, pictures, &BeginOptions::default()).unwrap();
    let seconds = begun.seconds;
    (seconds, Whole::grown(&sensors, readings, pictures, begun.known, options).unwrap())
}

fn position_error(whole: &Whole, recording: &FlightRecording) -> f64 {
    let estimate: Vec<NavState> = whole.batch.states.iter().map(|key| whole.values[*key]).collect();
    absolute_trajectory_error(&estimate, &recording.truth.states, Freedom::Four).unwrap().position
}

#[test]
fn the_batch_of_a_flight_grows_from_a_start_in_motion() {
    let motion = Trajectory::figure_eight();
    let flight = Flight { seconds: 6.0, picture_rate: 10.0, tracks: 40, ..Flight::new(motion) };
    let recording = flown(&flight.with_lever(LEVER), 3);
    let (seconds, found) = whole(&recording, &WholeOptions::default());
    assert!(seconds < 3.0, "begun after {seconds} s");
    assert_eq!(found.batch.states.len(), recording.pictures.len());
    let error = position_error(&found, &recording);
    assert!(error < 0.03, "{error} m off");
    let tracks = recording.truth.landmark_of_track.len();
    assert_eq!(found.batch.landmarks.len() + found.refused.len(), tracks);
}

#[test]
fn the_batch_of_a_flight_grows_from_a_stand_and_wrong_tracks_are_refused() {
    // Two seconds still, and then away ever faster, rising.
    let mut recording = taking_off(5);
    let wrong = recording.pictures[70].features[0].track;
    for picture in &mut recording.pictures[60..] {
        for feature in picture.features.iter_mut().filter(|feature| feature.track == wrong) {
            feature.pixel += Vector2::new(40.0, -30.0);
        }
    }
    let (seconds, found) = whole(&recording, &WholeOptions::default());
    assert!((1.5..3.0).contains(&seconds), "begun after {seconds} s");
    let error = position_error(&found, &recording);
    assert!(error < 0.05, "{error} m off");
    assert!(found.refused.contains_key(&wrong));
    let by_gate = |why: &LandmarkRefused| matches!(why, LandmarkRefused::Gate { .. });
    assert!(found.refused.values().filter(|why| by_gate(why)).count() < 5);
}

#[test]
fn a_body_that_need_not_stand_begins_all_the_same() {
    let recording = taking_off(5);
    let sensors = Sensors::of_flight(&recording.flight);
    for stand in [0.0, -1.0, f64::NAN] {
        let options = BeginOptions { stand, ..BeginOptions::default() };
        let begun = begin(&sensors, &recording.readings, &recording.pictures, &options);
        assert!(begun.is_ok_and(|begun| begun.seconds > 2.0), "{stand}");
        let still = BeginOptions { stand, ..BeginOptions::at_rest() };
        let still = begin(&sensors, &recording.readings, &recording.pictures, &still);
        assert!(matches!(still, Err(NoStart::NoStand { .. })), "{stand}");
    }
}

#[test]
fn a_flight_without_a_beginning_says_why() {
    let straight =
        Trajectory { position: [ScalarTrajectory::linear(0.6); 3], ..Trajectory::default() };
    let recording = for_two_seconds(straight, 1);
    let sensors = Sensors::of_flight(&recording.flight);
    let options = BeginOptions::default();
    let beginning = |pictures: &[_]| begin(&sensors, &recording.readings, pictures, &options);
    let error = beginning(&recording.pictures).unwrap_err();
    assert!(matches!(error, NoStart::Uniform { .. } | NoStart::Pictures(_)), "{error}");
    let error = beginning(&recording.pictures[..1]).unwrap_err();
    assert_eq!(error, NoStart::TooShort { pictures: 1, seconds: 2.0 });
    assert_eq!(beginning(&[]).unwrap_err(), NoStart::TooShort { pictures: 0, seconds: 2.0 });
}

#[test]
fn a_stand_after_a_flight_is_not_taken_for_one_from_the_first_picture_on() {
    const STANDS: &[[f64; 2]] = &[[3.0, 6.0]];
    let motion = Trajectory::figure_eight().with_stands(STANDS);
    let flight = Flight { seconds: 6.0, tracks: 40, picture_rate: 5.0, ..Flight::new(motion) };
    let recording = flown(&flight, 1);
    let sensors = Sensors::of_flight(&flight);
    let options = BeginOptions::at_rest();
    let begun = begin(&sensors, &recording.readings, &recording.pictures, &options).unwrap();
    let stand = begun.known.standing;
    assert!(stand.len() > 5, "{stand:?}");
    for picture in stand {
        let speed = recording.truth.states[picture].velocity.norm();
        assert!(speed < 0.02, "picture {picture} moves with {speed} m/s");
    }
}

/// In the last tenth of a second of a window the body may have set out unseen.
#[test]
fn a_stand_that_ends_is_left_before_the_body_sets_out() {
    const ENDS: [[[f64; 2]; 1]; 5] =
        [[[-1.0, 2.0]], [[-1.0, 2.05]], [[-1.0, 2.1]], [[-1.0, 2.15]], [[-1.0, 2.2]]];
    for stands in &ENDS {
        let motion = Trajectory::figure_eight().with_stands(stands);
        let flight = Flight { seconds: 4.0, tracks: 40, ..Flight::new(motion) };
        let flight = Flight { picture_rate: 5.0, ..flight };
        let recording = flight.record(&flight.room(3.0, 400, 1).unwrap(), 1).unwrap();
        let sensors = Sensors::of_flight(&flight);
        let begun = |options| begin(&sensors, &recording.readings, &recording.pictures, &options);
        for options in [BeginOptions::default(), BeginOptions::at_rest()] {
            let (_, start) = begun(options).unwrap().start;
            let truth = motion.at(1e-9 * start.nanoseconds as f64).state;
            assert!(truth.velocity.norm() < 1e-9, "{stands:?}: {}", truth.velocity);
        }
        let never = Flight { motion: Trajectory::figure_eight(), ..flight };
        let never = never.record(&never.room(3.0, 400, 1).unwrap(), 1).unwrap();
        let begun = begin(&sensors, &never.readings, &never.pictures, &BeginOptions::at_rest());
        assert!(matches!(begun.unwrap_err(), NoStart::NoStand { .. }));
    }
}
