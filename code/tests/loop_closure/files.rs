//! What is read from files of pose graphs. The costs beside them are what GTSAM 4.3.0 gives for the same
//! texts.

use approx::assert_abs_diff_eq;
use nalgebra::{Isometry2, Matrix3, Matrix6};
use vislam::datasets::pose_graph::{
    PoseGraphError, PoseGraphFault, read_planar_graph, read_pose_graph,
};
use vislam::loop_closure::SpatialGraph;

const SPACE: &str = "\
VERTEX_SE3:QUAT 3 0.1 -0.2 0.3 0 0 0 1
VERTEX_SE3:QUAT 5 1.2 0.1 -0.1 0.1 0.2 -0.3 0.9273618495495703
VERTEX_SE3:QUAT 9 1.9 1.4 0.2 -0.2 0.4 0.1 0.8888194417315589
EDGE_SE3:QUAT 3 5 1 0.2 -0.3 0.15 0.25 -0.2 0.9353074360871938 10 1 2 3 4 5 20 1 2 3 4 30 1 2 3 40 1 2 50 1 60
EDGE_SE3:QUAT 5 9 0.5 1.1 0.4 -0.3 0.1 0.4 0.8602325267042626 7 -1 0.5 2 1 -0.5 8 0.2 1 -1 2 9 1 0.3 -2 50 3 -4 60 5 70
EDGE_SE3:QUAT 9 3 -1.5 -1.2 -0.9 0.2 -0.5 0.1 0.8366600265340756 5 0 0 0 0 0 5 0 0 0 0 5 0 0 0 25 0 0 25 0 25
";

const PLANE: &str = "\
VERTEX_SE2 0 0.1 -0.2 0.3
VERTEX_SE2 1 1.2 0.4 0.7
VERTEX_SE2 2 1.9 1.5 1.6
EDGE_SE2 0 1 1 0.2 0.6 10 1 2 20 3 30
EDGE_SE2 1 2 0.9 0.3 1.2 5 -1 0.5 6 1 7
EDGE_SE2 2 0 -2.1 1.4 -1.1 2 0 0 3 0 4
";

const EULER: &str = "\
VERTEX3 0 0.1 -0.2 0.3 0 0 0
VERTEX3 1 1.2 0.1 -0.1 0.1 0.2 -0.7
EDGE3 0 1 1 0.2 -0.3 0.3 -0.4 0.5 10 1 2 3 4 5 20 1 2 3 4 30 1 2 3 40 1 2 50 1 60
";

#[test]
fn a_graph_in_space_costs_what_it_costs_in_gtsam() {
    let file = read_pose_graph(SPACE).unwrap();
    assert_eq!(file.vertices, [3, 5, 9]);
    assert_abs_diff_eq!(file.graph.cost().unwrap(), 13.223498930648702, epsilon = 1e-9);
    let parts = [1.8164974847370672, 6.121082821031182, 5.285918624880452];
    for (number, part) in parts.into_iter().enumerate() {
        assert_abs_diff_eq!(0.5 * file.graph.squared_error(number).unwrap(), part, epsilon = 1e-9);
    }
}

#[test]
fn a_graph_in_the_plane_costs_what_it_costs_in_gtsam() {
    let graph = read_planar_graph(PLANE).unwrap().graph;
    assert_abs_diff_eq!(graph.cost().unwrap(), 2.2598886977205837, epsilon = 1e-9);
}

#[test]
fn an_edge_of_euler_angles_has_its_translation_first_and_gtsam_takes_it_for_the_rotation() {
    let mut graph: SpatialGraph = read_pose_graph(EULER).unwrap().graph;
    assert!((graph.cost().unwrap() - 27.68356434716279).abs() > 0.1);
    let order = [3, 4, 5, 0, 1, 2];
    let as_written = graph.measurements[0].information;
    graph.measurements[0].information =
        Matrix6::from_fn(|row, column| as_written[(order[row], order[column])]);
    assert_abs_diff_eq!(graph.cost().unwrap(), 27.68356434716279, epsilon = 1e-9);
}

