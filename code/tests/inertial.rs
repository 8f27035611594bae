//! What an inertial sensor reads on known motions, and the states that follow from it.

mod measured;

use approx::assert_abs_diff_eq;
use nalgebra::{Isometry3, Matrix3, Vector3, Vector6};
use vislam::datasets::euroc::{read_ground_truth, read_imu};
use vislam::inertial::{
    CameraImu, GRAVITY, ImuBias, ImuNoise, ImuSample, NavState, NoiseError, StampedSample,
    WindowError, between,
};
use vislam::least_squares::Manifold;
use vislam::manifold::{se3, so3};
use vislam::preintegration::{LONGEST_STEP, Rule, preintegrate_stamped};
use vislam::simulation::{EulerAngles, ScalarTrajectory, Trajectory};

use measured::data;

// ANCHOR: at_rest
#[test]
fn a_sensor_on_a_table_reads_gravity_upward() {
    let sample = Trajectory::hover().at(3.0).sample(&GRAVITY);
    assert_eq!(sample.gyro, Vector3::zeros());
    assert_eq!(sample.accelerometer, Vector3::new(0.0, 0.0, 9.81));
}

#[test]
fn a_sensor_in_free_fall_reads_nothing() {
    let falling = Trajectory::constant_acceleration(&GRAVITY, EulerAngles::default());
    let sample = falling.at(3.0).sample(&GRAVITY);
    assert_abs_diff_eq!(sample.accelerometer, Vector3::zeros(), epsilon = 1e-12);
}
// ANCHOR_END: at_rest

#[test]
fn a_sensor_on_its_nose_reads_gravity_along_its_own_axis() {
    let pitch = ScalarTrajectory::constant(std::f64::consts::FRAC_PI_2);
    let angles = EulerAngles { pitch, ..EulerAngles::default() };
    let tilted = Trajectory { angles, ..Trajectory::hover() };
    let sample = tilted.at(0.0).sample(&GRAVITY);
    assert_abs_diff_eq!(sample.accelerometer, Vector3::new(-9.81, 0.0, 0.0), epsilon = 1e-12);
}

#[test]
fn a_level_turn_reads_a_constant_force_to_the_inside() {
    for t in [0.0, 0.7, 5.0] {
        let kinematics = Trajectory::level_turn(1.0, 0.5).at(t);
        let sample = kinematics.sample(&GRAVITY);
        assert_abs_diff_eq!(sample.gyro, Vector3::new(0.0, 0.0, 0.5), epsilon = 1e-12);
        assert_abs_diff_eq!(sample.accelerometer, Vector3::new(0.0, 0.5, 9.81), epsilon = 1e-12);
        let velocity = kinematics.state.world_from_body.inverse() * kinematics.state.velocity;
        assert_abs_diff_eq!(velocity, Vector3::x(), epsilon = 1e-12);
    }
    let start = Trajectory::level_turn(1.0, 0.5).at(0.0).state;
    assert_abs_diff_eq!(start.position, Vector3::zeros(), epsilon = 1e-12);
}

#[test]
fn an_acceleration_constant_in_the_body_frame_begins_at_rest() {
    let acceleration = Vector3::new(0.4, -0.7, 0.2);
    let motion = Trajectory::constant_body_acceleration(&acceleration, 0.6);
    let start = motion.at(0.0).state;
    assert_abs_diff_eq!(start.position, Vector3::zeros(), epsilon = 1e-12);
    assert_abs_diff_eq!(start.velocity, Vector3::zeros(), epsilon = 1e-12);
    for t in [0.0, 1.0, 4.0] {
        let sample = motion.at(t).sample(&GRAVITY);
        let expected = acceleration + Vector3::new(0.0, 0.0, 9.81);
        assert_abs_diff_eq!(sample.accelerometer, expected, epsilon = 1e-12);
    }
}

#[test]
fn a_constant_velocity_reads_like_rest_however_it_turns() {
    let angles =
        EulerAngles { yaw: ScalarTrajectory::linear(0.4), ..Trajectory::figure_eight().angles };
    let velocity = Vector3::new(1.0, -2.0, 0.5);
    let kinematics = Trajectory::constant_velocity(&velocity, angles).at(2.0);
    assert_eq!(kinematics.state.velocity, velocity);
    assert_eq!(kinematics.state.position, 2.0 * velocity);
    assert_abs_diff_eq!(kinematics.sample(&GRAVITY).accelerometer.norm(), 9.81, epsilon = 1e-12);
}

