//! Worked examples of preintegration, its order, its covariance and its derivatives.

#[path = "preintegration/axes.rs"]
mod axes;
#[path = "preintegration/combined.rs"]
mod combined;
#[path = "preintegration/joining.rs"]
mod joining;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Rotation3, SMatrix, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::inertial::{
    AxisNoise, GRAVITY, ImuBias, ImuNoise, ImuSample, NavState, NoiseError, StampedSample,
};
use vislam::least_squares::{Manifold, WhiteningError};
use vislam::manifold::so3;
use vislam::preintegration::{
    BiasWalk, Deltas, LONGEST_STEP, Matrix9, Matrix9x6, Preintegrated, PreintegrationError,
    Preintegrator, Rule, Vector9, correct_for_bias, error_dynamics, imu_residual, linearize,
    preintegrate, preintegrate_stamped,
};
use vislam::simulation::{EulerAngles, ScalarTrajectory, Trajectory};

// ANCHOR: worked_example
fn constant_yaw_rate() -> Vec<ImuSample> {
    let gyro = Vector3::new(0.0, 0.0, 0.51);
    let accelerometer = Vector3::new(0.0, 0.0, 9.81);
    vec![ImuSample { gyro, accelerometer }; 400]
}

#[test]
fn about_a_fixed_axis_the_bias_correction_is_that_of_integrating_again() {
    let (samples, noise) = (constant_yaw_rate(), ImuNoise::mems());
    let zero = preintegrate(&samples, 0.005, &ImuBias::default(), &noise).unwrap();
    assert_abs_diff_eq!(so3::log(&zero.deltas.rotation).z, 1.02, epsilon = 1e-9);

    let bias = ImuBias { gyro: Vector3::new(0.0, 0.0, 0.01), ..ImuBias::default() };
    let corrected = correct_for_bias(&zero, &bias);
    assert_abs_diff_eq!(so3::log(&corrected.rotation).z, 1.00, epsilon = 1e-9);

    let again = preintegrate(&samples, 0.005, &bias, &noise).unwrap();
    assert_abs_diff_eq!(corrected.rotation, again.deltas.rotation, epsilon = 1e-9);
}
// ANCHOR_END: worked_example

// ANCHOR: worked_jacobian
#[test]
fn about_a_fixed_axis_only_the_column_of_the_axis_is_minus_the_time() {
    let bias = ImuBias::default();
    let sums = preintegrate(&constant_yaw_rate(), 0.005, &bias, &ImuNoise::mems()).unwrap();
    let jacobian = sums.bias_jacobian.fixed_view::<3, 3>(0, 0).into_owned();
    let expected = -2.0 * so3::right_jacobian(&Vector3::new(0.0, 0.0, 1.02));
    assert_abs_diff_eq!(jacobian, expected, epsilon = 1e-9);
    assert_abs_diff_eq!(jacobian.column(2).into_owned(), -2.0 * Vector3::z(), epsilon = 1e-9);
    assert_abs_diff_eq!(jacobian[(0, 0)], -1.67, epsilon = 5e-3);
    assert_abs_diff_eq!(jacobian[(1, 0)].abs(), 0.93, epsilon = 1e-2);
}
// ANCHOR_END: worked_jacobian

// ANCHOR: at_rest
// ANCHOR: sigmas_at_rest
#[test]
fn after_a_second_at_rest_a_poor_sensor_knows_so_much() {
    let sums = at_rest(200);
    let [rotation, velocity, position] = sums.sigmas();
    assert_abs_diff_eq!(rotation, 3.50e-3, epsilon = 0.005e-3);
    assert_abs_diff_eq!(velocity, 2.57e-2, epsilon = 0.005e-2);
    assert_abs_diff_eq!(position, 1.31e-2, epsilon = 0.005e-2);
}
// ANCHOR_END: sigmas_at_rest

#[test]
fn a_bias_of_a_twentieth_of_a_radian_per_second_is_fourteen_sigmas_of_rotation() {
    let bias = ImuBias { gyro: Vector3::new(0.0, 0.0, 0.05), ..ImuBias::default() };
    let samples = vec![Trajectory::hover().at(0.0).sample(&GRAVITY).biased(&bias); 200];
    let sums = preintegrate(&samples, 0.005, &ImuBias::default(), &ImuNoise::mems()).unwrap();
    let origin = NavState::origin();
    let unaware = imu_residual(&sums, &origin, &origin, &GRAVITY, &ImuBias::default());
    assert_abs_diff_eq!(unaware.fixed_rows::<3>(0).norm() / sums.sigmas()[0], 14.3, epsilon = 0.05);
    let aware = imu_residual(&sums, &origin, &origin, &GRAVITY, &bias);
    assert!(aware.norm() < 1e-12, "{aware}");
}
// ANCHOR_END: at_rest

fn at_rest(steps: usize) -> Preintegrated {
    let samples = vec![Trajectory::hover().at(0.0).sample(&GRAVITY); steps];
    preintegrate(&samples, 0.005, &ImuBias::default(), &ImuNoise::mems()).unwrap()
}

