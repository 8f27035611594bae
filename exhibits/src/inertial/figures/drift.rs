//! How far a sensor drifts that nobody corrects, at rest and in flight.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::simulation::Trajectory;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};
use crate::inertial::drift::{SOURCES, TIMES, drifted, expected};

type Series = [[f64; TIMES.len()]; 4];

pub fn drift() -> Figure {
    let motions = [Trajectory::hover(), Trajectory::figure_eight()];
    let found = motions.map(|motion| SOURCES.map(|(source, _)| drifted(source, &motion)));
    let rows = SOURCES.iter().enumerate().flat_map(|(index, (source, name))| {
        let found = &found;
        TIMES.iter().enumerate().map(move |(at, t)| {
            let values = [expected(*source, *t), found[0][index][at], found[1][index][at]];
            let mut row = vec![(*name).to_owned(), format!("{t}")];
            row.extend(values.map(|value| format!("{value:.3}")));
            row
        })
    });
    Figure {
        columns: vec!["source", "time (s)", "formula (m)", "at rest (m)", "in flight (m)"],
        rows: rows.collect(),
        svg: figure::draw(1620, |drawing| {
            let (above, below) = drawing.split_vertically(860);
            panel(&above, "", "at rest", &found[0])?;
            panel(&below, "time (s)", "in flight", &found[1])
        }),
    }
}

fn panel(drawing: &Drawing, x_title: &str, name: &str, found: &Series) -> Drawn {
    let with_names = x_title.is_empty();
    let high = if with_names { 2e5 } else { 2e3 };
    let y_axis = ("drift (m)", (4e-4..high).log_scale(), 4);
    let mut chart = figure::axes(drawing, (x_title, (0.8..120.0).log_scale(), 3), y_axis)?;
    for (index, (source, source_name)) in SOURCES.iter().enumerate() {
        let colour = SERIES[index];
        let curve = (0..=40).map(|k| 60_f64.powf(f64::from(k) / 40.0));
        let curve = curve.map(|t| (t, expected(*source, t)));
        chart.draw_series(LineSeries::new(curve, colour.stroke_width(4)))?;
        let places = TIMES.iter().zip(&found[index]);
        chart
            .draw_series(places.map(|(t, drift)| EmptyElement::at((*t, *drift)) + marker(index)))?;
        if with_names {
            let place = (1.0, 6e4 / 6_f64.powi(index as i32));
            chart.draw_series([EmptyElement::at(place) + marker(index)])?;
            let beside = (1.14 * place.0, place.1);
            chart.draw_series([Text::new(*source_name, beside, letters_right_of(colour))])?;
        }
    }
    chart.draw_series([Text::new(name.to_owned(), (25.0, 2e-3), letters_right_of(INK))])?;
    Ok(())
}
