//! Normalized errors of the policies over time, by block and sensor, with the bands they have to be in.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::Rectangle;
use plotters::style::Color;

use super::SHOWN;
use crate::consistency::flown::{BLOCKS, MINUTES, SENSORS, bands, recorded};
use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, letters_right_of};

/// The time in minutes at which the axis begins and ends.
const TIMES: [f64; 2] = [0.8, 12.5];

fn panel(drawing: &Drawing, sensor: &str, block: usize) -> Drawn {
    let (name, _) = BLOCKS[block];
    let band = bands()[block];
    let of = |policy, minutes| recorded(sensor, policy, name, minutes);
    let all = SHOWN.into_iter().flat_map(|policy| MINUTES.map(|minutes| of(policy, minutes)));
    let (low, high) =
        all.fold((band.low, band.high), |(low, high), nees| (low.min(nees), high.max(nees)));
    let [begin, end] = TIMES;
    let is_last = block + 1 == BLOCKS.len();
    let x_axis = (if is_last { "time (min)" } else { "" }, (begin..end).log_scale().base(2.0), 4);
    let y_axis = (name, (0.85 * low..1.5 * high).log_scale().base(2.0), 4);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    let inside = [(begin, band.low), (end, band.high)];
    chart.draw_series([Rectangle::new(inside, INK.mix(0.12).filled())])?;
    for (series, policy) in SHOWN.into_iter().enumerate() {
        let points = MINUTES.map(|minutes| (minutes as f64, of(policy, minutes)));
        chart.line(points, SERIES[series], 4)?;
        chart.marks(points, series)?;
    }
    if block == 0 {
        chart.write(sensor, (0.9, 1.3 * high), letters_right_of(INK))?;
    }
    Ok(())
}

pub fn nees() -> Figure {
    let columns = super::columns(&[
        ("yaw: mean NEES, divided", "yaw"),
        ("tilt", "tilt"),
        ("velocity", "velocity"),
        ("position", "position"),
    ]);
    Figure::new(1900, columns, |drawing| {
        let (keys, panels) = drawing.split_vertically(150);
        super::keys(&keys)?;
        let panels = panels.split_evenly((BLOCKS.len(), SENSORS.len()));
        for (number, panel) in panels.iter().enumerate() {
            self::panel(panel, SENSORS[number % SENSORS.len()], number / SENSORS.len())?;
        }
        Ok(())
    })
}
