//! Singular values that are small beside the largest and right all the same.
//!
//! The decomposition of nalgebra 0.35 is not used here: of matrices without full rank, some come back
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
    let pairs = || (1..columns).flat_map(|second| (0..second).map(move |first| (first, second)));
    for _ in 0..SWEEPS {
        let mut squares: Vec<f64> = turned.iter().map(|column| column.norm_squared()).collect();
        let lost = LOST * LOST * squares.iter().fold(0.0, |a: f64, b| a.max(*b));
        let mut turned_any = false;
        for (first, second) in pairs() {
            let is_lost = squares[first].min(squares[second]) <= lost;
            turned_any |= !is_lost && turn(&mut turned, &mut squares, first, second);
        }
        if !turned_any {
            break;
        }
    }
    turned.sort_by(|a, b| b.norm_squared().total_cmp(&a.norm_squared()));
    let mut values: Vec<f64> = turned.iter().map(|column| column.norm()).collect();
    // What has lost its direction is replaced by what is orthogonal to all others.
    let kept = values.partition_point(|length| *length > LOST * values[0]);
    let mut whole = DMatrix::identity(columns, columns).insert_columns(0, kept, 0.0);
    for at in 0..kept {
        whole.set_column(at, &(&turned[at] / values[at]));
    }
    let mut vectors = whole.clone().qr().q();
    vectors.columns_mut(0, kept).copy_from(&whole.columns(0, kept));
    permutation.inv_permute_rows(&mut vectors);
    values.reverse();
    let ascending: Vec<usize> = (0..columns).rev().collect();
    (values, vectors.select_columns(&ascending))
}

/// Turns two columns in their plane until they are orthogonal, and knows their squared lengths
/// then. False when they were.
fn turn(columns: &mut [DVector<f64>], squares: &mut [f64], first: usize, second: usize) -> bool {
    let (before, rest) = columns.split_at_mut(second);
    let (one, other) = (&mut before[first], &mut rest[0]);
    let (a, b, c) = (squares[first], squares[second], one.dot(other));
    if c.abs() <= ORTHOGONAL * a.sqrt() * b.sqrt() {
        return false;
    }
    let zeta = (b - a) / (2.0 * c);
    // The smaller of the two angles.
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = tangent.hypot(1.0).recip();
    let sine = cosine * tangent;
    for (x, y) in one.iter_mut().zip(other.iter_mut()) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
    (squares[first], squares[second]) = ((a - tangent * c).max(0.0), b + tangent * c);
    true
}
