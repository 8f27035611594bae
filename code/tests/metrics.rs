//! How an estimate is judged whose truth is known.

use std::f64::consts::FRAC_PI_2;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix2, Matrix3, Matrix3x1, Rotation3, SMatrix, SVector, Vector1,
    Vector2, Vector3, Vector6,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::filtering::{
    AlignmentError, BandError, BlockNees, Freedom, NeesBand, NeesError, RootMeanSquares,
    StateError, TrajectoryError, absolute_trajectory_error, align, aligned, attitude_in_world,
    chi_square_band, chi_square_below, chi_square_quantile, nees, nis, pairs_by_distance,
    pairs_by_time, relative_pose_errors,
};
use vislam::inertial::NavState;
use vislam::least_squares::{Factor, Kernel, Key, Manifold, Options, Problem};
use vislam::manifold::{se3, so3};
use vislam::observability::Similarity;
use vislam::simulation::Trajectory;

fn random<const D: usize>(generator: &mut ChaCha8Rng) -> SVector<f64, D> {
    SVector::from_fn(|_, _| StandardNormal.sample(generator))
}

/// The figure-eight, ten states a second.
fn flight() -> Vec<NavState> {
    (0..80).map(|k| Trajectory::figure_eight().at(0.1 * f64::from(k)).state).collect()
}

fn moved(motion: &Similarity, states: &[NavState]) -> Vec<NavState> {
    let still = Vector3::zeros();
    states.iter().map(|state| motion.state(state, &still, &still)).collect()
}

fn rigid(turn: Vector3<f64>, translation: Vector3<f64>) -> Similarity {
    Similarity { scale: 1.0, rotation: so3::exp(&turn), translation }
}

/// Errors of a few centimetres and degrees.
fn noisy(states: &[NavState], generator: &mut ChaCha8Rng) -> Vec<NavState> {
    let step = |_| 0.05 * random::<9>(generator);
    let steps: Vec<_> = states.iter().map(step).collect();
    states.iter().zip(steps).map(|(state, step)| state.retract(step.as_slice())).collect()
}

mod chi_square {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (probability, degrees, expected) in
            [(0.95, 1, 3.841), (0.95, 2, 5.991), (0.025, 41, 25.215), (0.975, 41, 60.561)]
        {
            let quantile = chi_square_quantile(probability, degrees).unwrap();
            assert_abs_diff_eq!(quantile, expected, epsilon = 1e-3);
        }
    }

    #[test]
    fn two_degrees_have_a_formula() {
        for x in [1e-3, 0.1, 1.0, 5.0, 40.0] {
            assert_relative_eq!(chi_square_below(x, 2), -(-0.5 * x).exp_m1(), max_relative = 1e-12);
        }
        let quantile = chi_square_quantile(0.95, 2).unwrap();
        assert_relative_eq!(quantile, -2.0 * 0.05_f64.ln(), max_relative = 1e-9);
    }

    #[test]
    fn a_quantile_undoes_a_probability_for_few_degrees_and_for_many() {
        for degrees in [1, 3, 41, 20_500, 1_000_000] {
            for probability in [1e-6, 5e-4, 0.3, 0.975, 1.0 - 1e-6] {
                let quantile = chi_square_quantile(probability, degrees).unwrap();
                let slack = 1e-9 * quantile.max(1.0);
                let [less, more] =
                    [quantile - slack, quantile + slack].map(|x| chi_square_below(x, degrees));
                assert!((less..=more).contains(&probability), "{less} {probability} {more}");
            }
        }
    }

    #[test]
    fn many_degrees_are_nearly_normal() {
        let [low, high] = chi_square_band(0.001, 20_500).unwrap();
        assert_relative_eq!(0.5 * (high - low), 3.2905 * 41_000_f64.sqrt(), max_relative = 1e-3);
    }

    #[test]
    fn the_ends_of_what_there_is_are_no_fault() {
        assert_eq!(chi_square_below(-1.0, 3), 0.0);
        assert_eq!(chi_square_below(f64::INFINITY, 3), 1.0);
        assert!(chi_square_below(f64::NAN, 3).is_nan() && chi_square_below(f64::NAN, 0).is_nan());
        assert_eq!([chi_square_below(-1.0, 0), chi_square_below(0.0, 0)], [0.0, 1.0]);
        assert_eq!(chi_square_quantile(0.0, 3).unwrap(), 0.0);
        assert_eq!(chi_square_quantile(1.0, 3).unwrap(), f64::INFINITY);
        assert_eq!(chi_square_quantile(0.5, 0).unwrap(), 0.0);
        for wrong in [-0.1, 1.1, f64::NAN] {
            assert!(chi_square_quantile(wrong, 3).is_err() && chi_square_band(wrong, 3).is_err());
        }
    }
}

