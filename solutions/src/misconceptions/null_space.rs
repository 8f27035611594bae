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
            let (states, residual) = rotated(states, landmark, residual, from_the_bottom);
            Some((states.rows(0, count).into_owned(), residual.rows(0, count).into_owned()))
        }),
        projection(&FROM_THE_TOP, |states, landmark, residual| {
            turned(states, landmark, residual, |table, column| {
                for lower in column + 1..table.nrows() {
                    neighbours(table, column, lower);
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
            let (states, residual) = rotated(states, landmark, residual, from_the_bottom);
            Some((states.rows(3, count).into_owned(), residual.rows(3, count).into_owned()))
        }),
        projection(&ABSOLUTE_RANK, |states, landmark, residual| {
            let count = residual.len().checked_sub(3)?;
            if landmark.singular_values().min() < 1e-9 {
                return None;
            }
            let (states, residual) = rotated(states, landmark, residual, from_the_bottom);
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

/// I − H_f H_f⁺, with H_f⁺ = (H_fᵀ H_f)⁻¹ H_fᵀ.
fn complement(landmark: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let inverse = landmark.tr_mul(landmark).try_inverse()? * landmark.transpose();
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
    let (states, residual) = rotated(states, landmark, residual, rotate);
    let count = residual.len() - 3;
    Some((states.rows(3, count).into_owned(), residual.rows(3, count).into_owned()))
}

/// States and residual with all their rows, after they were rotated with the landmark.
fn rotated(
    states: DMatrix<f64>,
    landmark: DMatrix<f64>,
    residual: DVector<f64>,
    rotate: fn(&mut DMatrix<f64>, usize),
) -> (DMatrix<f64>, DVector<f64>) {
    let (rows, columns) = states.shape();
    let mut table = DMatrix::zeros(rows, 3 + columns + 1);
    table.columns_mut(0, 3).copy_from(&landmark);
    table.columns_mut(3, columns).copy_from(&states);
    table.set_column(3 + columns, &residual);
    (0..3).for_each(|column| rotate(&mut table, column));
    (table.columns(3, columns).into_owned(), table.column(3 + columns).into_owned())
}

/// Rotations of neighbours from the bottom, as they should be.
fn from_the_bottom(table: &mut DMatrix<f64>, column: usize) {
    for lower in (column + 1..table.nrows()).rev() {
        neighbours(table, column, lower);
    }
}

/// Turns a row and the one above it.
fn neighbours(table: &mut DMatrix<f64>, column: usize, lower: usize) {
    let (a, b) = (table.row(lower - 1).into_owned(), table.row(lower).into_owned());
    let (c, s) = right::givens(a[column], b[column]);
    table.set_row(lower - 1, &(c * &a + s * &b));
    table.set_row(lower, &(c * b - s * a));
}

/// Turns two rows, the second of them with the first one as it has become.
fn overwritten(table: &mut DMatrix<f64>, column: usize, upper: usize, lower: usize) {
    let (c, s) = right::givens(table[(upper, column)], table[(lower, column)]);
    for at in 0..table.ncols() {
        table[(upper, at)] = c * table[(upper, at)] + s * table[(lower, at)];
        table[(lower, at)] = c * table[(lower, at)] - s * table[(upper, at)];
    }
}
