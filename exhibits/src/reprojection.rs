//! What chapter `reprojection` shows: what moves a pixel, what one observation says, how a lens
//! bends the image, and what becomes of two conventions that are mixed.
//!
//! In formulas `k` is a camera, `t` a pose (camera from world) and `p` a point in the world.

mod counterexamples;
mod figures;
pub mod mixing;
mod numbers;
mod oracle;
mod worked;

use std::f64::consts::TAU;

use nalgebra::{
    Isometry3, Matrix2, Matrix2x3, Matrix2x6, Matrix3, Matrix3x6, Matrix6, Rotation3, SMatrix,
    Vector1, Vector2, Vector3, Vector6,
};
use vislam::manifold::{se3, so3};
use vislam::reprojection::{Pinhole, Projection, RadialTangential, ReprojFactor};

use crate::bearing::exchanged;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, inverse};
use crate::manifold::oracle::twist_of;
use crate::one_flight;
use crate::random::Random;
use oracle::{differences, image_of, moved_on_the_left, moved_on_the_right};

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Step of the central differences, in metres and radians.
const STEP: f64 = 1e-3;

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    noise(chapter);
    projection(chapter);
    blocks(chapter);
    factor(chapter);
    reading(chapter);
    lens(chapter);
    lens_and_noise(chapter);
    conventions(chapter);
    mixed(chapter);
    counterexamples::counterexamples(chapter);
    numbers::numbers(chapter);
    figures::figures(chapter);
    one_flight::one_picture::alone(chapter);
}

/// A camera, its pose, and a point in the world that it sees.
fn state(random: &mut Random) -> (Pinhole, Isometry3<f64>, Vector3<f64>) {
    let camera = random.camera();
    let rotation = random.rotation(3.0);
    let pose = Isometry3::from_parts(random.direction(2.0).into(), rotation.into());
    let point_in_camera = random.point(1.0..50.0);
    (camera, pose, pose.inverse_transform_point(&point_in_camera.into()).coords)
}

fn in_camera(pose: &Isometry3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
    pose.rotation * point + pose.translation.vector
}

fn matrix_of(pose: &Isometry3<f64>) -> Matrix3<f64> {
    pose.rotation.to_rotation_matrix().into_inner()
}

fn noise(chapter: &mut Chapter) {
    let formula: PixelLikelihood = |e, s| 0.5 * e.norm_squared() + (TAU * s * s).ln();
    let mutants: [(_, PixelLikelihood); 4] = [
        ("half dropped", |e, s| e.norm_squared() + (TAU * s * s).ln()),
        ("normalized in one dimension", |e, s| 0.5 * e.norm_squared() + 0.5 * (TAU * s * s).ln()),
        ("norm not squared", |e, s| 0.5 * e.norm() + (TAU * s * s).ln()),
        ("sign of the constant", |e, s| 0.5 * e.norm_squared() - (TAU * s * s).ln()),
    ];
    chapter.equation("pixel-likelihood", pixel_likelihood, formula, &mutants);
}

/// Takes a whitened residual and the deviation of a pixel.
type PixelLikelihood = fn(&Vector2<f64>, f64) -> f64;

fn pixel_likelihood(formula: PixelLikelihood) -> Comparison {
    let against = "the bell-shaped surface, normalized by summing it over a grid of pixels";
    Comparison::absolute(against, 1e-8, "nats").over(50, 1, |random| {
        let sigma = random.uniform(0.3..3.0);
        let surface = |u: f64, v: f64| (-(u * u + v * v) / (2.0 * sigma * sigma)).exp();
        let spacing = 0.25 * sigma;
        let places = || (-40..=40).map(|index| spacing * f64::from(index));
        let volume: f64 = places().flat_map(|u| places().map(move |v| surface(u, v))).sum();
        let off = Vector2::new(random.normal(sigma), random.normal(sigma));
        let density = surface(off.x, off.y) / (volume * spacing * spacing);
        (formula(&(off / sigma), sigma), -density.ln())
    })
}

