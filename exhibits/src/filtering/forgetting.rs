//! A filter and the batch of all that was measured.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use vislam::filtering::{Form, correct};

use crate::chapter::Chapter;
use crate::comparison::Comparison;

/// Steps after the first state.
const STEPS: usize = 4;

pub fn counterexamples(chapter: &mut Chapter) {
    let kept = Walk { bend: 0.0, common: 0.0, back: false };
    for (condition, dropped) in [
        ("linear", Walk { bend: 0.3, ..kept }),
        ("independent", Walk { common: 1.5, ..kept }),
        ("kept", Walk { back: true, ..kept }),
    ] {
        chapter.counterexample("filter-is-batch", condition, same_estimate, [kept, dropped]);
    }
}

/// A walk along a line: place and speed, of which the place is measured after every step.
#[derive(Clone, Copy)]
struct Walk {
    /// How strongly the measured place bends, per unit.
    bend: f64,
    /// The standard deviation of an error that all measurements have in common.
    common: f64,
    /// Whether the last measurement compares the last place with the first one.
    back: bool,
}

/// What was measured, in units of its noise.
const MEASURED: [f64; STEPS] = [1.4, 1.7, 3.6, 3.5];
const BACK: f64 = 3.1;
const SIGMA: f64 = 0.5;
const TRANSITION: Matrix2<f64> = Matrix2::new(1.0, 1.0, 0.0, 1.0);
const NOISE: Matrix2<f64> = Matrix2::new(0.05, 0.02, 0.02, 0.1);
const FIRST: Vector2<f64> = Vector2::new(0.0, 0.8);
const VARIANCE: f64 = 0.3;

impl Walk {
    /// The measured place and its derivative.
    fn place(&self, x: f64) -> (f64, f64) {
        (x + self.bend * x * x, 1.0 + 2.0 * self.bend * x)
    }

    /// The last state and its covariance, one measurement after the other. What compares with the
    /// first state cannot be used, for it has been dropped.
    fn filtered(&self) -> (DVector<f64>, DMatrix<f64>) {
        let (mut state, mut covariance) = (FIRST, DMatrix::from_diagonal_element(2, 2, VARIANCE));
        let by = DMatrix::from_column_slice(2, 2, TRANSITION.as_slice());
        let noise = DMatrix::from_column_slice(2, 2, NOISE.as_slice());
        for measured in MEASURED {
            state = TRANSITION * state;
            covariance = &by * covariance * by.transpose() + &noise;
            let (place, slope) = self.place(state.x);
            let sigma = SIGMA.hypot(self.common);
            let jacobian = DMatrix::from_row_slice(1, 2, &[slope / sigma, 0.0]);
            let residual = DVector::from_element(1, (place - measured) / sigma);
            let correction = correct(&mut covariance, &jacobian, &residual, Form::Joseph);
            let step = correction.expect("a covariance").step;
            state += Vector2::new(step[0], step[1]);
        }
        (DVector::from_column_slice(state.as_slice()), covariance)
    }

    /// The same from all states and measurements at once, by Gauss-Newton until nothing moves.
    fn batch(&self) -> (DVector<f64>, DMatrix<f64>) {
        let dimension = 2 * (STEPS + 1);
        let mut states = DVector::zeros(dimension);
        let root = |matrix: Matrix2<f64>| {
            let information = matrix.try_inverse().expect("a covariance");
            information.cholesky().expect("a covariance").l().transpose()
        };
        // Noise that all measurements share makes their covariance a full matrix.
        let shared = self.common * self.common;
        let noise = DMatrix::from_element(STEPS, STEPS, shared)
            + DMatrix::from_diagonal_element(STEPS, STEPS, SIGMA * SIGMA);
        let whitener = noise.cholesky().expect("a covariance").l();
        let whitener = whitener.try_inverse().expect("a covariance");
        let mut covariance = DMatrix::zeros(dimension, dimension);
        for _ in 0..60 {
            let rows = 2 + 2 * STEPS + STEPS + 1;
            let (mut j, mut r) = (DMatrix::zeros(rows, dimension), DVector::zeros(rows));
            let at = |k: usize| Vector2::new(states[2 * k], states[2 * k + 1]);
            let first = root(Matrix2::from_diagonal_element(VARIANCE));
            j.view_mut((0, 0), (2, 2)).copy_from(&first);
            r.rows_mut(0, 2).copy_from(&(first * (at(0) - FIRST)));
            let moved = root(NOISE);
            for k in 0..STEPS {
                let row = 2 + 2 * k;
                j.view_mut((row, 2 * k), (2, 2)).copy_from(&(-moved * TRANSITION));
                j.view_mut((row, 2 * k + 2), (2, 2)).copy_from(&moved);
                r.rows_mut(row, 2).copy_from(&(moved * (at(k + 1) - TRANSITION * at(k))));
            }
            let (mut by_place, mut off) = (DMatrix::zeros(STEPS, dimension), DVector::zeros(STEPS));
            for k in 0..STEPS {
                let (place, slope) = self.place(at(k + 1).x);
                by_place[(k, 2 * k + 2)] = slope;
                off[k] = place - MEASURED[k];
            }
            let row = 2 + 2 * STEPS;
            j.rows_mut(row, STEPS).copy_from(&(&whitener * by_place));
            r.rows_mut(row, STEPS).copy_from(&(&whitener * off));
            if self.back {
                let last = rows - 1;
                j[(last, 0)] = -1.0 / SIGMA;
                j[(last, 2 * STEPS)] = 1.0 / SIGMA;
                r[last] = (at(STEPS).x - at(0).x - BACK) / SIGMA;
            }
            covariance = j.tr_mul(&j).try_inverse().expect("everything is determined");
            states -= &covariance * j.tr_mul(&r);
        }
        let last = 2 * STEPS;
        (states.rows(last, 2).into_owned(), covariance.view((last, last), (2, 2)).into_owned())
    }
}

fn same_estimate(walk: Walk) -> Comparison {
    let against = "the batch of all that was measured";
    Comparison::absolute(against, 1e-9, "").once(walk.filtered(), walk.batch())
}
