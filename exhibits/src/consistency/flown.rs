//! The policies on the same hundred flights, and the batch on twenty of them.

use vislam::consistency::Policy;
use vislam::filtering::NeesBand;

use super::told::{Time, told};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};

const FLIGHTS: usize = 100;
/// When the filters are judged, in minutes; said before the runs.
pub const MINUTES: [usize; 4] = [1, 2, 5, 10];
pub const SENSORS: [&str; 2] = ["euroc", "mems"];
/// Landmarks that are kept in the state.
const KEPT: usize = 20;
/// The probability that a consistent filter with one sensor leaves any of its bands.
const OUTSIDE: f64 = 0.01;
/// The blocks that are judged, and their dimensions.
pub const BLOCKS: [(&str, usize); 4] = [("yaw", 1), ("tilt", 2), ("velocity", 3), ("position", 3)];
/// Flights of the batch, which sees everything at once.
const BATCHES: usize = 20;

/// Registers the records.
pub fn record(chapter: &mut Chapter) {
    let inputs = |flights: usize| {
        vec![
            ("flights", format!("seeds 0 to {}", flights - 1)),
            ("minutes", MINUTES.map(|minutes| minutes.to_string()).join(" ")),
            ("kept", KEPT.to_string()),
            ("sensors", SENSORS.join(" ")),
        ]
    };
    chapter.record_of_data("consistency_flights", &[], inputs(FLIGHTS), flown);
    chapter.record_of_data("consistency_batch", &[], inputs(BATCHES), batch);
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("band_percent", 100.0 * (1.0 - OUTSIDE), "%", 0);
    chapter.number("bands", (MINUTES.len() * BLOCKS.len()) as f64, "", 0);
    let [yaw, position] = [bands()[0], bands()[BLOCKS.len() - 1]];
    chapter.number("band_yaw_low", yaw.low, "", 2);
    chapter.number("band_yaw_high", yaw.high, "", 2);
    chapter.number("band_position_low", position.low, "", 2);
    chapter.number("band_position_high", position.high, "", 2);
}

/// What the example says of so many flights with a sensor, at all times.
fn fly(flights: usize, sensor: &str, more: &str) -> Result<Vec<Time>, NotMade> {
    let seconds = MINUTES.map(|minutes| (60 * minutes).to_string()).join(",");
    told(&format!("--flights {flights} --at {seconds} --kept {KEPT} --sensor {sensor} {more}"))
}

fn flown() -> Result<Vec<RecordValue>, NotMade> {
    let mut values = vec![RecordValue::new("flights", FLIGHTS as f64, "", 0, 0.0)];
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
                push("surer", time.by_ideal(policy, "sigma_yaw_mrad")?, "", 3);
                push("error", time.by_ideal(policy, "error_cm")?, "", 3);
            }
        }
        let last = &times[MINUTES.len() - 1];
        for policy in Policy::ALL {
            for claimed in ["claimed_yaw", "claimed_shift"] {
                values.push(part(sensor, policy, claimed, last)?);
            }
        }
        let rmse = last.of(Policy::Ideal.name(), "rmse_cm")?;
        values.push(RecordValue::new(format!("{sensor}_ideal_rmse"), rmse, "cm", 0, 0.02));
    }
    Ok(values)
}

/// What was claimed as a part of the whole: of the yaw of the standard filter in percent, and for
/// all others the power of ten below which it is. What is zero but for rounding differs from
/// machine to machine, so below 10⁻¹² it says no more.
fn part(sensor: &str, policy: Policy, claimed: &str, time: &Time) -> Result<RecordValue, NotMade> {
    let part = time.of(policy.name(), claimed)?;
    let name = format!("{sensor}_{policy}_{claimed}");
    Ok(if policy == Policy::Standard && claimed == "claimed_yaw" {
        RecordValue::new(name, 100.0 * part, "%", 2, 0.02)
    } else {
        RecordValue::new(name, part.log10().ceil().max(-12.0), "", 0, 0.0)
    })
}

fn batch() -> Result<Vec<RecordValue>, NotMade> {
    let mut values = vec![RecordValue::new("flights", BATCHES as f64, "", 0, 0.0)];
    for sensor in SENSORS {
        let times = fly(BATCHES, sensor, "--policy ideal --batch")?;
        for (minutes, time) in MINUTES.iter().zip(&times) {
            for line in [Policy::Ideal.name(), "batch"] {
                for (name, unit, decimals) in [
                    ("error_cm", "cm", 0),
                    ("error_yaw_mrad", "mrad", 1),
                    ("sigma_yaw_mrad", "mrad", 1),
                    ("nees_yaw", "", 2),
                    ("nees_position", "", 2),
                ] {
                    let value = time.of(line, name)?;
                    let name = format!("{sensor}_{line}_{name}_{minutes}");
                    values.push(RecordValue::new(name, value, unit, decimals, 0.02));
                }
            }
        }
    }
    Ok(values)
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
