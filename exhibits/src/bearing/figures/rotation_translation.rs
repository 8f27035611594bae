//! Two motions of the camera that look alike in the image; only one of them tells depths apart.

use nalgebra::{Isometry3, Vector2, Vector3};
use plotters::element::{Circle, Text};
use plotters::style::Color;
use vislam::bearing::back_project;

use crate::bearing::NOWHERE;
use crate::bearing::worked::{CAMERA, second_from_first};
use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, GRID, INK, MEASURED, decimals, letters_around,
    letters_right_of,
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
    let column = |of: fn(&Seen) -> f64| decimals(1, points.iter().map(of));
    let columns = vec![
        ("depth (m)", points.iter().map(|point| point.depth.to_string()).collect()),
        ("u before (px)", column(|point| point.before.x)),
        ("v before (px)", column(|point| point.before.y)),
        ("u after the turn (px)", column(|point| point.after_turn.x)),
        ("v after the turn (px)", column(|point| point.after_turn.y)),
        ("u after the step (px)", column(|point| point.after_step.x)),
        ("v after the step (px)", column(|point| point.after_step.y)),
    ];
    Figure::new(680, columns, |drawing| {
        let (panels, legend) = drawing.split_vertically(600);
        let (left, right) = panels.split_horizontally(680);
        let turned = points.iter().map(|point| (point, point.after_turn));
        let moved = points.iter().map(|point| (point, point.after_step));
        image(&left, &format!("turned by {TURN_DEG}°"), ("v (px)", 4), turned)?;
        image(&right, &format!("moved by {SIDEWAYS} m"), ("", 0), moved)?;
        for (index, (depth, radius)) in DEPTHS.into_iter().enumerate() {
            let x = 300 + 230 * index as i32;
            legend.draw(&Circle::new((x, 30), radius, MEASURED.filled()))?;
            legend.draw(&Text::new(format!("{depth} m"), (x + 30, 30), letters_right_of(INK)))?;
        }
        Ok(())
    })
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
            let middle = Vector2::new(150.0 * (0.7 + column as f64), 115.0 * (0.7 + row as f64));
            let before = middle.map(|place| place + random.uniform(-15.0..15.0));
            let point = back_project(&CAMERA, &before, depth);
            let seen = |motion| CAMERA.project(motion, &point).unwrap_or(NOWHERE);
            let (after_turn, after_step) = (seen(&turn), seen(&step));
            points.push(Seen { depth, radius, before, after_turn, after_step });
        }
    }
    points
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
    chart.line(border, GRID, 3)?;
    for (point, after) in flow {
        chart.arrow(&point.before, &after, (0.25, 12.0), MEASURED)?;
        chart.dots([(point.before.x, point.before.y)], point.radius, MEASURED)?;
    }
    Ok(())
}
