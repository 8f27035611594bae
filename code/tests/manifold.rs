//! Worked examples of rotations, poses and the small vectors between them, and their
//! accuracy against the power series that define them, summed in many digits.

use std::f64::consts::{PI, TAU};

use approx::assert_abs_diff_eq;
use nalgebra::{
    Isometry3, Matrix3, Matrix6, Quaternion, Rotation3, UnitQuaternion, Vector3, Vector6,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::manifold::{se3, so3};

use oracle::Truth;

/// What the module promises.
const PROMISE: f64 = 1e-14;

// ANCHOR: worked_example
#[test]
fn a_quarter_turn_about_z_takes_x_to_y() {
    let quarter = Vector3::new(0.0, 0.0, PI / 2.0);
    let rotation = so3::exp(&quarter);
    assert_abs_diff_eq!(rotation * Vector3::x(), Vector3::y(), epsilon = 1e-15);
    assert_abs_diff_eq!(so3::log(&rotation), quarter, epsilon = 1e-15);
}
// ANCHOR_END: worked_example

// ANCHOR: worked_jacobian
#[test]
fn after_a_quarter_turn_a_step_is_shorter_and_half_the_angle_behind() {
    let quarter = Vector3::new(0.0, 0.0, PI / 2.0);
    let jacobian = so3::right_jacobian(&quarter);
    let corrected = 2.0 / PI * Vector3::new(1.0, -1.0, 0.0);
    assert_abs_diff_eq!(jacobian * Vector3::x(), corrected, epsilon = 1e-15);
    assert_abs_diff_eq!(jacobian * Vector3::z(), Vector3::z(), epsilon = 1e-15);
}
// ANCHOR_END: worked_jacobian

// ANCHOR: worked_arc
#[test]
fn a_twist_that_turns_while_it_moves_follows_an_arc() {
    // One metre forward for each radian of the turn: a circle with a radius of 1 m.
    let twist = Vector6::new(PI / 2.0, 0.0, 0.0, 0.0, 0.0, PI / 2.0);
    let pose = se3::exp(&twist);
    assert_abs_diff_eq!(pose.translation.vector, Vector3::new(1.0, 1.0, 0.0), epsilon = 1e-15);
    assert_abs_diff_eq!(se3::log(&pose), twist, epsilon = 1e-15);
}
// ANCHOR_END: worked_arc

#[test]
fn a_transform_moves_a_point_that_the_operator_only_turns() {
    let pose = se3::exp(&Vector6::new(0.3, -0.2, 0.5, 0.4, 0.1, -0.6));
    let point = Vector3::new(1.0, 2.0, 3.0);
    let moved = se3::transform(&pose, &point);
    let by_matrix = (pose.to_homogeneous() * point.push(1.0)).xyz();
    assert_abs_diff_eq!(moved, by_matrix, epsilon = 1e-15);
    assert_abs_diff_eq!(moved, (pose * nalgebra::Point3::from(point)).coords, epsilon = 1e-15);
    assert_abs_diff_eq!(moved - pose * point, pose.translation.vector, epsilon = 1e-15);
}

#[test]
fn hat_is_the_cross_product_and_vee_undoes_it() {
    for (phi, other) in rotation_vectors().into_iter().zip(rotation_vectors().into_iter().rev()) {
        assert_eq!(so3::hat(&phi) * other, phi.cross(&other));
        assert_eq!(so3::vee(&so3::hat(&phi)), phi);
    }
}

#[test]
fn vee_of_any_matrix_is_that_of_its_skew_symmetric_part() {
    let matrix = Matrix3::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0);
    assert_eq!(so3::vee(&matrix), Vector3::new(1.0, -2.0, 1.0));
}

