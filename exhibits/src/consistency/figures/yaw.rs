//! What the policies believe of their yaw, and by how much they err.

use super::SHOWN;
use crate::consistency::flown::{MINUTES, SENSORS, recorded};
use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, letters_right_of};

fn panel(drawing: &Drawing, sensor: &str, x_title: &str) -> Drawn {
    let curve = |policy, what: &str| {
        MINUTES.map(|minutes| (minutes as f64, recorded(sensor, policy, what, minutes)))
    };
    let curves = SHOWN.map(|policy| ["sigma", "turned"].map(|what| curve(policy, what)));
    let all = curves.iter().flatten().flatten().map(|(_, value)| *value);
    let most = all.fold(0.0_f64, f64::max);
    let y_axis = ("yaw (mrad)", 0.0..1.15 * most, 5);
    let mut chart = figure::axes(drawing, (x_title, 0.0..10.5, 6), y_axis)?;
    for (series, [sigma, error]) in curves.into_iter().enumerate() {
        chart.line(sigma, SERIES[series], 5)?;
        chart.marks(error, series)?;
    }
    chart.write(sensor, (0.3, 1.08 * most), letters_right_of(INK))
}

pub fn yaw() -> Figure {
    let columns = super::columns(&[
        ("believed σ (mrad)", "sigma"),
        ("error, root mean square (mrad)", "turned"),
    ]);
    Figure::new(1500, columns, |drawing| {
        let (keys, panels) = drawing.split_vertically(150);
        super::keys(&keys)?;
        let halves = panels.split_evenly((2, 1));
        panel(&halves[0], SENSORS[0], "")?;
        panel(&halves[1], SENSORS[1], "time (min)")
    })
}
