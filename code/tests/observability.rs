//! What windows of pictures and inertial readings leave free, by motion and by what is assumed of
//! the biases.

use approx::assert_abs_diff_eq;
use nalgebra::{DMatrix, DVector, Rotation3, Vector2, Vector3};
use vislam::factors::{pixel_by_state, twist_by_state};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, NavState};
use vislam::least_squares::{Manifold, NullSpaceError, Spectrum};
use vislam::manifold::{se3, so3};
use vislam::observability::{
    BiasAssumption, Direction, ObservabilityError, Similarity, UnknownCalibration, Window,
};
use vislam::simulation::{EulerAngles, Flight, ScalarTrajectory, Trajectory, landmarks_around};

const ACCELERATION: Vector3<f64> = Vector3::new(0.7, -0.3, 0.4);
const LEVEL: Vector3<f64> = Vector3::new(0.7, -0.3, 0.0);
const VELOCITY: Vector3<f64> = Vector3::new(1.0, 0.5, 0.2);
const LEVER: Vector3<f64> = Vector3::new(0.1, 0.05, -0.03);

fn window(motion: Trajectory, assumption: BiasAssumption) -> Window {
    Flight::brief(motion).window(&landmarks_around(&Vector3::zeros(), 60), assumption).unwrap()
}

/// About all axes.
fn turning() -> EulerAngles {
    Trajectory::figure_eight().angles
}

fn pitching() -> EulerAngles {
    EulerAngles { pitch: ScalarTrajectory::wave(0.3, 1.3, 1.0), ..EulerAngles::default() }
}

/// With an acceleration that changes in size and direction.
fn swaying(angles: EulerAngles) -> Trajectory {
    let position = [
        ScalarTrajectory::wave(0.3, 2.0, 0.0),
        ScalarTrajectory::wave(0.4, 3.0, 0.0),
        ScalarTrajectory::wave(0.2, 2.5, 0.0),
    ];
    Trajectory { position, angles, ..Trajectory::default() }
}

/// What is free when the biases are unknown, and when they are known. What is said of constant
/// biases must hold for walking ones.
fn free(motion: Trajectory) -> [String; 2] {
    let noise = ImuNoise::euroc();
    let [constant, walking, known] =
        [BiasAssumption::CONSTANT, BiasAssumption::walking(noise), BiasAssumption::KNOWN]
            .map(|assumption| window(motion, assumption).free_directions().unwrap().to_string());
    assert_eq!(constant, walking);
    [constant, known]
}

#[test]
fn what_a_window_sees_fits_it_exactly_whatever_the_clock_of_the_camera() {
    let mut flight = Flight::brief(Trajectory::figure_eight()).with_lever(LEVER);
    flight.rig.time_offset = 0.01;
    let landmarks = landmarks_around(&Vector3::zeros(), 60);
    let window = flight.window(&landmarks, BiasAssumption::CONSTANT).unwrap();
    assert!(window.residual().unwrap().norm() < 1e-6);
}

#[test]
fn one_state_goes_to_another_by_the_turn_about_the_vertical_that_leaves_least() {
    let turned = |yaw: f64, pitch: f64| NavState {
        world_from_body: Rotation3::from_euler_angles(0.0, 0.0, yaw)
            * Rotation3::from_euler_angles(pitch, 0.0, 0.0),
        ..NavState::origin()
    };
    let by = |to: &NavState| Similarity::between(&turned(0.0, 0.0), to).rotation;
    for (yaw, pitch) in [(2.5, 0.1), (1.5, 1.5), (-0.4, 0.0)] {
        let (found, known) = (by(&turned(yaw, pitch)), Rotation3::from_euler_angles(0.0, 0.0, yaw));
        assert_abs_diff_eq!(found, known, epsilon = 1e-12);
    }
}

const POSITION: &str = "translation x, translation y, translation z";

#[test]
fn with_enough_excitation_four_directions_are_free_and_no_bias_matters() {
    let four = format!("4: {POSITION}, yaw");
    assert_eq!(free(Trajectory::figure_eight()), [four.clone(), four]);
}

