//! Time and memory of an iteration over the number of observations, from the accepted record.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::bundle_adjustment::growth::{above_line, line, observations, recorded};
use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};

const NAMES: [&str; 2] = ["time (ms)", "memory (MB)"];

pub fn growth() -> Figure {
    let (n, recorded) = (observations(), recorded());
    let residuals = recorded.each_ref().map(above_line);
    let rows = n.iter().enumerate().map(|(index, n)| {
        let mut row = vec![format!("{n}")];
        for (values, residuals) in recorded.iter().zip(&residuals) {
            row.extend([format!("{:.3}", values[index]), format!("{:.2}", residuals[index])]);
        }
        row
    });
    Figure {
        columns: vec![
            "observations",
            "time of an iteration (ms)",
            "above its line (%)",
            "memory (MB)",
            "above its line (%)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1280, |drawing| {
            let (above, below) = drawing.split_vertically(740);
            values_panel(&above, &n, &recorded)?;
            residuals_panel(&below, &n, &residuals)
        }),
    }
}

fn values_panel(drawing: &Drawing, n: &[f64], recorded: &[[f64; 5]; 2]) -> Drawn {
    let lowest = recorded.iter().flatten().fold(f64::INFINITY, |a, b| a.min(*b));
    let highest = recorded.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
    let y_axis = ("ms, MB", (0.5 * lowest..4.0 * highest).log_scale(), 4);
    let mut chart = figure::axes(drawing, ("", (7e3..1.5e6).log_scale(), 3), y_axis)?;
    for (index, values) in recorded.iter().enumerate() {
        let (start, slope) = line(n, values);
        let curve = (0..=40).map(|step| 1e4 * 100_f64.powf(f64::from(step) / 40.0));
        let curve = curve.map(|n| (n, start + slope * n));
        chart.draw_series(LineSeries::new(curve, SERIES[index].stroke_width(5)))?;
        let places = n.iter().zip(values);
        chart
            .draw_series(places.map(|(n, value)| EmptyElement::at((*n, *value)) + marker(index)))?;
        let place = (1e4, highest * [2.0, 0.7][index]);
        chart.draw_series([EmptyElement::at(place) + marker(index)])?;
        let beside = (1.15 * place.0, place.1);
        chart.draw_series([Text::new(NAMES[index], beside, letters_right_of(SERIES[index]))])?;
    }
    Ok(())
}

fn residuals_panel(drawing: &Drawing, n: &[f64], residuals: &[[f64; 5]; 2]) -> Drawn {
    let largest = residuals.iter().flatten().fold(1.0_f64, |a, b| a.max(b.abs()));
    let y_axis = ("above the line (%)", -1.3 * largest..1.3 * largest, 5);
    let mut chart = figure::axes(drawing, ("observations", (7e3..1.5e6).log_scale(), 3), y_axis)?;
    chart.draw_series([PathElement::new([(7e3, 0.0), (1.5e6, 0.0)], INK.stroke_width(3))])?;
    for (index, residuals) in residuals.iter().enumerate() {
        let places = n.iter().zip(residuals);
        chart.draw_series(
            places.map(|(n, residual)| EmptyElement::at((*n, *residual)) + marker(index)),
        )?;
    }
    Ok(())
}
