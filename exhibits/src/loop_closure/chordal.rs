//! The chord, and where to begin.

use nalgebra::{DMatrix, Dyn, Isometry3, Matrix3, OMatrix, Rotation3, U3, Vector3};
use vislam::loop_closure::{PoseGraph, SpatialGraph, chordal_initialization};

use super::STATES;
use super::draws::{isotropic, measure, pose};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered};
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Chord = |angle| 8_f64.sqrt() * (0.5 * angle).sin();
    let mutants: [(_, Chord); 3] = [
        ("the arc", |angle| 2_f64.sqrt() * angle),
        ("the sine of the whole angle", |angle| 2_f64.sqrt() * angle.sin()),
        ("the distance of two unit vectors", |angle| 2.0 * (0.5 * angle).sin()),
    ];
    chapter.equation("chord-length", chord_length, formula, &mutants);

    let formula: Start = |graph| chordal_initialization(graph).ok();
    let mutants: [(_, Start); 4] = [
        ("measured rotations transposed", |graph| {
            relaxed(&altered(graph.clone(), |graph| {
                for measurement in &mut graph.measurements {
                    measurement.measured.rotation = measurement.measured.rotation.inverse();
                }
            }))
        }),
        ("all weights alike", |graph| {
            relaxed(&altered(graph.clone(), |graph| {
                graph.measurements.iter_mut().for_each(|m| m.information = isotropic(1.0, 1.0));
            }))
        }),
        ("measurements chained", |graph| graph.chained().ok()),
        ("positions from rotations as they were", |graph| {
            let poses = relaxed(graph)?;
            let rotated = |(pose, was): (&Isometry3<f64>, &Isometry3<f64>)| {
                Isometry3::from_parts(was.translation, pose.rotation)
            };
            Some(poses.iter().zip(&graph.chained().ok()?).map(rotated).collect())
        }),
    ];
    chapter.equation("chordal-start", chordal_start, formula, &mutants);
}

/// The length of the chord between two rotations, by the angle between them.
type Chord = fn(f64) -> f64;

fn chord_length(formula: Chord) -> Comparison {
    let against = "the norm of nine differences";
    Comparison::relative(against, 1e-9).over(STATES, 86, |random| {
        let (rotation, axis) = (random.rotation(3.0), random.direction(1.0));
        let angle = random.uniform(0.01..3.1);
        let turned = rotation * Rotation3::new(angle * axis);
        (formula(angle), (turned.matrix() - rotation.matrix()).norm())
    })
}

/// Poses to begin with.
type Start = fn(&SpatialGraph) -> Option<Vec<Isometry3<f64>>>;

/// A few poses, with measurements of different weights that contradict each other.
fn drawn(random: &mut Random) -> SpatialGraph {
    let poses: Vec<_> = (0..5).map(|_| pose(random)).collect();
    let pairs = [[0, 1], [1, 2], [2, 3], [3, 4], [4, 0], [1, 3]];
    let measurements = pairs.map(|pair| {
        let about = random.logarithmic(0.02..0.3);
        measure(&poses, pair, [random.logarithmic(0.05..0.5), about], random)
    });
    PoseGraph { poses, measurements: measurements.to_vec() }
}

/// The rotation that comes nearest to a matrix with a positive determinant, by Newton's iteration.
fn nearest(matrix: Matrix3<f64>) -> Option<Rotation3<f64>> {
    let mut matrix = matrix;
    for _ in 0..60 {
        matrix = 0.5 * (matrix + matrix.try_inverse()?.transpose());
    }
    Some(Rotation3::from_matrix_unchecked(matrix))
}

/// Three right-hand sides.
type Sides = OMatrix<f64, Dyn, U3>;

/// The least squares of rows with three right-hand sides.
fn least(rows: &DMatrix<f64>, known: &Sides) -> Option<Sides> {
    (rows.transpose() * rows).try_inverse().map(|inverse| inverse * rows.transpose() * known)
}

/// The two linear problems, row by row and without any structure.
fn relaxed(graph: &SpatialGraph) -> Option<Vec<Isometry3<f64>>> {
    let (count, edges) = (graph.poses.len(), graph.measurements.len());
    let mut rows = DMatrix::zeros(3 * edges, 3 * count);
    for (at, edge) in graph.measurements.iter().enumerate() {
        let root = edge.information[(3, 3)].sqrt();
        let turn = edge.measured.rotation.to_rotation_matrix().matrix().transpose();
        rows.view_mut((3 * at, 3 * edge.first), (3, 3)).copy_from(&(-root * turn));
        rows.view_mut((3 * at, 3 * edge.second), (3, 3)).fill_diagonal(root);
    }
    let first = graph.poses[0].rotation.to_rotation_matrix();
    let known = -rows.columns(0, 3) * first.matrix().transpose();
    let found = least(&rows.columns(3, 3 * (count - 1)).into_owned(), &known)?;
    let rotation = |at: usize| nearest(found.fixed_view::<3, 3>(3 * at, 0).transpose());
    let mut rotations = vec![first];
    rotations.extend((0..count - 1).map(rotation).collect::<Option<Vec<_>>>()?);

    let mut rows = DMatrix::zeros(edges, count);
    let mut sides = Sides::zeros(edges);
    for (at, edge) in graph.measurements.iter().enumerate() {
        let root = edge.information[(0, 0)].sqrt();
        (rows[(at, edge.first)], rows[(at, edge.second)]) = (-root, root);
        let shift = root * (rotations[edge.first] * edge.measured.translation.vector);
        sides.row_mut(at).copy_from(&shift.transpose());
    }
    let origin = graph.poses[0].translation.vector;
    let known = &sides - rows.column(0) * origin.transpose();
    let found = least(&rows.columns(1, count - 1).into_owned(), &known)?;
    let place = |at: usize| match at {
        0 => origin,
        _ => Vector3::from_fn(|axis, _| found[(at - 1, axis)]),
    };
    let pose = |(at, rotation): (usize, Rotation3<f64>)| {
        Isometry3::from_parts(place(at).into(), rotation.into())
    };
    Some(rotations.into_iter().enumerate().map(pose).collect())
}

fn chordal_start(formula: Start) -> Comparison {
    let against =
        "two dense least-squares problems, and Newton's iteration to the nearest rotation";
    Comparison::relative(against, 1e-6).over(STATES, 87, |random| {
        let graph = drawn(random);
        (formula(&graph), relaxed(&graph).expect("the first rotation fixes the rest"))
    })
}
