//! When a matrix is essential, and how many of them five points leave.

use nalgebra::{Complex, Isometry3, Matrix3, SMatrix, SVector, Vector3};
use vislam::least_squares::Manifold;
use vislam::manifold::so3;
use vislam::robust_two_view::{
    FivePointError, RayPair, RelativeMotion, five_points, motions_of_five,
};
use vislam::two_views::{epipolar_residual, essential_matrix};

use super::STATES;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};
use crate::random::Random;
use crate::record::{RecordValue, accepted};

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Cubics); 5] = [
        ("trace not halved", |e| cubics(e, 1.0, |e| e * e.transpose() * e)),
        ("trace doubled", |e| cubics(e, 4.0, |e| 2.0 * e * e.transpose() * e)),
        ("sign of the trace", |e| cubics(e, -1.0, |e| 2.0 * e * e.transpose() * e)),
        ("cube of the matrix", |e| cubics(e, 1.0, |e| 2.0 * e * e * e)),
        ("transposes exchanged", |e| cubics(e, 1.0, |e| 2.0 * e.transpose() * e * e)),
    ];
    let formula: Cubics = |e| cubics(e, 1.0, |e| 2.0 * e * e.transpose() * e);
    chapter.equation("essential-cubics", essential_cubics, formula, &mutants);
    counterexamples(chapter);
    numbers(chapter);
}

/// The norm of the nine entries, and the size of the determinant.
type Cubics = fn(&Matrix3<f64>) -> [f64; 2];

fn cubics(e: &Matrix3<f64>, times: f64, product: fn(&Matrix3<f64>) -> Matrix3<f64>) -> [f64; 2] {
    let trace = (e * e.transpose()).trace();
    [(product(e) - times * trace * e).norm(), e.determinant().abs()]
}

fn essential_cubics(formula: Cubics) -> Comparison {
    let against = "zero for essential matrices, and products of singular values for others";
    Comparison::absolute(against, 1e-12, "entries").each(0..STATES as u64, |state| {
        let mut random = Random::new(100 + state);
        let turn = random.rotation(3.0).into_inner();
        if state % 2 == 0 {
            return (formula(&(so3::hat(&random.direction(1.0)) * turn)), [0.0; 2]);
        }
        // U diag(s) Vᵀ: every term of the cubic forms is one in the singular values.
        let values = Vector3::from_fn(|_, _| random.uniform(0.1..1.0));
        let matrix = turn * Matrix3::from_diagonal(&values) * random.rotation(3.0).into_inner();
        let sum = values.norm_squared();
        let nine = values.map(|s| s * (2.0 * s * s - sum)).norm();
        (formula(&matrix), [nine, values.product()])
    })
}

fn counterexamples(chapter: &mut Chapter) {
    let essential = so3::hat(&Vector3::new(0.6, 0.0, 0.8)).map(Complex::from);
    let isotropic = Vector3::new(Complex::from(1.0), Complex::i(), Complex::from(0.0));
    let complex = isotropic * isotropic.transpose() * Complex::from(0.5);
    let cases = |dropped| [essential, dropped];
    chapter.counterexample("essential-cubics", "real", is_essential, cases(complex));
    chapter.counterexample("essential-cubics", "not-zero", is_essential, cases(Matrix3::zeros()));
    chapter.counterexample("ten-matrices", "eliminated", ten_at_most, [true, false]);
}

/// Singular values of a matrix that satisfies all ten equations, beside those of an essential one.
fn is_essential(matrix: Matrix3<Complex<f64>>) -> Comparison {
    let gram = matrix * matrix.transpose();
    let cubic = gram * matrix * Complex::from(2.0) - matrix * gram.trace();
    assert!(cubic.norm() < 1e-12 && matrix.determinant().norm() < 1e-12, "it satisfies them");
    let mut squares: Vec<f64> =
        (matrix * matrix.adjoint()).symmetric_eigenvalues().iter().copied().collect();
    squares.sort_by(f64::total_cmp);
    Comparison::absolute("two singular values of one, and a zero", 1e-12, "squares")
        .once(squares, vec![0.0, 1.0, 1.0])
}

/// How many different essential matrices satisfy the equations of five points, for a camera that moved or one that only
/// turned.
fn ten_at_most(moved: bool) -> Comparison {
    let mut random = Random::new(3);
    let truth = motion(&mut random);
    let pairs = five(&mut random, &truth);
    let matrices: Vec<Matrix3<f64>> = if moved {
        five_points(&pairs).expect("five points in general position").to_vec()
    } else {
        let rotation = truth.rotation.to_rotation_matrix();
        (0..30).map(|_| so3::hat(&random.direction(1.0)) * rotation.matrix()).collect()
    };
    let pairs = if moved { pairs } else { pairs.map(|(ray, _)| (ray, truth.rotation * ray)) };
    let fits = |e: &&Matrix3<f64>| {
        pairs.iter().all(|(first, second)| epipolar_residual(e, first, second).abs() < 1e-9)
    };
    let count = matrices.iter().filter(fits).count() as f64;
    Comparison::absolute("ten", 0.1, "matrices").once(count.max(10.0), 10.0)
}