fn projection(chapter: &mut Chapter) {
    let mutants: [(_, ProjectionJacobian); 5] = [
        ("sign of the third column", |k, p| with_third_column_times(k, p, -1.0)),
        ("third column dropped", |k, p| with_third_column_times(k, p, 0.0)),
        ("third column over Z, not its square", |k, p| with_third_column_times(k, p, p.z)),
        ("focal lengths exchanged", |k, p| exchanged(k).projection_jacobian(p)),
        ("distance for depth", |k, p| k.projection_jacobian(&Vector3::new(p.x, p.y, p.norm()))),
    ];
    let formula = Pinhole::projection_jacobian;
    chapter.equation("projection-jacobian", projection_jacobian, formula, &mutants);
}

type ProjectionJacobian = fn(&Pinhole, &Vector3<f64>) -> Option<Matrix2x3<f64>>;

fn projection_jacobian(formula: ProjectionJacobian) -> Comparison {
    Comparison::relative("central differences of the projection", 1e-9).over(STATES, 2, |random| {
        let camera = random.camera();
        let point = random.point(0.5..50.0);
        let moved = |step: &_| image_of(&camera, &(point + step));
        (formula(&camera, &point), differences(STEP * point.z, moved))
    })
}

fn with_third_column_times(
    camera: &Pinhole,
    point: &Vector3<f64>,
    factor: f64,
) -> Option<Matrix2x3<f64>> {
    let mut jacobian = camera.projection_jacobian(point)?;
    jacobian.column_mut(2).scale_mut(factor);
    Some(jacobian)
}

fn blocks(chapter: &mut Chapter) {
    let formula: OfPose<Matrix3x6<f64>> = |t, p| moved_by(matrix_of(t), p);
    let mutants: [(_, OfPose<Matrix3x6<f64>>); 5] = [
        ("sign of the skew", |t, p| moved_by(matrix_of(t), &-p)),
        ("skew of the point in the camera", |t, p| moved_by(matrix_of(t), &in_camera(t, p))),
        ("rotation dropped", |_, p| moved_by(Matrix3::identity(), p)),
        ("rotation transposed", |t, p| moved_by(matrix_of(t).transpose(), p)),
        ("perturbed on the left", |t, p| moved_by(Matrix3::identity(), &in_camera(t, p))),
    ];
    chapter.equation("moved-point", moved_point, formula, &mutants);

    let formula: Block<Matrix2x6<f64>> = |k, t, p| Some(k.jacobians(t, p)?.0);
    let mutants: [(_, Block<Matrix2x6<f64>>); 6] = [
        ("perturbed on the left", |k, t, p| {
            Some(k.jacobians(t, p)?.0 * se3::adjoint(&t.inverse()))
        }),
        ("skew of the point in the camera", |k, t, p| {
            Some(k.jacobians(t, p)?.1 * moved_by(Matrix3::identity(), &in_camera(t, p)))
        }),
        ("sign of the skew", |k, t, p| {
            Some(k.jacobians(t, p)?.1 * moved_by(Matrix3::identity(), &-p))
        }),
        ("rotation before translation", |k, t, p| Some(k.jacobians(t, p)?.0 * halves_exchanged())),
        ("rotation dropped", |k, t, p| {
            Some(k.projection_jacobian(&in_camera(t, p))? * moved_by(Matrix3::identity(), p))
        }),
        ("pose inverted", |k, t, p| Some(k.jacobians(t, p)?.0 * -se3::adjoint(t))),
    ];
    chapter.equation("pose-block", pose_block, formula, &mutants);

    let formula: Block<Matrix2x3<f64>> = |k, t, p| Some(k.jacobians(t, p)?.1);
    let mutants: [(_, Block<Matrix2x3<f64>>); 3] = [
        ("rotation dropped", |k, t, p| k.projection_jacobian(&in_camera(t, p))),
        ("rotation transposed", |k, t, p| {
            Some(k.projection_jacobian(&in_camera(t, p))? * matrix_of(t).transpose())
        }),
        ("sign", |k, t, p| Some(-k.jacobians(t, p)?.1)),
    ];
    chapter.equation("point-block", point_block, formula, &mutants);
}

/// The 3×6 derivative of a point by a twist on the right of a pose with this rotation.
fn moved_by(rotation: Matrix3<f64>, point: &Vector3<f64>) -> Matrix3x6<f64> {
    let mut both = Matrix3x6::zeros();
    both.fixed_columns_mut::<3>(0).copy_from(&rotation);
    both.fixed_columns_mut::<3>(3).copy_from(&(-rotation * so3::hat(point)));
    both
}

