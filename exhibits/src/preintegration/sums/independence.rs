//! No state is in the sums, and what they say about two states.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::preintegration::{self as theory, Deltas, Preintegrated, Vector9};

use super::oracle::{
    Readings, deltas_of_states, difference, entries, rotation_vector, stack, state, summed,
};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Random states at which an equation is compared.
const STATES: usize = 500;

/// Registers the equations.
pub fn exhibits(chapter: &mut Chapter) {
    sums(chapter);
    residual(chapter);
    chapter.counterexample("no-state", "before", no_state, [(true, 0.0), (false, 0.0)]);
    chapter.counterexample("no-state", "gravity", no_state, [(true, 0.0), (true, 0.1)]);
}

const NO_DELTAS: fn() -> Deltas = || Deltas {
    rotation: Rotation3::identity(),
    velocity: Vector3::zeros(),
    position: Vector3::zeros(),
};

/// Takes readings, their step and the bias.
type Sums = fn(&[ImuSample], f64, &ImuBias) -> Deltas;

/// Sums by a step that takes deltas, the turn, the force and the time.
fn by_step(
    samples: &[ImuSample],
    dt: f64,
    bias: &ImuBias,
    step: impl Fn(&mut Deltas, &Rotation3<f64>, &Vector3<f64>),
) -> Deltas {
    let mut deltas = NO_DELTAS();
    for sample in samples {
        let reading = sample.corrected(bias);
        step(&mut deltas, &Rotation3::new(dt * reading.gyro), &reading.accelerometer);
    }
    deltas
}

fn sums(chapter: &mut Chapter) {
    let formula: Sums = |samples, dt, bias| summed(samples, dt, bias).deltas;
    let mutants: [(_, Sums); 5] = [
        ("bias added", |samples, dt, bias| {
            summed(samples, dt, &ImuBias::from_vector(&-bias.vector())).deltas
        }),
        ("velocity before position", |samples, dt, bias| {
            by_step(samples, dt, bias, |deltas, turn, force| {
                let gain = dt * (deltas.rotation * force);
                deltas.velocity += gain;
                deltas.position += dt * (deltas.velocity + 0.5 * gain);
                deltas.rotation *= turn;
            })
        }),
        ("rotation before velocity", |samples, dt, bias| {
            by_step(samples, dt, bias, |deltas, turn, force| {
                deltas.rotation *= turn;
                let gain = dt * (deltas.rotation * force);
                deltas.position += dt * (deltas.velocity + 0.5 * gain);
                deltas.velocity += gain;
            })
        }),
        ("turns multiplied on the left", |samples, dt, bias| {
            by_step(samples, dt, bias, |deltas, turn, force| {
                let gain = dt * (deltas.rotation * force);
                deltas.position += dt * (deltas.velocity + 0.5 * gain);
                deltas.velocity += gain;
                deltas.rotation = turn * deltas.rotation;
            })
        }),
        ("half of the gain dropped", |samples, dt, bias| {
            by_step(samples, dt, bias, |deltas, turn, force| {
                let gain = dt * (deltas.rotation * force);
                deltas.position += dt * deltas.velocity;
                deltas.velocity += gain;
                deltas.rotation *= turn;
            })
        }),
    ];
    chapter.equation("preintegrated-sums", preintegrated_sums, formula, &mutants);

    let mutants: [(_, Composition); 4] = [
        ("velocity not carried on", |first, second, _| first.then(second, 0.0)),
        ("second one not turned", |first, second, t| Deltas {
            velocity: first.velocity + second.velocity,
            position: first.position + t * first.velocity + second.position,
            ..first.then(second, t)
        }),
        ("rotations exchanged", |first, second, t| Deltas {
            rotation: second.rotation * first.rotation,
            ..first.then(second, t)
        }),
        ("turned by the second", |first, second, t| {
            let turned = Deltas { rotation: second.rotation, ..*first };
            Deltas { rotation: first.rotation * second.rotation, ..turned.then(second, t) }
        }),
    ];
    chapter.equation("delta-composition", delta_composition, Deltas::then, &mutants);
}

