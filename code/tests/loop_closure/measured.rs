//! Public pose graphs. They are no part of the library: `VISLAM_POSE_GRAPHS` names their folder, which
//! may be that of the examples that come with GTSAM.

use std::time::Instant;

use nalgebra::Matrix6;
use vislam::datasets::pose_graph::{read_planar_graph, read_pose_graph};
use vislam::factors::GraphPose;
use vislam::least_squares::{Kernel, Options};
use vislam::loop_closure::{Certificate, PoseGraph, SpatialGraph, certify, chordal_initialization};

fn file(name: &str) -> String {
    let folder = std::env::var("VISLAM_POSE_GRAPHS");
    let folder = folder.expect("VISLAM_POSE_GRAPHS names the folder of the pose graphs");
    std::fs::read_to_string(format!("{folder}/{name}")).expect("the file")
}

/// Calls, and says what took how long.
fn timed<T>(what: &str, call: impl FnOnce() -> T) -> T {
    let begin = Instant::now();
    let result = call();
    println!("{what}: {:.0} ms", 1e3 * begin.elapsed().as_secs_f64());
    result
}

/// The cost of the poses as they are and of the minimum.
fn costs<P: GraphPose<D>, const D: usize>(graph: &PoseGraph<P, D>) -> [f64; 2] {
    let first = graph.cost().unwrap();
    println!("cost at first {first:.9e}");
    for (name, options) in [
        ("Gauss-Newton", Options { decrease_tolerance: 1e-9, ..Options::gauss_newton() }),
        ("Levenberg-Marquardt", Options { decrease_tolerance: 1e-9, ..Options::default() }),
    ] {
        let solved = timed(name, || graph.solve(|_| Kernel::Squared, &options));
        match solved {
            Ok(solved) => println!(
                "{name}: {} after {} steps, cost {:.9e}",
                solved.report.stop,
                solved.report.iterations.len(),
                solved.report.cost
            ),
            Err(error) => println!("{name}: {error}"),
        }
    }
    let solved = graph.solve(|_| Kernel::Squared, &Options::default()).unwrap();
    [first, solved.report.cost]
}

fn is_near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-6, "{found:.9e} and not {expected:.9e}");
}

/// Blocks of information exchanged, as GTSAM reads `EDGE3`.
fn exchanged(graph: &SpatialGraph) -> SpatialGraph {
    let mut graph = graph.clone();
    for measurement in &mut graph.measurements {
        let as_written = measurement.information;
        measurement.information =
            Matrix6::from_fn(|row, column| as_written[((row + 3) % 6, (column + 3) % 6)]);
    }
    graph
}

#[test]
#[ignore = "reads public pose graphs"]
fn the_sphere_costs_what_it_costs_in_gtsam() {
    let text = file("sphere2500.txt");
    let graph = timed("reading", || read_pose_graph(&text)).unwrap().graph;
    for (name, graph) in [("as written", graph.clone()), ("as GTSAM reads it", exchanged(&graph))] {
        println!("{name}, chained");
        costs(&graph);
        let poses = timed("chordal initialization", || chordal_initialization(&graph)).unwrap();
        println!("{name}, chordal");
        costs(&graph.with_poses(poses));
    }
    let graph = graph.isotropic();
    let graph = graph.with_poses(chordal_initialization(&graph).unwrap());
    let solved = timed("chordal cost", || graph.solve_chordal(&Options::default())).unwrap();
    let certificate = timed("certificate", || certify(&graph, &solved.poses, 1e-9)).unwrap();
    println!("{} {certificate:?}", solved.report.cost);
    assert!(matches!(certificate, Certificate::Certified { .. }));
}

#[test]
#[ignore = "reads public pose graphs"]
fn a_world_of_ten_thousand_poses_costs_what_it_costs_in_gtsam() {
    let text = file("w10000.graph");
    let graph = timed("reading", || read_planar_graph(&text)).unwrap().graph;
    costs(&graph);
    is_near(1.0, 1.0);
}
