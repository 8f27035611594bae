//! The policies on the same flights, by `examples/consistency`.

use std::collections::BTreeMap;

use vislam::consistency::Policy;
use vislam::filtering::NeesBand;

use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};
use crate::release::said;

const FLIGHTS: usize = 100;
/// When the filters are judged, in minutes; said before the runs.
pub const MINUTES: [usize; 4] = [1, 2, 5, 10];
pub const SENSORS: [&str; 2] = ["euroc", "mems"];
/// Landmarks that are kept in the state.
const KEPT: usize = 20;
/// The probability that a consistent filter leaves any of the bands of one sensor.
const OUTSIDE: f64 = 0.01;
/// The blocks that are judged, and their dimensions.
pub const BLOCKS: [(&str, usize); 3] = [("yaw", 1), ("tilt", 2), ("position", 3)];
/// Flights of the batch, which sees everything at once.
const BATCHES: usize = 20;
/// Flights of one minute at constant velocity.
const STRAIGHT: usize = 20;

/// What one line of the example says.
pub type Line = BTreeMap<String, f64>;

/// What the example says with these arguments: for each time the line of each policy.
pub fn told(arguments: &[&str]) -> Result<Vec<BTreeMap<String, Line>>, NotMade> {
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
pub fn of(time: &BTreeMap<String, Line>, policy: &str, name: &str) -> Result<f64, NotMade> {
    let value = time.get(policy).and_then(|line| line.get(name)).copied();
    value.ok_or_else(|| NotMade::Failed(format!("the example said nothing of {policy}’s {name}")))
}

fn seconds() -> String {
    MINUTES.map(|minutes| (60 * minutes).to_string()).join(",")
}

/// Registers the records.
pub fn record(chapter: &mut Chapter) {
    let minutes = MINUTES.map(|minutes| minutes.to_string()).join(" ");
    let flights = |count| ("flights", format!("seeds 0 to {}", count - 1));
    let told = ("kept", KEPT.to_string());
    let inputs = vec![
        flights(FLIGHTS),
        ("minutes", minutes.clone()),
        told.clone(),
        ("sensors", SENSORS.join(" ")),
        ("outside", OUTSIDE.to_string()),
    ];
    chapter.record_of_data("consistency_flights", &[], inputs, flown);
    let inputs = vec![flights(BATCHES), ("minutes", minutes), told];
    chapter.record_of_data("consistency_batch", &[], inputs, batch);
    let inputs = vec![flights(STRAIGHT), ("minutes", "1".to_owned())];
    chapter.record_of_data("consistency_straight", &[], inputs, straight);
}

fn flown() -> Result<Vec<RecordValue>, NotMade> {
    let value =
        |name: String, value, unit, decimals| RecordValue::new(name, value, unit, decimals, 0.02);
    let mut values = vec![RecordValue::new("flights", FLIGHTS as f64, "", 0, 0.0)];
    for sensor in SENSORS {
        let (flights, kept) = (FLIGHTS.to_string(), KEPT.to_string());
        let times = told(&[
            "--flights",
            &flights,
            "--at",
            &seconds(),
            "--kept",
            &kept,
            "--sensor",
            sensor,
        ])?;
        for (minutes, time) in MINUTES.iter().zip(&times) {
            for policy in Policy::ALL.map(Policy::name) {
                let name = |what: &str| format!("{sensor}_{policy}_{what}_{minutes}");
                for (block, _) in BLOCKS {
                    let nees = of(time, policy, &format!("nees_{block}"))?;
                    values.push(value(name(block), nees, "", 2));
                }
                let ideal = |what| of(time, Policy::Ideal.name(), what);
                for (what, of_yaw) in [("sigma", "sigma_yaw_mrad"), ("turned", "error_yaw_mrad")] {
                    values.push(value(name(what), of(time, policy, of_yaw)?, "mrad", 2));
                }
                let error = of(time, policy, "error_cm")? / ideal("error_cm")?;
                values.push(value(name("error"), error, "", 3));
            }
        }
        let (last, longest) = (MINUTES[MINUTES.len() - 1], &times[MINUTES.len() - 1]);
        for policy in Policy::ALL.map(Policy::name) {
            let name = |what: &str| format!("{sensor}_{policy}_{what}_{last}");
            let rmse = of(longest, policy, "rmse_cm")?;
            values.push(value(name("rmse"), rmse, "cm", 1));
            for claimed in ["claimed_yaw", "claimed_shift"] {
                // What is zero but for rounding differs from machine to machine.
                let part = of(longest, policy, claimed)?.max(1e-14);
                values.push(RecordValue::new(name(claimed), part, "", 2, 10.0));
            }
        }
    }
    Ok(values)
}

fn batch() -> Result<Vec<RecordValue>, NotMade> {
    let mut values = Vec::new();
    for sensor in SENSORS {
        let (flights, kept) = (BATCHES.to_string(), KEPT.to_string());
        let times = told(&[
            "--flights",
            &flights,
            "--at",
            &seconds(),
            "--kept",
            &kept,
            "--sensor",
            sensor,
            "--policy",
            "ideal",
            "--batch",
        ])?;
        for (minutes, time) in MINUTES.iter().zip(&times) {
            for word in ["ideal", "batch"] {
                for (name, unit) in
                    [("error_cm", "cm"), ("error_yaw_mrad", "mrad"), ("sigma_yaw_mrad", "mrad")]
                {
                    let value = of(time, word, name)?;
                    let name = format!("{sensor}_{word}_{name}_{minutes}");
                    values.push(RecordValue::new(name, value, unit, 1, 0.02));
                }
            }
        }
    }
    Ok(values)
}

fn straight() -> Result<Vec<RecordValue>, NotMade> {
    let flights = STRAIGHT.to_string();
    let times = told(&["--flights", &flights, "--motion", "constant-velocity"])?;
    let mut values = Vec::new();
    for policy in Policy::ALL.map(Policy::name) {
        for (name, unit, decimals) in [
            ("sigma_speed_mm_s", "mm/s", 0),
            ("error_speed_mm_s", "mm/s", 0),
            ("nees_velocity", "", 1),
            ("nees_position", "", 1),
            ("nees_yaw", "", 1),
            ("error_cm", "cm", 0),
        ] {
            let value = of(&times[0], policy, name)?;
            values.push(RecordValue::new(format!("{policy}_{name}"), value, unit, decimals, 0.02));
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