/// Exchanges translation and rotation in a twist.
fn halves_exchanged() -> Matrix6<f64> {
    Matrix6::from_fn(|row, column| f64::from((row + 3) % 6 == column))
}

/// Takes a pose and a point of the world.
type OfPose<T> = fn(&Isometry3<f64>, &Vector3<f64>) -> T;

fn moved_point(formula: OfPose<Matrix3x6<f64>>) -> Comparison {
    let against = "central differences of the matrix exponential by its power series";
    Comparison::relative(against, 1e-10).over(STATES, 3, |random| {
        let (_, pose, point) = state(random);
        let moved = |xi: &_| moved_on_the_right(&pose, xi, &point);
        (formula(&pose, &point), differences(STEP, moved))
    })
}

/// Takes a camera, its pose and a point of the world; gives the block of its pixel.
type Block<T> = fn(&Pinhole, &Isometry3<f64>, &Vector3<f64>) -> Option<T>;

fn pose_block(formula: Block<Matrix2x6<f64>>) -> Comparison {
    let against = "central differences of the projection, the pose moved by a power series";
    Comparison::relative(against, 1e-8).over(STATES, 4, |random| {
        let (camera, pose, point) = state(random);
        let expected = pose_block_by_differences(&camera, &pose, &point);
        (formula(&camera, &pose, &point), expected)
    })
}

fn pose_block_by_differences(
    camera: &Pinhole,
    pose: &Isometry3<f64>,
    point: &Vector3<f64>,
) -> Matrix2x6<f64> {
    differences(STEP, |xi| image_of(camera, &moved_on_the_right(pose, xi, point)))
}

fn point_block(formula: Block<Matrix2x3<f64>>) -> Comparison {
    Comparison::relative("central differences of the projection", 1e-8).over(STATES, 5, |random| {
        let (camera, pose, point) = state(random);
        let seen = |step: &Vector3<f64>| image_of(&camera, &in_camera(&pose, &(point + step)));
        (formula(&camera, &pose, &point), differences(STEP, seen))
    })
}

fn factor(chapter: &mut Chapter) {
    let mutants: [(_, FactorBlocks); 5] = [
        ("sign", |factor, predicted| scaled(predicted, -factor.inverse_sigma)),
        ("not whitened", |_, predicted| scaled(predicted, 1.0)),
        ("whitened twice", |factor, predicted| scaled(predicted, factor.inverse_sigma.powi(2))),
        ("times the deviation", |factor, predicted| scaled(predicted, 1.0 / factor.inverse_sigma)),
        ("sign of the point block", |factor, predicted| {
            let (by_pose, by_point) = scaled(predicted, factor.inverse_sigma);
            (by_pose, -by_point)
        }),
    ];
    let formula: FactorBlocks = |factor, predicted| {
        let linearized = factor.linearize(predicted);
        (linearized.by_pose, linearized.by_point)
    };
    chapter.equation("factor-blocks", factor_blocks, formula, &mutants);
}

type FactorBlocks = fn(&ReprojFactor, &Projection) -> (Matrix2x6<f64>, Matrix2x3<f64>);

fn scaled(predicted: &Projection, factor: f64) -> (Matrix2x6<f64>, Matrix2x3<f64>) {
    (factor * predicted.by_pose, factor * predicted.by_point)
}

fn factor_blocks(formula: FactorBlocks) -> Comparison {
    let against = "central differences of the whitened residual";
    Comparison::relative(against, 1e-8).over(STATES, 6, |random| {
        let (camera, pose, point) = state(random);
        let sigma = random.logarithmic(0.2..5.0);
        let predicted = camera.project_with_jacobians(&pose, &point).expect("it is in sight");
        let pixel = predicted.pixel + sigma * Vector2::new(random.normal(1.0), random.normal(1.0));
        let factor = ReprojFactor { keyframe: 0, point: 0, pixel, inverse_sigma: 1.0 / sigma };
        let residual = |in_camera: Vector3<f64>| (image_of(&camera, &in_camera) - pixel) / sigma;
        let by_pose = |xi: &Vector6<f64>| residual(moved_on_the_right(&pose, xi, &point));
        let by_point = |step: &Vector3<f64>| residual(in_camera(&pose, &(point + step)));
        let expected = (differences(STEP, by_pose), differences(STEP, by_point));
        (formula(&factor, &predicted), expected)
    })
}