/// A turn, and a baseline of one.
fn motion(random: &mut Random) -> Isometry3<f64> {
    Isometry3::from_parts(random.direction(1.0).into(), random.rotation(0.8).into())
}

/// The directions of five points in front of both cameras.
fn five(random: &mut Random, second_from_first: &Isometry3<f64>) -> [RayPair; 5] {
    std::array::from_fn(|_| {
        loop {
            let point = random.point(2.0..10.0);
            let second = second_from_first.rotation * point + second_from_first.translation.vector;
            if second.z > 0.5 {
                break (point.normalize(), second.normalize());
            }
        }
    })
}

/// The condition number of the five equations, by differences over the five numbers of a motion.
fn condition(motion: &RelativeMotion, pairs: &[RayPair; 5]) -> f64 {
    let slopes: SMatrix<f64, 5, 5> = differences(1e-5, |step: SVector<f64, 5>| {
        let essential = motion.retract(step.as_slice()).essential();
        SVector::from(pairs.map(|(first, second)| epipolar_residual(&essential, &first, &second)))
    });
    let squares = slopes.tr_mul(&slopes).symmetric_eigenvalues();
    (squares.max() / squares.min().max(0.0)).sqrt()
}

/// How far two matrices are from each other, of length one and up to sign.
fn distance(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    let (a, b) = (a.normalize(), b.normalize());
    (a - b).amax().min((a + b).amax())
}

/// What came of many scenes.
#[derive(Default)]
struct Tally {
    well_posed: usize,
    /// The largest distance from the true matrix to the nearest one found, where the equations are well posed.
    worst: f64,
    solutions: Vec<usize>,
    in_front: Vec<usize>,
}

/// A condition number up to which the equations count as well posed.
const WELL_POSED: f64 = 1e6;

fn tally(scenes: usize, seed: u64) -> Tally {
    let (mut random, mut tally) = (Random::new(seed), Tally::default());
    for _ in 0..scenes {
        let truth = motion(&mut random);
        let pairs = five(&mut random, &truth);
        let found = five_points(&pairs).expect("points in general position");
        tally.solutions.push(found.len());
        tally.in_front.push(motions_of_five(&pairs).map_or(0, |motions| motions.len()));
        let motion = RelativeMotion::of(&truth).expect("it moved");
        if condition(&motion, &pairs) < WELL_POSED {
            tally.well_posed += 1;
            let essential = essential_matrix(&truth);
            let nearest = found.iter().map(|e| distance(e, &essential)).fold(1.0, f64::min);
            tally.worst = tally.worst.max(nearest);
        }
    }
    tally
}

fn mean(counts: &[usize]) -> f64 {
    counts.iter().sum::<usize>() as f64 / counts.len() as f64
}

/// How many scenes the record has.
const MANY: usize = 10_000;
const RECORD: &str = "five_point_scenes";

pub fn record(chapter: &mut Chapter) {
    let inputs =
        vec![("scenes", MANY.to_string()), ("well posed", format!("below {WELL_POSED:e}"))];
    chapter.record(RECORD, inputs, || {
        let tally = tally(MANY, 1);
        let most = tally.solutions.iter().max().copied().unwrap_or(0);
        let ten = tally.solutions.iter().filter(|count| **count == 10).count();
        let alone = tally.in_front.iter().filter(|count| **count == 1).count();
        let count = |name, count: usize| RecordValue::new(name, count as f64, "", 0, 0.01);
        vec![
            count("scenes", MANY),
            count("well_posed", tally.well_posed),
            RecordValue::new("worst_exponent", tally.worst.log10(), "", 1, 0.2),
            RecordValue::new("solutions", mean(&tally.solutions), "", 1, 0.01),
            count("most_solutions", most),
            RecordValue::new("ten_solutions", ten as f64, "", 0, 1.0),
            RecordValue::new("in_front", mean(&tally.in_front), "", 1, 0.01),
            count("alone", alone),
        ]
    });
}

fn numbers(chapter: &mut Chapter) {
    // The live check of the same thing.
    let few = tally(200, 2);
    chapter.number("few_scenes", few.solutions.len() as f64, "", 0);
    chapter.number("few_worst_exponent", few.worst.log10().ceil(), "", 0);
    chapter.number("alone_percent", 100.0 * accepted(RECORD, "alone") / MANY as f64, "%", 0);

    // Five points of a wall.
    let mut random = Random::new(4);
    let truth = motion(&mut random);
    let on_wall: [RayPair; 5] = std::array::from_fn(|_| {
        let ray = random.point(1.0..2.0);
        let point = ray * (4.0 / Vector3::new(0.2, 0.1, 1.0).dot(&ray));
        (ray.normalize(), (truth.rotation * point + truth.translation.vector).normalize())
    });
    let found = five_points(&on_wall).expect("a wall is no obstacle");
    chapter.number("wall_solutions", found.len() as f64, "", 0);
    let turned = on_wall.map(|(ray, _)| (ray, truth.rotation * ray));
    assert_eq!(five_points(&turned), Err(FivePointError::PureRotation));
}
