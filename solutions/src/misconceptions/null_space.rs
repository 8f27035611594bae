//! Wrong answers to [`null_space`](crate::null_space).

use exercise_spec::null_space::*;
use nalgebra::{DMatrix, DVector};

use super::Wrong;
use crate::null_space as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    givens: right::givens,
    project_out: right::project_out,
    correction: right::correction,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let rotation =
        |misconception, givens| Wrong::new(misconception, Functions { givens, ..REFERENCE });
    let projection = |misconception, project_out| {
        Wrong::new(misconception, Functions { project_out, ..REFERENCE })
    };
    let update = |misconception, correction| {
        Wrong::new(misconception, Functions { correction, ..REFERENCE })
    };
    vec![
        rotation(&TURNED_BACK, |a, b| {
            let (c, s) = right::givens(a, b);
            (c, -s)
        }),
        rotation(&FIRST_NUMBER_GONE, |a, b| {
            let (c, s) = right::givens(a, b);
            if a == 0.0 && b == 0.0 { (c, s) } else { (s, c) }
        }),
        projection(&PROJECTOR, |states, landmark, residual| {
            right::project_out(states.clone(), landmark.clone(), residual.clone())?;
            let complement = complement(&landmark)?;
            Some((&complement * states, complement * residual))
        }),
        projection(&PSEUDO_INVERSE_ROWS, |states, landmark, residual| {
            right::project_out(states.clone(), landmark.clone(), residual.clone())?;
            let complement = complement(&landmark)?.remove_rows(0, 3);
            Some((&complement * states, complement * residual))
        }),
        projection(&RESIDUAL_NOT_ROTATED, |states, landmark, residual| {
            let (states, _) = right::project_out(states, landmark, residual.clone())?;
            Some((states, residual.remove_rows(0, 3)))
        }),
        projection(&STATES_NOT_ROTATED, |states, landmark, residual| {
            let (_, residual) = right::project_out(states.clone(), landmark, residual)?;
            Some((states.remove_rows(0, 3), residual))
        }),
        projection(&FIRST_THREE_KEPT, |states, landmark, residual| {
            right::project_out(states.clone(), landmark.clone(), residual.clone())?;
            let count = residual.len() - 3;
            let (states, residual) = rotated(states, landmark, residual);
            Some((states.rows(0, count).into_owned(), residual.rows(0, count).into_owned()))
        }),
        projection(&FROM_THE_TOP, |states, landmark, residual| {
            turned(states, landmark, residual, |table, column| {
                for lower in column + 1..table.nrows() {
                    let (a, b) = (table.row(lower - 1).into_owned(), table.row(lower).into_owned());
                    let (c, s) = right::givens(a[column], b[column]);
                    table.set_row(lower - 1, &(c * &a + s * &b));
                    table.set_row(lower, &(c * b - s * a));
                }
            })
        }),
        projection(&STALE_ROW, |states, landmark, residual| {
            turned(states, landmark, residual, |table, column| {
                let a = table.row(column).into_owned();
                for lower in column + 1..table.nrows() {
                    let b = table.row(lower).into_owned();
                    let (c, s) = right::givens(a[column], b[column]);
                    table.set_row(column, &(c * &a + s * &b));
                    table.set_row(lower, &(c * b - s * &a));
                }
            })
        }),
        projection(&OVERWRITTEN_ROW, |states, landmark, residual| {
            turned(states, landmark, residual, |table, column| {
                for lower in (column + 1..table.nrows()).rev() {
                    overwritten(table, column, lower - 1, lower);
                }
            })
        }),
        projection(&OVERWRITTEN_ROW, |states, landmark, residual| {
            turned(states, landmark, residual, |table, column| {
                for lower in column + 1..table.nrows() {
                    overwritten(table, column, column, lower);
                }
            })
        }),
        projection(&RANK_TWO, |states, landmark, residual| {
            let count = residual.len().checked_sub(3)?;
            let (states, residual) = rotated(states, landmark, residual);
            Some((states.rows(3, count).into_owned(), residual.rows(3, count).into_owned()))
        }),
        projection(&ABSOLUTE_RANK, |states, landmark, residual| {
            let count = residual.len().checked_sub(3)?;
            if landmark.singular_values().min() < 1e-9 {
                return None;
            }
            let (states, residual) = rotated(states, landmark, residual);
            Some((states.rows(3, count).into_owned(), residual.rows(3, count).into_owned()))
        }),
        update(&OTHER_WAY, |prior, states, landmark, residual| {
            Some(-right::correction(prior, states, landmark, residual)?)
        }),
        update(&LANDMARK_KNOWN, |prior, states, landmark, residual| {
            right::project_out(states.clone(), landmark, residual.clone())?;
            let information = prior + states.tr_mul(&states);
            Some(-information.cholesky()?.solve(&states.tr_mul(&residual)))
        }),
        update(&WRONG_RIGHT_SIDE, |prior, states, landmark, residual| {
            let right_side = states.tr_mul(&residual);
            let (left, _) = right::project_out(states, landmark, residual)?;
            Some(-(prior + left.tr_mul(&left)).cholesky()?.solve(&right_side))
        }),
        update(&PRIOR_INVERTED, |prior, states, landmark, residual| {
            right::correction(prior.try_inverse()?, states, landmark, residual)
        }),
    ]
}

