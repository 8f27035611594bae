//! The error over the iterations of Gauss-Newton, for conventions that agree and for mixed ones.

use plotters::series::DashedLineSeries;
use plotters::style::Color;

use crate::figure::{self, Draw, Figure, INK, SERIES, letters_around, letters_right_of, powers};
use crate::reprojection::mixing::{Convention, Experiment, FAR_START, predicted_rate};

/// Degrees by which the camera that is turned most is turned from the world.
const ANGLES: [f64; 4] = [14.1, 40.0, 55.0, 70.0];
const STEPS: usize = 24;
/// Power of ten below which an error is left out.
const LOWEST: f64 = -13.0;

pub fn mixed_iterations() -> Figure {
    let consistent = run(ANGLES[0], Convention::Consistent);
    let mixed = ANGLES.map(|angle| run(angle, Convention::Mixed));
    let cells = |errors: &[f64]| {
        let mut cells = powers(1, errors.iter().copied());
        cells.resize(STEPS + 1, "none".to_owned());
        cells
    };
    let columns = vec![
        ("steps", (0..=STEPS).map(|step| step.to_string()).collect()),
        ("error with one convention", cells(&consistent)),
        ("error of mixed conventions at 14.1°", cells(&mixed[0])),
        ("at 40°", cells(&mixed[1])),
        ("at 55°", cells(&mixed[2])),
        ("at 70°", cells(&mixed[3])),
    ];
    Figure::new(900, columns, |drawing| {
        let x_axis = ("Gauss-Newton steps", 0.0..29.0, 6);
        let y_axis = ("error, as a power of ten", LOWEST..1.5, 8);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line(visible(&consistent), INK, 6)?;
        chart.write("one convention", (6.9, -11.9), letters_around(INK))?;
        for (index, errors) in mixed.iter().enumerate() {
            let colour = SERIES[index];
            let places = visible(errors);
            let &(last, height) = places.last().expect("the first error is visible");
            let slope = predicted_rate(ANGLES[index]).log10();
            let from = (last - 12.0).max(0.0);
            let predicted = [(from, height + slope * (from - last)), (last, height)];
            chart.draw_series(DashedLineSeries::new(predicted, 12, 10, colour.stroke_width(4)))?;
            chart.marks(places, index)?;
            let beside = (last + 0.8, height + if index == 0 { 0.4 } else { 0.0 });
            chart.write(&format!("{:.0}°", ANGLES[index]), beside, letters_right_of(colour))?;
        }
        Ok(())
    })
}

fn run(angle: f64, convention: Convention) -> Vec<f64> {
    let experiment = Experiment::new(0.0, angle, FAR_START);
    experiment.errors(convention, &experiment.truth(), STEPS)
}

/// Decimal logarithms of the errors over the steps, as far as they are drawn.
fn visible(errors: &[f64]) -> Vec<(f64, f64)> {
    let places = errors.iter().enumerate().map(|(step, error)| (step as f64, error.log10()));
    places.take_while(|place| place.1 > LOWEST).collect()
}
