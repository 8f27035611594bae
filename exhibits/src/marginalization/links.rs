//! Dropping links: who is sure of what afterwards.

use nalgebra::DMatrix;
use vislam::marginalization::{
    Information, OverConfidence, divergence, keep_marginals, marginalize, sparsify, zero_link,
};

use super::STATES;
use super::draws::{columns, gaussian, inverse, part, put, scalars};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Slope = |s, [i, a, b], link| 2.0 * link * s[(i, a)] * s[(i, b)];
    let mutants: [(_, Slope); 4] = [
        ("the other sign", |s, [i, a, b], link| -2.0 * link * s[(i, a)] * s[(i, b)]),
        ("one of the two places", |s, [i, a, b], link| link * s[(i, a)] * s[(i, b)]),
        ("the covariance of the two", |s, [i, a, b], link| 2.0 * link * s[(a, b)] * s[(i, i)]),
        ("squares of the covariance", |s, [i, a, _], link| 2.0 * link * s[(i, a)].powi(2)),
    ];
    chapter.equation("link-slope", link_slope, formula, &mutants);

    let mutants: [(_, Cut); 3] = [
        ("the link is zeroed", |window, a, b| Some(zero_link(window, a, b).ok()?.matrix().clone())),
        ("nothing taken off twice", |window, a, b| with_both(window, a, b, 0.0)),
        ("taken off twice", |window, a, b| with_both(window, a, b, 2.0)),
    ];
    let formula: Cut = |window, a, b| Some(keep_marginals(window, a, b).ok()?.matrix().clone());
    chapter.equation("kept-marginals", kept_marginals, formula, &mutants);

    let mutants: [(_, Cut); 3] = [
        ("the link is zeroed", |window, a, b| Some(zero_link(window, a, b).ok()?.matrix().clone())),
        ("marginals kept", |window, a, b| {
            Some(keep_marginals(window, a, b).ok()?.matrix().clone())
        }),
        ("other landmarks not held", unheld),
    ];
    let formula: Cut = |window, a, b| Some(sparsify(window, a, &[b]).ok()?.matrix().clone());
    chapter.equation("filter-sparsification", filter_sparsification, formula, &mutants);

    let formula: Nats = |p, q| divergence(p, q).unwrap_or(f64::NAN);
    let mutants: [(_, Nats); 4] = [
        ("the two exchanged", |p, q| divergence(q, p).unwrap_or(f64::NAN)),
        ("means forgotten", |p, q| nats(p, q, [1.0, 1.0, 0.0])),
        ("the dimension not taken off", |p, q| nats(p, q, [0.0, 1.0, 1.0])),
        ("determinants the other way", |p, q| nats(p, q, [1.0, -1.0, 1.0])),
    ];
    chapter.equation("gaussian-divergence", gaussian_divergence, formula, &mutants);

    let kept = [[2.0, -0.7, -0.3], [-0.7, 1.5, -0.6], [-0.3, -0.6, 1.8]];
    chapter.counterexample("link-signs", "no-positive", grown, [kept, COUNTEREXAMPLE]);
    chapter.counterexample("link-balance", "nothing-else", balance, [0.0, 1.5]);
}

/// Every two of three numbers coupled with the same sign.
pub const COUNTEREXAMPLE: [[f64; 3]; 3] = [[1.0, 0.5, 0.6], [0.5, 1.0, 0.6], [0.6, 0.6, 1.0]];

pub fn of_rows(rows: [[f64; 3]; 3]) -> Information<f64> {
    scalars(DMatrix::from_row_slice(3, 3, rows.as_flattened()))
}

/// By how much any variance grows when the first link is zeroed.
fn grown(rows: [[f64; 3]; 3]) -> Comparison {
    let truth = of_rows(rows);
    let without = zero_link(&truth, 0, 1).expect("a Gaussian").covariance().expect("a Gaussian");
    let truth = truth.covariance().expect("a Gaussian");
    let grown = (0..3).map(|at| without[(at, at)] - truth[(at, at)]).fold(0.0, f64::max);
    Comparison::absolute("zero", 1e-9, "").once(grown, 0.0)
}

