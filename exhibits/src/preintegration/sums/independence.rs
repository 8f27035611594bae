//! No state is in the sums, and what they say about two states.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::preintegration::{self as theory, Deltas, Preintegrated, Rule, Vector9};

use super::oracle::{Readings, deltas_of_states, difference, rotation_vector, state, summed};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::oracle::{STATES, nothing, parts, stack, stepped};

pub fn exhibits(chapter: &mut Chapter) {
    sums(chapter);
    residual(chapter);
    chapter.counterexample("no-state", "before", no_state, [(true, 0.0), (false, 0.0)]);
    chapter.counterexample("no-state", "gravity", no_state, [(true, 0.0), (true, 0.1)]);
}

/// Takes readings, their step and the bias.
type Sums = fn(&[ImuSample], f64, &ImuBias) -> Deltas;

/// Sums with steps that go wrong: `spoilt` takes the deltas before a step and after it, and the reading.
fn by_step(
    samples: &[ImuSample],
    dt: f64,
    bias: &ImuBias,
    spoilt: impl Fn(&Deltas, Deltas, &ImuSample) -> Deltas,
) -> Deltas {
    samples.iter().fold(nothing(), |before, sample| {
        let reading = sample.corrected(bias);
        spoilt(&before, stepped(Rule::Euler, &before, &reading, dt), &reading)
    })
}