fn reading(chapter: &mut Chapter) {
    let mutants: [(_, TurnToStep); 4] = [
        ("one over depth", |p| (p.x * p.x + p.z * p.z) / (p.x.abs() * p.z * p.z)),
        ("square of X dropped", |p| p.z * p.z / p.x.abs()),
        ("depth for its square", |p| p.z / p.x.abs()),
        ("upside down", |p| p.x.abs() / (p.x * p.x + p.z * p.z)),
    ];
    let formula: TurnToStep = |p| (p.x * p.x + p.z * p.z) / p.x.abs();
    chapter.equation("turn-to-step", turn_to_step, formula, &mutants);

    let formula: OfPose<SMatrix<f64, 6, 4>> = |t, p| pose_null_space(p, &ray(t, p));
    let mutants: [(_, OfPose<SMatrix<f64, 6, 4>>); 4] = [
        ("sign of the skew", |t, p| pose_null_space(&-p, &ray(t, p))),
        ("skew of the point in the camera", |t, p| pose_null_space(&in_camera(t, p), &ray(t, p))),
        ("ray in the camera's frame", |t, p| pose_null_space(p, &in_camera(t, p))),
        ("point for ray", |_, p| pose_null_space(p, p)),
    ];
    chapter.equation("pose-null-space", null_space_of_pose_block, formula, &mutants);
}

/// Takes a point in a camera that stands upright at the world's origin.
type TurnToStep = fn(&Vector3<f64>) -> f64;

fn turn_to_step(formula: TurnToStep) -> Comparison {
    let against = "columns of the pixel moved by small turns and steps";
    Comparison::relative(against, 1e-7).over(STATES, 7, |random| {
        let camera = random.camera();
        let slope = random.uniform(0.02..0.8) * random.uniform(-1.0..1.0).signum();
        let depth = random.logarithmic(1.0..50.0);
        let point = depth * Vector3::new(slope, random.uniform(-0.8..0.8), 1.0);
        let block = pose_block_by_differences(&camera, &Isometry3::identity(), &point);
        (formula(&point), (block[(0, 4)] / block[(0, 2)]).abs())
    })
}

/// From the camera to the point, along the axes of the world.
fn ray(pose: &Isometry3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
    pose.inverse_transform_vector(&in_camera(pose, point))
}

/// Four twists as columns: three turns about the point, and a step along its ray.
fn pose_null_space(point: &Vector3<f64>, ray_in_world: &Vector3<f64>) -> SMatrix<f64, 6, 4> {
    let mut basis = SMatrix::<f64, 6, 4>::zeros();
    basis.fixed_view_mut::<3, 3>(0, 0).copy_from(&so3::hat(point));
    basis.fixed_view_mut::<3, 3>(3, 0).copy_from(&Matrix3::identity());
    basis.fixed_view_mut::<3, 1>(0, 3).copy_from(ray_in_world);
    basis
}

fn null_space_of_pose_block(formula: OfPose<SMatrix<f64, 6, 4>>) -> Comparison {
    let against = "the null space of the differences' singular value decomposition";
    Comparison::absolute(against, 1e-8, "").over(STATES, 8, |random| {
        let (camera, pose, point) = state(random);
        let block = pose_block_by_differences(&camera, &pose, &point);
        let rows = block.svd(false, true).v_t.expect("it was asked for");
        let onto_null_space = Matrix6::identity() - rows.transpose() * rows;
        let basis = formula(&pose, &point).qr().q();
        (basis * basis.transpose(), onto_null_space)
    })
}

