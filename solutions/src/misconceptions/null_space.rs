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
