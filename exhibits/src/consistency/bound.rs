//! What a batch that sees everything at once makes of some of the flights: no filter can do better.

use vislam::consistency::Policy;

use super::flown::{MINUTES, SENSORS, fly};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};

const FLIGHTS: usize = 20;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    chapter.record_of_data("consistency_batch", &[], super::flown::inputs(FLIGHTS), bound);
}

pub fn numbers(chapter: &mut Chapter) {
    let less = |sensor: &str, what: &str, minutes: usize| {
        let of = |line| accepted("consistency_batch", &format!("{sensor}_{line}_{what}_{minutes}"));
        100.0 * (1.0 - of("batch") / of(Policy::Ideal.name()))
    };
    let of_sensor = |sensor| MINUTES.map(|minutes| less(sensor, "sigma", minutes));
    let surer = || SENSORS.into_iter().flat_map(of_sensor);
    chapter.number("batch_surer_least", surer().fold(f64::INFINITY, f64::min), "%", 0);
    chapter.number("batch_surer_most", surer().fold(0.0, f64::max), "%", 0);
    let nearer = |sensor| less(sensor, "error", MINUTES[MINUTES.len() - 1]);
    chapter.number("batch_nearer_euroc", nearer("euroc"), "%", 0);
    chapter.number("batch_nearer_mems", nearer("mems"), "%", 0);
}

fn bound() -> Result<Vec<RecordValue>, NotMade> {
    let mut values = vec![RecordValue::new("flights", FLIGHTS as f64, "", 0, 0.0)];
    for sensor in SENSORS {
        let times = fly(FLIGHTS, sensor, "--policy ideal --batch")?;
        for (minutes, time) in MINUTES.iter().zip(&times) {
            for line in [Policy::Ideal.name(), "batch"] {
                let mut push = |what: &str, value, unit, decimals| {
                    let name = format!("{sensor}_{line}_{what}_{minutes}");
                    values.push(RecordValue::new(name, value, unit, decimals, 0.02));
                };
                push("error", time.of(line, "error_cm")?, "cm", 1);
                push("turned", time.of(line, "error_yaw_mrad")?, "mrad", 2);
                push("sigma", time.of(line, "sigma_yaw_mrad")?, "mrad", 2);
            }
        }
    }
    Ok(values)
}