fn lens(chapter: &mut Chapter) {
    let mutants: [(_, OfLens<Vector2<f64>>); 4] = [
        ("p1 and p2 exchanged", |lens, p| ordered(lens, [0, 1, 3, 2, 4]).distort(p)),
        ("k3 before p1 and p2", |lens, p| ordered(lens, [0, 1, 4, 2, 3]).distort(p)),
        ("tangential part dropped", |lens, p| radial_part(lens).distort(p)),
        ("radius for its square", |lens, p| {
            let [k1, k2, ..] = lens.coefficients();
            (1.0 + k1 * p.norm() + k2 * p.norm_squared()) * p
        }),
    ];
    chapter.equation("distortion", distortion, RadialTangential::distort, &mutants);

    let mutants: [(_, OfLens<Matrix2<f64>>); 4] = [
        ("factor held fixed", |lens, p| {
            Matrix2::from_diagonal_element(lens.distort(p).dot(p) / p.norm_squared())
        }),
        ("sign beside the diagonal", |lens, p| {
            let j = lens.jacobian(p);
            Matrix2::new(j.m11, -j.m12, -j.m21, j.m22)
        }),
        ("diagonal exchanged", |lens, p| {
            let j = lens.jacobian(p);
            Matrix2::new(j.m22, j.m12, j.m21, j.m11)
        }),
        ("tangential part dropped", |lens, p| radial_part(lens).jacobian(p)),
    ];
    let formula = RadialTangential::jacobian;
    chapter.equation("distortion-jacobian", distortion_jacobian, formula, &mutants);

    let mutants: [(_, Fold); 4] = [
        ("of the factor, not the radius", |[k1, k2, k3], s| 1.0 + s * (k1 + s * (k2 + s * k3))),
        ("derivative by r² of the factor", |[k1, k2, k3], s| k1 + s * (2.0 * k2 + s * 3.0 * k3)),
        ("even numbers for odd", |[k1, k2, k3], s| {
            1.0 + s * (2.0 * k1 + s * (4.0 * k2 + s * 6.0 * k3))
        }),
        ("last term dropped", |[k1, k2, _], s| 1.0 + s * (3.0 * k1 + s * 5.0 * k2)),
    ];
    let formula: Fold = |[k1, k2, k3], s| 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3));
    chapter.equation("fold", fold, formula, &mutants);
}

/// A lens about as strong as that of a wide-angle camera.
fn random_lens(random: &mut Random) -> RadialTangential {
    let mut within = |size: f64| random.uniform(-size..size);
    lens_with([within(0.3), within(0.1), within(0.02), within(0.02), within(0.03)])
}

fn lens_with([k1, k2, p1, p2, k3]: [f64; 5]) -> RadialTangential {
    RadialTangential::new(k1, k2, p1, p2, k3).expect("finite coefficients")
}

fn ordered(lens: &RadialTangential, order: [usize; 5]) -> RadialTangential {
    lens_with(order.map(|index| lens.coefficients()[index]))
}

fn radial_part(lens: &RadialTangential) -> RadialTangential {
    let [k1, k2, _, _, k3] = lens.coefficients();
    lens_with([k1, k2, 0.0, 0.0, k3])
}

fn random_slope(random: &mut Random) -> Vector2<f64> {
    Vector2::new(random.uniform(-0.9..0.9), random.uniform(-0.9..0.9))
}

/// Takes a lens and an ideal point.
type OfLens<T> = fn(&RadialTangential, &Vector2<f64>) -> T;

fn distortion(formula: OfLens<Vector2<f64>>) -> Comparison {
    let against = "central differences of the scalar whose gradient it is";
    Comparison::absolute(against, 1e-10, "").over(STATES, 9, |random| {
        let (lens, ideal) = (random_lens(random), random_slope(random));
        let potential = |step: &_| Vector1::new(oracle::lens_potential(&lens, &(ideal + step)));
        (formula(&lens, &ideal), differences(STEP, potential))
    })
}

fn distortion_jacobian(formula: OfLens<Matrix2<f64>>) -> Comparison {
    let against = "central differences of the distorted point";
    Comparison::absolute(against, 1e-9, "").over(STATES, 10, |random| {
        let (lens, ideal) = (random_lens(random), random_slope(random));
        let distorted = |step: &_| lens.distort(&(ideal + step));
        (formula(&lens, &ideal), differences(STEP, distorted))
    })
}

/// Takes k1, k2, k3 and the square of the radius.
type Fold = fn([f64; 3], f64) -> f64;

