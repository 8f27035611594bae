//! How the sums follow the biases, and how well.

use nalgebra::{Matrix3, Matrix3x6, Rotation3, Vector3, Vector6};
use vislam::inertial::{ImuBias, ImuNoise, ImuSample};
use vislam::manifold::so3;
use vislam::preintegration::{
    self as theory, BiasWalk, Deltas, ErrorDynamics, LinearizationErrorBound, Matrix9, Matrix9x6,
    Preintegrated,
};

use super::oracle::{Readings, bias, bias_slopes, difference, gyro_bias, slopes};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::noise::dynamics::{
    euler, leak, leaking, not_turned, turned_forward, with_left_jacobian, without_jacobian,
};
use crate::preintegration::noise::oracle::Instant;
use crate::preintegration::oracle::{STATES, nothing, sizes};
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    recursion(chapter);
    blocks(chapter);
    update(chapter);
    linearization_error(chapter);
    walk(chapter);
}

/// Takes the Jacobian before a step and the matrices A and B of the step.
type Recursion = fn(&Matrix9x6, &Matrix9, &Matrix9x6) -> Matrix9x6;

fn recursion(chapter: &mut Chapter) {
    let mutants: [(_, Recursion); 5] = [
        ("sign of B", |j, a, b| a * j + b),
        ("A transposed", |j, a, b| a.transpose() * j - b),
        ("B before A", |j, a, b| a * (j - b)),
        ("A dropped", |j, _, b| j - b),
        ("A inverted", |j, a, b| a.try_inverse().unwrap_or_default() * j - b),
    ];
    chapter.equation("bias-recursion", bias_recursion, |j, a, b| a * j - b, &mutants);
}

fn bias_recursion(formula: Recursion) -> Comparison {
    Comparison::relative("central differences of walking again", 1e-6).over(STATES, 31, |random| {
        let readings = Readings::random(random);
        let step = |j: &Matrix9x6, of: ErrorDynamics| formula(j, &of.from_errors, &of.from_reading);
        (recursed(&readings, |at, jacobian| step(jacobian, euler(at))), bias_slopes(&readings))
    })
}

/// The Jacobian after all readings, by a step that takes the instant and the Jacobian before it.
fn recursed(readings: &Readings, step: impl Fn(&Instant, &Matrix9x6) -> Matrix9x6) -> Matrix9x6 {
    let (mut jacobian, mut deltas, dt) = (Matrix9x6::zeros(), nothing(), readings.dt);
    for sample in &readings.samples {
        let sample = sample.corrected(&readings.bias);
        jacobian = step(&Instant { deltas, sample, dt }, &jacobian);
        deltas.rotation *= Rotation3::new(dt * sample.gyro);
    }
    jacobian
}

/// Takes readings and gives the derivative of one of the deltas by both biases.
type Block = fn(&Readings) -> Matrix3x6<f64>;

/// Three rows of the Jacobian, by the recursion with these blocks of a step.
fn rows_by(
    readings: &Readings,
    row: usize,
    blocks: impl Fn(&Instant) -> ErrorDynamics,
) -> Matrix3x6<f64> {
    let step = |at: &Instant, jacobian: &Matrix9x6| {
        let ErrorDynamics { from_errors, from_reading } = blocks(at);
        from_errors * jacobian - from_reading
    };
    recursed(readings, step).fixed_rows::<3>(row).into()
}

/// The blocks of a step that moves the position by so many halves of what velocity gains.
fn with_halves(at: &Instant, halves: f64) -> ErrorDynamics {
    let mut of = euler(at);
    of.from_errors.fixed_view_mut::<3, 3>(6, 0).scale_mut(halves);
    of.from_reading.fixed_rows_mut::<3>(6).scale_mut(halves);
    of
}

fn rows(readings: &Readings, row: usize) -> Matrix3x6<f64> {
    readings.summed().bias_jacobian.fixed_rows::<3>(row).into()
}

fn force_hat(at: &Instant) -> Matrix3<f64> {
    so3::hat(&at.sample.accelerometer)
}

