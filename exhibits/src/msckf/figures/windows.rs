//! Accuracy over time, by the length of the window, from the accepted record.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, letters_around};
use crate::msckf::windows::{POLICIES, WINDOWS, recorded};

const NAMES: [&str; 2] = ["the oldest pose goes", "every third pose goes"];

pub fn windows() -> Figure {
    let curves = POLICIES.map(|(policy, _)| recorded(policy));
    let cells = || curves.iter().zip(NAMES).flat_map(|(curve, name)| curve.map(|at| (name, at)));
    let columns = vec![
        ("policy", cells().map(|(name, _)| name.to_owned()).collect()),
        ("poses", POLICIES.iter().flat_map(|_| WINDOWS.map(|window| window.to_string())).collect()),
        ("time of a picture (ms)", decimals(3, cells().map(|(_, (time, _))| time))),
        ("RMSE of the position (cm)", decimals(2, cells().map(|(_, (_, rmse))| rmse))),
    ];
    Figure::new(820, columns, |drawing| {
        let all = || curves.iter().flatten();
        let lowest = all().fold(f64::INFINITY, |a, at| a.min(at.0));
        let slowest = all().fold(0.0_f64, |a, at| a.max(at.0));
        let worst = all().fold(0.0_f64, |a, at| a.max(at.1));
        let x_axis = ("time of a picture (ms)", (0.7 * lowest..1.4 * slowest).log_scale(), 5);
        let y_axis = ("RMSE (cm)", 0.0..1.15 * worst, 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, curve) in curves.iter().enumerate() {
            chart.line(*curve, SERIES[index], 4)?;
            chart.marks(*curve, index)?;
            let away = if index == 0 { 0.06 } else { -0.06 } * worst;
            for (window, (time, rmse)) in WINDOWS.iter().zip(curve) {
                let style = letters_around(SERIES[index]);
                chart.write(&window.to_string(), (*time, rmse + away), style)?;
            }
            let height = worst * [1.05, 0.95][index];
            let left = lowest * (slowest / lowest).powf(0.35);
            chart.key(index, NAMES[index], (left, height), 1.07 * left)?;
        }
        Ok(())
    })
}
