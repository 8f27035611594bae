//! The six columns of the pose block, each as a field of arrows over the image.

use nalgebra::{Vector2, Vector6};
use plotters::element::{Circle, Text};
use plotters::style::Color;
use vislam::bearing::back_project;

use crate::figure::{Draw, Drawing, Drawn, Figure, GRID, INK, SERIES, decimals, letters_around};
use crate::reprojection::worked::{CAMERA, blocks};

/// Metres of the near points and of the far ones.
const NEAR: f64 = 3.0;
const FAR: f64 = 12.0;

/// The step that is drawn, in metres and radians; its arrows are not longer than the image bears.
const STEP: f64 = 0.28;
const TURN: f64 = 0.08;

/// What each panel is called, and which column it shows.
const PANELS: [(&str, usize); 6] = [
    ("step along x", 0),
    ("turn about x", 3),
    ("step along y", 1),
    ("turn about y", 4),
    ("step along z", 2),
    ("turn about z", 5),
];

struct Seen {
    pixel: Vector2<f64>,
    depth: f64,
    /// Where the pixel would go for a unit of each column.
    columns: [Vector2<f64>; 6],
}

pub fn pose_columns() -> Figure {
    let points = points();
    let number = |of: fn(&Seen) -> f64| decimals(0, points.iter().map(of));
    let cell = |column: Vector2<f64>| format!("({:.1} {:.1})", column.x, column.y);
    let column = |index: usize| points.iter().map(|point| cell(point.columns[index])).collect();
    let columns = vec![
        ("u (px)", number(|point| point.pixel.x)),
        ("v (px)", number(|point| point.pixel.y)),
        ("depth (m)", number(|point| point.depth)),
        ("by a step along x (px/m)", column(0)),
        ("along y (px/m)", column(1)),
        ("along z (px/m)", column(2)),
        ("by a turn about x (px/rad)", column(3)),
        ("about y (px/rad)", column(4)),
        ("about z (px/rad)", column(5)),
    ];
    Figure::new(1660, columns, |drawing| {
        let (panels, legend) = drawing.split_vertically(1590);
        for (panel, (name, column)) in panels.split_evenly((3, 2)).iter().zip(PANELS) {
            draw_panel(panel, name, column, &points)?;
        }
        for (x, depth, colour, radius) in [(380, NEAR, SERIES[1], 13), (760, FAR, SERIES[0], 7)] {
            legend.draw(&Circle::new((x, 30), radius, colour.filled()))?;
            legend.draw(&Text::new(format!("{depth} m"), (x + 80, 32), letters_around(INK)))?;
        }
        Ok(())
    })
}

/// A grid of pixels; near and far points take turns.
fn points() -> Vec<Seen> {
    let places = (0..5).flat_map(|row| (0..7).map(move |column| (row, column)));
    let seen = places.map(|(row, column)| {
        let pixel = Vector2::new(50.0 + 90.0 * f64::from(column), 40.0 + 100.0 * f64::from(row));
        let depth = if (row + column) % 2 == 0 { NEAR } else { FAR };
        let (block, _) = blocks(&back_project(&CAMERA, &pixel, depth));
        let columns = std::array::from_fn(|column| block * Vector6::ith(column, 1.0));
        Seen { pixel, depth, columns }
    });
    seen.collect()
}

fn draw_panel(drawing: &Drawing, name: &str, column: usize, points: &[Seen]) -> Drawn {
    let (heading, area) = drawing.split_vertically(64);
    heading.draw(&Text::new(name, (320, 40), letters_around(INK)))?;
    let mut chart = plotters::chart::ChartBuilder::on(&area)
        .margin(14)
        .build_cartesian_2d(0.0..640.0, 480.0..0.0)?;
    let border = [(0.0, 0.0), (640.0, 0.0), (640.0, 480.0), (0.0, 480.0), (0.0, 0.0)];
    chart.line(border, GRID, 3)?;
    let unit = if column < 3 { STEP } else { TURN };
    for point in points {
        let (colour, radius) = if point.depth == NEAR { (SERIES[1], 8) } else { (SERIES[0], 5) };
        let to = point.pixel + unit * point.columns[column];
        chart.arrow(&point.pixel, &to, (0.3, 9.0), colour)?;
        chart.dots([(point.pixel.x, point.pixel.y)], radius, colour)?;
    }
    Ok(())
}
