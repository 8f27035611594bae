//! The same on flights whose truth is known, computed for each build.

use nalgebra::Vector3;
use vislam::inertial::GRAVITY;
use vislam::preintegration::Rule;

use super::budget::{Pieces, gravity_found, normalized_with_truth};
use super::intervals::{LENGTHS, normalized, sizes};
use super::record::accepted_value;
use super::simulated::{Faults, STEP, flight};
use super::wander::Wander;
use crate::chapter::Chapter;

const SECONDS: f64 = 300.0;
const SEED: u64 = 5;

const LENGTH_NAMES: [&str; 4] = ["length_0", "length_1", "length_2", "length_3"];

/// What the record says is wrong with the ground truth of the real flight.
pub fn faults() -> Faults {
    let found = |name| accepted_value(&format!("v1_{name}"));
    Faults {
        attitude: Wander { sigma: 1e-3 * found("attitude_sigma"), tau: found("attitude_tau") },
        velocity: Wander { sigma: 1e-2 * found("velocity_sigma"), tau: found("velocity_tau") },
        gravity: 1e-2 * Vector3::from(["gravity_x", "gravity_y", "gravity_z"].map(found)) - GRAVITY,
    }
}

pub fn numbers(chapter: &mut Chapter) {
    for (name, seconds) in LENGTH_NAMES.into_iter().zip(LENGTHS) {
        chapter.number(name, seconds, "s", if seconds < 1.0 { 1 } else { 0 });
    }
    chapter.number("half_step", 0.5e3 * STEP, "ms", 1);
    let of_velocity = |part| accepted_value(&format!("v1_velocity_{part}_2"));
    chapter.number("push_seen", of_velocity("attitude").hypot(of_velocity("rest")), "cm/s", 1);
    let ideal = flight(SECONDS, SEED, None);
    let intervals = ideal.intervals(Rule::Midpoint, 1.0, 0.0);
    chapter.number("live_intervals", intervals.len() as f64, "", 0);
    chapter.number("live_normalized", normalized(&intervals, &GRAVITY), "", 1);
    // Three standard deviations of the mean of so many chi-square numbers of nine degrees.
    let scatter = 3.0 * (18.0 / intervals.len() as f64).sqrt();
    chapter.number("live_low", 9.0 - scatter, "", 1);
    chapter.number("live_high", 9.0 + scatter, "", 1);
    let faults = faults();
    let spoilt = flight(SECONDS, SEED, Some(&faults));
    let intervals = spoilt.intervals(Rule::Midpoint, 1.0, 0.0);
    let (gravity, _) = gravity_found(&spoilt);
    let [attitude, _] = Pieces::new(&spoilt, &gravity).wanders();
    chapter.number("live_spoilt", normalized(&intervals, &GRAVITY), "", 0);
    let [error, ..] = sizes(&intervals, &GRAVITY);
    chapter.number("live_attitude", 1e3 * error, "mrad", 2);
    chapter.number("live_gravity_x", 1e2 * gravity.x, "cm/s²", 1);
    chapter.number("live_sigma", 1e3 * attitude.sigma, "mrad", 1);
    chapter.number("live_tau", attitude.tau, "s", 1);
    let mended = normalized_with_truth(&intervals, &gravity, &attitude, &faults.velocity);
    chapter.number("live_mended", mended, "", 1);
    chapter.number("zurich", zurich(), "m/s²", 3);
}

/// Gravity on the ellipsoid of the World Geodetic System of 1984 at the latitude of Zürich, by the
/// formula of Somigliana, less what 440 metres of height take away.
fn zurich() -> f64 {
    let square = 47.38_f64.to_radians().sin().powi(2);
    let at_sea = 9.780_325_335_9 * (1.0 + 0.001_931_852_652_41 * square)
        / (1.0 - 0.006_694_379_990_14 * square).sqrt();
    at_sea - 3.086e-6 * 440.0
}
