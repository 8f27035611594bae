//! How far each keyframe leans the wrong way.

use nalgebra::{Isometry3, Vector3};

use crate::figure::{self, Draw, Figure, decimals};
use crate::loop_closure::flight::{example, shown};

/// One keyframe in so many has a row of data.
const ROWS: usize = 4;

/// The angle between the vertical of a pose and the true one, in milliradians.
fn lean(pose: &Isometry3<f64>, truth: &Isometry3<f64>) -> f64 {
    let up = |pose: &Isometry3<f64>| pose.rotation.inverse() * Vector3::z();
    1e3 * up(pose).angle(&up(truth))
}

pub fn tilt() -> Figure {
    let closed = shown();
    let leans = |poses: &[Isometry3<f64>]| -> Vec<f64> {
        let pairs = poses.iter().zip(&closed.keyframes.truth);
        pairs.map(|(pose, truth)| lean(pose, &truth.pose())).collect()
    };
    let (six, four) = (leans(&closed.six), leans(&closed.four));
    let flight = example::flight();
    let seconds = |at: usize| closed.keyframes.pictures[at] as f64 / flight.picture_rate;
    let times: Vec<f64> = (0..four.len()).map(seconds).collect();
    let columns = vec![
        ("time (s)", decimals(1, times.iter().copied().step_by(ROWS))),
        (
            "tilt error in six degrees of freedom (mrad)",
            decimals(2, six.iter().copied().step_by(ROWS)),
        ),
        ("in four, and of the filter (mrad)", decimals(2, four.iter().copied().step_by(ROWS))),
    ];
    Figure::new(760, columns, |drawing| {
        let highest = 1.25 * six.iter().chain(&four).fold(0.0_f64, |most, lean| most.max(*lean));
        let y_axis = ("tilt error (mrad)", 0.0..highest, 6);
        let mut chart = figure::axes(drawing, ("time (s)", 0.0..160.0, 9), y_axis)?;
        for (series, leans) in [(1, &six), (0, &four)] {
            let points = times.iter().copied().zip(leans.iter().copied());
            chart.line(points.clone(), figure::SERIES[series], 5)?;
            chart.marks(points.step_by(12).collect::<Vec<_>>(), series)?;
        }
        chart.key(1, "six degrees of freedom", (6.0, 0.94 * highest), 9.0)?;
        chart.key(0, "four", (90.0, 0.94 * highest), 93.0)
    })
}
