//! What a filter believes of its yaw while it hovers.

use crate::figure::{self, Draw, Figure, SERIES, decimals, plain};
use crate::filtering::hover::{SECONDS, TIMES, told};

pub fn hover() -> Figure {
    let curves = [
        told("latest", "sigma"),
        told("latest", "error"),
        told("first", "sigma"),
        told("first", "error"),
    ];
    let columns = vec![
        ("time (s)", plain(TIMES)),
        ("sigma of the yaw, latest estimates (°)", decimals(2, curves[0])),
        ("error of the yaw", decimals(2, curves[1])),
        ("sigma, first estimates", decimals(2, curves[2])),
        ("error", decimals(2, curves[3])),
    ];
    Figure::new(900, columns, |drawing| {
        let most = curves.iter().flatten().fold(0.0_f64, |most, value| most.max(*value));
        let y_axis = ("yaw (°)", 0.0..1.35 * most, 5);
        let mut chart = figure::axes(drawing, ("time (s)", 0.0..SECONDS, 6), y_axis)?;
        let names = ["believed, latest", "error, latest", "believed, first", "error, first"];
        for (index, curve) in curves.iter().enumerate() {
            chart.line(TIMES.into_iter().zip(*curve), SERIES[index], 4)?;
            chart.marks(TIMES.into_iter().zip(*curve), index)?;
            let (x, row) = (if index < 2 { 3.0 } else { 33.0 }, index % 2);
            let y = most * (1.27 - 0.11 * row as f64);
            chart.key(index, names[index], (x, y), x + 1.2)?;
        }
        Ok(())
    })
}
