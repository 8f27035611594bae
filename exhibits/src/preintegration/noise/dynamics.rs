//! What one step does to the errors.

use nalgebra::{Matrix3, Rotation3, Vector3, Vector6};
use vislam::manifold::so3;
use vislam::preintegration::{self as theory, ErrorDynamics, Matrix9, Matrix9x6, Rule, Vector9};

use super::oracle::{Instant, noisy, slopes, stepped, wrong};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

const STATES: usize = 500;

pub fn equations(chapter: &mut Chapter) {
    rows(chapter);
    blocks(chapter);
    first_frame(chapter);
}

/// Takes the instant, the errors before the step and the noise of the reading.
type Pushed = fn(&Instant, &Vector9, &Vector6<f64>) -> Vector9;

fn thirds(errors: &Vector9) -> [Vector3<f64>; 3] {
    [0, 3, 6].map(|at| errors.fixed_rows::<3>(at).into())
}

fn halves(noise: &Vector6<f64>) -> [Vector3<f64>; 2] {
    [0, 3].map(|at| noise.fixed_rows::<3>(at).into())
}

fn joined(phi: Vector3<f64>, v: Vector3<f64>, p: Vector3<f64>) -> Vector9 {
    Vector9::from_iterator(phi.iter().chain(v.iter()).chain(p.iter()).copied())
}

/// The three rows with the factors that can be wrong.
fn by_rows(
    at: &Instant,
    errors: &Vector9,
    noise: &Vector6<f64>,
    back: impl Fn(&Vector3<f64>) -> Rotation3<f64>,
    jacobian: impl Fn(&Vector3<f64>) -> Matrix3<f64>,
    leak: impl Fn(&Rotation3<f64>, &Vector3<f64>) -> Matrix3<f64>,
) -> Vector9 {
    let ([phi, v, p], [gyro, accelerometer], dt) = (thirds(errors), halves(noise), at.dt);
    let turn = dt * at.sample.gyro;
    let rotation = at.deltas.rotation;
    let force = leak(&rotation, &at.sample.accelerometer) * phi + rotation * accelerometer;
    joined(
        back(&turn) * phi + dt * (jacobian(&turn) * gyro),
        v + dt * force,
        p + dt * v + 0.5 * dt * dt * force,
    )
}

fn turned_back(turn: &Vector3<f64>) -> Rotation3<f64> {
    so3::exp(&-turn)
}

fn leak(rotation: &Rotation3<f64>, force: &Vector3<f64>) -> Matrix3<f64> {
    -(rotation.matrix() * so3::hat(force))
}

fn rows(chapter: &mut Chapter) {
    let formula: Pushed = |at, e, n| by_rows(at, e, n, turned_back, so3::right_jacobian, leak);
    let mutants: [(_, Pushed); 6] = [
        ("error not turned back", |at, e, n| {
            by_rows(at, e, n, |_| Rotation3::identity(), so3::right_jacobian, leak)
        }),
        ("error turned forward", |at, e, n| by_rows(at, e, n, so3::exp, so3::right_jacobian, leak)),
        ("no right Jacobian", |at, e, n| {
            by_rows(at, e, n, turned_back, |_| Matrix3::identity(), leak)
        }),
        ("left Jacobian for the right", |at, e, n| {
            by_rows(at, e, n, turned_back, so3::left_jacobian, leak)
        }),
        ("leak with the wrong sign", |at, e, n| {
            by_rows(at, e, n, turned_back, so3::right_jacobian, |r, a| -leak(r, a))
        }),
        ("leak in the wrong frame", |at, e, n| {
            by_rows(at, e, n, turned_back, so3::right_jacobian, |r, a| -so3::hat(&(r * a)))
        }),
    ];
    chapter.equation("error-dynamics", error_dynamics, formula, &mutants);
}

fn error_dynamics(formula: Pushed) -> Comparison {
    let against = "deltas that were made wrong, and stepped on with a noisy reading";
    let mut comparison = Comparison::relative(against, 1e-7);
    let mut random = Random::new(401);
    for _ in 0..STATES {
        let at = Instant::random(&mut random);
        let e = Vector9::from_fn(|_, _| random.normal(1.0));
        let n = Vector6::from_fn(|_, _| random.normal(1.0));
        let moved = slopes::<1>(|s| {
            let start = wrong(&at.deltas, &(s.x * e));
            stepped(Rule::Euler, &start, &noisy(&at.sample, &(s.x * n)), at.dt)
        });
        comparison.add(formula(&at, &e, &n).as_slice(), moved.as_slice());
    }
    comparison
}

type Blocks = fn(&Instant) -> ErrorDynamics;

fn euler(at: &Instant) -> ErrorDynamics {
    theory::error_dynamics(Rule::Euler, &at.deltas.rotation, &at.sample, at.dt)
}