#[test]
fn at_rest_the_sensor_reads_gravity_upward_and_the_deltas_fall_without_it() {
    let sums = at_rest(200);
    assert_relative_eq!(sums.duration, 1.0, epsilon = 1e-12);
    assert_eq!(sums.steps, 200);
    assert_abs_diff_eq!(sums.deltas.velocity, -GRAVITY, epsilon = 1e-12);
    assert_abs_diff_eq!(sums.deltas.position, -0.5 * GRAVITY, epsilon = 1e-12);
    assert_abs_diff_eq!(sums.greatest_force, 9.81, epsilon = 1e-12);
}

#[test]
fn a_single_step_has_no_whitener_and_two_have_one() {
    let mut random = Random::new(12);
    for _ in 0..50 {
        let samples = random.motion().samples(&GRAVITY, 0.005, 2);
        let sums = |steps: usize| {
            let readings = &samples[..steps];
            preintegrate(readings, 0.005, &ImuBias::default(), &ImuNoise::mems()).unwrap()
        };
        let (one, two) = (sums(1), sums(2));
        assert_eq!(one.sqrt_information(), Err(WhiteningError::NotPositiveDefinite));
        let whiten = two.sqrt_information().unwrap();
        let whitened = whiten * two.covariance * whiten.transpose();
        assert_abs_diff_eq!(whitened, Matrix9::identity(), epsilon = 1e-9);
        // The position of the only step is its velocity for half of the time.
        let tied = one.covariance.fixed_view::<3, 9>(6, 0)
            - 0.0025 * one.covariance.fixed_view::<3, 9>(3, 0);
        assert!(tied.amax() < 1e-20, "{tied}");
    }
}

/// The deltas of a motion between two times, from its formulas.
fn true_deltas(motion: &Trajectory, from: f64, duration: f64) -> Deltas {
    let (first, last) = (motion.at(from).state, motion.at(from + duration).state);
    let body_from_world = first.world_from_body.inverse();
    let fallen = first.velocity * duration + 0.5 * duration * duration * GRAVITY;
    Deltas {
        rotation: body_from_world * last.world_from_body,
        velocity: body_from_world * (last.velocity - first.velocity - duration * GRAVITY),
        position: body_from_world * (last.position - first.position - fallen),
    }
}

/// Errors of the deltas after one second in this many steps.
fn errors(motion: &Trajectory, rule: Rule, steps: usize) -> [f64; 3] {
    let dt = 1.0 / steps as f64;
    let samples = motion.samples(&GRAVITY, dt, steps + 1);
    let sums = summed(&samples, rule, dt, &ImuBias::default(), &ImuNoise::mems());
    let (found, truth) = (sums.deltas, true_deltas(motion, 0.0, 1.0));
    [
        so3::local(&truth.rotation, &found.rotation).norm(),
        (found.velocity - truth.velocity).norm(),
        (found.position - truth.position).norm(),
    ]
}

/// Readings at both ends of every step, summed by a rule.
fn summed(
    samples: &[ImuSample],
    rule: Rule,
    dt: f64,
    bias: &ImuBias,
    noise: impl Into<AxisNoise>,
) -> Preintegrated {
    let mut integrator = Preintegrator::new(bias, noise).unwrap();
    for pair in samples.windows(2) {
        match rule {
            Rule::Euler => integrator.integrate(&pair[0], dt).unwrap(),
            Rule::Midpoint => integrator.integrate_midpoint(&pair[0], &pair[1], dt).unwrap(),
        }
    }
    integrator.finish().unwrap()
}

#[test]
fn halving_the_step_halves_the_error_of_the_euler_rule_and_quarters_that_of_the_midpoint_rule() {
    let motion = Trajectory::figure_eight();
    for (rule, order) in [(Rule::Euler, 1.0), (Rule::Midpoint, 2.0)] {
        let steps = [50, 100, 200, 400, 800];
        let by_steps = steps.map(|steps| errors(&motion, rule, steps));
        for pair in by_steps.windows(2) {
            for (coarse, fine) in pair[0].iter().zip(pair[1]) {
                let measured = (coarse / fine).log2();
                assert!((measured - order).abs() < 0.1, "{rule:?}: order {measured}");
            }
        }
    }
}

