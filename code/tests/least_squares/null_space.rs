//! What factors leave free, of few columns and of many.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Vector3};
use vislam::factors::Prior;
use vislam::least_squares::{
    Kernel, Key, LandmarkElimination, NullSpaceError, Options, Problem, SolveError, Spectrum,
};
use vislam::manifold::se3;

use super::{Between, Draws, Linear, Observation, loop_of_poses};

/// Poses of which each is measured against the one before it.
fn chain_of_poses(count: usize) -> (Problem, Vec<Key<Isometry3<f64>>>) {
    let mut draws = Draws::new(40);
    let mut problem = Problem::new();
    let truth: Vec<_> = (0..count).map(|_| se3::exp(&draws.vector())).collect();
    let poses: Vec<_> = truth.iter().map(|pose| problem.add_variable(*pose)).collect();
    for second in 1..count {
        let measured = truth[second - 1].inv_mul(&truth[second]);
        let between = Between { poses: [poses[second - 1], poses[second]], measured };
        problem.add_factor(between, Kernel::Squared).unwrap();
    }
    (problem, poses)
}

/// Poses on a street, each of which sees the points near it.
fn street(count: usize) -> (Problem, Vec<Key<Isometry3<f64>>>) {
    let mut draws = Draws::new(41);
    let mut problem = Problem::new();
    let place = |index: usize| Vector3::new(index as f64, 0.0, 0.0);
    let truth = |index, draws: &mut Draws| {
        let mut pose = se3::exp(&(0.3 * draws.vector()));
        pose.translation.vector += place(index);
        pose
    };
    let poses: Vec<_> =
        (0..count).map(|index| problem.add_variable(truth(index, &mut draws))).collect();
    for index in 0..count {
        let point = problem.add_variable(place(index) + 2.0 * draws.vector::<3>());
        for pose in &poses[index.saturating_sub(3)..(index + 3).min(count)] {
            let in_body =
                se3::transform(&problem.values()[*pose].inverse(), &problem.values()[point]);
            let observation = Observation { pose: *pose, point, in_body };
            problem.add_factor(observation, Kernel::Squared).unwrap();
        }
    }
    (problem, poses)
}

/// Asserts that a problem leaves so many directions free, the same ones by all singular values of
/// its Jacobian and by what the problem itself says, which is found otherwise when columns are
/// many.
fn leaves_free(problem: &Problem, nullity: usize) {
    let null_space = problem.null_space(problem.values()).unwrap();
    let (jacobian, _) = problem.jacobian(problem.values()).unwrap();
    let spectrum = Spectrum::of(&jacobian).unwrap();
    let dense = spectrum.null_space();
    assert_eq!(
        (null_space.nullity(), dense.nullity(), spectrum.zeros),
        (nullity, nullity, nullity)
    );
    for direction in null_space.directions().column_iter() {
        assert!(dense.leaves(&direction.into_owned()) < 1e-8);
        assert!((&jacobian * direction).norm() < 1e-10 * direction.norm() * jacobian.norm());
    }
    for direction in dense.directions().column_iter() {
        assert!(null_space.leaves(&direction.into_owned()) < 1e-8);
    }
    let (least, expected) = (null_space.least_seen.unwrap(), dense.least_seen.unwrap());
    assert!((least / expected - 1.0).abs() < 0.1, "{least} {expected}");
}

/// Few and many: 30 and 408 columns, or near that.
const COUNTS: [usize; 2] = [5, 68];

#[test]
fn a_loop_of_poses_is_free_in_six_directions_and_with_an_anchor_in_none() {
    for count in COUNTS {
        let (mut problem, poses, _) = loop_of_poses(count, 0.1);
        leaves_free(&problem, 6);
        problem.hold(poses[count / 2]).unwrap();
        leaves_free(&problem, 0);
    }
}

#[test]
fn a_chain_of_poses_is_free_in_six_directions_and_with_an_anchor_in_none() {
    for count in COUNTS {
        let (mut problem, poses) = chain_of_poses(count);
        leaves_free(&problem, 6);
        problem.hold(poses[0]).unwrap();
        leaves_free(&problem, 0);
    }
}

#[test]
fn a_street_of_poses_and_points_is_free_in_six_directions_and_with_an_anchor_in_none() {
    for count in [6, 46] {
        let (mut problem, poses) = street(count);
        leaves_free(&problem, 6);
        problem.hold(poses[0]).unwrap();
        leaves_free(&problem, 0);
    }
}

#[test]
fn two_chains_that_do_not_meet_are_free_in_twelve_directions() {
    for count in COUNTS {
        let mut problem = Problem::new();
        let mut draws = Draws::new(42);
        for _ in 0..2 {
            let start: Vec<Isometry3<f64>> =
                (0..count / 2 + 1).map(|_| se3::exp(&draws.vector())).collect();
            let poses: Vec<_> = start.iter().map(|pose| problem.add_variable(*pose)).collect();
            for pair in poses.windows(2) {
                let measured = problem.values()[pair[0]].inv_mul(&problem.values()[pair[1]]);
                let between = Between { poses: [pair[0], pair[1]], measured };
                problem.add_factor(between, Kernel::Squared).unwrap();
            }
        }
        leaves_free(&problem, 12);
    }
}

