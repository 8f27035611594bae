//! Random matrices, and errors that have a covariance to the last digit.

use nalgebra::{DMatrix, DVector};
use vislam::filtering::Belief;
use vislam::inertial::{ImuBias, NavState};
use vislam::least_squares::Key;

use crate::random::Random;

pub fn matrix(random: &mut Random, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| random.normal(1.0))
}

pub fn vector(random: &mut Random, rows: usize) -> DVector<f64> {
    DVector::from_fn(rows, |_, _| random.normal(1.0))
}

/// A covariance whose condition is moderate.
pub fn covariance(random: &mut Random, dimension: usize) -> DMatrix<f64> {
    let root = matrix(random, 2 * dimension + 3, dimension);
    root.tr_mul(&root) / dimension as f64
}

pub fn state(random: &mut Random) -> NavState {
    NavState {
        world_from_body: random.rotation(3.0),
        velocity: random.direction(2.0),
        position: random.direction(4.0),
    }
}

/// Errors with mean zero and exactly this covariance, each as likely as the others.
pub fn ensemble(covariance: &DMatrix<f64>) -> Vec<DVector<f64>> {
    let root = covariance.clone().cholesky().expect("a covariance has a root").l();
    let root = root * (covariance.nrows() as f64).sqrt();
    root.column_iter().flat_map(|column| [column.into_owned(), -column]).collect()
}

/// The covariance of errors that are as likely as one another and have mean zero.
pub fn scatter(errors: impl Iterator<Item = DVector<f64>>) -> DMatrix<f64> {
    let (mut sum, mut count) = (DMatrix::zeros(0, 0), 0.0);
    for error in errors {
        let square = &error * error.transpose();
        sum = if count == 0.0 { square } else { sum + square };
        count += 1.0;
    }
    sum / count
}

/// A state, its bias and some other variable, of which all this is believed, 15 rows and then those
/// of the other one.
pub fn believed(covariance: &DMatrix<f64>) -> (Belief, (Key<NavState>, Key<ImuBias>)) {
    let block = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
        covariance.view_range(rows, columns).into_owned()
    };
    let mut belief = Belief::new();
    let state = belief.add(NavState::origin(), &block(0..9, 0..9)).expect("it fits");
    // What is left of a variable's covariance when those before it are known.
    let given = |until: usize, to: usize| {
        let before = block(0..until, 0..until).try_inverse().expect("a covariance");
        let by_all = block(until..to, 0..until) * before;
        let left = block(until..to, until..to) - &by_all * block(0..until, until..to);
        (by_all, left)
    };
    let (by_all, left) = given(9, 15);
    let bias = belief.add_function(ImuBias::default(), &by_all, &left).expect("it fits");
    let (by_all, left) = given(15, 18);
    let other = nalgebra::Vector3::<f64>::zeros();
    belief.add_function(other, &by_all, &left).expect("it fits");
    (belief, (state, bias))
}