#[test]
fn information_in_the_order_of_toro_is_that_in_the_order_of_g2o() {
    let g2o = PLANE.replace("VERTEX_SE2", "VERTEX2");
    let toro = g2o
        .replace("EDGE_SE2 0 1 1 0.2 0.6 10 1 2 20 3 30", "EDGE2 0 1 1 0.2 0.6 10 1 20 30 2 3")
        .replace("EDGE_SE2 1 2 0.9 0.3 1.2 5 -1 0.5 6 1 7", "EDGE2 1 2 0.9 0.3 1.2 5 -1 6 7 0.5 1");
    let (g2o, toro) = (read_planar_graph(&g2o).unwrap(), read_planar_graph(&toro).unwrap());
    for (one, other) in g2o.graph.measurements.iter().zip(&toro.graph.measurements) {
        assert_eq!(one.information, other.information);
    }
}

#[test]
fn what_a_file_does_not_say_is_filled_in() {
    let file = read_planar_graph(
        "# a walk\r\nFIX 0\r\n\r\nEDGE2 0 7 1 0 0\r\nEQUIV 0 7\r\nEDGE2 7 8 1 0 0.5\r\n",
    );
    let file = file.unwrap();
    assert_eq!((file.left_out, file.vertices.as_slice()), (3, [0, 7, 8].as_slice()));
    assert_eq!(file.graph.measurements[1].information, Matrix3::identity());
    // Without vertices the poses follow from the edges.
    let expected = Isometry2::new([2.0, 0.0].into(), 0.5);
    assert_abs_diff_eq!(file.graph.poses[2], expected, epsilon = 1e-15);
}

#[test]
fn a_fault_in_a_file_is_told_with_its_line_and_what_to_do() {
    let told = |text: &str| read_pose_graph(text).unwrap_err().to_string();
    assert_eq!(told(""), "line 1: the file ends without any edge; it is not complete");
    assert_eq!(
        told("\nVERTEX_SE2 0 0 0 0"),
        "line 2: `VERTEX_SE2` is neither vertex nor edge of a pose graph of this kind; read planar graphs \
         as such, and remove landmarks"
    );
    assert_eq!(
        told("VERTEX3 0 0 0 0 0 0 x"),
        "line 1: `x` is not a finite number of a position or angle; mend the field or remove the line"
    );
    assert_eq!(
        told("VERTEX3 0 0 0 0 0 0"),
        "line 1: the line ends where a finite number of a position or angle should stand; it is not \
         complete"
    );
    assert_eq!(
        told("VERTEX_SE3:QUAT 0 0 0 0 1 1 1 1"),
        "line 1: the quaternion has norm 2; a rotation has norm 1, with its scalar part last"
    );
    assert_eq!(
        told("VERTEX3 0 0 0 0 0 0 0\nVERTEX3 0 0 0 0 0 0 0"),
        "line 2: vertex 0 stands here for the second time; remove one of the two"
    );
    assert_eq!(
        told("VERTEX3 0 0 0 0 0 0 0\n\nEDGE3 0 1 0 0 0 0 0 0"),
        "line 3: vertex 1 has no line of its own; add one, or remove those of all others"
    );
    assert_eq!(
        told("EDGE3 2 2 0 0 0 0 0 0"),
        "line 1: the edge goes from vertex 2 to itself; remove it"
    );
    assert_eq!(
        told("EDGE3 4 5 0 0 0 0 0 0\nEDGE3 6 7 0 0 0 0 0 0"),
        "line 2: no chain of edges leads from vertex 4 to vertex 6; add one, or split the file"
    );
    let fault = |text: &str| {
        let PoseGraphError { line, fault } = read_planar_graph(text).unwrap_err();
        (line, fault)
    };
    // Information in the order of g2o under TORO's tag.
    assert_eq!(fault("EDGE2 0 1 0 0 0 1 0 0 1 0 1"), (1, PoseGraphFault::Information));
    assert_eq!(
        fault("EDGE_SE2 0 1 0 0 0 1 0 0 1 0 1 7"),
        (1, PoseGraphFault::Rest { text: "7".into() })
    );
    for number in ["NaN", "inf", "1e999"] {
        let (line, fault) = fault(&format!("\n\nEDGE2 0 1 0 {number} 0"));
        assert!(line == 3 && matches!(fault, PoseGraphFault::Number { .. }));
    }
    assert!(told(&"é".repeat(100_000)).len() < 500);
}
