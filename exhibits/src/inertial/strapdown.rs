//! How a state moves with what the sensor feels: the equations and the two rules.

use nalgebra::{Matrix3, Rotation3, SVector, Vector3};
use vislam::inertial::{GRAVITY, ImuSample, NavState};
use vislam::manifold::so3;

use super::STATES;
use super::oracle::{motion, slope};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::manifold::oracle::cross;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    continuous(chapter);
    euler(chapter);
    midpoint(chapter);
    first_state(chapter);
}

fn continuous(chapter: &mut Chapter) {
    let mutants: [(_, Strapdown); 5] = [
        ("angular velocity on the left", |x, read, g| Rates {
            rotation: so3::hat(&read.gyro) * x.world_from_body.matrix(),
            ..rates(x, read, g)
        }),
        ("gravity subtracted", |x, read, g| rates(x, read, &-g)),
        ("force not turned", |x, read, g| Rates {
            velocity: g + read.accelerometer,
            ..rates(x, read, g)
        }),
        ("force turned backwards", |x, read, g| Rates {
            velocity: g + x.world_from_body.inverse() * read.accelerometer,
            ..rates(x, read, g)
        }),
        ("velocity in the body", |x, read, g| Rates {
            position: x.world_from_body * x.velocity,
            ..rates(x, read, g)
        }),
    ];
    chapter.equation("inertial-strapdown", inertial_strapdown, rates, &mutants);
}

/// Rates of rotation, velocity and position.
struct Rates {
    rotation: Matrix3<f64>,
    velocity: Vector3<f64>,
    position: Vector3<f64>,
}

fn rates(x: &NavState, read: &ImuSample, g: &Vector3<f64>) -> Rates {
    let r = x.world_from_body;
    Rates {
        rotation: r.matrix() * so3::hat(&read.gyro),
        velocity: g + r * read.accelerometer,
        position: x.velocity,
    }
}

type Strapdown = fn(&NavState, &ImuSample, &Vector3<f64>) -> Rates;

fn inertial_strapdown(formula: Strapdown) -> Comparison {
    let against = "differences of rotation, velocity and position along known motions";
    let mut comparison = Comparison::absolute(against, 1e-7, "rad/s, m/s², m/s");
    let mut random = Random::new(20);
    for _ in 0..STATES {
        let motion = motion(&mut random);
        let t = random.uniform(0.0..5.0);
        let state = |s: f64| motion.at(t + s).state;
        let found = formula(&state(0.0), &motion.at(t).sample(&GRAVITY), &GRAVITY);
        let rotation = slope(|s| *state(s).world_from_body.matrix(), 1e-3);
        comparison.add(found.rotation.as_slice(), rotation.as_slice());
        comparison.add(found.velocity.as_slice(), slope(|s| state(s).velocity, 1e-3).as_slice());
        comparison.add(found.position.as_slice(), slope(|s| state(s).position, 1e-3).as_slice());
    }
    comparison
}

fn euler(chapter: &mut Chapter) {
    let mutants: [(_, EulerRule); 6] = [
        ("rotation first", rotation_first),
        ("velocity before position", velocity_first),
        ("no acceleration in the position", |x, read, g, dt| NavState {
            position: x.position + dt * x.velocity,
            ..x.propagate(read, g, dt)
        }),
        ("turned on the left", |x, read, g, dt| NavState {
            world_from_body: so3::exp(&(dt * read.gyro)) * x.world_from_body,
            ..x.propagate(read, g, dt)
        }),
        ("gravity subtracted", |x, read, g, dt| x.propagate(read, &-g, dt)),
        ("gravity forgotten", |x, read, _, dt| x.propagate(read, &Vector3::zeros(), dt)),
    ];
    chapter.equation("inertial-euler-rule", inertial_euler_rule, NavState::propagate, &mutants);
}

fn turn(state: &NavState, gyro: &Vector3<f64>, dt: f64) -> Rotation3<f64> {
    so3::retract(&state.world_from_body, &(dt * gyro))
}

