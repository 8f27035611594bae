//! What chapter `consistency` shows: the directions of which nothing may be known, how a filter comes
//! to know of them all the same, and seven ways to linearize it.

mod bound;
mod certificate;
mod charts;
mod constrained;
mod directions;
mod draws;
mod exercise;
mod figures;
mod flight;
mod flown;
mod map;
mod real;
mod small;
mod straight;
mod theorem;
mod told;

use crate::chapter::Chapter;
use crate::one_flight;

pub fn exhibits(chapter: &mut Chapter) {
    directions::exhibits(chapter);
    certificate::exhibits(chapter);
    theorem::exhibits(chapter);
    charts::exhibits(chapter);
    constrained::exhibits(chapter);
    flight::numbers(chapter);
    flown::numbers(chapter);
    bound::numbers(chapter);
    map::numbers(chapter);
    straight::numbers(chapter);
    real::numbers(chapter);
    exercise::numbers(chapter);
    figures::figures(chapter);
    one_flight::followed::told_apart(chapter);
}

pub fn records(chapter: &mut Chapter) {
    flown::record(chapter);
    bound::record(chapter);
    map::record(chapter);
    straight::record(chapter);
    real::record(chapter);
}
