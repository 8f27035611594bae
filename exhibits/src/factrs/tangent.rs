//! Preintegration in the tangent space, as factrs and GTSAM do it, held against the book's on the group.

use nalgebra::{Matrix3, Vector3};
use vislam::manifold::so3;

use super::predicted::{self, overshoot, summed};
use super::two_keyframes::HUBER;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};
use crate::random::Random;

const STATES: usize = 200;
const STEP: f64 = 1e-5;
/// Steps of an interval, and seconds of each.
const READINGS: usize = 200;
const SECONDS: f64 = 0.005;
/// Draws of a pixel's noise.
const DRAWS: usize = 100_000;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Overshoot); 4] = [
        ("sign", |rates, dt| -overshoot(rates, dt)),
        ("across the turn, not the rate", |rates, dt| {
            summed(rates, dt, |turn, rate| turn.cross(&rate.cross(turn)))
        }),
        ("along the rate", |rates, dt| summed(rates, dt, |turn, rate| rate * turn.dot(rate))),
        ("half of it", |rates, dt| 0.5 * overshoot(rates, dt)),
    ];
    chapter.equation("tangent-overshoot", tangent_overshoot, overshoot, &mutants);
    let mutants: [(_, Spread); 4] = [
        ("not seen from elsewhere", |_, covariance| *covariance),
        ("the left Jacobian", |turn, covariance| predicted::tangent_covariance(&-turn, covariance)),
        ("not inverted", |turn, covariance| {
            let jacobian = so3::right_jacobian(turn);
            jacobian * covariance * jacobian.transpose()
        }),
        ("transposed on the wrong side", |turn, covariance| {
            let jacobian = so3::right_jacobian_inverse(turn);
            jacobian.transpose() * covariance * jacobian
        }),
    ];
    chapter.equation(
        "tangent-covariance",
        tangent_covariance,
        predicted::tangent_covariance,
        &mutants,
    );
    let mutants: [(_, Share); 3] = [
        ("one coordinate", |k| 2.0 * (1.0 - normal_below(k))),
        ("not halved", |k| (-k * k).exp()),
        ("of the norm, not its square", |k| (-0.5 * k).exp()),
    ];
    chapter.equation("pixel-beyond", pixel_beyond, share_beyond, &mutants);
    chapter.number("beyond", 100.0 * share_beyond(HUBER), "%", 0);
    chapter.number("beyond_single", 200.0 * (1.0 - normal_below(HUBER)), "%", 0);
    chapter.number("huber", HUBER, "", 3);
}

/// By how much a turn is too long, from the rates of its readings and the seconds of each.
type Overshoot = fn(&[Vector3<f64>], f64) -> Vector3<f64>;
/// The share of pixels beyond a threshold.
type Share = fn(f64) -> f64;
/// The covariance of a rotation vector from that of a small turn after it.
type Spread = fn(&Vector3<f64>, &Matrix3<f64>) -> Matrix3<f64>;

/// The share of good pixels whose whitened residual is longer than a threshold. Implements {eq:pixel-beyond}.
fn share_beyond(threshold: f64) -> f64 {
    (-0.5 * threshold * threshold).exp()
}

/// The probability that a normal number is below another.
fn normal_below(number: f64) -> f64 {
    // Simpson's rule on the density is exact to many digits here.
    let density = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    let step = number / 1000.0;
    let weight = |k: u32| if k == 0 || k == 1000 { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
    let sum: f64 = (0..=1000).map(|k| weight(k) * density(step * f64::from(k))).sum();
    0.5 + step / 3.0 * sum
}

/// Against both schemes, run on the same readings.
fn tangent_overshoot(formula: Overshoot) -> Comparison {
    let against = "Euler's rule in the tangent space less the product of the turns";
    Comparison::relative(against, 0.1).over(STATES, 71, |random| {
        let rates = rates(random);
        let (mut tangent, mut turn) = (Vector3::zeros(), nalgebra::Rotation3::identity());
        for rate in &rates {
            tangent += SECONDS * so3::right_jacobian_inverse(&tangent) * rate;
            turn *= so3::exp(&(SECONDS * rate));
        }
        (formula(&rates, SECONDS), tangent - so3::log(&turn))
    })
}

/// Angular velocities that change as those of a flight do, and turn by less than half a radian.
fn rates(random: &mut Random) -> Vec<Vector3<f64>> {
    let (from, to) = (random.direction(0.4), random.direction(0.4));
    let share = |k: usize| k as f64 / READINGS as f64;
    (0..READINGS).map(|k| (1.0 - share(k)) * from + share(k) * to).collect()
}

/// Against differences of the rotation vector by the small turn.
fn tangent_covariance(formula: Spread) -> Comparison {
    let against = "central differences of log(exp(θ) exp(φ))";
    Comparison::relative(against, 1e-7).over(STATES, 72, |random| {
        let length = random.uniform(0.5..2.0);
        let turn = random.direction(length);
        let root = Matrix3::from_fn(|_, _| random.normal(1.0));
        let covariance = root * root.transpose();
        let rotation = so3::exp(&turn);
        let moved = |phi: Vector3<f64>| so3::log(&(rotation * so3::exp(&phi)));
        let by_phi: Matrix3<f64> = differences(STEP, moved);
        (formula(&turn, &covariance), by_phi * covariance * by_phi.transpose())
    })
}

/// Against a count of drawn pixels.
fn pixel_beyond(formula: Share) -> Comparison {
    Comparison::absolute("the share of drawn pixels", 0.01, "").over(25, 73, |random| {
        let threshold = random.uniform(0.8..2.2);
        let mut is_beyond = || random.normal(1.0).hypot(random.normal(1.0)) > threshold;
        let count = (0..DRAWS).filter(|_| is_beyond()).count();
        (formula(threshold), count as f64 / DRAWS as f64)
    })
}
