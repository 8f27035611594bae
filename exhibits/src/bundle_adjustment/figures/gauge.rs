//! One estimate in three gauges.

use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::bundle_adjustment::gauge::{CAMERAS, Covariances};
use crate::figure::{self, Figure, SERIES, letters_right_of, marker};

const NAMES: [&str; 3] = ["camera 0 held", "camera 4 held", "shortest"];

pub fn gauge() -> Figure {
    let covariances = Covariances::of_ring();
    let sigma = |gauge| (0..CAMERAS).map(move |k| (gauge, k));
    let sigmas: Vec<Vec<f64>> = (0..3)
        .map(|gauge| sigma(gauge).map(|(gauge, k)| covariances.position_mm(gauge, k)).collect())
        .collect();
    let rows = (0..CAMERAS).map(|camera| {
        let mut row = vec![camera.to_string()];
        row.extend(sigmas.iter().map(|of| format!("{:.2}", of[camera])));
        row
    });
    Figure {
        columns: vec![
            "camera",
            "with camera 0 held (mm)",
            "with camera 4 held (mm)",
            "with nothing held and shortest steps (mm)",
        ],
        rows: rows.collect(),
        svg: figure::draw(780, |drawing| {
            let highest = sigmas.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
            let x_axis = ("camera", -0.4..7.4, 8);
            let y_axis = ("position, standard deviation (mm)", -0.06 * highest..1.42 * highest, 5);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            for (index, of) in sigmas.iter().enumerate() {
                let places: Vec<_> =
                    of.iter().enumerate().map(|(camera, sigma)| (camera as f64, *sigma)).collect();
                let line = LineSeries::new(places.clone(), SERIES[index].stroke_width(4));
                chart.draw_series(line)?;
                chart.draw_series(
                    places.iter().map(|place| EmptyElement::at(*place) + marker(index)),
                )?;
                // A legend above the curves.
                let place = (2.55 * index as f64 - 0.15, 1.32 * highest);
                chart.draw_series([EmptyElement::at(place) + marker(index)])?;
                let beside = (place.0 + 0.17, place.1);
                chart.draw_series([Text::new(
                    NAMES[index],
                    beside,
                    letters_right_of(SERIES[index]),
                )])?;
            }
            Ok(())
        }),
    }
}
