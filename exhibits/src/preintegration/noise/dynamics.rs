//! What one step does to the errors.

use nalgebra::{Matrix3, Rotation3, Vector3, Vector6};
use vislam::manifold::so3;
use vislam::preintegration::{
    self as theory, Deltas, ErrorDynamics, Matrix9, Matrix9x6, Rule, Vector9,
};

use super::oracle::{Instant, noisy, slopes, wrong};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::oracle::{STATES, parts, stack, stepped};
use crate::random::Random;

pub fn equations(chapter: &mut Chapter) {
    rows(chapter);
    blocks(chapter);
    first_frame(chapter);
}

/// Takes the instant, the errors before the step and the noise of the reading.
type Pushed = fn(&Instant, &Vector9, &Vector6<f64>) -> Vector9;

fn halves(noise: &Vector6<f64>) -> [Vector3<f64>; 2] {
    [0, 3].map(|at| noise.fixed_rows::<3>(at).into())
}

/// The three rows.
fn by_rows(at: &Instant, errors: &Vector9, noise: &Vector6<f64>) -> Vector9 {
    let ([phi, v, p], [gyro, accelerometer], dt) = (parts(errors), halves(noise), at.dt);
    let turn = dt * at.sample.gyro;
    let force = leak(at) * phi + at.deltas.rotation * accelerometer;
    stack(
        &(so3::exp(&-turn) * phi + dt * (so3::right_jacobian(&turn) * gyro)),
        &(v + dt * force),
        &(p + dt * v + 0.5 * dt * dt * force),
    )
}

/// What a small turn φ of the last body frame makes of the force in the first frame: −ΔR a^.
pub fn leak(at: &Instant) -> Matrix3<f64> {
    -(at.deltas.rotation.matrix() * so3::hat(&at.sample.accelerometer))
}

/// What blocks make of errors and noise.
fn pushed(of: ErrorDynamics, errors: &Vector9, noise: &Vector6<f64>) -> Vector9 {
    of.from_errors * errors + of.from_reading * noise
}

/// The blocks with another leak.
pub fn leaking(at: &Instant, leak: Matrix3<f64>) -> ErrorDynamics {
    with_a(with_a(euler(at), (3, 0), at.dt * leak), (6, 0), 0.5 * at.dt * at.dt * leak)
}

fn rows(chapter: &mut Chapter) {
    let mutants: [(_, Pushed); 6] = [
        ("error not turned back", |at, e, n| pushed(not_turned(at), e, n)),
        ("error turned forward", |at, e, n| pushed(turned_forward(at), e, n)),
        ("no right Jacobian", |at, e, n| pushed(without_jacobian(at), e, n)),
        ("left Jacobian for the right", |at, e, n| pushed(with_left_jacobian(at), e, n)),
        ("leak with the wrong sign", |at, e, n| pushed(leaking(at, -leak(at)), e, n)),
        ("leak in the wrong frame", |at, e, n| {
            let force = at.deltas.rotation * at.sample.accelerometer;
            pushed(leaking(at, -so3::hat(&force)), e, n)
        }),
    ];
    chapter.equation("error-dynamics", error_dynamics, by_rows, &mutants);
}

fn error_dynamics(formula: Pushed) -> Comparison {
    let against = "deltas that were made wrong, and stepped on with a noisy reading";
    Comparison::relative(against, 1e-7).over(STATES, 401, |random| {
        let (at, e, n) = draw(random);
        (formula(&at, &e, &n), moved(Rule::Euler, &at, &n, |s| wrong(&at.deltas, &(s * e))))
    })
}

/// An instant, errors and noise.
fn draw(random: &mut Random) -> (Instant, Vector9, Vector6<f64>) {
    let at = Instant::random(random);
    let e = Vector9::from_fn(|_, _| random.normal(1.0));
    (at, e, Vector6::from_fn(|_, _| random.normal(1.0)))
}

