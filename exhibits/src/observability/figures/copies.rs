//! Copies of a flight, and which measurements object to them.

use nalgebra::{Rotation3, Vector3};
use plotters::element::{EmptyElement, Rectangle, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::observability::{BiasAssumption, Similarity, Window};
use vislam::preintegration::imu_residual;
use vislam::simulation::{Flight, Trajectory};

use crate::figure::{
    self, Drawing, Drawn, Figure, INK, SERIES, letters_around, letters_right_of, marker,
};
use crate::observability::worked::of_flight;

const NAMES: [&str; 4] = ["as flown", "shifted and turned", "grown by a fifth", "tilted by 2°"];
const KINDS: [&str; 4] = ["pixels", "rotation", "velocity", "position"];

fn similarities() -> [Similarity; 4] {
    let same = Similarity::identity();
    let turn = |axis: Vector3<f64>| Rotation3::new(axis);
    [
        same,
        Similarity {
            rotation: turn(60_f64.to_radians() * Vector3::z()),
            translation: Vector3::new(8.0, 1.0, 0.0),
            ..same
        },
        Similarity { scale: 1.2, ..same },
        Similarity { rotation: turn(2_f64.to_radians() * Vector3::x()), ..same },
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
    let rows = NAMES.iter().zip(&objections).map(|(name, values)| {
        let mut row = vec![(*name).to_owned()];
        row.extend(values.iter().map(|value| shown(*value)));
        row
    });
    Figure {
        columns: vec![
            "copy",
            "pixels (sigmas)",
            "rotation (sigmas)",
            "velocity (sigmas)",
            "position (sigmas)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1540, |drawing| {
            let (above, below) = drawing.split_vertically(800);
            plan(&above, &windows)?;
            bars(&below, &objections)
        }),
    }
}

fn plan(drawing: &Drawing, windows: &[Window; 4]) -> Drawn {
    let mut chart = figure::axes(drawing, ("x (m)", -5.0..13.0, 6), ("y (m)", -4.5..6.5, 5))?;
    // From above a tilted copy could not be told from the flight.
    for (index, window) in windows.iter().take(3).enumerate() {
        let places: Vec<_> =
            window.states.iter().map(|state| (state.position.x, state.position.y)).collect();
        chart.draw_series(LineSeries::new(places.clone(), SERIES[index].stroke_width(5)))?;
        let some = places.iter().step_by(4);
        chart.draw_series(some.map(|place| EmptyElement::at(*place) + marker(index)))?;
        let place = (-4.4, 5.9 - 1.0 * index as f64);
        chart.draw_series([EmptyElement::at(place) + marker(index)])?;
        let beside = (place.0 + 0.4, place.1);
        chart.draw_series([Text::new(NAMES[index], beside, letters_right_of(SERIES[index]))])?;
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
            chart.draw_series([Text::new(text, place, letters_around(SERIES[index]))])?;
        }
        let place = (0.12, (1.57 - 0.13 * index as f64) * highest);
        chart.draw_series([EmptyElement::at(place) + marker(index)])?;
        let beside = (place.0 + 0.09, place.1);
        chart.draw_series([Text::new(NAMES[index], beside, letters_right_of(SERIES[index]))])?;
    }
    for (kind, name) in KINDS.iter().enumerate() {
        let place = kind as f64 + 0.5;
        let height = if kind < 2 { 0.2 * highest } else { 1.2 * highest };
        chart.draw_series([Text::new(*name, (place, height), letters_around(INK))])?;
    }
    Ok(())
}