#[test]
fn at_constant_velocity_scale_is_free_even_with_known_biases() {
    let five = format!("5: {POSITION}, yaw, scale");
    let turning = Trajectory::constant_velocity(&VELOCITY, turning());
    assert_eq!(free(turning), [five.clone(), five.clone()]);
    let seven = format!("7: {POSITION}, tilt x, tilt y, yaw, scale");
    let straight = Trajectory::constant_velocity(&VELOCITY, EulerAngles::default());
    assert_eq!(free(straight), [seven, five]);
}

#[test]
fn an_acceleration_constant_in_the_body_hides_scale_in_an_unknown_bias() {
    let five = format!("5: {POSITION}, yaw, scale");
    let four = format!("4: {POSITION}, yaw");
    let turning = Trajectory::constant_body_acceleration(&ACCELERATION, 0.5);
    assert_eq!(free(turning), [five.clone(), four.clone()]);
    assert_eq!(free(Trajectory::level_turn(1.0, 0.5)), [five, four]);
}

#[test]
fn without_rotation_tilt_hides_in_an_unknown_bias() {
    let six = format!("6: {POSITION}, tilt x, tilt y, yaw");
    let four = format!("4: {POSITION}, yaw");
    assert_eq!(free(swaying(EulerAngles::default())), [six, four]);
}

#[test]
fn turning_about_a_horizontal_axis_leaves_one_tilt() {
    let five = format!("5: {POSITION}, tilt x, yaw");
    let four = format!("4: {POSITION}, yaw");
    assert_eq!(free(swaying(pitching())), [five, four]);
}

#[test]
fn a_ship_that_rolls_on_its_course_knows_neither_its_size_nor_how_far_its_bow_is_down() {
    let rolling =
        EulerAngles { roll: ScalarTrajectory::wave(0.3, 0.9, 0.0), ..EulerAngles::default() };
    let ship = Trajectory::constant_velocity(&Vector3::x(), rolling);
    let six = format!("6: {POSITION}, tilt y, yaw, scale");
    let five = format!("5: {POSITION}, yaw, scale");
    assert_eq!(free(ship), [six, five]);
}

#[test]
fn constant_acceleration_without_rotation_hides_scale_and_tilt_in_an_unknown_bias() {
    let seven = format!("7: {POSITION}, tilt x, tilt y, yaw, scale");
    let four = format!("4: {POSITION}, yaw");
    let motion = Trajectory::constant_acceleration(&ACCELERATION, EulerAngles::default());
    assert_eq!(free(motion), [seven, four]);
}

#[test]
fn a_constant_level_acceleration_mixes_scale_with_tilt_even_with_known_biases() {
    let seven = format!("7: {POSITION}, tilt x, tilt y, yaw, scale");
    let five = format!("5: {POSITION}, yaw, scale with tilt x with tilt y");
    let straight = Trajectory::constant_acceleration(&LEVEL, EulerAngles::default());
    assert_eq!(free(straight), [seven, five.clone()]);
    assert_eq!(free(Trajectory::constant_acceleration(&LEVEL, turning())), [five.clone(), five]);

    // It is the mixture in which gravity leans as the acceleration grows: e × g = −a.
    let window = window(straight, BiasAssumption::KNOWN);
    let parts = window.free_directions().unwrap().mixtures[0].parts.clone();
    let factor = |of| parts.iter().find(|(part, _)| *part == of).unwrap().1;
    let scale = factor(Direction::Scale);
    let turn = Vector3::new(factor(Direction::Tilt(0)), factor(Direction::Tilt(1)), 0.0) / scale;
    assert_abs_diff_eq!(turn.cross(&GRAVITY), -LEVEL, epsilon = 1e-6);
}

