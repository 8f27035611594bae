//! Two motions of the camera that look alike in the image; only one of them tells depths apart.

use nalgebra::{Isometry3, Vector2, Vector3};
use plotters::element::{Circle, PathElement, Polygon, Text};
use plotters::style::Color;
use vislam::bearing::back_project;

use crate::bearing::NOWHERE;
use crate::bearing::worked::{CAMERA, second_from_first};
use crate::figure::{
    self, Drawing, Drawn, Figure, GRID, INK, MEASURED, letters_around, letters_right_of,
};
use crate::random::Random;

/// Degrees by which the camera turns in the first panel.
const TURN_DEG: f64 = 8.0;
/// Metres by which the camera moves in the second panel.
const SIDEWAYS: f64 = 0.3;

/// Depths in metres, and the radius at which a point of that depth is drawn.
const DEPTHS: [(f64, i32); 4] = [(2.0, 15), (5.0, 12), (10.0, 9), (40.0, 6)];

struct Seen {
    depth: f64,
    radius: i32,
    before: Vector2<f64>,
    after_turn: Vector2<f64>,
    after_step: Vector2<f64>,
}

pub fn rotation_translation() -> Figure {
    let points = points();
    let rows = points.iter().map(|point| {
        let (before, turn, step) = (point.before, point.after_turn, point.after_step);
        let pixels = [before.x, before.y, turn.x, turn.y, step.x, step.y];
        let mut row = vec![format!("{}", point.depth)];
        row.extend(pixels.map(|pixel| format!("{pixel:.1}")));
        row
    });
    Figure {
        columns: vec![
            "depth (m)",
            "u before (px)",
            "v before (px)",
            "u after the turn (px)",
            "v after the turn (px)",
            "u after the step (px)",
            "v after the step (px)",
        ],
        rows: rows.collect(),
        svg: draw(&points),
    }
}

/// Sixteen points whose depths are spread over the image.
fn points() -> Vec<Seen> {
    let mut random = Random::new(30);
    let turn = Isometry3::rotation(-TURN_DEG.to_radians() * Vector3::y());
    let step = second_from_first(SIDEWAYS);
    let mut points = Vec::new();
    for row in 0..4 {
        for column in 0..4 {
            let (depth, radius) = DEPTHS[(column + 2 * row + row / 2) % 4];
            let mut place = |index: usize, spacing: f64| {
                spacing * (0.7 + index as f64) + random.uniform(-15.0..15.0)
            };
            let before = Vector2::new(place(column, 150.0), place(row, 115.0));
            let point = back_project(&CAMERA, &before, depth);
            let seen = |motion| CAMERA.project(motion, &point).unwrap_or(NOWHERE);
            points.push(Seen {
                depth,
                radius,
                before,
                after_turn: seen(&turn),
                after_step: seen(&step),
            });
        }
    }
    points
}

fn draw(points: &[Seen]) -> String {
    figure::draw(680, |drawing| {
        let (panels, legend) = drawing.split_vertically(600);
        let (left, right) = panels.split_horizontally(680);
        let turned = points.iter().map(|point| (point, point.after_turn));
        let moved = points.iter().map(|point| (point, point.after_step));
        image(&left, &format!("turned by {TURN_DEG}°"), ("v (px)", 4), turned)?;
        image(&right, &format!("moved by {SIDEWAYS} m"), ("", 0), moved)?;
        for (index, (depth, radius)) in DEPTHS.into_iter().enumerate() {
            let x = 300 + 230 * index as i32;
            legend.draw(&Circle::new((x, 30), radius, MEASURED.filled()))?;
            let name = Text::new(format!("{depth} m"), (x + 30, 30), letters_right_of(INK));
            legend.draw(&name)?;
        }
        Ok(())
    })
}

fn image<'p>(
    drawing: &Drawing,
    title: &str,
    (v_title, v_ticks): (&str, usize),
    flow: impl Iterator<Item = (&'p Seen, Vector2<f64>)>,
) -> Drawn {
    let (heading, area) = drawing.split_vertically(70);
    let middle = (if v_ticks == 0 { 325 } else { 405 }, 45);
    heading.draw(&Text::new(title.to_owned(), middle, letters_around(INK)))?;
    let mut chart = figure::axes(&area, ("u (px)", 0.0..640.0, 4), (v_title, 480.0..0.0, v_ticks))?;
    let border = [(0.0, 0.0), (640.0, 0.0), (640.0, 480.0), (0.0, 480.0), (0.0, 0.0)];
    chart.draw_series([PathElement::new(border, GRID.stroke_width(3))])?;
    for (point, after) in flow {
        let before = (point.before.x, point.before.y);
        let shaft = vec![before, (after.x, after.y)];
        chart.draw_series([PathElement::new(shaft, MEASURED.stroke_width(5))])?;
        chart.draw_series([Polygon::new(arrow_head(&point.before, &after), MEASURED.filled())])?;
        chart.draw_series([Circle::new(before, point.radius, MEASURED.filled())])?;
    }
    Ok(())
}

/// A triangle around the end of an arrow, smaller for a short arrow.
fn arrow_head(from: &Vector2<f64>, to: &Vector2<f64>) -> Vec<(f64, f64)> {
    let size = (0.25 * (to - from).norm()).min(12.0);
    let forward = size * (to - from).normalize();
    let across = Vector2::new(-forward.y, forward.x);
    let corners = [to + forward, to - forward + across, to - forward - across];
    corners.map(|corner| (corner.x, corner.y)).to_vec()
}
