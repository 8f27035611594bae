//! Pose graphs: their minimum, whether it is the lowest one, and what wrong loops do.

#[path = "loop_closure/certified.rs"]
mod certified;
#[path = "loop_closure/files.rs"]
mod files;
#[path = "loop_closure/keyframes.rs"]
mod keyframes;
#[path = "loop_closure/measured.rs"]
mod measured;
#[path = "loop_closure/simulated.rs"]
mod simulated;
#[path = "loop_closure/wrong_loops.rs"]
mod wrong_loops;

use approx::assert_abs_diff_eq;
use nalgebra::{
    DMatrix, Isometry3, Matrix6, Quaternion, SMatrix, UnitQuaternion, Vector3, Vector6,
};
use simulated::{Draws, largest_error, noisy_laps};
use vislam::factors::{BetweenPoses, ChordalPose, GraphPose, RelativePose, Switched};
use vislam::least_squares::{Kernel, Manifold, Options, Problem, SparseCholesky};
use vislam::loop_closure::{
    LoopClosureError, SpatialGraph, UprightPose, certify, chordal_initialization,
};
use vislam::manifold::{se2, se3, so3};

// Derivatives.

/// The largest difference between the Jacobian of a problem and central differences of its residual.
fn jacobian_error(problem: &Problem) -> f64 {
    let values = problem.values();
    let (jacobian, _) = problem.jacobian(values).unwrap();
    let step = 1e-5;
    let residual = |column: usize, by: f64| {
        let mut all = vec![0.0; values.dimension()];
        all[column] = by;
        problem.residual(&values.retract(&all)).unwrap()
    };
    let slope = |column| (residual(column, step) - residual(column, -step)) / (2.0 * step);
    let slopes: Vec<_> = (0..values.dimension()).map(slope).collect();
    (jacobian - DMatrix::from_columns(&slopes)).amax()
}

fn pair<P: GraphPose<D>, const D: usize>(
    [first, second]: [P; 2],
    measured: P::Measured,
) -> (Problem, BetweenPoses<P, D>) {
    let mut problem = Problem::new();
    let sqrt_information =
        SMatrix::from_fn(
            |row, column| if row <= column { 1.0 / (1 + row + column) as f64 } else { 0.0 },
        );
    let (first, second) = (problem.add_variable(first), problem.add_variable(second));
    (problem, BetweenPoses { first, second, measured, sqrt_information })
}

fn slopes_are_right<P: GraphPose<D>, const D: usize>(poses: [P; 2], measured: P::Measured) {
    let (mut problem, factor) = pair(poses, measured);
    problem.add_factor(factor.clone(), Kernel::Squared).unwrap();
    let switch = problem.add_variable(nalgebra::Vector1::new(0.7));
    problem.add_factor(Switched { measurement: factor, switch }, Kernel::Squared).unwrap();
    assert!(jacobian_error(&problem) < 1e-7, "{}", jacobian_error(&problem));
}

#[test]
fn a_relative_pose_has_the_slopes_of_its_residual_in_space_in_the_plane_and_upright() {
    let mut draws = Draws::new(1);
    for _ in 0..50 {
        let [first, second, measured] = [(); 3].map(|()| se3::exp(&draws.twist(3.0, 1.5)));
        slopes_are_right([first, second], measured);
        slopes_are_right([first, second].map(UprightPose::new), measured);
        let [first, second, measured] =
            [(); 3].map(|()| se2::exp(&draws.twist(3.0, 1.0).fixed_rows::<3>(2).into_owned()));
        slopes_are_right([first, second], measured);
    }
}

#[test]
fn a_chord_has_the_slopes_of_its_residual() {
    let mut draws = Draws::new(2);
    for _ in 0..50 {
        let [first, second, measured] = [(); 3].map(|()| se3::exp(&draws.twist(3.0, 1.5)));
        let mut problem = Problem::new();
        let (first, second) = (problem.add_variable(first), problem.add_variable(second));
        let [rotation_weight, translation_weight] = [7.0, 3.0];
        let factor = ChordalPose { first, second, measured, rotation_weight, translation_weight };
        problem.add_factor(factor, Kernel::Squared).unwrap();
        assert!(jacobian_error(&problem) < 1e-7);
    }
}