fn preintegrated_sums(formula: Sums) -> Comparison {
    let against = "two states, one reached from the other in the world under any gravity";
    let mut comparison = Comparison::relative(against, 1e-12);
    let mut random = Random::new(21);
    for _ in 0..STATES {
        let readings = Readings::random(&mut random);
        let (first, gravity) = (state(&mut random), random.direction(12.0));
        let second = readings.walked(&first, &gravity);
        let t = readings.dt * readings.samples.len() as f64;
        let found = formula(&readings.samples, readings.dt, &readings.bias);
        let expected = deltas_of_states(&first, &second, &gravity, t);
        comparison.add(&entries(&found), &entries(&expected));
    }
    comparison
}

/// Walks with the velocity from before a step or from after it, under gravity that grows by a share of itself in a
/// second.
fn no_state((before, growth): (bool, f64)) -> Comparison {
    let against = "what two states say about each other when one walked to the other";
    let mut comparison = Comparison::relative(against, 1e-11);
    let mut random = Random::new(25);
    for _ in 0..STATES {
        let readings = Readings::random(&mut random);
        let (first, gravity) = (state(&mut random), random.direction(12.0));
        let (mut at, mut t, dt) = (first, 0.0, readings.dt);
        for sample in &readings.samples {
            let reading = sample.corrected(&readings.bias);
            let force = at.world_from_body * reading.accelerometer;
            let gain = dt * (force + (1.0 + growth * t) * gravity);
            let coasting = if before { at.velocity } else { at.velocity + gain };
            at.position += dt * (coasting + 0.5 * gain);
            at.velocity += gain;
            at.world_from_body *= Rotation3::new(dt * reading.gyro);
            t += dt;
        }
        let stated = deltas_of_states(&first, &at, &gravity, t);
        comparison.add(&entries(&readings.summed().deltas), &entries(&stated));
    }
    comparison
}

/// Takes the deltas of two intervals in a row and the duration of the second.
type Composition = fn(&Deltas, &Deltas, f64) -> Deltas;

fn delta_composition(formula: Composition) -> Comparison {
    let against = "a walk without gravity through all readings at once";
    let mut comparison = Comparison::relative(against, 1e-12);
    let mut random = Random::new(22);
    for _ in 0..STATES {
        let readings = Readings::random(&mut random);
        let Readings { samples, dt, bias } = &readings;
        let (before, after) = samples.split_at(random.uniform(1.0..49.0) as usize);
        let [first, second] = [before, after].map(|part| summed(part, *dt, bias));
        let found = formula(&first.deltas, &second.deltas, second.duration);
        comparison.add(&entries(&found), &entries(&readings.deltas_with(bias)));
    }
    comparison
}

/// Takes sums, two states, gravity and the bias.
type Residual = fn(&Preintegrated, &NavState, &NavState, &Vector3<f64>, &ImuBias) -> Vector9;