/// The mutants spoil a step of the recursion, of which the printed sums are what it comes to.
fn blocks(chapter: &mut Chapter) {
    let mutants: [(_, Block); 4] = [
        ("not turned to the last frame", |r| rows_by(r, 0, not_turned)),
        ("turned the other way", |r| rows_by(r, 0, turned_forward)),
        ("right Jacobian dropped", |r| rows_by(r, 0, without_jacobian)),
        ("left Jacobian", |r| rows_by(r, 0, with_left_jacobian)),
    ];
    chapter.equation("bias-rotation-block", bias_rotation_block, |r| rows(r, 0), &mutants);

    let mutants: [(_, Block); 4] = [
        ("sign of the tilt", |r| rows_by(r, 3, |at| leaking(at, -leak(at)))),
        ("force not turned", |r| rows_by(r, 3, |at| leaking(at, -force_hat(at)))),
        ("tilt dropped", |r| rows_by(r, 3, |at| leaking(at, Matrix3::zeros()))),
        ("order of the tilt", |r| {
            rows_by(r, 3, |at| leaking(at, -force_hat(at) * at.deltas.rotation.matrix()))
        }),
    ];
    chapter.equation("bias-velocity-blocks", bias_velocity_blocks, |r| rows(r, 3), &mutants);

    let mutants: [(_, Block); 4] = [
        ("half of the gain dropped", |r| rows_by(r, 6, |at| with_halves(at, 0.0))),
        ("whole gain", |r| rows_by(r, 6, |at| with_halves(at, 2.0))),
        ("sign of the tilt", |r| rows_by(r, 6, |at| leaking(at, -leak(at)))),
        ("tilt dropped", |r| rows_by(r, 6, |at| leaking(at, Matrix3::zeros()))),
    ];
    chapter.equation("bias-position-blocks", bias_position_blocks, |r| rows(r, 6), &mutants);
}

fn bias_rotation_block(formula: Block) -> Comparison {
    bias_rows(formula, 0, 32)
}

fn bias_velocity_blocks(formula: Block) -> Comparison {
    bias_rows(formula, 3, 33)
}

fn bias_position_blocks(formula: Block) -> Comparison {
    bias_rows(formula, 6, 34)
}

fn bias_rows(formula: Block, row: usize, seed: u64) -> Comparison {
    Comparison::relative("central differences of walking again", 1e-6).over(
        STATES,
        seed,
        |random| {
            let readings = Readings::random(random);
            (formula(&readings), bias_slopes(&readings).fixed_rows::<3>(row).into_owned())
        },
    )
}

/// Takes sums and a bias.
type Update = fn(&Preintegrated, &ImuBias) -> Deltas;
/// Takes a rate and a time.
type FixedAxis = fn(&Vector3<f64>, f64) -> Matrix3<f64>;

fn update(chapter: &mut Chapter) {
    let mutants: [(_, Update); 4] = [
        ("sign", |sums, bias| {
            let opposite = 2.0 * sums.bias.vector() - bias.vector();
            theory::correct_for_bias(sums, &ImuBias::from_vector(&opposite))
        }),
        ("rotation corrected on the left", |sums, bias| {
            let corrected = theory::correct_for_bias(sums, bias);
            let turn = sums.deltas.rotation.transpose() * corrected.rotation;
            Deltas { rotation: turn * sums.deltas.rotation, ..corrected }
        }),
        ("accelerometer's bias dropped", |sums, bias| {
            let ImuBias { accelerometer, .. } = sums.bias;
            theory::correct_for_bias(sums, &ImuBias { accelerometer, ..*bias })
        }),
        ("velocity and position left alone", |sums, bias| Deltas {
            rotation: theory::correct_for_bias(sums, bias).rotation,
            ..sums.deltas
        }),
    ];
    chapter.equation("bias-update", bias_update, theory::correct_for_bias, &mutants);

    let formula: FixedAxis = |rate, t| -t * so3::right_jacobian(&(t * rate));
    let mutants: [(_, FixedAxis); 4] = [
        ("minus the time and no more", |_, t| -t * Matrix3::identity()),
        ("left Jacobian", |rate, t| -t * so3::left_jacobian(&(t * rate))),
        ("sign", |rate, t| t * so3::right_jacobian(&(t * rate))),
        ("inverse", |rate, t| -t * so3::right_jacobian_inverse(&(t * rate))),
    ];
    chapter.equation("bias-fixed-axis", bias_fixed_axis, formula, &mutants);
    chapter.counterexample("bias-fixed-axis", "constant", turn_by_halves, [0.0, 0.5]);
}

/// Readings of a rate and a force that stay the same.
fn steady(gyro: Vector3<f64>, accelerometer: Vector3<f64>, steps: usize, dt: f64) -> Readings {
    let samples = vec![ImuSample { gyro, accelerometer }; steps];
    Readings { samples, dt, bias: ImuBias::default() }
}