/// The Euler rule with a force that acts as the body stands after the step.
fn rotation_first(x: &NavState, read: &ImuSample, gravity: &Vector3<f64>, dt: f64) -> NavState {
    let turned = NavState { world_from_body: turn(x, &read.gyro, dt), ..*x };
    NavState { world_from_body: turned.world_from_body, ..turned.propagate(read, gravity, dt) }
}

/// The Euler rule with a position that uses the velocity after the step.
pub fn velocity_first(x: &NavState, read: &ImuSample, gravity: &Vector3<f64>, dt: f64) -> NavState {
    let next = x.propagate(read, gravity, dt);
    NavState { position: next.position + dt * (next.velocity - x.velocity), ..next }
}

/// Takes a state, a reading, gravity and the length of the step.
pub type EulerRule = fn(&NavState, &ImuSample, &Vector3<f64>, f64) -> NavState;

fn inertial_euler_rule(formula: EulerRule) -> Comparison {
    let against = "the equations by Runge and Kutta, the force held in its first direction";
    Comparison::absolute(against, 1e-9, "m, m/s, no unit").over(100, 21, |random| {
        let (state, read, dt) = (state(random), read(random), random.uniform(0.01..0.1));
        let along = *state.world_from_body.matrix();
        let found = formula(&state, &read, &GRAVITY, dt);
        (numbers(&found), integrated(&state, &read, &along, dt))
    })
}

fn midpoint(chapter: &mut Chapter) {
    let mutants: [(_, MidpointRule); 5] = [
        ("the first reading alone", |x, start, _, g, dt| x.propagate_midpoint(start, start, g, dt)),
        ("the force along the beginning", |x, start, end, g, dt| {
            x.propagate(&ImuSample::mean(start, end), g, dt)
        }),
        ("the force along the end", |x, start, end, g, dt| {
            rotation_first(x, &ImuSample::mean(start, end), g, dt)
        }),
        ("half of the turn", |x, start, end, g, dt| NavState {
            world_from_body: turn(x, &ImuSample::mean(start, end).gyro, 0.5 * dt),
            ..x.propagate_midpoint(start, end, g, dt)
        }),
        ("gravity subtracted", |x, start, end, g, dt| x.propagate_midpoint(start, end, &-g, dt)),
    ];
    let formula: MidpointRule = NavState::propagate_midpoint;
    chapter.equation("inertial-midpoint-rule", inertial_midpoint_rule, formula, &mutants);
}

type MidpointRule = fn(&NavState, &ImuSample, &ImuSample, &Vector3<f64>, f64) -> NavState;

fn inertial_midpoint_rule(formula: MidpointRule) -> Comparison {
    let against = "the equations by Runge and Kutta, the force held in its direction halfway";
    Comparison::absolute(against, 1e-9, "m, m/s, no unit").over(100, 22, |random| {
        let (state, dt) = (state(random), random.uniform(0.01..0.1));
        let (start, end) = (read(random), read(random));
        let mean = ImuSample {
            gyro: (start.gyro + end.gyro) / 2.0,
            accelerometer: (start.accelerometer + end.accelerometer) / 2.0,
        };
        let half = integrated(&state, &mean, &Matrix3::identity(), 0.5 * dt);
        let along = Matrix3::from_iterator(half.iter().copied().take(9));
        let found = formula(&state, &start, &end, &GRAVITY, dt);
        (numbers(&found), integrated(&state, &mean, &along, dt))
    })
}

pub fn state(random: &mut Random) -> NavState {
    NavState {
        world_from_body: random.rotation(3.0),
        velocity: random.direction(2.0),
        position: random.direction(5.0),
    }
}

pub fn read(random: &mut Random) -> ImuSample {
    ImuSample { gyro: random.direction(2.0), accelerometer: random.direction(9.0) }
}

pub type Fifteen = SVector<f64, 15>;