/// The derivative of the deltas after a step by how wrong their start is, and the noise with it.
fn moved(rule: Rule, at: &Instant, n: &Vector6<f64>, start: impl Fn(f64) -> Deltas) -> Vector9 {
    slopes::<1>(|s| stepped(rule, &start(s.x), &noisy(&at.sample, &(s.x * n)), at.dt))
}

type Blocks = fn(&Instant) -> ErrorDynamics;

pub fn euler(at: &Instant) -> ErrorDynamics {
    theory::error_dynamics(Rule::Euler, &at.deltas.rotation, &at.sample, at.dt)
}

fn midpoint(at: &Instant) -> ErrorDynamics {
    theory::error_dynamics(Rule::Midpoint, &at.deltas.rotation, &at.sample, at.dt)
}

/// With the block of A at this place replaced.
fn with_a(mut of: ErrorDynamics, at: (usize, usize), block: Matrix3<f64>) -> ErrorDynamics {
    of.from_errors.fixed_view_mut::<3, 3>(at.0, at.1).copy_from(&block);
    of
}

/// With the block of B at this place replaced.
fn with_b(mut of: ErrorDynamics, at: (usize, usize), block: Matrix3<f64>) -> ErrorDynamics {
    of.from_reading.fixed_view_mut::<3, 3>(at.0, at.1).copy_from(&block);
    of
}

pub fn not_turned(at: &Instant) -> ErrorDynamics {
    with_a(euler(at), (0, 0), Matrix3::identity())
}

pub fn turned_forward(at: &Instant) -> ErrorDynamics {
    with_a(euler(at), (0, 0), *so3::exp(&(at.dt * at.sample.gyro)).matrix())
}

pub fn with_left_jacobian(at: &Instant) -> ErrorDynamics {
    with_b(euler(at), (0, 0), at.dt * so3::left_jacobian(&(at.dt * at.sample.gyro)))
}

pub fn without_jacobian(at: &Instant) -> ErrorDynamics {
    with_b(euler(at), (0, 0), at.dt * Matrix3::identity())
}

fn blocks(chapter: &mut Chapter) {
    let mutants: [(_, Blocks); 6] = [
        ("the turn for its transpose", turned_forward),
        ("no leak into position", |at| with_a(euler(at), (6, 0), Matrix3::zeros())),
        ("leak with the sign of a force", |at| with_a(euler(at), (3, 0), -at.dt * leak(at))),
        ("time without the right Jacobian", without_jacobian),
        ("force in the body", |at| with_b(euler(at), (3, 3), at.dt * Matrix3::identity())),
        ("no force into position", |at| with_b(euler(at), (6, 3), Matrix3::zeros())),
    ];
    chapter.equation("error-dynamics-blocks", error_dynamics_blocks, euler, &mutants);

    let mutants: [(_, Blocks); 5] = [
        ("Euler rule", euler),
        ("noise of the gyroscope kept out of velocity", |at| {
            with_b(midpoint(at), (3, 0), Matrix3::zeros())
        }),
        ("right Jacobian for the left one", |at| {
            let (of, half) = (midpoint(at), 0.5 * at.dt);
            let leak = of.from_errors.fixed_view::<3, 3>(3, 0);
            with_b(of, (3, 0), half * leak * so3::right_jacobian(&(half * at.sample.gyro)))
        }),
        ("force not turned halfway in the leak", |at| {
            with_a(midpoint(at), (3, 0), at.dt * leak(at))
        }),
        ("force as the body stands at the beginning", |at| {
            with_b(midpoint(at), (3, 3), at.dt * at.deltas.rotation.matrix())
        }),
    ];
    chapter.equation("error-dynamics-midpoint", error_dynamics_midpoint, midpoint, &mutants);
}

fn error_dynamics_blocks(formula: Blocks) -> Comparison {
    compared_with_slopes(402, Rule::Euler, formula)
}

fn error_dynamics_midpoint(formula: Blocks) -> Comparison {
    compared_with_slopes(403, Rule::Midpoint, formula)
}