#[test]
fn standing_still_every_landmark_keeps_its_depth() {
    for (motion, tilts) in [(Trajectory::hover(), true), (Trajectory::turn_on_the_spot(0.4), false)]
    {
        let landmarks = window(motion, BiasAssumption::KNOWN).landmarks.len();
        let depths = format!("depth of {landmarks} landmarks");
        let known = format!("{}: {POSITION}, yaw, {depths}", landmarks + 4);
        let unknown = format!("{}: {POSITION}, tilt x, tilt y, yaw, {depths}", landmarks + 6);
        assert_eq!(free(motion), [if tilts { unknown } else { known.clone() }, known]);
    }
}

#[test]
fn pictures_alone_leave_seven_directions_free() {
    let seven = format!("7: {POSITION}, tilt x, tilt y, yaw, scale");
    for motion in [Trajectory::figure_eight(), Trajectory::level_turn(1.0, 0.5)] {
        let mut window = window(motion, BiasAssumption::KNOWN);
        window.intervals.clear();
        assert_eq!(window.free_directions().unwrap().to_string(), seven);
    }
}

/// The degenerate motions of online calibration, as Yang and Huang (2019) have them, with known
/// biases.
#[test]
fn calibration_is_free_where_the_motion_does_not_excite_it() {
    let free = |trajectory, calibration| {
        let flight = Flight::brief(trajectory).with_lever(LEVER);
        let landmarks = landmarks_around(&Vector3::zeros(), 60);
        let mut window = flight.window(&landmarks, BiasAssumption::KNOWN).unwrap();
        window.calibration = calibration;
        window.free_directions().unwrap().to_string()
    };
    let extrinsics = UnknownCalibration { extrinsics: true, time_offset: false };
    let both = UnknownCalibration { extrinsics: true, time_offset: true };
    let offset = UnknownCalibration { extrinsics: false, time_offset: true };
    let four = format!("4: {POSITION}, yaw");
    // Turning about two axes or more determines all of it.
    for calibration in [extrinsics, offset, both] {
        assert_eq!(free(Trajectory::figure_eight(), calibration), four);
    }
    // Without rotation the lever arm is free, and about one axis its part along that axis.
    let seven = format!("7: {POSITION}, yaw, lever arm x, lever arm y, lever arm z");
    assert_eq!(free(swaying(EulerAngles::default()), both), seven);
    assert_eq!(free(swaying(pitching()), both), format!("5: {POSITION}, yaw, lever arm y"));
    // Where readings are constant, a flight looks the same a moment later, and no picture tells how
    // late it is.
    let straight = Trajectory::constant_velocity(&VELOCITY, EulerAngles::default());
    assert_eq!(free(straight, offset), format!("6: {POSITION}, yaw, scale, 1 without a name"));
    let falling = Trajectory::constant_acceleration(&ACCELERATION, EulerAngles::default());
    assert_eq!(free(falling, offset), format!("5: {POSITION}, yaw, 1 without a name"));
}

#[test]
fn an_unknown_gyroscope_bias_frees_nothing() {
    let gyro = BiasAssumption { accelerometer_known: true, ..BiasAssumption::CONSTANT };
    for motion in
        [Trajectory::figure_eight(), Trajectory::hover(), Trajectory::level_turn(1.0, 0.5)]
    {
        let free = |assumption| window(motion, assumption).free_directions().unwrap().to_string();
        assert_eq!(free(gyro), free(BiasAssumption::KNOWN));
    }
}

#[test]
fn it_is_the_camera_whose_acceleration_counts() {
    let free = |motion, assumption| {
        let flight = Flight::brief(motion).with_lever(LEVER);
        let window = flight.window(&landmarks_around(&Vector3::zeros(), 60), assumption).unwrap();
        window.free_directions().unwrap().to_string()
    };
    let five = format!("5: {POSITION}, yaw, scale");
    let four = format!("4: {POSITION}, yaw");
    // A body at constant velocity that turns swings its camera about.
    let coasting = Trajectory::constant_velocity(&VELOCITY, turning());
    assert_eq!(free(coasting, BiasAssumption::CONSTANT), four);
    // A camera on an arm has a baseline when the body turns on the spot.
    let spot = Trajectory::turn_on_the_spot(0.4);
    assert_eq!(free(spot, BiasAssumption::CONSTANT), five);
    assert_eq!(free(spot, BiasAssumption::KNOWN), four);
}

