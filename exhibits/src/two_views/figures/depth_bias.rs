//! By how much triangulated points lie too far away on average.

use plotters::coord::combinators::IntoLogRange;
use vislam::two_views::depth_bias as formula;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around, letters_right_of};
use crate::two_views::draws::{Draws, mean_error};
use crate::two_views::worked::{depth_sigma_of, point_at, side_by_side};

/// Metres between the cameras.
const BASELINES: [f64; 3] = [0.2, 0.5, 1.0];
/// Metres from the first camera.
const RANGES: [f64; 7] = [2.0, 3.5, 6.0, 10.0, 18.0, 30.0, 50.0];
const PAIRS: usize = 3000;
/// Share of draws without a point up to which the mean of the others is shown.
const MOST_WITHOUT_POINT: f64 = 0.05;
const SEED: u64 = 64;

/// Mean errors in depth at one place, in metres.
struct Mean {
    baseline: f64,
    range: f64,
    by_formula: f64,
    linear: f64,
    likely: f64,
    /// Share of the draws.
    without_point: f64,
}

impl Mean {
    fn of(baseline: f64, range: f64) -> Self {
        let point = point_at(range);
        let draws = Draws::of(&side_by_side(&point, baseline), PAIRS, SEED);
        Self {
            baseline,
            range,
            by_formula: formula(range, depth_sigma_of(baseline, range)),
            linear: mean_error(&draws.linear, &point, 2),
            likely: mean_error(&draws.likely, &point, 2),
            without_point: draws.share_without_point(),
        }
    }
}

pub fn depth_bias() -> Figure {
    let means = BASELINES.map(|baseline| RANGES.map(|range| Mean::of(baseline, range)));
    let all = || means.iter().flatten();
    let relative_sigma = all().map(|m| depth_sigma_of(m.baseline, m.range) / m.range);
    let columns = vec![
        ("baseline (m)", all().map(|m| m.baseline.to_string()).collect()),
        ("depth (m)", all().map(|m| m.range.to_string()).collect()),
        ("sigma over depth", decimals(3, relative_sigma)),
        ("bias by the formula (m)", decimals(4, all().map(|m| m.by_formula))),
        ("mean error of most likely points (m)", decimals(4, all().map(|m| m.likely))),
        ("of linear points (m)", decimals(4, all().map(|m| m.linear))),
        ("draws without a point (%)", decimals(2, all().map(|m| 100.0 * m.without_point))),
    ];
    Figure::new(860, columns, |drawing| {
        let x_axis = ("depth (m)", (1.7..110.0).log_scale(), 3);
        let y_axis = ("mean depth error (m)", (5e-5..90.0).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, means) in means.iter().enumerate() {
            chart.line(means.iter().map(|m| (m.range, m.by_formula)), SERIES[index], 5)?;
            let shown = means.iter().filter(|m| m.without_point < MOST_WITHOUT_POINT);
            chart.marks(shown.map(|m| (m.range, m.likely)), index)?;
            let last = &means[RANGES.len() - 1];
            let beside = (1.12 * last.range, last.by_formula.min(40.0));
            let name = format!("{} m", last.baseline);
            chart.write(&name, beside, letters_right_of(SERIES[index]))?;
        }
        chart.write("baseline", (75.0, 0.15), letters_around(INK))
    })
}
