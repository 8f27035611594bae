//! What a turn of the attitude at one time does to velocity and position afterwards.

use std::ops::Range;

use nalgebra::{Rotation3, Vector3};
use plotters::element::{Circle, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::{GRAVITY, ImuSample};
use vislam::preintegration::Deltas;
use vislam::simulation::Trajectory;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_around};
use crate::preintegration::noise::growth::HINGE_ANGLE;
use crate::preintegration::noise::oracle::{nothing, summed};
use crate::preintegration::noise::runs::DT;

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
    let rows = (0..=READINGS).step_by(ROW).map(|k| {
        let after = k.checked_sub(HINGE).map_or(right[k], |later| wrong[later]);
        let values = [right[k].velocity, after.velocity, right[k].position, after.position];
        let cells = values.into_iter().flat_map(|value| [value.x, value.y]);
        let cells = std::iter::once(k as f64 * DT).chain(cells);
        cells.map(|value| format!("{value:.2}")).collect()
    });
    let plane = |vector: &Vector3<f64>| (vector.x, vector.y);
    let velocity_of = |deltas: &Deltas| plane(&deltas.velocity);
    let position_of = |deltas: &Deltas| plane(&deltas.position);
    let lines = |of: &dyn Fn(&Deltas) -> (f64, f64)| {
        [&right, &wrong].map(|course| course.iter().map(of).collect::<Vec<_>>())
    };
    let later = (READINGS - HINGE) as f64 * DT;
    let straight = [plane(&at.position), plane(&(at.position + later * at.velocity))];
    Figure {
        columns: vec![
            "time (s)",
            "velocity ahead (m/s)",
            "velocity to the left (m/s)",
            "with the error: ahead (m/s)",
            "to the left (m/s)",
            "position ahead (m)",
            "position to the left (m)",
            "with the error: ahead (m)",
            "to the left (m)",
        ],
        rows: rows.collect(),
        svg: figure::draw(660, |drawing| {
            let (left, right) = drawing.split_horizontally(640);
            let velocity = ("ahead (m/s)", -4.9..1.2, "left (m/s)", -2.5..3.6);
            panel(&left, "velocity", velocity, &lines(&velocity_of), None, (-2.2, 0.0))?;
            let position = ("ahead (m)", -8.5..1.5, "left (m)", -0.6..6.0);
            panel(&right, "position", position, &lines(&position_of), Some(straight), (-3.6, 1.3))
        }),
    }
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
    chart.draw_series([Text::new(name.to_owned(), (middle, top), letters_around(INK))])?;
    if let Some([from, to]) = straight {
        for dash in (0..20).step_by(2) {
            let part = |k: i32| f64::from(k) / 20.0;
            let place = |s: f64| (from.0 + s * (to.0 - from.0), from.1 + s * (to.1 - from.1));
            let ends = [place(part(dash)), place(part(dash + 1))];
            chart.draw_series([PathElement::new(ends, INK.stroke_width(3))])?;
        }
    }
    chart.draw_series(LineSeries::new(right.iter().copied(), INK.stroke_width(6)))?;
    chart.draw_series(LineSeries::new(wrong.iter().copied(), SERIES[1].stroke_width(6)))?;
    let wrongly = Text::new("wrong", beside, letters_around(SERIES[1]));
    chart.draw_series([wrongly])?;
    chart.draw_series([Circle::new(wrong[0], 14, INK.filled())])?;
    Ok(())
}