#[test]
fn tied_poses_share_their_freedom() {
    for count in COUNTS {
        let (mut problem, poses) = chain_of_poses(count);
        problem.hold(poses[0]).unwrap();
        problem.tie(poses[1], poses[count - 1]).unwrap();
        leaves_free(&problem, 0);
    }
}

#[test]
fn the_free_directions_of_a_loop_are_motions_of_the_whole_world() {
    let (problem, poses, _) = loop_of_poses(5, 0.1);
    let null_space = problem.null_space(problem.values()).unwrap();
    let mut draws = Draws::new(43);
    for _ in 0..10 {
        let xi = draws.vector::<6>();
        let carried =
            |pose: Key<Isometry3<f64>>| se3::adjoint(&problem.values()[pose].inverse()) * xi;
        let parts: Vec<f64> =
            poses.iter().flat_map(|pose| carried(*pose).as_slice().to_vec()).collect();
        assert!(null_space.leaves(&DVector::from_vec(parts)) < 1e-12);
        let one_alone = DVector::from_fn(30, |row, _| if row < 6 { xi[row] } else { 0.0 });
        assert!(null_space.leaves(&one_alone) > 0.1);
    }
}

/// Two vectors of which the sum is measured, and the second a little, beside as many more vectors
/// as are wanted.
fn a_little_measured(little: f64, more: usize) -> Problem {
    let mut problem = Problem::new();
    let vectors = [(); 3].map(|()| problem.add_variable(Vector3::<f64>::zeros()));
    let (one, zero) = (Matrix3::identity(), Matrix3::zeros());
    for blocks in [[one, one, zero], [zero, little * one, zero], [zero, zero, one]] {
        let linear = Linear { vectors, blocks, measured: Vector3::zeros() };
        problem.add_factor(linear, Kernel::Squared).unwrap();
    }
    for _ in 0..more {
        let variable = problem.add_variable(Vector3::zeros());
        let prior =
            Prior { variable, anchor: Vector3::zeros(), sqrt_information: Matrix3::identity() };
        problem.add_factor(prior, Kernel::Squared).unwrap();
    }
    problem
}

/// Few columns, and many.
const MORE: [usize; 2] = [0, 140];

#[test]
fn a_singular_value_in_the_gap_is_neither_zero_nor_seen_and_the_error_says_so() {
    for more in MORE {
        let problem = a_little_measured(1e-12, more);
        let error = problem.null_space(problem.values()).unwrap_err();
        let SolveError::NullSpace(NullSpaceError::NoGap { value }) = error else {
            panic!("{error}")
        };
        // By hand: ε/√2 beside √2.
        assert!((value / 5e-13 - 1.0).abs() < 0.01, "{value}");
        let covariance = problem.covariance(problem.values()).unwrap_err();
        assert!(matches!(covariance, SolveError::NullSpace(_)), "{covariance}");
    }
}

#[test]
fn beside_the_gap_there_is_an_answer() {
    for more in MORE {
        for (little, free) in [(0.0, 3), (1e-14, 3), (1e-9, 0), (1e-6, 0)] {
            let problem = a_little_measured(little, more);
            let null_space = problem.null_space(problem.values()).unwrap();
            assert_eq!(null_space.nullity(), free, "{little} {more}");
            let least = null_space.least_seen.unwrap();
            let expected = if free == 0 { 0.5 * little } else { 1.0 / f64::sqrt(2.0) };
            assert!((least / expected - 1.0).abs() < 0.05, "{least} for {expected}");
        }
    }
}

#[test]
fn the_square_of_a_jacobian_forgets_what_the_jacobian_sees() {
    let problem = a_little_measured(1e-9, 0);
    let hessian = problem.linearize(problem.values()).unwrap().hessian;
    assert_eq!(hessian[(3, 3)], 1.0, "the square of the small slope is lost");
    assert_eq!(problem.null_space(problem.values()).unwrap().nullity(), 0);
    let covariance = problem.covariance(problem.values()).unwrap();
    assert!((covariance.matrix()[(3, 3)] / 1e18 - 1.0).abs() < 1e-6);
}

#[test]
fn normal_equations_that_forget_the_weakest_direction_are_an_error_that_says_so() {
    for more in MORE {
        let problem = a_little_measured(1e-9, more);
        let error = problem.solve(&Options::gauss_newton()).unwrap_err();
        let SolveError::LostToRounding { least_seen } = error else { panic!("{error}") };
        assert!((least_seen / 5e-10 - 1.0).abs() < 0.05, "{least_seen}");
        assert!(error.to_string().starts_with("the weakest singular value"));
        assert!(problem.solve(&Options::default()).is_ok());
    }
}

