//! Points on one ray: the first camera sees one pixel, the second sees as many pixels as there are
//! points.

use nalgebra::Vector3;
use plotters::element::{EmptyElement, Polygon, Rectangle};
use plotters::style::Color;

use crate::bearing::worked::{BASELINE, CAMERA, POINT, second_from_first};
use crate::figure::{
    self, Draw, Drawing, Drawn, ESTIMATED, Figure, INK, MEASURED, decimals, letters_around,
};

const DEPTHS: [f64; 4] = [2.5, 3.5, 5.0, 8.0];

pub fn rays() -> Figure {
    let points = DEPTHS.map(|depth| (depth / POINT.z) * POINT);
    let columns = vec![
        ("depth z (m)", decimals(1, points.map(|point| point.z))),
        ("x (m)", decimals(2, points.map(|point| point.x))),
        ("u in image 0 (px)", decimals(1, points.map(|point| column_seen(0.0, &point)))),
        ("u in image 1 (px)", decimals(1, points.map(|point| column_seen(BASELINE, &point)))),
    ];
    Figure::new(1040, columns, |drawing| {
        let (above, below) = drawing.split_vertically(680);
        from_above(&above, &points)?;
        both_images(&below, &points)
    })
}

fn column_seen(baseline: f64, point: &Vector3<f64>) -> f64 {
    let pixel = CAMERA.project(&second_from_first(baseline), point);
    pixel.map_or(f64::NAN, |pixel| pixel.x)
}

fn from_above(drawing: &Drawing, points: &[Vector3<f64>]) -> Drawn {
    let x_axis = ("depth z (m)", -0.4..9.4, 10);
    let mut chart = figure::axes(drawing, x_axis, ("x (m)", -0.13..0.63, 5))?;
    for point in points {
        chart.line([(0.0, BASELINE), (point.z, point.x)], ESTIMATED, 3)?;
    }
    let end = (9.0 / POINT.z) * POINT;
    chart.line([(0.0, 0.0), (end.z, end.x)], MEASURED, 6)?;
    for point in points {
        chart.dots([(point.z, point.x)], 14, ESTIMATED)?;
        let below = (point.z + 0.1, point.x - 0.06);
        chart.write(&format!("{} m", point.z), below, letters_around(ESTIMATED))?;
    }
    for (name, x, name_x) in [("camera 0", 0.0, -0.06), ("camera 1", BASELINE, BASELINE + 0.06)] {
        let body = Polygon::new(vec![(-26, -20), (-26, 20), (10, 0)], INK.filled());
        chart.draw_series([EmptyElement::at((0.0, x)) + body])?;
        chart.write(name, (0.55, name_x), letters_around(INK))?;
    }
    Ok(())
}

fn both_images(drawing: &Drawing, points: &[Vector3<f64>]) -> Drawn {
    let x_axis = ("column u (px)", 225.0..355.0, 7);
    let mut chart = figure::axes(drawing, x_axis, ("", -0.6..2.1, 0))?;
    let (row_of_first, row_of_second) = (1.3, 0.0);
    chart.write("image 0", (234.0, row_of_first), letters_around(INK))?;
    chart.write("image 1", (234.0, row_of_second), letters_around(INK))?;
    for point in points {
        let column = column_seen(BASELINE, point);
        chart.dots([(column, row_of_second)], 14, ESTIMATED)?;
        let above = (column, row_of_second + 0.55);
        chart.write(&format!("{} m", point.z), above, letters_around(ESTIMATED))?;
    }
    let column = column_seen(0.0, &POINT);
    let pixel = Rectangle::new([(-15, -15), (15, 15)], MEASURED.filled());
    chart.draw_series([EmptyElement::at((column, row_of_first)) + pixel])?;
    chart.write("all of them", (column - 21.0, row_of_first), letters_around(MEASURED))
}
