//! The figures of the chapter.

use nalgebra::{Isometry3, Rotation3, Vector2, Vector3};
use plotters::element::{Circle, PathElement, Polygon, Rectangle, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::bearing::{
    back_project, depth_sigma, inverse_depth_sigma, stretch_shift, turned_pixel,
};

use super::worked::{BASELINE, CAMERA, POINT, second_from_first};
use crate::chapter::Chapter;
use crate::figure::{self, Drawing, Drawn, ESTIMATED, Figure, GRID, GROUND, INK, MEASURED, SERIES};

/// Registers the figures.
pub fn figures(chapter: &mut Chapter) {
    chapter.figure("rays", rays);
}

/// Points that the first camera cannot tell apart, by their depth in metres.
const DEPTHS: [f64; 4] = [2.5, 3.5, 5.0, 8.0];

fn rays() -> Figure {
    let points = DEPTHS.map(|depth| (depth / POINT.z) * POINT);
    let rows = points.iter().map(|point| {
        let first = column_in(0.0, point);
        let second = column_in(BASELINE, point);
        vec![
            format!("{}", point.z),
            format!("{:.2}", point.x),
            format!("{first:.1}"),
            format!("{second:.1}"),
        ]
    });
    Figure {
        columns: vec![
            "depth (m)",
            "x (m)",
            "u in the first image (px)",
            "u in the second image (px)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1040, |drawing| {
            let (above, below) = drawing.split_vertically(700);
            seen_from_above(&above, &points)?;
            both_images(&below, &points)
        }),
    }
}

fn column_in(baseline: f64, point: &Vector3<f64>) -> f64 {
    CAMERA
        .project(&second_from_first(baseline), point)
        .map_or(f64::NAN, |pixel| pixel.x)
}

fn seen_from_above(drawing: &Drawing, points: &[Vector3<f64>]) -> Drawn {
    let mut chart = figure::axes(
        drawing,
        ("depth z (m)", -0.3..9.2, 10),
        ("x (m)", -0.1..0.65, 6),
    )?;
    let end = (9.0 / POINT.z) * POINT;
    for point in points {
        chart.draw_series([PathElement::new(
            vec![(0.0, BASELINE), (point.z, point.x)],
            ESTIMATED.stroke_width(3),
        )])?;
    }
    chart.draw_series([PathElement::new(
        vec![(0.0, 0.0), (end.z, end.x)],
        MEASURED.stroke_width(5),
    )])?;
    for point in points {
        chart.draw_series([Circle::new((point.z, point.x), 13, ESTIMATED.filled())])?;
    }
    Ok(())
}

fn both_images(drawing: &Drawing, points: &[Vector3<f64>]) -> Drawn {
    let mut chart = figure::axes(
        drawing,
        ("column u (px)", 230.0..350.0, 7),
        ("", -0.6..1.6, 0),
    )?;
    for point in points {
        let first = column_in(0.0, point);
        let second = column_in(BASELINE, point);
        chart.draw_series([Circle::new((first, 1.0), 13, MEASURED.filled())])?;
        chart.draw_series([Circle::new((second, 0.0), 13, ESTIMATED.filled())])?;
    }
    Ok(())
}
