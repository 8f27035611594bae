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
    let formula: Bound =
        |condition, error| 2.0 * error * condition.sqrt() + error * error * condition;
    let mutants: [(_, Bound); 3] = [
        ("condition for its root", |condition, error| {
            2.0 * error * condition + (error * condition).powi(2)
        }),
        ("second order dropped", |condition, error| 2.0 * error * condition.sqrt()),
        ("fourth root", |condition, error| {
            2.0 * error * condition.powf(0.25) + error * error * condition.sqrt()
        }),
    ];
    chapter.equation("root-digits", root_digits, formula, &mutants);
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

type Bound = fn(f64, f64) -> f64;

/// The error of the root that does most harm lies along its weakest direction.
fn root_digits(formula: Bound) -> Comparison {
    let against = "the smallest eigenvalue when the worst error is added to the root";
    Comparison::relative(against, 1e-5).over(CASES, 41, |random| {
        let condition = random.logarithmic(1e1..1e5);
        let error = random.logarithmic(1e-3..1e-1);
        let root = Root::random(random, condition);
        let worst = error * root.left.column(1) * root.right.column(1).transpose();
        let spoilt = root.matrix() + worst;
        let before = root.values[1].powi(2);
        let spoilt = spoilt.tr_mul(&spoilt);
        // The direction is no longer the weakest when the error is large.
        let along = root.right.column(1);
        let after = along.dot(&(spoilt * along));
        (formula(condition, error), after / before - 1.0)
    })
}

/// By how much the smallest eigenvalue leaves the bound when an error is one of the root, or one of
/// the covariance.
fn within_bound(of_root: bool) -> Comparison {
    let (condition, error) = (1e6_f64, 1e-4);
    let bound = 2.0 * error * condition.sqrt() + error * error * condition;
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
const DRAWS: usize = 25;

/// For each condition the median relative error of the smallest variance after a measurement in
/// single precision: of the difference, of Joseph's form, and of the root.
pub fn lost() -> &'static [[f64; 3]; 9] {
    static LOST: OnceLock<[[f64; 3]; 9]> = OnceLock::new();
    LOST.get_or_init(|| {
        CONDITIONS.map(|condition| {
            let mut random = Random::new(43);
            let mut draws: Vec<[f64; 3]> =
                (0..DRAWS).map(|_| measured_once(&mut random, condition)).collect();
            [0, 1, 2].map(|form| {
                draws.sort_by(|one, other| one[form].total_cmp(&other[form]));
                draws[DRAWS / 2][form]
            })
        })
    })
}

/// Two sharp measurements of four numbers whose variance is one.
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
    [difference, joseph, root].map(|found| (found / expected - 1.0).abs().max(1e-9))
}
