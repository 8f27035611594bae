//! The policies on the same flights at constant velocity, by `examples/consistency`.

use std::collections::BTreeMap;

use vislam::consistency::Policy;

use super::flight::example::{ESTIMATED, SPEED};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::RecordValue;
use crate::release::said;

/// Flights of one minute at constant velocity.
const STRAIGHT: usize = 20;

/// What one line of the example says.
type Line = BTreeMap<String, f64>;

/// What the example says with these arguments: for each time the line of each policy.
fn told(arguments: &[&str]) -> Result<Vec<BTreeMap<String, Line>>, NotMade> {
    let said = said(&["--package", "vislam", "--example", "consistency"], arguments)?;
    let mut times = vec![BTreeMap::new()];
    for line in said.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("at") => times.push(BTreeMap::new()),
            Some("policy") => {
                let policy = words.next().unwrap_or_default().to_owned();
                let words: Vec<&str> = words.collect();
                let pairs = words.chunks_exact(2);
                let pairs =
                    pairs.filter_map(|pair| Some((pair[0].to_owned(), pair[1].parse().ok()?)));
                times.last_mut().map(|time| time.insert(policy, pairs.collect()));
            }
            _ => return Err(NotMade::Failed(format!("the example said “{line}”"))),
        }
    }
    times.retain(|time| !time.is_empty());
    Ok(times)
}

/// A number of a policy.
fn of(time: &BTreeMap<String, Line>, policy: &str, name: &str) -> Result<f64, NotMade> {
    let value = time.get(policy).and_then(|line| line.get(name)).copied();
    value.ok_or_else(|| NotMade::Failed(format!("the example said nothing of {policy}’s {name}")))
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("flights", format!("seeds 0 to {}", STRAIGHT - 1)),
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
    let flights = STRAIGHT.to_string();
    let times = told(&["--flights", &flights, "--motion", "constant-velocity"])?;
    let mut values = vec![RecordValue::new("flights", STRAIGHT as f64, "", 0, 0.0)];
    for policy in Policy::ALL.map(Policy::name) {
        for (name, unit, decimals) in [
            ("sigma_speed_mm_s", "mm/s", 0),
            ("error_speed_mm_s", "mm/s", 0),
            ("nees_velocity", "", 1),
        ] {
            let value = of(&times[0], policy, name)?;
            values.push(RecordValue::new(format!("{policy}_{name}"), value, unit, decimals, 0.02));
        }
        let error = 0.01 * of(&times[0], policy, "error_cm")?;
        values.push(RecordValue::new(format!("{policy}_error"), error, "m", 1, 0.02));
    }
    Ok(values)
}
