//! The conventions of factrs 0.3.0, each by what it does, and where they differ from the book's, by how much.

use factrs::core::{Huber, PriorResidual, SO3};
use factrs::dtype;
use factrs::fac;
use factrs::linalg::{Matrix3, VectorX};
use factrs::residuals::{Gravity, ImuCovariance, ImuPreintegrator};
use factrs::traits::{RobustCost, Variable};
use factrs::variables::ImuBias;
use factrs_graph::convert;
use factrs_graph::graph::{self, GyroNoise, X, covariance, preintegrator};
use factrs_graph::predicted::{overshoot, tangent_covariance};
use factrs_graph::said::Said;
use factrs_graph::two_keyframes::{HUBER, READINGS, STEP, Scene};
use nalgebra::{Isometry3, Vector3, Vector6};
use vislam::inertial::{ImuBias as OurBias, ImuSample};
use vislam::least_squares::{Kernel, sqrt_information};
use vislam::manifold::se3;
use vislam::preintegration::Matrix15;

const SECONDS: f64 = STEP * READINGS as f64;

fn times(variance: f64) -> Matrix3 {
    Matrix3::identity() * variance
}

/// What factrs says of the readings of a scene.
fn said(scene: &Scene, covariance: ImuCovariance) -> Said {
    Said::by(preintegrator(&scene.readings, &scene.known_bias, covariance))
}

fn usual(scene: &Scene) -> ImuCovariance {
    covariance(&scene.noise, GyroNoise::Moved)
}

fn variance(said: &Said, at: usize) -> f64 {
    said.covariance.fixed_view::<3, 3>(at, at).trace() / 3.0
}

#[test]
fn gravity_is_added_so_that_a_body_at_rest_which_reads_up_needs_down() {
    let scene = Scene::exact();
    let at_rest = ImuSample { gyro: Vector3::zeros(), accelerometer: Vector3::new(0.0, 0.0, 9.81) };
    let fallen = |gravity| {
        let mut sums = ImuPreintegrator::new(usual(&scene), ImuBias::zeros(), gravity);
        for _ in 0..READINGS {
            let (gyro, accel) = graph::reading(&at_rest);
            sums.integrate(&gyro, &accel, STEP);
        }
        Said::by(sums).state.velocity
    };
    assert!(fallen(Gravity::down()).norm() < 1e-9);
    let twice = Vector3::new(0.0, 0.0, 2.0 * 9.81 * SECONDS);
    assert!((fallen(Gravity::up()) - twice).norm() < 1e-9);
}

#[test]
fn the_covariance_of_the_gyroscope_is_not_read_and_that_of_its_bias_stands_in_its_place() {
    let scene = Scene::drawn(0);
    let silent = ImuCovariance { cov_winit: times(0.0), ..usual(&scene) };
    let louder = ImuCovariance { cov_gyro: times(1.0), ..silent.clone() };
    assert_eq!(said(&scene, silent.clone()).covariance, said(&scene, louder).covariance);

    // A variance of one reading, given as that of a step of the bias, makes the bias walk, and the turn with it.
    let per_reading = scene.noise.gyro.powi(2) / STEP;
    let instead = said(&scene, ImuCovariance { cov_gyro_bias: times(per_reading), ..silent });
    let of_walk = instead.covariance.fixed_view::<3, 3>(9, 9).trace() / 3.0;
    assert!((of_walk / (READINGS as f64 * per_reading) - 1.0).abs() < 1e-6);
    assert!(variance(&instead, 0) > scene.noise.gyro.powi(2) * SECONDS);
}

#[test]
fn without_the_noise_of_the_gyroscope_a_turn_is_taken_for_thirty_times_surer_than_it_is() {
    let scene = Scene::drawn(0);
    let named = said(&scene, covariance(&scene.noise, GyroNoise::Named));
    let ours = scene.preintegrated().unwrap().sums.sigmas()[0];
    let surer = ours / variance(&named, 0).sqrt();
    // What is left is the walk of the bias.
    let walked = scene.noise.gyro_walk * SECONDS / 3.0_f64.sqrt();
    assert!(surer > 30.0 && (surer * walked / scene.noise.gyro - 1.0).abs() < 0.02, "{surer}");
}