fn every_motion() -> [Trajectory; 7] {
    let turning = Trajectory::figure_eight().angles;
    [
        Trajectory::hover(),
        Trajectory::turn_on_the_spot(0.7),
        Trajectory::level_turn(1.0, 0.5),
        Trajectory::figure_eight(),
        Trajectory::constant_velocity(&Vector3::new(1.0, 2.0, 0.3), turning),
        Trajectory::constant_acceleration(&Vector3::new(0.1, -0.2, 0.3), turning),
        Trajectory::constant_body_acceleration(&Vector3::new(0.5, 0.2, 0.1), 0.4),
    ]
}

#[test]
fn velocity_acceleration_and_angular_velocity_are_derivatives_of_the_motion() {
    for motion in every_motion() {
        for t in [0.0, 0.4, 1.7, 6.0] {
            let (h, kinematics) = (1e-4, motion.at(t));
            let (before, after) = (motion.at(t - h).state, motion.at(t + h).state);
            let velocity = (after.position - before.position) / (2.0 * h);
            assert_abs_diff_eq!(kinematics.state.velocity, velocity, epsilon = 1e-6);
            let acceleration = (after.velocity - before.velocity) / (2.0 * h);
            assert_abs_diff_eq!(kinematics.acceleration, acceleration, epsilon = 1e-6);
            let turned = so3::local(&before.world_from_body, &after.world_from_body) / (2.0 * h);
            assert_abs_diff_eq!(kinematics.angular_velocity, turned, epsilon = 1e-6);
        }
    }
}

#[test]
fn the_figure_eight_excites_every_axis_of_both_sensors() {
    let samples = Trajectory::figure_eight().samples(&GRAVITY, 0.01, 1000);
    let spread = |value: fn(&ImuSample) -> Vector3<f64>| {
        let values: Vec<_> = samples.iter().map(value).collect();
        let mean = values.iter().sum::<Vector3<f64>>() / values.len() as f64;
        let scatter: Matrix3<f64> =
            values.iter().map(|v| (v - mean) * (v - mean).transpose()).sum();
        (scatter / values.len() as f64).symmetric_eigenvalues().min().sqrt()
    };
    assert!(spread(|sample| sample.gyro) > 0.2);
    assert!(spread(|sample| sample.accelerometer) > 0.3);
}

/// Error of position and velocity and angle after two seconds in so many steps.
fn propagated(motion: &Trajectory, steps: usize, midpoint: bool) -> [f64; 3] {
    let dt = 2.0 / steps as f64;
    let samples = motion.samples(&GRAVITY, dt, steps + 1);
    let mut state = motion.at(0.0).state;
    for pair in samples.windows(2) {
        state = if midpoint {
            state.propagate_midpoint(&pair[0], &pair[1], &GRAVITY, dt)
        } else {
            state.propagate(&pair[0], &GRAVITY, dt)
        };
    }
    let truth = motion.at(2.0).state;
    [
        (state.position - truth.position).norm(),
        (state.velocity - truth.velocity).norm(),
        so3::local(&truth.world_from_body, &state.world_from_body).norm(),
    ]
}

#[test]
fn propagation_is_of_first_order_by_the_euler_rule_and_of_second_by_the_midpoint_rule() {
    for (midpoint, order) in [(false, 1.0), (true, 2.0)] {
        let motion = Trajectory::figure_eight();
        let [coarse, fine] = [400, 800].map(|steps| propagated(&motion, steps, midpoint));
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            let measured = (coarse / fine).log2();
            assert!((measured - order).abs() < 0.1, "order {measured}");
        }
    }
}

