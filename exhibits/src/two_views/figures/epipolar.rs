//! Two pictures of five points, with the lines on which each picture expects the other's pixels.

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector2, Vector3};
use plotters::chart::ChartBuilder;
use plotters::element::{Cross, Rectangle};
use plotters::style::Color;
use vislam::two_views::{epipolar_line, essential_matrix, fundamental_matrix};

use crate::figure::{
    Draw, Drawing, Drawn, ESTIMATED, Figure, INK, SERIES, decimals, letters_around,
};
use crate::two_views::oracle::seen;
use crate::two_views::worked::CAMERA;

/// Metres in the first camera.
const POINTS: [Vector3<f64>; 4] = [
    Vector3::new(-1.9, -0.9, 5.0),
    Vector3::new(1.6, -1.3, 6.0),
    Vector3::new(-0.5, 1.1, 4.0),
    Vector3::new(2.6, 1.6, 7.0),
];
/// Width and height of the image, in pixels.
const IMAGE: (f64, f64) = (640.0, 480.0);

/// The second camera stands ahead of the first and to its right, and looks a little to the left.
fn second_from_first() -> Isometry3<f64> {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.16);
    let centre = Vector3::new(0.45, 0.1, 1.6);
    Isometry3::from_parts((-(turn * centre)).into(), turn.into())
}

pub fn epipolar() -> Figure {
    let motion = second_from_first();
    let essential = essential_matrix(&motion);
    let second_by_first = fundamental_matrix(&CAMERA, &CAMERA, &essential);
    let first = POINTS.map(|point| seen(&CAMERA, &Isometry3::identity(), &point));
    let second = POINTS.map(|point| seen(&CAMERA, &motion, &point));
    let first_by_second = second_by_first.transpose();
    let second_centre = motion.inverse().translation.vector;
    let first_epipole = seen(&CAMERA, &Isometry3::identity(), &second_centre);
    // The first camera lies behind the second one; the line through both centres still has a pixel.
    let second_epipole = seen(&CAMERA, &Isometry3::identity(), &-motion.translation.vector);
    let lines = first.map(|pixel| line(&second_by_first, &pixel));
    let columns = vec![
        ("u in image 0 (px)", decimals(1, first.map(|pixel| pixel.x))),
        ("v in image 0 (px)", decimals(1, first.map(|pixel| pixel.y))),
        ("u in image 1 (px)", decimals(1, second.map(|pixel| pixel.x))),
        ("v in image 1 (px)", decimals(1, second.map(|pixel| pixel.y))),
        ("line in image 1: a", decimals(4, lines.map(|line| line.x))),
        ("b", decimals(4, lines.map(|line| line.y))),
        ("c (px)", decimals(1, lines.map(|line| line.z))),
    ];
    Figure::new(1240, columns, |drawing| {
        let (above, below) = drawing.split_vertically(620);
        panel(&above, "image 0", &first, &second, &first_by_second, &first_epipole)?;
        panel(&below, "image 1", &second, &first, &second_by_first, &second_epipole)
    })
}

fn line(fundamental: &Matrix3<f64>, pixel: &Vector2<f64>) -> Vector3<f64> {
    epipolar_line(fundamental, pixel).unwrap_or(Vector3::repeat(f64::NAN))
}

/// One image with its own pixels and the lines of the other's.
fn panel(
    drawing: &Drawing,
    name: &str,
    pixels: &[Vector2<f64>; 4],
    others: &[Vector2<f64>; 4],
    fundamental: &Matrix3<f64>,
    epipole: &Vector2<f64>,
) -> Drawn {
    let (width, height) = drawing.dim_in_pixel();
    // The scale is the same along both axes, with room for a name beside the image.
    let scale = (f64::from(height) - 20.0) / IMAGE.1;
    let side = (f64::from(width) / scale - IMAGE.0) / 2.0;
    let mut chart = ChartBuilder::on(drawing)
        .margin_top(10)
        .margin_bottom(10)
        .build_cartesian_2d(-side..IMAGE.0 + side, -IMAGE.1..0.0)?;
    let frame = Rectangle::new([(0.0, 0.0), (IMAGE.0, -IMAGE.1)], INK.stroke_width(2));
    chart.draw_series([frame])?;
    chart.write(name, (-0.5 * side, -40.0), letters_around(INK))?;
    for (index, other) in others.iter().enumerate() {
        let ends = inside(&line(fundamental, other));
        chart.line(ends.iter().map(|end| (end.x, -end.y)), SERIES[index], 4)?;
    }
    for (index, pixel) in pixels.iter().enumerate() {
        chart.marks([(pixel.x, -pixel.y)], index)?;
    }
    let (place, in_margin) = ((epipole.x, -epipole.y), (-0.5 * side, -130.0));
    for place in [place, in_margin] {
        chart.draw_series([Cross::new(place, 16, ESTIMATED.stroke_width(7))])?;
    }
    let below = (in_margin.0, in_margin.1 - 40.0);
    chart.write("epipole", below, letters_around(ESTIMATED))
}

/// The two places at which a line enters and leaves the image.
fn inside(line: &Vector3<f64>) -> Vec<Vector2<f64>> {
    let at_column = |u: f64| Vector2::new(u, -(line.x * u + line.z) / line.y);
    let at_row = |v: f64| Vector2::new(-(line.y * v + line.z) / line.x, v);
    let crossings = [at_column(0.0), at_column(IMAGE.0), at_row(0.0), at_row(IMAGE.1)];
    let is_inside = |pixel: &Vector2<f64>| {
        let slack = 1e-9;
        (-slack..=IMAGE.0 + slack).contains(&pixel.x)
            && (-slack..=IMAGE.1 + slack).contains(&pixel.y)
    };
    crossings.into_iter().filter(is_inside).take(2).collect()
}
