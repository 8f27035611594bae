//! What a window keeps of those who left: a triangle of rows, made by rotations.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: prior
/// What is known of n coordinates x: the density exp(−½ ‖R x − d‖²), up to a factor. **d is
/// subtracted**; so R x = d is where the density is greatest.
///
/// All numbers are of single precision.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Prior {
    /// R, n×n, with zeros below the diagonal. A row of zeros says nothing.
    pub root: DMatrix<f32>,
    /// d.
    pub offset: DVector<f32>,
}
// ANCHOR_END: prior

crate::signatures! {
    // ANCHOR: absorb
    /// A prior of n coordinates after one measurement more. The measurement is whitened: of
    /// variance one, it has the residual `residual` where x is zero and `residual` + `row`·x
    /// elsewhere.
    ///
    /// The result has n rows and zeros below the diagonal again. A row may have either sign,
    /// together with its number of the offset. Before and after, the prior need not determine all
    /// coordinates: it may be zero, and the row may have zeros in any places.
    fn absorb(prior: Prior, row: DVector<f32>, residual: f32) -> Prior;
    // ANCHOR_END: absorb

    // ANCHOR: slide
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
    fn slide(
        prior: Prior,
        rows: DMatrix<f32>,
        residual: DVector<f32>,
        gone: Vec<usize>,
    ) -> Prior;
    // ANCHOR_END: slide

    // ANCHOR: seen_from
    /// The same prior in coordinates y that are counted from another point, x = `step` + y. The
    /// estimate has moved by `step`, and what is known has not.
    fn seen_from(prior: Prior, step: DVector<f32>) -> Prior;
    // ANCHOR_END: seen_from
}
