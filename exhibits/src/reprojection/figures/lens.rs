//! What a real lens does to a square grid, and where a model of it folds over.

use std::ops::Range;

use nalgebra::Vector2;
use plotters::element::{Circle, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::reprojection::RadialTangential;

use crate::figure::{
    self, Drawing, Drawn, Figure, GRID, INK, SERIES, letters_around, letters_right_of,
};
use crate::reprojection::worked::{EUROC_SIZE, euroc, one_coefficient};

/// The part of the image plane that is drawn, in pixels.
const COLUMNS_DRAWN: Range<f64> = -60.0..812.0;
const ROWS_DRAWN: Range<f64> = -70.0..565.0;

/// Lines of the grid to each side of the middle, and between them the distance in the ideal plane.
const COLUMNS: i32 = 8;
const ROWS: i32 = 5;
const SPACING: f64 = 0.15;
const GRID_WIDTH: f64 = SPACING * COLUMNS as f64;
const GRID_HEIGHT: f64 = SPACING * ROWS as f64;

/// Largest radius of an ideal point that is drawn.
const LARGEST: f64 = 1.6;

pub fn lens() -> Figure {
    let rows = (0..=16).map(|tenth| {
        let radius = f64::from(tenth) / 10.0;
        let shown = |lens: &RadialTangential| lens.distort(&Vector2::new(radius, 0.0)).norm();
        vec![
            format!("{radius:.1}"),
            format!("{:.4}", shown(&euroc().lens)),
            format!("{:.4}", shown(&one_coefficient())),
        ]
    });
    Figure {
        columns: vec![
            "ideal radius",
            "radius shown by the EuRoC lens",
            "radius shown by its first coefficient alone",
        ],
        rows: rows.collect(),
        svg: figure::draw(1540, |drawing| {
            let (above, below) = drawing.split_vertically(880);
            bent_grid(&above)?;
            folded_radius(&below)
        }),
    }
}

/// A grid of straight lines in the world, as the pinhole and as the lens show it.
fn bent_grid(drawing: &Drawing) -> Drawn {
    let camera = euroc();
    let pinhole = camera.pinhole;
    let x_axis = ("u (px)", COLUMNS_DRAWN, 5);
    let mut chart = figure::axes(drawing, x_axis, ("v (px)", ROWS_DRAWN.end..ROWS_DRAWN.start, 5))?;
    let (width, height) = EUROC_SIZE;
    let border = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0)];
    chart.draw_series([PathElement::new(border, INK.stroke_width(4))])?;
    let pixel = |x: f64, y: f64| (pinhole.fx * x + pinhole.cx, pinhole.fy * y + pinhole.cy);
    let bent = |x: f64, y: f64| {
        let shown = camera.lens.distort(&Vector2::new(x, y));
        pixel(shown.x, shown.y)
    };
    let fractions = || (0..=60).map(|step| f64::from(step) / 30.0 - 1.0);
    for column in -COLUMNS..=COLUMNS {
        let x = SPACING * f64::from(column);
        let line: Vec<_> = fractions().map(|along| bent(x, GRID_HEIGHT * along)).collect();
        chart.draw_series([PathElement::new(line, SERIES[0].stroke_width(4))])?;
    }
    for row in -ROWS..=ROWS {
        let y = SPACING * f64::from(row);
        let line: Vec<_> = fractions().map(|along| bent(GRID_WIDTH * along, y)).collect();
        chart.draw_series([PathElement::new(line, SERIES[0].stroke_width(4))])?;
        for column in -COLUMNS..=COLUMNS {
            let (u, v) = pixel(SPACING * f64::from(column), y);
            if (COLUMNS_DRAWN.contains(&u)) && (ROWS_DRAWN.contains(&v)) {
                let way = [(u, v), bent(SPACING * f64::from(column), y)];
                chart.draw_series([PathElement::new(way, SERIES[1].stroke_width(4))])?;
                chart.draw_series([Circle::new(way[0], 7, SERIES[1].filled())])?;
            }
        }
    }
    Ok(())
}

fn folded_radius(drawing: &Drawing) -> Drawn {
    let x_axis = ("ideal radius", 0.0..LARGEST, 8);
    let mut chart = figure::axes(drawing, x_axis, ("shown radius", 0.0..1.25, 5))?;
    let series = [
        (euroc().lens, SERIES[0], "EuRoC, k1 and k2", (1.2, 0.83)),
        (one_coefficient(), SERIES[1], "k1 alone", (1.18, 0.56)),
    ];
    let end = 1.25;
    chart.draw_series([PathElement::new([(0.0, 0.0), (end, end)], GRID.stroke_width(4))])?;
    chart.draw_series([Text::new("no lens", (0.5, 0.72), letters_around(INK))])?;
    for (lens, colour, name, place) in series {
        let curve = (0..=80).map(|step| {
            let radius = LARGEST * f64::from(step) / 80.0;
            (radius, lens.distort(&Vector2::new(radius, 0.0)).x)
        });
        chart.draw_series(LineSeries::new(curve, colour.stroke_width(5)))?;
        chart.draw_series([Text::new(name, place, letters_right_of(colour))])?;
    }
    let fold = one_coefficient().monotonic_radius();
    let top = (fold, one_coefficient().distort(&Vector2::new(fold, 0.0)).x);
    let upright = [(fold, 0.0), top];
    chart.draw_series([PathElement::new(upright, SERIES[1].stroke_width(3))])?;
    chart.draw_series([Circle::new(top, 13, SERIES[1].filled())])?;
    chart.draw_series([Text::new("fold", (fold - 0.1, 0.12), letters_around(SERIES[1]))])?;
    Ok(())
}