fn fold(formula: Fold) -> Comparison {
    let against = "differences of the distorted radius along a ray";
    Comparison::absolute(against, 1e-9, "").over(STATES, 11, |random| {
        let mut within = |size: f64| random.uniform(-size..size);
        let (k1, k2, k3) = (within(0.6), within(0.4), within(0.2));
        let lens = lens_with([k1, k2, 0.0, 0.0, k3]);
        let (ray, radius) = (direction(random), random.uniform(0.1..1.2));
        let shown = |step: &Vector1<f64>| lens.distort(&((radius + step[0]) * ray));
        (formula([k1, k2, k3], radius * radius), ray.dot(&differences(STEP, shown)))
    })
}

/// Any direction in the image plane.
fn direction(random: &mut Random) -> Vector2<f64> {
    let angle = random.uniform(0.0..TAU);
    Vector2::new(angle.cos(), angle.sin())
}

fn lens_and_noise(chapter: &mut Chapter) {
    let formula: UndistortedNoise = |lens, p, sigma| spread(inverse(lens.jacobian(p)), sigma);
    let mutants: [(_, UndistortedNoise); 4] = [
        ("unchanged", |_, _, sigma| spread(Matrix2::identity(), sigma)),
        ("Jacobian for its inverse", |lens, p, sigma| spread(lens.jacobian(p), sigma)),
        ("inverse on one side only", |lens, p, sigma| sigma * sigma * inverse(lens.jacobian(p))),
        ("at the distorted point", |lens, p, sigma| {
            spread(inverse(lens.jacobian(&lens.distort(&lens.distort(p)))), sigma)
        }),
    ];
    chapter.equation("undistorted-noise", undistorted_noise, formula, &mutants);
}

/// The covariance of noise with this deviation in both coordinates, after a linear map.
fn spread(by: Matrix2<f64>, sigma: f64) -> Matrix2<f64> {
    sigma * sigma * by * by.transpose()
}

/// Takes a lens, an ideal point and the deviation of the distorted one.
type UndistortedNoise = fn(&RadialTangential, &Vector2<f64>, f64) -> Matrix2<f64>;

fn undistorted_noise(formula: UndistortedNoise) -> Comparison {
    let against = "the scatter of 20,000 noisy points that were undistorted, for each state";
    let euroc = worked::euroc().lens;
    Comparison::relative(against, 0.035).over(20, 12, |random| {
        let direction = direction(random);
        let ideal = random.uniform(0.75..0.95) * direction;
        let sigma = random.uniform(1e-3..3e-3);
        let shown = euroc.distort(&ideal);
        let mut scatter = Matrix2::zeros();
        for _ in 0..20_000 {
            let noise = Vector2::new(random.normal(sigma), random.normal(sigma));
            let off = euroc.undistort(&(shown + noise)).expect("it is in the image") - ideal;
            scatter += off * off.transpose() / 20_000.0;
        }
        (formula(&euroc, &ideal, sigma), scatter)
    })
}

fn conventions(chapter: &mut Chapter) {
    let formula: ByAdjoint = |left, t| left * se3::adjoint(t);
    let mutants: [(_, ByAdjoint); 5] = [
        ("inverse of the adjoint", |left, t| left * se3::adjoint(&t.inverse())),
        ("adjoint transposed", |left, t| left * se3::adjoint(t).transpose()),
        ("translation dropped", |left, t| left * se3::adjoint(&turn_of(t))),
        ("unchanged", |left, _| *left),
        ("rotation before translation", |left, t| {
            left * halves_exchanged() * se3::adjoint(t) * halves_exchanged()
        }),
    ];
    chapter.equation("left-right", left_right, formula, &mutants);
}

/// The pose without its translation.
fn turn_of(pose: &Isometry3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Default::default(), pose.rotation)
}

/// Takes the 2×6 block of a step on the left, and the pose.
type ByAdjoint = fn(&Matrix2x6<f64>, &Isometry3<f64>) -> Matrix2x6<f64>;

fn left_right(formula: ByAdjoint) -> Comparison {
    let against = "central differences on the right, from central differences on the left";
    Comparison::relative(against, 1e-8).over(STATES, 13, |random| {
        let (camera, pose, point) = state(random);
        let moved = |xi: &_| image_of(&camera, &moved_on_the_left(&pose, xi, &point));
        let right = pose_block_by_differences(&camera, &pose, &point);
        (formula(&differences(STEP, moved), &pose), right)
    })
}