/// A source of random motions, biases and noise.
struct Random(ChaCha8Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn uniform(&mut self, size: f64) -> f64 {
        self.0.random_range(-size..size)
    }

    fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.uniform(size))
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.0.random::<f64>()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.0.random::<f64>()).cos()
    }

    fn coordinate(&mut self, size: f64) -> ScalarTrajectory {
        ScalarTrajectory {
            value: self.uniform(size),
            rate: self.uniform(size),
            acceleration: self.uniform(size),
            amplitude: self.uniform(size),
            frequency: self.uniform(3.0),
            phase: self.uniform(3.0),
        }
    }

    fn motion(&mut self) -> Trajectory {
        let position = [self.coordinate(2.0), self.coordinate(2.0), self.coordinate(2.0)];
        let (yaw, pitch, roll) = (self.coordinate(0.8), self.coordinate(0.4), self.coordinate(0.8));
        Trajectory { position, angles: EulerAngles { yaw, pitch, roll }, ..Trajectory::default() }
    }

    fn bias(&mut self, gyro: f64, accelerometer: f64) -> ImuBias {
        ImuBias { gyro: self.vector(gyro), accelerometer: self.vector(accelerometer) }
    }

    fn state(&mut self) -> NavState {
        NavState {
            world_from_body: so3::exp(&self.vector(1.5)),
            velocity: self.vector(3.0),
            position: self.vector(10.0),
        }
    }
}

/// (φ, v, p) from one to the other.
fn difference(from: &Deltas, to: &Deltas) -> Vector9 {
    let phi = so3::local(&from.rotation, &to.rotation);
    let (v, p) = (to.velocity - from.velocity, to.position - from.position);
    Vector9::from_iterator(phi.iter().chain(v.iter()).chain(p.iter()).copied())
}

#[test]
fn the_covariance_is_that_of_two_thousand_noisy_runs() {
    let noise = ImuNoise::mems();
    let (dt, bias) = (0.005, ImuBias::default());
    for (rule, motion) in [
        (Rule::Euler, Trajectory::hover()),
        (Rule::Euler, Trajectory::figure_eight()),
        (Rule::Midpoint, Trajectory::figure_eight()),
    ] {
        let samples = motion.samples(&GRAVITY, dt, 201);
        let clean = summed(&samples, rule, dt, &bias, &noise);
        let whiten = clean.sqrt_information().unwrap();
        let mut random = Random::new(11);
        let mut scatter = Matrix9::zeros();
        for _ in 0..2000 {
            let noisy: Vec<_> = samples
                .iter()
                .map(|sample| noise.corrupt(sample, &bias, dt, || random.normal()))
                .collect();
            let run = summed(&noisy, rule, dt, &bias, &noise);
            let error = whiten * difference(&clean.deltas, &run.deltas);
            scatter += error * error.transpose() / 2000.0;
        }
        let eigenvalues = scatter.symmetric_eigenvalues();
        let (low, high) = (eigenvalues.min(), eigenvalues.max());
        assert!(low > 0.83 && high < 1.18, "{rule:?}: {low} to {high}");
    }
}

#[test]
fn the_sums_are_those_of_the_dense_recursion() {
    let mut random = Random::new(3);
    let noise = ImuNoise::mems();
    for rule in [Rule::Euler, Rule::Midpoint] {
        for _ in 0..20 {
            let motion = random.motion();
            let bias = random.bias(0.1, 0.5);
            let dt = 0.01;
            let samples = motion.samples(&GRAVITY, dt, 101);
            let sums = summed(&samples, rule, dt, &bias, &noise);
            let (covariance, jacobian) = dense(&samples, rule, dt, &bias, &noise);
            let whiten = sums.sqrt_information().unwrap();
            let whitened = whiten * covariance * whiten.transpose();
            assert_abs_diff_eq!(whitened, Matrix9::identity(), epsilon = 1e-9);
            assert_relative_eq!(
                sums.bias_jacobian,
                jacobian,
                max_relative = 1e-11,
                epsilon = 1e-12
            );
        }
    }
}

#[test]
fn steps_of_any_turn_are_those_of_the_dense_recursion() {
    let (noise, bias) = (ImuNoise::mems(), ImuBias::default());
    let force = Vector3::new(1.0, -2.0, 9.0);
    for rule in [Rule::Euler, Rule::Midpoint] {
        // From a hundredth of a degree to more than a whole turn in a step.
        for angle in [2e-4, 0.1, 0.13, 0.9, 2.5, 4.0, 7.0] {
            let gyro = angle / 0.05 * Vector3::new(0.48, -0.6, 0.64);
            let reading = |k: i32| ImuSample { gyro: f64::from(k) * gyro, accelerometer: force };
            let samples = [reading(1), reading(1), reading(-1), reading(1)];
            let sums = summed(&samples, rule, 0.05, &bias, &noise);
            let (covariance, jacobian) = dense(&samples, rule, 0.05, &bias, &noise);
            let size = covariance.diagonal().map(f64::sqrt);
            let relative = |m: Matrix9| m.component_div(&(size * size.transpose()));
            let (found, expected) = (relative(sums.covariance), relative(covariance));
            assert_abs_diff_eq!(found, expected, epsilon = 1e-12);
            assert_abs_diff_eq!(sums.bias_jacobian, jacobian, epsilon = 1e-13);
        }
    }
}

