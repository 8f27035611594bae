//! By how much triangulated points lie too far away on average.

use nalgebra::Vector3;
use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::bearing::{depth_sigma, disparity_sigma};
use vislam::two_views::depth_bias as formula;

use crate::figure::{self, Figure, INK, SERIES, letters_around, letters_right_of, marker};
use crate::two_views::draws::{Draws, mean_error};
use crate::two_views::worked::{CAMERA, POINT, side_by_side};

/// Metres between the cameras.
const BASELINES: [f64; 3] = [0.2, 0.5, 1.0];
/// Metres from the first camera.
const RANGES: [f64; 7] = [2.0, 3.5, 6.0, 10.0, 18.0, 30.0, 50.0];
const PAIRS: usize = 3000;
/// Share of draws without a point up to which the mean of the others is shown.
const MOST_WITHOUT_POINT: f64 = 0.05;
const SEED: u64 = 64;

fn sigma(baseline: f64, range: f64) -> f64 {
    depth_sigma(&CAMERA, baseline, range, disparity_sigma(1.0, 1.0))
}

/// Mean error in depth of linear and of most likely points, and the share of draws without one.
fn means(baseline: f64, range: f64) -> (f64, f64, f64) {
    let point: Vector3<f64> = range / POINT.z * POINT;
    let draws = Draws::of(&side_by_side(&point, baseline), PAIRS, SEED);
    let mean = |points: &[Vector3<f64>]| mean_error(points, &point, 2);
    (mean(&draws.linear), mean(&draws.likely), draws.share_without_point())
}

pub fn depth_bias() -> Figure {
    let means = BASELINES.map(|baseline| RANGES.map(|range| means(baseline, range)));
    let mut rows = Vec::new();
    for (baseline, means) in BASELINES.into_iter().zip(means) {
        for (range, (linear, likely, without)) in RANGES.into_iter().zip(means) {
            rows.push(vec![
                format!("{baseline}"),
                format!("{range}"),
                format!("{:.3}", sigma(baseline, range) / range),
                format!("{:.4}", formula(range, sigma(baseline, range))),
                format!("{likely:.4}"),
                format!("{linear:.4}"),
                format!("{:.2}", 100.0 * without),
            ]);
        }
    }
    Figure {
        columns: vec![
            "baseline (m)",
            "depth (m)",
            "sigma over depth",
            "bias by the formula (m)",
            "mean error of most likely points (m)",
            "of linear points (m)",
            "draws without a point (%)",
        ],
        rows,
        svg: draw(&means),
    }
}

fn draw(means: &[[(f64, f64, f64); RANGES.len()]; BASELINES.len()]) -> String {
    figure::draw(860, |drawing| {
        let x_axis = ("depth (m)", (1.7..110.0).log_scale(), 3);
        let y_axis = ("mean depth error (m)", (5e-5..90.0).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, baseline) in BASELINES.into_iter().enumerate() {
            let line = RANGES.map(|range| (range, formula(range, sigma(baseline, range))));
            chart.draw_series(LineSeries::new(line, SERIES[index].stroke_width(5)))?;
            let marks = RANGES.iter().zip(&means[index]);
            let shown = marks.filter(|(_, mean)| mean.2 < MOST_WITHOUT_POINT);
            chart.draw_series(
                shown.map(|(range, mean)| EmptyElement::at((*range, mean.1)) + marker(index)),
            )?;
            let beside = (1.12 * RANGES[6], line[6].1.min(40.0));
            let name = format!("{baseline} m");
            chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[index]))])?;
        }
        chart.draw_series([Text::new("baseline", (75.0, 0.15), letters_around(INK))])?;
        Ok(())
    })
}
