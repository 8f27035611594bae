//! Allan deviations of two simulated sensors at rest, and the lines they should follow.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::ImuNoise;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};
use crate::inertial::averages::{allan_deviations, averaged, seconds};

/// Readings in a window.
const WINDOWS: [usize; 14] = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000];

const NAMES: [&str; 2] = ["consumer", "EuRoC"];

/// Densities of white noise and walk of a sensor.
type Densities = fn(&ImuNoise) -> [f64; 2];
const SENSORS: [(&str, Densities); 2] = [
    ("gyroscope (rad/s)", |noise| [noise.gyro, noise.gyro_walk]),
    ("accelerometer (m/s²)", |noise| [noise.accelerometer, noise.accelerometer_walk]),
];

pub fn allan() -> Figure {
    let noises = [ImuNoise::mems(), ImuNoise::euroc()];
    let found = [14, 15].map(|seed| allan_deviations(&noises[seed - 14], &WINDOWS, seed as u64));
    let rows = WINDOWS.iter().enumerate().map(|(index, window)| {
        let mut row = vec![format!("{}", seconds(*window))];
        for found in &found {
            row.extend(found[index].map(|deviation| format!("{deviation:.3e}")));
        }
        row
    });
    Figure {
        columns: vec![
            "window (s)",
            "consumer gyroscope (rad/s)",
            "consumer accelerometer (m/s²)",
            "EuRoC gyroscope (rad/s)",
            "EuRoC accelerometer (m/s²)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1360, |drawing| {
            let (above, below) = drawing.split_vertically(660);
            panel(&above, 0, (3e-5, 1e-1), &noises, &found)?;
            panel(&below, 1, (1e-3, 1.0), &noises, &found)
        }),
    }
}

fn panel(
    drawing: &Drawing,
    sensor: usize,
    (low, high): (f64, f64),
    noises: &[ImuNoise; 2],
    found: &[Vec<[f64; 2]>; 2],
) -> Drawn {
    let (title, densities) = SENSORS[sensor];
    let x_title = if sensor == 1 { "length of the window (s)" } else { "" };
    let y_axis = (title, (low..high).log_scale(), 5);
    let mut chart = figure::axes(drawing, (x_title, (0.015..700.0).log_scale(), 5), y_axis)?;
    for (index, noise) in noises.iter().enumerate() {
        let [white, walk] = densities(noise);
        let times = || (0..=60).map(|k| 0.02 * 2e4_f64.powf(f64::from(k) / 60.0));
        for parts in [[white, 0.0], [0.0, walk]] {
            let line = times().map(|t| (t, averaged(parts[0], parts[1], t).sqrt()));
            let line = line.filter(|(_, deviation)| (low..high).contains(deviation));
            chart.draw_series(LineSeries::new(line, INK.stroke_width(2)))?;
        }
        let curve = times().map(|t| (t, averaged(white, walk, t).sqrt()));
        chart.draw_series(LineSeries::new(curve, SERIES[index].stroke_width(5)))?;
        let places = WINDOWS.iter().zip(&found[index]);
        let marks = places.map(|(window, both)| {
            EmptyElement::at((seconds(*window), both[sensor])) + marker(index)
        });
        chart.draw_series(marks)?;
        let place = (20.0, high * [0.6, 0.28][index]);
        chart.draw_series([EmptyElement::at(place) + marker(index)])?;
        let beside = (1.25 * place.0, place.1);
        chart.draw_series([Text::new(NAMES[index], beside, letters_right_of(SERIES[index]))])?;
    }
    Ok(())
}