/// Error of position after two seconds with readings that are averages over the step after them;
/// the second end of a step is given its own reading or the next one.
fn propagated_with_averages(steps: usize, next: usize) -> f64 {
    let (motion, parts) = (Trajectory::figure_eight(), 20);
    let dt = 2.0 / steps as f64;
    let average = |k: usize| {
        let times = (0..parts).map(|part| (k as f64 + (part as f64 + 0.5) / parts as f64) * dt);
        let sum =
            times.map(|t| motion.at(t).sample(&GRAVITY)).fold(Vector6::zeros(), |sum, read| {
                let ImuSample { gyro, accelerometer } = read;
                sum + ImuBias { gyro, accelerometer }.vector()
            });
        let ImuBias { gyro, accelerometer } = ImuBias::from_vector(&(sum / parts as f64));
        ImuSample { gyro, accelerometer }
    };
    let state = (0..steps).fold(motion.at(0.0).state, |state, k| {
        state.propagate_midpoint(&average(k), &average(k + next), &GRAVITY, dt)
    });
    (state.position - motion.at(2.0).state.position).norm()
}

#[test]
fn readings_that_are_averages_over_their_step_must_not_be_averaged_with_the_next() {
    for (next, order) in [(0, 2.0), (1, 1.0)] {
        let [coarse, fine] = [200, 400].map(|steps| propagated_with_averages(steps, next));
        let measured = (coarse / fine).log2();
        assert!((measured - order).abs() < 0.1, "order {measured}");
    }
}

#[test]
fn without_rotation_a_constant_acceleration_is_propagated_exactly() {
    let motion =
        Trajectory::constant_acceleration(&Vector3::new(1.0, 2.0, -3.0), EulerAngles::default());
    assert!(propagated(&motion, 20, false).iter().all(|error| *error < 1e-12));
}

/// Where a level sensor that rests at the origin is believed to be after a minute.
fn after_a_minute(bias: &ImuBias) -> NavState {
    let read = Trajectory::hover().at(0.0).sample(&GRAVITY).biased(bias);
    let step = |state: NavState, _| state.propagate_midpoint(&read, &read, &GRAVITY, 0.01);
    (0..6000).fold(NavState::origin(), step)
}

// ANCHOR: drift
#[test]
fn a_bias_of_the_accelerometer_drifts_with_the_square_of_the_time() {
    let bias = ImuBias { accelerometer: Vector3::new(0.02, 0.0, 0.0), ..ImuBias::default() };
    let drift = after_a_minute(&bias).position;
    assert_abs_diff_eq!(drift, Vector3::new(36.0, 0.0, 0.0), epsilon = 1e-9);
}

#[test]
fn a_bias_of_the_gyroscope_drifts_with_its_cube_through_gravity() {
    let bias = ImuBias { gyro: Vector3::new(0.0, 1e-3, 0.0), ..ImuBias::default() };
    let drift = after_a_minute(&bias).position;
    // g b t³/6, less what a sine lacks of its angle.
    assert_abs_diff_eq!(drift.x, 353.16, epsilon = 0.1);
    let upright = ImuBias { gyro: Vector3::new(0.0, 0.0, 1e-3), ..ImuBias::default() };
    assert_abs_diff_eq!(after_a_minute(&upright).position, Vector3::zeros(), epsilon = 1e-9);
}
// ANCHOR_END: drift

#[test]
fn the_first_state_stays_outside_of_what_the_readings_add() {
    let samples = Trajectory::level_turn(1.5, 0.8).samples(&GRAVITY, 0.01, 101);
    let run = |first: NavState, gravity: Vector3<f64>| {
        samples
            .windows(2)
            .fold(first, |state, pair| state.propagate_midpoint(&pair[0], &pair[1], &gravity, 0.01))
    };
    let own = run(NavState::origin(), Vector3::zeros());
    let first = Trajectory::figure_eight().at(2.0).state;
    let (reached, turned) = (run(first, GRAVITY), first.world_from_body);
    let rotation = turned * own.world_from_body;
    assert_abs_diff_eq!(reached.world_from_body, rotation, epsilon = 1e-12);
    let velocity = first.velocity + GRAVITY + turned * own.velocity;
    assert_abs_diff_eq!(reached.velocity, velocity, epsilon = 1e-12);
    let fallen = first.position + first.velocity + 0.5 * GRAVITY;
    assert_abs_diff_eq!(reached.position, fallen + turned * own.position, epsilon = 1e-12);
}