/// Covariance and Jacobians by the products of 9×9 matrices that the derivation writes.
fn dense(
    samples: &[ImuSample],
    rule: Rule,
    dt: f64,
    bias: &ImuBias,
    noise: impl Into<AxisNoise>,
) -> (Matrix9, Matrix9x6) {
    let noise = noise.into();
    let (mut covariance, mut jacobian) = (Matrix9::zeros(), Matrix9x6::zeros());
    let mut rotation = Rotation3::identity();
    for pair in samples.windows(2) {
        let reading = match rule {
            Rule::Euler => pair[0],
            Rule::Midpoint => ImuSample::mean(&pair[0], &pair[1]),
        };
        let reading = reading.corrected(bias);
        let step = error_dynamics(rule, &rotation, &reading, dt);
        let (a, b) = (step.from_errors, step.from_reading);
        covariance = a * covariance * a.transpose() + b * noise.discrete(dt) * b.transpose();
        jacobian = a * jacobian - b;
        rotation *= so3::exp(&(dt * reading.gyro));
    }
    (covariance, jacobian)
}

/// The derivative of a function of `N` numbers at zero, by central differences extrapolated to
/// a step of zero.
fn differences<const N: usize>(
    step: f64,
    function: impl Fn(&SMatrix<f64, N, 1>) -> Vector9,
) -> SMatrix<f64, 9, N> {
    let central = |axis: usize, h: f64| {
        let mut at = SMatrix::<f64, N, 1>::zeros();
        at[axis] = h;
        (function(&at) - function(&-at)) / (2.0 * h)
    };
    let mut columns = SMatrix::<f64, 9, N>::zeros();
    for axis in 0..N {
        let fine = (4.0 * central(axis, step) - central(axis, 2.0 * step)) / 3.0;
        columns.set_column(axis, &fine);
    }
    columns
}

/// The largest difference of an entry against the largest entry of its 3×3 block.
fn assert_blocks<const N: usize>(
    found: &SMatrix<f64, 9, N>,
    expected: &SMatrix<f64, 9, N>,
    tolerance: f64,
) {
    for row in (0..9).step_by(3) {
        for column in (0..N).step_by(3) {
            let block = expected.view((row, column), (3, 3));
            let error = (found.view((row, column), (3, 3)) - block).amax();
            let scale = block.amax().max(1e-3);
            assert!(error <= tolerance * scale, "block ({row}, {column}): {error} of {scale}");
        }
    }
}

#[test]
fn the_bias_jacobian_is_the_slope_of_integrating_again() {
    let mut random = Random::new(5);
    for trajectory in 0..500 {
        let rule = if trajectory % 2 == 0 { Rule::Euler } else { Rule::Midpoint };
        let motion = random.motion();
        let bias = random.bias(0.1, 0.5);
        let samples = motion.samples(&GRAVITY, 0.01, 51);
        let noise = ImuNoise::mems();
        let at = |bias: &ImuBias| summed(&samples, rule, 0.01, bias, &noise);
        let sums = at(&bias);
        let slope = differences::<6>(1e-3, |step| {
            let moved = at(&ImuBias::from_vector(&(bias.vector() + step)));
            difference(&sums.deltas, &moved.deltas)
        });
        assert_blocks(&sums.bias_jacobian, &slope, 1e-6);
    }
}

#[test]
fn the_residual_jacobians_are_its_slopes() {
    let mut random = Random::new(6);
    for _ in 0..500 {
        let samples = random.motion().samples(&GRAVITY, 0.01, 60);
        let sums = preintegrate(&samples, 0.01, &random.bias(0.1, 0.5), &ImuNoise::mems()).unwrap();
        let at_bias = sums.bias.vector() + random.bias(0.1, 0.5).vector();
        let bias = ImuBias::from_vector(&at_bias);
        let first = random.state();
        // Away from where the readings lead, but not by half a turn, where the logarithm jumps.
        let off: Vec<f64> = (0..9).map(|_| random.uniform(0.6)).collect();
        let second = sums.predict(&first, &GRAVITY, &bias).retract(&off);
        let found = linearize(&sums, &first, &second, &GRAVITY, &bias);
        let residual = |first: &NavState, second: &NavState, bias: &ImuBias| {
            imu_residual(&sums, first, second, &GRAVITY, bias)
        };
        assert_eq!(found.residual, residual(&first, &second, &bias));
        let by_first = differences::<9>(1e-3, |step| {
            residual(&first.retract(step.as_slice()), &second, &bias)
        });
        assert_blocks(&found.by_first, &by_first, 1e-6);
        let by_second = differences::<9>(1e-3, |step| {
            residual(&first, &second.retract(step.as_slice()), &bias)
        });
        assert_blocks(&found.by_second, &by_second, 1e-6);
        let by_bias = differences::<6>(1e-3, |step| {
            residual(&first, &second, &ImuBias::from_vector(&(at_bias + step)))
        });
        assert_blocks(&found.by_bias, &by_bias, 1e-6);
    }
}

