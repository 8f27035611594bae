//! Beliefs: carried on, corrected, copied and cut.

use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix6, Rotation3, SMatrix, Vector1, Vector2, Vector3,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use vislam::factors::{PixelByCamera, Prior};
use vislam::filtering::{
    Belief, BeliefError, CorrectionError, Form, Transition, TransitionError, UpdateError,
    UpdateOptions, carry_root, chi_square_quantile, correct, correct_root, innovation_squared,
};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::least_squares::{Kernel, Manifold, Options, Problem, sqrt_information};
use vislam::preintegration::{CombinedPreintegrated, CombinedPreintegrator};

fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

fn numbers(random: &mut ChaCha8Rng, count: usize, size: f64) -> Vec<f64> {
    (0..count).map(|_| size * random.sample::<f64, _>(StandardNormal)).collect()
}

fn matrix(random: &mut ChaCha8Rng, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_vec(rows, columns, numbers(random, rows * columns, 1.0))
}

fn covariance(random: &mut ChaCha8Rng, dimension: usize) -> DMatrix<f64> {
    let root = matrix(random, dimension + 3, dimension);
    root.tr_mul(&root)
}

fn state(random: &mut ChaCha8Rng) -> NavState {
    NavState::origin().retract(&numbers(random, 9, 0.7))
}

fn interval(random: &mut ChaCha8Rng, bias: &ImuBias) -> CombinedPreintegrated {
    let mut sums = CombinedPreintegrator::new(bias, &ImuNoise::mems()).unwrap();
    for _ in 0..40 {
        let gyro = Vector3::from_vec(numbers(random, 3, 0.8));
        let accelerometer = Vector3::from_vec(numbers(random, 3, 3.0)) - GRAVITY;
        sums.integrate(&ImuSample { gyro, accelerometer }, 0.01).unwrap();
    }
    sums.finish().unwrap()
}

#[test]
fn a_transition_has_the_slopes_of_the_prediction() {
    let mut random = random(1);
    for _ in 0..20 {
        let bias = ImuBias::from_vector(&SMatrix::from_vec(numbers(&mut random, 6, 0.02)));
        let readings = interval(&mut random, &bias);
        let first = state(&mut random);
        let transition = Transition::new(&readings, &first, &bias, &GRAVITY).unwrap();
        let predicted = |step: &[f64]| {
            let bias = bias.retract(&step[9..]);
            let second = readings.sums.predict(&first.retract(&step[..9]), &GRAVITY, &bias);
            let mut error = [0.0; 9];
            transition.state.local(&second, &mut error);
            SMatrix::<f64, 9, 1>::from_row_slice(&error)
        };
        for coordinate in 0..15 {
            let mut step = [0.0; 15];
            step[coordinate] = 1e-5;
            let ahead = predicted(&step);
            step[coordinate] = -1e-5;
            let slope = (ahead - predicted(&step)) / 2e-5;
            let own = transition.by_error.fixed_view::<9, 1>(0, coordinate);
            assert!((slope - own).amax() < 1e-8, "{coordinate}: {}", (slope - own).amax());
        }
        assert!(transition.by_error.fixed_view::<6, 6>(9, 9).is_identity(0.0));
    }
}