mod normalized {
    use super::*;

    #[test]
    fn an_error_of_one_standard_deviation_in_every_direction_counts_one() {
        let covariance = Matrix2::new(4.0, 0.0, 0.0, 9.0);
        assert_relative_eq!(nees(&Vector2::new(2.0, -3.0), &covariance).unwrap(), 1.0);
        assert_relative_eq!(nees(&Vector2::new(4.0, 0.0), &covariance).unwrap(), 2.0);
        assert_eq!(
            nees(&Vector2::new(2.0, 1.0), &covariance),
            nis(&Vector2::new(2.0, 1.0), &covariance)
        );
    }

    #[test]
    fn it_is_the_quotient_by_the_inverse() {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let covariance = any_covariance::<5>(&mut generator);
        let error = random::<5>(&mut generator);
        let quotient = error.dot(&(covariance.try_inverse().unwrap() * error)) / 5.0;
        assert_relative_eq!(nees(&error, &covariance).unwrap(), quotient, max_relative = 1e-9);
        let (error, covariance) = (
            DVector::from_column_slice(error.as_slice()),
            DMatrix::from_fn(5, 5, |i, j| covariance[(i, j)]),
        );
        assert_relative_eq!(nees(&error, &covariance).unwrap(), quotient, max_relative = 1e-9);
    }

    #[test]
    fn a_tilt_that_is_known_well_beside_a_yaw_that_is_not_has_its_error() {
        for estimate in flight() {
            let up = estimate.world_from_body.inverse() * Vector3::z();
            let mut covariance = SMatrix::<f64, 9, 9>::identity();
            let turn = 1e-12 * Matrix3::identity() + up * up.transpose();
            covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
            assert!(BlockNees::of(&estimate, &estimate, &covariance).is_ok());
        }
    }

    #[test]
    fn what_is_no_covariance_of_the_error_is_refused() {
        let error = Vector2::new(1.0, 1.0);
        let refused = |covariance| nees(&error, &covariance).unwrap_err();
        let singular = Matrix2::new(1.0, 1.0, 1.0, 1.0);
        assert_eq!(refused(singular), NeesError::NotPositiveDefinite);
        assert_eq!(refused(-Matrix2::identity()), NeesError::NotPositiveDefinite);
        assert_eq!(refused(f64::NAN * singular), NeesError::NotFinite);
        let lopsided = Matrix2::new(1.0, 0.0, 0.5, 1.0);
        assert_eq!(refused(lopsided), NeesError::NotSymmetric { asymmetry: 0.5 });
        let infinite = Vector2::new(f64::INFINITY, 0.0);
        assert_eq!(nees(&infinite, &Matrix2::identity()), Err(NeesError::NotFinite));
        let sizes = nees(&DVector::zeros(2), &DMatrix::identity(3, 3));
        assert_eq!(sizes, Err(NeesError::Sizes { error: 2, rows: 3, columns: 3 }));
        assert_eq!(nees(&DVector::zeros(0), &DMatrix::zeros(0, 0)), Err(NeesError::Empty));
    }

    const RUNS: usize = 200;

    /// Mean over the runs by part: yaw, tilt, velocity, position, and the whole of it, where the
    /// filter says a covariance that is `stated` times the true one.
    fn means(stated: f64) -> [f64; 5] {
        let mut generator = ChaCha8Rng::seed_from_u64(2);
        let mut sums = [0.0; 5];
        for estimate in flight().iter().cycle().take(RUNS) {
            let covariance = 1e-4 * any_covariance::<9>(&mut generator);
            let root = covariance.cholesky().unwrap().l();
            let step = root * random::<9>(&mut generator);
            let truth = estimate.retract(step.as_slice());
            let covariance = stated * covariance;
            let parts = BlockNees::of(estimate, &truth, &covariance).unwrap();
            let whole = nees(&step, &covariance).unwrap();
            let all = [parts.yaw, parts.tilt, parts.velocity, parts.position, whole];
            sums.iter_mut().zip(all).for_each(|(sum, one)| *sum += one);
        }
        sums.map(|sum| sum / RUNS as f64)
    }

