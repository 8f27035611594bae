//! The policies on the same hundred flights.

use vislam::consistency::Policy;
use vislam::filtering::NeesBand;

use super::told::{Time, told};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};

const FLIGHTS: usize = 100;
/// When the filters are judged, in minutes; said before the runs.
pub const MINUTES: [usize; 4] = [1, 2, 5, 10];
const LAST: usize = MINUTES[MINUTES.len() - 1];
pub const SENSORS: [&str; 2] = ["euroc", "mems"];
/// Landmarks that are kept in the state.
const KEPT: usize = 20;
/// The probability that a consistent filter with one sensor leaves any of its bands.
const OUTSIDE: f64 = 0.01;
/// The blocks that are judged, and their dimensions.
pub const BLOCKS: [(&str, usize); 4] = [("yaw", 1), ("tilt", 2), ("velocity", 3), ("position", 3)];

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    chapter.record_of_data("consistency_flights", &[], inputs(FLIGHTS), flown);
}

/// What goes into a record of so many flights.
pub fn inputs(flights: usize) -> Vec<(&'static str, String)> {
    vec![
        ("flights", format!("seeds 0 to {}", flights - 1)),
        ("minutes", MINUTES.map(|minutes| minutes.to_string()).join(" ")),
        ("kept", KEPT.to_string()),
        ("sensors", SENSORS.join(" ")),
    ]
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("band_outside", 100.0 * OUTSIDE, "%", 0);
    chapter.number("bands", (MINUTES.len() * BLOCKS.len()) as f64, "", 0);
    let by_ideal = |sensor: &str, what: &str| {
        let of = |policy| recorded(sensor, policy, what, LAST);
        100.0 * (of(Policy::Standard) / of(Policy::Ideal) - 1.0)
    };
    chapter.number("standard_worse_euroc", by_ideal("euroc", "error"), "%", 0);
    chapter.number("standard_worse_mems", by_ideal("mems", "error"), "%", 0);
    chapter.number("standard_turned_euroc", by_ideal("euroc", "turned"), "%", 0);
    chapter.number("standard_turned_mems", by_ideal("mems", "turned"), "%", 0);
    chapter.number("all_bands", (SENSORS.len() * MINUTES.len() * BLOCKS.len()) as f64, "", 0);
    chapter.number("ideal_outside", outside(Policy::Ideal) as f64, "", 0);
    chapter.number("standard_outside", outside(Policy::Standard) as f64, "", 0);
    chapter.number("cures_outside", cures().map(outside).sum::<usize>() as f64, "", 0);
    chapter.number("cures_apart", (100.0 * cures().map(apart).fold(0.0, f64::max)).ceil(), "%", 0);
    let [yaw, position] = [bands()[0], bands()[BLOCKS.len() - 1]];
    chapter.number("band_yaw_low", yaw.low, "", 2);
    chapter.number("band_yaw_high", yaw.high, "", 2);
    chapter.number("band_position_low", position.low, "", 2);
    chapter.number("band_position_high", position.high, "", 2);
}

/// What the example says of so many flights with a sensor, at all times.
pub fn fly(flights: usize, sensor: &str, more: &str) -> Result<Vec<Time>, NotMade> {
    let seconds = MINUTES.map(|minutes| (60 * minutes).to_string()).join(",");
    told(&format!("--flights {flights} --at {seconds} --kept {KEPT} --sensor {sensor} {more}"))
}

fn flown() -> Result<Vec<RecordValue>, NotMade> {
    let mut values = vec![RecordValue::new("flights", FLIGHTS as f64, "", 0, 0.0)];
    let mut others = 0.0_f64;
    for sensor in SENSORS {
        let times = fly(FLIGHTS, sensor, "")?;
        for (minutes, time) in MINUTES.iter().zip(&times) {
            for policy in Policy::ALL {
                let mut push = |what: &str, value, unit, decimals| {
                    let name = format!("{sensor}_{policy}_{what}_{minutes}");
                    values.push(RecordValue::new(name, value, unit, decimals, 0.02));
                };
                for (block, _) in BLOCKS {
                    push(block, time.of(policy.name(), &format!("nees_{block}"))?, "", 2);
                }
                push("sigma", time.of(policy.name(), "sigma_yaw_mrad")?, "mrad", 2);
                push("turned", time.of(policy.name(), "error_yaw_mrad")?, "mrad", 2);
                if *minutes == LAST {
                    push("surer", time.by_ideal(policy, "sigma_yaw_mrad")?, "", 2);
                    push("error", time.by_ideal(policy, "error_cm")?, "", 2);
                }
            }
        }
        let last = &times[MINUTES.len() - 1];
        let part = |policy: Policy, claimed| last.of(policy.name(), claimed);
        for policy in Policy::ALL {
            others = others.max(part(policy, "claimed_shift")?);
            let turn = part(policy, "claimed_yaw")?;
            if policy == Policy::Standard {
                let name = format!("{sensor}_standard_claimed");
                values.push(RecordValue::new(name, 100.0 * turn, "%", 4, 0.02));
            } else {
                others = others.max(turn);
            }
        }
        let rmse = last.of(Policy::Ideal.name(), "rmse_cm")?;
        values.push(RecordValue::new(format!("{sensor}_ideal_rmse"), rmse, "cm", 0, 0.02));
    }
    // What is zero but for rounding differs from machine to machine, so this power says no more.
    let above = others.log10().ceil().max(-12.0);
    values.push(RecordValue::new("claimed_others_power", above, "", 0, 0.0));
    Ok(values)
}

/// The filters that neither mix linearization points nor know the truth.
fn cures() -> impl Iterator<Item = Policy> {
    let is_none = |policy: &Policy| [Policy::Standard, Policy::Ideal].contains(policy);
    Policy::ALL.into_iter().filter(move |policy| !is_none(policy))
}

/// How many bands of both sensors a policy leaves.
fn outside(policy: Policy) -> usize {
    let of_sensor = |sensor| {
        let leaves = |minutes| {
            let blocks = BLOCKS.iter().zip(bands());
            let left = |((block, _), band): &(&(&str, usize), NeesBand)| {
                !band.contains(recorded(sensor, policy, block, minutes))
            };
            blocks.filter(left).count()
        };
        MINUTES.map(leaves).iter().sum::<usize>()
    };
    SENSORS.map(of_sensor).iter().sum()
}

/// By which part a policy differs at the end from the one that is told the truth.
fn apart(policy: Policy) -> f64 {
    let of_sensor = |sensor| {
        let by_ideal = |what| {
            let of = |policy| recorded(sensor, policy, what, LAST);
            (of(policy) / of(Policy::Ideal) - 1.0).abs()
        };
        ["yaw", "surer", "error"].map(by_ideal).into_iter().fold(0.0, f64::max)
    };
    SENSORS.map(of_sensor).into_iter().fold(0.0, f64::max)
}

/// The band of each block, the same at all times.
pub fn bands() -> Vec<NeesBand> {
    let dimensions: Vec<usize> =
        MINUTES.iter().flat_map(|_| BLOCKS.map(|(_, dimension)| dimension)).collect();
    let bands = NeesBand::family(FLIGHTS, &dimensions, OUTSIDE).expect("a probability");
    bands.into_iter().take(BLOCKS.len()).collect()
}

/// A value of the flights of a policy with a sensor.
pub fn recorded(sensor: &str, policy: Policy, what: &str, minutes: usize) -> f64 {
    accepted("consistency_flights", &format!("{sensor}_{policy}_{what}_{minutes}"))
}
