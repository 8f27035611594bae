//! The minute of flight.

use exhibits::bundle_adjustment::consistency::band;
use exhibits::least_squares::window::{DEGREES, Flown, fly};

#[test]
fn a_minute_of_flight_converges_and_errs_as_much_as_it_says() {
    let Flown { report, errors } = fly(0);
    assert!(report.stop.is_convergence());
    let [low, high] = band(1e-4, DEGREES);
    let steps = report.iterations.len();
    let within = errors.iter().all(|error| (low..high).contains(error));
    assert!(within, "{errors:?} after {steps} steps");
}