    fn bands() -> Vec<NeesBand> {
        NeesBand::family(RUNS, &[1, 2, 3, 3, 9], 0.01).unwrap()
    }

    #[test]
    fn errors_drawn_from_the_covariance_lie_in_all_bands() {
        let means = means(1.0);
        let inside = bands().iter().zip(means).all(|(band, mean)| band.contains(mean));
        assert!(inside, "{means:?} in {:?}", bands());
    }

    #[test]
    fn a_covariance_that_is_four_times_too_large_is_noticed_below_and_one_too_small_above() {
        for (band, [cautious, bold]) in
            bands().iter().zip(means(4.0).into_iter().zip(means(0.25)).map(|(a, b)| [a, b]))
        {
            assert!(cautious < band.low && bold > band.high, "{cautious} {bold} by {band:?}");
        }
    }

    #[test]
    fn parts_of_a_state_do_not_depend_on_the_axes_of_the_body() {
        let mut generator = ChaCha8Rng::seed_from_u64(3);
        let estimate = flight()[17];
        let step = 0.1 * random::<9>(&mut generator);
        let covariance = any_covariance::<9>(&mut generator);
        let truth = estimate.retract(step.as_slice());
        let parts = BlockNees::of(&estimate, &truth, &covariance).unwrap();
        // The same body with other axes: R goes to R C, and φ to Cᵀ φ.
        let other = so3::exp(&random::<3>(&mut generator));
        let turned = |state: &NavState| NavState {
            world_from_body: state.world_from_body * other,
            ..*state
        };
        let mut by_step = SMatrix::<f64, 9, 9>::identity();
        by_step.fixed_view_mut::<3, 3>(0, 0).copy_from(&other.matrix().transpose());
        let covariance = by_step * covariance * by_step.transpose();
        let again = BlockNees::of(&turned(&estimate), &turned(&truth), &covariance).unwrap();
        for (one, two) in [
            (parts.yaw, again.yaw),
            (parts.tilt, again.tilt),
            (parts.velocity, again.velocity),
            (parts.position, again.position),
        ] {
            assert_relative_eq!(one, two, max_relative = 1e-9);
        }
    }

    #[test]
    fn a_body_on_its_side_that_errs_about_its_own_axis_ahead_errs_in_yaw() {
        // Its x axis looks up.
        let up = so3::exp(&Vector3::new(0.0, -FRAC_PI_2, 0.0));
        let estimate = NavState { world_from_body: up, ..NavState::origin() };
        let mut step = [0.0; 9];
        step[0] = 0.02;
        let truth = estimate.retract(&step);
        let error = StateError::between(&estimate, &truth);
        assert_abs_diff_eq!(error.yaw(), 0.02, epsilon = 1e-15);
        assert_abs_diff_eq!(error.tilt(), Vector2::zeros(), epsilon = 1e-15);
        let mut covariance = SMatrix::<f64, 9, 9>::identity();
        covariance[(0, 0)] = 1e-4;
        let parts = BlockNees::of(&estimate, &truth, &covariance).unwrap();
        assert_relative_eq!(parts.yaw, 4.0, max_relative = 1e-9);
        assert_abs_diff_eq!(parts.tilt, 0.0, epsilon = 1e-20);
        let in_world = attitude_in_world(&estimate, &covariance.fixed_view::<3, 3>(0, 0));
        let expected = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1e-4));
        assert_abs_diff_eq!(in_world, expected, epsilon = 1e-15);
    }

    /// Full, with variances of about one.
    fn any_covariance<const D: usize>(generator: &mut ChaCha8Rng) -> SMatrix<f64, D, D> {
        let columns = [(); D].map(|()| random::<D>(generator));
        let factor = SMatrix::<f64, D, D>::from_columns(&columns);
        let product: SMatrix<f64, D, D> =
            factor * factor.transpose() / D as f64 + 0.1 * SMatrix::identity();
        (product + product.transpose()) * 0.5
    }
}

mod bands {
    use super::*;

    /// For 100 runs, by the dimension: yaw, tilt, position.
    #[test]
    fn bands_of_one_test_at_a_time_leave_out_five_percent_each() {
        for (dimension, low, high) in [(1, 0.74, 1.30), (2, 0.81, 1.21), (3, 0.85, 1.17)] {
            let band = NeesBand::new(100, dimension, 0.05).unwrap();
            assert_abs_diff_eq!(band.low, low, epsilon = 0.005);
            assert_abs_diff_eq!(band.high, high, epsilon = 0.005);
        }
    }