/// In how many directions the report without a link is over-confident and too modest, when as many times the link's
/// size is taken off the diagonals of its ends.
fn balance(taken: f64) -> Comparison {
    let truth = of_rows([[2.0, 0.3, 0.4], [0.3, 2.0, -0.5], [0.4, -0.5, 2.0]]);
    let mut matrix = truth.matrix().clone();
    let link = matrix[(0, 1)];
    matrix[(0, 1)] = 0.0;
    matrix[(1, 0)] = 0.0;
    for end in 0..2 {
        matrix[(end, end)] -= taken * link.abs();
    }
    let ratios = OverConfidence::of(&truth, &scalars(matrix)).expect("a Gaussian").ratios;
    let above = ratios.iter().filter(|ratio| **ratio > 1.0 + 1e-9).count() as f64;
    let below = ratios.iter().filter(|ratio| **ratio < 1.0 - 1e-9).count() as f64;
    Comparison::absolute("one and one", 0.1, "directions").once([above, below], [1.0, 1.0])
}

type Slope = fn(&DMatrix<f64>, [usize; 3], f64) -> f64;

fn link_slope(formula: Slope) -> Comparison {
    let against = "central differences of the inverse";
    Comparison::relative(against, 1e-5).over(STATES, 51, |random| {
        let truth = gaussian(random, &[1; 5]).matrix() / 5.0;
        let link = truth[(1, 3)];
        let variances = |part: f64| {
            let mut matrix = truth.clone();
            matrix[(1, 3)] -= part * link;
            matrix[(3, 1)] -= part * link;
            inverse(&matrix).diagonal()
        };
        let step = 1e-6;
        let slopes = (variances(step) - variances(-step)) / (2.0 * step);
        let covariance = inverse(&truth);
        let found: Vec<f64> = (0..5).map(|i| formula(&covariance, [i, 1, 3], link)).collect();
        (found, slopes)
    })
}

/// An information matrix without the link of two blocks.
type Cut = fn(&Information<f64>, usize, usize) -> Option<DMatrix<f64>>;

const DIMENSIONS: [usize; 4] = [2, 1, 3, 2];

/// The marginals without either added, and a multiple of that without both taken off.
fn with_both(window: &Information<f64>, a: usize, b: usize, off: f64) -> Option<DMatrix<f64>> {
    let mut sum = DMatrix::zeros(window.matrix().nrows(), window.matrix().nrows());
    for (gone, factor) in [(vec![a], 1.0), (vec![b], 1.0), (vec![a, b], -off)] {
        let left = marginalize(window, &gone).ok()?;
        let own = columns(window, &left.blocks().names().collect::<Vec<_>>());
        let mut whole = DMatrix::zeros(sum.nrows(), sum.nrows());
        put(&mut whole, &own, &own, left.matrix());
        sum += factor * whole;
    }
    Some(sum)
}

fn kept_marginals(formula: Cut) -> Comparison {
    let against = "the inverse of a covariance in which the two are independent given the rest";
    Comparison::relative(against, 1e-6).over(STATES, 52, |random| {
        let window = gaussian(random, &DIMENSIONS);
        let mut covariance = inverse(window.matrix());
        let (a, b, rest) =
            (columns(&window, &[0]), columns(&window, &[2]), columns(&window, &[1, 3]));
        let of_rest = inverse(&part(&covariance, &rest, &rest));
        let between = part(&covariance, &a, &rest) * of_rest * part(&covariance, &rest, &b);
        put(&mut covariance, &a, &b, &between);
        put(&mut covariance, &b, &a, &between.transpose());
        (formula(&window, 0, 2), inverse(&covariance))
    })
}

/// A block that is linked with two others only, so that the fourth one is not its neighbour.
fn sparse(random: &mut crate::random::Random) -> Information<f64> {
    let full = gaussian(random, &DIMENSIONS);
    let (robot, far) = (columns(&full, &[0]), columns(&full, &[3]));
    let mut matrix = full.matrix() + 3.0 * DMatrix::identity(8, 8);
    put(&mut matrix, &robot, &far, &DMatrix::zeros(robot.len(), far.len()));
    put(&mut matrix, &far, &robot, &DMatrix::zeros(far.len(), robot.len()));
    Information::new(full.blocks().clone(), matrix, full.vector().clone()).expect("symmetric")
}

