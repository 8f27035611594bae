//! What a turn of the attitude at one time does to velocity and position afterwards.

use std::ops::Range;

use nalgebra::{Rotation3, Vector3};
use plotters::element::Circle;
use plotters::style::Color;
use vislam::inertial::{GRAVITY, ImuSample};
use vislam::preintegration::Deltas;
use vislam::simulation::Trajectory;

use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_around};
use crate::preintegration::noise::growth::HINGE_ANGLE;
use crate::preintegration::noise::oracle::summed;
use crate::preintegration::noise::runs::DT;
use crate::preintegration::oracle::nothing;

/// Readings in all, before the error, and between two rows of the table.
const READINGS: usize = 600;
const HINGE: usize = 220;
const ROW: usize = 20;
/// The turn: its speed in m/s and its rate in rad/s.
const TURN: (f64, f64) = (2.0, 1.5);

/// The deltas after every reading, from given ones on.
fn course(from: &Deltas, samples: &[ImuSample]) -> Vec<Deltas> {
    let mut course = vec![*from];
    for sample in samples {
        let next = summed(&course[course.len() - 1], &[*sample], DT);
        course.push(next);
    }
    course
}

pub fn hinge() -> Figure {
    let samples = Trajectory::level_turn(TURN.0, TURN.1).samples(&GRAVITY, DT, READINGS);
    let right = course(&nothing(), &samples);
    let at = right[HINGE];
    let rotation = Rotation3::new(HINGE_ANGLE * Vector3::z()) * at.rotation;
    let wrong = course(&Deltas { rotation, ..at }, &samples[HINGE..]);
    let with_error = |k: usize| k.checked_sub(HINGE).map_or(right[k], |later| wrong[later]);
    let cells = |of: &dyn Fn(usize) -> f64| decimals(2, (0..=READINGS).step_by(ROW).map(of));
    let columns = vec![
        ("time (s)", cells(&|k| k as f64 * DT)),
        ("velocity ahead (m/s)", cells(&|k| right[k].velocity.x)),
        ("velocity to the left (m/s)", cells(&|k| right[k].velocity.y)),
        ("with the error: ahead (m/s)", cells(&|k| with_error(k).velocity.x)),
        ("to the left (m/s)", cells(&|k| with_error(k).velocity.y)),
        ("position ahead (m)", cells(&|k| right[k].position.x)),
        ("position to the left (m)", cells(&|k| right[k].position.y)),
        ("with the error: ahead (m)", cells(&|k| with_error(k).position.x)),
        ("to the left (m)", cells(&|k| with_error(k).position.y)),
    ];
    let lines = |of: fn(&Deltas) -> Vector3<f64>| {
        [&right, &wrong].map(|course| course.iter().map(|deltas| plane(&of(deltas))).collect())
    };
    let (velocities, positions) =
        (lines(|deltas| deltas.velocity), lines(|deltas| deltas.position));
    let later = (READINGS - HINGE) as f64 * DT;
    let straight = [plane(&at.position), plane(&(at.position + later * at.velocity))];
    Figure::new(660, columns, |drawing| {
        let (left, right) = drawing.split_horizontally(640);
        let velocity = ("ahead (m/s)", -4.9..1.2, "left (m/s)", -2.5..3.6);
        panel(&left, "velocity", velocity, &velocities, None, (-2.2, 0.0))?;
        let position = ("ahead (m)", -8.5..1.5, "left (m)", -0.6..6.0);
        panel(&right, "position", position, &positions, Some(straight), (-3.6, 1.3))
    })
}

fn plane(vector: &Vector3<f64>) -> (f64, f64) {
    (vector.x, vector.y)
}

fn panel(
    drawing: &Drawing,
    name: &str,
    (x_title, x_range, y_title, y_range): (&str, Range<f64>, &str, Range<f64>),
    [right, wrong]: &[Vec<(f64, f64)>; 2],
    straight: Option<[(f64, f64); 2]>,
    beside: (f64, f64),
) -> Drawn {
    let (middle, top) = (0.5 * (x_range.start + x_range.end), 0.97 * y_range.end);
    let mut chart = figure::axes(drawing, (x_title, x_range, 4), (y_title, y_range, 5))?;
    chart.write(name, (middle, top), letters_around(INK))?;
    if let Some([from, to]) = straight {
        let place = |k: i32| {
            let share = f64::from(k) / 20.0;
            (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1))
        };
        for dash in (0..20).step_by(2) {
            chart.line([place(dash), place(dash + 1)], INK, 3)?;
        }
    }
    chart.line(right.iter().copied(), INK, 6)?;
    chart.line(wrong.iter().copied(), SERIES[1], 6)?;
    chart.write("wrong", beside, letters_around(SERIES[1]))?;
    chart.draw_series([Circle::new(wrong[0], 14, INK.filled())])?;
    Ok(())
}
