//! What chapter `robust_two_view` shows: five points, agreement among matches of which most are wrong, and which
//! model two pictures call for.

mod agreement;
mod chance;
mod figures;
mod five_points;
mod leverage;
mod models;
mod poselib;
mod scenes;
mod selected;
mod shares;
mod success;
mod worked;

use crate::chapter::Chapter;
use crate::one_flight;

/// Random states at which an equation is compared.
const STATES: usize = 200;

pub fn exhibits(chapter: &mut Chapter) {
    five_points::exhibits(chapter);
    agreement::exhibits(chapter);
    leverage::exhibits(chapter);
    chance::exhibits(chapter);
    models::exhibits(chapter);
    success::exhibits(chapter);
    worked::numbers(chapter);
    selected::numbers(chapter);
    shares::numbers(chapter);
    poselib::numbers(chapter);
    figures::figures(chapter);
    one_flight::two_pictures::robust(chapter);
}

pub fn records(chapter: &mut Chapter) {
    five_points::record(chapter);
    shares::record(chapter);
    poselib::record(chapter);
}
