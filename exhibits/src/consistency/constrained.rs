//! Derivatives that are changed as little as can be, and what an old tangent costs.

use nalgebra::{DMatrix, SMatrix, SVector, Vector2, Vector3};
use vislam::consistency::constrained;
use vislam::inertial::NavState;
use vislam::simulation::{Flight, Trajectory};

use super::draws::{self, Eye, SIGMA};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};
use crate::random::Random;

const STATES: usize = 100;
const SIZE: usize = 9;
const ROWS: usize = 5;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Constrained = |h, n, wanted| constrained(h, n, wanted);
    let mutants: [(_, Constrained); 4] = [
        ("Gram matrix dropped", |h, n, wanted| Some(h - (h * n - wanted) * n.transpose())),
        ("sign", |h, n, wanted| constrained(h, n, wanted).map(|freed| 2.0 * h - freed)),
        ("always to zero", |h, n, wanted| constrained(h, n, &(0.0 * wanted))),
        ("one direction after the other", |h, n, wanted| {
            let mut rows = h.clone();
            for at in 0..n.ncols() {
                let along = n.column(at).into_owned();
                let excess = &rows * &along - wanted.column(at);
                rows -= excess * along.transpose() / along.norm_squared();
            }
            Some(rows)
        }),
    ];
    chapter.equation("constrained-jacobian", constrained_jacobian, formula, &mutants);

    let formula: Bent = |second, e, d| second * (0.5 * e - d);
    let mutants: [(_, Bent); 4] = [
        ("sign of the distance", |second, e, d| second * (0.5 * e + d)),
        ("half dropped", |second, e, d| second * (e - d)),
        ("distance halved", |second, e, d| second * (0.5 * e - 0.5 * d)),
        ("latest tangent", |second, e, _| second * (0.5 * e)),
    ];
    chapter.equation("old-tangent", old_tangent, formula, &mutants);
    numbers(chapter);
}

/// A landmark ahead whose depth was wrong when its tangent was taken, and how far a step across the
/// line of sight moves its pixel.
fn numbers(chapter: &mut Chapter) {
    const DEPTH: f64 = 5.0;
    const OFF: f64 = 1.0;
    const ERROR: f64 = 0.05;
    let camera = Flight::brief(Trajectory::hover()).camera;
    let by_side = |depth: f64| {
        let by_point = camera.projection_jacobian(&Vector3::new(0.0, 0.0, depth));
        by_point.map_or(f64::NAN, |by_point| by_point[(0, 0)])
    };
    chapter.number("old_depth", DEPTH, "m", 0);
    chapter.number("old_off", OFF, "m", 0);
    chapter.number("old_error", 100.0 * ERROR, "cm", 0);
    chapter.number("old_focal", camera.fx, "px", 0);
    chapter.number("old_true_px", by_side(DEPTH) * ERROR, "px", 2);
    chapter.number("old_px", by_side(DEPTH + OFF) * ERROR, "px", 2);
}

type Constrained = fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> Option<DMatrix<f64>>;

fn constrained_jacobian(formula: Constrained) -> Comparison {
    let against = "the nearest row on the constraint, row by row, with multipliers";
    Comparison::relative(against, 1e-9).over(STATES, 15, |random| {
        let matrix = |random: &mut Random, rows, columns| {
            DMatrix::from_fn(rows, columns, |_, _| random.normal(1.0))
        };
        let (h, n) = (matrix(random, ROWS, SIZE), matrix(random, SIZE, 4));
        let wanted = matrix(random, ROWS, 4);
        let mut whole = DMatrix::zeros(SIZE + 4, SIZE + 4);
        whole.view_mut((0, 0), (SIZE, SIZE)).fill_with_identity();
        whole.view_mut((0, SIZE), (SIZE, 4)).copy_from(&n);
        whole.view_mut((SIZE, 0), (4, SIZE)).copy_from(&n.transpose());
        let mut right = DMatrix::zeros(SIZE + 4, ROWS);
        right.rows_mut(0, SIZE).copy_from(&h.transpose());
        right.rows_mut(SIZE, 4).copy_from(&wanted.transpose());
        let solved = whole.lu().solve(&right).expect("the constraints are independent");
        (formula(&h, &n, &wanted), Some(solved.rows(0, SIZE).transpose()))
    })
}

/// Position and landmark: six numbers that add.
type Six = SVector<f64, 6>;
/// Takes the second derivative of a residual along the error, 2×6, the error, and the distance from
/// the estimate to where the tangent was taken.
type Bent = fn(&SMatrix<f64, 2, 6>, &Six, &Six) -> Vector2<f64>;

fn old_tangent(formula: Bent) -> Comparison {
    let against = "the pixel at the truth less what the old tangent predicts";
    Comparison::relative(against, 2e-2).over(STATES, 16, |random| {
        let (eye, state) = (Eye::any(random), draws::state(random));
        let landmark = eye.ahead(&state, random);
        let at = |step: &Six| {
            let shift = step.fixed_rows::<3>(0);
            let state = NavState { position: state.position + shift, ..state };
            (state, landmark + step.fixed_rows::<3>(3))
        };
        let pixel = |step: &Six| {
            let (state, landmark) = at(step);
            eye.seen(&state, &landmark) / SIGMA
        };
        let tangent = |step: &Six| {
            let (state, landmark) = at(step);
            let (by_pose, by_landmark) = eye.rows(&state, &landmark);
            let mut rows = SMatrix::<f64, 2, 6>::zeros();
            rows.fixed_columns_mut::<3>(0).copy_from(&by_pose.fixed_columns::<3>(3));
            rows.fixed_columns_mut::<3>(3).copy_from(&by_landmark);
            rows
        };
        let draw = |random: &mut Random| Six::from_fn(|_, _| random.normal(1e-3));
        let (error, distance) = (draw(random), draw(random));
        let second = differences(1e-4, |step: Six| tangent(&step) * error);
        let left = pixel(&error) - pixel(&Six::zeros()) - tangent(&distance) * error;
        (formula(&second, &error, &distance), left)
    })
}