#[test]
fn whitening_multiplies_residual_and_jacobians() {
    let mut random = Random::new(7);
    let samples = random.motion().samples(&GRAVITY, 0.01, 50);
    let sums = preintegrate(&samples, 0.01, &ImuBias::default(), &ImuNoise::mems()).unwrap();
    let (first, second) = (random.state(), random.state());
    let plain = linearize(&sums, &first, &second, &GRAVITY, &sums.bias);
    let whiten = sums.sqrt_information().unwrap();
    let white = plain.whitened(&whiten);
    let squared = plain.residual.dot(&(sums.covariance.try_inverse().unwrap() * plain.residual));
    assert_relative_eq!(white.residual.norm_squared(), squared, max_relative = 1e-6);
    assert_eq!(white.by_first, whiten * plain.by_first);
    assert_eq!(white.by_second, whiten * plain.by_second);
    assert_eq!(white.by_bias, whiten * plain.by_bias);
}

#[test]
fn what_deltas_predict_is_what_propagation_reaches_from_any_state() {
    let mut random = Random::new(8);
    for rule in [Rule::Euler, Rule::Midpoint] {
        let samples = random.motion().samples(&GRAVITY, 0.005, 201);
        let bias = random.bias(0.1, 0.5);
        let sums = summed(&samples, rule, 0.005, &bias, &ImuNoise::mems());
        for _ in 0..10 {
            let first = random.state();
            let mut state = first;
            for pair in samples.windows(2) {
                let [start, end] = [pair[0].corrected(&bias), pair[1].corrected(&bias)];
                state = match rule {
                    Rule::Euler => state.propagate(&start, &GRAVITY, 0.005),
                    Rule::Midpoint => state.propagate_midpoint(&start, &end, &GRAVITY, 0.005),
                };
            }
            let predicted = sums.predict(&first, &GRAVITY, &bias);
            let rotation_error = so3::local(&predicted.world_from_body, &state.world_from_body);
            assert!(rotation_error.norm() < 1e-12);
            assert_abs_diff_eq!(predicted.velocity, state.velocity, epsilon = 1e-11);
            assert_abs_diff_eq!(predicted.position, state.position, epsilon = 1e-11);
            assert!(imu_residual(&sums, &first, &state, &GRAVITY, &bias).norm() < 1e-10);
            let back = sums.before(&predicted, &GRAVITY);
            assert!(so3::local(&back.world_from_body, &first.world_from_body).norm() < 1e-12);
            assert_abs_diff_eq!(back.velocity, first.velocity, epsilon = 1e-11);
            assert_abs_diff_eq!(back.position, first.position, epsilon = 1e-11);
        }
    }
}

#[test]
fn sample_by_sample_is_the_same_as_a_slice() {
    let samples = Trajectory::figure_eight().samples(&GRAVITY, 0.005, 200);
    let (bias, noise) = (Random::new(9).bias(0.1, 0.5), ImuNoise::mems());
    let mut integrator = Preintegrator::new(&bias, &noise).unwrap();
    for (index, sample) in samples.iter().enumerate() {
        integrator.integrate(sample, 0.005).unwrap();
        let slice = preintegrate(&samples[..=index], 0.005, &bias, &noise).unwrap();
        assert_eq!(integrator.finish().unwrap(), slice);
    }
}

#[test]
fn stamped_readings_are_summed_with_the_steps_between_their_times() {
    let motion = Trajectory::figure_eight();
    let times: [i64; 6] = [0, 5_000_000, 9_000_000, 16_000_000, 21_000_001, 30_000_000];
    let since = 1_403_715_273_262_142_976;
    let stamped: Vec<_> = times
        .iter()
        .map(|&time| StampedSample {
            nanoseconds: since + time,
            sample: motion.at(1e-9 * time as f64).sample(&GRAVITY),
        })
        .collect();
    let (bias, noise) = (ImuBias::default(), ImuNoise::mems());
    for rule in [Rule::Euler, Rule::Midpoint] {
        let mut integrator = Preintegrator::new(&bias, &noise).unwrap();
        for (pair, times) in stamped.windows(2).zip(times.windows(2)) {
            let dt = 1e-9 * (times[1] - times[0]) as f64;
            match rule {
                Rule::Euler => integrator.integrate(&pair[0].sample, dt),
                Rule::Midpoint => {
                    integrator.integrate_midpoint(&pair[0].sample, &pair[1].sample, dt)
                }
            }
            .unwrap();
        }
        let slice = preintegrate_stamped(&stamped, rule, LONGEST_STEP, &bias, &noise).unwrap();
        assert_eq!(integrator.finish().unwrap(), slice);
        assert_abs_diff_eq!(slice.duration, 0.03, epsilon = 1e-15);
    }
}

/// How far the corrected position is from that of integrating again.
fn correction_error(motion: &Trajectory, bias: &ImuBias) -> f64 {
    let samples = motion.samples(&GRAVITY, 0.005, 200);
    let noise = ImuNoise::mems();
    let sums = preintegrate(&samples, 0.005, &ImuBias::default(), &noise).unwrap();
    let again = preintegrate(&samples, 0.005, bias, &noise).unwrap();
    (correct_for_bias(&sums, bias).position - again.deltas.position).norm()
}

