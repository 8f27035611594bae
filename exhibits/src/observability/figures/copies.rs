//! Copies of a flight, and which measurements object to them.

use nalgebra::{Rotation3, Vector3};
use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::observability::{BiasAssumption, Similarity, Window};
use vislam::preintegration::imu_residual;
use vislam::simulation::{Flight, Trajectory};

use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, letters_around};
use crate::observability::worked::of_flight;

const NAMES: [&str; 4] = ["as flown", "shifted and turned", "grown by a fifth", "tilted by 2°"];
const KINDS: [&str; 4] = ["pixels", "rotation", "velocity", "position"];

fn similarities() -> [Similarity; 4] {
    let same = Similarity::identity();
    let turn = |degrees: f64, axis: Vector3<f64>| Rotation3::new(degrees.to_radians() * axis);
    let (rotation, translation) = (turn(60.0, Vector3::z()), Vector3::new(8.0, 1.0, 0.0));
    [
        same,
        Similarity { rotation, translation, ..same },
        Similarity { scale: 1.2, ..same },
        Similarity { rotation: turn(2.0, Vector3::x()), ..same },
    ]
}

fn windows() -> [Window; 4] {
    // One whole eight.
    let flight = Flight { seconds: 8.0, ..Flight::brief(Trajectory::figure_eight()) };
    let window = of_flight(&flight, BiasAssumption::KNOWN);
    similarities().map(|similarity| window.transformed(&similarity))
}

/// Root mean square of the residuals in standard deviations, by kind.
fn objections(window: &Window) -> [f64; 4] {
    let whole = window.residual().expect("a similar window is in front of its cameras");
    let pixels = whole.rows(0, 2 * window.observations.len());
    let mut squares = [0.0; 3];
    for (i, interval) in window.intervals.iter().enumerate() {
        let (first, second) = (&window.states[i], &window.states[i + 1]);
        let residual = imu_residual(interval, first, second, &window.gravity, &window.biases[0]);
        for row in 0..9 {
            squares[row / 3] += residual[row].powi(2) / interval.covariance[(row, row)];
        }
    }
    let count = 3.0 * window.intervals.len() as f64;
    let [rotation, velocity, position] = squares.map(|sum: f64| (sum / count).sqrt());
    [pixels.norm() / (pixels.len() as f64).sqrt(), rotation, velocity, position]
}

pub fn copies() -> Figure {
    let windows = windows();
    let objections = windows.each_ref().map(objections);
    let shown = |value: f64| if value < 1e-6 { "0".to_owned() } else { format!("{value:.1}") };
    let of_kind = |kind: usize| objections.iter().map(|of| shown(of[kind])).collect();
    let columns = vec![
        ("copy", NAMES.map(str::to_owned).to_vec()),
        ("pixels (sigmas)", of_kind(0)),
        ("rotation (sigmas)", of_kind(1)),
        ("velocity (sigmas)", of_kind(2)),
        ("position (sigmas)", of_kind(3)),
    ];
    Figure::new(1540, columns, |drawing| {
        let (above, below) = drawing.split_vertically(800);
        plan(&above, &windows)?;
        bars(&below, &objections)
    })
}

fn plan(drawing: &Drawing, windows: &[Window; 4]) -> Drawn {
    let mut chart = figure::axes(drawing, ("x (m)", -5.0..13.0, 6), ("y (m)", -4.5..6.5, 5))?;
    // From above a tilted copy could not be told from the flight.
    for (index, window) in windows.iter().take(3).enumerate() {
        let places = || window.states.iter().map(|state| (state.position.x, state.position.y));
        chart.line(places(), SERIES[index], 5)?;
        chart.marks(places().step_by(4), index)?;
        let (x, y) = (-4.4, 5.9 - 1.0 * index as f64);
        chart.key(index, NAMES[index], (x, y), x + 0.4)?;
    }
    Ok(())
}

fn bars(drawing: &Drawing, objections: &[[f64; 4]; 4]) -> Drawn {
    let highest = objections.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
    let y_axis = ("objection (standard deviations)", 0.0..1.5 * highest, 5);
    let mut chart = figure::axes(drawing, ("", 0.0..4.0, 0), y_axis)?;
    for (index, values) in objections.iter().enumerate().skip(1) {
        for (kind, value) in values.iter().enumerate() {
            let left = kind as f64 + 0.14 + 0.24 * (index as f64 - 1.0);
            let bar = Rectangle::new([(left, 0.0), (left + 0.22, *value)], SERIES[index].filled());
            chart.draw_series([bar])?;
            let text = if *value < 1e-6 { "0".to_owned() } else { format!("{value:.0}") };
            let place = (left + 0.11, value + 0.045 * highest);
            chart.write(&text, place, letters_around(SERIES[index]))?;
        }
        let (x, y) = (0.12, (1.57 - 0.13 * index as f64) * highest);
        chart.key(index, NAMES[index], (x, y), x + 0.09)?;
    }
    for (kind, name) in KINDS.iter().enumerate() {
        let height = if kind < 2 { 0.2 * highest } else { 1.2 * highest };
        chart.write(name, (kind as f64 + 0.5, height), letters_around(INK))?;
    }
    Ok(())
}
