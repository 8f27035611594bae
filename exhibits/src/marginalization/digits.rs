//! How many digits each form costs.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};
use vislam::marginalization::{
    Information, Layout, OverConfidence, SquareRoot, WindowSigmas, marginalize,
};

use super::STATES;
use super::draws::{blocks, inverse, matrix};
use super::windows::window;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;
use crate::statistics::median;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Bounds); 4] = [
        ("the same condition for both", |rounding, condition| {
            [bounds(rounding, condition)[0], interval(rounding * condition, 1)]
        }),
        ("the root squares its condition", |rounding, condition| {
            [interval(rounding * condition.powi(2), 2), bounds(rounding, condition)[1]]
        }),
        ("the root's variance changes as a length does", |rounding, condition| {
            [interval(rounding * condition, 1), bounds(rounding, condition)[1]]
        }),
        ("rounding does not grow with the condition", |rounding, _| {
            [interval(rounding, 2), interval(rounding, 1)]
        }),
    ];
    chapter.equation("digits-lost", digits_lost, bounds, &mutants);

    let kept = Rounded { rounding: 2e-7, change: |root| single(root, |r| Some(r.qr().r())) };
    let squared: Change =
        |root| single(root, |r| Some(r.tr_mul(&r).cholesky()?.unpack().transpose()));
    for (condition, dropped) in [
        ("relative", Rounded { change: squared, ..kept }),
        ("small", Rounded { rounding: 1.5 / CONDITION, change: weakest_lost }),
    ] {
        chapter.counterexample("prior-digits", condition, within, [kept, dropped]);
    }
}

type Bounds = fn(f64, f64) -> [[f64; 2]; 2];

/// Between which multiples of itself a variance is found, from a root and from an information matrix.
pub fn bounds(rounding: f64, condition: f64) -> [[f64; 2]; 2] {
    [interval(rounding * condition, 2), interval(rounding * condition.powi(2), 1)]
}

fn interval(change: f64, power: i32) -> [f64; 2] {
    [(1.0 + change).powi(-power), (1.0 - change).powi(-power)]
}

/// A tall matrix with this condition number, and the singular vectors of its least singular value; the largest one
/// is one.
fn tall(random: &mut Random, condition: f64) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
    let (rows, columns) = (12, 5);
    let axes = matrix(random, rows, columns).qr().q();
    let turn = matrix(random, columns, columns).qr().q();
    let size = |at: usize| condition.powf(-(at as f64) / (columns - 1) as f64);
    let sizes = DMatrix::from_diagonal(&DVector::from_fn(columns, |at, _| size(at)));
    let (left, right) = (axes.column(columns - 1).into(), turn.column(columns - 1).into());
    (&axes * sizes * turn.transpose(), left, right)
}

fn digits_lost(formula: Bounds) -> Comparison {
    let against = "the variance of the weakest quantity after the worst change, by inversion";
    Comparison::relative(against, 1e-6).over(STATES, 43, |random| {
        let condition = random.uniform(3.0..30.0);
        let rounding = random.uniform(0.05..0.6) / condition.powi(2);
        let (root, u, v) = tall(random, condition);
        let information = root.tr_mul(&root);
        let variance = |matrix: &DMatrix<f64>| v.dot(&(inverse(matrix) * &v));
        let truth = variance(&information);
        let changed = [rounding, -rounding].map(|change| {
            let root = &root + change * &u * v.transpose();
            let matrix = &information + change * &v * v.transpose();
            [variance(&root.tr_mul(&root)) / truth, variance(&matrix) / truth]
        });
        let found = [[changed[0][0], changed[1][0]], [changed[0][1], changed[1][1]]];
        (formula(rounding, condition).concat(), found.concat())
    })
}

/// The condition of the theorem's cases.
const CONDITION: f64 = 2e3;

type Change = fn(&DMatrix<f64>) -> DMatrix<f64>;

#[derive(Clone, Copy)]
struct Rounded {
    rounding: f64,
    change: Change,
}

/// What single precision makes of a matrix.
fn single(root: &DMatrix<f64>, of: impl Fn(DMatrix<f32>) -> Option<DMatrix<f32>>) -> DMatrix<f64> {
    let changed = of(root.map(|number| number as f32));
    changed.map_or_else(|| DMatrix::zeros(5, 5), |changed| changed.map(f64::from))
}

/// A change along the least singular value, by a hundredth less than that.
fn weakest_lost(root: &DMatrix<f64>) -> DMatrix<f64> {
    let parts = root.clone().svd(true, true);
    let (Some(u), Some(v_t)) = (parts.u, parts.v_t) else { return root.clone() };
    let least = parts.singular_values.imin();
    root - 0.99 * parts.singular_values[least] * u.column(least) * v_t.row(least)
}

