//! The policies on a real flight, from its own start at rest.

use vislam::consistency::{Claimed, Policy};
use vislam::filtering::{Freedom, attitude_in_world};
use vislam::inertial::NavState;
use vislam::msckf::{Msckf, MsckfOptions, Start};

use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::initialization::real::{FILES, Real, ate};
use crate::record::RecordValue;

/// Every so manieth picture corrects the filter.
const EVERY: usize = 2;
/// Landmarks that are kept in the state.
const KEPT: [usize; 2] = [0, 20];
/// What a track without fault passes with this probability.
const GATE: f64 = 0.999;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("every", EVERY.to_string()),
        ("kept", KEPT.map(|kept| kept.to_string()).join(" ")),
        ("gate", GATE.to_string()),
        ("noise", "ImuNoise::euroc(), 1 px".to_owned()),
    ];
    chapter.record_of_data("consistency_real", &FILES, inputs, real);
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("real_kept", KEPT[1] as f64, "", 0);
}

/// The policies that need no truth.
pub fn policies() -> impl Iterator<Item = Policy> {
    Policy::ALL.into_iter().filter(|policy| *policy != Policy::Ideal)
}

/// What became of a filter.
struct Followed {
    states: Vec<NavState>,
    /// The standard deviation of yaw at the end, in rad.
    sigma: f64,
    claimed: Claimed,
}

fn follow(flight: &Real, start: &Start, policy: Policy, kept: usize) -> Result<Followed, NotMade> {
    let failed = |error: String| NotMade::Failed(format!("{policy}: {error}"));
    let sensors = &flight.sensors;
    let options = MsckfOptions {
        gravity: sensors.gravity(),
        landmarks: kept,
        gate: GATE,
        linearization: policy.into(),
        ..MsckfOptions::new(sensors.camera, sensors.pixel_sigma, sensors.noise)
    };
    let mut filter = Msckf::new(options, start).map_err(|error| failed(error.to_string()))?;
    let before =
        flight.readings.partition_point(|reading| reading.nanoseconds <= start.nanoseconds);
    for reading in &flight.readings[before.saturating_sub(1)..] {
        filter.reading(*reading).map_err(|error| failed(error.to_string()))?;
    }
    let (mut states, mut claimed) = (Vec::new(), Claimed::default());
    for picture in &flight.pictures {
        let report = filter.picture(picture).map_err(|error| failed(error.to_string()))?;
        claimed.add(&report.claimed);
        states.push(*filter.state());
    }
    let turn = attitude_in_world(filter.state(), &filter.covariance().fixed_view::<3, 3>(0, 0));
    Ok(Followed { states, sigma: turn[(2, 2)].sqrt(), claimed })
}

fn real() -> Result<Vec<RecordValue>, NotMade> {
    let mut flight = Real::read()?;
    let (picture, start) = flight.stood()?.start;
    flight.pictures = flight.pictures[picture..].iter().step_by(EVERY).cloned().collect();
    flight.truth = flight.truth[picture..].iter().step_by(EVERY).copied().collect();
    let seconds = 1e-9
        * (flight.pictures[flight.pictures.len() - 1].nanoseconds - flight.pictures[0].nanoseconds)
            as f64;
    let mut others = 0.0_f64;
    let mut values = vec![RecordValue::new("seconds", seconds, "s", 0, 1e-3)];
    for kept in KEPT {
        for policy in policies() {
            let Followed { states, sigma, claimed } = follow(&flight, &start, policy, kept)?;
            let name = |what: &str| format!("{policy}_{kept}_{what}");
            let mut push = |what: &str, value, unit, decimals, within| {
                values.push(RecordValue::new(name(what), value, unit, decimals, within));
            };
            push("ate", ate(&states, &flight.truth, Freedom::Four)?, "cm", 1, 0.02);
            push("sigma", 1e3 * sigma, "mrad", 2, 0.02);
            let part = 100.0 * claimed.part_of_turn().unwrap_or(f64::NAN);
            if policy == Policy::Standard {
                values.push(RecordValue::new(format!("claimed_{kept}"), part, "%", 1, 0.02));
            } else {
                others = others.max(part);
            }
        }
    }
    // What is zero but for rounding differs from machine to machine.
    let above = others.log10().ceil().max(-9.0);
    values.push(RecordValue::new("others_exponent", above, "", 0, 0.0));
    Ok(values)
}
