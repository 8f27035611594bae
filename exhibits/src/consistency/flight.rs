//! One flight with a poor sensor and kept landmarks, followed by all policies.

use vislam::consistency::{Claimed, Policy};
use vislam::simulation::FlightRecording;

use crate::chapter::Chapter;

#[allow(dead_code)]
#[path = "../../../code/examples/consistency/flown.rs"]
pub mod example;

pub use example::PICTURE_RATE;
use example::{Motion, Setting, flown, follow};
use vislam::inertial::ImuNoise;

const SECONDS: f64 = 30.0;
/// Landmarks that are kept in the state.
const KEPT: usize = 20;
const SEED: u64 = 1;
/// The first pose has left the window then, at which position and heading were known exactly.
const FREE: usize = 13;

/// A filter after a picture.
pub struct Seen {
    /// The least standard deviation of the yaw that the certificate allows, in rad; `None` while the
    /// heading is known exactly.
    pub floor: Option<f64>,
    /// What was claimed until then of the turn and of shifts, as a part of the whole.
    pub claimed_heading: f64,
    pub claimed_shifts: f64,
}

fn setting() -> Setting {
    Setting { noise: ImuNoise::mems(), landmarks: KEPT, ..Setting::default() }
}

fn recording() -> FlightRecording {
    flown(Motion::FigureEight, &setting(), SECONDS, SEED).expect("it can be flown")
}

/// The flight with a policy, picture by picture.
pub fn seen(policy: Policy) -> Vec<Seen> {
    let (mut seen, mut sum) = (Vec::new(), Claimed::default());
    follow(&recording(), &setting(), policy, SEED, |number, filter, report| {
        sum.add(&report.claimed);
        let certificate = filter.certificate().filter(|_| number >= FREE);
        seen.push(Seen {
            floor: certificate.and_then(|known| Some(known.try_inverse()?[(3, 3)].sqrt())),
            claimed_heading: sum.part_of_turn().unwrap_or(0.0),
            claimed_shifts: sum.part_of_shifts().unwrap_or(0.0),
        });
    })
    .expect("the flight is followed");
    seen
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("flight_seconds", SECONDS, "s", 0);
    chapter.number("kept", KEPT as f64, "", 0);
    let last = |policy: Policy| seen(policy).pop().expect("there are pictures");
    let standard = last(Policy::Standard);
    let others = Policy::ALL.into_iter().filter(|policy| *policy != Policy::Standard).map(last);
    let others: Vec<Seen> = others.collect();
    let most = |of: fn(&Seen) -> f64| others.iter().map(of).fold(0.0, f64::max);
    chapter.number("claimed_percent", 100.0 * standard.claimed_heading, "%", 2);
    let least = |value: f64| (value.log10().floor() + 1.0).max(-99.0);
    chapter.number("claimed_others_power", least(most(|seen| seen.claimed_heading)), "", 0);
    chapter.number(
        "claimed_shifts_power",
        least(most(|seen| seen.claimed_shifts).max(standard.claimed_shifts)),
        "",
        0,
    );
    let ideal = others.last().and_then(|seen| seen.floor).unwrap_or(f64::NAN);
    let standard = standard.floor.unwrap_or(f64::NAN);
    chapter.number("floor_ideal", 1e3 * ideal, "mrad", 1);
    chapter.number("floor_standard", 1e3 * standard, "mrad", 1);
}
