//! What chapter `initialization` shows: a start at rest and one in motion, how many solutions the
//! readings leave, what noise leaves of them, and the batch of a flight.

mod attenuation;
mod batch;
mod exact;
mod exercise;
mod figures;
pub mod flights;
pub mod gtsam;
mod gyro;
pub mod judged;
mod linear;
mod map;
mod motions;
pub mod real;
mod rest;
mod solutions;
mod spectrum;
mod sphere;

use crate::chapter::Chapter;
use crate::one_flight;

pub fn exhibits(chapter: &mut Chapter) {
    rest::exhibits(chapter);
    gyro::exhibits(chapter);
    linear::exhibits(chapter);
    sphere::exhibits(chapter);
    solutions::exhibits(chapter);
    spectrum::exhibits(chapter);
    attenuation::exhibits(chapter);
    map::exhibits(chapter);
    batch::exhibits(chapter);
    flights::numbers(chapter);
    real::numbers(chapter);
    gtsam::numbers(chapter);
    exercise::numbers(chapter);
    figures::figures(chapter);
    one_flight::beginning::from_nothing(chapter);
}

pub fn records(chapter: &mut Chapter) {
    flights::record(chapter);
    real::record(chapter);
    gtsam::record(chapter);
}