#[test]
fn without_gravity_acceleration_still_fixes_scale() {
    let mut flight = Flight::brief(Trajectory::figure_eight());
    flight.gravity = Vector3::zeros();
    let landmarks = landmarks_around(&Vector3::zeros(), 60);
    for assumption in [BiasAssumption::CONSTANT, BiasAssumption::KNOWN] {
        let free = flight.window(&landmarks, assumption).unwrap().free_directions().unwrap();
        assert_eq!(free.to_string(), format!("6: {POSITION}, tilt x, tilt y, yaw"));
    }
}

#[test]
fn three_pictures_are_enough_with_known_biases_and_four_without() {
    let count = |states, assumption| {
        let flight = Flight {
            seconds: 0.25 * f64::from(states - 1),
            ..Flight::brief(Trajectory::figure_eight())
        };
        let window = flight.window(&landmarks_around(&Vector3::zeros(), 90), assumption).unwrap();
        window.free_directions().unwrap().count()
    };
    assert_eq!([2, 3, 4, 5].map(|states| count(states, BiasAssumption::KNOWN)), [7, 4, 4, 4]);
    assert_eq!([2, 3, 4, 5].map(|states| count(states, BiasAssumption::CONSTANT)), [10, 7, 4, 4]);
}

// ANCHOR: worked_example
#[test]
fn a_level_turn_of_another_size_reads_the_same_with_another_bias() {
    let flight = Flight::brief(Trajectory::level_turn(1.0, 0.5));
    let landmarks = landmarks_around(&Vector3::zeros(), 60);
    let larger = Similarity { scale: 1.1, ..Similarity::identity() };

    let window = flight.window(&landmarks, BiasAssumption::CONSTANT).unwrap();
    let copy = window.transformed(&larger);
    assert_abs_diff_eq!(copy.biases[0].accelerometer.y, -0.05, epsilon = 1e-9);
    assert!(copy.residual().unwrap().norm() < 1e-6);
    let free = window.free_directions().unwrap().to_string();
    assert_eq!(free, "5: translation x, translation y, translation z, yaw, scale");

    let window = flight.window(&landmarks, BiasAssumption::KNOWN).unwrap();
    let copy = window.transformed(&larger);
    assert!(copy.residual().unwrap().norm() > 10.0);
    let free = window.free_directions().unwrap().to_string();
    assert_eq!(free, "4: translation x, translation y, translation z, yaw");
}
// ANCHOR_END: worked_example

/// A window moved off the truth, so that no residual is zero.
fn disturbed(motion: Trajectory, assumption: BiasAssumption) -> Window {
    let flight = Flight::brief(motion).with_lever(LEVER);
    let window = flight.window(&landmarks_around(&Vector3::zeros(), 60), assumption).unwrap();
    let step: Vec<f64> = (0..window.dimension()).map(|i| 0.02 * (1.7 * i as f64).sin()).collect();
    window.retract(&step)
}

// ANCHOR: symmetry
#[test]
fn shift_and_yaw_change_no_residual_at_any_estimate() {
    for motion in
        [Trajectory::figure_eight(), Trajectory::hover(), Trajectory::level_turn(1.0, 0.5)]
    {
        let window = disturbed(motion, BiasAssumption::KNOWN);
        let moved = window.transformed(&Similarity {
            scale: 1.0,
            rotation: Rotation3::from_axis_angle(&Vector3::z_axis(), 2.1),
            translation: Vector3::new(30.0, -7.0, 4.0),
        });
        let (before, after) = (window.residual().unwrap(), moved.residual().unwrap());
        assert!(before.norm() > 100.0);
        assert!((&after - &before).norm() < 1e-9 * before.norm());
    }
}
// ANCHOR_END: symmetry

