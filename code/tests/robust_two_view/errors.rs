//! Squared errors, their factors, and covariances.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use vislam::factors::{Epipolar, Transferred, transfer_covariance};
use vislam::least_squares::{Factor, Manifold, Problem};
use vislam::robust_two_view::{
    ConsensusOptions, Correspondences, GeneralMotion, Matches, OnePlane, OnlyTurned,
    RelativeMotion, consensus,
};
use vislam::two_views::{fundamental_matrix, sampson_distance};

use super::scenes::{CAMERA, World, normal, pixels, random, small_motion};

const WIDE: f64 = 1e12;

#[test]
fn the_squared_error_of_a_motion_is_that_of_the_sampson_distance() {
    let mut random = random(21);
    let pose = small_motion(&mut random);
    let pixels = pixels(&mut random, &pose, World::Deep, 50, 0);
    let matches = Matches::new([&CAMERA, &CAMERA], &pixels, 0.5).unwrap();
    let motion = RelativeMotion::of(&pose).unwrap();
    let fundamental = fundamental_matrix(&CAMERA, &CAMERA, &motion.essential());
    let data = GeneralMotion(&matches);
    let error = data.squared_errors(&motion, 1e3);
    for (k, [first, second]) in pixels.iter().enumerate() {
        let distance = sampson_distance(&fundamental, first, second).unwrap() / 0.5;
        assert!((error(k, k) - distance * distance).abs() < 1e-9 * (1.0 + distance * distance));
    }
}

/// Compares the derivatives of a factor of one variable with differences.
fn compare<F, V, const R: usize, const D: usize>(
    factor: &F,
    value: &V,
    residual: impl Fn(&F, &V) -> Option<SVector<f64, R>>,
    jacobian: &SMatrix<f64, R, D>,
) where
    V: Manifold,
{
    for axis in 0..D {
        let moved = |by: f64| {
            let mut step = [0.0; D];
            step[axis] = by;
            residual(factor, &value.retract(&step)).unwrap()
        };
        let slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
        let error = (slope - jacobian.column(axis)).amax();
        assert!(error < 1e-5 * (1.0 + jacobian.amax()), "axis {axis}: {error:e}");
    }
}

#[test]
fn the_derivatives_of_the_factors_are_those_of_their_residuals() {
    let (mut random, mut largest) = (random(22), 0.0);
    for _ in 0..50 {
        let pose = small_motion(&mut random);
        let pixels = pixels(&mut random, &pose, World::Deep, 1, 0);
        let matches = Matches::new([&CAMERA, &CAMERA], &pixels, 1.0).unwrap();
        let (first, second) = matches.rays()[0];
        let sigmas =
            [CAMERA; 2].map(|camera| nalgebra::Vector2::new(1.0 / camera.fx, 1.0 / camera.fy));
        let mut problem = Problem::new();

        // Far from where the residual vanishes, so that no term hides.
        let motion = RelativeMotion::of(&pose).unwrap().retract(&[0.02, -0.03, 0.01, 0.05, -0.04]);
        let factor = Epipolar { motion: problem.add_variable(motion), first, second, sigmas };
        let (residual, (jacobian,)) = factor.linearize((&motion,)).unwrap();
        largest = residual.norm().max(largest);
        compare(&factor, &motion, |factor, motion| factor.residual((motion,)), &jacobian);

        let rotation = motion.rotation;
        let covariance = transfer_covariance(rotation.matrix(), &first, &sigmas).unwrap();
        let sqrt_information = covariance.cholesky().unwrap().l().try_inverse().unwrap();
        let transfer = problem.add_variable(rotation);
        let factor = Transferred { transfer, first, second: second.xy(), sqrt_information };
        let (_, (jacobian,)) = factor.linearize((&rotation,)).unwrap();
        compare(&factor, &rotation, |factor, rotation| factor.residual((rotation,)), &jacobian);

        let plane = rotation.matrix() + Matrix3::from_fn(|_, _| 0.02 * normal(&mut random));
        let entries = SVector::<f64, 9>::from_column_slice(plane.as_slice());
        let transfer = problem.add_variable(entries);
        let factor = Transferred { transfer, first, second: second.xy(), sqrt_information };
        let (_, (jacobian,)) = factor.linearize((&entries,)).unwrap();
        compare(&factor, &entries, |factor, entries| factor.residual((entries,)), &jacobian);
    }
    assert!(largest > 10.0);
}

