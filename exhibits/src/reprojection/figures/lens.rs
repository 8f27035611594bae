//! What a real lens does to a square grid, and where a model of it folds over.

use nalgebra::Vector2;
use plotters::element::{Circle, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::reprojection::RadialTangential;

use crate::figure::{
    self, Drawing, Drawn, Figure, GRID, INK, SERIES, letters_around, letters_right_of,
};
use crate::reprojection::worked::{EUROC_SIZE, euroc, one_coefficient};

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
        svg: figure::draw(1500, |drawing| {
            let (above, below) = drawing.split_vertically(840);
            bent_grid(&above)?;
            folded_radius(&below)
        }),
    }
}

/// A grid of straight lines in the world, as the pinhole and as the lens show it.
fn bent_grid(drawing: &Drawing) -> Drawn {
    let camera = euroc();
    let pinhole = camera.pinhole;
    let x_axis = ("u (px)", -60.0..812.0, 5);
    let mut chart = figure::axes(drawing, x_axis, ("v (px)", 520.0..-40.0, 5))?;
    let (width, height) = EUROC_SIZE;
    let border = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0)];
    chart.draw_series([PathElement::new(border, INK.stroke_width(4))])?;
    let pixel = |x: f64, y: f64| (pinhole.fx * x + pinhole.cx, pinhole.fy * y + pinhole.cy);
    let inside = |(u, v): &(f64, f64)| (-60.0..=812.0).contains(u) && (-40.0..=520.0).contains(v);
    for line in -8..=8 {
        let across = f64::from(line) * 0.15;
        for upright in [false, true] {
            let along = (-60..=60).map(|step| f64::from(step) * 0.02);
            let places = along.map(|along| if upright { (across, along) } else { (along, across) });
            let places: Vec<_> = places.collect();
            let ideal: Vec<_> = places.iter().map(|&(x, y)| pixel(x, y)).filter(inside).collect();
            let shown = places.iter().map(|&(x, y)| {
                let bent = camera.lens.distort(&Vector2::new(x, y));
                pixel(bent.x, bent.y)
            });
            let shown: Vec<_> = shown.filter(inside).collect();
            chart.draw_series([PathElement::new(ideal, GRID.stroke_width(3))])?;
            chart.draw_series([PathElement::new(shown, SERIES[0].stroke_width(4))])?;
        }
    }
    let centre = (pinhole.cx, pinhole.cy);
    chart.draw_series([Circle::new(centre, 9, INK.filled())])?;
    Ok(())
}

fn folded_radius(drawing: &Drawing) -> Drawn {
    let x_axis = ("ideal radius", 0.0..LARGEST, 8);
    let mut chart = figure::axes(drawing, x_axis, ("shown radius", 0.0..1.25, 5))?;
    let series = [
        (euroc().lens, SERIES[0], "EuRoC, k1 and k2", (0.95, 1.0)),
        (one_coefficient(), SERIES[1], "k1 alone", (1.3, 0.53)),
    ];
    let end = 1.25;
    chart.draw_series([PathElement::new([(0.0, 0.0), (end, end)], GRID.stroke_width(4))])?;
    chart.draw_series([Text::new("no lens", (0.72, 0.95), letters_around(INK))])?;
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
