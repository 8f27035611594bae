//! Mixed conventions over the angle from the world: the rate of Gauss-Newton, and where
//! Levenberg-Marquardt ends.

use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{
    self, Drawing, Drawn, ESTIMATED, Figure, GRID, INK, SERIES, letters_around, marker,
};
use crate::reprojection::mixing::{
    OUTCOME_ANGLES, RATE_ANGLES, consistent_and_noiseless, outcomes, predicted_rate, rates,
};

pub fn mixed_outcome() -> Figure {
    let rates = RATE_ANGLES.iter().zip(rates()).map(|(angle, rate)| {
        let predicted = predicted_rate(*angle);
        let none = "none".to_owned();
        vec![
            format!("{angle}"),
            format!("{predicted:.3}"),
            format!("{rate:.3}"),
            none.clone(),
            none,
        ]
    });
    let outcomes = OUTCOME_ANGLES.iter().zip(outcomes()).map(|(angle, outcome)| {
        let (none, predicted) = ("none".to_owned(), predicted_rate(*angle));
        let (rmse, steps) = (format!("{:.3}", outcome.rmse), outcome.iterations.to_string());
        vec![format!("{angle}"), format!("{predicted:.3}"), none, rmse, steps]
    });
    Figure {
        columns: vec![
            "largest angle from the world (°)",
            "predicted rate",
            "measured rate of Gauss-Newton",
            "RMSE at the end of Levenberg-Marquardt (px)",
            "its steps",
        ],
        rows: rates.chain(outcomes).collect(),
        svg: figure::draw(1180, |drawing| {
            let (above, below) = drawing.split_vertically(620);
            rate_panel(&above)?;
            outcome_panel(&below)
        }),
    }
}

fn rate_panel(drawing: &Drawing) -> Drawn {
    let y_axis = ("error left per step", 0.0..1.6, 4);
    let mut chart = figure::axes(drawing, ("largest angle (°)", 0.0..125.0, 6), y_axis)?;
    chart.draw_series([PathElement::new([(0.0, 1.0), (125.0, 1.0)], INK.stroke_width(3))])?;
    chart.draw_series([PathElement::new([(60.0, 0.0), (60.0, 1.6)], GRID.stroke_width(4))])?;
    let curve = (0..=104).map(f64::from).map(|angle| (angle, predicted_rate(angle)));
    chart.draw_series(LineSeries::new(curve, SERIES[0].stroke_width(5)))?;
    let measured = RATE_ANGLES.iter().zip(rates());
    chart.draw_series(measured.map(|(x, y)| EmptyElement::at((*x, *y)) + marker(1)))?;
    chart.draw_series([Text::new("shrinks", (90.0, 0.87), letters_around(INK))])?;
    chart.draw_series([Text::new("grows", (30.0, 1.12), letters_around(INK))])?;
    Ok(())
}

fn outcome_panel(drawing: &Drawing) -> Drawn {
    let y_axis = ("RMSE (px)", 0.0..14.0, 5);
    let mut chart = figure::axes(drawing, ("largest angle (°)", 0.0..125.0, 6), y_axis)?;
    let optimum = consistent_and_noiseless(4).0.rmse;
    let line = [(0.0, optimum), (125.0, optimum)];
    chart.draw_series([PathElement::new(line, ESTIMATED.stroke_width(5))])?;
    chart.draw_series([Text::new("the optimum", (98.0, 2.3), letters_around(ESTIMATED))])?;
    let ends = OUTCOME_ANGLES.iter().zip(outcomes());
    let ends: Vec<_> = ends.map(|(angle, outcome)| (*angle, outcome.rmse)).collect();
    chart.draw_series(ends.iter().map(|place| EmptyElement::at(*place) + marker(2)))?;
    Ok(())
}