fn mixed(chapter: &mut Chapter) {
    let formula: MixedError = |t, error| error - se3::adjoint(t) * error;
    let mutants: [(_, MixedError); 4] = [
        ("sign", |t, error| error + se3::adjoint(t) * error),
        ("inverse of the adjoint", |t, error| error - se3::adjoint(&t.inverse()) * error),
        ("identity dropped", |t, error| -se3::adjoint(t) * error),
        ("translation dropped", |t, error| error - se3::adjoint(&turn_of(t)) * error),
    ];
    chapter.equation("mixed-error", mixed_error, formula, &mutants);

    let mutants: [(_, MixedRate); 4] = [
        ("half angle dropped", |angle| 2.0 * angle.sin()),
        ("factor dropped", |angle| (angle / 2.0).sin()),
        ("cosine for sine", |angle| 2.0 * (angle / 2.0).cos()),
        ("real part only", |angle| 1.0 - angle.cos()),
    ];
    let formula: MixedRate = |angle| 2.0 * (angle / 2.0).sin();
    chapter.equation("mixed-rate", mixed_rate, formula, &mutants);
}

/// Takes the true pose and the error before a step, and gives the one after it.
type MixedError = fn(&Isometry3<f64>, &Vector6<f64>) -> Vector6<f64>;

fn mixed_error(formula: MixedError) -> Comparison {
    let against = "a Gauss-Newton step that takes the left block for the right one";
    Comparison::relative(against, 1e-3).over(100, 14, |random| {
        let camera = random.camera();
        let rotation = random.rotation(3.0);
        let truth = Isometry3::from_parts(random.direction(2.0).into(), rotation.into());
        let seen: Vec<_> = (0..20).map(|_| (random.point(2.0..10.0), Vector2::zeros())).collect();
        let error = twist_of(&random.direction(1e-6), &random.direction(1e-6));
        let after = after_a_mixed_step(&camera, &truth, &error, &seen);
        (1e6 * formula(&truth, &error), 1e6 * after)
    })
}

/// The error of a camera after a Gauss-Newton step with the left block, taken on the right. It sees
/// points, given in its coordinates, with noise in pixels. Of several steps it takes the shortest.
fn after_a_mixed_step(
    camera: &Pinhole,
    truth: &Isometry3<f64>,
    error: &Vector6<f64>,
    points: &[(Vector3<f64>, Vector2<f64>)],
) -> Vector6<f64> {
    let start = se3::retract(truth, error);
    let (mut hessian, mut gradient) = (Matrix6::zeros(), Vector6::zeros());
    for (in_camera, noise) in points {
        let point = truth.inverse_transform_point(&(*in_camera).into()).coords;
        let by_pose: Matrix2x6<f64> =
            differences(STEP, |xi| image_of(camera, &moved_on_the_left(&start, xi, &point)));
        let predicted = start.transform_point(&point.into()).coords;
        let residual = image_of(camera, &predicted) - image_of(camera, in_camera) - noise;
        hessian += by_pose.transpose() * by_pose;
        gradient += by_pose.transpose() * residual;
    }
    let negligible = 1e-9 * hessian.norm();
    let step = hessian.svd(true, true).solve(&-gradient, negligible);
    se3::local(truth, &se3::retract(&start, &step.expect("both factors are there")))
}

/// Takes the angle by which a camera is turned from the world.
type MixedRate = fn(f64) -> f64;

fn mixed_rate(formula: MixedRate) -> Comparison {
    let against = "the largest eigenvalue of the error's 6×6 matrix, computed numerically";
    Comparison::absolute(against, 1e-5, "").over(STATES, 15, |random| {
        let angle = random.uniform(0.05..3.1);
        let rotation = Rotation3::new(random.direction(angle));
        let pose = Isometry3::from_parts(random.direction(2.0).into(), rotation.into());
        let map = Matrix6::identity() - se3::adjoint(&pose);
        (formula(angle), map.complex_eigenvalues().map(|value| value.norm()).max())
    })
}
