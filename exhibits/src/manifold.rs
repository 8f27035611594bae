//! What chapter `manifold` shows: small vectors that move rotations and poses.
//!
//! Each part registers its equations, then checks them. In formulas `r` is a rotation, `t` a pose,
//! `phi` a rotation vector, `xi` a twist and `sigma` a covariance.

mod accuracy;
mod counterexamples;
mod figures;
mod numbers;
pub mod oracle;
mod uncertainty;

use nalgebra::{Isometry3, Matrix3, Matrix6, Rotation3, SMatrix, UnitQuaternion, Vector3, Vector6};
use vislam::manifold::{se3, so3};

use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};
use crate::one_flight;
use crate::random::Random;
use oracle::{cross, exponential_of, small_twist, small_vector, turned, twist_of};
use uncertainty::{Noise, sample_covariance};

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Step of the central differences.
const STEP: f64 = 1e-5;

/// States and draws at each of them of a comparison with simulated noise.
const NOISY_STATES: u64 = 20;
const DRAWS: usize = 10_000;

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    exponential(chapter);
    frames(chapter);
    jacobians(chapter);
    products(chapter);
    poses(chapter);
    pose_jacobians(chapter);
    covariances(chapter);
    counterexamples::counterexamples(chapter);
    numbers::numbers(chapter);
    figures::figures(chapter);
    one_flight::readings::turns(chapter);
}

/// A rotation vector with an angle up to `largest`, and not so small that mutants look right.
fn vector(random: &mut Random, largest: f64) -> Vector3<f64> {
    let angle = random.uniform(0.3..largest);
    random.direction(angle)
}

fn twist(random: &mut Random, largest_angle: f64) -> Vector6<f64> {
    let length = random.uniform(0.3..3.0);
    twist_of(&random.direction(length), &vector(random, largest_angle))
}

