//! The figure-eight from above, and what a perfect sensor reads on it.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::{GRAVITY, ImuSample};
use vislam::simulation::Trajectory;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};

/// Seconds for one round of the level path.
const ROUND: f64 = TAU / 0.8;

pub fn eight() -> Figure {
    let motion = Trajectory::figure_eight();
    let rows = (0..=31).map(|k| {
        let t = 0.25 * f64::from(k);
        let (place, read) = (motion.at(t).state.position, motion.at(t).sample(&GRAVITY));
        let all = place.iter().chain(read.gyro.iter()).chain(read.accelerometer.iter());
        let mut row = vec![format!("{t}")];
        row.extend(all.map(|value| format!("{value:.3}")));
        row
    });
    Figure {
        columns: vec![
            "time (s)",
            "x (m)",
            "y (m)",
            "z (m)",
            "gyroscope x (rad/s)",
            "gyroscope y (rad/s)",
            "gyroscope z (rad/s)",
            "accelerometer x (m/s²)",
            "accelerometer y (m/s²)",
            "accelerometer z (m/s²)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1760, |drawing| {
            let (path, readings) = drawing.split_vertically(700);
            let (gyro, force) = readings.split_vertically(490);
            path_panel(&path, &motion)?;
            let title = "gyroscope (rad/s)";
            readings_panel(&gyro, (title, -1.6..2.1), &motion, |read| read.gyro)?;
            let title = "force (m/s²)";
            readings_panel(&force, (title, -6.0..18.0), &motion, |read| read.accelerometer)
        }),
    }
}

fn path_panel(drawing: &Drawing, motion: &Trajectory) -> Drawn {
    let x_axis = ("x (m)", -4.1..4.1, 9);
    let mut chart = figure::axes(drawing, x_axis, ("y (m)", -2.05..2.05, 5))?;
    let place = |t: f64| motion.at(t).state.position;
    let path = (0..=200).map(|k| place(ROUND * f64::from(k) / 200.0)).map(|p| (p.x, p.y));
    chart.draw_series(LineSeries::new(path, SERIES[3].stroke_width(5)))?;
    // The nose of the body, every third of a second.
    for k in 0..24 {
        let state = motion.at(ROUND * f64::from(k) / 24.0).state;
        let nose = state.position + 0.5 * (state.world_from_body * Vector3::x());
        let stroke = [(state.position.x, state.position.y), (nose.x, nose.y)];
        chart.draw_series([PathElement::new(stroke, INK.stroke_width(4))])?;
    }
    let start = place(0.0);
    chart.draw_series([EmptyElement::at((start.x, start.y)) + marker(3)])?;
    Ok(())
}

fn readings_panel(
    drawing: &Drawing,
    (title, range): (&str, std::ops::Range<f64>),
    motion: &Trajectory,
    of: fn(&ImuSample) -> Vector3<f64>,
) -> Drawn {
    let top = range.end - 0.11 * (range.end - range.start);
    let mut chart = figure::axes(drawing, ("time (s)", 0.0..ROUND, 8), (title, range, 5))?;
    let read = |t: f64| of(&motion.at(t).sample(&GRAVITY));
    for axis in 0..3 {
        let times = (0..=160).map(|k| ROUND * f64::from(k) / 160.0);
        let curve = times.map(|t| (t, read(t)[axis]));
        chart.draw_series(LineSeries::new(curve, SERIES[axis].stroke_width(5)))?;
        let times = (0..8).map(|k| 0.4 + f64::from(k));
        let marks = times.map(|t| EmptyElement::at((t, read(t)[axis])) + marker(axis));
        chart.draw_series(marks)?;
        let name = ["x, ahead", "y, left", "z, up"][axis];
        let place = (0.3 + 2.5 * axis as f64, top);
        chart.draw_series([EmptyElement::at(place) + marker(axis)])?;
        let beside = (place.0 + 0.17, place.1);
        chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[axis]))])?;
    }
    Ok(())
}
