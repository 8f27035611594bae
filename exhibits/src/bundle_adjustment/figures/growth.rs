//! Time and memory of an iteration over the number of observations, from the accepted record.

use plotters::coord::combinators::IntoLogRange;

use crate::bundle_adjustment::growth::{above_line, line, observations, recorded};
use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, geometric};

const NAMES: [&str; 2] = ["time (ms)", "memory (MB)"];

pub fn growth() -> Figure {
    let (n, recorded) = (observations(), recorded());
    let residuals = recorded.each_ref().map(above_line);
    let columns = vec![
        ("observations", decimals(0, n)),
        ("time of an iteration (ms)", decimals(3, recorded[0])),
        ("above its line (%)", decimals(2, residuals[0])),
        ("memory (MB)", decimals(3, recorded[1])),
        ("above its line (%)", decimals(2, residuals[1])),
    ];
    Figure::new(1280, columns, |drawing| {
        let (above, below) = drawing.split_vertically(740);
        values_panel(&above, &n, &recorded)?;
        residuals_panel(&below, &n, &residuals)
    })
}

fn values_panel(drawing: &Drawing, n: &[f64; 5], recorded: &[[f64; 5]; 2]) -> Drawn {
    let lowest = recorded.iter().flatten().fold(f64::INFINITY, |a, b| a.min(*b));
    let highest = recorded.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
    let y_axis = ("ms, MB", (0.5 * lowest..4.0 * highest).log_scale(), 4);
    let mut chart = figure::axes(drawing, ("", (7e3..1.5e6).log_scale(), 3), y_axis)?;
    for (index, values) in recorded.iter().enumerate() {
        let (start, slope) = line(n, values);
        chart.line(geometric(1e4, 100.0, 40).map(|n| (n, start + slope * n)), SERIES[index], 5)?;
        chart.marks(n.iter().copied().zip(*values), index)?;
        let (x, y) = (1e4, highest * [2.0, 0.7][index]);
        chart.key(index, NAMES[index], (x, y), 1.15 * x)?;
    }
    Ok(())
}

fn residuals_panel(drawing: &Drawing, n: &[f64; 5], residuals: &[[f64; 5]; 2]) -> Drawn {
    let largest = residuals.iter().flatten().fold(1.0_f64, |a, b| a.max(b.abs()));
    let y_axis = ("above the line (%)", -1.3 * largest..1.3 * largest, 5);
    let mut chart = figure::axes(drawing, ("observations", (7e3..1.5e6).log_scale(), 3), y_axis)?;
    chart.line([(7e3, 0.0), (1.5e6, 0.0)], INK, 3)?;
    for (index, residuals) in residuals.iter().enumerate() {
        chart.marks(n.iter().copied().zip(*residuals), index)?;
    }
    Ok(())
}