#[test]
fn a_turn_about_the_vertical_changes_nothing_that_a_resting_sensor_reads() {
    let facing = |yaw: f64| {
        let (pitch, roll) = (ScalarTrajectory::constant(0.3), ScalarTrajectory::constant(-0.8));
        let angles = EulerAngles { yaw: ScalarTrajectory::constant(yaw), pitch, roll };
        Trajectory { angles, ..Trajectory::hover() }.at(0.0).sample(&GRAVITY).accelerometer
    };
    assert_abs_diff_eq!(facing(0.0), facing(2.2), epsilon = 1e-12);
    let force = facing(1.0);
    assert_abs_diff_eq!(force.y.atan2(force.z), -0.8, epsilon = 1e-12);
    assert_abs_diff_eq!((-force.x).atan2(force.y.hypot(force.z)), 0.3, epsilon = 1e-12);
}

#[test]
fn on_a_level_turn_a_clock_that_is_off_is_corrected_exactly() {
    let (camera, motion) =
        (CameraImu { time_offset: 0.2, ..camera() }, Trajectory::level_turn(1.0, 2.0));
    let kinematics = motion.at(0.5);
    let moved =
        camera.world_from_camera_at_same_reading(&kinematics.state, &kinematics.angular_velocity);
    let truth = camera.world_from_camera(&motion.at(0.7).state);
    assert_abs_diff_eq!(se3::local(&moved, &truth), Vector6::zeros(), epsilon = 1e-12);
}

