//! Preintegration on real flights. They are no part of the library: `VISLAM_DATA` names the folder
//! in which `euroc/` holds them, and `cargo test --test real_flights -- --ignored` runs these tests.

mod measured;

use nalgebra::{Matrix3x6, Matrix6, Vector6};
use vislam::datasets::euroc::{GroundTruth, read_ground_truth, read_imu};
use vislam::inertial::{GRAVITY, ImuNoise, between};
use vislam::preintegration::{
    LONGEST_STEP, Preintegrated, Rule, imu_residual, preintegrate_stamped,
};

use measured::data;

/// Intervals of a second of the flight V1_01: their sums, and the states at their ends.
fn seconds_of_v1_01() -> Vec<(Preintegrated, GroundTruth, GroundTruth)> {
    let samples = read_imu(&data("V1_01_imu0.csv")).unwrap();
    let truth = read_ground_truth(&data("V1_01_groundtruth_20hz.csv")).unwrap();
    let states: Vec<GroundTruth> = truth.into_iter().step_by(20).collect();
    let intervals = states.windows(2).filter_map(|pair| {
        let [first, last] = [pair[0], pair[1]];
        let window = between(&samples, first.nanoseconds, last.nanoseconds).ok()?;
        let (bias, noise) = (&first.bias, &ImuNoise::euroc());
        let sums = preintegrate_stamped(&window, Rule::Midpoint, LONGEST_STEP, bias, noise);
        Some((sums.unwrap(), first, last))
    });
    intervals.collect()
}

// ANCHOR: flight_gravity
#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn a_flight_finds_its_room_tilted_and_cannot_weigh_the_earth() {
    let (mut information, mut moments) = (Matrix6::zeros(), Vector6::zeros());
    for (sums, first, last) in &seconds_of_v1_01() {
        let residual = imu_residual(sums, &first.state, &last.state, &GRAVITY, &first.bias);
        let by_gravity = sums.duration * first.state.world_from_body.inverse().matrix();
        let mut design = Matrix3x6::zeros();
        design.fixed_columns_mut::<3>(0).copy_from(&by_gravity);
        let by_bias = sums.bias_jacobian.fixed_view::<3, 3>(3, 3);
        design.fixed_columns_mut::<3>(3).copy_from(&by_bias);
        information += design.transpose() * design;
        moments += design.transpose() * residual.fixed_rows::<3>(3);
    }
    let inverse = information.try_inverse().unwrap();
    let gravity = GRAVITY + (inverse * moments).fixed_rows::<3>(0);
    let tilt = gravity.xy().norm() / gravity.norm();
    assert!((tilt.to_degrees() - 0.24).abs() < 0.02);
    let alike = inverse[(2, 3)] / (inverse[(2, 2)] * inverse[(3, 3)]).sqrt();
    assert!(alike.abs() > 0.999);
}
// ANCHOR_END: flight_gravity

#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn a_second_of_a_real_flight_is_off_by_little_and_by_more_than_its_noise() {
    let intervals = seconds_of_v1_01();
    let (mut squares, mut predicted) = ([0.0; 3], [0.0; 3]);
    for (sums, first, last) in &intervals {
        let residual = imu_residual(sums, &first.state, &last.state, &GRAVITY, &first.bias);
        for part in 0..3 {
            squares[part] += residual.fixed_rows::<3>(3 * part).norm_squared();
            predicted[part] += 3.0 * sums.sigmas()[part].powi(2);
        }
    }
    // Milliradians, cm/s and cm.
    let root = |sum: f64, unit: f64| unit * (sum / intervals.len() as f64).sqrt();
    for (part, (unit, [low, high])) in
        [(1e3, [1.8, 2.6]), (1e2, [4.2, 5.2]), (1e2, [2.1, 2.7])].into_iter().enumerate()
    {
        let (error, predicted) = (root(squares[part], unit), root(predicted[part], unit));
        assert!((low..high).contains(&error), "part {part}: {error}");
        assert!(error > 5.0 * predicted, "part {part}: {error} against {predicted}");
    }
}
