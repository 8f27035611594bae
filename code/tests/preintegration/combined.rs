//! Sums over readings whose bias walks meanwhile.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Matrix6, Rotation3, SMatrix, SVector, Vector3, Vector6};
use vislam::inertial::{AxisNoise, GRAVITY, ImuBias, ImuNoise, ImuSample, StampedSample};
use vislam::least_squares::WhiteningError;
use vislam::manifold::so3;
use vislam::preintegration::{
    CombinedPreintegrated, CombinedPreintegrator, LONGEST_STEP, Matrix9, Matrix9x6, Matrix15,
    PreintegrationError, Rule, error_dynamics, preintegrate_combined,
};
use vislam::simulation::Trajectory;

use super::{Random, difference, summed};

const DT: f64 = 0.01;

/// A sensor whose bias walks so much that it matters within a second.
fn restless() -> AxisNoise {
    AxisNoise {
        gyro_walk: Vector3::new(2e-2, 1e-2, 3e-2),
        accelerometer_walk: Vector3::new(0.1, 0.2, 0.05),
        ..AxisNoise::from(&ImuNoise::mems())
    }
}

fn combined(
    samples: &[ImuSample],
    rule: Rule,
    dt: f64,
    bias: &ImuBias,
    noise: impl Into<AxisNoise>,
) -> CombinedPreintegrated {
    let mut integrator = CombinedPreintegrator::new(bias, noise).unwrap();
    for pair in samples.windows(2) {
        match rule {
            Rule::Euler => integrator.integrate(&pair[0], dt).unwrap(),
            Rule::Midpoint => integrator.integrate_midpoint(&pair[0], &pair[1], dt).unwrap(),
        }
    }
    integrator.finish().unwrap()
}

/// The covariance by products of 15×15 matrices, with noise and walk driven at every step. A
/// reading that is too large makes the deltas lack less.
fn dense(
    samples: &[ImuSample],
    rule: Rule,
    dt: f64,
    bias: &ImuBias,
    noise: &AxisNoise,
) -> Matrix15 {
    let mut covariance = Matrix15::zeros();
    let mut rotation = Rotation3::identity();
    for pair in samples.windows(2) {
        // How much of the step's own walk its reading has.
        let (reading, seen) = match rule {
            Rule::Euler => (pair[0], 0.0),
            Rule::Midpoint => (ImuSample::mean(&pair[0], &pair[1]), 0.5),
        };
        let reading = reading.corrected(bias);
        let step = error_dynamics(rule, &rotation, &reading, dt);
        let mut transition = Matrix15::identity();
        transition.fixed_view_mut::<9, 9>(0, 0).copy_from(&step.from_errors);
        transition.fixed_view_mut::<9, 6>(0, 9).copy_from(&-step.from_reading);
        let mut by_noise = SMatrix::<f64, 15, 6>::zeros();
        by_noise.fixed_view_mut::<9, 6>(0, 0).copy_from(&-step.from_reading);
        let mut by_walk = seen * by_noise;
        by_walk.fixed_view_mut::<6, 6>(9, 0).fill_with_identity();
        covariance = transition * covariance * transition.transpose()
            + by_noise * noise.discrete(dt) * by_noise.transpose()
            + by_walk * noise.bias_walk(dt) * by_walk.transpose();
        rotation *= so3::exp(&(dt * reading.gyro));
    }
    covariance
}

/// The largest entry of a covariance, whitened by these sums, less the identity.
fn apart(covariance: &Matrix15, sums: &CombinedPreintegrated) -> f64 {
    let whiten = sums.sqrt_information().unwrap();
    (whiten * covariance * whiten.transpose() - Matrix15::identity()).amax()
}

#[test]
fn sums_with_a_walking_bias_are_those_of_the_dense_recursion() {
    let mut random = Random::new(51);
    for noise in [restless(), AxisNoise::from(&ImuNoise::mems())] {
        for rule in [Rule::Euler, Rule::Midpoint] {
            for _ in 0..20 {
                let samples = random.motion().samples(&GRAVITY, DT, 101);
                let bias = random.bias(0.1, 0.5);
                let sums = combined(&samples, rule, DT, &bias, noise);
                let expected = dense(&samples, rule, DT, &bias, &noise);
                assert!(apart(&expected, &sums) < 1e-9);
                // The rules differ in which walk a reading has seen.
                let swapped = match rule {
                    Rule::Euler => Rule::Midpoint,
                    Rule::Midpoint => Rule::Euler,
                };
                assert!(apart(&dense(&samples, swapped, DT, &bias, &noise), &sums) > 1e-3);
            }
        }
    }
}

