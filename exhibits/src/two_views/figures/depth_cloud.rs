//! Errors of single triangulated points over range, and the standard deviation they should have.

use nalgebra::Vector3;
use plotters::coord::combinators::IntoLogRange;
use plotters::element::{Circle, EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::bearing::{depth_sigma, disparity_sigma};

use crate::figure::{self, Figure, INK, SERIES, letters_around, letters_right_of, marker};
use crate::two_views::draws::{Draws, rms_error};
use crate::two_views::worked::{CAMERA, POINT, side_by_side};

/// Metres between the cameras.
const BASELINES: [f64; 3] = [0.1, 0.5, 2.0];
/// Metres from the first camera.
const RANGES: [f64; 6] = [1.5, 3.0, 6.0, 12.0, 25.0, 50.0];
/// Single errors that are shown for each baseline.
const DOTS: usize = 130;
const PAIRS: usize = 2000;
const SEED: u64 = 63;

/// First order, with a pixel of noise in both images.
fn sigma(baseline: f64, range: f64) -> f64 {
    depth_sigma(&CAMERA, baseline, range, disparity_sigma(1.0, 1.0))
}

fn drawn(baseline: f64, range: f64) -> (Vector3<f64>, Draws) {
    let point = range / POINT.z * POINT;
    (point, Draws::of(&side_by_side(&point, baseline), PAIRS, SEED))
}

/// Root mean square of the errors in depth, or `None` when draws without a point leave it open.
fn scatter(baseline: f64, range: f64) -> Option<f64> {
    let (point, draws) = drawn(baseline, range);
    (draws.without_point == 0).then(|| rms_error(&draws.likely, &point, 2))
}

pub fn depth_cloud() -> Figure {
    let mut rows = Vec::new();
    for baseline in BASELINES {
        for range in RANGES {
            let (_, draws) = drawn(baseline, range);
            rows.push(vec![
                format!("{baseline}"),
                format!("{range}"),
                format!("{:.4}", sigma(baseline, range)),
                scatter(baseline, range).map_or("open".to_owned(), |rms| format!("{rms:.4}")),
                format!("{:.2}", 100.0 * draws.share_without_point()),
            ]);
        }
    }
    Figure {
        columns: vec![
            "baseline (m)",
            "depth (m)",
            "first-order sigma (m)",
            "root mean squared error of draws (m)",
            "draws without a point (%)",
        ],
        rows,
        svg: draw(),
    }
}

fn draw() -> String {
    figure::draw(960, |drawing| {
        let x_axis = ("depth (m)", (1.2..110.0).log_scale(), 3);
        let y_axis = ("depth error (m)", (0.0002..400.0).log_scale(), 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, baseline) in BASELINES.into_iter().enumerate() {
            let dots = single_errors(baseline);
            chart.draw_series(
                dots.into_iter()
                    .map(|place| Circle::new(place, 5, SERIES[index].mix(0.5).filled())),
            )?;
            let line = RANGES.map(|range| (range, sigma(baseline, range)));
            chart.draw_series(LineSeries::new(line, SERIES[index].stroke_width(5)))?;
            let marks =
                RANGES.iter().filter_map(|range| Some((*range, scatter(baseline, *range)?)));
            chart.draw_series(marks.map(|place| EmptyElement::at(place) + marker(index)))?;
            let beside = (1.15 * RANGES[5], sigma(baseline, RANGES[5]));
            let name = format!("{baseline} m");
            chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[index]))])?;
        }
        chart.draw_series([Text::new("baseline", (78.0, 220.0), letters_around(INK))])?;
        Ok(())
    })
}

/// Errors of one point each, at ranges that fill the axis evenly.
fn single_errors(baseline: f64) -> Vec<(f64, f64)> {
    let places = (0..DOTS).filter_map(|index| {
        let share = index as f64 / DOTS as f64;
        let range = RANGES[0] * (RANGES[5] / RANGES[0]).powf(share);
        let point = range / POINT.z * POINT;
        let draws = Draws::of(&side_by_side(&point, baseline), 1, SEED + index as u64);
        let error = (draws.likely.first()?.z - range).abs();
        (2.5e-4..350.0).contains(&error).then_some((range, error))
    });
    places.collect()
}
