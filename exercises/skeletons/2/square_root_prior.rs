//! What a window keeps of those who left. Edition 2.
//!
//! `cargo test -p exercises square_root_prior`

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
    let _ = (prior, row, residual);
    todo!("rotations that leave nothing in the new row")
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
    let _ = (prior, rows, residual, gone);
    todo!("what is known of those that stay")
}

/// The same prior in coordinates y that are counted from another point, x = `step` + y. The
/// estimate has moved by `step`, and what is known has not.
pub fn seen_from(prior: Prior, step: DVector<f32>) -> Prior {
    let _ = (prior, step);
    todo!("an offset for another origin")
}