#[test]
fn a_bias_that_stays_gives_the_usual_sums() {
    let mut random = Random::new(52);
    let walk = Vector3::zeros();
    let constant = AxisNoise { gyro_walk: walk, accelerometer_walk: walk, ..restless() };
    for rule in [Rule::Euler, Rule::Midpoint] {
        let samples = random.motion().samples(&GRAVITY, DT, 101);
        let bias = random.bias(0.1, 0.5);
        let found = combined(&samples, rule, DT, &bias, constant);
        let usual = summed(&samples, rule, DT, &bias, constant);
        let whiten = usual.sqrt_information().unwrap();
        let whitened = whiten * found.sums.covariance * whiten.transpose();
        assert_abs_diff_eq!(whitened, Matrix9::identity(), epsilon = 1e-9);
        assert_eq!(found.sums.deltas, usual.deltas);
        assert_abs_diff_eq!(found.sums.bias_jacobian, usual.bias_jacobian, epsilon = 1e-12);
        assert_eq!(found.with_bias, Matrix9x6::zeros());
        assert_eq!(found.walk, Matrix6::zeros());
        assert_eq!(found.sqrt_information(), Err(WhiteningError::NotPositiveDefinite));
        let walking = combined(&samples, rule, DT, &bias, restless());
        assert_eq!(walking.walk, restless().bias_walk(walking.sums.duration));
        assert!(walking.sums.sigmas().iter().zip(usual.sigmas()).all(|(more, less)| *more > less));
    }
}

#[test]
fn stamped_readings_are_summed_by_the_midpoint_rule_while_the_bias_walks() {
    let mut random = Random::new(54);
    let samples = random.motion().samples(&GRAVITY, DT, 21);
    let bias = random.bias(0.1, 0.5);
    let since = 1_403_715_273_262_142_976;
    let stamped = |(k, sample): (i64, ImuSample)| StampedSample {
        nanoseconds: since + 10_000_000 * k,
        sample,
    };
    let mut readings: Vec<_> = (0..).zip(samples.clone()).map(stamped).collect();
    let found = preintegrate_combined(&readings, &bias, restless()).unwrap();
    assert_eq!(found, combined(&samples, Rule::Midpoint, DT, &bias, restless()));
    readings[20].nanoseconds += 100_000_000;
    let gap = PreintegrationError::Gap { step: 19, dt: 0.11, longest: LONGEST_STEP };
    assert_eq!(preintegrate_combined(&readings, &bias, restless()), Err(gap));
    readings[20].nanoseconds = readings[19].nanoseconds;
    let repeated = PreintegrationError::Step { step: 19, dt: 0.0 };
    assert_eq!(preintegrate_combined(&readings, &bias, restless()), Err(repeated));
    let one = preintegrate_combined(&readings[..1], &bias, restless());
    assert_eq!(one, Err(PreintegrationError::Empty));
}

/// What deltas lack at the bias of the start, and how far the bias has gone, in runs whose
/// readings have noise and a bias that walks.
fn runs(
    samples: &[ImuSample],
    rule: Rule,
    noise: &AxisNoise,
    count: usize,
) -> Vec<SVector<f64, 15>> {
    let mut random = Random::new(53);
    let start = random.bias(0.1, 0.5);
    let white = noise.discrete(DT).diagonal().map(f64::sqrt);
    let step = noise.bias_walk(DT).diagonal().map(f64::sqrt);
    let truth = summed(samples, rule, DT, &ImuBias::default(), noise);
    let run = |_| {
        let (mut readings, mut walk) = (Vec::new(), Vector6::zeros());
        for sample in samples {
            let error = start.vector() + walk + white.map(|sigma| sigma * random.normal());
            readings.push((sample.biased(&ImuBias::from_vector(&error)), walk));
            walk += step.map(|sigma| sigma * random.normal());
        }
        let end = readings[samples.len() - 1].1;
        let readings: Vec<_> = readings.into_iter().map(|(reading, _)| reading).collect();
        let found = summed(&readings, rule, DT, &start, noise);
        let lacking = difference(&found.deltas, &truth.deltas);
        SVector::from_iterator(lacking.iter().chain(end.iter()).copied())
    };
    (0..count).map(run).collect()
}

