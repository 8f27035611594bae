//! How sure of its yaw a window seems that is linearized at two estimates.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::EmptyElement;
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Figure, SERIES, marker};
use crate::observability::near::{DISAGREEMENTS, all_mixed};

pub fn yaw() -> Figure {
    let mixed = all_mixed();
    let points: Vec<_> =
        DISAGREEMENTS.into_iter().zip(mixed.iter().map(|mixed| mixed.yaw_degrees)).collect();
    let rows = points.iter().zip(mixed).map(|((size, yaw), mixed)| {
        vec![size.to_string(), mixed.free.to_string(), format!("{yaw:.3}")]
    });
    Figure {
        columns: vec![
            "difference of the estimates (rad and m and m/s)",
            "free directions",
            "sigma of yaw that is claimed (degrees)",
        ],
        rows: rows.collect(),
        svg: figure::draw(760, |drawing| {
            let x_axis = ("difference of the estimates (rad, m, m/s)", (7e-5..0.16).log_scale(), 4);
            let y_axis = ("claimed sigma of yaw (°)", (0.05..1000.0).log_scale(), 5);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            chart.draw_series(LineSeries::new(points.clone(), SERIES[1].stroke_width(4)))?;
            chart.draw_series(points.iter().map(|at| EmptyElement::at(*at) + marker(1)))?;
            Ok(())
        }),
    }
}
