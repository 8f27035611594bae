//! Cases that drop a condition of a theorem, on which what the theorem says is wrong.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{GRAVITY, ImuSample, NavState};

use super::STATES;
use super::averages::averaged;
use super::rules::exponent;
use super::strapdown::{EulerRule, composed, numbers, read, state, velocity_first};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn counterexamples(chapter: &mut Chapter) {
    let still = [0.0, 0.0];
    chapter.counterexample("inertial-yaw", "rest", keeps_the_vertical, [still, [0.1, 0.0]]);
    chapter.counterexample("inertial-yaw", "perfect", keeps_the_vertical, [still, [0.0, 0.1]]);

    let white: Covariance = |first, second| f64::from(first == second);
    let bias: Covariance = |_, _| 1.0;
    let warming: Covariance = |first, second| match first == second {
        true => 1.0 + 0.1 * first as f64,
        false => 0.0,
    };
    chapter.counterexample("inertial-density", "independent", in_proportion, [white, bias]);
    chapter.counterexample("inertial-density", "length", in_proportion, [white, warming]);

    chapter.counterexample("inertial-best-average", "walk", worse_in_the_end, [1e-4, 0.0]);

    let kept: Run = (NavState::propagate, |_| GRAVITY);
    let early: Run = (velocity_first, |_| GRAVITY);
    let growing: Run = (NavState::propagate, |t| (1.0 + 0.1 * t) * GRAVITY);
    chapter.counterexample("inertial-first-state", "rule", stays_outside, [kept, early]);
    chapter.counterexample("inertial-first-state", "gravity", stays_outside, [kept, growing]);

    chapter.counterexample("inertial-orders", "smooth", is_of_second_order, [0.0, 1.0]);
}

/// Gives a second sensor the reading of a first one that rests, although it accelerates and has a bias. Each of the
/// two leans what it belongs to by an angle.
fn keeps_the_vertical([acceleration, bias]: [f64; 2]) -> Comparison {
    let against = "the vertical, turned from one sensor to another with the same reading";
    Comparison::absolute(against, 1e-9, "no unit").over(STATES, 41, |random| {
        let first = random.rotation(3.0);
        let lean = |angle: f64| Rotation3::new(angle * Vector3::x());
        let felt = lean(bias) * (first.inverse() * -GRAVITY);
        let force = lean(acceleration) * -GRAVITY;
        let second = Rotation3::rotation_between(&felt, &force).expect("not opposite");
        let up = Vector3::z();
        (second * first.inverse() * up, up)
    })
}

/// The covariance of two readings, by their numbers.
type Covariance = fn(usize, usize) -> f64;

fn in_proportion(covariance: Covariance) -> Comparison {
    let against = "the variance of sums of readings, from all their covariances";
    Comparison::relative(against, 1e-12).each([(0, 2), (7, 10), (50, 40)], |(first, count)| {
        let readings = first..first + count;
        let with_all = |one| readings.clone().map(move |other| covariance(one, other)).sum::<f64>();
        (count as f64 * covariance(0, 0), readings.clone().map(with_all).sum::<f64>())
    })
}

/// Whether a rest of two days tells less about the bias than one of a day.
fn worse_in_the_end(walk: f64) -> Comparison {
    let against = "the variance after one day of rest and after two";
    let [day, two] = [1.0, 2.0].map(|days| averaged(1e-3, walk, 86_400.0 * days));
    Comparison::absolute(against, 1e-12, "no unit").once(two > day, true)
}

/// A rule for one step, and gravity at a time.
type Run = (EulerRule, fn(f64) -> Vector3<f64>);

fn stays_outside((rule, gravity): Run) -> Comparison {
    let against = "runs of 25 steps from the first state, with gravity";
    Comparison::absolute(against, 1e-12, "m, m/s, no unit").over(STATES, 42, |random| {
        let first = state(random);
        let (mut there, mut own, mut time) = (first, NavState::origin(), 0.0);
        for _ in 0..25 {
            let (reading, dt) = (read(random), random.uniform(0.002..0.01));
            there = rule(&there, &reading, &gravity(time), dt);
            own = rule(&own, &reading, &Vector3::zeros(), dt);
            time += dt;
        }
        let found = composed(&first, &own, &gravity(0.0), time);
        (numbers(&found), numbers(&there))
    })
}

/// The power of the step by which the midpoint rule errs about a turn whose rate jumps by `jump` in mid-step.
fn is_of_second_order(jump: f64) -> Comparison {
    let against = "the slope of its errors over four steps from 100 to 12.5 ms";
    let (knock, end) = (1.0 / 3.0, 1.0);
    let steps = [0.1, 0.05, 0.025, 0.0125];
    let errors = steps.map(|dt: f64| {
        let reading = |k: usize| {
            let t = k as f64 * dt;
            let rate = t.exp() + if t > knock { jump } else { 0.0 };
            ImuSample { gyro: rate * Vector3::z(), accelerometer: Vector3::zeros() }
        };
        let step =
            |x: NavState, k| x.propagate_midpoint(&reading(k), &reading(k + 1), &GRAVITY, dt);
        let found = (0..(end / dt).round() as usize).fold(NavState::origin(), step);
        let truth = end.exp() - 1.0 + jump * (end - knock);
        found.world_from_body.angle_to(&Rotation3::new(truth * Vector3::z()))
    });
    let power = exponent(&steps, &errors);
    Comparison::absolute(against, 0.05, "no unit").once(power, 2.0)
}
