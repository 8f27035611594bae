//! What chapter `observability` shows: what pictures and inertial readings leave free, and what it
//! costs to come near to it.

mod certainty;
mod chain;
mod draws;
mod figures;
mod near;
mod numbers;
mod oracle;
mod readings;
mod symmetry;
pub mod worked;

use crate::chapter::Chapter;
use crate::one_flight;

/// Random states at which an equation is compared, unless it takes whole windows.
const STATES: usize = 500;

pub fn exhibits(chapter: &mut Chapter) {
    chain::exhibits(chapter);
    symmetry::exhibits(chapter);
    readings::exhibits(chapter);
    certainty::exhibits(chapter);
    numbers::numbers(chapter);
    figures::figures(chapter);
    one_flight::beginning::sure_of_scale(chapter);
}