    #[test]
    fn bands_of_a_family_are_wider_and_those_of_one_test_are_its_own() {
        let alone = NeesBand::new(100, 3, 0.05).unwrap();
        assert_eq!(NeesBand::family(100, &[3], 0.05).unwrap(), [alone]);
        let family = NeesBand::family(100, &[3; 6], 0.05).unwrap();
        assert_eq!(family, [NeesBand::new(100, 3, 0.05 / 6.0).unwrap(); 6]);
        assert!(family[0].low < alone.low && alone.high < family[0].high);
    }

    #[test]
    fn a_family_of_perfect_estimators_is_rejected_as_often_as_stated_and_no_more() {
        let (families, runs, tests) = (4000, 10, 6);
        let mut generator = ChaCha8Rng::seed_from_u64(4);
        let (mut alone, mut together) = (0, 0);
        let single = NeesBand::new(runs, 3, 0.05).unwrap();
        let family = NeesBand::family(runs, &vec![3; tests], 0.05).unwrap();
        for _ in 0..families {
            let mean = |_| {
                let squares = (0..runs).map(|_| random::<3>(&mut generator).norm_squared() / 3.0);
                squares.sum::<f64>() / runs as f64
            };
            let means: Vec<f64> = (0..tests).map(mean).collect();
            alone += usize::from(means.iter().any(|mean| !single.contains(*mean)));
            together += usize::from(family.iter().zip(&means).any(|(b, mean)| !b.contains(*mean)));
        }
        let share = |count: usize| count as f64 / families as f64;
        // One in four for six tests at five percent; three deviations of a count are 0.02.
        assert_abs_diff_eq!(share(alone), 1.0 - 0.95_f64.powi(6), epsilon = 0.02);
        assert_abs_diff_eq!(share(together), 0.05, epsilon = 0.01);
    }

    #[test]
    fn bands_of_nothing_are_refused() {
        let empty = BandError::Empty { runs: 0, dimension: 3 };
        assert_eq!(NeesBand::new(0, 3, 0.05), Err(empty));
        for outside in [0.0, 1e-17, 1.0, -0.1] {
            assert_eq!(NeesBand::new(9, 3, outside), Err(BandError::Outside { outside }));
            assert_eq!(NeesBand::family(9, &[3], outside), Err(BandError::Outside { outside }));
        }
        for outside in [1e-15, 0.05] {
            assert!(NeesBand::new(9, 3, outside).unwrap().high.is_finite());
        }
        assert!(NeesBand::new(9, 3, f64::NAN).is_err());
        assert!(!NeesBand::new(9, 3, 0.05).unwrap().contains(f64::NAN));
    }
}

mod alignment {
    use super::*;

    #[test]
    fn a_known_yaw_and_shift_are_recovered_and_a_tilt_is_left() {
        let truth = flight();
        for yaw in [0.3, -2.0, 3.1] {
            let motion = rigid(Vector3::new(0.0, 0.0, yaw), Vector3::new(5.0, -7.0, 2.0));
            let world = Similarity { rotation: motion.rotation.inverse(), ..motion };
            let world = Similarity { translation: -(world.rotation * motion.translation), ..world };
            let estimate = moved(&world, &truth);
            let found = align(&estimate, &truth, Freedom::Four).unwrap();
            assert_abs_diff_eq!(found.translation, motion.translation, epsilon = 1e-12);
            assert_abs_diff_eq!(found.rotation, motion.rotation, epsilon = 1e-13);
            // Every attitude is tilted, and no position.
            let tilt = so3::exp(&Vector3::new(0.02, 0.01, 0.0));
            let tilted: Vec<NavState> = truth
                .iter()
                .map(|state| NavState { world_from_body: tilt * state.world_from_body, ..*state })
                .collect();
            let error = absolute_trajectory_error(&moved(&world, &tilted), &truth, Freedom::Four);
            let error = error.unwrap();
            assert_abs_diff_eq!(error.tilt, 0.02_f64.hypot(0.01), epsilon = 1e-12);
            assert_abs_diff_eq!(error.yaw, 0.0, epsilon = 1e-12);
            assert_abs_diff_eq!(error.position, 0.0, epsilon = 1e-12);
        }
    }