#[test]
fn a_tenth_of_the_bias_error_leaves_a_hundredth_of_the_correction_error() {
    let turn = Trajectory::level_turn(1.0, 0.5);
    let about = |axis: &Vector3<f64>, size: f64| ImuBias {
        gyro: size * axis,
        accelerometer: Vector3::zeros(),
    };
    for axis in [Vector3::x(), Vector3::z()] {
        let [large, small] = [0.1, 0.01].map(|size| correction_error(&turn, &about(&axis, size)));
        assert!((large / small / 100.0 - 1.0).abs() < 0.05, "{}", large / small);
    }
    let level = correction_error(&turn, &about(&Vector3::z(), 0.1));
    assert_abs_diff_eq!(level, 0.205e-3, epsilon = 0.005e-3);
    let tilted = correction_error(&turn, &about(&Vector3::x(), 0.1));
    assert_abs_diff_eq!(tilted, 4.0e-3, epsilon = 0.1e-3);
    let spot = correction_error(&Trajectory::turn_on_the_spot(0.5), &about(&Vector3::z(), 0.1));
    assert!(spot < 1e-12);
}

#[test]
fn what_a_correction_leaves_out_is_below_its_bound() {
    let mut random = Random::new(10);
    let noise = ImuNoise::mems();
    let mut closest = [0.0_f64; 3];
    for _ in 0..500 {
        let samples = random.motion().samples(&GRAVITY, 0.01, 100);
        let sums = preintegrate(&samples, 0.01, &ImuBias::default(), &noise).unwrap();
        let bias = random.bias(0.03, 0.1);
        let again = preintegrate(&samples, 0.01, &bias, &noise).unwrap();
        let error = difference(&again.deltas, &correct_for_bias(&sums, &bias));
        let bound = sums.linearization_error_bound(&bias);
        let bounds = [bound.rotation, bound.velocity, bound.position];
        for (block, bound) in bounds.into_iter().enumerate() {
            let part = error.fixed_rows::<3>(3 * block).norm() / bound;
            closest[block] = closest[block].max(part);
        }
    }
    assert!(closest.iter().all(|part| *part < 1.0 && *part > 0.05), "{closest:?}");
}

#[test]
fn readings_are_summed_again_when_the_bias_has_moved_far() {
    let sums = at_rest(200);
    let gyro = |size: f64| ImuBias { gyro: Vector3::x() * size, ..ImuBias::default() };
    assert!(!sums.should_reintegrate(&sums.bias, 0.01));
    assert!(!sums.should_reintegrate(&gyro(0.02), 0.01));
    assert!(sums.should_reintegrate(&gyro(0.03), 0.01));
    assert!(sums.should_reintegrate(&gyro(f64::NAN), 0.01));
    // Without a square root of the information there is no limit to keep.
    let tied = at_rest(1);
    assert!(
        !tied.should_reintegrate(&tied.bias, 0.01) && tied.should_reintegrate(&gyro(1e-9), 0.01)
    );
}

#[test]
fn a_correction_that_is_kept_adds_no_more_to_the_squared_error_than_was_allowed() {
    let mut random = Random::new(12);
    let noise = ImuNoise::mems();
    let (mut kept, mut closest) = (0, 0.0_f64);
    for _ in 0..300 {
        let samples = random.motion().samples(&GRAVITY, 0.01, 100);
        let sums = preintegrate(&samples, 0.01, &ImuBias::default(), &noise).unwrap();
        let bias = random.bias(0.02, 0.1);
        let again = preintegrate(&samples, 0.01, &bias, &noise).unwrap();
        let error = difference(&again.deltas, &correct_for_bias(&sums, &bias));
        let whiten = sums.sqrt_information().unwrap();
        let part = (whiten * error).norm_squared() / sums.squared_error_bound(&bias, &whiten);
        closest = closest.max(part);
        if !sums.should_reintegrate(&bias, 0.01) {
            kept += 1;
            assert!((whiten * error).norm_squared() < 0.09);
        }
    }
    assert!(closest < 1.0 && closest > 1e-3, "{closest}");
    assert!(kept > 30 && kept < 270, "{kept}");
}

#[test]
fn a_tenth_of_every_standard_deviation_may_be_much_of_the_squared_error() {
    // Ascent to the worst directions of errors whose lengths are a tenth of the deviations.
    let worst = |sums: &Preintegrated| {
        let whiten = sums.sqrt_information().unwrap();
        let tenths = sums.sigmas().map(|sigma| 0.1 * sigma);
        let mut error = Vector9::from_fn(|row, _| [1.0, -0.5, 0.3][row % 3] * (row as f64 - 3.7));
        for _ in 0..300 {
            let gradient = whiten.tr_mul(&(whiten * error));
            for (block, tenth) in tenths.into_iter().enumerate() {
                let uphill = gradient.fixed_rows::<3>(3 * block).normalize();
                error.fixed_rows_mut::<3>(3 * block).copy_from(&(tenth * uphill));
            }
        }
        (whiten * error).norm_squared()
    };
    let (second, five) = (worst(&at_rest(200)), worst(&at_rest(1000)));
    assert!(second > 0.2 && second < 0.34, "{second}");
    assert!(five > 1.5 && five < 2.91, "{five}");
}

