//! By how much triangulated points lie too far away on average.

use plotters::coord::combinators::IntoLogRange;
use vislam::two_views::depth_bias as formula;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around, letters_right_of};
use crate::two_views::draws::{AtDepth, mean_error};

/// Metres between the cameras.
const BASELINES: [f64; 3] = [0.2, 0.5, 1.0];
/// Metres from the first camera.
const RANGES: [f64; 7] = [2.0, 3.5, 6.0, 10.0, 18.0, 30.0, 50.0];
const PAIRS: usize = 3000;
/// Share of draws without a point up to which the mean of the others is shown.
const MOST_WITHOUT_POINT: f64 = 0.05;
const SEED: u64 = 64;

pub fn depth_bias() -> Figure {
    let places = AtDepth::all(BASELINES, RANGES, (PAIRS, SEED));
    let all = || places.iter().flatten();
    let bias = |at: &AtDepth| formula(at.depth, at.sigma);
    let likely = |at: &AtDepth| mean_error(&at.draws.likely, &at.point, 2);
    let linear = |at: &AtDepth| mean_error(&at.draws.linear, &at.point, 2);
    let without_point = all().map(|at| 100.0 * at.draws.share_without_point());
    let columns = vec![
        ("baseline (m)", all().map(|at| at.baseline.to_string()).collect()),
        ("depth (m)", all().map(|at| at.depth.to_string()).collect()),
        ("sigma over depth", decimals(3, all().map(|at| at.sigma / at.depth))),
        ("bias by the formula (m)", decimals(4, all().map(bias))),
        ("mean error of most likely points (m)", decimals(4, all().map(likely))),
        ("of linear points (m)", decimals(4, all().map(linear))),
        ("draws without a point (%)", decimals(2, without_point)),
    ];
    Figure::new(860, columns, |drawing| {
        let x_axis = ("depth (m)", (1.7..110.0).log_scale(), 3);
        let y_axis = ("mean depth error (m)", (5e-5..90.0).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, row) in places.iter().enumerate() {
            chart.line(row.iter().map(|at| (at.depth, bias(at))), SERIES[index], 5)?;
            let shown = row.iter().filter(|at| at.draws.share_without_point() < MOST_WITHOUT_POINT);
            chart.marks(shown.map(|at| (at.depth, likely(at))), index)?;
            let last = &row[RANGES.len() - 1];
            let name = format!("{} m", last.baseline);
            let beside = (1.12 * last.depth, bias(last).min(40.0));
            chart.write(&name, beside, letters_right_of(SERIES[index]))?;
        }
        chart.write("baseline", (75.0, 0.15), letters_around(INK))
    })
}