#[test]
fn a_state_moves_by_nine_numbers_rotation_first() {
    let state = Trajectory::figure_eight().at(1.0).state;
    assert_eq!(state.dimension(), 9);
    assert_eq!(state.retract(&[0.0; 9]), state);
    let moved = state.retract(&[0.1, 0.2, 0.3, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let turned = so3::local(&state.world_from_body, &moved.world_from_body);
    assert_abs_diff_eq!(turned, Vector3::new(0.1, 0.2, 0.3), epsilon = 1e-14);
    assert_eq!(moved.velocity, state.velocity + Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(moved.position, state.position + Vector3::new(4.0, 5.0, 6.0));
    assert_eq!(NavState::origin().pose(), Isometry3::identity());
}

// ANCHOR: densities
#[test]
fn the_noise_of_a_reading_depends_on_its_step_and_that_of_an_average_does_not() {
    let noise = ImuNoise::mems();
    let (fine, coarse) = (noise.discrete(0.005), noise.discrete(0.01));
    assert_abs_diff_eq!(fine, 2.0 * coarse, epsilon = 1e-12);
    assert_abs_diff_eq!(fine[(0, 0)], 3.5e-3 * 3.5e-3 * 200.0, epsilon = 1e-15);
    assert_abs_diff_eq!(fine[(5, 5)], 2.0e-2 * 2.0e-2 * 200.0, epsilon = 1e-15);
    // The mean of two readings of the finer step has the variance of one of the coarser.
    assert_abs_diff_eq!(0.5 * fine, coarse, epsilon = 1e-12);
    let walk = noise.bias_walk(4.0);
    assert_abs_diff_eq!(walk[(1, 1)].sqrt(), 2.0 * noise.gyro_walk, epsilon = 1e-15);
    assert_abs_diff_eq!(walk[(4, 4)].sqrt(), 2.0 * noise.accelerometer_walk, epsilon = 1e-15);
}
// ANCHOR_END: densities

#[test]
fn a_corrupted_reading_has_the_bias_as_mean_error_and_the_density_as_scatter() {
    let (noise, dt) = (ImuNoise::euroc(), 0.005);
    let bias = ImuBias::from_vector(&Vector6::new(0.1, 0.2, 0.3, 0.4, 0.5, 0.6));
    let truth = Trajectory::figure_eight().at(1.0).sample(&GRAVITY);
    let drawn = noise.corrupt(&truth, &bias, dt, || 1.0);
    let error = drawn.corrected(&bias);
    let sigma = noise.discrete(dt).diagonal().map(f64::sqrt);
    let found = ImuBias {
        gyro: error.gyro - truth.gyro,
        accelerometer: error.accelerometer - truth.accelerometer,
    };
    assert_abs_diff_eq!(found.vector(), sigma, epsilon = 1e-14);
    let walked = noise.walk(&bias, 4.0, || 1.0).vector() - bias.vector();
    assert_abs_diff_eq!(walked, noise.bias_walk(4.0).diagonal().map(f64::sqrt), epsilon = 1e-14);
}

#[test]
fn a_density_is_not_negative_and_finite() {
    assert_eq!(ImuNoise::mems().check(), Ok(()));
    let zero = ImuNoise { gyro: 0.0, accelerometer: 0.0, gyro_walk: 0.0, accelerometer_walk: 0.0 };
    assert_eq!(zero.check(), Ok(()));
    let error = ImuNoise { gyro_walk: -1.0, ..zero }.check().unwrap_err();
    assert_eq!(error, NoiseError { name: "gyro_walk", axis: None, value: -1.0 });
    assert_eq!(
        error.to_string(),
        "the noise density `gyro_walk` is -1; give a finite number that is not negative"
    );
}

fn camera() -> CameraImu {
    let turn = so3::exp(&Vector3::new(0.3, -0.7, 1.1));
    let lever = Vector3::new(0.2, -0.1, 0.05);
    CameraImu {
        body_from_camera: Isometry3::from_parts(lever.into(), turn.into()),
        time_offset: 0.004,
    }
}

#[test]
fn a_camera_sits_at_the_end_of_its_lever_arm() {
    let (camera, state) = (camera(), Trajectory::figure_eight().at(0.8).state);
    let lever = camera.body_from_camera.translation.vector;
    let centre = state.position + state.world_from_body * lever;
    assert_abs_diff_eq!(
        camera.world_from_camera(&state).translation.vector,
        centre,
        epsilon = 1e-14
    );
    let seen = camera.camera_from_world(&state) * nalgebra::Point3::from(centre);
    assert_abs_diff_eq!(seen.coords, Vector3::zeros(), epsilon = 1e-14);
}

#[test]
fn the_twist_of_the_camera_is_the_derivative_of_its_pose() {
    let (camera, motion, h) = (camera(), Trajectory::figure_eight(), 1e-4);
    for t in [0.0, 0.8, 2.1] {
        let kinematics = motion.at(t);
        let pose = |t: f64| camera.world_from_camera(&motion.at(t).state);
        let slope = se3::local(&pose(t - h), &pose(t + h)) / (2.0 * h);
        let twist = camera.twist(&kinematics.state, &kinematics.angular_velocity);
        assert_abs_diff_eq!(twist, slope, epsilon = 1e-6);
    }
}

#[test]
fn a_clock_that_is_off_shows_the_camera_further_on() {
    let (camera, motion) = (camera(), Trajectory::figure_eight());
    let error = |offset: f64| {
        let camera = CameraImu { time_offset: offset, ..camera };
        let kinematics = motion.at(0.5);
        let moved = camera
            .world_from_camera_at_same_reading(&kinematics.state, &kinematics.angular_velocity);
        let truth = camera.world_from_camera(&motion.at(0.5 + offset).state);
        se3::local(&moved, &truth).norm()
    };
    assert!(error(0.004) < 1e-4);
    assert!((error(0.02) / error(0.01) - 4.0).abs() < 0.2);
    assert_eq!(camera.imu_nanoseconds(1_403_715_273_262_142_976), 1_403_715_273_266_142_976);
}

#[test]
fn the_acceleration_at_the_camera_is_the_second_derivative_of_its_centre() {
    let (camera, motion, h) = (camera(), Trajectory::figure_eight(), 1e-3);
    let t = 0.9;
    let kinematics = motion.at(t);
    let body_from_world = kinematics.state.world_from_body.inverse();
    let turning =
        (motion.at(t + h).angular_velocity - motion.at(t - h).angular_velocity) / (2.0 * h);
    let own = body_from_world * kinematics.acceleration;
    let found = camera.acceleration(&own, &kinematics.angular_velocity, &turning);
    let centre = |t: f64| camera.world_from_camera(&motion.at(t).state).translation.vector;
    let second = (centre(t + h) - 2.0 * centre(t) + centre(t - h)) / (h * h);
    assert_abs_diff_eq!(found, body_from_world * second, epsilon = 1e-5);
}

#[test]
fn six_numbers_are_a_bias_and_a_bias_is_six_numbers() {
    let vector = Vector6::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
    let bias = ImuBias::from_vector(&vector);
    assert_eq!(bias.gyro, Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(bias.vector(), vector);
    assert!(bias.is_finite());
    assert!(!ImuBias { gyro: Vector3::repeat(f64::NAN), ..bias }.is_finite());
}

/// Readings that are their own time in milliseconds, one every five.
fn ramp() -> Vec<StampedSample> {
    let at = |k: i64| StampedSample {
        nanoseconds: 5_000_000 * k,
        sample: ImuSample {
            gyro: Vector3::repeat(5.0 * k as f64),
            accelerometer: Vector3::repeat(-5.0 * k as f64),
        },
    };
    (0..5).map(at).collect()
}

#[test]
fn an_interval_between_readings_begins_and_ends_with_interpolated_ones() {
    let millis = |window: &[StampedSample]| -> Vec<(i64, f64)> {
        window.iter().map(|s| (s.nanoseconds, s.sample.gyro.x)).collect()
    };
    let window = between(&ramp(), 7_000_000, 16_000_000).unwrap();
    let expected =
        vec![(7_000_000, 7.0), (10_000_000, 10.0), (15_000_000, 15.0), (16_000_000, 16.0)];
    assert_eq!(millis(&window), expected);
    assert_eq!(window[0].sample.accelerometer, Vector3::repeat(-7.0));
    let window = between(&ramp(), 5_000_000, 15_000_000).unwrap();
    assert_eq!(millis(&window), [(5_000_000, 5.0), (10_000_000, 10.0), (15_000_000, 15.0)]);
    let window = between(&ramp(), 6_000_000, 8_000_000).unwrap();
    assert_eq!(millis(&window), [(6_000_000, 6.0), (7_000_000, 7.0), (8_000_000, 8.0)]);
    assert_eq!(between(&ramp(), 0, 20_000_000).unwrap(), ramp());
}

#[test]
fn an_interval_must_have_length_and_readings() {
    let ramp = ramp();
    let (start, end) = (7_000_000, 7_000_000);
    assert_eq!(between(&ramp, start, end), Err(WindowError::Order { start, end }));
    for (start, end) in [(-1, 5_000_000), (0, 20_000_001), (30_000_000, 40_000_000)] {
        assert_eq!(between(&ramp, start, end), Err(WindowError::NotCovered { start, end }));
    }
    assert!(between(&[], 0, 1).is_err());
    assert!(between(&ramp[..1], 0, 1).is_err());
    let mut unsorted = ramp.clone();
    unsorted[2].nanoseconds = 5_000_000;
    let error = between(&unsorted, 1_000_000, 16_000_000).unwrap_err();
    assert_eq!(error, WindowError::Unsorted { nanoseconds: 5_000_000 });
}

#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn a_real_flight_goes_where_its_readings_lead() {
    let samples = read_imu(&data("V1_01_imu0.csv")).unwrap();
    let truth = read_ground_truth(&data("V1_01_groundtruth_20hz.csv")).unwrap();
    // Intervals of half a second.
    for pair in truth.iter().step_by(10).collect::<Vec<_>>().windows(2) {
        let Ok(window) = between(&samples, pair[0].nanoseconds, pair[1].nanoseconds) else {
            continue;
        };
        let (bias, noise) = (&pair[0].bias, &ImuNoise::euroc());
        let sums =
            preintegrate_stamped(&window, Rule::Midpoint, LONGEST_STEP, bias, noise).unwrap();
        let predicted = sums.predict(&pair[0].state, &GRAVITY, bias);
        let found = &pair[1].state;
        let angle = so3::local(&predicted.world_from_body, &found.world_from_body).norm();
        assert!(angle < 0.03, "{angle} rad");
        assert!((predicted.velocity - found.velocity).norm() < 0.3);
        assert!((predicted.position - found.position).norm() < 0.1);
    }
}