#[test]
fn a_transferred_pixel_misses_by_its_own_noise_and_that_of_the_first() {
    let mut random = random(23);
    let pose = small_motion(&mut random);
    let plane = Vector3::new(0.3, -0.2, 1.0) / 4.0;
    let homography = pose.rotation.to_rotation_matrix().into_inner()
        + pose.translation.vector * plane.transpose();
    let count = 4000;
    let pixels = pixels(&mut random, &pose, World::Flat, count, 0);
    let matches = Matches::new([&CAMERA, &CAMERA], &pixels, 1.0).unwrap();
    let data = OnePlane(&matches);
    let error = data.squared_errors(&homography, WIDE);
    let mean = (0..count).map(|k| error(k, k)).sum::<f64>() / count as f64;
    // Two degrees of freedom; the mean of 4000 scatters by 2/√4000.
    assert!((mean - 2.0).abs() < 0.13, "{mean}");
}

#[test]
fn the_covariance_is_that_of_the_errors() {
    let mut random = random(24);
    let (mut general, mut turned) = (Vec::new(), 0.0);
    let scenes = 150;
    for seed in 0..scenes {
        let options = ConsensusOptions { seed, ..ConsensusOptions::default() };
        let mut pose = small_motion(&mut random);
        let pixels = pixels(&mut random, &pose, World::Deep, 100, 0);
        let matches = Matches::new([&CAMERA, &CAMERA], &pixels, 1.0).unwrap();
        let found = consensus(&GeneralMotion(&matches), &options).unwrap();
        let mut error = SVector::<f64, 5>::zeros();
        found.estimate.local(&RelativeMotion::of(&pose).unwrap(), error.as_mut_slice());
        let information = found.covariance.unwrap().try_inverse().unwrap();
        general.push((error.transpose() * information * error)[0]);

        pose.translation.vector = Vector3::zeros();
        let pixels = super::scenes::pixels(&mut random, &pose, World::Deep, 100, 30);
        let matches = Matches::new([&CAMERA, &CAMERA], &pixels, 1.0).unwrap();
        let found = consensus(&OnlyTurned(&matches), &options).unwrap();
        let mut error = SVector::<f64, 3>::zeros();
        found.estimate.local(&pose.rotation.to_rotation_matrix(), error.as_mut_slice());
        let information = found.covariance.unwrap().try_inverse().unwrap();
        turned += (error.transpose() * information * error)[0] / scenes as f64;
    }
    // Half of what has five degrees of freedom stays below 4.35, and 95 % below 11.1.
    general.sort_by(f64::total_cmp);
    let half = general[scenes as usize / 2];
    let beyond = general.iter().filter(|square| **square > 11.1).count() as f64 / scenes as f64;
    assert!((3.5..5.3).contains(&half) && beyond < 0.12, "{half}, {beyond}");
    // Three degrees of freedom; the gate cuts off one right match in a hundred.
    assert!((2.3..4.0).contains(&turned), "{turned}");
}

#[test]
fn leverages_lie_between_zero_and_one_and_add_up_to_the_number_of_parameters() {
    let mut random = random(31);
    for count in [6, 20, 200] {
        let pose = small_motion(&mut random);
        let pixels = pixels(&mut random, &pose, World::Deep, count, 0);
        let matches = Matches::new([&CAMERA, &CAMERA], &pixels, 1.0).unwrap();
        let all: Vec<usize> = (0..count).collect();
        let motion = RelativeMotion::of(&pose).unwrap();
        let leverages = GeneralMotion(&matches).leverages(&motion, &all).unwrap();
        assert!(leverages.iter().all(|leverage| (0.0..1.0).contains(leverage)));
        assert!((leverages.iter().sum::<f64>() - 5.0).abs() < 1e-6);
    }
}