/// I − H_f H_f⁺.
fn complement(landmark: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let inverse = landmark.clone().pseudo_inverse(0.0).ok()?;
    Some(DMatrix::identity(landmark.nrows(), landmark.nrows()) - landmark * inverse)
}

/// Rows below the third, after a table of landmark, states and residual was rotated column by column.
fn turned(
    states: DMatrix<f64>,
    landmark: DMatrix<f64>,
    residual: DVector<f64>,
    rotate: fn(&mut DMatrix<f64>, usize),
) -> Option<(DMatrix<f64>, DVector<f64>)> {
    right::project_out(states.clone(), landmark.clone(), residual.clone())?;
    let (rows, columns) = states.shape();
    let mut table = DMatrix::zeros(rows, 3 + columns + 1);
    table.columns_mut(0, 3).copy_from(&landmark);
    table.columns_mut(3, columns).copy_from(&states);
    table.set_column(3 + columns, &residual);
    (0..3).for_each(|column| rotate(&mut table, column));
    let left = table.rows(3, rows - 3);
    Some((left.columns(3, columns).into_owned(), left.column(3 + columns).into_owned()))
}

/// Turns two rows, the second of them with the first one as it has become.
fn overwritten(table: &mut DMatrix<f64>, column: usize, upper: usize, lower: usize) {
    let (c, s) = right::givens(table[(upper, column)], table[(lower, column)]);
    for at in 0..table.ncols() {
        table[(upper, at)] = c * table[(upper, at)] + s * table[(lower, at)];
        table[(lower, at)] = c * table[(lower, at)] - s * table[(upper, at)];
    }
}

/// States and residual with all their rows, rotated with the landmark.
fn rotated(
    mut states: DMatrix<f64>,
    landmark: DMatrix<f64>,
    mut residual: DVector<f64>,
) -> (DMatrix<f64>, DVector<f64>) {
    let factors = landmark.qr();
    // Householder's factor has as many columns as the landmark has; the rest is completed.
    let thin = factors.q();
    let rows = thin.nrows();
    let complement = DMatrix::identity(rows, rows) - &thin * thin.transpose();
    let mut basis = vec![];
    basis.extend(thin.column_iter().map(|column| column.into_owned()));
    for candidate in complement.column_iter() {
        let mut column = candidate.into_owned();
        for known in &basis {
            let part: f64 = known.dot(&column);
            column -= part * known;
        }
        if basis.len() < rows && column.norm() > 1e-6 {
            basis.push(column.normalize());
        }
    }
    let turn = DMatrix::from_columns(&basis).transpose();
    states = &turn * states;
    residual = turn * residual;
    (states, residual)
}