#[test]
fn the_four_directions_are_null_at_any_estimate() {
    for assumption in [BiasAssumption::CONSTANT, BiasAssumption::walking(ImuNoise::mems())] {
        let window = disturbed(Trajectory::figure_eight(), assumption);
        let jacobian = window.linearize().unwrap().0;
        let four = [0, 1, 2].map(Direction::Translation);
        for direction in four.into_iter().chain([Direction::Yaw]) {
            let vector = window.direction(direction);
            let scale = jacobian.norm() * vector.norm();
            let moved = (&jacobian * vector).norm();
            assert!(moved < 1e-11 * scale, "{direction}: {}", moved / scale);
        }
        let scale = window.direction(Direction::Scale);
        assert!((&jacobian * &scale).norm() > 1e-6 * jacobian.norm() * scale.norm());
    }
}

#[test]
fn directions_are_derivatives_of_similarities() {
    let window = disturbed(Trajectory::figure_eight(), BiasAssumption::CONSTANT);
    let step = 1e-6;
    let turned = |axis: Vector3<f64>| Similarity {
        rotation: so3::exp(&(step * axis)),
        ..Similarity::identity()
    };
    let cases = [
        (Direction::Yaw, turned(Vector3::z())),
        (Direction::Tilt(0), turned(Vector3::x())),
        (Direction::Tilt(1), turned(Vector3::y())),
        (Direction::Scale, Similarity { scale: 1.0 + step, ..Similarity::identity() }),
        (
            Direction::Translation(1),
            Similarity { translation: step * Vector3::y(), ..Similarity::identity() },
        ),
    ];
    for (direction, similarity) in cases {
        let by_vector: Vec<f64> = (step * window.direction(direction)).iter().copied().collect();
        let moved = window.retract(&by_vector);
        let transformed = window.transformed(&similarity);
        for (one, other) in moved.states.iter().zip(&transformed.states) {
            let turn = so3::local(&one.world_from_body, &other.world_from_body);
            assert_abs_diff_eq!(turn, Vector3::zeros(), epsilon = 1e-10);
            assert_abs_diff_eq!(one.velocity, other.velocity, epsilon = 1e-10);
            assert_abs_diff_eq!(one.position, other.position, epsilon = 1e-10);
        }
        for (one, other) in moved.landmarks.iter().zip(&transformed.landmarks) {
            assert_abs_diff_eq!(one, other, epsilon = 1e-10);
        }
        let biases = (moved.biases[0], transformed.biases[0]);
        assert_abs_diff_eq!(biases.0.vector(), biases.1.vector(), epsilon = 1e-10);
    }
}

#[test]
fn every_degenerate_motion_has_copies_that_read_the_same() {
    let grown = Similarity { scale: 1.3, ..Similarity::identity() };
    let rotation = so3::exp(&Vector3::new(0.2, -0.1, 0.4));
    let tilted = Similarity { rotation, ..Similarity::identity() };
    let both = Similarity { scale: 0.8, ..tilted };
    let (known, constant) = (BiasAssumption::KNOWN, BiasAssumption::CONSTANT);
    let straight = Trajectory::constant_acceleration(&ACCELERATION, EulerAngles::default());
    for (motion, assumption, similarity) in [
        (Trajectory::constant_velocity(&VELOCITY, turning()), known, grown),
        (Trajectory::constant_body_acceleration(&ACCELERATION, 0.5), constant, grown),
        (swaying(EulerAngles::default()), constant, tilted),
        (straight, constant, both),
        (Trajectory::hover(), constant, tilted),
    ] {
        let window = window(motion, assumption);
        assert!(window.transformed(&similarity).residual().unwrap().norm() < 1e-5);
    }
}