#[test]
fn each_source_of_noise_alone_grows_by_its_own_law() {
    let accelerometer = ImuNoise { gyro: 0.0, ..ImuNoise::mems() };
    let gyro = ImuNoise { accelerometer: 0.0, ..ImuNoise::mems() };
    let sample = Trajectory::hover().at(0.0).sample(&GRAVITY);
    let sigmas = |noise: &ImuNoise, steps: usize| {
        let samples = vec![sample; steps];
        preintegrate(&samples, 0.005, &ImuBias::default(), noise).unwrap().sigmas()
    };
    let exponent = |noise: &ImuNoise, quantity: usize| {
        (sigmas(noise, 2000)[quantity] / sigmas(noise, 500)[quantity]).log2() / 2.0
    };
    assert_eq!(sigmas(&accelerometer, 500)[0], 0.0);
    assert_abs_diff_eq!(exponent(&accelerometer, 1), 0.5, epsilon = 0.01);
    assert_abs_diff_eq!(exponent(&accelerometer, 2), 1.5, epsilon = 0.01);
    assert_abs_diff_eq!(exponent(&gyro, 0), 0.5, epsilon = 0.01);
    assert_abs_diff_eq!(exponent(&gyro, 1), 1.5, epsilon = 0.01);
    assert_abs_diff_eq!(exponent(&gyro, 2), 2.5, epsilon = 0.01);
}

#[test]
fn a_long_sum_stays_a_rotation_and_its_covariance_symmetric() {
    let motion = Trajectory::figure_eight();
    let mut integrator = Preintegrator::new(&ImuBias::default(), &ImuNoise::mems()).unwrap();
    for k in 0..200_000 {
        integrator.integrate(&motion.at(0.005 * k as f64).sample(&GRAVITY), 0.005).unwrap();
    }
    let sums = integrator.finish().unwrap();
    let rotation = sums.deltas.rotation.matrix();
    let identity = nalgebra::Matrix3::identity();
    assert_abs_diff_eq!(rotation * rotation.transpose(), identity, epsilon = 1e-12);
    assert_eq!(sums.covariance, sums.covariance.transpose());
    assert!(sums.covariance.symmetric_eigenvalues().min() > 0.0);
}

#[test]
fn the_walk_of_the_biases_is_whitened() {
    let noise = ImuNoise::mems();
    let walk = BiasWalk::new(&noise, 4.0).unwrap();
    let first = ImuBias::default();
    let gyro = Vector3::new(2.0 * noise.gyro_walk, 0.0, 0.0);
    let accelerometer = Vector3::new(0.0, 0.0, -4.0 * noise.accelerometer_walk);
    let found = walk.linearize(&first, &ImuBias { gyro, accelerometer });
    let expected = Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, -2.0);
    assert_abs_diff_eq!(found.residual, expected, epsilon = 1e-12);
    assert_eq!(found.by_first, -found.by_second);
    assert_abs_diff_eq!(found.by_second[(0, 0)], 0.5 / noise.gyro_walk, epsilon = 1e-9);
    assert_eq!(BiasWalk::new(&noise, 0.0), Err(WhiteningError::NotPositiveDefinite));
    assert_eq!(BiasWalk::new(&noise, f64::NAN), Err(WhiteningError::NotFinite));
}

#[test]
fn no_reading_is_an_error() {
    let (bias, noise) = (ImuBias::default(), ImuNoise::mems());
    assert_eq!(preintegrate(&[], 0.005, &bias, &noise), Err(PreintegrationError::Empty));
    let sample = Trajectory::hover().at(0.0).sample(&GRAVITY);
    let one = [StampedSample { nanoseconds: 0, sample }];
    for few in [&one[..0], &one[..]] {
        let found = preintegrate_stamped(few, Rule::Midpoint, LONGEST_STEP, &bias, &noise);
        assert_eq!(found, Err(PreintegrationError::Empty));
    }
    assert!(PreintegrationError::Empty.to_string().contains("no step"));
}

#[test]
fn a_step_must_be_positive_and_no_longer_than_the_limit() {
    let (bias, noise) = (ImuBias::default(), ImuNoise::mems());
    let sample = Trajectory::hover().at(0.0).sample(&GRAVITY);
    for dt in [0.0, -0.0, -0.005, f64::NEG_INFINITY] {
        let found = preintegrate(&[sample], dt, &bias, &noise);
        assert_eq!(found, Err(PreintegrationError::Step { step: 0, dt }));
    }
    let nan = preintegrate(&[sample], f64::NAN, &bias, &noise).unwrap_err();
    assert!(matches!(nan, PreintegrationError::Step { step: 0, dt } if dt.is_nan()));
    for dt in [LONGEST_STEP * 1.01, f64::INFINITY] {
        let found = preintegrate(&[sample], dt, &bias, &noise);
        assert_eq!(found, Err(PreintegrationError::Gap { step: 0, dt, longest: LONGEST_STEP }));
    }
    let mut patient = Preintegrator::new(&bias, &noise).unwrap();
    patient.longest_step = 1.0;
    patient.integrate(&sample, 0.5).unwrap();
    let gap = patient.integrate_midpoint(&sample, &sample, 1.5).unwrap_err();
    assert_eq!(gap, PreintegrationError::Gap { step: 1, dt: 1.5, longest: 1.0 });
    assert_eq!(
        gap.to_string(),
        "step 1 lasts 1.5 s, longer than 1 s; readings are missing, so end the interval before \
         them or allow longer steps"
    );
}

