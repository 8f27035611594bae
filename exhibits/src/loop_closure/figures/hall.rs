//! The flight from above, with its errors drawn larger than they are.

use nalgebra::Vector3;

use crate::figure::{
    self, Draw, Figure, GRID, INK, SERIES, decimals, letters_around, letters_right_of,
};
use crate::loop_closure::flight::shown;

/// One loop in so many is drawn.
const LOOPS: usize = 5;
/// One keyframe in so many has a row of data.
const ROWS: usize = 4;

pub fn hall() -> Figure {
    let closed = shown();
    let truth: Vec<Vector3<f64>> =
        closed.keyframes.truth.iter().map(|state| state.position).collect();
    let errors = [&closed.graph.poses, &closed.four].map(|poses| closed.off(poses));
    let [odometry, four] = errors.each_ref().map(|off| closed.drawn(off));
    let lengths = |way: usize| {
        decimals(1, errors[way].iter().step_by(ROWS).map(|error| 100.0 * error.norm()))
    };
    let columns = vec![
        ("x (m)", decimals(2, truth.iter().step_by(ROWS).map(|place| place.x))),
        ("y (m)", decimals(2, truth.iter().step_by(ROWS).map(|place| place.y))),
        ("error of odometry (cm)", lengths(0)),
        ("after closing loops (cm)", lengths(1)),
    ];
    let pair = |place: &Vector3<f64>| (place.x, place.y);
    Figure::new(980, columns, |drawing| {
        let axes = [("x (m)", -44.0..44.0, 9), ("y (m)", -33.0..33.0, 7)];
        let [x_axis, y_axis] = axes;
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line(truth.iter().map(pair), GRID, 9)?;
        for seen in closed.loops().iter().step_by(LOOPS) {
            chart.line([seen.first, seen.second].map(|at| pair(&odometry[at])), INK, 3)?;
        }
        chart.line(odometry.iter().map(pair), SERIES[1], 4)?;
        chart.line(four.iter().map(pair), SERIES[0], 4)?;
        let every = |places: &[Vector3<f64>]| -> Vec<(f64, f64)> {
            places.iter().step_by(17).map(pair).collect()
        };
        chart.marks(every(&odometry), 1)?;
        chart.marks(every(&four), 0)?;
        chart.key(1, "odometry", (-14.0, 6.0), -12.0)?;
        chart.key(0, "loops closed, four", (-14.0, 1.0), -12.0)?;
        chart.write("thick: the truth", (-15.0, -4.0), letters_right_of(INK))?;
        chart.write("thin: loops", (-15.0, -9.0), letters_right_of(INK))?;
        let ends = [("start", 0), ("end", truth.len() - 1)];
        for (name, at) in ends {
            let (x, y) = pair(&truth[at]);
            chart.dots([(x, y)], 9, INK)?;
            chart.write(name, (0.8 * x, 0.8 * y), letters_around(INK))?;
        }
        Ok(())
    })
}