/// A pose that does not come from the formulas to be checked.
fn pose(random: &mut Random) -> Isometry3<f64> {
    let length = random.uniform(0.3..3.0);
    let rotation = turned(&vector(random, 3.0));
    Isometry3::from_parts(
        random.direction(length).into(),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}

fn exponential(chapter: &mut Chapter) {
    let mutants: [(_, Exp); 5] = [
        ("transposed", |phi| so3::exp(&-phi).into_inner()),
        ("second power dropped", |phi| accuracy::textbook_exp(phi, 0.0)),
        ("sign of the second power", |phi| accuracy::textbook_exp(phi, -1.0)),
        ("half the angle", |phi| so3::exp(&(0.5 * phi)).into_inner()),
        ("the Jacobian for it", so3::left_jacobian),
    ];
    chapter.equation("rodrigues", rodrigues, |phi| so3::exp(phi).into_inner(), &mutants);

    let mutants: [(_, Log); 4] = [
        ("transposed", |r| so3::log(&r.transpose())),
        ("half the angle", |r| 0.5 * so3::log(r)),
        ("the sine for the angle", |r| small_vector(r.matrix())),
        ("w of either sign", |r| {
            let q = UnitQuaternion::from_rotation_matrix(r);
            let q = if q.i < 0.0 { -q.into_inner() } else { q.into_inner() };
            2.0 * q.imag().norm().atan2(q.w) * q.imag().normalize()
        }),
    ];
    chapter.equation("so3-log", so3_log, so3::log, &mutants);
}

type Exp = fn(&Vector3<f64>) -> Matrix3<f64>;

fn rodrigues(formula: Exp) -> Comparison {
    let against = "the differential equation of a body that turns at a constant rate, integrated \
                   in 400 steps of Runge and Kutta";
    Comparison::absolute(against, 1e-8, "").over(STATES, 1, |random| {
        let phi = vector(random, 6.0);
        (formula(&phi), oracle::integrated(&phi))
    })
}

type Log = fn(&Rotation3<f64>) -> Vector3<f64>;

fn so3_log(formula: Log) -> Comparison {
    let against = "the axis and the angle of a rotation that was put together from a basis";
    Comparison::absolute(against, 1e-13, "rad").over(STATES, 2, |random| {
        let phi = vector(random, 3.1);
        (formula(&turned(&phi)), phi)
    })
}

fn frames(chapter: &mut Chapter) {
    let mutants: [(_, OtherSide); 4] = [
        ("not rotated", |_, phi| *phi),
        ("rotated back", |r, phi| r.inverse() * phi),
        ("sign", |r, phi| -(r * phi)),
        ("rotated twice", |r, phi| r * (r * phi)),
    ];
    chapter.equation("so3-adjoint", so3_adjoint, |r, phi| r * phi, &mutants);

    let mutants: [(_, PointJacobian); 5] = [
        ("sign", |r, p| r * cross(p)),
        ("rotation dropped", |_, p| -cross(p)),
        ("rotation behind", |r, p| -cross(p) * r.matrix()),
        ("of the rotated point", |r, p| -cross(&(r * p))),
        ("rotation transposed", |r, p| -(r.inverse() * cross(p))),
    ];
    chapter.equation("rotated-point", rotated_point, |r, p| -(r * so3::hat(p)), &mutants);
}

/// Takes a rotation and a small vector on its right; gives the small vector on its left.
type OtherSide = fn(&Rotation3<f64>, &Vector3<f64>) -> Vector3<f64>;

fn so3_adjoint(formula: OtherSide) -> Comparison {
    let against = "the same rotation with the vector on the right, put together from bases";
    Comparison::absolute(against, 1e-13, "").over(STATES, 3, |random| {
        let (rotation, phi) = (turned(&vector(random, 3.0)), vector(random, 3.0));
        (turned(&formula(&rotation, &phi)) * rotation, rotation * turned(&phi))
    })
}

type PointJacobian = fn(&Rotation3<f64>, &Vector3<f64>) -> Matrix3<f64>;

fn rotated_point(formula: PointJacobian) -> Comparison {
    let against = "central differences of the rotated point";
    Comparison::relative(against, 1e-9).over(STATES, 4, |random| {
        let rotation = turned(&vector(random, 3.0));
        let length = random.uniform(0.5..5.0);
        let point = random.direction(length);
        let slope = differences(STEP, |step: Vector3<f64>| rotation * turned(&step) * point);
        (formula(&rotation, &point), slope)
    })
}

fn jacobians(chapter: &mut Chapter) {
    let mutants: [(_, Exp); 4] = [
        ("sign in the exponent", |phi| mean_rotation(phi, -1.0, 1.0)),
        ("twice the time", |phi| mean_rotation(phi, 1.0, 2.0)),
        ("only the end", |phi| turned(&-phi).into_inner()),
        ("only the start", |_| Matrix3::identity()),
    ];
    let formula: Exp = |phi| mean_rotation(phi, 1.0, 1.0);
    chapter.equation("right-jacobian-integral", right_jacobian_integral, formula, &mutants);

    let mutants: [(_, Exp); 4] = [
        ("left for right", so3::left_jacobian),
        ("its inverse", so3::right_jacobian_inverse),
        ("identity", |_| Matrix3::identity()),
        ("second power dropped", |phi| {
            let t = phi.norm();
            Matrix3::identity() - (1.0 - t.cos()) / (t * t) * cross(phi)
        }),
    ];
    chapter.equation("right-jacobian", right_jacobian, so3::right_jacobian, &mutants);

    let mutants: [(_, Exp); 4] = [
        ("rotation transposed", |phi| so3::exp(phi).inverse() * so3::right_jacobian(phi)),
        ("rotation dropped", so3::right_jacobian),
        ("rotation in place of the Jacobian", |phi| so3::exp(phi).into_inner()),
        ("inverse", |phi| so3::exp(phi) * so3::right_jacobian_inverse(phi)),
    ];
    let formula: Exp = |phi| so3::exp(phi) * so3::right_jacobian(phi);
    chapter.equation("left-jacobian", left_jacobian, formula, &mutants);

    let mutants: [(_, Exp); 4] = [
        ("left for right", so3::left_jacobian_inverse),
        ("not inverted", so3::right_jacobian),
        ("transposed Jacobian for its inverse", so3::left_jacobian),
        ("second power dropped", |phi| Matrix3::identity() + 0.5 * cross(phi)),
    ];
    let formula = so3::right_jacobian_inverse;
    chapter.equation("right-jacobian-inverse", right_jacobian_inverse, formula, &mutants);
}

/// The integral of exp(−s φ^) from 0 to `end`, by Simpson's rule.
fn mean_rotation(phi: &Vector3<f64>, sign: f64, end: f64) -> Matrix3<f64> {
    let intervals = 400;
    let at = |k: i32| {
        let s = end * f64::from(k) / f64::from(intervals);
        so3::exp(&(-sign * s * phi)).into_inner()
    };
    let weight = |k: i32| match k {
        0 => 1.0,
        k if k == intervals => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum = (0..=intervals).map(|k| weight(k) * at(k)).sum::<Matrix3<f64>>();
    sum * end / (3.0 * f64::from(intervals))
}

fn right_jacobian_integral(formula: Exp) -> Comparison {
    compared_with_steps(5, 100, formula, right_step)
}

fn right_jacobian(formula: Exp) -> Comparison {
    compared_with_steps(6, STATES, formula, right_step)
}

fn left_jacobian(formula: Exp) -> Comparison {
    compared_with_steps(7, STATES, formula, |before, after| {
        small_vector((after * before.transpose()).matrix())
    })
}

/// The small vector by which a rotation has moved, in its own frame.
fn right_step(before: &Rotation3<f64>, after: &Rotation3<f64>) -> Vector3<f64> {
    small_vector((before.transpose() * after).matrix())
}

/// Compares `formula` with the small vectors between the rotation of φ and those of its neighbours.
fn compared_with_steps(
    seed: u64,
    states: usize,
    formula: Exp,
    step_between: fn(&Rotation3<f64>, &Rotation3<f64>) -> Vector3<f64>,
) -> Comparison {
    let against = "central differences of rotations that were put together from bases";
    Comparison::absolute(against, 1e-9, "").over(states, seed, |random| {
        let phi = vector(random, 6.0);
        let moved = |step: Vector3<f64>| step_between(&turned(&phi), &turned(&(phi + step)));
        (formula(&phi), differences(STEP, moved))
    })
}

fn right_jacobian_inverse(formula: Exp) -> Comparison {
    let against = "central differences of the logarithm";
    Comparison::relative(against, 1e-8).over(STATES, 8, |random| {
        let phi = vector(random, 3.0);
        let moved = |step: Vector3<f64>| so3::log(&(turned(&phi) * turned(&step)));
        (formula(&phi), differences(STEP, moved))
    })
}

fn products(chapter: &mut Chapter) {
    let mutants: [(_, Product); 4] = [
        ("sign", |a, b| a + b - 0.5 * a.cross(b)),
        ("half dropped", |a, b| a + b + a.cross(b)),
        ("sum only", |a, b| a + b),
        ("symmetric", |a, b| a + b + 0.5 * a.component_mul(b)),
    ];
    chapter.equation("bch", bch, |a, b| a + b + 0.5 * a.cross(b), &mutants);
}

/// Takes two rotation vectors; gives that of their product.
type Product = fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>;

fn bch(formula: Product) -> Comparison {
    let against = "the logarithm of the product, less the sum of the two vectors";
    Comparison::relative(against, 0.01).over(STATES, 9, |random| {
        let first = random.direction(2e-3);
        let across = first.cross(&random.direction(1.0)).normalize();
        let second = random.uniform(-1e-3..1e-3) * first / first.norm() + 2e-3 * across;
        let beyond_sum = |vector: Vector3<f64>| vector - first - second;
        let product = so3::log(&(turned(&first) * turned(&second)));
        (beyond_sum(formula(&first, &second)), beyond_sum(product))
    })
}

fn poses(chapter: &mut Chapter) {
    let mutants: [(_, PoseExp); 4] = [
        ("translation not turned", |xi| with_translation(xi, Matrix3::identity())),
        ("right Jacobian", |xi| with_translation(xi, so3::right_jacobian(&turn_of(xi)))),
        ("rotation for the Jacobian", |xi| with_translation(xi, so3::exp(&turn_of(xi)).into())),
        ("rotation first", |xi| se3::exp(&Vector6::new(xi[3], xi[4], xi[5], xi[0], xi[1], xi[2]))),
    ];
    chapter.equation("se3-exp", se3_exp, se3::exp, &mutants);

    let mutants: [(_, Adjoint); 5] = [
        ("of the inverse pose", |t| se3::adjoint(&t.inverse())),
        ("translation dropped", |t| {
            se3::adjoint(&Isometry3::from_parts(Default::default(), t.rotation))
        }),
        ("sign of the corner", |t| {
            se3::adjoint(&Isometry3::from_parts(t.translation.inverse(), t.rotation))
        }),
        ("corner below", |t| se3::adjoint(t).transpose()),
        ("rotation before the skew", |t| {
            let corner = t.rotation.to_rotation_matrix() * cross(&t.translation.vector);
            with_corner(se3::adjoint(t), &corner)
        }),
    ];
    chapter.equation("se3-adjoint", se3_adjoint, se3::adjoint, &mutants);
}

/// The matrix with another upper right block.
fn with_corner(mut matrix: Matrix6<f64>, corner: &Matrix3<f64>) -> Matrix6<f64> {
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(corner);
    matrix
}

fn turn_of(xi: &Vector6<f64>) -> Vector3<f64> {
    xi.fixed_rows::<3>(3).into()
}

/// The pose of a twist with another matrix in front of its translation.
fn with_translation(xi: &Vector6<f64>, matrix: Matrix3<f64>) -> Isometry3<f64> {
    let translation = matrix * xi.fixed_rows::<3>(0);
    Isometry3::from_parts(translation.into(), so3::exp_quaternion(&turn_of(xi)))
}

type PoseExp = fn(&Vector6<f64>) -> Isometry3<f64>;

fn se3_exp(formula: PoseExp) -> Comparison {
    let against = "the power series of the 4×4 matrix";
    Comparison::absolute(against, 1e-11, "").over(STATES, 10, |random| {
        let xi = twist(random, 6.0);
        (formula(&xi), exponential_of(&xi))
    })
}

type Adjoint = fn(&Isometry3<f64>) -> Matrix6<f64>;

fn se3_adjoint(formula: Adjoint) -> Comparison {
    let against = "the two products of 4×4 matrices, the twist on the right and on the left";
    Comparison::absolute(against, 1e-10, "").over(STATES, 11, |random| {
        let (pose, xi) = (pose(random), twist(random, 3.0));
        let (moved, pose) = (formula(&pose) * xi, pose.to_homogeneous());
        (exponential_of(&moved) * pose, pose * exponential_of(&xi))
    })
}

fn pose_jacobians(chapter: &mut Chapter) {
    let mutants: [(_, Corner); 4] = [
        ("sign of the turn", |phi, rho| so3::left_jacobian_derivative(&-phi, rho)),
        ("sign of the translation", |phi, rho| so3::left_jacobian_derivative(phi, &-rho)),
        ("exchanged", |phi, rho| so3::left_jacobian_derivative(rho, phi)),
        ("angle held fixed", |phi, rho| {
            let across = rho - phi * phi.dot(rho) / phi.norm_squared();
            so3::left_jacobian_derivative(phi, &across)
        }),
    ];
    let formula = so3::left_jacobian_derivative;
    chapter.equation("se3-corner", se3_corner, formula, &mutants);

    let mutants: [(_, PoseJacobian); 4] = [
        ("left for right", se3::left_jacobian),
        ("inverse", se3::right_jacobian_inverse),
        ("corner dropped", |xi| with_corner(se3::right_jacobian(xi), &Matrix3::zeros())),
        ("corner of the left one", |xi| {
            let left = se3::left_jacobian(xi).fixed_view::<3, 3>(0, 3).into_owned();
            with_corner(se3::right_jacobian(xi), &left)
        }),
    ];
    chapter.equation("se3-jacobian", se3_jacobian, se3::right_jacobian, &mutants);
}

/// Takes a rotation vector and a translation.
type Corner = fn(&Vector3<f64>, &Vector3<f64>) -> Matrix3<f64>;

fn se3_corner(formula: Corner) -> Comparison {
    let against = "the sum over all products of powers of the two matrices";
    Comparison::absolute(against, 1e-12, "").over(STATES, 12, |random| {
        let (phi, rho) = (vector(random, 4.0), vector(random, 3.0));
        // Powers of φ^ before and behind ρ^, each word of n letters over (n+1)!.
        let mut words = cross(&rho);
        let mut power = cross(&phi);
        let (mut factorial, mut sum) = (2.0, words / 2.0);
        for n in 2..50 {
            words = words * cross(&phi) + power * cross(&rho);
            power *= cross(&phi);
            factorial *= f64::from(n + 1);
            sum += words / factorial;
        }
        (formula(&phi, &rho), sum)
    })
}

type PoseJacobian = fn(&Vector6<f64>) -> Matrix6<f64>;

fn se3_jacobian(formula: PoseJacobian) -> Comparison {
    let against = "central differences of the power series of the 4×4 matrix";
    Comparison::absolute(against, 1e-8, "").over(100, 13, |random| {
        let xi = twist(random, 4.0);
        let back = exponential_of(&-xi);
        let moved = |step: Vector6<f64>| small_twist(&(back * exponential_of(&(xi + step))));
        (formula(&xi), differences(STEP, moved))
    })
}

fn covariances(chapter: &mut Chapter) {
    let formula: Composed = |t, first, second| moved(se3::adjoint(&t.inverse()), first) + second;
    let mutants: [(_, Composed); 4] = [
        ("added without moving", |_, first, second| first + second),
        ("moved the other way", |t, first, second| moved(se3::adjoint(t), first) + second),
        ("first pose certain", |_, _, second| *second),
        ("transposed for inverse", |t, first, second| {
            moved(se3::adjoint(t).transpose(), first) + second
        }),
    ];
    chapter.equation("compose-covariance", compose_covariance, formula, &mutants);

    let mutants: [(_, Moved); 4] = [
        ("not moved", |_, sigma| *sigma),
        ("moved the other way", |t, sigma| moved(se3::adjoint(&t.inverse()), sigma)),
        ("adjoint on one side", |t, sigma| se3::adjoint(t) * sigma),
        ("transposes exchanged", |t, sigma| moved(se3::adjoint(t).transpose(), sigma)),
    ];
    let formula: Moved = |t, sigma| moved(se3::adjoint(t), sigma);
    chapter.equation("left-covariance", left_covariance, formula, &mutants);

    let mutants: [(_, OfVector); 4] = [
        ("Jacobian forgotten", |_, sigma| *sigma),
        ("not inverted", |phi, sigma| moved(so3::right_jacobian(phi), sigma)),
        ("left for right", |phi, sigma| {
            so3::left_jacobian_inverse(phi) * sigma * so3::right_jacobian_inverse(phi)
        }),
        ("on one side only", |phi, sigma| so3::right_jacobian_inverse(phi) * sigma),
    ];
    let formula: OfVector = |phi, sigma| moved(so3::right_jacobian_inverse(phi), sigma);
    chapter.equation("vector-covariance", vector_covariance, formula, &mutants);
}

/// The covariance of a vector with this covariance after a linear map.
fn moved<const N: usize>(
    by: SMatrix<f64, N, N>,
    covariance: &SMatrix<f64, N, N>,
) -> SMatrix<f64, N, N> {
    by * covariance * by.transpose()
}

/// Takes the second pose and the covariances of the first and of the second.
type Composed = fn(&Isometry3<f64>, &Matrix6<f64>, &Matrix6<f64>) -> Matrix6<f64>;

fn compose_covariance(formula: Composed) -> Comparison {
    let mut random = Random::new(14);
    against_noise().each(0..NOISY_STATES, |state| {
        let poses = [(); 2].map(|()| pose(&mut random));
        let sigmas = [(); 2].map(|()| uncertainty::covariance(&mut random, 0.005, 0.01));
        let mut first = Noise::new(&sigmas[0], 1000 + state);
        let mut second = Noise::new(&sigmas[1], 2000 + state);
        let drawn = sample_covariance(DRAWS, || {
            let product = first.around(&poses[0]) * second.around(&poses[1]);
            se3::local(&(poses[0] * poses[1]), &product)
        });
        (formula(&poses[1], &sigmas[0], &sigmas[1]), drawn)
    })
}

/// Takes a pose and the covariance of the small twist on its right.
type Moved = fn(&Isometry3<f64>, &Matrix6<f64>) -> Matrix6<f64>;

fn left_covariance(formula: Moved) -> Comparison {
    let mut random = Random::new(15);
    against_noise().each(0..NOISY_STATES, |state| {
        let pose = pose(&mut random);
        let sigma = uncertainty::covariance(&mut random, 0.005, 0.01);
        let mut noise = Noise::new(&sigma, 3000 + state);
        let drawn = sample_covariance(DRAWS, || se3::log(&(noise.around(&pose) * pose.inverse())));
        (formula(&pose, &sigma), drawn)
    })
}

/// Takes a rotation vector and the covariance of the small vector on the right of its rotation.
type OfVector = fn(&Vector3<f64>, &Matrix3<f64>) -> Matrix3<f64>;

fn vector_covariance(formula: OfVector) -> Comparison {
    let mut random = Random::new(16);
    against_noise().each(0..NOISY_STATES, |state| {
        let angle = random.uniform(1.5..2.8);
        let phi = random.direction(angle);
        let rotation = turned(&phi);
        let whole = uncertainty::covariance(&mut random, 0.01, 0.01);
        let mut noise = Noise::new(&whole, 4000 + state);
        let sigma = whole.fixed_view::<3, 3>(3, 3).into_owned();
        let drawn = sample_covariance(DRAWS, || {
            so3::log(&(rotation * turned(&turn_of(&noise.draw())))) - phi
        });
        (formula(&phi, &sigma), drawn)
    })
}

fn against_noise() -> Comparison {
    Comparison::relative("Monte Carlo with 10,000 noisy draws for each state", 0.05)
}
