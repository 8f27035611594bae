//! What chapter `bundle_adjustment` shows: how a problem of many points becomes one of a few cameras,
//! and how sure its solution is.

mod certainty;
mod conditions;
pub mod consistency;
mod dense;
mod figures;
mod gauge;
mod growth;
mod numbers;
mod outliers;
mod points_first;
pub mod progress;
mod rails;
mod stereo;
mod whole;

use crate::chapter::Chapter;
use crate::one_flight;

pub fn exhibits(chapter: &mut Chapter) {
    points_first::exhibits(chapter);
    conditions::counterexamples(chapter);
    numbers::numbers(chapter);
    certainty::exhibits(chapter);
    gauge::numbers(chapter);
    stereo::numbers(chapter);
    consistency::numbers(chapter);
    outliers::numbers(chapter);
    growth::numbers(chapter);
    figures::figures(chapter);
    one_flight::many_pictures::adjusted(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    consistency::record(chapter);
    growth::record(chapter);
}
