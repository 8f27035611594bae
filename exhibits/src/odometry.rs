//! What chapter `odometry` shows: the whole estimator on simulated flights, with one thing after the other switched off,
//! and on a real one.

mod begun;
mod figures;
pub mod real;
pub mod switches;

use crate::chapter::Chapter;
use crate::one_flight;

pub fn exhibits(chapter: &mut Chapter) {
    switches::numbers(chapter);
    begun::numbers(chapter);
    real::numbers(chapter);
    figures::figures(chapter);
    one_flight::followed::from_nothing(chapter);
}

pub fn records(chapter: &mut Chapter) {
    switches::record(chapter);
    begun::record(chapter);
    real::record(chapter);
}
