//! Digits that a covariance loses, and how many of them its root keeps.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};
use vislam::filtering::{Form, correct, correct_root};

use super::draws;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

const CASES: usize = 60;
const DIMENSION: usize = 5;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Bounds); 4] = [
        ("condition for its root", |condition, error| {
            [2.0 * error * condition + (error * condition).powi(2), error * condition]
        }),
        ("second order dropped", |condition, error| {
            [2.0 * error * condition.sqrt(), error * condition]
        }),
        ("fourth root", |condition, error| [bounds(condition.sqrt(), error)[0], error * condition]),
        ("root of the condition for both", |condition, error| {
            [bounds(condition, error)[0], error * condition.sqrt()]
        }),
    ];
    chapter.equation("root-digits", root_digits, bounds, &mutants);
    chapter.counterexample("root-digits", "of-the-root", within_bound, [true, false]);
}

/// A root with a given condition of its square, as U = A diag Bᵀ.
struct Root {
    left: DMatrix<f64>,
    values: DVector<f64>,
    right: DMatrix<f64>,
}

impl Root {
    fn random(random: &mut Random, condition: f64) -> Self {
        let [left, right] = [(); 2].map(|()| draws::matrix(random, DIMENSION, DIMENSION).qr().q());
        let values = DVector::from_fn(DIMENSION, |at, _| match at {
            0 => 1.0,
            1 => condition.sqrt().recip(),
            _ => {
                random.uniform(0.0..1.0) * (1.0 - condition.sqrt().recip())
                    + condition.sqrt().recip()
            }
        });
        Self { left, values, right }
    }

    fn matrix(&self) -> DMatrix<f64> {
        &self.left * DMatrix::from_diagonal(&self.values) * self.right.transpose()
    }
}

fn smallest(covariance: &DMatrix<f64>) -> f64 {
    covariance.symmetric_eigenvalues().min()
}

type Bounds = fn(f64, f64) -> [f64; 2];

/// By which part of itself the smallest eigenvalue moves at most, by an error of the root and by one
/// of the matrix.
fn bounds(condition: f64, error: f64) -> [f64; 2] {
    [2.0 * error * condition.sqrt() + error * error * condition, error * condition]
}

/// The error that does most harm lies along the weakest direction.
fn root_digits(formula: Bounds) -> Comparison {
    let against =
        "the smallest eigenvalue when the worst error is added to the root, or to the matrix";
    Comparison::relative(against, 1e-5).over(CASES, 41, |random| {
        let condition = random.logarithmic(1e1..1e5);
        let error = random.logarithmic(1e-3..1e-1);
        let root = Root::random(random, condition);
        let (left, right) = (root.left.column(1), root.right.column(1));
        let before = root.values[1].powi(2);
        // The direction is no longer the weakest when the error is large.
        let part = |spoilt: DMatrix<f64>| right.dot(&(spoilt * right)) / before - 1.0;
        let upper = root.matrix();
        let spoilt = &upper + error * left * right.transpose();
        let of_root = part(spoilt.tr_mul(&spoilt));
        let of_matrix = part(upper.tr_mul(&upper) + error * right * right.transpose());
        (formula(condition, error), [of_root, of_matrix])
    })
}

/// By how much the smallest eigenvalue leaves the bound when an error is one of the root, or one of
/// the covariance.
fn within_bound(of_root: bool) -> Comparison {
    let (condition, error) = (1e6_f64, 1e-4);
    let [bound, _] = bounds(condition, error);
    let against = Comparison::absolute("zero", 1e-6, "of the eigenvalue");
    against.over(20, 42, |random| {
        let root = Root::random(random, condition);
        let wrong = draws::matrix(random, DIMENSION, DIMENSION);
        let norm = wrong.tr_mul(&wrong).symmetric_eigenvalues().max().sqrt();
        let (wrong, upper) = (error / norm * wrong, root.matrix());
        let spoilt = match of_root {
            true => (&upper + &wrong).tr_mul(&(&upper + &wrong)),
            false => upper.tr_mul(&upper) + 0.5 * (&wrong + wrong.transpose()),
        };
        let off = (smallest(&spoilt) / root.values[1].powi(2) - 1.0).abs();
        ((off - bound).max(0.0), 0.0)
    })
}

/// Half the distance from one to the next number in single precision.
pub const ROUNDING: f64 = 0.5 * f32::EPSILON as f64;
/// Conditions of the covariance after the measurement.
pub const CONDITIONS: [f64; 9] = [1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10];
pub const DRAWS: usize = 100;

/// What three forms make of a measurement in single precision: the difference, Joseph's form, and the
/// root.
pub struct Lost {
    /// The median relative error of the smallest variance.
    pub error: [f64; 3],
    /// In how many of the draws it is below zero.
    pub below_zero: [usize; 3],
}

/// For each condition.
pub fn lost() -> &'static [Lost; 9] {
    static LOST: OnceLock<[Lost; 9]> = OnceLock::new();
    LOST.get_or_init(|| {
        CONDITIONS.map(|condition| {
            let mut random = Random::new(43);
            let draws: Vec<[f64; 3]> =
                (0..DRAWS).map(|_| measured_once(&mut random, condition)).collect();
            let of = |form: usize| draws.iter().map(move |draw| draw[form]);
            let error = [0, 1, 2].map(|form| {
                let mut off: Vec<f64> = of(form).map(|part| part.abs().max(1e-9)).collect();
                off.sort_by(f64::total_cmp);
                off[DRAWS / 2]
            });
            let below_zero = [0, 1, 2].map(|form| of(form).filter(|part| *part < -1.0).count());
            Lost { error, below_zero }
        })
    })
}

/// By which part of itself the smallest variance is off after two sharp measurements of four numbers
/// whose variance is one.
fn measured_once(random: &mut Random, condition: f64) -> [f64; 3] {
    let across = draws::matrix(random, 4, 4).qr().q().rows(0, 2).into_owned();
    let jacobian = (condition.sqrt() * across).map(|entry| entry as f32);
    let exact = jacobian.map(f64::from);
    let sharpest = (&exact * exact.transpose()).symmetric_eigenvalues().max();
    let expected = (1.0 + sharpest).recip();
    let residual = DVector::<f32>::zeros(2);
    let of = |covariance: DMatrix<f32>| smallest(&covariance.map(f64::from));
    let [difference, joseph] = [Form::Difference, Form::Joseph].map(|form| {
        let mut covariance = DMatrix::<f32>::identity(4, 4);
        correct(&mut covariance, &jacobian, &residual, form).expect("the prior is a covariance");
        of(covariance)
    });
    let mut root = DMatrix::<f32>::identity(4, 4);
    correct_root(&mut root, &jacobian, &residual).expect("the prior is a root");
    let root = root.map(f64::from);
    let root = smallest(&root.tr_mul(&root));
    [difference, joseph, root].map(|found| found / expected - 1.0)
}
