//! Elimination in square-root form: rows are turned, and nothing is squared.

use nalgebra::DMatrix;

/// Columns and entries.
pub(super) type SparseRow = Vec<(usize, f64)>;

/// The columns of some rows, ascending, and the rows with these alone.
pub(super) fn dense(rows: &[SparseRow]) -> (Vec<usize>, DMatrix<f64>) {
    let mut columns: Vec<usize> = rows.iter().flatten().map(|(column, _)| *column).collect();
    columns.sort_unstable();
    columns.dedup();
    let mut dense = DMatrix::zeros(rows.len(), columns.len());
    for (number, row) in rows.iter().enumerate() {
        for (column, slope) in row {
            dense[(number, columns.partition_point(|other| other < column))] = *slope;
        }
    }
    (columns, dense)
}

// ANCHOR: eliminate_rows
/// Eliminates the first columns of some rows, the last column of which may be the residual: turns the
/// rows by an orthogonal matrix until only as many of them name these columns as there are of them.
///
/// Gives these rows, and then those that say everything else that was said, without the first
/// columns. Whether a column is seen at all does not matter: what is not seen leaves zeros.
pub fn eliminate(rows: DMatrix<f64>, columns: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let columns = columns.min(rows.ncols());
    let triangle = rows.qr().unpack_r();
    let own = columns.min(triangle.nrows());
    let (left, width) = (triangle.nrows() - own, triangle.ncols() - columns);
    let rest = triangle.view((own, columns), (left, width)).into_owned();
    (triangle.rows(0, own).into_owned(), rest)
}
// ANCHOR_END: eliminate_rows