#[test]
fn the_rotation_of_a_vector_is_its_power_series() {
    let (mut whole, mut skew) = (Worst::default(), Worst::default());
    for phi in rotation_vectors() {
        let truth = Truth::of(&so3::hat(&phi)).exp();
        let computed = so3::exp(&phi).into_inner();
        whole.add(truth.relative_error(&computed));
        if phi.norm() < 1.0 {
            skew.add(
                truth.minus_transpose().relative_error_of(&Truth::of(&computed).minus_transpose()),
            );
        }
    }
    whole.assert_below(PROMISE, "so3::exp");
    skew.assert_below(PROMISE, "so3::exp, skew part below 1 rad");
}

#[test]
fn the_quaternion_of_a_vector_is_its_power_series() {
    let (mut whole, mut imaginary) = (Worst::default(), Worst::default());
    for phi in rotation_vectors() {
        let truth = true_quaternion(&phi);
        let computed = *so3::exp_quaternion(&phi).quaternion();
        let computed = [computed.w, computed.i, computed.j, computed.k];
        whole.add(truth.relative_error_of(&Truth::column(&computed)));
        imaginary.add(truth.rows(1..4).relative_error_of(&Truth::column(&computed[1..])));
    }
    whole.assert_below(PROMISE, "so3::exp_quaternion");
    imaginary.assert_below(PROMISE, "so3::exp_quaternion, imaginary part");
}

#[test]
fn the_vector_of_a_rotation_is_the_one_it_was_made_of() {
    let (mut matrix, mut quaternion) = (Worst::default(), Worst::default());
    for phi in rotation_vectors().into_iter().filter(|phi| PI - phi.norm() > 5e-16) {
        let truth = Truth::column(phi.as_slice());
        let log =
            so3::log(&Rotation3::from_matrix_unchecked(Truth::of(&so3::hat(&phi)).exp().rounded()));
        matrix.add(truth.relative_error(&log));
        let log = so3::log_quaternion(&rounded_quaternion(&phi));
        quaternion.add(truth.relative_error(&log));
    }
    matrix.assert_below(PROMISE, "so3::log");
    quaternion.assert_below(PROMISE, "so3::log_quaternion");
}

#[test]
fn the_rotation_of_the_vector_of_a_rotation_is_that_rotation_up_to_pi() {
    let (mut matrix, mut quaternion) = (Worst::default(), Worst::default());
    for phi in rotation_vectors() {
        let truth = Truth::of(&so3::hat(&phi)).exp();
        let log = so3::log(&Rotation3::from_matrix_unchecked(truth.rounded()));
        matrix.add(truth.relative_error_of(&Truth::of(&so3::hat(&log)).exp()));
        let log = so3::log_quaternion(&rounded_quaternion(&phi));
        quaternion.add(truth.relative_error_of(&Truth::of(&so3::hat(&log)).exp()));
    }
    matrix.assert_below(PROMISE, "exp(so3::log(R)) against R");
    quaternion.assert_below(PROMISE, "exp(so3::log_quaternion(q)) against R");
}

#[test]
fn half_turns_have_a_vector_of_length_pi() {
    let mut random = Random::new(3);
    for _ in 0..1000 {
        let axis = random.direction(1.0);
        let half_turn = 2.0 * axis * axis.transpose() - Matrix3::identity();
        let log = so3::log(&Rotation3::from_matrix_unchecked(half_turn));
        assert_abs_diff_eq!(log.norm(), PI, epsilon = 2e-15);
        assert_abs_diff_eq!(so3::exp(&log).into_inner(), half_turn, epsilon = 4e-15);
    }
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        let half_turn = 2.0 * axis * axis.transpose() - Matrix3::identity();
        let log = so3::log(&Rotation3::from_matrix_unchecked(half_turn));
        assert_eq!(log, PI * axis);
    }
}

#[test]
fn angles_beyond_pi_come_back_the_shorter_way_round() {
    let mut random = Random::new(4);
    for _ in 0..1000 {
        let axis = random.direction(1.0);
        let angle = random.uniform(PI + 1e-3..TAU);
        let shorter = (angle - TAU) * axis;
        assert_abs_diff_eq!(so3::log(&so3::exp(&(angle * axis))), shorter, epsilon = 4e-15);
        let quaternion = so3::exp_quaternion(&(angle * axis));
        assert_abs_diff_eq!(so3::log_quaternion(&quaternion), shorter, epsilon = 4e-15);
    }
}