#[test]
fn the_tilt_of_a_pitching_body_is_flat_and_not_a_family() {
    let objection = |motion, lean: f64| {
        let rotation = so3::exp(&(lean * Vector3::x()));
        let tilted = Similarity { rotation, ..Similarity::identity() };
        window(motion, BiasAssumption::CONSTANT).transformed(&tilted).residual().unwrap().norm()
    };
    let ratio = |motion| objection(motion, 0.02) / objection(motion, 0.01);
    assert!((ratio(swaying(pitching())) - 4.0).abs() < 0.05);
    assert!((ratio(Trajectory::figure_eight()) - 2.0).abs() < 0.05);
}

#[test]
fn a_constant_acceleration_that_climbs_has_exactly_one_false_scale() {
    let acceleration = Vector3::new(2.0, 0.0, 0.2);
    let window =
        window(Trajectory::constant_acceleration(&acceleration, turning()), BiasAssumption::KNOWN);
    let scale = 1.0 - 2.0 * GRAVITY.dot(&acceleration) / acceleration.norm_squared();
    let copy = |scale: f64| {
        // The rotation that takes the gravity that the readings want to where gravity is.
        let wanted = GRAVITY + (scale - 1.0) * acceleration;
        let rotation = Rotation3::rotation_between(&wanted, &GRAVITY).unwrap();
        window.transformed(&Similarity { scale, rotation, ..Similarity::identity() })
    };
    assert!(copy(scale).residual().unwrap().norm() < 1e-5);
    assert!(copy(0.5 * (1.0 + scale)).residual().unwrap().norm() > 10.0);
    assert_eq!(window.free_directions().unwrap().count(), 4);
}

#[test]
fn jacobians_are_those_of_central_differences() {
    let assumptions = [
        BiasAssumption::CONSTANT,
        BiasAssumption::KNOWN,
        BiasAssumption::walking(ImuNoise::mems()),
    ];
    for assumption in assumptions {
        let window = disturbed(Trajectory::figure_eight(), assumption);
        let jacobian = window.linearize().unwrap().0;
        let step = 1e-6;
        for column in 0..window.dimension() {
            let moved = |sign: f64| {
                let mut by = vec![0.0; window.dimension()];
                by[column] = sign * step;
                window.retract(&by).residual().unwrap()
            };
            let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            let error = (jacobian.column(column) - &difference).norm();
            assert!(error < 1e-5 * difference.norm(), "column {column}: {error}");
        }
    }
}

#[test]
fn the_twist_of_a_state_is_that_of_central_differences_and_gives_the_pixels() {
    let window = disturbed(Trajectory::figure_eight(), BiasAssumption::KNOWN);
    let state = window.states[3];
    let pose = window.rig.camera_from_world(&state);
    let step = 1e-6;
    let twist = twist_by_state(&state);
    for column in 0..9 {
        let moved = |sign: f64| {
            let mut by = [0.0; 9];
            by[column] = sign * step;
            se3::local(&pose, &window.rig.camera_from_world(&state.retract(&by)))
        };
        let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
        assert_abs_diff_eq!(twist.column(column).into_owned(), difference, epsilon = 1e-8);
    }
    let point = pose.inverse() * nalgebra::Point3::new(0.4, -0.3, 5.0);
    let (by_pose, by_point) = window.camera.jacobians(&pose, &point.coords).unwrap();
    let by_state = pixel_by_state(&state, &point.coords, &by_point);
    assert_abs_diff_eq!(by_state, by_pose * twist, epsilon = 1e-9);
}

#[test]
fn at_inconsistent_estimates_yaw_seems_to_be_known() {
    let truth = window(Trajectory::figure_eight(), BiasAssumption::CONSTANT);
    let step: Vec<f64> = (0..truth.dimension()).map(|i| 0.01 * (1.7 * i as f64).sin()).collect();
    let elsewhere = truth.retract(&step);
    let (mut mixed, other) = (truth.linearize().unwrap().0, elsewhere.linearize().unwrap().0);
    let pixels = 2 * truth.observations.len();
    mixed.rows_mut(0, pixels).copy_from(&other.rows(0, pixels));
    assert_eq!(Spectrum::of(&other).unwrap().zeros, 4);
    let spectrum = Spectrum::of(&mixed).unwrap();
    assert_eq!(spectrum.zeros, 3);
    for axis in 0..3 {
        assert!(
            spectrum.null_space().leaves(&truth.direction(Direction::Translation(axis))) < 1e-9
        );
    }
    assert!(spectrum.null_space().leaves(&truth.direction(Direction::Yaw)) > 0.1);
}

