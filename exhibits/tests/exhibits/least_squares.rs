//! The minute of flight.

use exhibits::least_squares::window::{DEGREES, Flown, fly};
use vislam::filtering::chi_square_band;

#[test]
fn a_minute_of_flight_converges_and_errs_as_much_as_it_says() {
    let Flown { report, errors } = fly(0);
    assert!(report.stop.is_convergence());
    let [low, high] = chi_square_band(1e-4, DEGREES).unwrap();
    let steps = report.iterations.len();
    let within = errors.iter().all(|error| (low..high).contains(error));
    assert!(within, "{errors:?} after {steps} steps");
}
