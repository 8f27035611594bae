//! What chapter `loop_closure` shows: measurements between keyframes, the minimum and where to begin, whether it is the
//! lowest one, and what wrong loops do.

mod certificate;
mod chordal;
mod draws;
mod figures;
pub mod flight;
mod public_graphs;
mod relative;
mod robust;
mod sharing;
mod sphere;
mod upright;
mod wrong;

use crate::chapter::Chapter;
use crate::one_flight;

/// Random states at which an equation is compared.
const STATES: usize = 200;

pub fn exhibits(chapter: &mut Chapter) {
    relative::exhibits(chapter);
    sharing::exhibits(chapter);
    upright::exhibits(chapter);
    chordal::exhibits(chapter);
    certificate::exhibits(chapter);
    robust::exhibits(chapter);
    flight::numbers(chapter);
    sphere::numbers(chapter);
    wrong::numbers(chapter);
    public_graphs::numbers(chapter);
    one_flight::followed::recognized(chapter);
    figures::figures(chapter);
}

pub fn records(chapter: &mut Chapter) {
    flight::record(chapter);
    public_graphs::record(chapter);
}
