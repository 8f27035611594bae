//! How sure of its yaw a window seems that is linearized at two estimates.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals};
use crate::observability::near::{DISAGREEMENTS, all_mixed};

pub fn yaw() -> Figure {
    let mixed = all_mixed();
    let yaws = mixed.each_ref().map(|mixed| mixed.yaw_degrees);
    let sizes = DISAGREEMENTS.map(|size| size.to_string()).to_vec();
    let columns = vec![
        ("difference of the estimates (rad and m and m/s)", sizes),
        ("free directions", mixed.iter().map(|mixed| mixed.free.to_string()).collect()),
        ("sigma of yaw that is claimed (degrees)", decimals(3, yaws)),
    ];
    Figure::new(760, columns, |drawing| {
        let x_axis = ("difference of the estimates (rad, m, m/s)", (7e-5..0.16).log_scale(), 4);
        let y_axis = ("claimed sigma of yaw (°)", (0.05..1000.0).log_scale(), 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line(DISAGREEMENTS.into_iter().zip(yaws), SERIES[1], 4)?;
        chart.marks(DISAGREEMENTS.into_iter().zip(yaws), 1)
    })
}
