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
    let by_batch = |sensor: &str, what: &str, minutes: usize| {
        let of = |line| accepted("consistency_batch", &format!("{sensor}_{line}_{what}_{minutes}"));
        of(Policy::Ideal.name()) / of("batch")
    };
    let each = |times: &'static [usize]| {
        SENSORS.into_iter().flat_map(|sensor| times.iter().map(move |minutes| (sensor, *minutes)))
    };
    let surer = each(&MINUTES).map(|(sensor, minutes)| 1.0 / by_batch(sensor, "sigma", minutes));
    let surer: Vec<f64> = surer.map(|part| 100.0 * (1.0 - part)).collect();
    let nearer = each(&MINUTES[2..]).map(|(sensor, minutes)| by_batch(sensor, "error", minutes));
    let nearer: Vec<f64> = nearer.map(|part| 100.0 * (part - 1.0)).collect();
    for (least, most, percent) in [
        ("batch_surer_least", "batch_surer_most", surer),
        ("batch_nearer_least", "batch_nearer_most", nearer),
    ] {
        chapter.number(least, percent.iter().copied().fold(f64::INFINITY, f64::min), "%", 0);
        chapter.number(most, percent.iter().copied().fold(0.0, f64::max), "%", 0);
    }
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