#[test]
fn a_chord_costs_half_the_square_of_nine_entries_at_any_angle() {
    let mut draws = Draws::new(10);
    for _ in 0..50 {
        let [first, second, measured] = [(); 3].map(|()| se3::exp(&draws.twist(3.0, 1.5)));
        let matrix = |pose: &Isometry3<f64>| pose.rotation.to_rotation_matrix().into_inner();
        let chord = matrix(&second) - matrix(&first) * matrix(&measured);
        let shift = second.translation.vector - (first * measured).translation.vector;
        let expected = 0.5 * (49.0 / 2.0 * chord.norm_squared() + 9.0 * shift.norm_squared());
        let mut problem = Problem::new();
        let (first, second) = (problem.add_variable(first), problem.add_variable(second));
        let [rotation_weight, translation_weight] = [7.0, 3.0];
        let factor = ChordalPose { first, second, measured, rotation_weight, translation_weight };
        problem.add_factor(factor, Kernel::Squared).unwrap();
        let cost = problem.cost(problem.values());
        assert_abs_diff_eq!(cost, expected, epsilon = 1e-12 * expected);
    }
}

#[test]
fn a_small_chord_costs_what_the_arc_costs() {
    let mut draws = Draws::new(3);
    let small = draws.twist(1e-4, 1e-4);
    let mut problem = Problem::new();
    let first = problem.add_variable(se3::exp(&draws.twist(3.0, 1.5)));
    let measured = se3::exp(&draws.twist(3.0, 1.5));
    let second = problem.values()[first] * measured * se3::exp(&small);
    let second = problem.add_variable(second);
    let factor =
        ChordalPose { first, second, measured, rotation_weight: 7.0, translation_weight: 3.0 };
    problem.add_factor(factor, Kernel::Squared).unwrap();
    let arc = 0.5
        * (9.0 * small.fixed_rows::<3>(0).norm_squared()
            + 49.0 * small.fixed_rows::<3>(3).norm_squared());
    assert_abs_diff_eq!(problem.cost(problem.values()) / arc, 1.0, epsilon = 1e-4);
}

#[test]
fn a_planar_pose_is_a_pose_in_space_that_stays_in_the_plane() {
    let mut draws = Draws::new(4);
    let lift = |xi: &Vector3<f64>| Vector6::new(xi.x, xi.y, 0.0, 0.0, 0.0, xi.z);
    for _ in 0..100 {
        let xi: Vector3<f64> = draws.twist(3.0, 1.7).fixed_rows::<3>(2).into();
        let (flat, space) = (se2::exp(&xi), se3::exp(&lift(&xi)));
        assert_abs_diff_eq!(
            flat.translation.vector,
            space.translation.vector.xy(),
            epsilon = 1e-13
        );
        assert_abs_diff_eq!(lift(&se2::log(&flat)), se3::log(&space), epsilon = 1e-12);
        let rows = [0, 1, 5];
        let of_plane = |matrix: Matrix6<f64>| matrix.select_rows(&rows).select_columns(&rows);
        let pairs = [
            (se2::adjoint(&flat), se3::adjoint(&space)),
            (se2::right_jacobian_inverse(&xi), se3::right_jacobian_inverse(&lift(&xi))),
        ];
        for (flat, space) in pairs {
            assert!(
                (DMatrix::from_iterator(3, 3, flat.iter().copied()) - of_plane(space)).amax()
                    < 1e-12
            );
        }
    }
}

#[test]
fn a_body_and_a_camera_say_the_same_of_a_relative_pose() {
    let mut draws = Draws::new(5);
    let poses = [(); 2].map(|()| se3::exp(&draws.twist(3.0, 1.5)));
    let measured = se3::exp(&draws.twist(3.0, 1.5));
    let (mut by_body, factor) = pair(poses, measured);
    let sqrt_information = factor.sqrt_information;
    by_body.add_factor(factor, Kernel::Squared).unwrap();
    let mut by_camera = Problem::new();
    let [first, second] = poses.map(|pose| by_camera.add_variable(pose.inverse()));
    let factor = RelativePose { first: second, second: first, measured, sqrt_information };
    by_camera.add_factor(factor, Kernel::Squared).unwrap();
    let cost = |problem: &Problem| problem.cost(problem.values());
    assert_abs_diff_eq!(cost(&by_body), cost(&by_camera), epsilon = 1e-10 * cost(&by_body));
}

