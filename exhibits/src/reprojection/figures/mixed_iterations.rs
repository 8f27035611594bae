//! The error over the iterations of Gauss-Newton, for conventions that agree and for mixed ones.

use plotters::element::{EmptyElement, Text};
use plotters::series::{DashedLineSeries, LineSeries};
use plotters::style::Color;

use crate::figure::{self, Figure, INK, SERIES, letters_around, letters_right_of, marker};
use crate::reprojection::mixing::{Convention, Experiment, FAR_START, predicted_rate};

/// Degrees by which the camera that is turned most is turned from the world.
const ANGLES: [f64; 4] = [14.1, 40.0, 55.0, 70.0];
const STEPS: usize = 24;
/// Power of ten below which an error is left out.
const LOWEST: f64 = -13.0;

pub fn mixed_iterations() -> Figure {
    let consistent = run(ANGLES[0], Convention::Consistent);
    let mixed = ANGLES.map(|angle| run(angle, Convention::Mixed));
    let rows = (0..=STEPS).map(|step| {
        let cell =
            |errors: &[f64]| errors.get(step).map_or("none".to_owned(), |e| format!("{e:.1e}"));
        let mut row = vec![step.to_string(), cell(&consistent)];
        row.extend(mixed.iter().map(|errors| cell(errors)));
        row
    });
    Figure {
        columns: vec![
            "steps",
            "error with one convention",
            "error of mixed conventions at 14.1°",
            "at 40°",
            "at 55°",
            "at 70°",
        ],
        rows: rows.collect(),
        svg: draw(&consistent, &mixed),
    }
}

fn run(angle: f64, convention: Convention) -> Vec<f64> {
    let experiment = Experiment::new(0.0, angle, FAR_START);
    experiment.errors(convention, &experiment.truth(), STEPS)
}

fn draw(consistent: &[f64], mixed: &[Vec<f64>; 4]) -> String {
    figure::draw(900, |drawing| {
        let x_axis = ("Gauss-Newton steps", 0.0..29.0, 6);
        let y_axis = ("error, as a power of ten", LOWEST..1.5, 8);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        let place = |(step, error): (usize, &f64)| (step as f64, error.log10());
        let visible = |errors: &[f64]| -> Vec<(f64, f64)> {
            errors.iter().enumerate().map(place).take_while(|place| place.1 > LOWEST).collect()
        };
        chart.draw_series(LineSeries::new(visible(consistent), INK.stroke_width(6)))?;
        chart.draw_series([Text::new("one convention", (6.9, -11.9), letters_around(INK))])?;
        for (index, errors) in mixed.iter().enumerate() {
            let colour = SERIES[index];
            let places = visible(errors);
            let &(last, height) = places.last().expect("the first error is visible");
            let slope = predicted_rate(ANGLES[index]).log10();
            let from = (last - 12.0).max(0.0);
            let predicted = [(from, height + slope * (from - last)), (last, height)];
            let line = DashedLineSeries::new(predicted, 12, 10, colour.stroke_width(4));
            chart.draw_series(line)?;
            chart
                .draw_series(places.iter().map(|place| EmptyElement::at(*place) + marker(index)))?;
            let name = format!("{:.0}°", ANGLES[index]);
            let beside = (last + 0.8, height + if index == 0 { 0.4 } else { 0.0 });
            chart.draw_series([Text::new(name, beside, letters_right_of(colour))])?;
        }
        Ok(())
    })
}
