//! The smallest eigenvalues of the reduced system, with one camera and with two.

use plotters::coord::combinators::IntoLogRange;

use crate::bundle_adjustment::stereo::{BASELINE, eigenvalues};
use crate::figure::{self, Draw, Drawing, Drawn, Figure, GRID, INK, SERIES, letters_right_of};

const SHOWN: usize = 10;
/// What is below this is rounding, and all of it is shown on one level.
const ROUNDING: f64 = 1e-13;
const LEVEL: f64 = -15.0;
const CASES: [(&str, Option<f64>, bool); 4] = [
    ("one camera, free", None, false),
    ("stereo, free", Some(BASELINE), false),
    ("one camera, pinned", None, true),
    ("stereo, pinned", Some(BASELINE), true),
];
/// Metres.
const BASELINES: [f64; 7] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0];

pub fn stereo() -> Figure {
    let cases = CASES.map(|(_, baseline, pinned)| eigenvalues(baseline, pinned));
    let by_baseline = BASELINES.map(|baseline| eigenvalues(Some(baseline), true));
    let longer = BASELINES.map(|baseline| (CASES[3].0, Some(baseline)));
    let named = CASES.map(|(name, baseline, _)| (name, baseline)).into_iter().chain(longer);
    let shown = cases.iter().map(|values| &values[..SHOWN]);
    let shown = shown.chain(by_baseline.iter().map(|values| &values[..2]));
    let rows: Vec<_> = named
        .zip(shown)
        .flat_map(|(named, values)| {
            values.iter().enumerate().map(move |(index, value)| (named, index + 1, *value))
        })
        .collect();
    let text = |value: f64| {
        if value < ROUNDING { "below 1e-13".to_owned() } else { format!("{value:.2e}") }
    };
    let metres = |baseline: Option<f64>| baseline.map_or("none".to_owned(), |b| b.to_string());
    let columns = vec![
        ("case", rows.iter().map(|row| row.0.0.replace(',', ":")).collect()),
        ("baseline (m)", rows.iter().map(|row| metres(row.0.1)).collect()),
        ("which eigenvalue", rows.iter().map(|row| row.1.to_string()).collect()),
        ("its value", rows.iter().map(|row| text(row.2)).collect()),
    ];
    Figure::new(1500, columns, |drawing| {
        let (above, below) = drawing.split_vertically(880);
        spectra(&above, &cases)?;
        over_baseline(&below, &by_baseline)
    })
}

fn spectra(drawing: &Drawing, cases: &[Vec<f64>; 4]) -> Drawn {
    let x_axis = ("which eigenvalue, from the smallest", 0.4..10.6, 10);
    let y_axis = ("log\u{2081}\u{2080} of eigenvalue", -15.8..2.8, 6);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    chart.line([(0.4, -14.0), (10.6, -14.0)], GRID, 4)?;
    for (index, values) in cases.iter().enumerate() {
        let places = values.iter().take(SHOWN).enumerate().map(|(order, value)| {
            // Marks of one place stand side by side.
            let aside = 0.16 * (index as f64 - 1.5);
            let height = if *value < ROUNDING { LEVEL } else { value.log10() };
            (order as f64 + 1.0 + aside, height)
        });
        chart.marks(places, index)?;
        let (x, y) = (5.5 * (index % 2) as f64 + 0.8, if index < 2 { 2.0 } else { 0.6 });
        chart.key(index, CASES[index].0, (x, y), x + 0.25)?;
    }
    chart.write("rounding", (8.2, -14.6), letters_right_of(INK))
}

fn over_baseline(drawing: &Drawing, values: &[Vec<f64>; BASELINES.len()]) -> Drawn {
    let x_axis = ("baseline (m)", (7e-4..1.4).log_scale(), 4);
    let y_axis = ("log\u{2081}\u{2080} of eigenvalue", -8.0..0.0, 5);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    for (order, series, name, above) in [(0, 3, "smallest", 1.0), (1, 4, "next", 0.6)] {
        let heights = values.each_ref().map(|values| values[order].log10());
        chart.line(BASELINES.into_iter().zip(heights), SERIES[series], 4)?;
        chart.marks(BASELINES.into_iter().zip(heights), series)?;
        let beside = (BASELINES[1] * 0.9, heights[1] + above);
        chart.write(name, beside, letters_right_of(SERIES[series]))?;
    }
    Ok(())
}