    #[test]
    fn six_degrees_recover_any_rigid_motion_and_never_a_reflection() {
        let mut generator = ChaCha8Rng::seed_from_u64(5);
        let truth = flight();
        for _ in 0..20 {
            let motion = rigid(random(&mut generator), 10.0 * random::<3>(&mut generator));
            let found = align(&truth, &moved(&motion, &truth), Freedom::Six).unwrap();
            assert_abs_diff_eq!(found.rotation, motion.rotation, epsilon = 1e-12);
            assert_abs_diff_eq!(found.translation, motion.translation, epsilon = 1e-11);
        }
        let mirrored: Vec<NavState> =
            truth.iter().map(|state| NavState { position: -state.position, ..*state }).collect();
        let found = align(&mirrored, &truth, Freedom::Six).unwrap();
        assert_relative_eq!(found.rotation.matrix().determinant(), 1.0, max_relative = 1e-12);
    }

    /// A position of the estimate in the true world, less the true one.
    struct Turned {
        yaw: Key<Vector1<f64>>,
        shift: Key<Vector3<f64>>,
        estimate: Vector3<f64>,
        truth: Vector3<f64>,
    }

    impl Factor<3> for Turned {
        type Variables = (Vector1<f64>, Vector3<f64>);
        type Jacobians = (Matrix3x1<f64>, Matrix3<f64>);

        fn variables(&self) -> (Key<Vector1<f64>>, Key<Vector3<f64>>) {
            (self.yaw, self.shift)
        }

        fn residual(&self, values: (&Vector1<f64>, &Vector3<f64>)) -> Option<Vector3<f64>> {
            self.linearize(values).map(|(residual, _)| residual)
        }