fn residual(chapter: &mut Chapter) {
    let mutants: [(_, Residual); 6] = [
        ("gravity dropped", |sums, first, second, _, bias| {
            theory::imu_residual(sums, first, second, &Vector3::zeros(), bias)
        }),
        ("gravity upwards", |sums, first, second, g, bias| {
            theory::imu_residual(sums, first, second, &-g, bias)
        }),
        ("measured less stated", |sums, first, second, g, bias| {
            -theory::imu_residual(sums, first, second, g, bias)
        }),
        ("differences left in the world", |sums, first, second, g, bias| {
            let mut residual = theory::imu_residual(sums, first, second, g, bias);
            for at in [3, 6] {
                let turned = first.world_from_body * residual.fixed_rows::<3>(at);
                residual.fixed_rows_mut::<3>(at).copy_from(&turned);
            }
            residual
        }),
        ("first velocity not carried on", |sums, first, second, g, bias| {
            let still = NavState { velocity: Vector3::zeros(), ..*first };
            let mut residual = theory::imu_residual(sums, first, second, g, bias);
            let position = theory::imu_residual(sums, &still, second, g, bias);
            residual.fixed_rows_mut::<3>(6).copy_from(&position.fixed_rows::<3>(6));
            residual
        }),
        ("rotations exchanged", |sums, first, second, g, bias| {
            let mut residual = theory::imu_residual(sums, first, second, g, bias);
            let stated = first.world_from_body.transpose() * second.world_from_body;
            let phi = rotation_vector(&(stated * sums.deltas.rotation.transpose()));
            residual.fixed_rows_mut::<3>(0).copy_from(&phi);
            residual
        }),
    ];
    chapter.equation("imu-residual", imu_residual, theory::imu_residual, &mutants);

    let mutants: [(_, AtTruth); 3] = [
        ("sign", |truth, measured| -at_truth(truth, measured)),
        ("error of the rotation in the first frame", |truth, measured| {
            let phi = rotation_vector(&(measured.rotation * truth.rotation.transpose()));
            let mut residual = at_truth(truth, measured);
            residual.fixed_rows_mut::<3>(0).copy_from(&-phi);
            residual
        }),
        ("rotation of the other sign", |truth, measured| {
            let mut residual = at_truth(truth, measured);
            residual.fixed_rows_mut::<3>(0).neg_mut();
            residual
        }),
    ];
    chapter.equation("residual-at-truth", residual_at_truth, at_truth, &mutants);
}

fn imu_residual(formula: Residual) -> Comparison {
    let against = "the second state less the one that the readings reach, as the first sees it";
    let mut comparison = Comparison::absolute(against, 1e-11, "rad, m/s, m");
    let mut random = Random::new(23);
    for _ in 0..STATES {
        let readings = Readings::random(&mut random);
        let (first, gravity) = (state(&mut random), random.direction(12.0));
        let reached = readings.walked(&first, &gravity);
        let second = NavState {
            world_from_body: reached.world_from_body * random.rotation(2.5),
            velocity: reached.velocity + random.direction(1.0),
            position: reached.position + random.direction(1.0),
        };
        let found = formula(&readings.summed(), &first, &second, &gravity, &readings.bias);
        let back = first.world_from_body.transpose();
        let expected = stack(
            &rotation_vector(&(reached.world_from_body.transpose() * second.world_from_body)),
            &(back * (second.velocity - reached.velocity)),
            &(back * (second.position - reached.position)),
        );
        comparison.add(found.as_slice(), expected.as_slice());
    }
    comparison
}

/// Takes the deltas of what happened and of what was measured.
type AtTruth = fn(&Deltas, &Deltas) -> Vector9;

fn at_truth(truth: &Deltas, measured: &Deltas) -> Vector9 {
    -difference(truth, measured)
}

fn residual_at_truth(formula: AtTruth) -> Comparison {
    let against = "the residual of noisy readings at states that perfect ones lead to";
    let mut comparison = Comparison::absolute(against, 1e-11, "rad, m/s, m");
    let mut random = Random::new(24);
    // Ten times the noise, so that first order would not do.
    let noise = ImuNoise { gyro: 3.5e-2, accelerometer: 0.2, ..ImuNoise::mems() };
    for _ in 0..STATES {
        let perfect = Readings::random(&mut random);
        let noisy: Vec<ImuSample> = perfect
            .samples
            .iter()
            .map(|s| noise.corrupt(s, &ImuBias::default(), perfect.dt, || random.normal(1.0)))
            .collect();
        let measured = summed(&noisy, perfect.dt, &perfect.bias);
        let first = state(&mut random);
        let second = perfect.walked(&first, &GRAVITY);
        let found = formula(&perfect.deltas_with(&perfect.bias), &measured.deltas);
        let expected = theory::imu_residual(&measured, &first, &second, &GRAVITY, &perfect.bias);
        comparison.add(found.as_slice(), expected.as_slice());
    }
    comparison
}