#[test]
fn the_noise_of_a_transition_is_what_many_flights_scatter_by() {
    let mut random = random(2);
    let (noise, dt, count) = (ImuNoise::mems(), 0.01, 20);
    let truth = ImuBias::default();
    let perfect: Vec<ImuSample> = (0..count)
        .map(|_| ImuSample {
            gyro: Vector3::from_vec(numbers(&mut random, 3, 0.8)),
            accelerometer: Vector3::from_vec(numbers(&mut random, 3, 3.0)) - GRAVITY,
        })
        .collect();
    let first = state(&mut random);
    let flown = |samples: &[ImuSample]| {
        let mut sums = CombinedPreintegrator::new(&truth, &noise).unwrap();
        samples.iter().for_each(|sample| sums.integrate(sample, dt).unwrap());
        Transition::new(&sums.finish().unwrap(), &first, &truth, &GRAVITY).unwrap()
    };
    let expected = flown(&perfect);
    let root = sqrt_information(&expected.noise).unwrap();
    let (draws, mut sum) = (4000, SMatrix::<f64, 15, 15>::zeros());
    for _ in 0..draws {
        let mut bias = truth;
        let mut draw = || random.sample::<f64, _>(StandardNormal);
        let samples: Vec<ImuSample> = perfect
            .iter()
            .map(|sample| {
                let noisy = noise.corrupt(sample, &bias, dt, &mut draw);
                bias = noise.walk(&bias, dt, &mut draw);
                noisy
            })
            .collect();
        let mut error = SMatrix::<f64, 15, 1>::zeros();
        expected.state.local(&flown(&samples).state, &mut error.as_mut_slice()[..9]);
        // The prediction errs by as much the other way, and the bias walks on.
        error.fixed_rows_mut::<9>(0).neg_mut();
        error.fixed_rows_mut::<6>(9).copy_from(&bias.vector());
        let whitened = root * error;
        sum += whitened * whitened.transpose();
    }
    let scatter = sum / f64::from(draws);
    let largest = (scatter - SMatrix::<f64, 15, 15>::identity()).amax();
    assert!(largest < 0.12, "{largest}");
}

#[test]
fn carrying_on_is_the_product_with_the_transition_and_leaves_the_others() {
    let mut random = random(3);
    let bias = ImuBias::default();
    let mut belief = Belief::new();
    let other = belief.add(Vector3::<f64>::x(), &covariance(&mut random, 3)).unwrap();
    let state = belief.add(state(&mut random), &(1e-3 * covariance(&mut random, 9))).unwrap();
    let bias = belief.add(bias, &(1e-4 * covariance(&mut random, 6))).unwrap();
    let tied = matrix(&mut random, 2, 18);
    belief.add_function(Vector2::<f64>::zeros(), &tied, &DMatrix::zeros(2, 2)).unwrap();
    let readings = interval(&mut random, &ImuBias::default());
    let values = belief.values().clone();
    let transition = Transition::new(&readings, &values[state], &values[bias], &GRAVITY).unwrap();
    let mut whole = DMatrix::identity(20, 20);
    whole.view_mut((3, 3), (15, 15)).copy_from(&transition.by_error);
    let mut expected = &whole * belief.covariance() * whole.transpose();
    let mut own = expected.view_mut((3, 3), (15, 15));
    own += transition.noise;
    let mut without_bias = belief.clone();
    without_bias.keep(&[0, 1, 3]).unwrap();
    let refused = without_bias.carry_on((state, bias), &transition);
    assert_eq!(refused, Err(TransitionError::NoSuchVariable));
    belief.carry_on((state, bias), &transition).unwrap();
    let difference = (belief.covariance() - &expected).amax();
    assert!(difference < 1e-12 * expected.amax(), "{difference}");
    assert_eq!((belief.covariance() - belief.covariance().transpose()).amax(), 0.0);
    assert_eq!(belief.values()[other], Vector3::x());
    assert_eq!(belief.values()[state], transition.state);
}

#[test]
fn all_forms_of_the_correction_are_that_of_information() {
    let mut random = random(4);
    for rows in [1, 4, 12] {
        let before = covariance(&mut random, 8);
        let (jacobian, residual) = (matrix(&mut random, rows, 8), numbers(&mut random, rows, 1.0));
        let residual = DVector::from_vec(residual);
        let information = before.clone().try_inverse().unwrap() + jacobian.tr_mul(&jacobian);
        let expected = information.try_inverse().unwrap();
        let step = -&expected * jacobian.tr_mul(&residual);
        let of_root = |covariance: &mut DMatrix<f64>| {
            let mut root = covariance.clone().cholesky().unwrap().l().transpose();
            let correction = correct_root(&mut root, &jacobian, &residual).unwrap();
            *covariance = root.tr_mul(&root);
            correction
        };
        for form in [Some(Form::Difference), Some(Form::Joseph), None] {
            let mut after = before.clone();
            let correction = match form {
                Some(form) => correct(&mut after, &jacobian, &residual, form).unwrap(),
                None => of_root(&mut after),
            };
            assert!((&after - &expected).amax() < 1e-10 * before.amax(), "{form:?}");
            assert!((correction.step - &step).amax() < 1e-10, "{form:?}");
            let innovation =
                &jacobian * &before * jacobian.transpose() + DMatrix::identity(rows, rows);
            let squared = residual.dot(&innovation.cholesky().unwrap().solve(&residual));
            assert!((correction.innovation / squared - 1.0).abs() < 1e-10, "{form:?}");
            let asked = innovation_squared(&before, &jacobian, &residual).unwrap();
            assert!((asked / squared - 1.0).abs() < 1e-10);
        }
    }
}

