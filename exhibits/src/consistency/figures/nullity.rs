//! How many directions the rows of a filter leave free, picture by picture.

use nalgebra::DMatrix;
use vislam::consistency::Chart;

use crate::consistency::small::{Case, Points};
use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, powers};
use crate::random::Random;

const PICTURES: usize = 7;
/// From so many pictures on, they have as many rows as there are directions.
const FIRST: usize = 3;
/// So many of the smallest singular values are shown.
const SHOWN: usize = 6;
const SEED: u64 = 3;
/// All that is below this is shown here, and the axis begins lower, so that no mark lies on its numbers.
const LEAST: f64 = -18.0;
const AXIS: f64 = -20.0;

const CASES: [(&str, Case); 2] = [
    ("first estimates", Case { chart: Chart::Separate, points: Points::First, known: false }),
    ("latest estimates", Case { chart: Chart::Separate, points: Points::Latest, known: false }),
];

/// The smallest singular values of all rows until each picture over the largest, ascending. The errors at the
/// beginning are taken in their standard deviations.
fn spectra(case: Case) -> Vec<Vec<f64>> {
    let filter = case.flown(PICTURES, &mut Random::new(SEED));
    let until = |pictures: usize| {
        let rows: Vec<_> =
            filter.seen[..pictures].iter().flat_map(|rows| rows.row_iter()).collect();
        let values = (DMatrix::from_rows(&rows) * filter.start()).singular_values();
        let mut values: Vec<f64> = values.iter().map(|value| value / values.max()).collect();
        values.sort_by(f64::total_cmp);
        values.truncate(SHOWN);
        values
    };
    (FIRST..=PICTURES).map(until).collect()
}

fn panel(drawing: &Drawing, series: usize, spectra: &[Vec<f64>], x_title: &str) -> Drawn {
    let (name, _) = CASES[series];
    let x_axis = (x_title, FIRST as f64 - 0.5..PICTURES as f64 + 0.5, PICTURES + 1 - FIRST);
    let mut chart = figure::axes(drawing, x_axis, ("power of ten", AXIS..2.0, 5))?;
    for index in 0..SHOWN {
        let points = spectra
            .iter()
            .enumerate()
            .map(|(number, values)| ((FIRST + number) as f64, values[index].log10().max(LEAST)));
        let points: Vec<_> = points.collect();
        chart.line(points.clone(), SERIES[series], 3)?;
        chart.marks(points, series)?;
    }
    let zeros = spectra.iter().map(|values| values.iter().filter(|value| **value < 1e-12).count());
    for (number, zeros) in zeros.enumerate() {
        let at = ((FIRST + number) as f64 + 0.08, -12.5);
        chart.write(&format!("{zeros}"), at, letters_right_of(INK))?;
    }
    chart.write(name, (FIRST as f64 - 0.4, 1.0), letters_right_of(SERIES[series]))?;
    Ok(())
}

pub fn nullity() -> Figure {
    let spectra = CASES.map(|(_, case)| spectra(case));
    let each = || {
        CASES.iter().zip(&spectra).flat_map(|((name, _), of)| {
            of.iter().enumerate().map(move |(number, values)| (name, FIRST + number, values))
        })
    };
    let value = |index: usize| powers(0, each().map(|(.., values)| values[index]));
    let columns = vec![
        ("derivatives at", each().map(|(name, ..)| (*name).to_owned()).collect()),
        ("pictures", each().map(|(_, pictures, _)| pictures.to_string()).collect()),
        ("smallest singular value, over the largest", value(0)),
        ("second", value(1)),
        ("third", value(2)),
        ("fourth", value(3)),
        ("fifth", value(4)),
        ("sixth", value(5)),
    ];
    Figure::new(1400, columns, |drawing| {
        let halves = drawing.split_evenly((2, 1));
        panel(&halves[0], 0, &spectra[0], "")?;
        panel(&halves[1], 1, &spectra[1], "pictures")
    })
}
