//! The update of a Gaussian by a linear measurement, in four forms.

use nalgebra::{DMatrix, DVector};
use vislam::filtering::{Form, correct, correct_root, innovation_squared};

use super::{STATES, draws};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Update = |given| by_information(given, 1.0, -1.0);
    let mutants: [(_, Update); 4] = [
        ("covariance for information", |given| {
            let information = &given.p + given.h.tr_mul(&given.h);
            let after = inverse(&information);
            (-&after * given.h.tr_mul(&given.r), after)
        }),
        ("information subtracted", |given| by_information(given, -0.2, -1.0)),
        ("sign of the step", |given| by_information(given, 1.0, 1.0)),
        ("prior in the step's place", |given| {
            let (_, after) = by_information(given, 1.0, -1.0);
            (-&given.p * given.h.tr_mul(&given.r), after)
        }),
    ];
    chapter.equation("information-update", information_update, formula, &mutants);

    let formula: Update = |given| {
        let mut after = given.p.clone();
        let correction = correct(&mut after, &given.h, &given.r, Form::Difference);
        (correction.expect("a covariance").step, after)
    };
    let mutants: [(_, Update); 4] = [
        ("noise dropped", |given| by_gain(given, 0.0, -1.0)),
        ("covariance added", |given| {
            let (step, after) = by_gain(given, 1.0, -1.0);
            (step, 2.0 * &given.p - after)
        }),
        ("sign of the step", |given| by_gain(given, 1.0, 1.0)),
        ("noise subtracted", |given| by_gain(given, -1.0, -1.0)),
    ];
    chapter.equation("gain-update", gain_update, formula, &mutants);

    let formula: Left =
        |given| innovation_squared(&given.p, &given.h, &given.r).expect("a covariance");
    let mutants: [(_, Left); 3] = [
        ("prior dropped", |given| given.r.norm_squared()),
        ("noise dropped", |given| {
            let seen = &given.h * &given.p * given.h.transpose();
            given.r.dot(&(inverse(&seen) * &given.r))
        }),
        ("not inverted", |given| given.r.dot(&(innovation(given) * &given.r))),
    ];
    chapter.equation("innovation-cost", innovation_cost, formula, &mutants);

    let formula: AnyGain = |given, gain| joseph(given, gain, 1.0);
    let mutants: [(_, AnyGain); 4] = [
        ("noise dropped", |given, gain| joseph(given, gain, 0.0)),
        ("noise subtracted", |given, gain| joseph(given, gain, -1.0)),
        ("difference", |given, gain| &given.p - gain * &given.h * &given.p),
        ("transposed", |given, gain| {
            let kept = left(given, gain);
            kept.transpose() * &given.p * kept + gain * gain.transpose()
        }),
    ];
    chapter.equation("joseph-form", joseph_form, formula, &mutants);

    let formula: OfRoot = |root, given| {
        let mut root = root.clone();
        let correction = correct_root(&mut root, &given.h, &given.r).expect("a root");
        (correction.step, root.tr_mul(&root))
    };
    let mutants: [(_, OfRoot); 3] = [
        ("root transposed", |root, given| of_array(&root.transpose(), given, 1.0, 0)),
        ("noise dropped", |root, given| of_array(root, given, 0.0, 0)),
        ("new root from the wrong rows", |root, given| of_array(root, given, 1.0, 1)),
    ];
    chapter.equation("root-array", root_array, formula, &mutants);
}

/// A belief with the covariance P, and a measurement r + H e.
struct Given {
    p: DMatrix<f64>,
    h: DMatrix<f64>,
    r: DVector<f64>,
}

impl Given {
    fn random(random: &mut crate::random::Random, dimension: usize, rows: usize) -> Self {
        let p = draws::covariance(random, dimension);
        Self { p, h: draws::matrix(random, rows, dimension), r: draws::vector(random, rows) }
    }

    /// Step and covariance by least squares with the prior as rows.
    fn solved(&self) -> (DVector<f64>, DMatrix<f64>) {
        let lower = self.p.clone().cholesky().expect("a covariance").l();
        let dimension = self.p.nrows();
        let prior = lower.try_inverse().expect("a covariance");
        let mut rows = DMatrix::zeros(dimension + self.h.nrows(), dimension);
        rows.rows_mut(0, dimension).copy_from(&prior);
        rows.rows_mut(dimension, self.h.nrows()).copy_from(&self.h);
        let mut right = DVector::zeros(rows.nrows());
        right.rows_mut(dimension, self.h.nrows()).copy_from(&-&self.r);
        let qr = rows.qr();
        let inverse = qr.r().try_inverse().expect("the prior determines everything");
        (&inverse * qr.q().tr_mul(&right), &inverse * inverse.transpose())
    }
}

fn inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, columns) = matrix.shape();
    matrix.clone().try_inverse().unwrap_or(DMatrix::repeat(rows, columns, f64::NAN))
}

fn innovation(given: &Given) -> DMatrix<f64> {
    let rows = given.h.nrows();
    &given.h * &given.p * given.h.transpose() + DMatrix::identity(rows, rows)
}

fn by_information(given: &Given, measured: f64, sign: f64) -> (DVector<f64>, DMatrix<f64>) {
    let after = inverse(&(inverse(&given.p) + measured * given.h.tr_mul(&given.h)));
    (sign * &after * given.h.tr_mul(&given.r), after)
}

