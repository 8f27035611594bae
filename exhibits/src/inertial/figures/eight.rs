//! The figure-eight from above, and what a perfect sensor reads on it.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use vislam::inertial::{GRAVITY, ImuSample};
use vislam::simulation::Trajectory;

use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, plain};

/// Seconds for one round of the level path.
const ROUND: f64 = TAU / 0.8;

pub fn eight() -> Figure {
    let motion = Trajectory::figure_eight();
    let times = || (0..=31).map(|k| 0.25 * f64::from(k));
    let place = |axis: usize| decimals(3, times().map(|t| motion.at(t).state.position[axis]));
    let read = |t: f64| motion.at(t).sample(&GRAVITY);
    let gyro = |axis: usize| decimals(3, times().map(|t| read(t).gyro[axis]));
    let force = |axis: usize| decimals(3, times().map(|t| read(t).accelerometer[axis]));
    let columns = vec![
        ("time (s)", plain(times())),
        ("x (m)", place(0)),
        ("y (m)", place(1)),
        ("z (m)", place(2)),
        ("gyroscope x (rad/s)", gyro(0)),
        ("gyroscope y (rad/s)", gyro(1)),
        ("gyroscope z (rad/s)", gyro(2)),
        ("accelerometer x (m/s²)", force(0)),
        ("accelerometer y (m/s²)", force(1)),
        ("accelerometer z (m/s²)", force(2)),
    ];
    Figure::new(1760, columns, |drawing| {
        let (path, readings) = drawing.split_vertically(700);
        let (gyro, force) = readings.split_vertically(490);
        path_panel(&path, &motion)?;
        readings_panel(&gyro, ("gyroscope (rad/s)", -1.6..2.1), &motion, |read| read.gyro)?;
        let of: fn(&ImuSample) -> Vector3<f64> = |read| read.accelerometer;
        readings_panel(&force, ("force (m/s²)", -6.0..18.0), &motion, of)
    })
}

fn path_panel(drawing: &Drawing, motion: &Trajectory) -> Drawn {
    let x_axis = ("x (m)", -4.1..4.1, 9);
    let mut chart = figure::axes(drawing, x_axis, ("y (m)", -2.05..2.05, 5))?;
    let place = |t: f64| motion.at(t).state.position;
    let path = (0..=200).map(|k| place(ROUND * f64::from(k) / 200.0)).map(|p| (p.x, p.y));
    chart.line(path, SERIES[3], 5)?;
    // The nose of the body, every third of a second.
    for k in 0..24 {
        let state = motion.at(ROUND * f64::from(k) / 24.0).state;
        let nose = state.position + 0.5 * (state.world_from_body * Vector3::x());
        chart.line([(state.position.x, state.position.y), (nose.x, nose.y)], INK, 4)?;
    }
    chart.marks([(place(0.0).x, place(0.0).y)], 3)
}

fn readings_panel(
    drawing: &Drawing,
    (title, range): (&str, std::ops::Range<f64>),
    motion: &Trajectory,
    of: fn(&ImuSample) -> Vector3<f64>,
) -> Drawn {
    let top = range.end - 0.11 * (range.end - range.start);
    let mut chart = figure::axes(drawing, ("time (s)", 0.0..ROUND, 8), (title, range, 5))?;
    for (axis, name) in ["x, ahead", "y, left", "z, up"].into_iter().enumerate() {
        let read = |t: f64| (t, of(&motion.at(t).sample(&GRAVITY))[axis]);
        chart.line((0..=160).map(|k| read(ROUND * f64::from(k) / 160.0)), SERIES[axis], 5)?;
        chart.marks((0..8).map(|k| read(0.4 + f64::from(k))), axis)?;
        let x = 0.3 + 2.5 * axis as f64;
        chart.key(axis, name, (x, top), x + 0.17)?;
    }
    Ok(())
}