#[test]
fn a_root_is_carried_on_as_its_square() {
    let mut random = random(8);
    let before = covariance(&mut random, 6);
    let (transition, noise) = (matrix(&mut random, 6, 6), matrix(&mut random, 2, 6));
    let expected = &transition * &before * transition.transpose() + noise.tr_mul(&noise);
    let mut root = before.cholesky().unwrap().l().transpose();
    carry_root(&mut root, &transition, &noise).unwrap();
    assert!((root.tr_mul(&root) - &expected).amax() < 1e-12 * expected.amax());
    for (rows, columns) in [(6, 5), (5, 6)] {
        let wrong = carry_root(&mut root, &DMatrix::zeros(rows, columns), &noise);
        assert!(matches!(wrong, Err(CorrectionError::Sizes { .. })), "{rows} {columns}");
    }
}

#[test]
fn in_single_precision_the_difference_has_no_covariance_left_and_the_root_has() {
    // A sharp measurement of what was known badly: 1e8 of its variance goes.
    let covariance = DMatrix::<f32>::from_row_slice(2, 2, &[1e4, 0.0, 0.0, 1e4]);
    let jacobian = DMatrix::from_row_slice(2, 2, &[3e2_f32, 3e2, 3e2, 3.001e2]);
    let residual = DVector::zeros(2);
    let difference = correct(&mut covariance.clone(), &jacobian, &residual, Form::Difference);
    assert_eq!(difference, Err(CorrectionError::Covariance));
    let mut root = covariance.cholesky().unwrap().l().transpose();
    correct_root(&mut root, &jacobian, &residual).unwrap();
    let exact = DMatrix::<f64>::from_row_slice(2, 2, &[3e2, 3e2, 3e2, 3.001e2_f32 as f64]);
    let exact: DMatrix<f64> =
        (exact.tr_mul(&exact) + 1e-4 * DMatrix::<f64>::identity(2, 2)).try_inverse().unwrap();
    let squared = root.map(f64::from).tr_mul(&root.map(f64::from));
    let relative = (squared - &exact).norm() / exact.norm();
    assert!(relative < 0.05, "{relative}");
}

/// Three pixels of a landmark by a camera that is known well and a landmark that is known badly, so
/// that the projection bends within what is believed.
fn bent() -> (Belief, Problem, Problem) {
    let mut random = random(5);
    let camera = vislam::reprojection::Pinhole { fx: 300.0, fy: 300.0, cx: 320.0, cy: 240.0 };
    let posed = |shift: f64| {
        let camera_from_world = Isometry3::translation(-shift, 0.0, 0.0);
        vislam::factors::MovingCamera(vislam::bundle_adjustment::PosedPinhole {
            intrinsics: camera,
            camera_from_world,
        })
    };
    let start = Vector3::new(0.3, -0.2, 4.0);
    let prior = Matrix6::from_diagonal_element(1e-4);
    let loose = SMatrix::<f64, 3, 3>::from_diagonal(&Vector3::new(0.2, 0.2, 0.8));
    let mut belief = Belief::new();
    let (mut pixels, mut whole) = (Problem::new(), Problem::new());
    let cameras: Vec<_> = [0.0, 0.5, 1.1]
        .into_iter()
        .map(|shift| {
            let variance = DMatrix::from_column_slice(6, 6, prior.as_slice());
            belief.add(posed(shift), &variance).unwrap();
            pixels.add_variable(posed(shift));
            whole.add_variable(posed(shift))
        })
        .collect();
    belief.add(start, &DMatrix::from_column_slice(3, 3, loose.as_slice())).unwrap();
    pixels.add_variable(start);
    let landmark = whole.add_variable(start);
    for (camera, shift) in cameras.iter().zip([0.0, 0.5, 1.1]) {
        let sqrt_information = sqrt_information(&prior).unwrap();
        let prior = Prior { variable: *camera, anchor: posed(shift), sqrt_information };
        whole.add_factor(prior, Kernel::Squared).unwrap();
        let truth = Vector3::new(0.4, -0.1, 2.6);
        let pixel = vislam::bundle_adjustment::Camera::project(&posed(shift).0, &truth).unwrap()
            + Vector2::from_vec(numbers(&mut random, 2, 1.0));
        let factor = PixelByCamera { camera: *camera, landmark, pixel, inverse_sigma: 1.0 };
        pixels.add_factor(factor, Kernel::Squared).unwrap();
        whole.add_factor(factor, Kernel::Squared).unwrap();
    }
    let sqrt_information = sqrt_information(&loose).unwrap();
    let prior = Prior { variable: landmark, anchor: start, sqrt_information };
    whole.add_factor(prior, Kernel::Squared).unwrap();
    (belief, pixels, whole)
}

