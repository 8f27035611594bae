//! Digits that formulas lose at small angles and near a half turn.

use crate::figure::{
    self, Column, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_right_of,
};
use crate::manifold::accuracy::{errors_near, errors_near_half_turn};

/// Decimal logarithms of the angles and of their distances from π.
fn exponents() -> impl Iterator<Item = f64> + Clone {
    (0..=64).map(|k| -16.0 + 0.25 * f64::from(k))
}

/// How a curve is drawn: its name and where that stands, and its series or none for the library.
type Curve = (&'static str, (f64, f64), Option<usize>);

/// In the order of [`errors_near`].
const SMALL: [Curve; 6] = [
    ("angle", (-5.2, -3.6), Some(0)),
    ("Jacobian", (-13.6, -10.4), Some(1)),
    ("corner Q", (-15.2, -5.4), Some(2)),
    ("log", (-9.6, -1.0), Some(3)),
    ("exp", (-6.6, -17.1), Some(4)),
    ("the library", (-7.3, -14.4), None),
];

/// In the order of [`errors_near_half_turn`].
const HALF: [Curve; 2] = [("log", (-4.6, -5.0), Some(3)), ("the library", (-14.0, -14.3), None)];

pub fn accuracy() -> Figure {
    let (small, half) = (sizes(errors_near), sizes(errors_near_half_turn));
    let cells = |sizes: &[f64]| decimals(1, sizes.iter().step_by(4).copied());
    let names = [
        "error of the textbook's angle as a power of ten",
        "of its Jacobian",
        "of its corner Q",
        "of its log",
        "of its exp",
        "of the library",
        "of the textbook's log as far from a half turn",
        "of the library's there",
    ];
    let angles = ("angle (rad) as a power of ten", decimals(0, exponents().step_by(4)));
    let errors = small.iter().chain(&half).map(|sizes| cells(sizes));
    let columns = [angles].into_iter().chain(names.into_iter().zip(errors));
    Figure::new(1520, columns.collect::<Vec<Column>>(), |drawing| {
        let (above, below) = drawing.split_vertically(860);
        panel(&above, "angle (rad), power of ten", &SMALL, &small)?;
        panel(&below, "distance from a half turn (rad), power of ten", &HALF, &half)
    })
}

/// The decimal logarithms of errors over the exponents; no error at all is drawn below the rounding
/// error.
fn sizes<const N: usize>(errors: fn(f64) -> [f64; N]) -> [Vec<f64>; N] {
    let errors: Vec<_> = exponents().map(|exponent| errors(10_f64.powf(exponent))).collect();
    std::array::from_fn(|k| errors.iter().map(|errors| errors[k].max(1e-17).log10()).collect())
}

fn panel(drawing: &Drawing, title: &str, curves: &[Curve], sizes: &[Vec<f64>]) -> Drawn {
    let y_axis = ("error, power of ten", -17.9..1.0, 6);
    let mut chart = figure::axes(drawing, (title, -16.4..0.9, 8), y_axis)?;
    for ((name, name_at, series), sizes) in curves.iter().zip(sizes) {
        let colour = series.map_or(INK, |index| SERIES[index]);
        let places = exponents().zip(sizes.iter().copied());
        chart.line(places.clone(), colour, 5)?;
        if let Some(index) = *series {
            chart.marks(places.skip(2 * index).step_by(8), index)?;
        }
        chart.write(name, *name_at, letters_right_of(colour))?;
    }
    Ok(())
}
