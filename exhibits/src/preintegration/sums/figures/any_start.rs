//! The same readings from three first states, and what is left when these are taken off.

use nalgebra::{Rotation3, Vector2, Vector3};
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::{GRAVITY, ImuSample, NavState};
use vislam::simulation::Trajectory;

use crate::figure::{self, Drawing, Drawn, Figure, SERIES, letters, letters_right_of, marker};
use crate::preintegration::sums::oracle::deltas_of_states;

const DT: f64 = 0.005;
const STEPS: usize = 600;
/// A mark and a row of data for so many steps.
const EVERY: usize = 60;
const NAMES: [&str; 3] = ["as it was", "turned", "tilted"];

fn starts() -> [NavState; 3] {
    let truth = Trajectory::figure_eight().at(0.0).state;
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 1.2);
    let elsewhere = NavState {
        world_from_body: turn * truth.world_from_body,
        velocity: turn * truth.velocity + Vector3::new(-1.2, 0.3, 0.0),
        position: truth.position + Vector3::new(-3.0, -3.0, 0.0),
    };
    let tilt = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.09);
    let tilted = NavState {
        world_from_body: tilt * truth.world_from_body,
        position: truth.position + Vector3::new(4.5, 0.5, 0.0),
        ..truth
    };
    [truth, elsewhere, tilted]
}

/// Places seen from above at the beginning and after each step: in the world, and of the delta.
fn path(first: &NavState, samples: &[ImuSample]) -> Vec<[Vector2<f64>; 2]> {
    let mut state = *first;
    let mut path = vec![[first.position.xy(), Vector2::zeros()]];
    for (index, sample) in samples.iter().enumerate() {
        state = state.propagate(sample, &GRAVITY, DT);
        let deltas = deltas_of_states(first, &state, &GRAVITY, DT * (index + 1) as f64);
        path.push([state.position.xy(), deltas.position.xy()]);
    }
    path
}

pub fn any_start() -> Figure {
    let samples = Trajectory::figure_eight().samples(&GRAVITY, DT, STEPS);
    let paths = starts().map(|first| path(&first, &samples));
    let rows = (0..=STEPS).step_by(EVERY).map(|step| {
        let mut row = vec![format!("{:.1}", DT * step as f64)];
        for side in 0..2 {
            for path in &paths {
                let place = path[step][side];
                row.extend([format!("{:.3}", place.x), format!("{:.3}", place.y)]);
            }
        }
        row
    });
    Figure {
        columns: vec![
            "time (s)",
            "world x as it was (m)",
            "world y as it was (m)",
            "world x elsewhere (m)",
            "world y elsewhere (m)",
            "world x tilted (m)",
            "world y tilted (m)",
            "delta x as it was (m)",
            "delta y as it was (m)",
            "delta x elsewhere (m)",
            "delta y elsewhere (m)",
            "delta x tilted (m)",
            "delta y tilted (m)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1500, |drawing| {
            let (above, below) = drawing.split_vertically(760);
            panel(&above, &paths, 0, "in the world, from above")?;
            panel(&below, &paths, 1, "as the first body sees it, drift and fall taken off")
        }),
    }
}

fn panel(
    drawing: &Drawing,
    paths: &[Vec<[Vector2<f64>; 2]>; 3],
    side: usize,
    title: &'static str,
) -> Drawn {
    let places = paths.iter().flatten().map(|place| place[side]);
    let (mut low, mut high) = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
    for place in places {
        (low, high) = (low.inf(&place), high.sup(&place));
    }
    let room = 0.08 * (high - low);
    let (low, high) = (low - room, high + room);
    // Equal scales on both axes, for a panel twice as wide as it is tall.
    let half = (high.x - low.x).max(2.0 * (high.y - low.y) * 1.25) / 2.0;
    let (x, y) = ((low.x + high.x) / 2.0, (low.y + high.y) / 2.0 + 0.1 * half);
    let x_axis = ("x (m)", x - half..x + half, 7);
    let y_axis = ("y (m)", y - half / 2.0..y + half / 2.0, 5);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    for (index, path) in paths.iter().enumerate() {
        let line = path.iter().map(|place| (place[side].x, place[side].y));
        let width = [12, 6, 3][index];
        chart.draw_series(LineSeries::new(line, SERIES[index].stroke_width(width)))?;
        // Marks take turns, so that none hides another where the paths are one.
        let marks = path.iter().skip(20 * index).step_by(EVERY);
        let marks = marks.map(|place| EmptyElement::at((place[side].x, place[side].y)));
        chart.draw_series(marks.map(|at| at + marker(index)))?;
        if side == 0 {
            let end = path[[STEPS, 0, STEPS][index]][side];
            let beside = (end.x + 0.04 * half, end.y - [0.05, 0.0, 0.0][index] * half);
            let name = Text::new(NAMES[index], beside, letters_right_of(SERIES[index]));
            chart.draw_series([name])?;
        }
    }
    let corner = (x - 0.97 * half, y + 0.48 * half);
    chart.draw_series([Text::new(title, corner, letters(figure::INK))])?;
    Ok(())
}
