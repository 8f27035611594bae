//! How badly a place may be known before rounding takes its covariance away.

use vislam::odometry::Estimator;
use vislam::simulation::Flight;

use super::followed::{Followed, options};
use crate::chapter::Chapter;
use crate::msckf::flights::example::{flight, start};
use crate::msckf::flights::flown;

const SECONDS: f64 = 3.0;
/// Standard deviations of the place at the beginning, in metres.
const PLACES: [f64; 9] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];

pub fn numbers(chapter: &mut Chapter) {
    for (name, picture_rate) in [("known_of_twenty", 20.0), ("known_of_a_hundred", 100.0)] {
        let flight = Flight { picture_rate, ..flight(SECONDS) };
        let known = PLACES.into_iter().take_while(|sigma| is_known(&flight, *sigma)).last();
        chapter.number(name, known.expect("the first of them is known"), "m", 0);
    }
}

/// Whether the smoother says after each picture how well it knows the place, to a tenth.
fn is_known(flight: &Flight, sigma: f64) -> bool {
    let recording = flown(flight, 0);
    let mut start = start(&recording, 0);
    (6..9).for_each(|at| start.covariance[(at, at)] = sigma * sigma);
    let options = options(&recording, Estimator::Smoother);
    let followed = Followed::simulated(&recording, options, &start).expect("it is followed");
    let is_right = |variance: f64| (variance.sqrt() / sigma - 1.0).abs() < 0.1;
    followed.causal.len() == recording.pictures.len() - 1
        && followed.causal.iter().all(|(_, said)| is_right(said.covariance[(6, 6)]))
}
