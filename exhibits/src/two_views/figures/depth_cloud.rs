//! Errors of single triangulated points over range, and the standard deviation they should have.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::Circle;
use plotters::style::Color;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around, letters_right_of};
use crate::two_views::draws::{AtDepth, Draws, rms_error};
use crate::two_views::worked::{point_at, side_by_side};

/// Metres between the cameras.
const BASELINES: [f64; 3] = [0.1, 0.5, 2.0];
/// Metres from the first camera.
const RANGES: [f64; 6] = [1.5, 3.0, 6.0, 12.0, 25.0, 50.0];
/// Single errors that are shown for each baseline.
const DOTS: usize = 130;
const PAIRS: usize = 2000;
const SEED: u64 = 63;

pub fn depth_cloud() -> Figure {
    let places = AtDepth::all(BASELINES, RANGES, (PAIRS, SEED));
    let all = || places.iter().flatten();
    // Draws without a point leave it open.
    let rms = |AtDepth { draws, point, .. }: &AtDepth| {
        (draws.without_point == 0).then(|| rms_error(&draws.likely, point, 2))
    };
    let shown = |rms: f64| format!("{rms:.4}");
    let without_point = all().map(|at| 100.0 * at.draws.share_without_point());
    let columns = vec![
        ("baseline (m)", all().map(|at| at.baseline.to_string()).collect()),
        ("depth (m)", all().map(|at| at.depth.to_string()).collect()),
        ("first-order sigma (m)", decimals(4, all().map(|at| at.sigma))),
        (
            "root mean squared error of draws (m)",
            all().map(|at| rms(at).map_or("open".to_owned(), shown)).collect(),
        ),
        ("draws without a point (%)", decimals(2, without_point)),
    ];
    Figure::new(960, columns, |drawing| {
        let x_axis = ("depth (m)", (1.2..110.0).log_scale(), 3);
        let y_axis = ("depth error (m)", (0.0002..400.0).log_scale(), 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, row) in places.iter().enumerate() {
            let last = &row[RANGES.len() - 1];
            let colour = SERIES[index].mix(0.5).filled();
            let dots = single_errors(last.baseline).into_iter();
            chart.draw_series(dots.map(|place| Circle::new(place, 5, colour)))?;
            chart.line(row.iter().map(|at| (at.depth, at.sigma)), SERIES[index], 5)?;
            chart.marks(row.iter().filter_map(|at| Some((at.depth, rms(at)?))), index)?;
            let name = format!("{} m", last.baseline);
            let beside = (1.15 * last.depth, last.sigma);
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