fn by_gain(given: &Given, noise: f64, sign: f64) -> (DVector<f64>, DMatrix<f64>) {
    let rows = given.h.nrows();
    let expected = innovation(given) + (noise - 1.0) * DMatrix::identity(rows, rows);
    let gain = &given.p * given.h.transpose() * inverse(&expected);
    (sign * &gain * &given.r, &given.p - &gain * &given.h * &given.p)
}

fn left(given: &Given, gain: &DMatrix<f64>) -> DMatrix<f64> {
    let dimension = given.p.nrows();
    DMatrix::identity(dimension, dimension) - gain * &given.h
}

fn joseph(given: &Given, gain: &DMatrix<f64>, noise: f64) -> DMatrix<f64> {
    let left = left(given, gain);
    &left * &given.p * left.transpose() + noise * gain * gain.transpose()
}

/// Step and covariance from the array, with so much of a unit block and the new root from so many
/// rows too high.
fn of_array(
    root: &DMatrix<f64>,
    given: &Given,
    unit: f64,
    high: usize,
) -> (DVector<f64>, DMatrix<f64>) {
    let (rows, dimension) = given.h.shape();
    let mut array = DMatrix::zeros(rows + dimension, rows + dimension);
    array.view_mut((0, 0), (rows, rows)).fill_diagonal(unit);
    array.view_mut((rows, 0), (dimension, rows)).copy_from(&(root * given.h.transpose()));
    array.view_mut((rows, rows), (dimension, dimension)).copy_from(root);
    let triangle = array.qr().unpack_r();
    let corner = triangle.view((0, 0), (rows, rows)).into_owned();
    let gain = triangle.view((0, rows), (rows, dimension)).into_owned();
    let new = triangle.view((rows - high, rows), (dimension, dimension));
    (-gain.tr_mul(&(inverse(&corner.transpose()) * &given.r)), new.tr_mul(&new))
}

type Update = fn(&Given) -> (DVector<f64>, DMatrix<f64>);

fn information_update(formula: Update) -> Comparison {
    let against = "mean and covariance of the product of the densities, summed over a grid";
    Comparison::relative(against, 1e-9).over(30, 11, |random| {
        let given = Given::random(random, 2, 3);
        let sigmas = given.p.diagonal().map(f64::sqrt);
        let (half, mut weight) = (120_i32, 0.0);
        let (mut sum, mut squares) = (DVector::zeros(2), DMatrix::zeros(2, 2));
        let information = inverse(&given.p);
        for (x, y) in (-half..=half).flat_map(|x| (-half..=half).map(move |y| (x, y))) {
            let place = DVector::from_vec(vec![f64::from(x) * sigmas[0], f64::from(y) * sigmas[1]]);
            let error = place * (8.0 / f64::from(half));
            let cost = error.dot(&(&information * &error));
            let cost = cost + (&given.r + &given.h * &error).norm_squared();
            let density = (-0.5 * cost).exp();
            weight += density;
            sum += density * &error;
            squares += density * &error * error.transpose();
        }
        let mean = sum / weight;
        let covariance = squares / weight - &mean * mean.transpose();
        (formula(&given), (mean, covariance))
    })
}

fn gain_update(formula: Update) -> Comparison {
    let against = "least squares with the prior as rows";
    Comparison::relative(against, 1e-9).over(STATES, 12, |random| {
        let given = Given::random(random, 6, 4);
        (formula(&given), given.solved())
    })
}

type Left = fn(&Given) -> f64;

fn innovation_cost(formula: Left) -> Comparison {
    let against = "the least cost, found by least squares";
    Comparison::relative(against, 1e-9).over(STATES, 13, |random| {
        let given = Given::random(random, 6, 4);
        let (step, _) = given.solved();
        let cost = step.dot(&(inverse(&given.p) * &step));
        (formula(&given), cost + (&given.r + &given.h * &step).norm_squared())
    })
}

type AnyGain = fn(&Given, &DMatrix<f64>) -> DMatrix<f64>;

fn joseph_form(formula: AnyGain) -> Comparison {
    let against = "the scatter of errors that any gain corrects, one by one";
    Comparison::relative(against, 1e-10).over(STATES, 14, |random| {
        let given = Given::random(random, 5, 3);
        let gain = draws::matrix(random, 5, 3);
        let noises = draws::ensemble(&DMatrix::identity(3, 3));
        let errors = draws::ensemble(&given.p);
        // The residual is prediction less measurement, −(H e + n); the step moves the estimate.
        let corrected = errors.iter().flat_map(|error| {
            let (given, gain) = (&given, &gain);
            noises.iter().map(move |noise| error - gain * (&given.h * error + noise))
        });
        (formula(&given, &gain), draws::scatter(corrected))
    })
}

type OfRoot = fn(&DMatrix<f64>, &Given) -> (DVector<f64>, DMatrix<f64>);

fn root_array(formula: OfRoot) -> Comparison {
    let against = "least squares with the prior as rows";
    Comparison::relative(against, 1e-9).over(STATES, 15, |random| {
        let given = Given::random(random, 6, 4);
        let root = given.p.clone().cholesky().expect("a covariance").l().transpose();
        (formula(&root, &given), given.solved())
    })
}
