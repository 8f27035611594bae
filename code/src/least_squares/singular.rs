//! Singular values that are small beside the largest and right all the same.
//!
//! The decomposition of nalgebra 0.35 is not used: of matrices without full rank, some come back
//! with singular values that are wrong by a hundredth.

use nalgebra::{DMatrix, DVector};

/// Two columns are orthogonal when their cosine is below this.
const ORTHOGONAL: f64 = 3e-15;

/// Each sweep over all pairs squares what is left; a dozen is plenty.
const SWEEPS: usize = 40;

/// Columns shorter than this part of the longest have lost their direction to rounding.
const LOST: f64 = 1e-14;

/// Singular values, ascending, and the right singular vectors as columns, by the one-sided method
/// of Jacobi on a triangular factor. It turns pairs of columns until all are orthogonal; their
/// lengths are the singular values.
pub fn right_singular(matrix: DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let (rows, columns) = matrix.shape();
    if columns == 0 {
        return (Vec::new(), DMatrix::zeros(0, 0));
    }
    let filled = matrix.insert_rows(rows, columns.saturating_sub(rows), 0.0);
    let (_, triangular, permutation) = filled.col_piv_qr().unpack();
    let mut turned: Vec<DVector<f64>> = triangular.row_iter().map(|row| row.transpose()).collect();
    for _ in 0..SWEEPS {
        if !sweep(&mut turned) {
            break;
        }
    }
    turned.sort_by(|a, b| b.norm_squared().total_cmp(&a.norm_squared()));
    let mut values: Vec<f64> = turned.iter().map(|column| column.norm()).collect();
    let mut vectors = completed(&turned, &values);
    permutation.inv_permute_rows(&mut vectors);
    values.reverse();
    let ascending: Vec<usize> = (0..columns).rev().collect();
    (values, vectors.select_columns(&ascending))
}

/// Makes every pair of columns that have a direction orthogonal once. Whether any was not.
fn sweep(columns: &mut [DVector<f64>]) -> bool {
    let mut squares: Vec<f64> = columns.iter().map(|column| column.norm_squared()).collect();
    let lost = LOST * LOST * squares.iter().fold(0.0, |a: f64, b| a.max(*b));
    let mut turned_any = false;
    for second in 1..columns.len() {
        let (before, rest) = columns.split_at_mut(second);
        for (first, column) in before.iter_mut().enumerate() {
            if squares[first].min(squares[second]) > lost {
                let pair = [squares[first], squares[second]];
                if let Some(pair) = turn(column, &mut rest[0], pair) {
                    [squares[first], squares[second]] = pair;
                    turned_any = true;
                }
            }
        }
    }
    turned_any
}

/// Turns two columns with these squared lengths in their plane until they are orthogonal, and
/// gives their squared lengths then; `None` when they were orthogonal.
fn turn(first: &mut DVector<f64>, second: &mut DVector<f64>, [a, b]: [f64; 2]) -> Option<[f64; 2]> {
    let c = dot(first.as_slice(), second.as_slice());
    if c.abs() <= ORTHOGONAL * a.sqrt() * b.sqrt() {
        return None;
    }
    let zeta = (b - a) / (2.0 * c);
    // The smaller of the two angles.
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = tangent.hypot(1.0).recip();
    let sine = cosine * tangent;
    for (x, y) in first.iter_mut().zip(second.iter_mut()) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
    Some([(a - tangent * c).max(0.0), b + tangent * c])
}

/// Four sums side by side keep the processor busy.
fn dot(first: &[f64], second: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours, rest) = first.as_chunks::<4>();
    let (other_fours, other_rest) = second.as_chunks::<4>();
    for (x, y) in fours.iter().zip(other_fours) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    let rest: f64 = rest.iter().zip(other_rest).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

/// The columns at length one, with those that have lost their direction replaced by what is
/// orthogonal to all others. Lengths descend.
fn completed(columns: &[DVector<f64>], lengths: &[f64]) -> DMatrix<f64> {
    let size = columns.len();
    let kept = lengths.partition_point(|length| *length > LOST * lengths[0]);
    let mut whole = DMatrix::zeros(size, kept + size);
    for (at, (column, length)) in columns.iter().zip(lengths).take(kept).enumerate() {
        whole.set_column(at, &(column / *length));
    }
    whole.columns_mut(kept, size).fill_with_identity();
    let mut vectors = whole.clone().qr().q();
    vectors.columns_mut(0, kept).copy_from(&whole.columns(0, kept));
    vectors
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::right_singular;

    /// Numbers that look random.
    fn entry(seed: usize) -> impl FnMut(usize, usize) -> f64 {
        move |row, column| {
            let x = (1 + row * 31 + column * 17 + seed * 101) as f64;
            2.0 * (x.sin() * 43_758.545_3).fract()
        }
    }

    #[test]
    fn a_matrix_is_what_its_singular_vectors_make_of_it_whatever_its_rank() {
        for seed in 0..300 {
            let missing = seed % 4;
            let thin = DMatrix::from_fn(20, 8 - missing, entry(seed));
            let matrix = thin * DMatrix::from_fn(8 - missing, 8, entry(seed + 1000));
            let (values, vectors) = right_singular(matrix.clone());
            let identity = vectors.tr_mul(&vectors) - DMatrix::identity(8, 8);
            assert!(identity.norm() < 1e-13, "{seed}: {}", identity.norm());
            assert!(values.is_sorted());
            assert!(values[..missing].iter().all(|value| *value < 1e-13 * values[7]));
            let squares = DVector::from_iterator(8, values.iter().map(|value| value * value));
            let again = &vectors * DMatrix::from_diagonal(&squares) * vectors.transpose();
            let square = matrix.tr_mul(&matrix);
            assert!((again - &square).norm() < 1e-13 * square.norm(), "{seed}");
        }
    }

    #[test]
    fn small_singular_values_are_right_beside_large_ones() {
        // A graded matrix: orthogonal times diagonal, so that the values are known.
        let orthogonal = DMatrix::from_fn(6, 6, entry(7)).qr().q();
        let values = [1.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-13];
        let diagonal = DMatrix::from_diagonal(&DVector::from_row_slice(&values));
        let (found, _) = right_singular(orthogonal * diagonal);
        for (found, value) in found.iter().rev().zip(values) {
            assert!((found / value - 1.0).abs() < 1e-12, "{found} for {value}");
        }
    }
}