/// p(x | Y⁺) p(Y): the passive landmarks are not held but marginalized.
fn unheld(window: &Information<f64>, robot: usize, cut: usize) -> Option<DMatrix<f64>> {
    Some(robot_given(window, robot, cut, &marginalize(window, &[3, cut]).ok()?))
}

/// The information matrix of p(x | Y⁺) p(Y), in which the first part is taken out of a Gaussian over x and Y⁺.
fn robot_given(
    window: &Information<f64>,
    robot: usize,
    cut: usize,
    near: &Information<f64>,
) -> DMatrix<f64> {
    let kept: Vec<usize> = near.blocks().names().filter(|name| *name != robot).collect();
    let others: Vec<usize> = window.blocks().names().filter(|name| *name != robot).collect();
    debug_assert!(!kept.contains(&cut));
    let local = inverse(near.matrix());
    let (x, y) = (columns(near, &[robot]), columns(near, &kept));
    let gain = part(&local, &x, &y) * inverse(&part(&local, &y, &y));
    let noise = part(&local, &x, &x) - &gain * part(&local, &y, &x);
    let mut covariance = inverse(window.matrix());
    let (robot, kept) = (columns(window, &[robot]), columns(window, &kept));
    let others = columns(window, &others);
    let across = &gain * part(&covariance, &kept, &others);
    let own = noise + &gain * part(&covariance, &kept, &kept) * gain.transpose();
    put(&mut covariance, &robot, &others, &across);
    put(&mut covariance, &others, &robot, &across.transpose());
    put(&mut covariance, &robot, &robot, &own);
    inverse(&covariance)
}

fn filter_sparsification(formula: Cut) -> Comparison {
    let against =
        "the inverse of a covariance made of the robot's regression on what it stays linked with";
    Comparison::relative(against, 1e-6).over(STATES, 53, |random| {
        let window = sparse(random);
        let near = window.select(&[0, 1, 2]).and_then(|near| marginalize(&near, &[2]));
        let near = near.expect("it is positive");
        (formula(&window, 0, 2), robot_given(&window, 0, 2, &near))
    })
}

type Nats = fn(&Information<f64>, &Information<f64>) -> f64;

/// The divergence with factors of the dimension, the determinants and the means.
fn nats(p: &Information<f64>, q: &Information<f64>, [count, size, means]: [f64; 3]) -> f64 {
    let covariance = inverse(p.matrix());
    let moved = inverse(q.matrix()) * q.vector() - &covariance * p.vector();
    let spread = (q.matrix() * &covariance).trace() - count * p.vector().len() as f64;
    let sizes = (p.matrix().determinant() / q.matrix().determinant()).ln();
    0.5 * (spread + size * sizes + means * moved.dot(&(q.matrix() * &moved)))
}

fn gaussian_divergence(formula: Nats) -> Comparison {
    let against = "the integral, as a sum over a grid";
    Comparison::absolute(against, 1e-5, "nats").over(20, 54, |random| {
        let [p, q] = [0, 1].map(|_| gaussian(random, &[1, 1]));
        let root = p.matrix().clone().cholesky().expect("positive").l();
        let mean = p.mean().expect("it is determined");
        let density = |of: &Information<f64>| {
            let mean = of.mean().expect("it is determined");
            let size = 0.5 * of.matrix().determinant().ln() - std::f64::consts::TAU.ln();
            let matrix = of.matrix().clone();
            move |x: &nalgebra::DVector<f64>| {
                let off = x - &mean;
                size - 0.5 * off.dot(&(&matrix * &off))
            }
        };
        let (of_p, of_q) = (density(&p), density(&q));
        let step = 0.1;
        let places = (-70..=70).map(|k| step * f64::from(k));
        let mut sum = 0.0;
        for (u, v) in places.clone().flat_map(|u| places.clone().map(move |v| (u, v))) {
            // In these coordinates p is a standard normal density.
            let at = nalgebra::DVector::from_vec(vec![u, v]);
            let x = &mean + root.tr_solve_lower_triangular(&at).expect("a triangle");
            let weight = (-0.5 * (u * u + v * v)).exp() / std::f64::consts::TAU;
            sum += step * step * weight * (of_p(&x) - of_q(&x));
        }
        (formula(&p, &q), sum)
    })
}