#[test]
fn the_identity_has_the_vector_zero() {
    assert_eq!(so3::log(&Rotation3::identity()), Vector3::zeros());
    assert_eq!(so3::exp(&Vector3::zeros()), Rotation3::identity());
    assert_eq!(se3::log(&Isometry3::identity()), Vector6::zeros());
    assert_eq!(se3::exp(&Vector6::zeros()), Isometry3::identity());
    assert_eq!(se3::left_jacobian(&Vector6::zeros()), Matrix6::identity());
    assert_eq!(se3::left_jacobian_inverse(&Vector6::zeros()), Matrix6::identity());
}

#[test]
fn the_jacobians_of_rotations_are_their_power_series() {
    let mut errors: [Worst; 4] = Default::default();
    for phi in rotation_vectors() {
        let left = Truth::of(&so3::hat(&phi)).jacobian();
        let right = Truth::of(&so3::hat(&-phi)).jacobian();
        errors[0].add(left.relative_error(&so3::left_jacobian(&phi)));
        errors[1].add(right.relative_error(&so3::right_jacobian(&phi)));
        let inverse = so3::left_jacobian_inverse(&phi);
        errors[2].add(left.inverse_near(&inverse).relative_error(&inverse));
        let inverse = so3::right_jacobian_inverse(&phi);
        errors[3].add(right.inverse_near(&inverse).relative_error(&inverse));
    }
    errors[0].assert_below(PROMISE, "so3::left_jacobian");
    errors[1].assert_below(PROMISE, "so3::right_jacobian");
    errors[2].assert_below(PROMISE, "so3::left_jacobian_inverse");
    errors[3].assert_below(PROMISE, "so3::right_jacobian_inverse");
}

#[test]
fn exp_and_right_jacobian_at_once_are_the_same_as_one_by_one() {
    for phi in rotation_vectors() {
        let one_by_one = (so3::exp(&phi), so3::right_jacobian(&phi));
        assert_eq!(so3::exp_with_right_jacobian(&phi), one_by_one);
    }
}

#[test]
fn the_pose_of_a_twist_is_its_power_series() {
    let (mut rotation, mut translation) = (Worst::default(), Worst::default());
    for xi in twists() {
        let truth = Truth::of(&se3::hat(&xi)).exp();
        let computed = se3::exp(&xi).to_homogeneous();
        rotation.add(truth.block_error(&computed, 0..3, 0..3));
        translation.add(truth.block_error(&computed, 0..3, 3..4));
    }
    rotation.assert_below(PROMISE, "se3::exp, rotation");
    translation.assert_below(PROMISE, "se3::exp, translation");
}

#[test]
fn the_twist_of_a_pose_is_the_one_it_was_made_of() {
    let (mut rotation, mut translation) = (Worst::default(), Worst::default());
    for xi in twists().into_iter().filter(|xi| PI - angle(xi) > 5e-16) {
        let log = se3::log(&rounded_pose(&xi));
        let truth = Truth::column(xi.as_slice());
        translation.add(truth.block_error(&log, 0..3, 0..1));
        rotation.add(truth.block_error(&log, 3..6, 0..1));
    }
    translation.assert_below(PROMISE, "se3::log, translation");
    rotation.assert_below(PROMISE, "se3::log, rotation");
}

#[test]
fn the_pose_of_the_twist_of_a_pose_is_that_pose_up_to_pi() {
    let (mut rotation, mut translation) = (Worst::default(), Worst::default());
    for xi in twists() {
        let truth = Truth::of(&se3::hat(&xi)).exp();
        let again = Truth::of(&se3::hat(&se3::log(&rounded_pose(&xi)))).exp().rounded();
        rotation.add(truth.block_error::<4, 4>(&again, 0..3, 0..3));
        translation.add(truth.block_error::<4, 4>(&again, 0..3, 3..4));
    }
    rotation.assert_below(PROMISE, "exp(se3::log(T)) against T, rotation");
    translation.assert_below(PROMISE, "exp(se3::log(T)) against T, translation");
}