/// The gradient of the logarithm of the distance from the first state to the last.
fn log_distance(window: &Window) -> DVector<f64> {
    let (first, last) =
        (window.states[0].position, window.states[window.states.len() - 1].position);
    let slope = (last - first) / (last - first).norm_squared();
    let mut gradient = DVector::zeros(window.dimension());
    gradient.rows_mut(6, 3).copy_from(&-slope);
    gradient.rows_mut(9 * (window.states.len() - 1) + 6, 3).copy_from(&slope);
    gradient
}

#[test]
fn sigma_is_that_of_the_inverse_with_position_and_yaw_held() {
    let window = window(Trajectory::figure_eight(), BiasAssumption::CONSTANT);
    let jacobian = window.linearize().unwrap().0;
    let gradient = log_distance(&window);
    let spectrum = Spectrum::of(&jacobian).unwrap();
    let sigma = spectrum.sigma(&gradient).unwrap();
    // Position and yaw of the first state held by an equation each.
    let mut held = DMatrix::zeros(jacobian.nrows() + 4, jacobian.ncols());
    held.rows_mut(4, jacobian.nrows()).copy_from(&jacobian);
    held.view_mut((0, 6), (3, 3)).fill_diagonal(1e3);
    let up = window.states[0].world_from_body.inverse() * Vector3::z();
    held.view_mut((3, 0), (1, 3)).copy_from(&(1e3 * up.transpose()));
    let covariance = held.tr_mul(&held).try_inverse().unwrap();
    let expected = gradient.dot(&(covariance * &gradient)).sqrt();
    assert!((sigma / expected - 1.0).abs() < 1e-4, "{sigma} {expected}");
    // Nothing bounds a position by itself.
    let mut position = DVector::zeros(window.dimension());
    position[6] = 1.0;
    assert_eq!(spectrum.sigma(&position), None);
}

#[test]
fn scale_is_as_uncertain_as_the_change_of_velocity_is_small() {
    let sigma = |amplitude: f64| {
        let mut motion = Trajectory::constant_velocity(&VELOCITY, turning());
        motion.position[1] = ScalarTrajectory {
            amplitude: amplitude / 9.0,
            frequency: 3.0,
            rate: 0.5,
            ..ScalarTrajectory::default()
        };
        let window = window(motion, BiasAssumption::KNOWN);
        let spectrum = Spectrum::of(&window.linearize().unwrap().0).unwrap();
        spectrum.sigma(&log_distance(&window)).unwrap()
    };
    let exponent = (sigma(1e-3) / sigma(1e-2)).log10();
    assert!((exponent - 1.0).abs() < 0.02, "{exponent}");
}

#[test]
fn a_motion_that_is_nearly_degenerate_is_four_or_five_or_refused_but_nothing_else() {
    let mut outcomes = Vec::new();
    for exponent in -18..=-4 {
        let mut motion = Trajectory::constant_velocity(&VELOCITY, turning());
        motion.position[1].amplitude = 10_f64.powi(exponent);
        motion.position[1].frequency = 3.0;
        outcomes.push(match window(motion, BiasAssumption::KNOWN).free_directions() {
            Ok(free) => free.count(),
            Err(ObservabilityError::NullSpace(NullSpaceError::NoGap { .. })) => 0,
            Err(error) => panic!("{error}"),
        });
    }
    let order = [5, 0, 4].map(|outcome| outcomes.iter().filter(|found| **found == outcome).count());
    assert!(order.iter().all(|count| *count > 0), "{outcomes:?}");
    let sorted = [vec![5; order[0]], vec![0; order[1]], vec![4; order[2]]].concat();
    assert_eq!(outcomes, sorted);
}

