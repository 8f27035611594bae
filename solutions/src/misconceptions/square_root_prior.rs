//! Wrong answers to [`square_root_prior`](crate::square_root_prior).

use exercise_spec::square_root_prior::*;
use nalgebra::{DMatrix, DVector};

use super::Wrong;
use crate::square_root_prior as right;

/// The reference answer.
pub const REFERENCE: Functions =
    Functions { absorb: right::absorb, slide: right::slide, seen_from: right::seen_from };

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let absorb =
        |misconception, absorb| Wrong::new(misconception, Functions { absorb, ..REFERENCE });
    let slide = |misconception, slide| Wrong::new(misconception, Functions { slide, ..REFERENCE });
    let seen_from =
        |misconception, seen_from| Wrong::new(misconception, Functions { seen_from, ..REFERENCE });
    vec![
        absorb(&RESIDUAL_NOT_ROTATED, |prior, row, residual| {
            let offset = prior.offset.clone();
            Prior { offset, ..right::absorb(prior, row, residual) }
        }),
        slide(&RESIDUAL_NOT_ROTATED, |prior, rows, residual, gone| {
            let (_, all) = stacked(&prior, &rows, &residual);
            let prior = right::slide(prior, rows, residual, gone.clone());
            Prior { offset: -all.rows(gone.len(), prior.offset.len()), ..prior }
        }),
        absorb(&OFFSET_SIGN, |prior, row, residual| right::absorb(prior, row, -residual)),
        slide(&OFFSET_SIGN, |prior, rows, residual, gone| {
            turned_over(right::slide(prior, rows, residual, gone))
        }),
        slide(&OFFSET_SIGN, |prior, rows, residual, gone| {
            turned_over(right::slide(turned_over(prior), rows, residual, gone))
        }),
        slide(&HELD, |prior, rows, residual, gone| {
            let (rows, residual) = stacked(&prior, &rows, &residual);
            let rows = rows.select_columns(&stays(rows.ncols(), &gone));
            right::slide(nothing(), rows, residual, Vec::new())
        }),
        slide(&ROWS_OF_THE_GONE, |prior, rows, residual, gone| {
            let (rows, residual) = stacked(&prior, &rows, &residual);
            let order = [gone.clone(), stays(rows.ncols(), &gone)].concat();
            let all = right::slide(nothing(), rows.select_columns(&order), residual, Vec::new());
            Prior { root: all.root.columns_range(gone.len()..).into_owned(), ..all }
        }),
        slide(&FIRST_COLUMNS, |prior, rows, residual, gone| {
            right::slide(prior, rows, residual, (0..gone.len()).collect())
        }),
        slide(&PRIOR_FORGOTTEN, |_, rows, residual, gone| {
            right::slide(nothing(), rows, residual, gone)
        }),
        slide(&PRIOR_SIGN, |prior, rows, residual, gone| {
            right::slide(turned_over(prior), rows, residual, gone)
        }),
        slide(&SQUARED, |prior, rows, residual, gone| {
            let (rows, residual) = stacked(&prior, &rows, &residual);
            by_information(&rows, &residual, &gone)
        }),
        absorb(&SQUARED, |prior, row, residual| {
            let count = row.len();
            let (rows, residual) = stacked(
                &prior,
                &DMatrix::from_fn(1, count, |_, column| row[column]),
                &DVector::from_element(1, residual),
            );
            by_information(&rows, &residual, &[])
        }),
        seen_from(&SHIFT_SIGN, |prior, step| right::seen_from(prior, -step)),
        seen_from(&SHIFT_UNWEIGHTED, |prior, step| Prior { offset: &prior.offset - step, ..prior }),
        seen_from(&OFFSET_NOT_MOVED, |prior, _| prior),
    ]
}

fn nothing() -> Prior {
    Prior { root: DMatrix::zeros(0, 0), offset: DVector::zeros(0) }
}

fn turned_over(prior: Prior) -> Prior {
    Prior { offset: -prior.offset, ..prior }
}

fn stays(columns: usize, gone: &[usize]) -> Vec<usize> {
    (0..columns).filter(|column| !gone.contains(column)).collect()
}

/// The rows of a prior as if they had been measured, above those that have been.
fn stacked(
    prior: &Prior,
    rows: &DMatrix<f32>,
    residual: &DVector<f32>,
) -> (DMatrix<f32>, DVector<f32>) {
    let (old, new, columns) = (prior.offset.len(), rows.nrows(), rows.ncols());
    let mut all = DMatrix::zeros(old + new, columns);
    all.view_mut((0, 0), (old, old)).copy_from(&prior.root);
    all.rows_mut(old, new).copy_from(rows);
    let numbers = prior.offset.iter().map(|number| -number).chain(residual.iter().copied());
    (all, DVector::from_iterator(old + new, numbers))
}

/// The detour by the information matrix, with a little added where it is not positive definite.
fn by_information(rows: &DMatrix<f32>, residual: &DVector<f32>, gone: &[usize]) -> Prior {
    let (information, vector) = (rows.tr_mul(rows), -rows.tr_mul(residual));
    let stays = stays(rows.ncols(), gone);
    let block = |a: &[usize], b: &[usize]| information.select_rows(a).select_columns(b);
    let inverse = block(gone, gone).try_inverse().unwrap_or_default();
    let coupling = block(&stays, gone) * inverse;
    let mut left = block(&stays, &stays) - &coupling * block(gone, &stays);
    let vector = vector.select_rows(&stays) - coupling * vector.select_rows(gone);
    let little = 1e-7 * left.amax();
    loop {
        if let Some(factor) = left.clone().cholesky() {
            let offset = factor.l_dirty().solve_lower_triangular(&vector).unwrap_or(vector);
            return Prior { root: factor.l().transpose(), offset };
        }
        for index in 0..left.nrows() {
            left[(index, index)] += little;
        }
    }
}
