//! How much too sure a covariance is of an attitude whose noise has a memory.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Figure, INK, SERIES, letters_right_of, marker};
use crate::preintegration::noise::correlated::{attitude_runs, too_sure};
use crate::preintegration::noise::runs::DT;

/// Seconds over which the noise forgets.
const MEMORIES: [f64; 3] = [0.05, 0.02, 0.005];
const READINGS: [usize; 8] = [1, 3, 7, 16, 36, 84, 200, 400];
const RUNS: usize = 600;

pub fn correlated() -> Figure {
    let runs = MEMORIES.map(|memory| attitude_runs(memory, &READINGS, RUNS));
    let rows = READINGS.iter().enumerate().map(|(index, readings)| {
        let mut row = vec![format!("{:.3}", *readings as f64 * DT)];
        for (memory, runs) in MEMORIES.iter().zip(&runs) {
            row.extend([too_sure(*readings, *memory), runs[index]].map(|of| format!("{of:.2}")));
        }
        row
    });
    Figure {
        columns: vec![
            "time (s)",
            "actual over predicted with a memory of 50 ms",
            "in runs",
            "with 20 ms",
            "in runs",
            "with 5 ms",
            "in runs",
        ],
        rows: rows.collect(),
        svg: figure::draw(760, |drawing| {
            let x_axis = ("time (s)", (0.004..7.0).log_scale(), 4);
            let mut chart = figure::axes(drawing, x_axis, ("actual / predicted", 0.0..5.0, 6))?;
            let white = [(0.004, 1.0), (2.3, 1.0)];
            chart.draw_series([PathElement::new(white, INK.stroke_width(4))])?;
            chart.draw_series([Text::new("white", (2.6, 0.98), letters_right_of(INK))])?;
            for (index, memory) in MEMORIES.into_iter().enumerate() {
                let curve = (0..=80).map(|step| 400_f64.powf(f64::from(step) / 80.0).round());
                let curve = curve.map(|n| (n * DT, too_sure(n as usize, memory)));
                chart.draw_series(LineSeries::new(curve, SERIES[index].stroke_width(5)))?;
                let places = READINGS.iter().zip(&runs[index]);
                chart.draw_series(places.map(|(n, ratio)| {
                    EmptyElement::at((*n as f64 * DT, *ratio)) + marker(index)
                }))?;
                let beside = (2.6, too_sure(400, memory));
                let name = format!("{} ms", 1e3 * memory);
                chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[index]))])?;
            }
            Ok(())
        }),
    }
}