#[test]
fn every_block_of_the_covariance_is_that_of_four_thousand_runs() {
    let (count, noise) = (4000, restless());
    let samples = Trajectory::figure_eight().samples(&GRAVITY, DT, 101);
    for rule in [Rule::Euler, Rule::Midpoint] {
        let sums = combined(&samples, rule, DT, &ImuBias::default(), noise);
        let runs = runs(&samples, rule, &noise, count);
        let scatter = runs.iter().map(|run| run * run.transpose()).sum::<Matrix15>() / count as f64;
        // Each block alone has a mean square of its dimension, with a known scatter.
        let covariance = sums.covariance();
        for at in (0..15).step_by(3) {
            let block = covariance.fixed_view::<3, 3>(at, at).into_owned();
            let inverse = block.try_inverse().unwrap();
            let mean = (inverse * scatter.fixed_view::<3, 3>(at, at)).trace();
            let sigma = (6.0 / count as f64).sqrt();
            assert!((mean - 3.0).abs() < 4.0 * sigma, "{rule:?}, block {at}: {mean} of 3");
        }
        // And each entry off the diagonal is as far off as an estimate of it may be.
        for (row, column) in (0..15).flat_map(|row| (0..row).map(move |column| (row, column))) {
            let (own, with) =
                (covariance[(row, row)] * covariance[(column, column)], covariance[(row, column)]);
            let sigma = ((own + with * with) / count as f64).sqrt();
            let error = (scatter[(row, column)] - with) / sigma;
            assert!(error.abs() < 4.5, "{rule:?}, ({row}, {column}): {error}");
        }
        // All at once, no direction is off.
        let whiten = sums.sqrt_information().unwrap();
        let spread = |m: &Matrix15| {
            let eigenvalues = (whiten * m * whiten.transpose()).symmetric_eigenvalues();
            (eigenvalues.min(), eigenvalues.max())
        };
        let (low, high) = spread(&scatter);
        assert!(low > 0.84 && high < 1.17, "{rule:?}: {low} to {high}");
        // As it would be, were the bias held constant or the covariance with it forgotten.
        let usual = summed(&samples, rule, DT, &ImuBias::default(), noise).covariance;
        for with_bias in [sums.with_bias, -sums.with_bias, Matrix9x6::zeros()] {
            let held = CombinedPreintegrated { with_bias, ..sums };
            let mut wrong = held.covariance();
            if with_bias == sums.with_bias {
                wrong.fixed_view_mut::<9, 9>(0, 0).copy_from(&usual);
            }
            let (low, high) = spread(&wrong);
            assert!(low < 0.5 || high > 2.0, "{rule:?}: {low} to {high}");
        }
    }
}

#[test]
fn the_walk_alone_grows_as_an_integral_of_a_walk_does() {
    let silent =
        ImuNoise { gyro: 0.0, accelerometer: 0.0, gyro_walk: 0.0, accelerometer_walk: 0.0 };
    let (steps, t) = (400, 2.0_f64);
    let still = vec![Trajectory::hover().at(0.0).sample(&GRAVITY); steps + 1];
    let of = |noise: &ImuNoise| {
        let dt = t / steps as f64;
        combined(&still, Rule::Midpoint, dt, &ImuBias::default(), noise)
    };
    let near =
        |found: f64, expected: f64| assert_relative_eq!(found, expected, max_relative = 1e-2);
    let (w, g) = (1e-3_f64, 9.81_f64);
    // Rotation is a walk summed once, velocity twice and position three times. Gravity leaks into
    // the two level directions.
    let sums = of(&ImuNoise { gyro_walk: w, ..silent });
    let variances = sums.sums.covariance.diagonal();
    for axis in 0..2 {
        near(variances[axis], w.powi(2) * t.powi(3) / 3.0);
        near(variances[3 + axis], (g * w).powi(2) * t.powi(5) / 20.0);
        near(variances[6 + axis], (g * w).powi(2) * t.powi(7) / 252.0);
        near(sums.with_bias[(axis, axis)], -w.powi(2) * t.powi(2) / 2.0);
    }
    near(sums.with_bias[(4, 0)], g * w.powi(2) * t.powi(3) / 6.0);
    near(sums.with_bias[(7, 0)], g * w.powi(2) * t.powi(4) / 24.0);
    assert_abs_diff_eq!(variances[5], 0.0, epsilon = 1e-20);
    let sums = of(&ImuNoise { accelerometer_walk: w, ..silent });
    let variances = sums.sums.covariance.diagonal();
    for axis in 0..3 {
        assert_eq!(variances[axis], 0.0);
        near(variances[3 + axis], w.powi(2) * t.powi(3) / 3.0);
        near(variances[6 + axis], w.powi(2) * t.powi(5) / 20.0);
        near(sums.with_bias[(3 + axis, 3 + axis)], -w.powi(2) * t.powi(2) / 2.0);
        near(sums.with_bias[(6 + axis, 3 + axis)], -w.powi(2) * t.powi(3) / 6.0);
    }
}