fn midpoint(at: &Instant) -> ErrorDynamics {
    theory::error_dynamics(Rule::Midpoint, &at.deltas.rotation, &at.sample, at.dt)
}

/// With one block of A replaced.
fn with_a(
    mut of: ErrorDynamics,
    (row, column): (usize, usize),
    block: Matrix3<f64>,
) -> ErrorDynamics {
    of.from_errors.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
    of
}

/// With one block of B replaced.
fn with_b(
    mut of: ErrorDynamics,
    (row, column): (usize, usize),
    block: Matrix3<f64>,
) -> ErrorDynamics {
    of.from_reading.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
    of
}

fn blocks(chapter: &mut Chapter) {
    let mutants: [(_, Blocks); 6] = [
        ("the turn for its transpose", |at| {
            with_a(euler(at), (0, 0), *so3::exp(&(at.dt * at.sample.gyro)).matrix())
        }),
        ("no leak into position", |at| with_a(euler(at), (6, 0), Matrix3::zeros())),
        ("leak with the sign of a force", |at| {
            let of = euler(at);
            with_a(of, (3, 0), -of.from_errors.fixed_view::<3, 3>(3, 0).into_owned())
        }),
        ("time without the right Jacobian", |at| {
            with_b(euler(at), (0, 0), at.dt * Matrix3::identity())
        }),
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
            let of = midpoint(at);
            let leak = of.from_errors.fixed_view::<3, 3>(3, 0);
            let half = 0.5 * at.dt;
            let block = half * leak * so3::right_jacobian(&(half * at.sample.gyro));
            with_b(of, (3, 0), block)
        }),
        ("force not turned halfway in the leak", |at| {
            let of = midpoint(at);
            let leak = euler(at).from_errors.fixed_view::<3, 3>(3, 0).into_owned();
            with_a(of, (3, 0), leak)
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
    let mut comparison = Comparison::relative(against, 1e-7);
    let mut random = Random::new(seed);
    for _ in 0..STATES {
        let at = Instant::random(&mut random);
        let step = |e: &Vector9, n: &Vector6<f64>| {
            stepped(rule, &wrong(&at.deltas, e), &noisy(&at.sample, n), at.dt)
        };
        let a: Matrix9 = slopes(|e| step(e, &Vector6::zeros()));
        let b: Matrix9x6 = slopes(|n| step(&Vector9::zeros(), n));
        let ErrorDynamics { from_errors, from_reading } = formula(&at);
        let of = [from_errors.as_slice(), from_reading.as_slice()].concat();
        comparison.add(&of, &[a.as_slice(), b.as_slice()].concat());
    }
    comparison
}

/// The step of (θ, v, p), with the sign of the leak and the matrix of the noise as parameters.
fn in_first_frame(
    at: &Instant,
    errors: &Vector9,
    noise: &Vector6<f64>,
    sign: f64,
    from_gyro: impl Fn(&Rotation3<f64>, &Vector3<f64>) -> Matrix3<f64>,
) -> Vector9 {
    let ([theta, v, p], [gyro, accelerometer], dt) = (thirds(errors), halves(noise), at.dt);
    let rotation = at.deltas.rotation;
    let gain = dt * (rotation * at.sample.accelerometer);
    let d = -sign * gain.cross(&theta) + dt * (rotation * accelerometer);
    let noise = dt * (from_gyro(&rotation, &(dt * at.sample.gyro)) * gyro);
    joined(theta + noise, v + d, p + dt * (v + 0.5 * d))
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
    chapter.counterexample(
        "covariance-first-frame",
        "euler",
        |rule| by_rule(rule, |at, e, n| in_first_frame(at, e, n, 1.0, end_of_step)),
        [Rule::Euler, Rule::Midpoint],
    );
}

fn covariance_first_frame(formula: Pushed) -> Comparison {
    by_rule(Rule::Euler, formula)
}

fn by_rule(rule: Rule, formula: Pushed) -> Comparison {
    let against = "deltas turned wrongly on the left, stepped on, and their errors seen from there";
    let mut comparison = Comparison::relative(against, 1e-7);
    let mut random = Random::new(404);
    for _ in 0..STATES {
        let at = Instant::random(&mut random);
        let e = Vector9::from_fn(|_, _| random.normal(1.0));
        let n = Vector6::from_fn(|_, _| random.normal(1.0));
        let after = stepped(rule, &at.deltas, &at.sample, at.dt);
        let moved = slopes::<1>(|s| {
            let [theta, v, p] = thirds(&(s.x * e));
            let mut start = at.deltas;
            start.rotation = Rotation3::new(theta) * start.rotation;
            start.velocity += v;
            start.position += p;
            stepped(rule, &start, &noisy(&at.sample, &(s.x * n)), at.dt)
        });
        let [phi, v, p] = thirds(&moved);
        let oracle = joined(after.rotation * phi, v, p);
        comparison.add(formula(&at, &e, &n).as_slice(), oracle.as_slice());
    }
    comparison
}
