//! What the chapter's theorems assume, and a case for each condition that drops it.

use nalgebra::{DMatrix, DVector, Matrix6, RowVector6, SMatrix, Vector2, Vector3, Vector6};
use vislam::least_squares::Kernel;

use super::oracle::Fit;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Registers the counterexamples.
pub fn counterexamples(chapter: &mut Chapter) {
    chapter.counterexample("least-squares", "independent", one_minimum, [false, true]);
    rate(chapter);
    damping(chapter);
    gauge(chapter);
    reweighting(chapter);
}

/// The minimum of a linear problem, found from two places; the third column of its Jacobian may be the sum of the
/// others.
fn one_minimum(dependent: bool) -> Comparison {
    let mut fit = Fit::random(&mut Random::new(31));
    if dependent {
        let sum = fit.j.column(0) + fit.j.column(1);
        fit.j.set_column(2, &sum);
    }
    let inverse = fit.j.pseudo_inverse(1e-10).expect("the tolerance is positive");
    let start = Vector3::new(1.0, -2.0, 3.0);
    let from_there = start - inverse * (fit.r + fit.j * start);
    let against = Comparison::relative("the minimum found from another start", 1e-9);
    against.once(from_there, -inverse * fit.r)
}

/// Two residuals of one unknown, each with its first two derivatives.
type Bent = fn(f64) -> [[f64; 3]; 2];

fn rate(chapter: &mut Chapter) {
    // The second measurement contradicts the first: its residual is 0.3 at the minimum.
    let kept: Bent =
        |x| [[x, 1.0, 0.0], [0.3 + x * x + x * x * x, 2.0 * x + 3.0 * x * x, 2.0 + 6.0 * x]];
    let rough: Bent = |x| {
        let root = x.abs().sqrt();
        [[x, 1.0, 0.0], [1.0 + x * x * root, 2.5 * x * root, 3.75 * root]]
    };
    let sloped: Bent = |x| [[x + 0.5, 1.0, 0.0], [0.3 + x * x, 2.0 * x, 2.0]];
    let flat: Bent = |x| [[x * x, 2.0 * x, 2.0], [0.0, 0.0, 0.0]];
    for (condition, dropped) in [("smooth", rough), ("stationary", sloped), ("invertible", flat)] {
        chapter.counterexample("gauss-newton-rate", condition, led_astray, [kept, dropped]);
    }
}

/// One Gauss-Newton step from beside zero, compared with the theorem's, in units of the squared distance. What the
/// method neglects over what it keeps counts as zero where both are zero.
fn led_astray(residuals: Bent) -> Comparison {
    let sums = |x: f64| {
        let add = |part: fn(&[f64; 3]) -> f64| residuals(x).iter().map(part).sum::<f64>();
        [add(|r| r[0] * r[1]), add(|r| r[1] * r[1]), add(|r| r[0] * r[2])]
    };
    let [_, kept, neglected] = sums(0.0);
    let rate = if neglected == 0.0 { 0.0 } else { neglected / kept };
    let against = Comparison::absolute("the theorem, over the squared distance", 10.0, "");
    against.each([1e-2, 1e-3, 1e-4], |away| {
        let [gradient, hessian, _] = sums(away);
        ((away - gradient / hessian) / (away * away), -rate / away)
    })
}

/// Two residuals, each of an unknown of its own: x + a and b + c y + y², and the sign of their Jacobian.
#[derive(Clone, Copy)]
struct Pair {
    a: f64,
    b: f64,
    c: f64,
    sign: f64,
}

fn damping(chapter: &mut Chapter) {
    let kept = Pair { a: 1.0, b: 1.0, c: 1.0, sign: 1.0 };
    for (condition, dropped) in [
        ("derivative", Pair { sign: -1.0, ..kept }),
        ("gradient", Pair { a: 0.0, b: 0.0, ..kept }),
        ("diagonal", Pair { c: 0.0, ..kept }),
    ] {
        chapter.counterexample("some-damping-works", condition, strongly_damped, [kept, dropped]);
    }
}

/// The gain of a strongly damped step from zero. No step and no decrease are no gain, and an unknown that the damped
/// equations say nothing about moves by one.
fn strongly_damped(Pair { a, b, c, sign }: Pair) -> Comparison {
    let damping = 1e6;
    let residuals = |step: Vector2<f64>| Vector2::new(step.x + a, b + c * step.y + step.y * step.y);
    let gradient = Vector2::new(sign * a, sign * c * b);
    let diagonal = Vector2::new(1.0, c * c);
    let move_by = |g: f64, d: f64| if d == 0.0 { 1.0 } else { -g / (d * (1.0 + damping)) };
    let step = gradient.zip_map(&diagonal, move_by);
    let predicted = 0.5 * step.dot(&(damping * diagonal.component_mul(&step) - gradient));
    let cost = |step| 0.5 * residuals(step).norm_squared();
    let decrease = cost(Vector2::zeros()) - cost(step);
    let gain = if predicted == 0.0 { 0.0 } else { decrease / predicted };
    Comparison::absolute("one", 1e-4, "").once(gain, 1.0)
}

