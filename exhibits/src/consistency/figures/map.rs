//! Where the standard filter's yaw leaves its band, cell by cell, and what the cures cost there.

use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::consistency::Policy;

use crate::consistency::map::{Cell, PIXELS, SENSORS, band};
use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_around, letters_of,
    letters_right_of,
};

const SHOWN: [Policy; 3] = [Policy::Standard, Policy::FirstEstimates, Policy::RightInvariant];

/// A sensor: a row for each start, number of kept landmarks, length of tracks and window, and in it
/// for each policy a field for each noise of the pixels.
fn panel(drawing: &Drawing, sensor: &str) -> Drawn {
    let cells: Vec<Cell> = Cell::all().into_iter().filter(|cell| cell.sensor == sensor).collect();
    let rows = cells.len() / PIXELS.len();
    let width = (SHOWN.len() * (PIXELS.len() + 1)) as f64;
    let mut chart = figure::axes(drawing, ("", -7.0..width, 0), ("", -0.2..rows as f64 + 2.6, 0))?;
    let above = rows as f64;
    chart.write(sensor, (-6.8, above + 1.6), letters_right_of(INK))?;
    for (group, policy) in SHOWN.iter().enumerate() {
        let left = (group * (PIXELS.len() + 1)) as f64;
        chart.write(policy.name(), (left + 1.5, above + 1.6), letters_around(SERIES[group]))?;
        for (at, pixels) in PIXELS.iter().enumerate() {
            chart.write(pixels, (left + at as f64 + 0.5, above + 0.6), letters_around(INK))?;
        }
    }
    for (number, cell) in cells.iter().enumerate() {
        let (row, column) = ((rows - 1 - number / PIXELS.len()) as f64, number % PIXELS.len());
        if column == 0 {
            let name = format!("{} kept, {}, {}", cell.kept, cell.longest.0, cell.clones);
            chart.write(&name, (-6.8, row + 0.72), letters_of(30.0, INK))?;
        }
        for (group, policy) in SHOWN.iter().enumerate() {
            let left = (group * (PIXELS.len() + 1) + column) as f64;
            let yaw = cell.recorded(*policy, "yaw");
            let corners = [(left + 0.04, row + 0.06), (left + 0.96, row + 0.94)];
            let shade = if band().contains(yaw) { 0.12 } else { 0.6 };
            chart.draw_series([Rectangle::new(corners, SERIES[group].mix(shade).filled())])?;
            let text = format!("{yaw:.1}");
            let style = letters_around(INK);
            chart.write(&text, (left + 0.5, row + 0.5), style)?;
        }
    }
    Ok(())
}

pub fn map() -> Figure {
    let cells = Cell::all();
    let text = |of: fn(&Cell) -> String| cells.iter().map(of).collect::<Vec<String>>();
    let value = |policy: Policy, what: &str| {
        decimals(2, cells.iter().map(|cell| cell.recorded(policy, what)))
    };
    let columns = vec![
        ("sensor", text(|cell| cell.sensor.to_owned())),
        ("start", text(|cell| cell.start.0.to_owned())),
        ("kept", text(|cell| cell.kept.to_string())),
        ("tracks", text(|cell| cell.longest.0.to_owned())),
        ("window", text(|cell| cell.clones.to_string())),
        ("pixels (px)", text(|cell| cell.pixels.to_owned())),
        ("ideal: NEES of yaw", value(Policy::Ideal, "yaw")),
        ("standard: NEES of yaw", value(Policy::Standard, "yaw")),
        ("error over ideal's", value(Policy::Standard, "error")),
        ("first estimates: NEES of yaw", value(Policy::FirstEstimates, "yaw")),
        ("error over ideal's", value(Policy::FirstEstimates, "error")),
        ("right-invariant: NEES of yaw", value(Policy::RightInvariant, "yaw")),
        ("error over ideal's", value(Policy::RightInvariant, "error")),
        ("robocentric: error over ideal's", value(Policy::Robocentric, "error")),
    ];
    Figure::new(2200, columns, |drawing| {
        let halves = drawing.split_evenly((2, 1));
        panel(&halves[0], SENSORS[0])?;
        panel(&halves[1], SENSORS[1])
    })
}
