//! What a window keeps of those who left.

use exercise_spec::square_root_prior::Prior;
use nalgebra::{DMatrix, DVector};

/// A prior of n coordinates after one measurement more. The measurement is whitened: of
/// variance one, it has the residual `residual` where x is zero and `residual` + `row`·x
/// elsewhere.
///
/// The result has n rows and zeros below the diagonal again. A row may have either sign,
/// together with its number of the offset. Before and after, the prior need not determine all
/// coordinates: it may be zero, and the row may have zeros in any places.
pub fn absorb(prior: Prior, row: DVector<f32>, residual: f32) -> Prior {
    let Prior { mut root, mut offset } = prior;
    // One line more below R x = d, which says row·x = −residual.
    let (mut row, mut number) = (row, -residual);
    for column in 0..row.len() {
        let (c, s) = turning(root[(column, column)], row[column]);
        for index in column..row.len() {
            let both = (root[(column, index)], row[index]);
            (root[(column, index)], row[index]) = turned(both, c, s);
        }
        (offset[column], number) = turned((offset[column], number), c, s);
    }
    Prior { root, offset }
}

/// Cosine and sine of the rotation that leaves nothing in the second number.
fn turning(a: f32, b: f32) -> (f32, f32) {
    if b == 0.0 { (1.0, 0.0) } else { (a / a.hypot(b), b / a.hypot(b)) }
}

fn turned((a, b): (f32, f32), c: f32, s: f32) -> (f32, f32) {
    (c * a + s * b, c * b - s * a)
}

/// The prior of a window that has moved on: what the old prior and the measurements together say
/// of the coordinates that stay, whatever those have been that go.
///
/// `rows` has a column for each coordinate, first those of the old prior in their order, which
/// may be none, and then new ones. A row is a whitened measurement, of the residual r where x
/// is zero and r + `rows` x elsewhere. `gone` are the columns of the coordinates that go, each
/// once, in any order. Those that stay keep their order.
///
/// The result has as many rows as coordinates stay and zeros below the diagonal. Together,
/// prior and rows determine all coordinates; some of them ten thousand times as well as
/// others, and the result should know both kinds to a hundredth of a standard deviation.
pub fn slide(prior: Prior, rows: DMatrix<f32>, residual: DVector<f32>, gone: Vec<usize>) -> Prior {
    let columns = rows.ncols();
    let stays = (0..columns).filter(|column| !gone.contains(column));
    // Whoever goes stands first: below their rows, nothing speaks of them any more.
    let order: Vec<usize> = gone.iter().copied().chain(stays).collect();
    let old = prior.root.clone().resize_horizontally(columns, 0.0);
    let mut all = Prior { root: DMatrix::zeros(columns, columns), offset: DVector::zeros(columns) };
    for (row, number) in old.row_iter().zip(&prior.offset) {
        all = absorb(all, row.transpose().select_rows(&order), -number);
    }
    for (row, number) in rows.row_iter().zip(&residual) {
        all = absorb(all, row.transpose().select_rows(&order), *number);
    }
    let (first, count) = (gone.len(), columns - gone.len());
    Prior {
        root: all.root.view((first, first), (count, count)).into_owned(),
        offset: all.offset.rows(first, count).into_owned(),
    }
}

/// The same prior in coordinates y that are counted from another point, x = `step` + y. The
/// estimate has moved by `step`, and what is known has not.
pub fn seen_from(prior: Prior, step: DVector<f32>) -> Prior {
    let Prior { root, offset } = prior;
    Prior { offset: offset - &root * step, root }
}
