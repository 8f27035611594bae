//! Sensors whose axes differ in noise.

use approx::assert_abs_diff_eq;
use nalgebra::Vector3;
use vislam::inertial::{AxisNoise, GRAVITY, ImuBias, ImuNoise, NoiseError};
use vislam::preintegration::{
    BiasWalk, CombinedPreintegrator, Matrix9, Preintegrated, PreintegrationError, Preintegrator,
    Rule,
};
use vislam::simulation::Trajectory;

use super::{Random, dense, difference, summed};

const DT: f64 = 0.01;

/// A poor sensor that is worse along some axes.
fn uneven() -> AxisNoise {
    AxisNoise {
        gyro: Vector3::new(3.5e-3, 1.0e-3, 9.0e-3),
        accelerometer: Vector3::new(6.0e-2, 2.0e-2, 0.5e-2),
        gyro_walk: Vector3::new(2e-4, 1e-4, 5e-4),
        accelerometer_walk: Vector3::new(1e-2, 2e-2, 3e-3),
    }
}

/// A covariance as it is seen when another one is whitened.
fn whitened(covariance: &Matrix9, by: &Preintegrated) -> Matrix9 {
    let whiten = by.sqrt_information().unwrap();
    whiten * covariance * whiten.transpose()
}

#[test]
fn axes_of_the_same_noise_have_the_isotropic_covariance() {
    let mut random = Random::new(41);
    let noise = ImuNoise::mems();
    let same = AxisNoise::from(&noise);
    // Different in the last digit, which takes the general way.
    let mut nearly = same;
    nearly.gyro.z *= 1.0 + f64::EPSILON;
    assert_ne!(nearly, same);
    for rule in [Rule::Euler, Rule::Midpoint] {
        for _ in 0..20 {
            let samples = random.motion().samples(&GRAVITY, DT, 101);
            let bias = random.bias(0.1, 0.5);
            let isotropic = summed(&samples, rule, DT, &bias, &noise);
            assert_eq!(summed(&samples, rule, DT, &bias, same), isotropic);
            let general = summed(&samples, rule, DT, &bias, nearly);
            let found = whitened(&general.covariance, &isotropic);
            assert_abs_diff_eq!(found, Matrix9::identity(), epsilon = 1e-9);
            assert_eq!(general.deltas, isotropic.deltas);
            assert_abs_diff_eq!(general.bias_jacobian, isotropic.bias_jacobian, epsilon = 1e-12);
        }
    }
    assert_eq!(same.discrete(DT), noise.discrete(DT));
    assert_eq!(same.bias_walk(DT), noise.bias_walk(DT));
}

#[test]
fn axes_of_other_noise_have_the_covariance_of_the_dense_recursion() {
    let mut random = Random::new(42);
    let noise = uneven();
    for rule in [Rule::Euler, Rule::Midpoint] {
        for _ in 0..20 {
            let samples = random.motion().samples(&GRAVITY, DT, 101);
            let bias = random.bias(0.1, 0.5);
            let sums = summed(&samples, rule, DT, &bias, noise);
            let (covariance, _) = dense(&samples, rule, DT, &bias, noise);
            let found = whitened(&covariance, &sums);
            assert_abs_diff_eq!(found, Matrix9::identity(), epsilon = 1e-9);
            // Axes that change places make another covariance.
            let turned = AxisNoise { gyro: noise.gyro.yzx(), ..noise };
            let (covariance, _) = dense(&samples, rule, DT, &bias, turned);
            assert!((whitened(&covariance, &sums) - Matrix9::identity()).amax() > 0.1);
        }
    }
}

#[test]
fn axes_of_other_noise_have_the_covariance_of_two_thousand_noisy_runs() {
    let (noise, bias) = (uneven(), ImuBias::default());
    let samples = Trajectory::figure_eight().samples(&GRAVITY, DT, 101);
    let sigmas = noise.discrete(DT).diagonal().map(f64::sqrt);
    let clean = summed(&samples, Rule::Euler, DT, &bias, noise);
    let (mut random, mut scatter) = (Random::new(43), Matrix9::zeros());
    for _ in 0..2000 {
        let mut noisy = samples.clone();
        for sample in &mut noisy {
            let error = sigmas.map(|sigma| sigma * random.normal());
            *sample = sample.biased(&ImuBias::from_vector(&error));
        }
        let run = summed(&noisy, Rule::Euler, DT, &bias, noise);
        let error = difference(&clean.deltas, &run.deltas);
        scatter += error * error.transpose() / 2000.0;
    }
    let eigenvalues = whitened(&scatter, &clean).symmetric_eigenvalues();
    let (low, high) = (eigenvalues.min(), eigenvalues.max());
    assert!(low > 0.83 && high < 1.18, "{low} to {high}");
}

#[test]
fn a_silent_axis_stays_silent_while_the_body_does_not_turn() {
    let still = [Trajectory::hover().at(0.0).sample(&GRAVITY); 51];
    let only_z = AxisNoise { gyro: Vector3::new(0.0, 0.0, 1e-3), ..uneven() };
    let sums = summed(&still, Rule::Euler, DT, &ImuBias::default(), only_z);
    let attitude = sums.covariance.fixed_view::<3, 3>(0, 0).diagonal();
    assert_abs_diff_eq!(attitude, Vector3::new(0.0, 0.0, 0.5e-6), epsilon = 1e-18);
}

#[test]
fn the_walk_of_each_axis_is_whitened_by_its_own_density() {
    let walk = BiasWalk::new(uneven(), 4.0).unwrap().sqrt_information.diagonal();
    let expected = [2e-4, 1e-4, 5e-4, 1e-2, 2e-2, 3e-3].map(|density| 0.5 / density);
    assert_abs_diff_eq!(walk, expected.into(), epsilon = 1e-9);
}

#[test]
fn a_density_that_is_none_is_named_with_its_axis() {
    assert_eq!(uneven().check(), Ok(()));
    let names = ["gyro", "accelerometer", "gyro_walk", "accelerometer_walk"];
    for (field, name) in names.into_iter().enumerate() {
        for (place, axis) in ['x', 'y', 'z'].into_iter().enumerate() {
            for value in [-1e-3, f64::INFINITY, f64::NAN] {
                let mut noise = uneven();
                let AxisNoise { gyro, accelerometer, gyro_walk, accelerometer_walk } = &mut noise;
                [gyro, accelerometer, gyro_walk, accelerometer_walk][field][place] = value;
                let error = noise.check().unwrap_err();
                assert_eq!((error.name, error.axis), (name, Some(axis)));
                assert!(error.to_string().contains(&format!("`{name}` along {axis}")), "{error}");
                let errors = [
                    Preintegrator::new(&ImuBias::default(), noise).err(),
                    CombinedPreintegrator::new(&ImuBias::default(), noise).err(),
                ];
                for error in errors {
                    let named = |e: &NoiseError| (e.name, e.axis) == (name, Some(axis));
                    assert!(matches!(error, Some(PreintegrationError::Noise(e)) if named(&e)));
                }
            }
        }
    }
    let all = ImuNoise { gyro: f64::NAN, ..ImuNoise::mems() }.check().unwrap_err();
    assert_eq!((all.name, all.axis), ("gyro", None));
}
