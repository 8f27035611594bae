//! What chapter `inertial` shows: what an inertial sensor feels, how wrong it is, and where that leads.
//!
//! Each part registers its equations, then checks them, and the numbers that belong to them.

mod averages;
mod calibration;
mod camera;
mod clock;
mod conditions;
mod drift;
mod figures;
mod gravity;
mod noise;
mod oracle;
pub mod rest;
pub mod rules;
mod scale;
mod sheet;
mod shutter;
mod strapdown;

use crate::chapter::Chapter;
use crate::one_flight;

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

pub fn exhibits(chapter: &mut Chapter) {
    gravity::exhibits(chapter);
    noise::exhibits(chapter);
    averages::exhibits(chapter);
    rest::numbers(chapter);
    sheet::exhibits(chapter);
    scale::numbers(chapter);
    strapdown::exhibits(chapter);
    rules::exhibits(chapter);
    drift::exhibits(chapter);
    camera::exhibits(chapter);
    clock::exhibits(chapter);
    shutter::exhibits(chapter);
    calibration::numbers(chapter);
    conditions::counterexamples(chapter);
    figures::figures(chapter);
    one_flight::readings::dead_reckoning(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    rest::record(chapter);
}
