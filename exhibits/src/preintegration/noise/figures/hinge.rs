//! What a turn of the attitude at one time does to velocity and position afterwards.

use nalgebra::{Rotation3, Vector3};
use plotters::element::{Circle, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::{GRAVITY, ImuSample, Motion};
use vislam::preintegration::Deltas;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of};
use crate::preintegration::noise::growth::HINGE_ANGLE;
use crate::preintegration::noise::oracle::{nothing, summed};
use crate::preintegration::noise::runs::DT;

/// Readings in all, before the error, and between two rows of the table.
const READINGS: usize = 400;
const HINGE: usize = 160;
const ROW: usize = 20;

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
    let samples = Motion::figure_eight().samples(&GRAVITY, DT, READINGS);
    let right = course(&nothing(), &samples);
    let at = right[HINGE];
    let rotation = Rotation3::new(HINGE_ANGLE * Vector3::y()) * at.rotation;
    let wrong = course(&Deltas { rotation, ..at }, &samples[HINGE..]);
    let rows = (0..=READINGS).step_by(ROW).map(|k| {
        let after = k.checked_sub(HINGE).map_or(right[k], |later| wrong[later]);
        let values = [right[k].velocity, after.velocity, right[k].position, after.position];
        let cells = values.into_iter().flat_map(|value| [value.x, value.z]);
        let cells = std::iter::once(k as f64 * DT).chain(cells);
        cells.map(|value| format!("{value:.2}")).collect()
    });
    let plane = |vector: &Vector3<f64>| (vector.x, vector.z);
    let velocity = |deltas: &Deltas| plane(&deltas.velocity);
    let position = |deltas: &Deltas| plane(&deltas.position);
    let lines = |of: &dyn Fn(&Deltas) -> (f64, f64)| {
        [&right, &wrong].map(|course| course.iter().map(of).collect::<Vec<_>>())
    };
    let later = (READINGS - HINGE) as f64 * DT;
    let straight = [plane(&at.position), plane(&(at.position + later * at.velocity))];
    Figure {
        columns: vec![
            "time (s)",
            "velocity ahead (m/s)",
            "velocity up (m/s)",
            "with the error: ahead (m/s)",
            "up (m/s)",
            "position ahead (m)",
            "position up (m)",
            "with the error: ahead (m)",
            "up (m)",
        ],
        rows: rows.collect(),
        svg: figure::draw(860, |drawing| {
            let (left, right) = drawing.split_horizontally(640);
            panel(&left, ["velocity ahead (m/s)", "up (m/s)"], &lines(&velocity), None)?;
            panel(&right, ["position ahead (m)", "up (m)"], &lines(&position), Some(straight))
        }),
    }
}

fn panel(
    drawing: &Drawing,
    titles: [&str; 2],
    [right, wrong]: &[Vec<(f64, f64)>; 2],
    straight: Option<[(f64, f64); 2]>,
) -> Drawn {
    let x_axis = (titles[0], -5.5..8.5, 4);
    let mut chart = figure::axes(drawing, x_axis, (titles[1], 0.0..22.0, 5))?;
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
    chart.draw_series([Circle::new(wrong[0], 14, INK.filled())])?;
    let name = Text::new("hinge", (wrong[0].0 + 0.8, wrong[0].1), letters_right_of(INK));
    chart.draw_series([name])?;
    Ok(())
}