        fn linearize(
            &self,
            (yaw, shift): (&Vector1<f64>, &Vector3<f64>),
        ) -> Option<(Vector3<f64>, Self::Jacobians)> {
            let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw.x) * self.estimate;
            let by_yaw = Vector3::z().cross(&turned);
            Some((turned + shift - self.truth, (by_yaw, Matrix3::identity())))
        }
    }

    /// The same with all of rotation and translation.
    struct Moved {
        pose: Key<Isometry3<f64>>,
        estimate: Vector3<f64>,
        truth: Vector3<f64>,
    }

    impl Factor<3> for Moved {
        type Variables = (Isometry3<f64>,);
        type Jacobians = (SMatrix<f64, 3, 6>,);

        fn variables(&self) -> (Key<Isometry3<f64>>,) {
            (self.pose,)
        }

        fn residual(&self, pose: (&Isometry3<f64>,)) -> Option<Vector3<f64>> {
            self.linearize(pose).map(|(residual, _)| residual)
        }

        fn linearize(
            &self,
            (pose,): (&Isometry3<f64>,),
        ) -> Option<(Vector3<f64>, Self::Jacobians)> {
            let rotation = pose.rotation.to_rotation_matrix();
            let mut by_twist = SMatrix::<f64, 3, 6>::zeros();
            by_twist.fixed_columns_mut::<3>(0).copy_from(rotation.matrix());
            let by_turn = -rotation.matrix() * so3::hat(&self.estimate);
            by_twist.fixed_columns_mut::<3>(3).copy_from(&by_turn);
            Some((se3::transform(pose, &self.estimate) - self.truth, (by_twist,)))
        }
    }

    /// Its own flight with noise, elsewhere and turned, also out of the vertical.
    fn displaced() -> [Vec<NavState>; 2] {
        let truth = flight();
        let mut generator = ChaCha8Rng::seed_from_u64(6);
        let motion = rigid(Vector3::new(0.05, -0.1, 0.8), Vector3::new(3.0, 1.0, -2.0));
        [moved(&motion, &noisy(&truth, &mut generator)), truth]
    }

    fn exactly() -> Options {
        Options { decrease_tolerance: 1e-15, gradient_tolerance: 1e-10, ..Options::default() }
    }

    #[test]
    fn the_closed_form_in_four_degrees_is_the_numerical_minimum() {
        let [estimate, truth] = displaced();
        let mut problem = Problem::new();
        let yaw = problem.add_variable(Vector1::new(0.0));
        let shift = problem.add_variable(Vector3::zeros());
        for (estimate, truth) in estimate.iter().zip(&truth) {
            let (estimate, truth) = (estimate.position, truth.position);
            problem.add_factor(Turned { yaw, shift, estimate, truth }, Kernel::Squared).unwrap();
        }
        let values = problem.solve(&exactly()).unwrap().values;
        let found = align(&estimate, &truth, Freedom::Four).unwrap();
        assert_abs_diff_eq!(so3::log(&found.rotation).z, values[yaw].x, epsilon = 1e-8);
        assert_abs_diff_eq!(found.translation, values[shift], epsilon = 1e-8);
    }

    #[test]
    fn the_closed_form_in_six_degrees_is_the_numerical_minimum() {
        let [estimate, truth] = displaced();
        let mut problem = Problem::new();
        let pose = problem.add_variable(Isometry3::identity());
        for (estimate, truth) in estimate.iter().zip(&truth) {
            let (estimate, truth) = (estimate.position, truth.position);
            problem.add_factor(Moved { pose, estimate, truth }, Kernel::Squared).unwrap();
        }
        let values = problem.solve(&exactly()).unwrap().values;
        let found = align(&estimate, &truth, Freedom::Six).unwrap();
        let isometry = Isometry3::from_parts(found.translation.into(), found.rotation.into());
        assert_abs_diff_eq!(se3::local(&isometry, &values[pose]), Vector6::zeros(), epsilon = 1e-8);
    }

    #[test]
    fn trajectories_that_leave_the_answer_open_are_refused() {
        let still = vec![NavState::origin(); 5];
        let at = |k: i32, along: Vector3<f64>| NavState {
            position: Vector3::new(10.0, -4.0, 1.0) + f64::from(k) * along,
            ..NavState::origin()
        };
        let climb: Vec<_> = (0..5).map(|k| at(k, Vector3::z())).collect();
        let line: Vec<_> = (0..5).map(|k| at(k, Vector3::new(0.3, 0.7, 0.1))).collect();
        for states in [&still, &climb] {
            assert_eq!(align(states, states, Freedom::Four), Err(AlignmentError::Yaw));
            assert_eq!(align(&line, states, Freedom::Four), Err(AlignmentError::Yaw));
        }
        assert!(align(&line, &line, Freedom::Four).is_ok());
        for states in [&still, &climb, &line] {
            assert_eq!(align(states, states, Freedom::Six), Err(AlignmentError::Rotation));
        }
    }

    #[test]
    fn states_that_do_not_belong_together_are_refused() {
        let truth = flight();
        let both = |estimate: &[NavState], truth: &[NavState]| {
            aligned(estimate, truth, Freedom::Four).unwrap_err()
        };
        let lengths = AlignmentError::Lengths { estimate: 79, truth: 80 };
        assert_eq!(both(&truth[1..], &truth), lengths);
        assert_eq!(both(&truth[..1], &truth[..1]), AlignmentError::TooFew { states: 1 });
        assert_eq!(both(&[], &[]), AlignmentError::TooFew { states: 0 });
        let mut lost = truth.clone();
        lost[3].velocity.x = f64::NAN;
        assert_eq!(both(&lost, &truth), AlignmentError::NotFinite { state: 3 });
        assert_eq!(both(&truth, &lost), AlignmentError::NotFinite { state: 3 });
    }
}

mod absolute {
    use super::*;

    #[test]
    fn an_estimate_without_noise_has_no_error_wherever_its_world_is() {
        let truth = flight();
        let motion = rigid(Vector3::new(0.0, 0.0, 1.2), Vector3::new(-3.0, 8.0, 1.0));
        for estimate in [truth.clone(), moved(&motion, &truth)] {
            for freedom in [Freedom::Four, Freedom::Six] {
                let error = absolute_trajectory_error(&estimate, &truth, freedom).unwrap();
                let RootMeanSquares { position, velocity, rotation, tilt, yaw } = error;
                assert!([position, velocity, rotation, tilt, yaw].iter().all(|e| *e < 1e-12));
            }
        }
    }

    #[test]
    fn six_degrees_hide_a_tilted_world_that_four_leave() {
        let truth = flight();
        let tilted = moved(&rigid(Vector3::new(0.05, 0.0, 0.0), Vector3::zeros()), &truth);
        let four = absolute_trajectory_error(&tilted, &truth, Freedom::Four).unwrap();
        let six = absolute_trajectory_error(&tilted, &truth, Freedom::Six).unwrap();
        assert!(six.position < 1e-12 && six.tilt < 1e-12);
        assert_abs_diff_eq!(four.tilt, 0.05, epsilon = 1e-3);
        assert!(four.position > 0.02);
    }

