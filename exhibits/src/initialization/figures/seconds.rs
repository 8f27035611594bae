//! What a second more of motion buys.

use plotters::coord::combinators::IntoLogRange;

use super::super::flights::{FOLLOWED, TIMES};
use super::super::motions::{RATE, equations};
use crate::figure::{
    self, Draw, Figure, INK, SERIES, decimals, geometric, letters_around, letters_right_of,
};
use crate::record::accepted;
use crate::statistics::{median, root_mean_square};
use vislam::simulation::{ScalarTrajectory, Trajectory};

/// The standard deviation of a camera's centre on each axis, in metres.
const CENTRE: f64 = 0.02;
/// The standard deviation of the accelerometer's bias, in m/s².
const BIAS: f64 = 0.1;
/// Places of the figure-eight at which it is taken up, a second after another.
const STARTS: usize = 20;

/// The figure-eight from some second on.
fn eight(from: f64) -> Trajectory {
    let mut motion = Trajectory::figure_eight();
    let later = |coordinate: &mut ScalarTrajectory| coordinate.phase += from * coordinate.frequency;
    motion.position.iter_mut().for_each(later);
    let angles = &mut motion.angles;
    [&mut angles.yaw, &mut angles.pitch, &mut angles.roll].into_iter().for_each(later);
    motion
}

/// The standard deviation of the scale by the linear equations, as a part of it.
fn sigma(from: f64, seconds: f64) -> f64 {
    let (beyond, _) =
        equations(eight(from), seconds).beyond(CENTRE, CENTRE / BIAS).expect("a path");
    CENTRE / beyond
}

/// The size of the third derivative of the position, in m/s³, as a root mean square.
fn jerk() -> f64 {
    let step = 0.01;
    let acceleration = |time: f64| Trajectory::figure_eight().at(time).acceleration;
    let jerks = (0..3000).map(|k| 0.01 * f64::from(k)).map(|time| {
        ((acceleration(time + step) - acceleration(time - step)) / (2.0 * step)).norm()
    });
    root_mean_square(jerks)
}

/// By the distance of a path of constant jerk from its best parabola.
fn formula(jerk: f64, seconds: f64) -> f64 {
    120.0 * 7.0_f64.sqrt() * CENTRE / (jerk * seconds.powi(3) * (RATE * seconds).sqrt())
}

pub fn seconds() -> Figure {
    let times = || TIMES.into_iter();
    let starts = || (0..STARTS).map(|start| start as f64);
    let linear: Vec<f64> =
        times().map(|time| 100.0 * median(starts().map(|from| sigma(from, time)))).collect();
    let jerk = jerk();
    let predicted: Vec<f64> = times().map(|time| 100.0 * formula(jerk, time)).collect();
    let of = |at: usize| {
        let value = |number| accepted("initial_flights", &format!("followed_{number}_{at}_sigma"));
        (TIMES[at], median((0..FOLLOWED).map(value)))
    };
    let reported: Vec<(f64, f64)> =
        (0..TIMES.len()).map(of).filter(|(_, sigma)| *sigma > 0.0).collect();
    let cell = |(_, sigma): (f64, f64)| match sigma > 0.0 {
        true => format!("{sigma:.2}"),
        false => String::new(),
    };
    let cells = (0..TIMES.len()).map(|at| cell(of(at))).collect();
    let columns = vec![
        ("time (s)", decimals(1, times())),
        ("linear equations; median of twenty starts (%)", decimals(3, linear.iter().copied())),
        ("for a constant jerk (%)", decimals(3, predicted)),
        ("reported by the batch (%)", cells),
    ];
    Figure::new(900, columns, |drawing| {
        let x_axis = ("length of the motion (s)", (0.4..6.0).log_scale(), 5);
        let y_axis = ("sigma of the scale (%)", (0.02..5e3).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        // A logarithmic axis as short as this has a single label of its own.
        for time in [0.5, 2.0, 5.0] {
            chart.write(&format!("{time}"), (time, 0.032), letters_around(INK))?;
        }
        let line = geometric(0.42, 14.0, 50).map(|time| (time, 100.0 * formula(jerk, time)));
        chart.line(line, INK, 3)?;
        chart.line(times().zip(linear.iter().copied()), SERIES[0], 4)?;
        chart.marks(times().zip(linear.iter().copied()), 0)?;
        chart.marks(reported.iter().copied(), 1)?;
        chart.key(0, "linear equations", (1.55, 2.2e3), 1.65)?;
        chart.key(1, "reported by the batch", (1.55, 8e2), 1.65)?;
        chart.line([(1.48, 3e2), (1.62, 3e2)], INK, 3)?;
        chart.write("constant jerk, slope \u{2212}3.5", (1.65, 3e2), letters_right_of(INK))?;
        Ok(())
    })
}