#[test]
fn a_spectrum_without_a_gap_is_refused() {
    // Three unit vectors that are nearly one.
    let columns = [Vector3::x(), Vector3::new(1.0, 1e-10, 0.0), Vector3::new(1.0, 0.0, 1e-11)];
    let matrix = DMatrix::from_fn(3, 3, |row, column| columns[column][row]);
    let error = Spectrum::of(&matrix).unwrap_err();
    assert!(matches!(error, NullSpaceError::NoGap { .. }), "{error}");
}

#[test]
fn a_landmark_that_nobody_sees_is_free_without_a_name() {
    let mut window = window(Trajectory::figure_eight(), BiasAssumption::CONSTANT);
    window.landmarks.push(Vector3::zeros());
    let free = window.free_directions().unwrap();
    assert_eq!((free.count(), free.unnamed()), (7, 3));
    assert_eq!(free.to_string(), format!("7: {POSITION}, yaw, 3 without a name"));
}

#[test]
fn what_does_not_fit_together_is_an_error_that_says_so() {
    let good = window(Trajectory::figure_eight(), BiasAssumption::CONSTANT);
    let refused = |change: fn(&mut Window)| {
        let mut bad = good.clone();
        change(&mut bad);
        bad.free_directions().unwrap_err()
    };
    let sentence = |change| refused(change).to_string();
    assert!(sentence(|w| w.landmarks.clear()).contains("0 landmarks"));
    assert!(sentence(|w| w.states.clear()).contains("0 states"));
    assert!(sentence(|w| w.intervals.truncate(2)).contains("2 intervals"));
    assert!(sentence(|w| w.biases.push(ImuBias::default())).contains("2 biases were given"));
    assert!(sentence(|w| w.angular_velocities.clear()).contains("0 angular velocities"));
    assert!(sentence(|w| w.observations[3].point = 99).contains("observation 3"));
    assert!(sentence(|w| w.observations[3].keyframe = 99).contains("state 99"));
    assert!(sentence(|w| w.landmarks[0] = Vector3::new(-50.0, 0.0, 0.0)).contains("landmark 0"));
    assert!(
        sentence(|w| w.observations[0].pixel = Vector2::new(f64::NAN, 0.0)).contains("factor 0")
    );
    assert!(sentence(|w| w.states[1].velocity.x = f64::NAN).contains("not finite"));
    assert!(sentence(|w| w.gravity = Vector3::repeat(f64::INFINITY)).contains("not finite"));
    let matrix = DMatrix::from_element(2, 2, f64::NAN);
    assert_eq!(Spectrum::of(&matrix).unwrap_err(), NullSpaceError::NotFinite { row: 0 });
    assert_eq!(Spectrum::of(&DMatrix::zeros(0, 0)).unwrap().zeros, 0);
    assert_eq!(Spectrum::of(&DMatrix::zeros(0, 2)).unwrap().zeros, 2);
}

#[test]
fn a_window_that_does_not_fit_together_can_still_be_moved_without_a_panic() {
    let mut window = window(Trajectory::figure_eight(), BiasAssumption::CONSTANT);
    window.states.truncate(2);
    window.angular_velocities.clear();
    let all = [0, 7, 4000].map(Direction::Depth).into_iter().chain([Direction::Scale]);
    let all = all.chain([Direction::Tilt(9), Direction::Translation(9), Direction::Yaw]);
    for direction in all.chain([Direction::LeverArm(0)]) {
        assert_eq!(window.direction(direction).len(), window.dimension());
    }
    let grown = Similarity { scale: 2.0, ..Similarity::identity() };
    let moved = window.transformed(&grown);
    assert!(moved.residual().is_err());
    let is_moved = |(moved, state): (&NavState, &NavState)| moved.velocity != state.velocity;
    assert!(moved.states.iter().zip(&window.states).all(is_moved));
}