#[test]
fn times_that_repeat_go_back_or_leave_a_gap_are_errors() {
    let sample = Trajectory::hover().at(0.0).sample(&GRAVITY);
    let at = |times: &[i64]| {
        let stamped: Vec<_> =
            times.iter().map(|&nanoseconds| StampedSample { nanoseconds, sample }).collect();
        let (bias, noise) = (ImuBias::default(), ImuNoise::mems());
        preintegrate_stamped(&stamped, Rule::Euler, 0.02, &bias, &noise).unwrap_err()
    };
    let repeated = at(&[0, 5_000_000, 5_000_000]);
    assert_eq!(repeated, PreintegrationError::Step { step: 1, dt: 0.0 });
    assert!(matches!(at(&[0, -5_000_000]), PreintegrationError::Step { step: 0, .. }));
    assert!(matches!(at(&[0, 5_000_000, 30_000_000]), PreintegrationError::Gap { step: 1, .. }));
    assert!(matches!(at(&[i64::MIN, i64::MAX]), PreintegrationError::Gap { step: 0, .. }));
}

#[test]
fn a_reading_that_is_not_finite_leaves_the_sums_as_they_were() {
    let good = Trajectory::figure_eight().at(0.3).sample(&GRAVITY);
    let mut integrator = Preintegrator::new(&ImuBias::default(), &ImuNoise::mems()).unwrap();
    integrator.integrate(&good, 0.005).unwrap();
    let before = integrator.finish().unwrap();
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..6 {
            let mut bad = good;
            if axis < 3 {
                bad.gyro[axis] = value
            } else {
                bad.accelerometer[axis - 3] = value
            }
            for found in [
                integrator.integrate(&bad, 0.005),
                integrator.integrate_midpoint(&bad, &good, 0.005),
                integrator.integrate_midpoint(&good, &bad, 0.005),
            ] {
                assert!(matches!(found, Err(PreintegrationError::Sample { step: 1, .. })));
            }
        }
    }
    assert_eq!(integrator.finish().unwrap(), before);
}

#[test]
fn bias_and_noise_must_be_numbers() {
    let noise = ImuNoise::mems();
    let bias = ImuBias { gyro: Vector3::new(0.0, f64::NAN, 0.0), ..ImuBias::default() };
    let error = Preintegrator::new(&bias, &noise).unwrap_err();
    assert!(matches!(error, PreintegrationError::Bias { .. }), "{error}");
    for value in [-1e-3, f64::NAN, f64::INFINITY] {
        for noise in [
            ImuNoise { gyro: value, ..noise },
            ImuNoise { accelerometer: value, ..noise },
            ImuNoise { gyro_walk: value, ..noise },
            ImuNoise { accelerometer_walk: value, ..noise },
        ] {
            let error = Preintegrator::new(&ImuBias::default(), &noise).unwrap_err();
            assert!(matches!(error, PreintegrationError::Noise(NoiseError { .. })), "{error}");
        }
    }
}

#[test]
fn readings_too_large_to_be_summed_are_an_error() {
    let huge = ImuSample { gyro: Vector3::zeros(), accelerometer: Vector3::repeat(1e300) };
    let found = preintegrate(&[huge; 3], 0.005, &ImuBias::default(), &ImuNoise::mems());
    assert_eq!(found, Err(PreintegrationError::Overflow { steps: 3 }));
    let spinning = ImuSample { gyro: Vector3::repeat(1e300), accelerometer: Vector3::zeros() };
    let found = preintegrate(&[spinning; 3], 0.005, &ImuBias::default(), &ImuNoise::mems());
    assert_eq!(found, Err(PreintegrationError::Overflow { steps: 3 }));
}

#[test]
fn without_noise_nothing_can_be_whitened() {
    let silent = ImuNoise { gyro: 0.0, accelerometer: 0.0, ..ImuNoise::mems() };
    let samples = Trajectory::figure_eight().samples(&GRAVITY, 0.005, 20);
    let sums = preintegrate(&samples, 0.005, &ImuBias::default(), &silent).unwrap();
    assert_eq!(sums.covariance, Matrix9::zeros());
    assert_eq!(sums.sqrt_information(), Err(WhiteningError::NotPositiveDefinite));
}