// Four degrees of freedom.

#[test]
fn an_upright_pose_keeps_roll_and_pitch_and_comes_where_a_step_leads() {
    let mut draws = Draws::new(6);
    for _ in 0..100 {
        let pose = UprightPose::new(se3::exp(&draws.twist(3.0, 1.0)));
        let step = [(); 4].map(|()| draws.number().clamp(-3.0, 3.0));
        let moved = pose.retract(&step);
        let up = |pose: &UprightPose| pose.world_from_body.rotation.inverse() * Vector3::z();
        assert_abs_diff_eq!(up(&pose), up(&moved), epsilon = 1e-14);
        let mut back = [0.0; 4];
        pose.local(&moved, &mut back);
        for (expected, found) in step.iter().zip(back) {
            assert_abs_diff_eq!(*expected, found, epsilon = 1e-13);
        }
    }
}

#[test]
fn what_only_the_four_can_be_wrong_in_costs_the_same_in_six() {
    let (truth, graph) = noisy_laps(12, 0.0, 0.0, 1);
    let upright: Vec<UprightPose> = truth.iter().map(|pose| UprightPose::new(*pose)).collect();
    let mut draws = Draws::new(7);
    let moved = |pose: &UprightPose| pose.retract(&[(); 4].map(|()| 1e-5 * draws.number()));
    let moved: Vec<UprightPose> = upright.iter().map(moved).collect();
    let six = graph.with_poses(moved.iter().map(|pose| pose.world_from_body).collect());
    let four = six.upright().cost().unwrap();
    assert_abs_diff_eq!(six.cost().unwrap() / four, 1.0, epsilon = 1e-3);
}

#[test]
fn a_closed_loop_takes_the_drift_out_of_four_degrees_of_freedom_and_leaves_the_tilt() {
    let (truth, graph) = noisy_laps(60, 0.02, 0.004, 2);
    // An inertial odometry drifts in position and yaw; its roll and pitch are those of the truth.
    let drift = |(number, pose): (usize, &Isometry3<f64>)| {
        let number = number as f64;
        UprightPose::new(*pose).retract(&[
            0.02 * number,
            -0.01 * number,
            0.01 * number,
            0.006 * number,
        ])
    };
    let drifted: Vec<_> = truth.iter().enumerate().map(drift).collect();
    let graph = graph
        .with_poses(drifted.iter().map(|pose| pose.world_from_body).collect::<Vec<_>>())
        .upright();
    let solved = graph.solve(|_| Kernel::Squared, &Options::default()).unwrap();
    assert!(solved.report.stop.is_convergence());
    let poses: Vec<_> = solved.poses.iter().map(|pose| pose.world_from_body).collect();
    let before: Vec<_> = drifted.iter().map(|pose| pose.world_from_body).collect();
    assert!(largest_error(&before, &truth) > 1.0);
    assert!(largest_error(&poses, &truth) < 0.3, "{}", largest_error(&poses, &truth));
    for (pose, before) in poses.iter().zip(&before) {
        let up = |pose: &Isometry3<f64>| pose.rotation.inverse() * Vector3::z();
        assert_abs_diff_eq!(up(pose), up(before), epsilon = 1e-12);
    }
}

#[test]
fn a_measured_pose_upside_down_says_nothing_of_yaw() {
    let over = Isometry3::rotation(std::f64::consts::PI * Vector3::x());
    let pose = UprightPose::new(Isometry3::identity());
    assert!(pose.error(&pose, &over).is_none());
}

// Graphs.

