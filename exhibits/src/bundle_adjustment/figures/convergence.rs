//! Cost and scaled gradient over the iterations, on the ring and on the street.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::style::Color;
use vislam::bundle_adjustment::BaReport;

use crate::bundle_adjustment::progress::{self, solved};
use crate::figure::{self, Drawing, Drawn, Figure, SERIES, letters_right_of, marker};

const NAMES: [&str; 2] = ["street", "ring"];

/// The last iteration on the axis.
const LAST: f64 = 16.4;

pub fn convergence() -> Figure {
    let reports = [solved(progress::street()), solved(progress::ring())];
    let mut rows = Vec::new();
    for (name, report) in NAMES.iter().zip(&reports) {
        for (index, step) in report.iterations.iter().enumerate() {
            rows.push(vec![
                (*name).to_owned(),
                format!("{index}"),
                format!("{:.6e}", step.cost),
                format!("{:.2e}", step.gradient_norm),
                format!("{:.1e}", step.damping),
                format!("{:.3}", step.gain_ratio.unwrap_or(f64::NAN)),
                if step.accepted { "yes" } else { "no" }.to_owned(),
            ]);
        }
    }
    Figure {
        columns: vec!["scene", "iteration", "cost", "gradient", "damping", "gain", "step taken"],
        rows,
        svg: figure::draw(1220, |drawing| {
            let (above, below) = drawing.split_vertically(590);
            costs(&above, &reports)?;
            gradients(&below, &reports)
        }),
    }
}

fn costs(drawing: &Drawing, reports: &[BaReport; 2]) -> Drawn {
    let range = (1e2..1e6).log_scale();
    let mut chart = figure::axes(drawing, ("", -0.3..LAST, 7), ("cost", range, 5))?;
    for (index, report) in reports.iter().enumerate() {
        let mut places: Vec<_> =
            report.iterations.iter().enumerate().map(|(i, step)| (i as f64, step.cost)).collect();
        places.push((places.len() as f64, report.cost));
        let name = if index == 0 { (6.0, 3.0 * report.cost) } else { (5.5, report.cost) };
        chart.draw_series([PathElement::new(places.clone(), SERIES[index].stroke_width(4))])?;
        let marks = places.into_iter().map(|place| EmptyElement::at(place) + marker(index));
        chart.draw_series(marks)?;
        chart.draw_series([Text::new(NAMES[index], name, letters_right_of(SERIES[index]))])?;
    }
    Ok(())
}

fn gradients(drawing: &Drawing, reports: &[BaReport; 2]) -> Drawn {
    let y_axis = ("log\u{2081}\u{2080} of scaled gradient", -4.0..4.0, 5);
    let mut chart = figure::axes(drawing, ("iteration", -0.3..LAST, 7), y_axis)?;
    for (index, report) in reports.iter().enumerate() {
        let places: Vec<_> = report
            .iterations
            .iter()
            .enumerate()
            .map(|(i, step)| (i as f64, step.gradient_norm.log10()))
            .collect();
        chart.draw_series([PathElement::new(places.clone(), SERIES[index].stroke_width(4))])?;
        let marks = places.into_iter().map(|place| EmptyElement::at(place) + marker(index));
        chart.draw_series(marks)?;
    }
    Ok(())
}
