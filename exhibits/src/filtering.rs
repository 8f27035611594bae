//! What chapter `filtering` shows: what a filter believes, how readings and measurements change it,
//! and how one finds out whether it is right.

mod carried;
mod consistent;
mod copies;
mod digits;
mod draws;
mod faults;
mod figures;
pub mod flown;
mod forgetting;
mod hover;
mod iterated;
mod numbers;
mod spot;
mod updated;

use crate::chapter::Chapter;
use crate::one_flight;

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 200;

pub fn exhibits(chapter: &mut Chapter) {
    carried::exhibits(chapter);
    updated::exhibits(chapter);
    iterated::exhibits(chapter);
    digits::exhibits(chapter);
    copies::exhibits(chapter);
    forgetting::counterexamples(chapter);
    consistent::exhibits(chapter);
    numbers::numbers(chapter);
    figures::figures(chapter);
    one_flight::followed::filtered(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    faults::record(chapter);
    hover::record(chapter);
}