#[test]
fn the_jacobians_of_poses_are_their_power_series() {
    let mut diagonal: [Worst; 4] = Default::default();
    let mut corner: [Worst; 4] = Default::default();
    for xi in twists() {
        let left = Truth::of(&ad(&xi)).jacobian();
        let right = Truth::of(&ad(&-xi)).jacobian();
        let inverses = [se3::left_jacobian_inverse(&xi), se3::right_jacobian_inverse(&xi)];
        let cases = [
            (se3::left_jacobian(&xi), left.clone()),
            (se3::right_jacobian(&xi), right.clone()),
            (inverses[0], left.inverse_near(&inverses[0])),
            (inverses[1], right.inverse_near(&inverses[1])),
        ];
        for (k, (computed, truth)) in cases.iter().enumerate() {
            diagonal[k].add(truth.block_error(computed, 0..3, 0..3));
            diagonal[k].add(truth.block_error(computed, 3..6, 3..6));
            corner[k].add(truth.block_error(computed, 0..3, 3..6));
            assert_eq!(computed.fixed_view::<3, 3>(3, 0), Matrix3::zeros());
        }
    }
    let names = ["left", "right", "left inverse", "right inverse"];
    for (k, name) in names.iter().enumerate() {
        diagonal[k].assert_below(PROMISE, &format!("se3 {name} jacobian, diagonal"));
        corner[k].assert_below(PROMISE, &format!("se3 {name} jacobian, corner"));
    }
}

#[test]
fn beyond_pi_the_exponential_and_the_jacobians_are_their_power_series_still() {
    let (mut exp, mut jacobian, mut inverse) =
        (Worst::default(), Worst::default(), Worst::default());
    let mut random = Random::new(13);
    for k in 0..60 {
        let phi = random.direction(PI + f64::from(k) / 20.0);
        let rho = random.direction(1.0);
        let xi = Vector6::new(rho.x, rho.y, rho.z, phi.x, phi.y, phi.z);
        let truth = Truth::of(&se3::hat(&xi)).exp();
        exp.add(truth.relative_error(&se3::exp(&xi).to_homogeneous()));
        let truth = Truth::of(&ad(&xi)).jacobian();
        jacobian.add(truth.relative_error(&se3::left_jacobian(&xi)));
        let computed = se3::left_jacobian_inverse(&xi);
        inverse.add(truth.inverse_near(&computed).relative_error(&computed));
    }
    exp.assert_below(PROMISE, "se3::exp beyond π");
    jacobian.assert_below(PROMISE, "se3::left_jacobian beyond π");
    inverse.assert_below(PROMISE, "se3::left_jacobian_inverse beyond π");
}

#[test]
fn the_right_jacobian_of_a_rotation_is_the_derivative_of_exp() {
    let mut random = Random::new(5);
    for _ in 0..1000 {
        let phi = random.rotation_vector();
        let rotation = so3::exp(&phi);
        let numerical = Matrix3::from_columns(&[0, 1, 2].map(|k| {
            let step = 1e-5 * Vector3::ith(k, 1.0);
            let forward = so3::local(&rotation, &so3::exp(&(phi + step)));
            let backward = so3::local(&rotation, &so3::exp(&(phi - step)));
            (forward - backward) / 2e-5
        }));
        assert_abs_diff_eq!(so3::right_jacobian(&phi), numerical, epsilon = 1e-9);
    }
}

