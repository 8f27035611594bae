//! Normalized errors of the policies, by block, sensor and time, with the bands they have to be in.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::consistency::Policy;

use super::short;
use crate::consistency::flown::{BLOCKS, MINUTES, SENSORS, bands, recorded};
use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals};

/// The errors of a sensor: a group for each policy, in it a mark for each time.
fn panel(drawing: &Drawing, sensor: &str, block: usize, is_last: bool) -> Drawn {
    let (name, _) = BLOCKS[block];
    let band = bands()[block];
    let of = |policy, minutes| recorded(sensor, policy, name, minutes);
    let all = Policy::ALL.into_iter().flat_map(|policy| MINUTES.map(|minutes| of(policy, minutes)));
    let (low, high) =
        all.fold((band.low, band.high), |(low, high), nees| (low.min(nees), high.max(nees)));
    let y_axis = (name, (0.8 * low..1.25 * high).log_scale(), 4);
    let width = Policy::ALL.len() as f64;
    let mut chart = figure::axes(drawing, ("", 0.0..width, 0), y_axis)?;
    let inside = [(0.0, band.low), (width, band.high)];
    chart.draw_series([Rectangle::new(inside, SERIES[block].mix(0.2).filled())])?;
    chart.line([(0.0, 1.0), (width, 1.0)], INK, 2)?;
    for (column, policy) in Policy::ALL.into_iter().enumerate() {
        let at = |which: usize| column as f64 + 0.2 + 0.2 * which as f64;
        let points =
            MINUTES.iter().enumerate().map(|(which, minutes)| (at(which), of(policy, *minutes)));
        let points: Vec<_> = points.collect();
        chart.line(points.clone(), SERIES[block], 3)?;
        chart.marks(points, block)?;
        if is_last {
            let style = figure::letters_of(28.0, INK);
            let place = (column as f64 + 0.08, 0.86 * low);
            chart.write(short(policy), place, style)?;
        }
    }
    Ok(())
}

pub fn nees() -> Figure {
    let each = || {
        SENSORS.into_iter().flat_map(|sensor| {
            Policy::ALL
                .into_iter()
                .flat_map(move |policy| MINUTES.map(move |minutes| (sensor, policy, minutes)))
        })
    };
    let of = |block: usize| {
        decimals(
            2,
            each().map(move |(sensor, policy, minutes)| {
                recorded(sensor, policy, BLOCKS[block].0, minutes)
            }),
        )
    };
    let columns = vec![
        ("sensor", each().map(|(sensor, ..)| sensor.to_owned()).collect()),
        ("policy", each().map(|(_, policy, _)| policy.to_string()).collect()),
        ("time (min)", each().map(|(.., minutes)| minutes.to_string()).collect()),
        ("yaw: mean NEES, divided", of(0)),
        ("tilt", of(1)),
        ("position", of(2)),
    ];
    Figure::new(2400, columns, |drawing| {
        let panels = drawing.split_evenly((6, 1));
        for (row, sensor) in SENSORS.into_iter().enumerate() {
            for block in 0..BLOCKS.len() {
                let number = BLOCKS.len() * row + block;
                panel(&panels[number], sensor, block, block + 1 == BLOCKS.len())?;
            }
        }
        Ok(())
    })
}
