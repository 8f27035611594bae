//! Which strength of gravity a constant acceleration asks for at another scale.

use nalgebra::Vector3;
use vislam::inertial::GRAVITY;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals};
use crate::observability::numbers::RAMP;
use crate::observability::readings::other_scale;

const NAMES: [&str; 3] = ["on a level road", "uphill", "downhill"];
const SCALES: [f64; 2] = [-0.4, 2.6];

fn accelerations() -> [Vector3<f64>; 3] {
    let along = |up: f64| Vector3::new(RAMP.x, RAMP.y, up);
    [along(0.0), along(RAMP.z), along(-RAMP.z)]
}

/// By how much gravity would have to be stronger than it is, in m/s².
fn excess(acceleration: &Vector3<f64>, scale: f64) -> f64 {
    (GRAVITY + (scale - 1.0) * acceleration).norm() - GRAVITY.norm()
}

fn curve(acceleration: &Vector3<f64>, steps: u32) -> Vec<(f64, f64)> {
    let at = |step: u32| SCALES[0] + (SCALES[1] - SCALES[0]) * f64::from(step) / f64::from(steps);
    (0..=steps).map(|step| (at(step), excess(acceleration, at(step)))).collect()
}

pub fn false_scale() -> Figure {
    let curves = accelerations().map(|acceleration| curve(&acceleration, 15));
    let cells = |index: usize| decimals(3, curves[index].iter().map(|(_, excess)| *excess));
    let columns = vec![
        ("scale", decimals(1, curves[0].iter().map(|(scale, _)| *scale))),
        ("excess of gravity on a level road (m/s²)", cells(0)),
        ("uphill (m/s²)", cells(1)),
        ("downhill (m/s²)", cells(2)),
    ];
    Figure::new(820, columns, |drawing| {
        let x_axis = ("scale", SCALES[0]..SCALES[1], 7);
        let y_axis = ("excess of gravity (m/s²)", -0.25..0.95, 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line(SCALES.map(|scale| (scale, 0.0)), INK, 3)?;
        for (index, acceleration) in accelerations().iter().enumerate() {
            chart.line(curve(acceleration, 90), SERIES[index], 5)?;
            chart.marks([(other_scale(acceleration, &GRAVITY), 0.0)], index)?;
            let (x, y) = (0.35, 0.88 - 0.1 * index as f64);
            chart.key(index, NAMES[index], (x, y), x + 0.06)?;
        }
        Ok(())
    })
}