#[test]
fn the_residual_is_that_beside_the_jacobian() {
    let (mut problem, poses, _) = loop_of_poses(5, 0.1);
    problem.hold(poses[0]).unwrap();
    let shift = DVector::from_fn(problem.values().dimension(), |row, _| 0.1 * (row as f64).sin());
    let values = problem.values().retract(shift.as_slice());
    assert_eq!(problem.residual(&values).unwrap(), problem.jacobian(&values).unwrap().1);
    let other = a_little_measured(1.0, 0);
    let error = problem.residual(other.values()).unwrap_err();
    assert!(matches!(error, SolveError::WrongValues { .. }), "{error}");
}

/// Numbers that look random.
fn entry(seed: usize) -> impl FnMut(usize, usize) -> f64 {
    move |row, column| {
        let x = (1 + row * 31 + column * 17 + seed * 101) as f64;
        2.0 * (x.sin() * 43_758.545_3).fract()
    }
}

#[test]
fn a_matrix_that_lacks_rank_has_as_many_zeros_and_its_own_null_space() {
    for seed in 0..300 {
        let missing = seed % 4;
        let thin = DMatrix::from_fn(20, 8 - missing, entry(seed));
        let matrix = thin * DMatrix::from_fn(8 - missing, 8, entry(seed + 1000));
        let spectrum = Spectrum::of(&matrix).unwrap();
        assert_eq!(spectrum.zeros, missing);
        assert!(spectrum.singular_values.is_sorted());
        let directions = spectrum.null_space().directions();
        assert!((&matrix * &directions).norm() <= 1e-13 * matrix.norm() * directions.norm());
        if let Some(covariance) = spectrum.covariance() {
            let identity = matrix.tr_mul(&matrix) * covariance;
            assert!((identity - DMatrix::identity(8, 8)).norm() < 1e-6, "{seed}");
        }
    }
}

#[test]
fn small_singular_values_are_right_beside_large_ones() {
    // Pairs of unit vectors at an angle θ, whose values are √2 sin θ/2 and √2 cos θ/2, turned.
    let angles = [1.0, 1e-2, 1e-4, 1e-6, 1e-8];
    let mut pairs = DMatrix::zeros(10, 10);
    let mut values = Vec::new();
    for (at, angle) in angles.iter().enumerate() {
        let (sine, cosine) = f64::sin_cos(*angle);
        pairs.view_mut((2 * at, 2 * at), (1, 2)).copy_from_slice(&[1.0, cosine]);
        pairs[(2 * at + 1, 2 * at + 1)] = sine;
        values.extend([f64::sin(0.5 * angle), f64::cos(0.5 * angle)]);
    }
    values.sort_by(f64::total_cmp);
    let turned = DMatrix::from_fn(12, 10, entry(7)).qr().q() * pairs;
    let found = Spectrum::of(&turned).unwrap().singular_values;
    for (found, value) in found.iter().zip(&values) {
        assert!((found - value / values[9]).abs() < 2e-15, "{found} for {value}");
    }
}

#[test]
fn gauss_newton_refuses_what_is_free_among_many_columns_too() {
    let (problem, _) = chain_of_poses(68);
    let error = problem.solve(&Options::gauss_newton()).unwrap_err();
    let SolveError::Singular(singular) = error else { panic!("{error}") };
    assert_eq!((singular.free, singular.dimension), (6, 408));
    let gram = singular.basis.tr_mul(&singular.basis);
    assert!((gram - DMatrix::identity(6, 6)).amax() < 1e-12);
}

#[test]
fn a_jacobian_that_is_not_finite_has_no_spectrum() {
    let jacobian = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, f64::NAN]);
    assert_eq!(Spectrum::of(&jacobian), Err(NullSpaceError::NotFinite { row: 1 }));
}

#[test]
fn what_no_factor_depends_on_is_all_free() {
    let jacobian = DMatrix::<f64>::zeros(4, 3);
    let null_space = Spectrum::of(&jacobian).unwrap().null_space();
    assert_eq!((null_space.nullity(), null_space.least_seen), (3, None));
}

#[test]
fn landmarks_in_different_places_of_one_type_of_factor_are_refused() {
    let mut problem = Problem::new();
    let points = [(); 4].map(|()| problem.add_variable(Vector3::<f64>::zeros()));
    let [first, second, held, also_held] = points;
    problem.hold(held).unwrap();
    problem.hold(also_held).unwrap();
    for vectors in [[first, held, also_held], [held, second, also_held]] {
        let linear = Linear { vectors, blocks: [Matrix3::identity(); 3], measured: Vector3::x() };
        problem.add_factor(linear, Kernel::Squared).unwrap();
    }
    let error = LandmarkElimination::<6>::new::<Vector3<f64>>(&problem).unwrap_err();
    let said = "factor 1 has its landmark in another place than others of its type";
    assert_eq!(error.to_string(), said);
}