    #[test]
    fn four_degrees_leave_at_least_as_much_of_the_positions_as_six() {
        let truth = flight();
        for seed in 0..20 {
            let estimate = noisy(&truth, &mut ChaCha8Rng::seed_from_u64(seed));
            let [four, six] = [Freedom::Four, Freedom::Six].map(|freedom| {
                absolute_trajectory_error(&estimate, &truth, freedom).unwrap().position
            });
            assert!(six < four);
        }
    }

    #[test]
    fn errors_do_not_depend_on_where_the_origin_is() {
        let truth = flight();
        let estimate = noisy(&truth, &mut ChaCha8Rng::seed_from_u64(7));
        let far = rigid(Vector3::zeros(), Vector3::new(1000.0, 0.0, 0.0));
        let near = absolute_trajectory_error(&estimate, &truth, Freedom::Four).unwrap();
        let [estimate, truth] = [estimate, truth].map(|states| moved(&far, &states));
        let far = absolute_trajectory_error(&estimate, &truth, Freedom::Four).unwrap();
        assert_relative_eq!(near.position, far.position, max_relative = 1e-9);
        assert_relative_eq!(near.rotation, far.rotation, max_relative = 1e-9);
    }
}

mod relative {
    use super::*;

    /// Five states along x, a metre and a second apart.
    fn line() -> Vec<NavState> {
        let at = |k: i32| NavState {
            velocity: Vector3::x(),
            position: f64::from(k) * Vector3::x(),
            ..NavState::origin()
        };
        (0..5).map(at).collect()
    }

    #[test]
    fn a_trajectory_a_tenth_too_long_errs_by_a_tenth_of_every_stretch() {
        let truth = line();
        let grow = Similarity { scale: 1.1, ..Similarity::identity() };
        let estimate = moved(&grow, &truth);
        for (metres, count) in [(1.0, 4), (2.0, 3), (4.0, 1)] {
            let pairs = pairs_by_distance(&truth, metres).unwrap();
            let errors = relative_pose_errors(&estimate, &truth, &pairs, Freedom::Four).unwrap();
            assert_eq!(errors.len(), count);
            for error in &errors {
                let expected = Vector3::new(-0.1 * metres, 0.0, 0.0);
                assert_abs_diff_eq!(error.position, expected, epsilon = 1e-12);
                assert_abs_diff_eq!(error.rotation, Vector3::zeros(), epsilon = 1e-12);
                assert_abs_diff_eq!(error.velocity.x, -0.1, epsilon = 1e-12);
            }
            let sum = RootMeanSquares::of(&errors).unwrap();
            assert_abs_diff_eq!(sum.position, 0.1 * metres, epsilon = 1e-12);
        }
    }

    #[test]
    fn a_yaw_that_drifts_turns_every_stretch_from_its_first_state_on() {
        let (truth, rate) = (line(), 0.1);
        let drifting = |(k, state): (usize, &NavState)| NavState {
            world_from_body: so3::exp(&Vector3::new(0.0, 0.0, rate * k as f64)),
            ..*state
        };
        let estimate: Vec<_> = truth.iter().enumerate().map(drifting).collect();
        let errors =
            relative_pose_errors(&estimate, &truth, &[(0, 2), (1, 3)], Freedom::Four).unwrap();
        for (first, error) in errors.iter().enumerate() {
            assert_abs_diff_eq!(error.yaw(), -2.0 * rate, epsilon = 1e-12);
            // Two metres, turned back by what had drifted until the first state.
            let chord = 4.0 * (0.5 * rate * first as f64).sin();
            assert_abs_diff_eq!(error.position.norm(), chord, epsilon = 1e-12);
        }
    }

    #[test]
    fn a_tilt_is_left_by_four_degrees_and_becomes_height_by_six() {
        let truth = line();
        let pitched = so3::exp(&Vector3::new(0.0, 0.1, 0.0));
        let tilted = |state: &NavState| NavState { world_from_body: pitched, ..*state };
        let estimate: Vec<_> = truth.iter().map(tilted).collect();
        let error =
            |freedom| relative_pose_errors(&estimate, &truth, &[(0, 2)], freedom).unwrap()[0];
        let (four, six) = (error(Freedom::Four), error(Freedom::Six));
        assert_abs_diff_eq!(four.tilt(), Vector2::new(0.0, -0.1), epsilon = 1e-12);
        assert_abs_diff_eq!(four.position, Vector3::zeros(), epsilon = 1e-12);
        assert_abs_diff_eq!(six.rotation, Vector3::zeros(), epsilon = 1e-12);
        let height = -2.0 * 0.1_f64.sin();
        assert_abs_diff_eq!(six.position.z, height, epsilon = 1e-12);
    }

