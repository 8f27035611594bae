//! The policies on the same flights at constant velocity.

use vislam::consistency::Policy;

use super::flight::example::{ESTIMATED, SPEED};
use super::told::told;
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::RecordValue;

/// Flights, of one minute each.
const FLIGHTS: usize = 20;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("flights", format!("seeds 0 to {}", FLIGHTS - 1)),
        ("minutes", "1".to_owned()),
        ("motion", "constant velocity, 1 m/s".to_owned()),
    ];
    chapter.record_of_data("consistency_straight", &[], inputs, straight);
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("straight_speed", SPEED, "m/s", 0);
    chapter.number("straight_start", 1e3 * ESTIMATED[1], "mm/s", 0);
    chapter.number("straight_scale", 100.0 * ESTIMATED[1] / SPEED, "%", 0);
}

fn straight() -> Result<Vec<RecordValue>, NotMade> {
    let times = told(&format!("--flights {FLIGHTS} --motion constant-velocity"))?;
    let mut values = vec![RecordValue::new("flights", FLIGHTS as f64, "", 0, 0.0)];
    for policy in Policy::ALL.map(Policy::name) {
        for (name, unit, decimals) in [
            ("sigma_speed_mm_s", "mm/s", 0),
            ("error_speed_mm_s", "mm/s", 0),
            ("nees_velocity", "", 1),
        ] {
            let value = times[0].of(policy, name)?;
            values.push(RecordValue::new(format!("{policy}_{name}"), value, unit, decimals, 0.02));
        }
    }
    let error = |policy: Policy| Ok(0.01 * times[0].of(policy.name(), "error_cm")?);
    let mut push = |name, error| values.push(RecordValue::new(name, error, "m", 1, 0.02));
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for policy in Policy::ALL {
        match policy {
            Policy::FirstEstimates => push("first_estimates_error", error(policy)?),
            Policy::Ideal => push("ideal_error", error(policy)?),
            _ => (least, most) = (least.min(error(policy)?), most.max(error(policy)?)),
        }
    }
    push("others_error_least", least);
    push("others_error_most", most);
    Ok(values)
}