#[test]
fn the_right_jacobian_of_a_pose_is_the_derivative_of_exp() {
    let mut random = Random::new(6);
    for _ in 0..1000 {
        let xi = random.twist();
        let pose = se3::exp(&xi);
        let numerical = Matrix6::from_columns(&[0, 1, 2, 3, 4, 5].map(|k| {
            let step = 1e-5 * Vector6::ith(k, 1.0);
            let forward = se3::local(&pose, &se3::exp(&(xi + step)));
            let backward = se3::local(&pose, &se3::exp(&(xi - step)));
            (forward - backward) / 2e-5
        }));
        assert_abs_diff_eq!(se3::right_jacobian(&xi), numerical, epsilon = 1e-8);
    }
}

#[test]
fn the_right_inverse_jacobian_is_the_derivative_of_log() {
    let mut random = Random::new(7);
    for _ in 0..1000 {
        let xi = random.twist();
        let pose = se3::exp(&xi);
        let numerical = Matrix6::from_columns(&[0, 1, 2, 3, 4, 5].map(|k| {
            let step = 1e-5 * Vector6::ith(k, 1.0);
            let forward = se3::log(&se3::retract(&pose, &step));
            let backward = se3::log(&se3::retract(&pose, &-step));
            (forward - backward) / 2e-5
        }));
        assert_abs_diff_eq!(se3::right_jacobian_inverse(&xi), numerical, epsilon = 1e-8);
    }
}

#[test]
fn the_derivatives_of_the_rotation_jacobians_are_their_differences() {
    let mut random = Random::new(8);
    for _ in 0..1000 {
        let (phi, rho) = (random.rotation_vector(), random.direction(1.0));
        let (after, before) = (phi + 1e-5 * rho, phi - 1e-5 * rho);
        let numerical = (so3::left_jacobian(&after) - so3::left_jacobian(&before)) / 2e-5;
        let derivative = so3::left_jacobian_derivative(&phi, &rho);
        assert_abs_diff_eq!(derivative, numerical, epsilon = 1e-9);
        let (after, before) =
            (so3::left_jacobian_inverse(&after), so3::left_jacobian_inverse(&before));
        let derivative = so3::left_jacobian_inverse_derivative(&phi, &rho);
        assert_abs_diff_eq!(derivative, (after - before) / 2e-5, epsilon = 1e-9);
    }
}

#[test]
fn left_and_right_jacobians_of_a_rotation_differ_by_the_rotation() {
    let mut random = Random::new(9);
    for _ in 0..1000 {
        let phi = random.rotation_vector();
        let left = so3::left_jacobian(&phi);
        let right = so3::right_jacobian(&phi);
        assert_eq!(left, so3::right_jacobian(&-phi));
        assert_abs_diff_eq!(left, so3::exp(&phi) * right, epsilon = 2e-15);
        let identity = left * so3::left_jacobian_inverse(&phi);
        assert_abs_diff_eq!(identity, Matrix3::identity(), epsilon = 4e-15);
    }
}

#[test]
fn left_and_right_jacobians_of_a_pose_differ_by_the_adjoint() {
    let mut random = Random::new(10);
    for _ in 0..1000 {
        let xi = random.twist();
        let left = se3::left_jacobian(&xi);
        let right = se3::right_jacobian(&xi);
        assert_eq!(left, se3::right_jacobian(&-xi));
        assert_abs_diff_eq!(left, se3::adjoint(&se3::exp(&xi)) * right, epsilon = 1e-13);
        let identity = left * se3::left_jacobian_inverse(&xi);
        assert_abs_diff_eq!(identity, Matrix6::identity(), epsilon = 1e-13);
    }
}

#[test]
fn the_adjoint_moves_a_twist_to_the_other_side_of_a_pose() {
    let mut random = Random::new(11);
    for _ in 0..1000 {
        let (pose, xi) = (se3::exp(&random.twist()), random.twist());
        let right = pose * se3::exp(&xi);
        let left = se3::exp(&(se3::adjoint(&pose) * xi)) * pose;
        assert_abs_diff_eq!(left.to_homogeneous(), right.to_homogeneous(), epsilon = 1e-12);
    }
}