/// The matrix of a steady turn for one whose first half is slower and whose second half is faster by this share.
fn turn_by_halves(share: f64) -> Comparison {
    const HALF: usize = 25;
    const DT: f64 = 0.02;
    Comparison::relative("central differences of walking again", 1e-6).over(STATES, 37, |random| {
        let mean = random.direction(1.5);
        let part = |share: f64| steady((1.0 + share) * mean, Vector3::zeros(), HALF, DT).samples;
        let samples = [part(-share), part(share)].concat();
        let t = DT * samples.len() as f64;
        let readings = Readings { samples, dt: DT, bias: ImuBias::default() };
        (-t * so3::right_jacobian(&(t * mean)), rotation_slopes(&readings))
    })
}

fn bias_update(formula: Update) -> Comparison {
    let against = "how deltas change with the bias when readings are walked again";
    Comparison::relative(against, 1e-6).over(STATES, 35, |random| {
        let readings = Readings::random(random);
        let sums = readings.summed();
        let direction = bias(random, 1.0, 1.0).vector();
        let moved = |h: f64| ImuBias::from_vector(&(sums.bias.vector() + h * direction));
        let slope = |deltas: &dyn Fn(&ImuBias) -> Deltas| {
            slopes::<1>(1e-3, |h| difference(&sums.deltas, &deltas(&moved(h.x))))
        };
        (slope(&|bias| formula(&sums, bias)), slope(&|bias| readings.deltas_with(bias)))
    })
}

/// The derivative of the rotation by the gyroscope's bias, by walking again.
fn rotation_slopes(readings: &Readings) -> Matrix3<f64> {
    bias_slopes(readings).fixed_view::<3, 3>(0, 0).into_owned()
}

fn bias_fixed_axis(formula: FixedAxis) -> Comparison {
    Comparison::relative("central differences of walking again", 1e-6).over(STATES, 36, |random| {
        let (steps, dt) = (random.uniform(20.0..60.0) as usize, 0.02);
        let gyro = random.direction(1.5);
        let readings = steady(gyro, Vector3::zeros(), steps, dt);
        (formula(&gyro, dt * steps as f64), rotation_slopes(&readings))
    })
}

/// Takes the specific force, the change of the gyroscope's bias and the time.
type CorrectionError = fn(&Vector3<f64>, &Vector3<f64>, f64) -> f64;
/// Takes sums and a bias.
type Bound = fn(&Preintegrated, &ImuBias) -> LinearizationErrorBound;

pub fn correction_error_term(force: &Vector3<f64>, step: &Vector3<f64>, t: f64) -> f64 {
    force.cross(step).norm() * step.norm() * t.powi(4) / 24.0
}

fn linearization_error(chapter: &mut Chapter) {
    let mutants: [(_, CorrectionError); 4] = [
        ("the whole force", |f, step, t| f.norm() * step.norm_squared() * t.powi(4) / 24.0),
        ("linear in the bias", |f, step, t| f.cross(step).norm() * t.powi(4) / 24.0),
        ("third power of the time", |f, s, t| correction_error_term(f, s, t) / t),
        ("as if constant", |f, step, t| f.cross(step).norm() * step.norm() * t.powi(4) / 4.0),
    ];
    chapter.equation("correction-error", correction_error, correction_error_term, &mutants);

    let mutants: [(_, Bound); 4] = [
        ("rotation by a square of the rate only", |sums, bias| {
            let rotation = 0.25 * squared_gyro(sums, bias);
            LinearizationErrorBound { rotation, ..sums.linearization_error_bound(bias) }
        }),
        ("force dropped", |sums, bias| {
            let velocity = 0.25 * squared_gyro(sums, bias) * sums.duration.powi(3);
            LinearizationErrorBound { velocity, ..sums.linearization_error_bound(bias) }
        }),
        ("both biases at once dropped", |sums, bias| {
            let gyro = ImuBias { accelerometer: sums.bias.accelerometer, ..*bias };
            sums.linearization_error_bound(&gyro)
        }),
        ("twelve for four in the position", |sums, bias| {
            let bound = sums.linearization_error_bound(bias);
            LinearizationErrorBound { position: bound.position / 3.0, ..bound }
        }),
    ];
    let formula: Bound = Preintegrated::linearization_error_bound;
    chapter.equation("correction-bound", correction_bound, formula, &mutants);
}

fn squared_gyro(sums: &Preintegrated, bias: &ImuBias) -> f64 {
    (bias.gyro - sums.bias.gyro).norm_squared()
}

