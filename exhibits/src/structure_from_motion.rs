//! What chapter `structure_from_motion` shows: a camera from known points, worlds laid upon each other, tracks and
//! wrong matches, and a map that grows and drifts.

mod colmap;
mod drift;
mod figures;
mod orientation;
mod pixels;
mod resection;
mod street;
mod survival;

use crate::chapter::Chapter;
use crate::one_flight;

/// Random states at which an equation is compared.
const STATES: usize = 100;

pub fn exhibits(chapter: &mut Chapter) {
    resection::exhibits(chapter);
    orientation::exhibits(chapter);
    survival::exhibits(chapter);
    drift::exhibits(chapter);
    street::numbers(chapter);
    figures::figures(chapter);
    one_flight::many_pictures::from_nothing(chapter);
}

pub fn records(chapter: &mut Chapter) {
    pixels::record(chapter);
    colmap::record(chapter);
}