#[test]
fn the_iterated_update_takes_the_steps_of_gauss_and_newton() {
    let (belief, pixels, whole) = bent();
    for iterations in 1..=6 {
        let mut updated = belief.clone();
        let options = UpdateOptions { iterations, tolerance: 0.0, ..UpdateOptions::default() };
        updated.update(&pixels, &options).unwrap();
        let options = Options {
            max_iterations: iterations,
            gradient_tolerance: 0.0,
            step_tolerance: 0.0,
            decrease_tolerance: 0.0,
            ..Options::gauss_newton()
        };
        let solved = whole.solve(&options).unwrap();
        let difference = updated.values().local(&solved.values);
        let largest = difference.iter().fold(0.0_f64, |most, step| most.max(step.abs()));
        assert!(largest < 1e-9, "{iterations}: {largest}");
    }
}

#[test]
fn one_linearization_is_not_enough_where_the_pixels_bend() {
    let (belief, pixels, whole) = bent();
    let optimum = whole.solve(&Options::default()).unwrap().values;
    let landmark = optimum.key::<Vector3<f64>>(3).unwrap();
    let error = |iterations| {
        let mut updated = belief.clone();
        let options = UpdateOptions { iterations, ..UpdateOptions::default() };
        updated.update(&pixels, &options).unwrap();
        (updated.values()[landmark] - optimum[landmark]).norm()
    };
    assert!(error(1) > 0.05, "{}", error(1));
    assert!(error(10) < 1e-6, "{}", error(10));
}

#[test]
fn the_covariance_of_an_iterated_update_is_that_of_the_minimum() {
    let (mut belief, pixels, whole) = bent();
    let options = UpdateOptions { iterations: 20, tolerance: 1e-9, ..UpdateOptions::default() };
    belief.update(&pixels, &options).unwrap();
    let expected = whole.covariance(belief.values()).unwrap();
    let relative = (belief.covariance() - expected.matrix()).norm() / expected.matrix().norm();
    assert!(relative < 1e-6, "{relative}");
}

#[test]
fn a_gate_refuses_what_contradicts_and_nothing_is_lost() {
    let (mut belief, pixels, _) = bent();
    let before = belief.clone();
    let gate = Some(chi_square_quantile(1e-3, 6).unwrap());
    let refused = belief.update(&pixels, &UpdateOptions { gate, ..UpdateOptions::default() });
    assert!(matches!(refused, Err(UpdateError::Gated { .. })), "{refused:?}");
    assert_eq!(belief.covariance(), before.covariance());
    assert!(belief.values().local(before.values()).iter().all(|step| *step == 0.0));
}