fn correction_error(formula: CorrectionError) -> Comparison {
    let against = "walking again, with a force and a rate about the bias that stay the same";
    Comparison::relative(against, 0.02).over(STATES, 37, |random| {
        let t = random.uniform(0.5..1.5);
        let (steps, force) = (400, random.direction(10.0));
        let size = random.logarithmic(0.005..0.03);
        let step = random.direction(size);
        let readings = steady(2.0 * step, force, steps, t / steps as f64);
        let moved = gyro_bias(step);
        let corrected = theory::correct_for_bias(&readings.summed(), &moved);
        let error = corrected.position - readings.deltas_with(&moved).position;
        (formula(&force, &step, t), error.norm())
    })
}

fn correction_bound(formula: Bound) -> Comparison {
    let against = "how far the error of the correction exceeds it, as a part of it, here nothing";
    let mut random = Random::new(38);
    Comparison::absolute(against, 0.01, "relative").each(0..STATES, |state| {
        let readings =
            if state % 2 == 0 { hard(&mut random) } else { Readings::random(&mut random) };
        let sums = readings.summed();
        let step = match state % 4 {
            0 => random.direction(0.02).xy().push(0.0),
            _ => random.direction(0.02),
        };
        // In every third case both biases, across one another.
        let other = match state % 3 {
            0 => 5.0 * step.cross(&random.direction(1.0)),
            _ => Vector3::zeros(),
        };
        let moved =
            ImuBias { gyro: sums.bias.gyro + step, accelerometer: sums.bias.accelerometer + other };
        let corrected = theory::correct_for_bias(&sums, &moved);
        let errors = sizes(&difference(&readings.deltas_with(&moved), &corrected));
        let LinearizationErrorBound { rotation, velocity, position } = formula(&sums, &moved);
        let bounds = [rotation, velocity, position];
        ([0, 1, 2].map(|part| (errors[part] / bounds[part] - 1.0).max(0.0)), [0.0; 3])
    })
}

/// Readings that come near the bounds: half a turn about the vertical, or none, under a steady
/// force.
fn hard(random: &mut Random) -> Readings {
    let (steps, dt) = (100, 0.01 * random.uniform(0.5..1.5));
    let half_turn = if random.uniform(0.0..1.0) < 0.5 { 3.1 } else { 0.0 };
    let gyro = Vector3::z() * half_turn / (steps as f64 * dt);
    steady(gyro, 4.0 * Vector3::z(), steps, dt)
}

/// Takes densities, a time, the first bias and the second.
type Walk = fn(&ImuNoise, f64, &ImuBias, &ImuBias) -> Vector6<f64>;

fn walked_bias(noise: &ImuNoise, t: f64, first: &ImuBias, second: &ImuBias) -> Vector6<f64> {
    let walk = BiasWalk::new(noise, t);
    walk.map_or(Vector6::repeat(f64::NAN), |walk| walk.linearize(first, second).residual)
}

fn walk(chapter: &mut Chapter) {
    let mutants: [(_, Walk); 4] = [
        ("root of the time dropped", |noise, _, a, b| walked_bias(noise, 1.0, a, b)),
        ("time for its root", |noise, t, a, b| walked_bias(noise, t * t, a, b)),
        ("as white noise", |noise, t, a, b| walked_bias(noise, 1.0 / t, a, b)),
        ("first bias dropped", |noise, t, _, b| walked_bias(noise, t, &ImuBias::default(), b)),
    ];
    chapter.equation("bias-walk-factor", bias_walk_factor, walked_bias, &mutants);
}

fn bias_walk_factor(formula: Walk) -> Comparison {
    let against = "Monte Carlo, the variance of 4,000 walks of eight uneven steps for each state";
    Comparison::absolute(against, 0.12, "").over(24, 39, |random| {
        let noise = ImuNoise {
            gyro_walk: random.logarithmic(1e-5..1e-3),
            accelerometer_walk: random.logarithmic(1e-3..1e-1),
            ..ImuNoise::mems()
        };
        let steps: Vec<f64> = (0..8).map(|_| random.logarithmic(0.02..0.1)).collect();
        let t = steps.iter().sum();
        let first = bias(random, 0.1, 0.5);
        let mut squares = Vector6::zeros();
        for _ in 0..4000 {
            let second =
                steps.iter().fold(first, |bias, dt| noise.walk(&bias, *dt, || random.normal(1.0)));
            squares += formula(&noise, t, &first, &second).map(|r| r * r / 4000.0);
        }
        (squares, [1.0; 6])
    })
}
