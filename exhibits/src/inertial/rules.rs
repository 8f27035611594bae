//! How wrong the two rules are, in one step and after many.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{GRAVITY, ImuSample, NavState};
use vislam::manifold::so3;
use vislam::simulation::Trajectory;

use super::noise::STEP;
use super::oracle::{bend, motion, slope};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    euler(chapter);
    midpoint(chapter);
    numbers(chapter);
}

/// A motion at one time: rotation, and both readings with two derivatives each.
struct Local {
    r: Rotation3<f64>,
    w: [Vector3<f64>; 3],
    f: [Vector3<f64>; 3],
}

impl Local {
    fn of(motion: &Trajectory, t: f64) -> Self {
        let read = |s: f64| motion.at(t + s).sample(&GRAVITY);
        let (gyro, force) = (|s: f64| read(s).gyro, |s: f64| read(s).accelerometer);
        Self {
            r: motion.at(t).state.world_from_body,
            w: [gyro(0.0), slope(gyro, 1e-3), bend(gyro, 4e-3)],
            f: [force(0.0), slope(force, 1e-3), bend(force, 4e-3)],
        }
    }

    /// The rate of the specific force in the world.
    fn jerk(&self) -> Vector3<f64> {
        self.r * (self.w[0].cross(&self.f[0]) + self.f[1])
    }
}

/// Gives the errors of rotation, velocity and position, each divided by its power of the step.
type StepError = fn(&Local) -> [Vector3<f64>; 3];

fn euler(chapter: &mut Chapter) {
    let formula: StepError = |x| euler_error(x, x.jerk());
    let mutants: [(_, StepError); 4] = [
        ("sign", |x| euler_error(x, x.jerk()).map(|error| -error)),
        ("the turn of the force dropped", |x| euler_error(x, x.r * x.f[1])),
        ("the change of the force dropped", |x| euler_error(x, x.r * x.w[0].cross(&x.f[0]))),
        ("in the body", |x| euler_error(x, x.r.inverse() * x.jerk())),
    ];
    chapter.equation("inertial-euler-error", inertial_euler_error, formula, &mutants);
}

fn euler_error(x: &Local, jerk: Vector3<f64>) -> [Vector3<f64>; 3] {
    [x.w[1] / 2.0, jerk / 2.0, jerk / 6.0]
}

fn inertial_euler_error(formula: StepError) -> Comparison {
    single_steps(30, formula, |x, [start, _], dt| x.propagate(start, &GRAVITY, dt), [2, 2, 3])
}

fn midpoint(chapter: &mut Chapter) {
    let formula: StepError = |x| [midpoint_turn(x), midpoint_velocity(x), x.jerk() / -12.0];
    let mutants: [(_, StepError); 4] = [
        ("sign", |x| [-midpoint_turn(x), -midpoint_velocity(x), x.jerk() / 12.0]),
        ("axes that stay", |x| [x.w[2] / -12.0, midpoint_velocity(x), x.jerk() / -12.0]),
        ("the force's turn taken once", |x| {
            let once = x.r * x.w[0].cross(&(x.w[0].cross(&x.f[0]) + x.f[1])) / 24.0;
            [midpoint_turn(x), once - later(x), x.jerk() / -12.0]
        }),
        ("the change of rate dropped", |x| {
            let dropped = x.r * x.w[1].cross(&x.f[0]) / 12.0;
            [midpoint_turn(x), midpoint_velocity(x) + dropped, x.jerk() / -12.0]
        }),
    ];
    chapter.equation("inertial-midpoint-error", inertial_midpoint_error, formula, &mutants);
}

fn midpoint_turn(x: &Local) -> Vector3<f64> {
    (x.w[0].cross(&x.w[1]) - x.w[2]) / 12.0
}

fn midpoint_velocity(x: &Local) -> Vector3<f64> {
    let twice = x.w[0].cross(&(x.w[0].cross(&x.f[0]) + 2.0 * x.f[1]));
    x.r * twice / 24.0 - later(x)
}

fn later(x: &Local) -> Vector3<f64> {
    x.r * (x.f[2] + x.w[1].cross(&x.f[0])) / 12.0
}