fn compared_with_slopes(seed: u64, rule: Rule, formula: Blocks) -> Comparison {
    let against = "central differences of the step by the deltas and by the reading";
    Comparison::relative(against, 1e-7).over(STATES, seed, |random| {
        let at = Instant::random(random);
        let step = |e: &Vector9, n: &Vector6<f64>| {
            stepped(rule, &wrong(&at.deltas, e), &noisy(&at.sample, n), at.dt)
        };
        let a: Matrix9 = slopes(|e| step(e, &Vector6::zeros()));
        let b: Matrix9x6 = slopes(|n| step(&Vector9::zeros(), n));
        let ErrorDynamics { from_errors, from_reading } = formula(&at);
        ((from_errors, from_reading), (a, b))
    })
}

/// The step of (θ, v, p), with the sign of the leak and the matrix of the noise as parameters.
fn in_first_frame(
    at: &Instant,
    errors: &Vector9,
    noise: &Vector6<f64>,
    sign: f64,
    from_gyro: impl Fn(&Rotation3<f64>, &Vector3<f64>) -> Matrix3<f64>,
) -> Vector9 {
    let ([theta, v, p], [gyro, accelerometer], dt) = (parts(errors), halves(noise), at.dt);
    let rotation = at.deltas.rotation;
    let gain = dt * (rotation * at.sample.accelerometer);
    let d = -sign * gain.cross(&theta) + dt * (rotation * accelerometer);
    let noise = dt * (from_gyro(&rotation, &(dt * at.sample.gyro)) * gyro);
    stack(&(theta + noise), &(v + d), &(p + dt * (v + 0.5 * d)))
}

/// N over dt: the rotation at the end of the step, times the right Jacobian.
fn end_of_step(rotation: &Rotation3<f64>, turn: &Vector3<f64>) -> Matrix3<f64> {
    (rotation * so3::exp(turn)).matrix() * so3::right_jacobian(turn)
}

fn first_frame(chapter: &mut Chapter) {
    let formula: Pushed = |at, e, n| in_first_frame(at, e, n, 1.0, end_of_step);
    let mutants: [(_, Pushed); 5] = [
        ("sign of the cross product", |at, e, n| in_first_frame(at, e, n, -1.0, end_of_step)),
        ("no leak", |at, e, n| in_first_frame(at, e, n, 0.0, end_of_step)),
        ("rotation at the beginning of the step", |at, e, n| {
            in_first_frame(at, e, n, 1.0, |r, turn| r.matrix() * so3::right_jacobian(turn))
        }),
        ("left Jacobian for the right", |at, e, n| {
            in_first_frame(at, e, n, 1.0, |r, turn| {
                (r * so3::exp(turn)).matrix() * so3::left_jacobian(turn)
            })
        }),
        ("noise in the body", |at, e, n| {
            in_first_frame(at, e, n, 1.0, |_, turn| so3::right_jacobian(turn))
        }),
    ];
    chapter.equation("covariance-first-frame", covariance_first_frame, formula, &mutants);
    let by_rule = |rule| by_rule(rule, |at, e, n| in_first_frame(at, e, n, 1.0, end_of_step));
    let rules = [Rule::Euler, Rule::Midpoint];
    chapter.counterexample("covariance-first-frame", "euler", by_rule, rules);
}

fn covariance_first_frame(formula: Pushed) -> Comparison {
    by_rule(Rule::Euler, formula)
}

fn by_rule(rule: Rule, formula: Pushed) -> Comparison {
    let against = "deltas turned wrongly on the left, stepped on, and their errors seen from there";
    Comparison::relative(against, 1e-7).over(STATES, 404, |random| {
        let (at, e, n) = draw(random);
        let moved = moved(rule, &at, &n, |s| {
            let ([theta, v, p], deltas) = (parts(&(s * e)), at.deltas);
            Deltas {
                rotation: Rotation3::new(theta) * deltas.rotation,
                velocity: deltas.velocity + v,
                position: deltas.position + p,
            }
        });
        let [phi, v, p] = parts(&moved);
        let after = stepped(rule, &at.deltas, &at.sample, at.dt);
        (formula(&at, &e, &n), stack(&(after.rotation * phi), &v, &p))
    })
}