#[test]
fn local_finds_what_retract_was_given() {
    let mut random = Random::new(12);
    for _ in 0..1000 {
        let (first, phi) = (so3::exp(&random.rotation_vector()), random.rotation_vector());
        let moved = so3::retract(&first, &phi);
        assert_abs_diff_eq!(so3::local(&first, &moved), phi, epsilon = 1e-13);
        let (first, xi) = (se3::exp(&random.twist()), random.twist());
        let moved = se3::retract(&first, &xi);
        assert_abs_diff_eq!(se3::local(&first, &moved), xi, epsilon = 1e-12);
    }
}

#[test]
fn nan_comes_out_where_nan_goes_in() {
    for k in 0..3 {
        let mut phi = Vector3::new(0.1, 0.2, 0.3);
        phi[k] = f64::NAN;
        assert!(so3::exp(&phi).matrix().iter().any(|x| x.is_nan()));
        assert!(so3::left_jacobian(&phi).iter().any(|x| x.is_nan()));
        assert!(so3::left_jacobian_inverse(&phi).iter().any(|x| x.is_nan()));
        assert!(so3::log_quaternion(&so3::exp_quaternion(&phi)).iter().all(|x| x.is_nan()));
    }
    for k in 0..9 {
        let mut matrix = Matrix3::identity();
        matrix[k] = f64::NAN;
        let log = so3::log(&Rotation3::from_matrix_unchecked(matrix));
        assert!(log.iter().all(|x| x.is_nan()), "{matrix}");
    }
    for k in 0..6 {
        let mut xi = Vector6::repeat(0.1);
        xi[k] = f64::NAN;
        assert!(se3::log(&se3::exp(&xi)).iter().any(|x| x.is_nan()));
        assert!(se3::left_jacobian(&xi).iter().any(|x| x.is_nan()));
        assert!(se3::left_jacobian_inverse(&xi).iter().any(|x| x.is_nan()));
    }
}

/// Angles from 1e-300 to π and up to π, about five axes.
fn rotation_vectors() -> Vec<Vector3<f64>> {
    let spread = (0..=200).map(|k| PI * 10_f64.powf(-1.5 * f64::from(k)));
    let usual = (0..50).map(|k| PI * 10_f64.powf(-f64::from(k) / 5.0));
    let near_pi = (0..=16).map(|k| PI - 10_f64.powi(-k));
    let angles: Vec<f64> = spread.chain(usual).chain(near_pi).collect();
    let mut random = Random::new(1);
    let mut axes = vec![Vector3::x(), Vector3::y(), Vector3::z()];
    axes.extend((0..2).map(|_| random.direction(1.0)));
    axes.iter().flat_map(|axis| angles.iter().map(move |&angle| angle * axis)).collect()
}

/// The same rotations, each with a translation between a millimetre and a kilometre.
fn twists() -> Vec<Vector6<f64>> {
    let mut random = Random::new(2);
    let with_translation = |phi: Vector3<f64>| {
        let length = 10_f64.powf(random.uniform(-3.0..3.0));
        let rho = random.direction(length);
        Vector6::new(rho.x, rho.y, rho.z, phi.x, phi.y, phi.z)
    };
    rotation_vectors().into_iter().map(with_translation).collect()
}

fn angle(xi: &Vector6<f64>) -> f64 {
    xi.fixed_rows::<3>(3).norm()
}

/// The 6×6 matrix that multiplies a twist as the commutator of their 4×4 matrices does.
fn ad(xi: &Vector6<f64>) -> Matrix6<f64> {
    let rho = so3::hat(&xi.fixed_rows::<3>(0).into());
    let phi = so3::hat(&xi.fixed_rows::<3>(3).into());
    let mut matrix = Matrix6::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&phi);
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&rho);
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&phi);
    matrix
}

