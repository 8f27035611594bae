//! What chapter `marginalization` shows: what survivors keep, what it couples, which digits it costs, and what
//! other ways of forgetting claim.

mod digits;
mod draws;
mod figures;
mod links;
mod numbers;
mod schur;
mod trees;
mod windows;

use crate::chapter::Chapter;
use crate::one_flight;

/// Random Gaussians at which an equation is compared.
const STATES: usize = 200;

pub fn exhibits(chapter: &mut Chapter) {
    schur::exhibits(chapter);
    digits::exhibits(chapter);
    links::exhibits(chapter);
    trees::exhibits(chapter);
    numbers::numbers(chapter);
    figures::figures(chapter);
    one_flight::followed::forgotten(chapter);
}
