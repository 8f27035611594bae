//! The scale that the inertial estimate finds when the shape counts as exact, and when it is measured.

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around};
use crate::initialization::real::{WINDOWS, accepted_value};

/// Ratio of the scale to the true one and its standard deviation, at the starts.
fn of(name: &str) -> Vec<(f64, f64, f64)> {
    let value = |from: u32| {
        let ratio = accepted_value(&format!("{name}_{from}"));
        (f64::from(from), ratio, 0.01 * ratio * accepted_value(&format!("{name}_{from}_sigma")))
    };
    WINDOWS.into_iter().map(value).filter(|(_, ratio, _)| *ratio > 0.0).collect()
}

pub fn shrunk() -> Figure {
    let both = [("poses exact", of("exact")), ("poses measured", of("measured"))];
    let each = || both.iter().flat_map(|(name, of)| of.iter().map(move |point| (*name, point)));
    let columns = vec![
        ("poses", each().map(|(name, _)| name.to_owned()).collect()),
        ("start (s)", decimals(0, each().map(|(_, point)| point.0))),
        ("scale over the true one", decimals(3, each().map(|(_, point)| point.1))),
        ("reported σ", decimals(3, each().map(|(_, point)| point.2))),
    ];
    Figure::new(760, columns, |drawing| {
        let highest = each().map(|(_, point)| point.1 + point.2).fold(1.3, f64::max).min(2.0);
        let lowest = each().map(|(_, point)| point.1 - point.2).fold(0.6, f64::min).max(0.0);
        let top = highest + 0.2 * (highest - lowest);
        let x_axis = ("start of two seconds (s after the first reading)", 4.0..21.5, 9);
        let y_axis = ("scale over the true one", lowest..top, 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line([(4.0, 1.0), (21.5, 1.0)], INK, 2)?;
        for (series, (name, points)) in both.iter().enumerate() {
            let beside = 0.24 * (series as f64 - 0.5);
            for (from, ratio, sigma) in points {
                let ends = [ratio - sigma, ratio + sigma];
                let bar = ends.map(|end| (from + beside, end.clamp(lowest, highest)));
                chart.line(bar, SERIES[series], 5)?;
                if (lowest..highest).contains(ratio) {
                    chart.marks([(from + beside, *ratio)], series)?;
                }
            }
            for from in WINDOWS.into_iter().map(f64::from) {
                if points.iter().all(|point| point.0 != from) && series == 0 {
                    let style = letters_around(INK);
                    chart.write("none", (from, lowest + 0.06 * (top - lowest)), style)?;
                }
            }
            let at = (5.0 + 7.5 * series as f64, top - 0.08 * (top - lowest));
            chart.key(series, name, at, at.0 + 0.4)?;
        }
        Ok(())
    })
}