#[test]
fn what_was_measured_without_errors_is_found_from_anywhere_near() {
    let (truth, graph) = noisy_laps(40, 0.0, 0.0, 3);
    assert!(graph.with_poses(truth.clone()).cost().unwrap() < 1e-20);
    let chained = graph.chained().unwrap();
    assert!(largest_error(&chained, &truth) < 1e-9);
    let mut draws = Draws::new(8);
    let moved = |pose: &Isometry3<f64>| pose * se3::exp(&draws.twist(0.1, 0.05));
    let mut moved: Vec<_> = truth.iter().map(moved).collect();
    moved[0] = truth[0];
    let solved = graph.with_poses(moved).solve(|_| Kernel::Squared, &Options::default()).unwrap();
    assert!(largest_error(&solved.poses, &truth) < 1e-6);
}

#[test]
fn chained_poses_go_along_the_odometry_before_they_take_a_loop() {
    let (_, graph) = noisy_laps(40, 0.1, 0.05, 4);
    let chained = graph.chained().unwrap();
    for measurement in graph.measurements.iter().filter(|it| it.second == it.first + 1) {
        let predicted = chained[measurement.first] * measurement.measured;
        assert!(
            (predicted.inverse() * chained[measurement.second]).translation.vector.norm() < 1e-9
        );
    }
    // Without a link in the chain a loop leads on.
    let mut cut = graph.clone();
    cut.measurements.retain(|it| (it.first, it.second) != (30, 31));
    assert!(cut.chained().is_ok());
}

#[test]
fn a_graph_that_cannot_be_solved_is_refused_in_words() {
    let (_, graph) = noisy_laps(10, 0.1, 0.05, 5);
    let refused = |change: &dyn Fn(&mut SpatialGraph)| {
        let mut graph = graph.clone();
        change(&mut graph);
        let error = graph.solve(|_| Kernel::Squared, &Options::default()).unwrap_err();
        assert!(chordal_initialization(&graph).is_err());
        error
    };
    assert_eq!(
        refused(&|graph| graph.measurements.clear()),
        LoopClosureError::Empty { poses: 20, measurements: 0 }
    );
    assert_eq!(
        refused(&|graph| graph.measurements[3].second = 99).to_string(),
        "measurement 3 names pose 99 of 20, which are counted from zero; add the pose or remove the \
         measurement"
    );
    assert_eq!(
        refused(&|graph| graph.measurements[3].second = 3),
        LoopClosureError::SamePose { measurement: 3, pose: 3 }
    );
    assert_eq!(
        refused(&|graph| graph.measurements[2].measured.translation.vector.x = f64::NAN),
        LoopClosureError::NotFinite { measurement: 2 }
    );
    assert_eq!(
        refused(&|graph| graph.poses[0].translation.vector.y = f64::NAN),
        LoopClosureError::PoseNotFinite { pose: 0 }
    );
    for (row, number) in [(2, f64::NAN), (0, f64::NAN), (0, f64::INFINITY)] {
        assert_eq!(
            refused(&|graph| graph.measurements[1].information[(row, 2)] = number),
            LoopClosureError::NotFinite { measurement: 1 }
        );
    }
    for (row, column, number) in [(0, 0, -1.0), (4, 4, 0.0), (0, 1, 5.0)] {
        assert_eq!(
            refused(&|graph| graph.measurements[1].information[(row, column)] = number),
            LoopClosureError::Information { measurement: 1 }
        );
    }
    assert_eq!(
        refused(&|graph| graph.poses.push(Isometry3::identity())),
        LoopClosureError::Unreached { pose: 20 }
    );
}

#[test]
fn poses_that_are_no_numbers_are_refused_unless_others_are_asked_for() {
    let (truth, mut graph) = noisy_laps(10, 0.0, 0.0, 5);
    let mut upright = graph.upright();
    let nowhere = LoopClosureError::PoseNotFinite { pose: 7 };
    let turned = UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    graph.poses[7].translation.vector.y = f64::NAN;
    let solved = graph.solve(|_| Kernel::Squared, &Options::default());
    assert_eq!(solved.unwrap_err(), nowhere);
    graph.poses[7] = truth[7];
    graph.poses[7].rotation = turned;
    upright.poses[7].world_from_body.rotation = turned;
    assert_eq!(graph.cost().unwrap_err(), nowhere);
    assert_eq!(upright.cost().unwrap_err(), nowhere);
    assert!(largest_error(&graph.chained().unwrap(), &truth) < 1e-9);
    assert!(largest_error(&chordal_initialization(&graph).unwrap(), &truth) < 1e-9);
    assert_eq!(certify(&graph, &graph.poses, 1e-6).unwrap_err(), nowhere);
    assert!(certify(&graph, &truth, 1e-6).is_ok());
}

