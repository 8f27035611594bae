//! What wrong loops do, and what is made of them.

use nalgebra::Isometry3;
use vislam::filtering::chi_square_quantile;
use vislam::least_squares::{Kernel, Manifold};
use vislam::loop_closure::{
    Graduation, LoopClosureError, SpatialGraph, UprightPose, pose_graph_options,
};
use vislam::manifold::se3;

use crate::simulated::{Draws, largest_error, noisy_laps};

const LAP: usize = 60;
/// The largest error of a position, in metres, as it is when all loops are right, or a little more.
const GOOD: f64 = 1.0;

/// Two laps, and wrong loops that say that places of the first lap are those of the second lap a
/// quarter of a lap later, all in agreement. The numbers of the wrong ones.
fn with_wrong_loops(wrong: usize, seed: u64) -> (Vec<Isometry3<f64>>, SpatialGraph, Vec<usize>) {
    let (truth, mut graph) = noisy_laps(LAP, 0.03, 0.005, seed);
    let (right, mut draws) = (graph.measurements.len(), Draws::new(100 + seed));
    for number in 0..wrong {
        let mut measurement = graph.measurements[2 * LAP - 1].clone();
        (measurement.first, measurement.second) = (3 * number + 1, 3 * number + LAP + 16);
        measurement.measured = se3::exp(&draws.twist(0.5, 0.1));
        graph.measurements.push(measurement);
    }
    let wrong = (right..graph.measurements.len()).collect();
    (truth, graph, wrong)
}

fn error_with(kernel: Kernel, wrong: usize, seed: u64) -> f64 {
    let (truth, graph, _) = with_wrong_loops(wrong, seed);
    let loops = graph.loops();
    let of = |number: usize| if loops.contains(&number) { kernel } else { Kernel::Squared };
    let solved = graph.solve(of, &pose_graph_options()).unwrap();
    largest_error(&solved.poses, &truth)
}

fn threshold() -> f64 {
    chi_square_quantile(0.999, 6).unwrap().sqrt()
}

#[test]
fn one_wrong_loop_bends_the_whole_trajectory() {
    assert!(error_with(Kernel::Squared, 0, 1) < GOOD);
    assert!(error_with(Kernel::Squared, 1, 1) > 3.0);
}

#[test]
fn one_wrong_loop_is_survived_with_either_kernel_and_ten_with_the_one_that_lets_go() {
    for seed in 0..3 {
        for kernel in [Kernel::Huber(1.0), Kernel::Cauchy(1.0)] {
            assert!(error_with(kernel, 1, seed) < GOOD);
        }
        assert!(error_with(Kernel::Huber(1.0), 10, seed) > 3.0);
        assert!(error_with(Kernel::Cauchy(1.0), 10, seed) < GOOD);
    }
}

#[test]
fn switches_turn_the_wrong_loops_off_and_leave_the_right_ones_on() {
    for seed in 0..3 {
        let (truth, graph, wrong) = with_wrong_loops(10, seed);
        let (loops, information) = (graph.loops(), threshold().powi(2));
        let solved = graph.solve_switched(&loops, information, &pose_graph_options()).unwrap();
        assert!(solved.report.stop.is_convergence());
        assert!(largest_error(&solved.poses, &truth) < GOOD);
        for (number, switch) in loops.iter().zip(&solved.switches) {
            assert!((0.0..=1.0).contains(switch));
            assert_eq!(*switch < 0.5, wrong.contains(number), "loop {number}: {switch}");
        }
    }
}

#[test]
fn graduated_non_convexity_keeps_the_right_loops_and_drops_the_wrong_ones() {
    for seed in 0..3 {
        let (truth, graph, wrong) = with_wrong_loops(10, seed);
        let loops = graph.loops();
        let graduation = Graduation::with_threshold(threshold());
        let solved = graph.solve_graduated(&loops, &graduation, &pose_graph_options()).unwrap();
        assert!(
            largest_error(&solved.poses, &truth) < GOOD,
            "{}",
            largest_error(&solved.poses, &truth)
        );
        for (number, weight) in loops.iter().zip(&solved.weights) {
            let expected = if wrong.contains(number) { 0.0 } else { 1.0 };
            assert_eq!(*weight, expected, "loop {number}");
        }
    }
}

