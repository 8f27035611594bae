//! What is written for other programs, and what a ground truth says between its states.

use approx::assert_abs_diff_eq;
use nalgebra::{Matrix6, Quaternion, Rotation3, UnitQuaternion, Vector3};
use vislam::datasets::euroc::{GroundTruth, truth_at};
use vislam::datasets::written::{ply, pose_covariances, tum};
use vislam::inertial::{ImuBias, NavState};

fn state(angle: f64, x: f64) -> NavState {
    let world_from_body = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    let position = Vector3::new(x, -2.0, 0.1 + 0.2);
    NavState { world_from_body, position, velocity: Vector3::new(x, 0.0, 0.0) }
}

/// The lines that are no comment, as numbers.
fn numbers(text: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect()
}

#[test]
fn a_trajectory_reads_back_with_all_its_digits() {
    let states = [state(0.5, 1.0 / 3.0), state(3.0, -1e-9)];
    let times = [1_403_715_273_262_142_976, 5];
    let text = tum(times.into_iter().zip(&states));
    let first = text.lines().nth(1).unwrap();
    assert!(first.starts_with("1403715273.262142976 0.3333333333333333 -2 "), "{first}");
    assert!(text.lines().nth(2).unwrap().starts_with("0.000000005 "));
    for (line, state) in numbers(&text).iter().zip(&states) {
        assert_eq!(line.len(), 8);
        assert_eq!(line[1..4], *state.position.as_slice());
        let q = Quaternion::new(line[7], line[4], line[5], line[6]);
        let turn = UnitQuaternion::new_normalize(q).to_rotation_matrix();
        assert_abs_diff_eq!(turn, state.world_from_body, epsilon = 1e-14);
    }
    assert!(tum([(-1_500_000_000, &states[0])]).contains("\n-1.500000000 "));
}

#[test]
fn a_covariance_reads_back_from_its_upper_triangle() {
    let covariance =
        Matrix6::from_fn(|row, column| (row.min(column) * 10 + row.max(column)) as f64);
    let text = pose_covariances([(7_000_000_000, &covariance)]);
    let line = &numbers(&text)[0];
    assert_eq!((line.len(), line[0]), (22, 7.0));
    assert_eq!(line[1..8], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 11.0]);
    assert_eq!(line[21], 55.0);
}

#[test]
fn a_map_names_as_many_points_as_it_has() {
    let points = [(Vector3::new(0.1, -2.0, 3.5), [255, 0, 0]), (Vector3::zeros(), [160, 160, 160])];
    let text = ply(&points);
    let (head, body) = text.split_once("end_header\n").unwrap();
    assert!(head.starts_with("ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\n"));
    assert_eq!(head.matches("property").count(), 6);
    assert_eq!(body, "0.1 -2 3.5 255 0 0\n0 0 0 160 160 160\n");
}

#[test]
fn a_truth_is_taken_at_its_states_and_on_the_line_between_two() {
    let at = |nanoseconds: i64, angle: f64, x: f64| {
        let bias = ImuBias { gyro: Vector3::repeat(x), ..ImuBias::default() };
        GroundTruth { nanoseconds, state: state(angle, x), bias }
    };
    let millisecond = 1_000_000;
    let truth = [at(0, 0.0, 0.0), at(50 * millisecond, 0.1, 1.0), at(1000 * millisecond, 0.3, 3.0)];
    let found = |time: i64| truth_at(&truth, time);
    for (near, state) in [(-999_999, 0), (400_000, 0), (50 * millisecond - 352, 1)] {
        assert_eq!(found(near), Some(truth[state]));
    }
    let between = found(20 * millisecond).unwrap();
    assert_eq!(between.nanoseconds, 20 * millisecond);
    assert_abs_diff_eq!(between.state.position.x, 0.4, epsilon = 1e-12);
    assert_abs_diff_eq!(between.state.velocity.x, 0.4, epsilon = 1e-12);
    assert_abs_diff_eq!(between.bias.gyro.y, 0.4, epsilon = 1e-12);
    assert_abs_diff_eq!(between.state.world_from_body.angle(), 0.04, epsilon = 1e-12);
    // Too far apart, too early, too late, nothing.
    for time in [500 * millisecond, -millisecond, 1001 * millisecond, i64::MIN, i64::MAX] {
        assert_eq!(found(time), None);
    }
    assert_eq!(truth_at(&[], 0), None);
}