fn sums(chapter: &mut Chapter) {
    let formula: Sums = |samples, dt, bias| summed(samples, dt, bias).deltas;
    let mutants: [(_, Sums); 5] = [
        ("bias added", |samples, dt, bias| {
            summed(samples, dt, &ImuBias::from_vector(&-bias.vector())).deltas
        }),
        ("velocity before position", |samples, dt, bias| {
            by_step(samples, dt, bias, |before, after, _| Deltas {
                position: after.position + dt * (after.velocity - before.velocity),
                ..after
            })
        }),
        ("rotation before velocity", |samples, dt, bias| {
            by_step(samples, dt, bias, |before, Deltas { rotation, .. }, reading| {
                let turned = Deltas { rotation, ..*before };
                Deltas { rotation, ..stepped(Rule::Euler, &turned, reading, dt) }
            })
        }),
        ("turns multiplied on the left", |samples, dt, bias| {
            by_step(samples, dt, bias, |before, after, reading| {
                let rotation = Rotation3::new(dt * reading.gyro) * before.rotation;
                Deltas { rotation, ..after }
            })
        }),
        ("half of the gain dropped", |samples, dt, bias| {
            by_step(samples, dt, bias, |before, after, _| Deltas {
                position: before.position + dt * before.velocity,
                ..after
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
    Comparison::relative(against, 1e-12).over(STATES, 21, |random| {
        let readings = Readings::random(random);
        let (first, gravity) = (state(random), random.direction(12.0));
        let second = readings.walked(&first, &gravity);
        let t = readings.dt * readings.samples.len() as f64;
        let found = formula(&readings.samples, readings.dt, &readings.bias);
        (found, deltas_of_states(&first, &second, &gravity, t))
    })
}

/// Walks with the velocity from before a step or from after it, under gravity that grows by a share of itself in a
/// second.
fn no_state((before, growth): (bool, f64)) -> Comparison {
    let against = "what two states say about each other when one walked to the other";
    Comparison::relative(against, 1e-11).over(STATES, 25, |random| {
        let readings = Readings::random(random);
        let (first, gravity) = (state(random), random.direction(12.0));
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
        (readings.summed().deltas, deltas_of_states(&first, &at, &gravity, t))
    })
}

/// Takes the deltas of two intervals in a row and the duration of the second.
type Composition = fn(&Deltas, &Deltas, f64) -> Deltas;

fn delta_composition(formula: Composition) -> Comparison {
    let against = "a walk without gravity through all readings at once";
    Comparison::relative(against, 1e-12).over(STATES, 22, |random| {
        let readings = Readings::random(random);
        let Readings { samples, dt, bias } = &readings;
        let (before, after) = samples.split_at(random.uniform(1.0..49.0) as usize);
        let [first, second] = [before, after].map(|part| summed(part, *dt, bias));
        let found = formula(&first.deltas, &second.deltas, second.duration);
        (found, readings.deltas_with(bias))
    })
}

/// Takes sums, two states, gravity and the bias.
type Residual = fn(&Preintegrated, &NavState, &NavState, &Vector3<f64>, &ImuBias) -> Vector9;

fn residual(chapter: &mut Chapter) {
    let mutants: [(_, Residual); 6] = [
        ("gravity dropped", |s, i, j, _, bias| {
            theory::imu_residual(s, i, j, &(0.0 * GRAVITY), bias)
        }),
        ("gravity upwards", |s, i, j, g, bias| theory::imu_residual(s, i, j, &-g, bias)),
        ("measured less stated", |s, i, j, g, bias| -theory::imu_residual(s, i, j, g, bias)),
        ("differences left in the world", |sums, first, second, g, bias| {
            let [phi, v, p] = parts(&theory::imu_residual(sums, first, second, g, bias));
            stack(&phi, &(first.world_from_body * v), &(first.world_from_body * p))
        }),
        ("first velocity not carried on", |sums, first, second, g, bias| {
            let still = NavState { velocity: Vector3::zeros(), ..*first };
            let [phi, v, _] = parts(&theory::imu_residual(sums, first, second, g, bias));
            let [.., p] = parts(&theory::imu_residual(sums, &still, second, g, bias));
            stack(&phi, &v, &p)
        }),
        ("rotations exchanged", |sums, first, second, g, bias| {
            let [_, v, p] = parts(&theory::imu_residual(sums, first, second, g, bias));
            let stated = first.world_from_body.transpose() * second.world_from_body;
            stack(&rotation_vector(&(stated * sums.deltas.rotation.transpose())), &v, &p)
        }),
    ];
    chapter.equation("imu-residual", imu_residual, theory::imu_residual, &mutants);

    let mutants: [(_, AtTruth); 3] = [
        ("sign", |truth, measured| -at_truth(truth, measured)),
        ("error of the rotation in the first frame", |truth, measured| {
            let phi = rotation_vector(&(measured.rotation * truth.rotation.transpose()));
            let [_, v, p] = parts(&at_truth(truth, measured));
            stack(&-phi, &v, &p)
        }),
        ("rotation of the other sign", |truth, measured| {
            let [phi, v, p] = parts(&at_truth(truth, measured));
            stack(&-phi, &v, &p)
        }),
    ];
    chapter.equation("residual-at-truth", residual_at_truth, at_truth, &mutants);
}

fn imu_residual(formula: Residual) -> Comparison {
    let against = "the second state less the one that the readings reach, as the first sees it";
    Comparison::absolute(against, 1e-11, "rad, m/s, m").over(STATES, 23, |random| {
        let readings = Readings::random(random);
        let (first, gravity) = (state(random), random.direction(12.0));
        let reached = readings.walked(&first, &gravity);
        let second = NavState {
            world_from_body: reached.world_from_body * random.rotation(2.5),
            velocity: reached.velocity + random.direction(1.0),
            position: reached.position + random.direction(1.0),
        };
        let back = first.world_from_body.transpose();
        let expected = stack(
            &rotation_vector(&(reached.world_from_body.transpose() * second.world_from_body)),
            &(back * (second.velocity - reached.velocity)),
            &(back * (second.position - reached.position)),
        );
        (formula(&readings.summed(), &first, &second, &gravity, &readings.bias), expected)
    })
}

/// Takes the deltas of what happened and of what was measured.
type AtTruth = fn(&Deltas, &Deltas) -> Vector9;

fn at_truth(truth: &Deltas, measured: &Deltas) -> Vector9 {
    -difference(truth, measured)
}

fn residual_at_truth(formula: AtTruth) -> Comparison {
    let against = "the residual of noisy readings at states that perfect ones lead to";
    // Ten times the noise, so that first order would not do.
    let noise = ImuNoise { gyro: 3.5e-2, accelerometer: 0.2, ..ImuNoise::mems() };
    Comparison::absolute(against, 1e-11, "rad, m/s, m").over(STATES, 24, |random| {
        let perfect = Readings::random(random);
        let corrupt =
            |sample| noise.corrupt(sample, &ImuBias::default(), perfect.dt, || random.normal(1.0));
        let noisy: Vec<ImuSample> = perfect.samples.iter().map(corrupt).collect();
        let measured = summed(&noisy, perfect.dt, &perfect.bias);
        let first = state(random);
        let second = perfect.walked(&first, &GRAVITY);
        let expected = theory::imu_residual(&measured, &first, &second, &GRAVITY, &perfect.bias);
        (formula(&perfect.deltas_with(&perfect.bias), &measured.deltas), expected)
    })
}
