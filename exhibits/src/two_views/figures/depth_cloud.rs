//! Errors of single triangulated points over range, and the standard deviation they should have.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::Circle;
use plotters::style::Color;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around, letters_right_of};
use crate::two_views::draws::{Draws, rms_error};
use crate::two_views::worked::{depth_sigma_of, point_at, side_by_side};

/// Metres between the cameras.
const BASELINES: [f64; 3] = [0.1, 0.5, 2.0];
/// Metres from the first camera.
const RANGES: [f64; 6] = [1.5, 3.0, 6.0, 12.0, 25.0, 50.0];
/// Single errors that are shown for each baseline.
const DOTS: usize = 130;
const PAIRS: usize = 2000;
const SEED: u64 = 63;

/// Errors in depth at one place.
struct Scatter {
    baseline: f64,
    range: f64,
    /// To first order, in metres.
    sigma: f64,
    /// Root mean square in metres, or `None` when draws without a point leave it open.
    rms: Option<f64>,
    /// Share of the draws.
    without_point: f64,
}

impl Scatter {
    fn of(baseline: f64, range: f64) -> Self {
        let point = point_at(range);
        let draws = Draws::of(&side_by_side(&point, baseline), PAIRS, SEED);
        Self {
            baseline,
            range,
            sigma: depth_sigma_of(baseline, range),
            rms: (draws.without_point == 0).then(|| rms_error(&draws.likely, &point, 2)),
            without_point: draws.share_without_point(),
        }
    }
}

pub fn depth_cloud() -> Figure {
    let scatters = BASELINES.map(|baseline| RANGES.map(|range| Scatter::of(baseline, range)));
    let all = || scatters.iter().flatten();
    let rms = all().map(|s| s.rms.map_or("open".to_owned(), |rms| format!("{rms:.4}")));
    let columns = vec![
        ("baseline (m)", all().map(|s| s.baseline.to_string()).collect()),
        ("depth (m)", all().map(|s| s.range.to_string()).collect()),
        ("first-order sigma (m)", decimals(4, all().map(|s| s.sigma))),
        ("root mean squared error of draws (m)", rms.collect()),
        ("draws without a point (%)", decimals(2, all().map(|s| 100.0 * s.without_point))),
    ];
    Figure::new(960, columns, |drawing| {
        let x_axis = ("depth (m)", (1.2..110.0).log_scale(), 3);
        let y_axis = ("depth error (m)", (0.0002..400.0).log_scale(), 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, scatters) in scatters.iter().enumerate() {
            let last = &scatters[RANGES.len() - 1];
            let colour = SERIES[index].mix(0.5).filled();
            let dots = single_errors(last.baseline).into_iter();
            chart.draw_series(dots.map(|place| Circle::new(place, 5, colour)))?;
            chart.line(scatters.iter().map(|s| (s.range, s.sigma)), SERIES[index], 5)?;
            chart.marks(scatters.iter().filter_map(|s| Some((s.range, s.rms?))), index)?;
            let name = format!("{} m", last.baseline);
            let beside = (1.15 * last.range, last.sigma);
            chart.write(&name, beside, letters_right_of(SERIES[index]))?;
        }
        chart.write("baseline", (78.0, 220.0), letters_around(INK))
    })
}

/// Errors of one point each, at ranges that fill the axis evenly.
fn single_errors(baseline: f64) -> Vec<(f64, f64)> {
    let places = (0..DOTS).filter_map(|index| {
        let share = index as f64 / DOTS as f64;
        let range = RANGES[0] * (RANGES[5] / RANGES[0]).powf(share);
        let draws = Draws::of(&side_by_side(&point_at(range), baseline), 1, SEED + index as u64);
        let error = (draws.likely.first()?.z - range).abs();
        (2.5e-4..350.0).contains(&error).then_some((range, error))
    });
    places.collect()
}
