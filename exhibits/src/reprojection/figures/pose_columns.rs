//! The six columns of the pose block, each as a field of arrows over the image.

use nalgebra::{Isometry3, Vector2, Vector3, Vector6};
use plotters::element::{Circle, PathElement, Polygon, Text};
use plotters::style::Color;
use vislam::bearing::back_project;

use crate::figure::{self, Drawing, Drawn, Figure, GRID, INK, SERIES, letters_around};
use crate::reprojection::NO_POSE_BLOCK;
use crate::reprojection::worked::CAMERA;

/// Metres of the near points and of the far ones.
const NEAR: f64 = 3.0;
const FAR: f64 = 12.0;

/// The step that is drawn, in metres and radians; its arrows are not longer than the image bears.
const STEP: f64 = 0.28;
const TURN: f64 = 0.08;

const NAMES: [&str; 6] = [
    "step along x",
    "turn about x",
    "step along y",
    "turn about y",
    "step along z",
    "turn about z",
];
/// Which column each panel shows.
const COLUMNS: [usize; 6] = [0, 3, 1, 4, 2, 5];

struct Seen {
    pixel: Vector2<f64>,
    depth: f64,
    /// Where the pixel would go for a unit of each column.
    columns: [Vector2<f64>; 6],
}

pub fn pose_columns() -> Figure {
    let points = points();
    let rows = points.iter().map(|point| {
        let mut row = vec![
            format!("{:.0}", point.pixel.x),
            format!("{:.0}", point.pixel.y),
            format!("{:.0}", point.depth),
        ];
        let columns = point.columns.iter();
        row.extend(columns.map(|column| format!("({:.1} {:.1})", column.x, column.y)));
        row
    });
    Figure {
        columns: vec![
            "u (px)",
            "v (px)",
            "depth (m)",
            "by a step along x (px/m)",
            "along y (px/m)",
            "along z (px/m)",
            "by a turn about x (px/rad)",
            "about y (px/rad)",
            "about z (px/rad)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1660, |drawing| {
            let (panels, legend) = drawing.split_vertically(1590);
            for (index, panel) in panels.split_evenly((3, 2)).iter().enumerate() {
                draw_panel(panel, NAMES[index], COLUMNS[index], &points)?;
            }
            for (x, depth, colour, radius) in [(380, NEAR, SERIES[1], 13), (760, FAR, SERIES[0], 7)]
            {
                legend.draw(&Circle::new((x, 30), radius, colour.filled()))?;
                let name = format!("{depth} m");
                legend.draw(&Text::new(name, (x + 80, 32), letters_around(INK)))?;
            }
            Ok(())
        }),
    }
}

/// A grid of pixels; near and far points take turns.
fn points() -> Vec<Seen> {
    let mut points = Vec::new();
    for row in 0..5 {
        for column in 0..7 {
            let pixel =
                Vector2::new(50.0 + 90.0 * f64::from(column), 40.0 + 100.0 * f64::from(row));
            let depth = if (row + column) % 2 == 0 { NEAR } else { FAR };
            let point = back_project(&CAMERA, &pixel, depth);
            points.push(Seen { pixel, depth, columns: columns(&point) });
        }
    }
    points
}

fn columns(point: &Vector3<f64>) -> [Vector2<f64>; 6] {
    let block =
        CAMERA.jacobians(&Isometry3::identity(), point).map_or(NO_POSE_BLOCK, |both| both.0);
    std::array::from_fn(|column| block * Vector6::ith(column, 1.0))
}

fn draw_panel(drawing: &Drawing, name: &str, column: usize, points: &[Seen]) -> Drawn {
    let (heading, area) = drawing.split_vertically(64);
    heading.draw(&Text::new(name, (320, 40), letters_around(INK)))?;
    let mut chart = plotters::chart::ChartBuilder::on(&area)
        .margin(14)
        .build_cartesian_2d(0.0..640.0, 480.0..0.0)?;
    let border = [(0.0, 0.0), (640.0, 0.0), (640.0, 480.0), (0.0, 480.0), (0.0, 0.0)];
    chart.draw_series([PathElement::new(border, GRID.stroke_width(3))])?;
    let unit = if column < 3 { STEP } else { TURN };
    for point in points {
        let (colour, radius) = if point.depth == NEAR { (SERIES[1], 8) } else { (SERIES[0], 5) };
        let to = point.pixel + unit * point.columns[column];
        let shaft = [(point.pixel.x, point.pixel.y), (to.x, to.y)];
        chart.draw_series([PathElement::new(shaft, colour.stroke_width(5))])?;
        chart.draw_series([Polygon::new(arrow_head(&point.pixel, &to), colour.filled())])?;
        chart.draw_series([Circle::new(shaft[0], radius, colour.filled())])?;
    }
    Ok(())
}

/// A triangle around the end of an arrow, smaller for a short arrow.
fn arrow_head(from: &Vector2<f64>, to: &Vector2<f64>) -> Vec<(f64, f64)> {
    let length = (to - from).norm();
    if length == 0.0 {
        return vec![(to.x, to.y)];
    }
    let forward = (0.3_f64).min(9.0 / length) * (to - from);
    let across = Vector2::new(-forward.y, forward.x);
    let corners = [to + forward, to - forward + across, to - forward - across];
    corners.map(|corner| (corner.x, corner.y)).to_vec()
}