/// The exponential of the quaternion φ/2 without real part: the first column of the
/// exponential of the matrix that multiplies by it from the left.
fn true_quaternion(phi: &Vector3<f64>) -> Truth {
    let (x, y, z) = (0.5 * phi.x, 0.5 * phi.y, 0.5 * phi.z);
    #[rustfmt::skip]
    let multiply = nalgebra::Matrix4::new(
        0.0, -x, -y, -z,
        x, 0.0, -z, y,
        y, z, 0.0, -x,
        z, -y, x, 0.0,
    );
    Truth::of(&multiply).exp().block(0..4, 0..1)
}

fn rounded_quaternion(phi: &Vector3<f64>) -> UnitQuaternion<f64> {
    let q: nalgebra::Vector4<f64> = true_quaternion(phi).rounded();
    UnitQuaternion::new_unchecked(Quaternion::new(q[0], q[1], q[2], q[3]))
}

fn rounded_pose(xi: &Vector6<f64>) -> Isometry3<f64> {
    let translation: Vector3<f64> = Truth::of(&se3::hat(xi)).exp().block(0..3, 3..4).rounded();
    let rotation = rounded_quaternion(&xi.fixed_rows::<3>(3).into());
    Isometry3::from_parts(translation.into(), rotation)
}

/// The largest of many errors; NaN counts as the largest of all.
#[derive(Default)]
struct Worst {
    error: f64,
    count: usize,
}

impl Worst {
    fn add(&mut self, error: f64) {
        let error = if error.is_nan() { f64::INFINITY } else { error };
        self.error = self.error.max(error);
        self.count += 1;
    }

    fn assert_below(&self, bound: f64, name: &str) {
        println!("{name}: {:.1e} over {} states", self.error, self.count);
        assert!(self.count > 0, "{name}: nothing was compared");
        assert!(self.error < bound, "{name}: {:.1e}", self.error);
    }
}

/// Random vectors, the same in every run.
struct Random(ChaCha8Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn uniform(&mut self, range: std::ops::Range<f64>) -> f64 {
        self.0.random_range(range)
    }

    fn direction(&mut self, length: f64) -> Vector3<f64> {
        loop {
            let in_cube = Vector3::from_fn(|_, _| self.uniform(-1.0..1.0));
            if in_cube.norm() > 0.1 && in_cube.norm() < 1.0 {
                return length * in_cube.normalize();
            }
        }
    }

    /// An angle below π by enough to take differences.
    fn rotation_vector(&mut self) -> Vector3<f64> {
        let angle = self.uniform(0.0..3.1);
        self.direction(angle)
    }

    fn twist(&mut self) -> Vector6<f64> {
        let length = self.uniform(0.0..3.0);
        let (rho, phi) = (self.direction(length), self.rotation_vector());
        Vector6::new(rho.x, rho.y, rho.z, phi.x, phi.y, phi.z)
    }
}

/// Matrices with 60 decimal digits, and the power series that define what is tested.
mod oracle {
    use std::ops::Range;

    use dashu_float::{FBig, round::mode::HalfEven};
    use nalgebra::SMatrix;

    type Real = FBig<HalfEven, 2>;

    const BITS: usize = 200;

    fn real(value: f64) -> Real {
        let exact = Real::try_from(value).expect("a finite number");
        exact.with_precision(BITS).value()
    }

    fn size(value: &Real) -> Real {
        if *value < Real::ZERO { -value.clone() } else { value.clone() }
    }

    #[derive(Clone)]
    pub struct Truth {
        columns: usize,
        /// Row by row.
        entries: Vec<Real>,
    }

    impl Truth {
        pub fn of<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> Self {
            let by_row = matrix.transpose();
            Self { columns: C, entries: by_row.iter().map(|&entry| real(entry)).collect() }
        }

        pub fn column(entries: &[f64]) -> Self {
            Self { columns: 1, entries: entries.iter().map(|&entry| real(entry)).collect() }
        }

        /// The sum of Aⁿ/n!.
        pub fn exp(&self) -> Self {
            self.series(0)
        }

        /// The sum of Aⁿ/(n+1)!.
        pub fn jacobian(&self) -> Self {
            self.series(1)
        }