#[test]
fn covariances_are_those_of_one_reading_and_not_densities() {
    let scene = Scene::drawn(0);
    let ours = scene.preintegrated().unwrap().sums.sigmas()[1].powi(2);
    let density = scene.noise.accelerometer.powi(2);
    let of = |cov_accel| {
        variance(
            &said(&scene, ImuCovariance { cov_accel, cov_winit: times(0.0), ..usual(&scene) }),
            3,
        )
    };
    let silent = of(times(0.0));
    let (per_reading, as_density) =
        (of(times(density / STEP)) - silent, of(times(density)) - silent);
    assert!((per_reading / (density * SECONDS) - 1.0).abs() < 1e-6);
    assert!((as_density / (density * SECONDS) - STEP).abs() < 1e-6 * STEP);
    assert!(per_reading < ours);
}

#[test]
fn the_covariance_of_a_bias_is_that_of_its_step_from_reading_to_reading() {
    let scene = Scene::drawn(0);
    let walk = scene.noise.accelerometer_walk.powi(2) * SECONDS;
    assert!((variance(&said(&scene, usual(&scene)), 12) / walk - 1.0).abs() < 1e-6);
}

#[test]
fn the_noise_of_the_integration_is_added_once_a_reading_however_short_it_is() {
    let scene = Scene::drawn(0);
    let with = |variance| ImuCovariance { cov_integration: times(variance), ..usual(&scene) };
    let preset = ImuCovariance::default().cov_integration;
    let added =
        variance(&said(&scene, with(preset[(0, 0)])), 6) - variance(&said(&scene, with(0.0)), 6);
    assert!((added / (READINGS as f64 * preset[(0, 0)]) - 1.0).abs() < 1e-6);
    // Left as it comes, it is several millimetres in a second at 200 readings.
    assert!(added.sqrt() > 4e-3);
}

#[test]
fn the_turn_is_summed_up_in_the_tangent_space_and_too_long_by_what_is_predicted() {
    let scene = Scene::drawn(0);
    let ours = scene.preintegrated().unwrap().sums.deltas.rotation.scaled_axis();
    let too_long = said(&scene, usual(&scene)).turn() - ours;
    let rates: Vec<Vector3<f64>> = scene.readings.iter().map(|reading| reading.gyro).collect();
    let predicted = overshoot(&rates, STEP);
    assert!((too_long - predicted).norm() < 0.1 * predicted.norm(), "{too_long} for {predicted}");
}

#[test]
fn about_a_fixed_axis_both_sums_are_the_same() {
    let (scene, gyro) = (Scene::exact(), Vector3::new(0.3, -0.5, 0.4));
    let readings = vec![ImuSample { gyro, accelerometer: Vector3::zeros() }; READINGS];
    let theirs = Said::by(preintegrator(&readings, &scene.known_bias, usual(&scene)));
    assert!((theirs.turn() - SECONDS * gyro).norm() < 1e-9);
}

#[test]
fn steps_half_as_long_halve_the_difference() {
    let scene = Scene::drawn(0);
    let ours = scene.preintegrated().unwrap().sums.deltas.rotation;
    let off = |parts: usize| {
        let mut sums = ImuPreintegrator::new(usual(&scene), ImuBias::zeros(), Gravity::down());
        for reading in scene.readings.iter().flat_map(|reading| vec![reading; parts]) {
            let (gyro, accel) = graph::reading(reading);
            sums.integrate(&gyro, &accel, STEP / parts as f64);
        }
        Said::by(sums).angle_to(&ours)
    };
    assert!((off(1) / off(2) - 2.0).abs() < 1e-2);
}

#[test]
fn the_covariance_of_the_turn_is_that_of_the_tangent_space() {
    let scene = Scene::drawn(0);
    let sums = scene.preintegrated().unwrap();
    let (ours, theirs) = (sums.covariance(), said(&scene, usual(&scene)).covariance);
    let turn = sums.sums.deltas.rotation.scaled_axis();
    let [least, most] = variances_in(&theirs, &ours);
    assert!(least < 0.85 && most > 1.2, "from {least} to {most} times ours");
    let [least, most] = variances_in(&theirs, &in_tangent(&turn, &ours));
    assert!(least > 0.96 && most < 1.04, "from {least} to {most} times what is predicted");
}

