//! Normalized errors of the smoother over a hundred flights, by block and time, with their bands.

use plotters::element::Rectangle;
use plotters::style::Color;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around};
use crate::smoother::consistency::{BLOCKS, TIMES, bands, recorded};

/// What stands above each block.
const NAMES: [&str; BLOCKS.len()] = ["yaw", "tilt", "velocity", "position", "gyro", "accel."];

pub fn nees() -> Figure {
    let (means, bands) = (BLOCKS.map(|(block, _)| recorded(block)), bands());
    let each =
        || BLOCKS.iter().zip(&bands).flat_map(|(block, band)| TIMES.map(|_| (block.0, *band)));
    let columns = vec![
        ("block", each().map(|(block, _)| block.to_owned()).collect()),
        ("time (s)", BLOCKS.iter().flat_map(|_| TIMES.map(|time| time.to_string())).collect()),
        ("mean NEES, divided", decimals(2, means.iter().flatten().copied())),
        ("band from", decimals(2, each().map(|(_, band)| band.low))),
        ("to", decimals(2, each().map(|(_, band)| band.high))),
    ];
    Figure::new(820, columns, |drawing| {
        let highest = means.iter().flatten().copied().chain(bands.iter().map(|band| band.high));
        let highest = highest.fold(1.0, f64::max);
        let right = BLOCKS.len() as f64;
        let y_axis = ("mean normalized error squared", 0.0..1.25 * highest, 6);
        let mut chart = figure::axes(drawing, ("", 0.0..right, 0), y_axis)?;
        chart.line([(0.0, 1.0), (right, 1.0)], INK, 2)?;
        for (at, (name, (means, band))) in NAMES.iter().zip(means.iter().zip(&bands)).enumerate() {
            let (left, series) = (at as f64, at % 4);
            let corners = [(left + 0.08, band.low), (left + 0.92, band.high)];
            chart.draw_series([Rectangle::new(corners, SERIES[series].mix(0.25).filled())])?;
            let place = |which: usize| left + 0.22 + 0.28 * which as f64;
            chart.marks(
                means.iter().enumerate().map(|(which, mean)| (place(which), *mean)),
                series,
            )?;
            for (which, time) in TIMES.iter().enumerate() {
                let style = letters_around(INK);
                chart.write(&time.to_string(), (place(which), 0.05 * highest), style)?;
            }
            chart.write(name, (left + 0.5, 1.15 * highest), letters_around(SERIES[series]))?;
        }
        Ok(())
    })
}