/// The rotation's nine entries, column by column, then velocity and position.
pub fn numbers(state: &NavState) -> Fifteen {
    let matrix = state.world_from_body.matrix();
    let all = matrix.iter().chain(state.velocity.iter()).chain(state.position.iter());
    Fifteen::from_iterator(all.copied())
}

/// R' = R ω^, v' = g + A f, p' = v for a constant matrix A, in steps of Runge and Kutta.
fn integrated(state: &NavState, read: &ImuSample, along: &Matrix3<f64>, dt: f64) -> Fifteen {
    let acceleration = GRAVITY + along * read.accelerometer;
    let rate = |x: &Fifteen| {
        let rotation = Matrix3::from_iterator(x.iter().copied().take(9)) * cross(&read.gyro);
        let velocity = x.fixed_rows::<3>(9);
        let all = rotation.iter().chain(acceleration.iter()).chain(velocity.iter());
        Fifteen::from_iterator(all.copied())
    };
    let (mut x, steps) = (numbers(state), 20);
    let h = dt / f64::from(steps);
    for _ in 0..steps {
        let first = rate(&x);
        let second = rate(&(x + 0.5 * h * first));
        let third = rate(&(x + 0.5 * h * second));
        let fourth = rate(&(x + h * third));
        x += h / 6.0 * (first + 2.0 * second + 2.0 * third + fourth);
    }
    x
}

fn first_state(chapter: &mut Chapter) {
    let formula: FirstState = |first, own, g, t| NavState {
        position: first.position
            + t * first.velocity
            + 0.5 * t * t * g
            + first.world_from_body * own.position,
        ..composed(first, own, g, t)
    };
    let mutants: [(_, FirstState); 4] = [
        ("rotations in the other order", |first, own, g, t| NavState {
            world_from_body: own.world_from_body * first.world_from_body,
            ..composed(first, own, g, t)
        }),
        ("first velocity forgotten", |first, own, g, t| NavState {
            position: composed(first, own, g, t).position - t * first.velocity,
            ..composed(first, own, g, t)
        }),
        ("gravity without its half", |first, own, g, t| NavState {
            position: composed(first, own, g, t).position + 0.5 * t * t * g,
            ..composed(first, own, g, t)
        }),
        ("own velocity not turned", |first, own, g, t| NavState {
            velocity: first.velocity + t * g + own.velocity,
            ..composed(first, own, g, t)
        }),
    ];
    chapter.equation("inertial-first-state", inertial_first_state, formula, &mutants);
}

/// The composition, with the position in fewer products.
pub fn composed(first: &NavState, own: &NavState, g: &Vector3<f64>, t: f64) -> NavState {
    let r = first.world_from_body;
    NavState {
        world_from_body: r * own.world_from_body,
        velocity: first.velocity + t * g + r * own.velocity,
        position: first.position + t * (first.velocity + 0.5 * t * g) + r * own.position,
    }
}

/// Takes the first state, the last one of a run from the origin without gravity, gravity and the
/// time between.
type FirstState = fn(&NavState, &NavState, &Vector3<f64>, f64) -> NavState;

fn inertial_first_state(formula: FirstState) -> Comparison {
    let against = "runs of 25 steps from the first state, with gravity, by either rule";
    let mut random = Random::new(23);
    Comparison::absolute(against, 1e-12, "m, m/s, no unit").each(0..STATES, |run| {
        let first = state(&mut random);
        let (mut there, mut own, mut time) = (first, NavState::origin(), 0.0);
        for _ in 0..25 {
            let (start, end) = (read(&mut random), read(&mut random));
            let dt = random.uniform(0.002..0.01);
            let step = |x: &NavState, g: &Vector3<f64>| match run % 2 {
                0 => x.propagate(&start, g, dt),
                _ => x.propagate_midpoint(&start, &end, g, dt),
            };
            (there, own) = (step(&there, &GRAVITY), step(&own, &Vector3::zeros()));
            time += dt;
        }
        let found = formula(&first, &own, &GRAVITY, time);
        (numbers(&found), numbers(&there))
    })
}
