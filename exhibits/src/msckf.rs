//! What chapter `msckf` shows: what a track says of the poses that saw it, and a filter that takes
//! nothing else from it.

mod clock;
mod compression;
mod conditions;
mod consistency;
mod cost;
mod draws;
mod figures;
pub mod flights;
mod outlier;
mod passing;
mod rank;
pub mod rotations;
mod step;
mod track;
mod windows;

use crate::chapter::Chapter;
use crate::one_flight;

/// Random tracks on which an equation is compared.
const TRACKS: usize = 100;

pub fn exhibits(chapter: &mut Chapter) {
    track::exhibits(chapter);
    rotations::exhibits(chapter);
    step::exhibits(chapter);
    conditions::counterexamples(chapter);
    rank::exhibits(chapter);
    compression::exhibits(chapter);
    clock::exhibits(chapter);
    passing::numbers(chapter);
    outlier::numbers(chapter);
    flights::numbers(chapter);
    figures::figures(chapter);
    one_flight::followed::without_map(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    consistency::record(chapter);
    cost::record(chapter);
    windows::record(chapter);
}