    #[test]
    fn an_error_at_the_start_spoils_no_later_stretch() {
        let truth = flight();
        let turn = rigid(Vector3::new(0.0, 0.0, 0.2), Vector3::new(0.5, 0.0, 0.0));
        let mut estimate = moved(&turn, &truth);
        estimate[..10].copy_from_slice(&truth[..10]);
        let pairs = pairs_by_distance(&truth, 2.0).unwrap();
        let errors = relative_pose_errors(&estimate, &truth, &pairs, Freedom::Four).unwrap();
        for ((first, last), error) in pairs.iter().zip(&errors) {
            let crosses = *first < 10 && *last >= 10;
            assert_eq!(error.position.norm() > 1e-9, crosses, "{first} {last}");
        }
    }

    #[test]
    fn pairs_by_time_and_by_distance_take_the_first_state_that_is_far_enough() {
        let times: Vec<f64> = (0..6).map(|k| 0.1 * f64::from(k)).collect();
        assert_eq!(pairs_by_time(&times, 0.3).unwrap(), [(0, 3), (1, 4), (2, 5)]);
        assert_eq!(pairs_by_time(&times, 0.35).unwrap(), [(0, 4), (1, 5)]);
        // There and back: the path counts, not how far off the body is.
        let back: Vec<_> = line().into_iter().chain(line().into_iter().rev()).collect();
        let pairs = pairs_by_distance(&back, 4.0).unwrap();
        assert_eq!(pairs, [(0, 4), (1, 6), (2, 7), (3, 8), (4, 9), (5, 9)]);
    }

    #[test]
    fn a_second_is_a_second_by_the_clock_of_a_computer_too() {
        let times: Vec<f64> = (0..500).map(|k| 1.4e9 + 0.05 * f64::from(k)).collect();
        let pairs = pairs_by_time(&times, 1.0).unwrap();
        assert!(pairs.iter().all(|(from, to)| to - from == 20));
        assert_eq!(pairs.len(), 480);
        // Of less than that clock can tell apart, too, no state is a pair with itself.
        let pairs = pairs_by_time(&times, 1e-6).unwrap();
        assert!(pairs.iter().all(|(from, to)| to - from == 1));
    }

    #[test]
    fn what_has_no_relative_error_is_refused() {
        let truth = line();
        let too_long = TrajectoryError::TooShort { whole: 4.0, interval: 5.0 };
        assert_eq!(pairs_by_distance(&truth, 5.0), Err(too_long));
        for interval in [0.0, -1.0, f64::INFINITY] {
            let error = Err(TrajectoryError::Interval { interval });
            assert_eq!(pairs_by_distance(&truth, interval), error);
            assert_eq!(pairs_by_time(&[0.0, 1.0], interval), error);
        }
        let order = Err(TrajectoryError::Order { state: 2 });
        assert_eq!(pairs_by_time(&[0.0, 1.0, 1.0], 1.0), order);
        assert_eq!(pairs_by_time(&[0.0, 1.0, f64::NAN], 1.0), order);
        let at_no_time = Err(TrajectoryError::Order { state: 0 });
        assert_eq!(pairs_by_time(&[f64::NAN], 1.0), at_no_time);
        let mut nowhere = truth.clone();
        nowhere[3].position.z = f64::NAN;
        let at_no_place = AlignmentError::NotFinite { state: 3 };
        assert_eq!(pairs_by_distance(&nowhere, 1.0), Err(at_no_place.into()));
        let errors = |estimate: &[NavState], pair| {
            relative_pose_errors(estimate, &truth, &[pair], Freedom::Four).unwrap_err()
        };
        let missing = TrajectoryError::NoSuchState { state: 5, states: 5 };
        assert_eq!(errors(&truth, (1, 5)), missing);
        let lengths = AlignmentError::Lengths { estimate: 4, truth: 5 };
        assert_eq!(errors(&truth[1..], (0, 1)), TrajectoryError::Alignment(lengths));
        let mut on_its_head = truth.clone();
        on_its_head[2].world_from_body = so3::exp(&Vector3::new(std::f64::consts::PI, 0.0, 0.0));
        assert_eq!(errors(&on_its_head, (2, 3)), TrajectoryError::UpsideDown { state: 2 });
        assert_eq!(RootMeanSquares::of(&[]), None);
    }
}