// Where to begin.

#[test]
fn two_linear_problems_find_what_was_measured_without_errors() {
    let (truth, graph) = noisy_laps(40, 0.0, 0.0, 6);
    let mut blind = vec![Isometry3::identity(); truth.len()];
    blind[0] = truth[0];
    let found = chordal_initialization(&graph.with_poses(blind)).unwrap();
    assert!(largest_error(&found, &truth) < 1e-9);
    for (found, truth) in found.iter().zip(&truth) {
        assert!(so3::local(&truth.rotation.into(), &found.rotation.into()).norm() < 1e-9);
    }
}

#[test]
fn chordal_initialization_is_nearer_to_the_minimum_than_chained_odometry() {
    let (_, graph) = noisy_laps(60, 0.05, 0.05, 7);
    let cost = |poses| graph.with_poses(poses).cost().unwrap();
    let chained = cost(graph.chained().unwrap());
    let chordal = cost(chordal_initialization(&graph).unwrap());
    let begin = graph.with_poses(chordal_initialization(&graph).unwrap());
    let best = begin.solve(|_| Kernel::Squared, &Options::default()).unwrap().report.cost;
    assert!(best < chordal && chordal < 5.0 * best, "{best} {chordal}");
    assert!(chained > 100.0 * chordal, "{chordal} {chained}");
}

// The factorization below.

#[test]
fn a_sparse_matrix_is_factored_solved_and_found_out_when_it_is_not_definite() {
    let mut draws = Draws::new(9);
    let sizes = [3, 4, 4, 4, 2, 4, 4];
    let pairs = [[0, 1], [2, 1], [2, 3], [3, 4], [5, 4], [5, 6], [6, 0], [1, 5]];
    let starts: Vec<usize> = sizes
        .iter()
        .scan(0, |end, size| {
            *end += size;
            Some(*end - size)
        })
        .collect();
    let dimension = sizes.iter().sum();
    let mut sparse = SparseCholesky::new(&sizes, &pairs);
    let mut dense = DMatrix::<f64>::zeros(dimension, dimension);
    for block in 0..sizes.len() {
        let own = SMatrix::<f64, 4, 4>::from_fn(|_, _| draws.number());
        let own = own + own.transpose();
        sparse.add(block, block, &own);
        let mut place =
            dense.view_mut((starts[block], starts[block]), (sizes[block], sizes[block]));
        place += own.view((0, 0), (sizes[block], sizes[block]));
    }
    for [rows, columns] in pairs {
        let block = SMatrix::<f64, 4, 4>::from_fn(|_, _| draws.number());
        sparse.add(rows, columns, &block);
        for row in 0..sizes[rows] {
            for column in 0..sizes[columns] {
                dense[(starts[rows] + row, starts[columns] + column)] += block[(row, column)];
                dense[(starts[columns] + column, starts[rows] + row)] += block[(row, column)];
            }
        }
    }
    let smallest = dense.clone().symmetric_eigenvalues().min();
    assert!(smallest < -1.0 && !sparse.factorize(|_, _| 0.0));
    assert!(!sparse.factorize(|_, _| -smallest - 1e-9));
    assert!(sparse.factorize(|_, _| -smallest + 1e-9));
    assert!(sparse.factorize(|_, _| 20.0));
    let right: Vec<f64> = (0..dimension).map(|_| draws.number()).collect();
    let mut found = right.clone();
    sparse.solve(&mut found);
    let back = (dense + DMatrix::identity(dimension, dimension) * 20.0)
        * nalgebra::DVector::from_vec(found);
    assert!((back - nalgebra::DVector::from_vec(right)).amax() < 1e-12);
}
