//! Public pose graphs. They are no part of the library: `VISLAM_POSE_GRAPHS` names their folder, which
//! may be that of the examples that come with GTSAM. The costs beside them are what GTSAM 4.3.0 gives.

use nalgebra::{Isometry3, Matrix6};
use vislam::datasets::pose_graph::{read_planar_graph, read_pose_graph};
use vislam::factors::GraphPose;
use vislam::least_squares::{Kernel, Options};
use vislam::loop_closure::{
    Certificate, PoseGraph, SpatialGraph, certify, chordal_initialization, pose_graph_options,
};

fn file(name: &str) -> String {
    let folder = std::env::var("VISLAM_POSE_GRAPHS");
    let folder = folder.expect("VISLAM_POSE_GRAPHS names the folder of the pose graphs");
    std::fs::read_to_string(format!("{folder}/{name}")).expect("the file")
}

/// Compares to six digits.
fn is_near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-6, "{found:.9e} and not {expected:.9e}");
}

fn minimum<P: GraphPose<D>, const D: usize>(graph: &PoseGraph<P, D>, options: &Options) -> f64 {
    let solved = graph.solve(|_| Kernel::Squared, options).unwrap();
    assert!(solved.report.stop.is_convergence(), "{}", solved.report.stop);
    solved.report.cost
}

#[test]
#[ignore = "reads public pose graphs"]
fn the_sphere_costs_what_it_costs_in_gtsam() {
    let graph = read_pose_graph(&file("sphere2500.txt")).unwrap().graph;
    is_near(graph.cost().unwrap(), 1.287028827e6);
    let chordal = graph.with_poses(chordal_initialization(&graph).unwrap());
    for options in [Options::gauss_newton(), pose_graph_options()] {
        is_near(minimum(&graph, &options), 3.644948686e2);
        is_near(minimum(&chordal, &options), 3.644948686e2);
    }
}

/// Blocks of information exchanged, as GTSAM reads `EDGE3`.
fn exchanged(mut graph: SpatialGraph) -> SpatialGraph {
    for measurement in &mut graph.measurements {
        let written = measurement.information;
        measurement.information =
            Matrix6::from_fn(|row, column| written[((row + 3) % 6, (column + 3) % 6)]);
    }
    graph
}

#[test]
#[ignore = "reads public pose graphs"]
fn the_sphere_as_gtsam_reads_it_costs_what_it_costs_there() {
    let graph = exchanged(read_pose_graph(&file("sphere2500.txt")).unwrap().graph);
    is_near(graph.cost().unwrap(), 1.228097877e7);
    let chordal = graph.with_poses(chordal_initialization(&graph).unwrap());
    let options = Options { max_iterations: 500, ..pose_graph_options() };
    is_near(minimum(&chordal, &options), 1.132991982e3);
}

#[test]
#[ignore = "reads public pose graphs"]
fn the_isotropic_sphere_has_a_certificate() {
    let graph = read_pose_graph(&file("sphere2500.txt")).unwrap().graph.isotropic();
    let poses = chordal_initialization(&graph).unwrap();
    let solved = graph.with_poses(poses).solve_chordal(&pose_graph_options()).unwrap();
    let Certificate::Certified { cost, lower_bound, .. } =
        certify(&graph, &solved.poses, 1e-10).unwrap()
    else {
        panic!("not certified")
    };
    assert!(lower_bound < cost && cost - lower_bound < 1e-6 * cost);
    // Where all poses are the same, nothing is certified.
    let nowhere = vec![Isometry3::identity(); graph.poses.len()];
    let certificate = certify(&graph, &nowhere, 1e-10).unwrap();
    assert!(matches!(certificate, Certificate::NotApplicable(_)));
}

#[test]
#[ignore = "reads public pose graphs"]
fn a_plane_of_ten_thousand_poses_costs_what_it_costs_in_gtsam() {
    let graph = read_planar_graph(&file("w10000.graph")).unwrap().graph;
    is_near(graph.cost().unwrap(), 2.760314782e7);
    for options in [Options::gauss_newton(), pose_graph_options()] {
        is_near(minimum(&graph, &options), 1.448673816e2);
    }
}

#[test]
#[ignore = "reads public pose graphs"]
fn other_public_files_are_read() {
    for name in ["pose3example.txt", "pose3example-grid.txt", "Klaus3.g2o", "toyExample.g2o"] {
        assert!(read_pose_graph(&file(name)).is_ok(), "{name}");
    }
    for name in ["w100.graph", "noisyToyGraph.txt", "pose2example.txt"] {
        assert!(read_planar_graph(&file(name)).is_ok(), "{name}");
    }
    // Without information, and with Euler angles.
    assert_eq!(read_pose_graph(&file("sphere_smallnoise.graph")).unwrap().vertices.len(), 2200);
    // Under TORO's tag, in another order.
    assert!(read_planar_graph(&file("w20000.txt")).is_err());
}
