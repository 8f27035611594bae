//! What a filter has come to know of a turn of everything about the vertical, along one flight.

use vislam::consistency::Policy;

use crate::consistency::flight::{PICTURE_RATE, Seen, seen};
use crate::figure::{self, Draw, Figure, SERIES, decimals, powers};

/// Those that differ in the figure.
const SHOWN: [Policy; 4] =
    [Policy::Standard, Policy::FirstEstimates, Policy::RightInvariant, Policy::Ideal];
/// Every so manieth picture stands in the table.
const TOLD: usize = 12;
/// Parts of the whole below this are drawn at it: rounding.
const ROUNDING: f64 = 1e-34;

pub fn certificate() -> Figure {
    let curves = SHOWN.map(seen);
    let time = |number: usize| number as f64 / PICTURE_RATE;
    let floor = |curve: &[Seen]| -> Vec<(f64, f64)> {
        let floors = curve.iter().enumerate();
        floors.filter_map(|(number, seen)| Some((time(number), 1e3 * seen.floor?))).collect()
    };
    let claimed = |curve: &[Seen]| -> Vec<(f64, f64)> {
        let part = |seen: &Seen| seen.claimed_heading.max(ROUNDING);
        curve.iter().enumerate().map(|(number, seen)| (time(number), part(seen))).collect()
    };
    let each = || {
        SHOWN.iter().zip(&curves).flat_map(|(policy, curve)| {
            // The last one is among them.
            let told = curve.iter().enumerate().skip((curve.len() - 1) % TOLD).step_by(TOLD);
            told.map(move |(number, seen)| (policy, number, seen))
        })
    };
    let columns = vec![
        ("policy", each().map(|(policy, ..)| policy.to_string()).collect()),
        ("time (s)", decimals(1, each().map(|(_, number, _)| time(number)))),
        (
            "floor of the yaw’s σ (mrad)",
            decimals(2, each().map(|(.., seen)| 1e3 * seen.floor.unwrap_or(0.0))),
        ),
        (
            "claimed of the turn until then, of the whole",
            powers(1, each().map(|(.., seen)| seen.claimed_heading)),
        ),
        ("claimed of shifts", powers(1, each().map(|(.., seen)| seen.claimed_shifts))),
    ];
    Figure::new(1500, columns, |drawing| {
        let halves = drawing.split_evenly((2, 1));
        let last = time(curves[0].len() - 1);
        let x_axis = |title| (title, 0.0..last, 6);
        let floors: Vec<Vec<(f64, f64)>> = curves.iter().map(|curve| floor(curve)).collect();
        let high = floors.iter().flatten().fold(0.0_f64, |high, (_, floor)| high.max(*floor));
        let y_axis = ("floor of the yaw’s σ (mrad)", 0.0..1.4 * high, 5);
        let mut chart = figure::axes(&halves[0], x_axis(""), y_axis)?;
        for (series, curve) in floors.into_iter().enumerate() {
            chart.line(curve, SERIES[series], 4)?;
            let row = (series / 2) as f64;
            let at = (last * (0.03 + 0.5 * (series % 2) as f64), high * (1.32 - 0.12 * row));
            chart.key(series, SHOWN[series].name(), at, at.0 + 0.025 * last)?;
        }
        let y_axis = ("claimed, power of ten", -36.0..2.0, 5);
        let mut chart = figure::axes(&halves[1], x_axis("time (s)"), y_axis)?;
        for (series, curve) in curves.iter().enumerate() {
            let points = claimed(curve).into_iter().map(|(time, part)| (time, part.log10()));
            chart.line(points.clone(), SERIES[series], 4)?;
            chart.marks(points.skip(10 + 4 * series).step_by(20), series)?;
        }
        Ok(())
    })
}