/// Three points in the plane.
const TRIANGLE: [f64; 6] = [0.0, 0.0, 4.0, 1.0, 1.0, 3.0];

/// The derivatives of the three distances by the six coordinates.
fn distances() -> SMatrix<f64, 3, 6> {
    let rows = [(0, 1), (0, 2), (1, 2)].map(|(one, other)| {
        let point = |i: usize| Vector2::new(TRIANGLE[2 * i], TRIANGLE[2 * i + 1]);
        let direction = (point(other) - point(one)).normalize();
        let mut row = RowVector6::zeros();
        row.fixed_columns_mut::<2>(2 * one).copy_from(&-direction.transpose());
        row.fixed_columns_mut::<2>(2 * other).copy_from(&direction.transpose());
        row
    });
    SMatrix::from_rows(&rows)
}

fn gauge(chapter: &mut Chapter) {
    let points = Vector6::from(TRIANGLE);
    let [ax, ay, bx, by, cx, cy] = TRIANGLE;
    let turned = Vector6::new(-ay, ax, -by, bx, -cy, cx);
    let mirrored = Vector6::new(0.0, -2.0 * ay, 0.0, -2.0 * by, 0.0, -2.0 * cy);
    chapter.counterexample("gauge", "path", null_vector, [turned, mirrored]);
    chapter.counterexample("gauge", "unchanged", null_vector, [turned, points]);

    let length = distances().row(1).transpose();
    let coordinate = Vector6::ith(2, 1.0);
    let kept = (length, 3);
    for (condition, dropped) in [("unchanged", (coordinate, 3)), ("inverse", (length, 4))] {
        chapter.counterexample("gauge-free", condition, same_variance, [kept, dropped]);
    }
}

/// What a motion of the triangle does to its distances, to first order.
fn null_vector(motion: Vector6<f64>) -> Comparison {
    Comparison::absolute("zero", 1e-12, "m").once(distances() * motion, [0.0; 3])
}

/// The variance of a quantity with this gradient and so many of the first coordinates held, and that
/// by the pseudo-inverse.
fn same_variance((quantity, held): (Vector6<f64>, usize)) -> Comparison {
    let hessian: Matrix6<f64> = distances().transpose() * distances();
    // To hold both coordinates of the first point and one of the second is enough.
    let order = [0, 1, 3, 5, 2, 4];
    let free = &order[held..];
    let block = DMatrix::from_fn(free.len(), free.len(), |i, j| hessian[(free[i], free[j])]);
    let gradient = DVector::from_fn(free.len(), |i, _| quantity[free[i]]);
    let solved = block.lu().solve(&gradient).unwrap_or_else(|| f64::NAN * &gradient);
    let inverse = hessian.pseudo_inverse(1e-10).expect("the tolerance is positive");
    let against = Comparison::relative("the variance by the pseudo-inverse", 1e-9);
    against.once(gradient.dot(&solved), quantity.dot(&(inverse * quantity)))
}

/// Readings of one number, what a residual costs and weighs, a start, and which part of the way to the weighted mean
/// is gone.
#[derive(Clone, Copy)]
struct Reweighted {
    readings: [f64; 4],
    cost: fn(f64) -> f64,
    weight: fn(f64) -> f64,
    start: f64,
    part: f64,
}

fn reweighting(chapter: &mut Chapter) {
    let kept = Reweighted {
        readings: [0.0, 0.2, -0.1, 10.0],
        cost: |s| Kernel::Cauchy(2.0).cost(s),
        weight: |s| Kernel::Cauchy(2.0).weight(s),
        start: 0.5,
        part: 1.0,
    };
    let fourth_power = Reweighted {
        readings: [0.0, 0.0, 0.0, 10.0],
        cost: |s| 0.25 * s.powi(4),
        weight: |s| s * s,
        start: 0.0,
        ..kept
    };
    let beyond = Reweighted { part: 3.0, ..kept };
    for (condition, dropped) in [("concave", fourth_power), ("solved", beyond)] {
        chapter.counterexample("reweighting", condition, raised, [kept, dropped]);
    }
}

/// By how much one round of reweighting raises the robust cost.
fn raised(case: Reweighted) -> Comparison {
    let weights = case.readings.map(|reading| (case.weight)((case.start - reading).abs()));
    let sum: f64 =
        weights.iter().zip(case.readings).map(|(weight, reading)| weight * reading).sum();
    let mean = sum / weights.iter().sum::<f64>();
    let end = case.start + case.part * (mean - case.start);
    let cost = |at: f64| -> f64 {
        case.readings.iter().map(|reading| (case.cost)((at - reading).abs())).sum()
    };
    Comparison::absolute("zero", 1e-12, "").once((cost(end) - cost(case.start)).max(0.0), 0.0)
}
