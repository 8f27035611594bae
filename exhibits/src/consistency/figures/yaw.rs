//! What the policies believe of their yaw, and by how much they err.

use vislam::consistency::Policy;

use crate::consistency::flown::{MINUTES, SENSORS, recorded};
use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_right_of};

/// Those that differ in the figure; the others lie on the last.
const SHOWN: [Policy; 3] = [Policy::Standard, Policy::FirstEstimates, Policy::Ideal];

fn curve(sensor: &str, policy: Policy, what: &str) -> Vec<(f64, f64)> {
    MINUTES.map(|minutes| (minutes as f64, recorded(sensor, policy, what, minutes))).to_vec()
}

fn panel(drawing: &Drawing, (sensor, title): (&str, &str)) -> Drawn {
    let curves = SHOWN.map(|policy| ["sigma", "turned"].map(|what| curve(sensor, policy, what)));
    let most = curves.iter().flatten().flatten().fold(0.0_f64, |most, (_, value)| most.max(*value));
    let mut chart =
        figure::axes(drawing, (title, 0.0..10.5, 6), ("yaw (mrad)", 0.0..1.4 * most, 5))?;
    for (series, (policy, [sigma, error])) in SHOWN.iter().zip(curves).enumerate() {
        chart.line(sigma, SERIES[series], 5)?;
        chart.marks(error, series)?;
        let at = (0.4 + 3.6 * series as f64, 1.25 * most);
        chart.key(series, policy.name(), at, at.0 + 0.25)?;
    }
    chart.write(sensor, (0.4, 1.12 * most), letters_right_of(INK))?;
    Ok(())
}

pub fn yaw() -> Figure {
    let each = || {
        SENSORS.into_iter().flat_map(|sensor| {
            SHOWN
                .into_iter()
                .flat_map(move |policy| MINUTES.map(move |minutes| (sensor, policy, minutes)))
        })
    };
    let of = |what: &'static str| {
        let value = move |(sensor, policy, minutes)| recorded(sensor, policy, what, minutes);
        decimals(2, each().map(value))
    };
    let columns = vec![
        ("sensor", each().map(|(sensor, ..)| sensor.to_owned()).collect()),
        ("policy", each().map(|(_, policy, _)| policy.to_string()).collect()),
        ("time (min)", each().map(|(.., minutes)| minutes.to_string()).collect()),
        ("believed σ (mrad)", of("sigma")),
        ("error, root mean square (mrad)", of("turned")),
    ];
    Figure::new(1400, columns, |drawing| {
        let halves = drawing.split_evenly((2, 1));
        panel(&halves[0], (SENSORS[0], ""))?;
        panel(&halves[1], (SENSORS[1], "time (min)"))?;
        Ok(())
    })
}