#[test]
fn a_clone_is_as_the_variable_until_the_variable_moves_on() {
    let mut random = random(6);
    let mut belief = Belief::new();
    let state = belief.add(state(&mut random), &(1e-3 * covariance(&mut random, 9))).unwrap();
    let bias = belief.add(ImuBias::default(), &(1e-4 * covariance(&mut random, 6))).unwrap();
    let copy = belief.clone_variable(state).unwrap();
    let mut between = DMatrix::zeros(9, 24);
    between.view_mut((0, 0), (9, 9)).fill_with_identity();
    between.view_mut((0, 15), (9, 9)).fill_diagonal(-1.0);
    assert_eq!((&between * belief.covariance() * between.transpose()).amax(), 0.0);
    let readings = interval(&mut random, &ImuBias::default());
    let (before, first) = (belief.of(copy).unwrap(), belief.values()[state]);
    let transition = Transition::new(&readings, &first, &belief.values()[bias], &GRAVITY).unwrap();
    belief.carry_on((state, bias), &transition).unwrap();
    assert_eq!(belief.of(copy).unwrap(), before);
    assert_eq!(belief.values()[copy], first);
    // What is between the two is noise of the readings and the error of the bias, however uncertain
    // the state itself was: a step of it that all share goes through the transition alone.
    let mut moved = between;
    moved.view_mut((0, 15), (9, 9)).copy_from(&-transition.by_error.fixed_view::<9, 9>(0, 0));
    let left = &moved * belief.covariance() * moved.transpose();
    let by_bias = transition.by_error.fixed_view::<9, 6>(0, 9);
    let own =
        belief.covariance().fixed_view::<6, 6>(9, 9) - transition.noise.fixed_view::<6, 6>(9, 9);
    let expected = by_bias * own * by_bias.transpose() + transition.noise.fixed_view::<9, 9>(0, 0);
    assert!((left - expected).amax() < 1e-12);
}

// ANCHOR: worked_example
/// A place is known to a variance of four, and a step adds one. The step is measured
/// with a variance of one: that says nothing of where it began.
#[test]
fn a_measured_step_says_nothing_of_where_it_began() {
    let one = |value| DMatrix::from_element(1, 1, value);
    let mut belief = Belief::new();
    let before = belief.add(Vector1::new(0.0), &one(4.0)).unwrap();
    let now = belief.add_function(Vector1::new(3.0), &one(1.0), &one(1.0)).unwrap();
    let mut untied = Belief::new();
    untied.add(Vector1::new(0.0), &one(4.0)).unwrap();
    untied.add(Vector1::new(3.0), &one(5.0)).unwrap();

    let by_both = DMatrix::from_row_slice(1, 2, &[-1.0, 1.0]);
    let residual = DVector::from_element(1, -2.0);
    belief.correct(&by_both, &residual, Form::Joseph).unwrap();
    untied.correct(&by_both, &residual, Form::Joseph).unwrap();

    let near = |is: f64, expected: f64| assert!((is - expected).abs() < 1e-12, "{is}");
    near(belief.values()[before].x, 0.0);
    near(belief.values()[now].x, 4.0);
    near(belief.of(before).unwrap()[0], 4.0);
    near(belief.of(now).unwrap()[0], 4.5);
    near(untied.of(now).unwrap()[0], 2.5);
}
// ANCHOR_END: worked_example

#[test]
fn what_stays_is_believed_as_before() {
    let mut random = random(7);
    let mut belief = Belief::new();
    let first = belief.add(Rotation3::<f64>::identity(), &covariance(&mut random, 3)).unwrap();
    belief.add(Vector2::<f64>::zeros(), &covariance(&mut random, 2)).unwrap();
    let by_all = matrix(&mut random, 3, 5);
    let noise = covariance(&mut random, 3);
    let last = belief.add_function(Vector3::<f64>::y(), &by_all, &noise).unwrap();
    let (before, tied) =
        (belief.of(last).unwrap(), belief.covariance().view((5, 0), (3, 3)).into_owned());
    let own = belief.of(first).unwrap();
    belief.keep(&[2, 0]).unwrap();
    assert_eq!(belief.dimension(), 6);
    assert_eq!(belief.covariance().view((0, 0), (3, 3)), before);
    assert_eq!(belief.covariance().view((3, 3), (3, 3)), own);
    assert_eq!(belief.covariance().view((0, 3), (3, 3)), tied);
    assert_eq!(*belief.values().of_kind::<Vector3<f64>>(), [Vector3::y()]);
}

