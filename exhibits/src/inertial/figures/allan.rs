//! Allan deviations of two simulated sensors at rest, and the lines they should follow.

use plotters::coord::combinators::IntoLogRange;
use vislam::inertial::ImuNoise;

use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, geometric, powers};
use crate::inertial::averages::{allan_deviations, averaged, seconds};

/// Readings in a window.
const WINDOWS: [usize; 14] = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000];

/// Densities of white noise and walk of a sensor.
type Densities = fn(&ImuNoise) -> [f64; 2];
const SENSORS: [(&str, Densities); 2] = [
    ("gyroscope (rad/s)", |noise| [noise.gyro, noise.gyro_walk]),
    ("accelerometer (m/s²)", |noise| [noise.accelerometer, noise.accelerometer_walk]),
];

/// A sensor's noise and its deviations in each window.
type Found = (ImuNoise, Vec<[f64; 2]>);

pub fn allan() -> Figure {
    let found = [(ImuNoise::mems(), 14), (ImuNoise::euroc(), 15)]
        .map(|(noise, seed)| (noise, allan_deviations(&noise, &WINDOWS, seed)));
    let deviations =
        |index: usize, sensor: usize| powers(3, found[index].1.iter().map(|both| both[sensor]));
    let columns = vec![
        ("window (s)", WINDOWS.map(|window| format!("{}", seconds(window))).to_vec()),
        ("consumer gyroscope (rad/s)", deviations(0, 0)),
        ("consumer accelerometer (m/s²)", deviations(0, 1)),
        ("EuRoC gyroscope (rad/s)", deviations(1, 0)),
        ("EuRoC accelerometer (m/s²)", deviations(1, 1)),
    ];
    Figure::new(1360, columns, |drawing| {
        let (above, below) = drawing.split_vertically(660);
        panel(&above, 0, (3e-5, 1e-1), &found)?;
        panel(&below, 1, (1e-3, 1.0), &found)
    })
}

fn panel(drawing: &Drawing, sensor: usize, (low, high): (f64, f64), found: &[Found; 2]) -> Drawn {
    let (title, densities) = SENSORS[sensor];
    let x_title = if sensor == 1 { "length of the window (s)" } else { "" };
    let y_axis = (title, (low..high).log_scale(), 5);
    let mut chart = figure::axes(drawing, (x_title, (0.015..700.0).log_scale(), 5), y_axis)?;
    for (index, (noise, deviations)) in found.iter().enumerate() {
        let [white, walk] = densities(noise);
        let curve = |white: f64, walk: f64| {
            geometric(0.02, 2e4, 60).map(move |t| (t, averaged(white, walk, t).sqrt()))
        };
        for line in [curve(white, 0.0), curve(0.0, walk)] {
            chart.line(line.filter(|(_, deviation)| (low..high).contains(deviation)), INK, 2)?;
        }
        chart.line(curve(white, walk), SERIES[index], 5)?;
        let places = WINDOWS.iter().zip(deviations);
        chart.marks(places.map(|(window, both)| (seconds(*window), both[sensor])), index)?;
        let mark = (20.0, high * [0.6, 0.28][index]);
        chart.key(index, ["consumer", "EuRoC"][index], mark, 25.0)?;
    }
    Ok(())
}