fn inertial_midpoint_error(formula: StepError) -> Comparison {
    let step: Step = |x, [start, end], dt| x.propagate_midpoint(start, end, &GRAVITY, dt);
    single_steps(31, formula, step, [3, 3, 3])
}

/// Takes a state, the readings at both ends of a step and its length.
type Step = fn(&NavState, &[ImuSample; 2], f64) -> NavState;

/// Compares with single steps along known motions, extrapolated to steps of no length.
fn single_steps(seed: u64, formula: StepError, step: Step, powers: [i32; 3]) -> Comparison {
    let against = "single steps of 2 and 4 ms along known motions, extrapolated";
    Comparison::relative(against, 3e-3).over(200, seed, |random| {
        let motion = motion(random);
        let t = random.uniform(0.0..5.0);
        let error = |dt: f64| {
            let reads = [0.0, dt].map(|s| motion.at(t + s).sample(&GRAVITY));
            let found = step(&motion.at(t).state, &reads, dt);
            let truth = motion.at(t + dt).state;
            let turned = so3::local(&found.world_from_body, &truth.world_from_body);
            let moved = [truth.velocity - found.velocity, truth.position - found.position];
            let scaled = [turned, moved[0], moved[1]];
            [0, 1, 2].map(|k| scaled[k] / dt.powi(powers[k]))
        };
        let (coarse, fine) = (error(4e-3), error(2e-3));
        let oracle = [0, 1, 2].map(|k| 2.0 * fine[k] - coarse[k]);
        (formula(&Local::of(&motion, t)), oracle)
    })
}

/// Seconds over which many steps are taken.
pub const DURATION: f64 = 10.0;

/// Rates of a sensor in the figure, in readings per second.
pub const RATES: [f64; 7] = [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];

/// Error of position after [`DURATION`] along the figure-eight, in metres.
pub fn position_error(rate: f64, midpoint: bool) -> f64 {
    error_with(rate, midpoint, ImuSample::clone)
}

/// The same with readings that something has gone wrong with.
pub fn error_with(rate: f64, midpoint: bool, read: impl Fn(&ImuSample) -> ImuSample) -> f64 {
    let motion = Trajectory::figure_eight();
    let (dt, steps) = (1.0 / rate, (DURATION * rate).round() as usize);
    let samples: Vec<_> = motion.samples(&GRAVITY, dt, steps + 1).iter().map(read).collect();
    let mut state = motion.at(0.0).state;
    for pair in samples.windows(2) {
        state = if midpoint {
            state.propagate_midpoint(&pair[0], &pair[1], &GRAVITY, dt)
        } else {
            state.propagate(&pair[0], &GRAVITY, dt)
        };
    }
    (state.position - motion.at(DURATION).state.position).norm()
}

/// Slope of the straight line through logarithms of these values over those of the places.
pub fn exponent(places: &[f64], values: &[f64]) -> f64 {
    let mean = |of: &[f64]| of.iter().map(|value| value.ln()).sum::<f64>() / of.len() as f64;
    let (x, y) = (mean(places), mean(values));
    let both = places.iter().zip(values).map(|(p, v)| (p.ln() - x) * (v.ln() - y)).sum::<f64>();
    both / places.iter().map(|p| (p.ln() - x).powi(2)).sum::<f64>()
}

fn numbers(chapter: &mut Chapter) {
    chapter.number("rule_duration", DURATION, "s", 0);
    let steps = RATES.map(|rate| 1.0 / rate);
    // The coarsest steps are not small yet.
    let fitted = |midpoint| {
        let errors = RATES.map(|rate| position_error(rate, midpoint));
        exponent(&steps[2..], &errors[2..])
    };
    chapter.number("euler_order", fitted(false), "", 2);
    chapter.number("midpoint_order", fitted(true), "", 2);
    chapter.number("euler_200_cm", 100.0 * position_error(200.0, false), "cm", 1);
    chapter.number("midpoint_200_mm", 1e3 * position_error(200.0, true), "mm", 1);
    // A velocity that is brought up to date before the position adds g dt² in every step.
    let too_much = GRAVITY.norm() * STEP;
    chapter.number("wrong_order_cm", 100.0 * too_much, "cm", 1);
}