#[test]
fn what_does_not_fit_is_refused_by_what_it_is() {
    let mut belief = Belief::new();
    let wrong = belief.add(Vector3::<f64>::x(), &DMatrix::zeros(2, 2));
    assert_eq!(wrong, Err(BeliefError::Covariance { given: (2, 2), expected: (3, 3) }));
    let nan = belief.add(Vector2::<f64>::x(), &DMatrix::from_element(2, 2, f64::NAN));
    assert!(nan.unwrap_err().to_string().contains("give finite numbers in 2 rows"));
    belief.add(Vector2::<f64>::x(), &DMatrix::identity(2, 2)).unwrap();
    assert_eq!(belief.keep(&[1]), Err(BeliefError::NoSuchVariable { variable: 1, variables: 1 }));
    let missing = belief.correct(&DMatrix::zeros(1, 3), &DVector::zeros(1), Form::Joseph);
    assert!(matches!(missing, Err(CorrectionError::Sizes { columns: 3, dimension: 2, .. })));
    let infinite = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, f64::INFINITY]);
    let refused = belief.correct(&infinite, &DVector::zeros(2), Form::Joseph);
    assert_eq!(refused, Err(CorrectionError::NotFinite { row: 1 }));
    let mut indefinite = DMatrix::from_row_slice(1, 1, &[-2.0]);
    let lost = correct(&mut indefinite, &DMatrix::identity(1, 1), &DVector::zeros(1), Form::Joseph);
    assert_eq!(lost, Err(CorrectionError::Covariance));
    assert_eq!(belief.covariance(), &DMatrix::identity(2, 2));
    let (one, none) = (DMatrix::identity(1, 1), DVector::zeros(1));
    let number = |number: f64| DMatrix::from_element(1, 1, number);
    for (mut covariance, jacobian) in
        [(number(f64::NAN), number(1.0)), (number(1e300), number(1e10))]
    {
        let residual = DVector::from_element(1, 1.0);
        let lost = correct(&mut covariance, &jacobian, &residual, Form::Difference);
        assert_eq!(lost, Err(CorrectionError::Covariance));
    }
    let mut root = number(f64::NAN);
    assert_eq!(correct_root(&mut root, &one, &none), Err(CorrectionError::Covariance));
    assert_eq!(carry_root(&mut root, &one, &one), Err(CorrectionError::Covariance));
    let mut root = number(1e200);
    assert_eq!(carry_root(&mut root, &number(1e200), &one), Err(CorrectionError::Covariance));
    assert_eq!(root, number(1e200));
}

#[test]
fn what_a_problem_ties_is_not_tied_in_a_belief() {
    let updated = |is_tied: bool| {
        let (mut belief, mut problem) = (Belief::new(), Problem::new());
        let [first, second] = [(); 2].map(|()| {
            belief.add(Vector1::new(0.0), &DMatrix::identity(1, 1)).unwrap();
            problem.add_variable(Vector1::new(0.0))
        });
        if is_tied {
            problem.tie(second, first).unwrap();
        }
        let prior = Prior::near(first, Vector1::new(1.0), [1.0]);
        problem.add_factor(prior, Kernel::Squared).unwrap();
        belief.update(&problem, &UpdateOptions::default()).unwrap();
        [first, second].map(|key| belief.values()[key].x)
    };
    assert_eq!(updated(true), updated(false));
    assert_eq!(updated(true)[1], 0.0);
}

#[test]
fn a_key_from_before_variables_were_dropped_carries_nothing_on() {
    let mut belief = Belief::new();
    let add = |size| DMatrix::identity(size, size);
    belief.add(Vector3::zeros(), &add(3)).unwrap();
    let state = belief.add(NavState::origin(), &add(9)).unwrap();
    let bias = belief.add(ImuBias::default(), &add(6)).unwrap();
    belief.add(Vector3::x(), &add(3)).unwrap();
    belief.keep(&[1, 2, 3]).unwrap();
    let before = belief.covariance().clone();
    let transition = Transition {
        state: NavState::origin(),
        by_error: SMatrix::identity(),
        noise: SMatrix::zeros(),
    };
    let refused = belief.carry_on((state, bias), &transition);
    assert_eq!(refused, Err(TransitionError::NoSuchVariable));
    assert_eq!(belief.covariance(), &before);
    assert_eq!(belief.of(state), None);
}