/// By how much variances are outside of the theorem's bounds.
fn within(case: Rounded) -> Comparison {
    let (root, ..) = tall(&mut Random::new(44), CONDITION);
    let zero = DVector::zeros(5);
    let gaussian = |root: &DMatrix<f64>| {
        Information::new(blocks(&[5]), root.tr_mul(root), zero.clone()).expect("symmetric")
    };
    let ratios = OverConfidence::of(&gaussian(&root), &gaussian(&(case.change)(&root)));
    let ratios = ratios.expect("the truth is determined");
    let [low, high] = bounds(case.rounding, CONDITION)[0];
    let outside = (ratios.smallest().recip() - high).max(low - ratios.largest().recip());
    Comparison::absolute("zero", 1e-6, "of the variance").once(outside.max(0.0), 0.0)
}

/// How well the first keyframe of a window is known, in metres and radians.
pub const SIGMAS: [f64; 8] = [0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
pub const SEEDS: u64 = 9;

/// What the two forms make of windows of a condition in single precision.
pub struct Digits {
    /// The median condition number of the root, its columns scaled to one.
    pub condition: f64,
    /// The median of the largest relative error of any variance, from the Hessian and from the root; nothing when
    /// most of them were no Gaussian.
    pub errors: [Option<f64>; 2],
    /// How many of the windows had a Gaussian, by form.
    pub gaussians: [usize; 2],
}

pub fn all() -> &'static [Digits] {
    static ALL: OnceLock<Vec<Digits>> = OnceLock::new();
    ALL.get_or_init(|| SIGMAS.map(digits).into())
}

fn digits(first_keyframe: f64) -> Digits {
    let layout = Layout::eight_keyframes();
    let sigmas = WindowSigmas { first_keyframe, ..WindowSigmas::default() };
    let (mut conditions, mut errors) = (Vec::new(), [Vec::new(), Vec::new()]);
    for seed in 0..SEEDS {
        let window = window(&layout, &sigmas, seed);
        conditions.push(condition(window.root()));
        let found = single_precision(&window, &layout.slide(0));
        errors.iter_mut().zip(found).for_each(|(errors, found)| errors.push(found));
    }
    let gaussians = errors.each_ref().map(|errors| errors.iter().filter(|e| e.is_finite()).count());
    let errors = errors.map(|errors| Some(median(errors)).filter(|error| error.is_finite()));
    Digits { condition: median(conditions), errors, gaussians }
}

fn condition(root: &DMatrix<f64>) -> f64 {
    let mut scaled = root.clone();
    scaled.column_iter_mut().for_each(|mut column| {
        column.normalize_mut();
    });
    let singular = scaled.singular_values();
    singular.max() / singular.min()
}

/// The largest relative error of a variance of the survivors, from the Hessian and from the root; infinite where
/// there is no Gaussian.
fn single_precision(window: &SquareRoot<f64>, gone: &[usize]) -> [f64; 2] {
    let truth = window.marginalize(gone).expect("it is determined");
    let single = window.cast::<f32>();
    let root = single.marginalize(gone).ok().map(|left| left.cast::<f64>());
    let hessian = marginalize(&single.information(), gone).ok().map(|left| left.cast::<f64>());
    let root = root.map(|left| left.root().clone());
    let hessian = hessian.and_then(|left| Some(left.matrix().clone().cholesky()?.l().transpose()));
    [hessian, root].map(|found| found.map_or(f64::INFINITY, |found| worst(truth.root(), &found)))
}

/// The largest relative error of a variance, out of two triangular roots.
fn worst(truth: &DMatrix<f64>, found: &DMatrix<f64>) -> f64 {
    // Variances are found over true ones where R_true / R_found has its squared singular values.
    let identity = DMatrix::identity(found.ncols(), found.ncols());
    let Some(inverse) = found.solve_upper_triangular(&identity) else { return f64::INFINITY };
    let ratios = (truth * inverse).singular_values();
    ratios.iter().map(|ratio| (ratio * ratio - 1.0).abs()).fold(0.0, f64::max)
}

/// Digits lost for each of the condition, between two of the sigmas.
pub fn lost(form: usize, [well, badly]: [usize; 2]) -> f64 {
    let at = |index: usize| &all()[index];
    let error = |index: usize| at(index).errors[form].unwrap_or(f64::NAN);
    (error(badly) / error(well)).ln() / (at(badly).condition / at(well).condition).ln()
}