#[test]
fn readings_that_cannot_be_summed_are_errors_with_a_walking_bias_too() {
    let bad = ImuBias { gyro: Vector3::repeat(f64::NAN), ..ImuBias::default() };
    let error = CombinedPreintegrator::new(&bad, restless()).unwrap_err();
    assert!(matches!(error, PreintegrationError::Bias { .. }), "{error}");
    let mut sums = CombinedPreintegrator::new(&ImuBias::default(), restless()).unwrap();
    assert_eq!(sums.finish(), Err(PreintegrationError::Empty));
    let good = Trajectory::hover().at(0.0).sample(&GRAVITY);
    sums.integrate(&good, DT).unwrap();
    let one = sums.finish().unwrap();
    assert_eq!(one.sqrt_information(), Err(WhiteningError::NotPositiveDefinite));
    let gap = PreintegrationError::Gap { step: 1, dt: 0.05, longest: 0.02 };
    sums.set_longest_step(0.02);
    assert_eq!(sums.integrate(&good, 0.05), Err(gap));
    assert_eq!(sums.integrate_midpoint(&good, &good, 0.05), Err(gap));
    let nan = good.biased(&bad);
    assert!(sums.integrate(&nan, DT).is_err());
    assert!(sums.integrate_midpoint(&good, &nan, DT).is_err());
    assert_eq!(sums.finish().unwrap(), one);
    let huge = ImuSample { accelerometer: Vector3::repeat(1e300), ..good };
    sums.integrate(&huge, DT).unwrap();
    sums.integrate(&huge, DT).unwrap();
    assert!(matches!(sums.finish(), Err(PreintegrationError::Overflow { .. })));
}

#[test]
fn two_intervals_joined_are_the_interval_summed_at_once_while_the_bias_walks() {
    let mut random = Random::new(36);
    for rule in [Rule::Euler, Rule::Midpoint] {
        for split in [2, 13, 50, 98] {
            let samples = random.motion().samples(&GRAVITY, DT, 101);
            let bias = random.bias(0.1, 0.5);
            let sums = |samples: &[ImuSample]| combined(samples, rule, DT, &bias, restless());
            let whole = sums(&samples);
            let (first, later) = (sums(&samples[..=split]), sums(&samples[split..]));
            let joined = first.then(&later).unwrap();
            assert!(difference(&whole.sums.deltas, &joined.sums.deltas).amax() < 1e-9);
            let whiten = whole.sqrt_information().unwrap();
            let off = whiten * joined.covariance() * whiten.transpose() - Matrix15::identity();
            assert!(off.amax() < 1e-9, "{rule:?} split at {split}: {:e}", off.amax());
            assert_abs_diff_eq!(joined.walk, whole.walk, epsilon = 1e-12);
            // Without the walk of the first interval the later one would seem too sure.
            let careless = first.sums.then(&later.sums).unwrap().covariance;
            let left = (joined.sums.covariance - careless).symmetric_eigenvalues();
            assert!(left.max() > 1e-6, "{left}");
        }
    }
    let samples = random.motion().samples(&GRAVITY, DT, 11);
    let at = |bias: &ImuBias| combined(&samples, Rule::Euler, DT, bias, restless());
    let (one, other) = (at(&random.bias(0.1, 0.5)), at(&random.bias(0.1, 0.5)));
    assert!(matches!(one.then(&other), Err(PreintegrationError::BiasesDiffer { .. })));
}