#[test]
fn the_covariance_of_velocity_and_position_does_not_turn_with_the_first_body() {
    let scene = Scene::drawn(0);
    let first = scene.known_state.world_from_body;
    let pose = convert::pose(&Isometry3::from_parts(Vector3::zeros().into(), first.into()));
    let sums = preintegrator(&scene.readings, &scene.known_bias, usual(&scene));
    let theirs = Said::after(&pose, sums).covariance;
    let [least, most] = variances_in(&theirs, &said(&scene, usual(&scene)).covariance);
    assert!(least > 0.999 && most < 1.001, "from {least} to {most} times those of a level body");

    let sums = scene.preintegrated().unwrap();
    let ours = in_tangent(&sums.sums.deltas.rotation.scaled_axis(), &sums.covariance());
    let mut in_world = Matrix15::identity();
    for at in [3, 6] {
        in_world.fixed_view_mut::<3, 3>(at, at).copy_from(first.matrix());
    }
    let [least, most] = variances_in(&theirs, &(in_world * ours * in_world.transpose()));
    assert!(least < 0.6 && most > 1.7, "from {least} to {most} times ours in the world");
}

/// The least and the greatest variance that one covariance has where another has one.
fn variances_in(covariance: &Matrix15, other: &Matrix15) -> [f64; 2] {
    let whitening = sqrt_information(other).unwrap();
    let variances = (whitening * covariance * whitening.transpose()).symmetric_eigenvalues();
    [variances.min(), variances.max()]
}

/// A covariance whose small turn comes after a turn θ, as one of θ.
fn in_tangent(turn: &Vector3<f64>, covariance: &Matrix15) -> Matrix15 {
    let mut jacobian = Matrix15::identity();
    let by_phi = vislam::manifold::so3::right_jacobian_inverse(turn);
    jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_phi);
    let moved = jacobian * covariance * jacobian.transpose();
    let block = covariance.fixed_view::<3, 3>(0, 0).into_owned();
    let alone = tangent_covariance(turn, &block);
    assert!((moved.fixed_view::<3, 3>(0, 0) - alone).norm() < 1e-12 * alone.norm());
    moved
}

#[test]
fn in_a_step_of_a_pose_the_turn_comes_first_and_it_is_taken_on_the_right() {
    let pose = Isometry3::new(Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.3, 0.2, -0.4));
    let (rho, phi) = (Vector3::new(0.1, 0.2, -0.3), Vector3::new(-0.2, 0.1, 0.3));
    let step = VectorX::from_iterator(6, phi.iter().chain(&rho).copied());
    let theirs = convert::pose(&pose).oplus(step.as_view());
    let ours = se3::retract(&pose, &Vector6::from_iterator(rho.iter().chain(&phi).copied()));
    let apart = theirs.ominus(&convert::pose(&ours));
    assert!(apart.norm() < 1e-9, "{apart}");
}

#[test]
fn a_prior_says_how_the_known_pose_is_seen_from_the_estimate() {
    let known = Isometry3::new(Vector3::new(0.1, 0.0, 0.2), Vector3::new(0.3, 0.0, 0.1));
    let there = Isometry3::new(Vector3::new(0.0, 0.3, 0.2), Vector3::new(-0.1, 0.2, 0.1));
    let factor = fac![PriorResidual::new(convert::pose(&known)), X(0)];
    let mut values = factrs::core::Values::new();
    values.insert(X(0), convert::pose(&there));
    let residual = -factor.linearize(&values).b;
    let ours = se3::local(&there, &known);
    let expected = [ours[3], ours[4], ours[5], ours[0], ours[1], ours[2]];
    assert!(residual.iter().zip(expected).all(|(theirs, ours)| (theirs - ours).abs() < 1e-9));
}

#[test]
fn of_two_biases_that_of_the_gyroscope_comes_first() {
    let (gyro, accelerometer) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(4.0, 5.0, 6.0));
    let theirs = convert::bias(&OurBias { gyro, accelerometer }).log();
    assert_eq!(theirs.as_slice(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn hubers_kernel_is_that_of_the_norm_with_the_same_cost_and_weight() {
    let (theirs, ours) = (Huber::new(HUBER), Kernel::Huber(HUBER));
    for norm in [0.0, 0.5, HUBER, 1.4, 3.0, 50.0] {
        let squared: dtype = norm * norm;
        assert!((theirs.loss(squared) - ours.cost(norm)).abs() < 1e-12);
        assert!((theirs.weight(squared) - ours.weight(norm)).abs() < 1e-12);
    }
    assert_eq!(format!("{:?}", Huber::default()), format!("{theirs:?}"));
}

#[test]
fn a_small_turn_of_factrs_is_exact_to_ten_digits() {
    // Below a milliradian the exponential is a polynomial.
    let turn = Vector3::new(6e-4, -5e-4, 4e-4);
    let theirs = SO3::exp(VectorX::from_column_slice(turn.as_slice()).as_view());
    let off = convert::our_rotation(&theirs).angle_to(&vislam::manifold::so3::exp(&turn));
    assert!(off < 1e-10, "{off:e}");
}