        fn series(&self, shift: u32) -> Self {
            let mut term = self.identity();
            let mut sum = term.clone();
            let negligible = self.largest() >> (BITS as isize);
            for n in 1.. {
                term = term.times(self).map(|entry| entry / real(f64::from(n + shift)));
                sum = sum.plus(&term);
                if term.largest() <= negligible {
                    break;
                }
            }
            sum
        }

        /// The inverse by Newton's iteration. Every step doubles the correct digits.
        pub fn inverse_near<const N: usize>(&self, approximation: &SMatrix<f64, N, N>) -> Self {
            let mut inverse = Self::of(approximation);
            for _ in 0..4 {
                let residual = self.identity().minus(&self.times(&inverse));
                inverse = inverse.plus(&inverse.times(&residual));
            }
            inverse
        }

        pub fn minus_transpose(&self) -> Self {
            let n = self.columns;
            let transposed = (0..n * n).map(|k| self.entries[k % n * n + k / n].clone());
            self.minus(&Self { columns: n, entries: transposed.collect() })
        }

        pub fn block(&self, rows: Range<usize>, columns: Range<usize>) -> Self {
            let (width, all) = (columns.len(), self.columns);
            let row = |i: usize| self.entries[i * all..][columns.clone()].to_vec();
            Self { columns: width, entries: rows.flat_map(row).collect() }
        }

        pub fn rows(&self, rows: Range<usize>) -> Self {
            self.block(rows, 0..self.columns)
        }

        pub fn rounded<const R: usize, const C: usize>(&self) -> SMatrix<f64, R, C> {
            SMatrix::from_row_iterator(self.entries.iter().map(|entry| entry.to_f64().value()))
        }

        /// The largest error of an entry over the largest entry.
        pub fn relative_error<const R: usize, const C: usize>(
            &self,
            computed: &SMatrix<f64, R, C>,
        ) -> f64 {
            if computed.iter().all(|entry| entry.is_finite()) {
                self.relative_error_of(&Self::of(computed))
            } else {
                f64::NAN
            }
        }

        pub fn relative_error_of(&self, computed: &Self) -> f64 {
            (computed.minus(self).largest() / self.largest()).to_f64().value()
        }

        pub fn block_error<const R: usize, const C: usize>(
            &self,
            computed: &SMatrix<f64, R, C>,
            rows: Range<usize>,
            columns: Range<usize>,
        ) -> f64 {
            let computed = Self::of(computed).block(rows.clone(), columns.clone());
            self.block(rows, columns).relative_error_of(&computed)
        }

        fn identity(&self) -> Self {
            let n = self.columns;
            let entry = |k| if k / n == k % n { real(1.0) } else { real(0.0) };
            Self { columns: n, entries: (0..n * n).map(entry).collect() }
        }

        fn largest(&self) -> Real {
            self.entries.iter().map(size).max().expect("a matrix with entries")
        }

        fn plus(&self, other: &Self) -> Self {
            let sums = self.entries.iter().zip(&other.entries).map(|(a, b)| a + b);
            Self { columns: self.columns, entries: sums.collect() }
        }

        fn minus(&self, other: &Self) -> Self {
            self.plus(&other.clone().map(|entry| -entry))
        }

        fn map(self, change: impl Fn(Real) -> Real) -> Self {
            let entries = self.entries.into_iter().map(change).collect();
            Self { columns: self.columns, entries }
        }

        fn times(&self, other: &Self) -> Self {
            let (n, width) = (self.columns, other.columns);
            let entry = |k: usize| {
                let (row, column) = (&self.entries[k / width * n..][..n], k % width);
                let mut sum = real(0.0);
                for (i, factor) in row.iter().enumerate() {
                    if *factor != Real::ZERO {
                        sum += factor * &other.entries[i * width + column];
                    }
                }
                sum
            };
            let count = self.entries.len() / n * width;
            Self { columns: width, entries: (0..count).map(entry).collect() }
        }
    }
}
