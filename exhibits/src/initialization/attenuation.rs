//! Errors in the path make the scale too small.

use std::sync::LazyLock;

use nalgebra::DVector;

use super::exact::Told;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

const MOTIONS: usize = 20;
const CAMERAS: usize = 14;
const DRAWS: usize = 30_000;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Shrunk); 4] = [
        ("sign", |of| of.beyond / (of.beyond - of.free * of.variance)),
        ("one row", |of| of.beyond / (of.beyond + of.variance)),
        ("all rows", |of| of.beyond / (of.beyond + of.rows * of.variance)),
        ("the whole column", |of| of.column / (of.column + of.free * of.variance)),
    ];
    chapter.equation("attenuation", attenuation, shrunk, &mutants);
}

/// Squares of what the other unknowns cannot imitate of the centres and of the whole column, the rows, those less the
/// other unknowns, and the variance of a centre on each axis.
struct Erring {
    beyond: f64,
    column: f64,
    rows: f64,
    free: f64,
    variance: f64,
}

type Shrunk = fn(&Erring) -> f64;

/// The scale that is found over the true one, in the mean.
fn shrunk(of: &Erring) -> f64 {
    of.beyond / (of.beyond + of.free * of.variance)
}

fn attenuation(formula: Shrunk) -> Comparison {
    static DRAWN: LazyLock<Vec<(Erring, f64)>> = LazyLock::new(|| {
        let mut random = Random::new(71);
        (0..MOTIONS).map(|_| drawn(&mut random)).collect()
    });
    let against = "least squares with errors drawn in the column of centres, in the mean";
    let comparison = Comparison::absolute(against, 0.013, "of the scale");
    comparison.each(DRAWN.iter(), |(of, mean)| (formula(of), *mean))
}

/// What errs, with the mean of the scale that is found over the true one.
fn drawn(random: &mut Random) -> (Erring, f64) {
    let system = Told::drawn(random, CAMERAS).system();
    let rows = system.matrix.nrows();
    // What the nine others can imitate of a column is taken off it.
    let basis = system.matrix.columns(1, 9).into_owned().qr().q();
    let beyond = |column: &DVector<f64>| column - &basis * basis.tr_mul(column);
    let (column, right) = (system.matrix.column(0).into_owned(), beyond(&system.right));
    let square = beyond(&column).norm_squared();
    let scale = beyond(&column).dot(&right) / square;
    let free = (rows - 9) as f64;
    let sigma = (random.logarithmic(0.05..1.0) * square / free).sqrt();
    let draw = |_| {
        let errors = DVector::from_fn(rows, |_, _| random.normal(sigma));
        let erring = beyond(&(&column + errors));
        erring.dot(&right) / (erring.norm_squared() * scale)
    };
    let mean = (0..DRAWS).map(draw).sum::<f64>() / DRAWS as f64;
    let column = column.norm_squared();
    let of = Erring { beyond: square, column, rows: rows as f64, free, variance: sigma * sigma };
    (of, mean)
}