#[test]
fn without_wrong_loops_nothing_is_dropped_and_the_estimate_is_the_plain_one() {
    let (_, graph, _) = with_wrong_loops(0, 5);
    let plain = graph.solve(|_| Kernel::Squared, &pose_graph_options()).unwrap();
    let graduation = Graduation::with_threshold(10.0);
    let solved = graph.solve_graduated(&graph.loops(), &graduation, &pose_graph_options()).unwrap();
    assert!(solved.weights.iter().all(|weight| *weight == 1.0) && solved.rounds == 1);
    assert!(largest_error(&solved.poses, &plain.poses) < 1e-9);
}

#[test]
fn a_switch_is_where_its_loop_and_its_prior_agree() {
    let (_, graph, _) = with_wrong_loops(2, 1);
    let (loops, information) = (graph.loops(), 4.0);
    let solved = graph.solve_switched(&loops, information, &pose_graph_options()).unwrap();
    let graph = graph.with_poses(solved.poses);
    for (number, switch) in loops.iter().zip(&solved.switches) {
        let square = graph.squared_error(*number).unwrap();
        assert!((switch - information / (information + square)).abs() < 1e-4);
    }
}

#[test]
fn impossible_options_are_named() {
    let (_, graph, _) = with_wrong_loops(1, 1);
    let options = pose_graph_options();
    let graduated = |threshold, growth| {
        let graduation = Graduation { growth, ..Graduation::with_threshold(threshold) };
        graph.solve_graduated(&[], &graduation, &options).map(|_| ())
    };
    assert!(graduated(1.0, 1.4).is_ok());
    let name = |error: LoopClosureError| match error {
        LoopClosureError::Option { name, .. } => name,
        other => panic!("{other}"),
    };
    assert_eq!(name(graduated(0.0, 1.4).unwrap_err()), "threshold");
    assert_eq!(name(graduated(1.0, 1.0).unwrap_err()), "growth");
    assert_eq!(name(graph.solve_switched(&[], -1.0, &options).unwrap_err()), "information");
    let measurements = graph.measurements.len();
    assert_eq!(
        graph.solve_switched(&[measurements], 1.0, &options).unwrap_err(),
        LoopClosureError::NoSuchMeasurement { measurement: measurements, measurements }
    );
}

#[test]
fn wrong_loops_are_dropped_in_four_degrees_of_freedom_too() {
    let (truth, graph, wrong) = with_wrong_loops(10, 1);
    // Roll and pitch are those of the truth, as gravity gives them.
    let tilted = |(pose, truth): (&Isometry3<f64>, &Isometry3<f64>)| {
        let near = UprightPose::new(*truth);
        let mut step = [0.0; 4];
        near.local(&UprightPose::new(*pose), &mut step);
        near.retract(&step).world_from_body
    };
    let poses = graph.poses.iter().zip(&truth).map(tilted).collect();
    let graph = graph.with_poses(poses).upright();
    let (loops, limit) = (graph.loops(), chi_square_quantile(0.999, 4).unwrap());
    let plain = graph.solve(|_| Kernel::Squared, &pose_graph_options()).unwrap();
    let graduation = Graduation::with_threshold(limit.sqrt());
    let graduated = graph.solve_graduated(&loops, &graduation, &pose_graph_options()).unwrap();
    let switched = graph.solve_switched(&loops, limit, &pose_graph_options()).unwrap();
    let error = |poses: &[UprightPose]| {
        let poses: Vec<_> = poses.iter().map(|pose| pose.world_from_body).collect();
        largest_error(&poses, &truth)
    };
    assert!(error(&plain.poses) > 3.0);
    assert!(error(&graduated.poses) < GOOD && error(&switched.poses) < GOOD);
    for (number, weight) in loops.iter().zip(&graduated.weights) {
        assert_eq!(*weight == 0.0, wrong.contains(number), "loop {number}");
    }
}
