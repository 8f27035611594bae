//! Points on one ray: the first camera sees one pixel, the second sees as many pixels as there are
//! points.

use nalgebra::Vector3;
use plotters::element::{Circle, EmptyElement, PathElement, Polygon, Rectangle, Text};
use plotters::style::Color;

use crate::bearing::worked::{BASELINE, CAMERA, POINT, second_from_first};
use crate::figure::{self, Drawing, Drawn, ESTIMATED, Figure, INK, MEASURED, letters_around};

const DEPTHS: [f64; 4] = [2.5, 3.5, 5.0, 8.0];

pub fn rays() -> Figure {
    let points = DEPTHS.map(|depth| (depth / POINT.z) * POINT);
    let rows = points.iter().map(|point| {
        let (first, second) = (column_seen(0.0, point), column_seen(BASELINE, point));
        vec![
            format!("{:.1}", point.z),
            format!("{:.2}", point.x),
            format!("{first:.1}"),
            format!("{second:.1}"),
        ]
    });
    Figure {
        columns: vec!["depth z (m)", "x (m)", "u in image 0 (px)", "u in image 1 (px)"],
        rows: rows.collect(),
        svg: figure::draw(1040, |drawing| {
            let (above, below) = drawing.split_vertically(680);
            from_above(&above, &points)?;
            both_images(&below, &points)
        }),
    }
}

fn column_seen(baseline: f64, point: &Vector3<f64>) -> f64 {
    let pixel = CAMERA.project(&second_from_first(baseline), point);
    pixel.map_or(f64::NAN, |pixel| pixel.x)
}

fn from_above(drawing: &Drawing, points: &[Vector3<f64>]) -> Drawn {
    let x_axis = ("depth z (m)", -0.4..9.4, 10);
    let mut chart = figure::axes(drawing, x_axis, ("x (m)", -0.13..0.63, 5))?;
    for point in points {
        let ray = vec![(0.0, BASELINE), (point.z, point.x)];
        chart.draw_series([PathElement::new(ray, ESTIMATED.stroke_width(3))])?;
    }
    let end = (9.0 / POINT.z) * POINT;
    let ray = vec![(0.0, 0.0), (end.z, end.x)];
    chart.draw_series([PathElement::new(ray, MEASURED.stroke_width(6))])?;
    for point in points {
        let place = (point.z, point.x);
        chart.draw_series([Circle::new(place, 14, ESTIMATED.filled())])?;
        let below = (point.z + 0.1, point.x - 0.06);
        let depth = format!("{} m", point.z);
        chart.draw_series([Text::new(depth, below, letters_around(ESTIMATED))])?;
    }
    for (name, x) in [("camera 0", 0.0), ("camera 1", BASELINE)] {
        let body = Polygon::new(vec![(-26, -20), (-26, 20), (10, 0)], INK.filled());
        chart.draw_series([EmptyElement::at((0.0, x)) + body])?;
        let beside = (0.55, x + if x > 0.0 { 0.06 } else { -0.06 });
        chart.draw_series([Text::new(name, beside, letters_around(INK))])?;
    }
    Ok(())
}

fn both_images(drawing: &Drawing, points: &[Vector3<f64>]) -> Drawn {
    let x_axis = ("column u (px)", 225.0..355.0, 7);
    let mut chart = figure::axes(drawing, x_axis, ("", -0.6..2.1, 0))?;
    let (row_of_first, row_of_second) = (1.3, 0.0);
    for (name, row) in [("image 0", row_of_first), ("image 1", row_of_second)] {
        chart.draw_series([Text::new(name, (234.0, row), letters_around(INK))])?;
    }
    for point in points {
        let place = (column_seen(BASELINE, point), row_of_second);
        chart.draw_series([Circle::new(place, 14, ESTIMATED.filled())])?;
        let above = (place.0, place.1 + 0.55);
        let depth = format!("{} m", point.z);
        chart.draw_series([Text::new(depth, above, letters_around(ESTIMATED))])?;
    }
    let place = (column_seen(0.0, &POINT), row_of_first);
    let pixel = Rectangle::new([(-15, -15), (15, 15)], MEASURED.filled());
    chart.draw_series([EmptyElement::at(place) + pixel])?;
    let beside = (place.0 - 21.0, place.1);
    chart.draw_series([Text::new("all of them", beside, letters_around(MEASURED))])?;
    Ok(())
}
