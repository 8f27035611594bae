//! What wanders, and gravity beside a bias.

use exhibits::random::Random;
use exhibits::real_flights::wander::Wander;
use nalgebra::Vector3;
use vislam::inertial::GRAVITY;

use exhibits::real_flights::budget::{gravity_beside_a_bias, gravity_found};
use exhibits::real_flights::simulated::flight;

#[test]
fn a_drawn_wander_spreads_as_it_should_and_is_found_again() {
    let wander = Wander { sigma: 2.0, tau: 1.5 };
    let values = wander.drawn(&mut Random::new(1), 0.05, 200_000);
    let lags = [1, 4, 20, 60];
    let squares = lags.map(|lag| {
        let pairs = values.windows(lag + 1).map(|w| (w[lag] - w[0]).norm_squared());
        pairs.sum::<f64>() / (values.len() - lag) as f64
    });
    let times = lags.map(|lag| 0.05 * lag as f64);
    for (square, time) in squares.iter().zip(times) {
        assert!((square / wander.spread(time) - 1.0).abs() < 0.05);
    }
    let found = Wander::fitted(&times, &squares);
    assert!((found.sigma / 2.0 - 1.0).abs() < 0.05 && (found.tau / 1.5 - 1.0).abs() < 0.05);
}

#[test]
fn a_bias_that_is_believed_is_weighed_as_gravity_and_one_that_is_free_is_not() {
    let mut flight = flight(120.0, 7, None);
    let wrong = Vector3::new(0.0, 0.0, 0.17);
    flight.truth.iter_mut().for_each(|truth| truth.bias.accelerometer -= wrong);
    assert!((gravity_found(&flight).0.norm() - GRAVITY.norm()).abs() > 0.1);
    let free = gravity_beside_a_bias(&flight);
    let (gravity, bias) = (free.gravity - GRAVITY, free.bias - wrong);
    for axis in 0..3 {
        assert!(gravity[axis].abs() < 4.0 * free.sigma(axis), "{gravity} of {axis}");
        assert!(bias[axis].abs() < 4.0 * free.sigma(3 + axis), "{bias} of {axis}");
    }
    assert!(free.correlation(2, 5).abs() > 0.9);
}
