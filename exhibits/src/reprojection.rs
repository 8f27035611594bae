//! What chapter `reprojection` shows: what moves a pixel, what one observation says, how a lens
//! bends the image, and what becomes of two conventions that are mixed.
//!
//! In formulas `k` is a camera, `t` a pose (camera from world) and `p` a point in the world.

mod counterexamples;
mod figures;
mod mixing;
mod numbers;
mod oracle;
mod worked;

use nalgebra::{
    Isometry3, Matrix2, Matrix2x3, Matrix2x6, Matrix3, Matrix6, Rotation3, SMatrix, Vector2,
    Vector3, Vector6,
};
use vislam::manifold::{se3, so3};
use vislam::reprojection::{LinearizedReproj, Pinhole, Projection, RadialTangential, ReprojFactor};

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;
use oracle::{differences, image_of, moved_on_the_left, moved_on_the_right};

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Step of the central differences, in metres and radians.
const STEP: f64 = 1e-3;

/// Stand for the Jacobians of a formula that gives none; no comparison accepts them.
const NO_POSE_BLOCK: Matrix2x6<f64> =
    Matrix2x6::from_array_storage(nalgebra::ArrayStorage([[f64::NAN; 2]; 6]));
const NO_POINT_BLOCK: Matrix2x3<f64> =
    Matrix2x3::from_array_storage(nalgebra::ArrayStorage([[f64::NAN; 2]; 3]));

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
    let formula: PixelLikelihood =
        |e, sigma| 0.5 * e.norm_squared() + (std::f64::consts::TAU * sigma * sigma).ln();
    let mutants: [(_, PixelLikelihood); 4] = [
        ("half dropped", |e, sigma| {
            e.norm_squared() + (std::f64::consts::TAU * sigma * sigma).ln()
        }),
        ("normalized in one dimension", |e, sigma| {
            0.5 * e.norm_squared() + 0.5 * (std::f64::consts::TAU * sigma * sigma).ln()
        }),
        ("norm not squared", |e, sigma| {
            0.5 * e.norm() + (std::f64::consts::TAU * sigma * sigma).ln()
        }),
        ("sign of the constant", |e, sigma| {
            0.5 * e.norm_squared() - (std::f64::consts::TAU * sigma * sigma).ln()
        }),
    ];
    chapter.equation("pixel-likelihood", pixel_likelihood, formula, &mutants);
}

/// Takes a whitened residual and the deviation of a pixel.
type PixelLikelihood = fn(&Vector2<f64>, f64) -> f64;

fn pixel_likelihood(formula: PixelLikelihood) -> Comparison {
    let against = "the bell-shaped surface, normalized by summing it over a grid of pixels";
    let mut comparison = Comparison::absolute(against, 1e-8, "nats");
    let mut random = Random::new(1);
    for _ in 0..50 {
        let sigma = random.uniform(0.3..3.0);
        let surface = |u: f64, v: f64| (-(u * u + v * v) / (2.0 * sigma * sigma)).exp();
        let spacing = 0.25 * sigma;
        let places = || (-40..=40).map(|index| spacing * f64::from(index));
        let volume: f64 = places().flat_map(|u| places().map(move |v| surface(u, v))).sum();
        let off = Vector2::new(random.normal(sigma), random.normal(sigma));
        let density = surface(off.x, off.y) / (volume * spacing * spacing);
        comparison.add(&[formula(&(off / sigma), sigma)], &[-density.ln()]);
    }
    comparison
}

fn projection(chapter: &mut Chapter) {
    let mutants: [(_, ProjectionJacobian); 5] = [
        ("sign of the third column", |k, p| with_third_column_times(k, p, -1.0)),
        ("third column dropped", |k, p| with_third_column_times(k, p, 0.0)),
        ("third column over Z, not its square", |k, p| with_third_column_times(k, p, p.z)),
        ("focal lengths exchanged", |k, p| {
            Pinhole { fx: k.fy, fy: k.fx, ..*k }.projection_jacobian(p)
        }),
        ("distance for depth", |k, p| k.projection_jacobian(&Vector3::new(p.x, p.y, p.norm()))),
    ];
    let formula = Pinhole::projection_jacobian;
    chapter.equation("projection-jacobian", projection_jacobian, formula, &mutants);
}

type ProjectionJacobian = fn(&Pinhole, &Vector3<f64>) -> Option<Matrix2x3<f64>>;

fn projection_jacobian(formula: ProjectionJacobian) -> Comparison {
    let mut comparison = Comparison::relative("central differences of the projection", 1e-9);
    let mut random = Random::new(2);
    for _ in 0..STATES {
        let camera = random.camera();
        let point = random.point(0.5..50.0);
        let step = STEP * point.z;
        let expected = differences(step, |step| image_of(&camera, &(point + step)));
        let jacobian = formula(&camera, &point).unwrap_or(NO_POINT_BLOCK);
        comparison.add(jacobian.as_slice(), expected.as_slice());
    }
    comparison
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
    let formula: MovedPoint = |t, p| beside(&matrix_of(t), &(-matrix_of(t) * so3::hat(p)));
    let mutants: [(_, MovedPoint); 5] = [
        ("sign of the skew", |t, p| beside(&matrix_of(t), &(matrix_of(t) * so3::hat(p)))),
        ("skew of the point in the camera", |t, p| {
            beside(&matrix_of(t), &(-matrix_of(t) * so3::hat(&in_camera(t, p))))
        }),
        ("rotation dropped", |_, p| beside(&Matrix3::identity(), &-so3::hat(p))),
        ("rotation transposed", |t, p| {
            let rotation = matrix_of(t).transpose();
            beside(&rotation, &(-rotation * so3::hat(p)))
        }),
        ("perturbed on the left", |t, p| {
            beside(&Matrix3::identity(), &-so3::hat(&in_camera(t, p)))
        }),
    ];
    chapter.equation("moved-point", moved_point, formula, &mutants);

    let formula: PoseBlock = |k, t, p| Some(k.jacobians(t, p)?.0);
    let mutants: [(_, PoseBlock); 6] = [
        ("perturbed on the left", |k, t, p| {
            Some(k.jacobians(t, p)?.0 * se3::adjoint(&t.inverse()))
        }),
        ("skew of the point in the camera", |k, t, p| {
            let by_point = k.jacobians(t, p)?.1;
            Some(by_point * beside(&Matrix3::identity(), &-so3::hat(&in_camera(t, p))))
        }),
        ("sign of the skew", |k, t, p| {
            Some(k.jacobians(t, p)?.1 * beside(&Matrix3::identity(), &so3::hat(p)))
        }),
        ("rotation before translation", |k, t, p| {
            Some(k.jacobians(t, p)?.1 * beside(&-so3::hat(p), &Matrix3::identity()))
        }),
        ("rotation dropped", |k, t, p| {
            let by_camera_point = k.projection_jacobian(&in_camera(t, p))?;
            Some(by_camera_point * beside(&Matrix3::identity(), &-so3::hat(p)))
        }),
        ("pose inverted", |k, t, p| Some(k.jacobians(t, p)?.0 * -se3::adjoint(t))),
    ];
    chapter.equation("pose-block", pose_block, formula, &mutants);

    let formula: PointBlock = |k, t, p| Some(k.jacobians(t, p)?.1);
    let mutants: [(_, PointBlock); 3] = [
        ("rotation dropped", |k, t, p| k.projection_jacobian(&in_camera(t, p))),
        ("rotation transposed", |k, t, p| {
            Some(k.projection_jacobian(&in_camera(t, p))? * matrix_of(t).transpose())
        }),
        ("sign", |k, t, p| Some(-k.jacobians(t, p)?.1)),
    ];
    chapter.equation("point-block", point_block, formula, &mutants);
}

/// The 3×6 matrix of two 3×3 ones side by side.
fn beside(left: &Matrix3<f64>, right: &Matrix3<f64>) -> SMatrix<f64, 3, 6> {
    let mut both = SMatrix::<f64, 3, 6>::zeros();
    both.fixed_columns_mut::<3>(0).copy_from(left);
    both.fixed_columns_mut::<3>(3).copy_from(right);
    both
}

type MovedPoint = fn(&Isometry3<f64>, &Vector3<f64>) -> SMatrix<f64, 3, 6>;

fn moved_point(formula: MovedPoint) -> Comparison {
    let against = "central differences of the matrix exponential by its power series";
    let mut comparison = Comparison::relative(against, 1e-10);
    let mut random = Random::new(3);
    for _ in 0..STATES {
        let (_, pose, point) = state(&mut random);
        let expected = differences(STEP, |xi| moved_on_the_right(&pose, xi, &point));
        comparison.add(formula(&pose, &point).as_slice(), expected.as_slice());
    }
    comparison
}

type PoseBlock = fn(&Pinhole, &Isometry3<f64>, &Vector3<f64>) -> Option<Matrix2x6<f64>>;

fn pose_block(formula: PoseBlock) -> Comparison {
    let against = "central differences of the projection, the pose moved by a power series";
    let mut comparison = Comparison::relative(against, 1e-8);
    let mut random = Random::new(4);
    for _ in 0..STATES {
        let (camera, pose, point) = state(&mut random);
        let expected = pose_block_by_differences(&camera, &pose, &point);
        let block = formula(&camera, &pose, &point).unwrap_or(NO_POSE_BLOCK);
        comparison.add(block.as_slice(), expected.as_slice());
    }
    comparison
}

fn pose_block_by_differences(
    camera: &Pinhole,
    pose: &Isometry3<f64>,
    point: &Vector3<f64>,
) -> Matrix2x6<f64> {
    differences(STEP, |xi| image_of(camera, &moved_on_the_right(pose, xi, point)))
}

type PointBlock = fn(&Pinhole, &Isometry3<f64>, &Vector3<f64>) -> Option<Matrix2x3<f64>>;

fn point_block(formula: PointBlock) -> Comparison {
    let mut comparison = Comparison::relative("central differences of the projection", 1e-8);
    let mut random = Random::new(5);
    for _ in 0..STATES {
        let (camera, pose, point) = state(&mut random);
        let seen = |step: &Vector3<f64>| image_of(&camera, &in_camera(&pose, &(point + step)));
        let block = formula(&camera, &pose, &point).unwrap_or(NO_POINT_BLOCK);
        comparison.add(block.as_slice(), differences(STEP, seen).as_slice());
    }
    comparison
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
        let LinearizedReproj { by_pose, by_point, .. } = factor.linearize(predicted);
        (by_pose, by_point)
    };
    chapter.equation("factor-blocks", factor_blocks, formula, &mutants);
}

type FactorBlocks = fn(&ReprojFactor, &Projection) -> (Matrix2x6<f64>, Matrix2x3<f64>);

fn scaled(predicted: &Projection, factor: f64) -> (Matrix2x6<f64>, Matrix2x3<f64>) {
    (factor * predicted.by_pose, factor * predicted.by_point)
}

fn factor_blocks(formula: FactorBlocks) -> Comparison {
    let against = "central differences of the whitened residual";
    let mut comparison = Comparison::relative(against, 1e-8);
    let mut random = Random::new(6);
    for _ in 0..STATES {
        let (camera, pose, point) = state(&mut random);
        let sigma = random.logarithmic(0.2..5.0);
        let predicted = camera.project_with_jacobians(&pose, &point).expect("it is in sight");
        let pixel = predicted.pixel + sigma * Vector2::new(random.normal(1.0), random.normal(1.0));
        let factor = ReprojFactor { keyframe: 0, point: 0, pixel, inverse_sigma: 1.0 / sigma };
        let residual = |in_camera: Vector3<f64>| (image_of(&camera, &in_camera) - pixel) / sigma;
        let by_pose: Matrix2x6<f64> =
            differences(STEP, |xi| residual(moved_on_the_right(&pose, xi, &point)));
        let by_point: Matrix2x3<f64> =
            differences(STEP, |step| residual(in_camera(&pose, &(point + step))));
        let (pose_block, point_block) = formula(&factor, &predicted);
        let both = [pose_block.as_slice(), point_block.as_slice()].concat();
        comparison.add(&both, &[by_pose.as_slice(), by_point.as_slice()].concat());
    }
    comparison
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

    let formula: NullSpace =
        |t, p| pose_null_space(p, &t.inverse_transform_vector(&in_camera(t, p)));
    let mutants: [(_, NullSpace); 4] = [
        ("sign of the skew", |t, p| {
            pose_null_space(&-p, &t.inverse_transform_vector(&in_camera(t, p)))
        }),
        ("skew of the point in the camera", |t, p| {
            pose_null_space(&in_camera(t, p), &t.inverse_transform_vector(&in_camera(t, p)))
        }),
        ("ray in the camera's frame", |t, p| pose_null_space(p, &in_camera(t, p))),
        ("point for ray", |_, p| pose_null_space(p, p)),
    ];
    chapter.equation("pose-null-space", null_space_of_pose_block, formula, &mutants);
}

/// Takes a point in a camera that stands upright at the world's origin.
type TurnToStep = fn(&Vector3<f64>) -> f64;

fn turn_to_step(formula: TurnToStep) -> Comparison {
    let against = "columns of the pixel moved by small turns and steps";
    let mut comparison = Comparison::relative(against, 1e-7);
    let mut random = Random::new(7);
    for _ in 0..STATES {
        let camera = random.camera();
        let slope = random.uniform(0.02..0.8) * random.uniform(-1.0..1.0).signum();
        let depth = random.logarithmic(1.0..50.0);
        let point = depth * Vector3::new(slope, random.uniform(-0.8..0.8), 1.0);
        let block = pose_block_by_differences(&camera, &Isometry3::identity(), &point);
        comparison.add(&[formula(&point)], &[(block[(0, 4)] / block[(0, 2)]).abs()]);
    }
    comparison
}

/// Four twists as columns: three turns about the point, and a step along its ray.
fn pose_null_space(point: &Vector3<f64>, ray_in_world: &Vector3<f64>) -> SMatrix<f64, 6, 4> {
    let mut basis = SMatrix::<f64, 6, 4>::zeros();
    basis.fixed_view_mut::<3, 3>(0, 0).copy_from(&so3::hat(point));
    basis.fixed_view_mut::<3, 3>(3, 0).copy_from(&Matrix3::identity());
    basis.fixed_view_mut::<3, 1>(0, 3).copy_from(ray_in_world);
    basis
}

type NullSpace = fn(&Isometry3<f64>, &Vector3<f64>) -> SMatrix<f64, 6, 4>;

fn null_space_of_pose_block(formula: NullSpace) -> Comparison {
    let against = "the null space of the differences' singular value decomposition";
    let mut comparison = Comparison::absolute(against, 1e-8, "");
    let mut random = Random::new(8);
    for _ in 0..STATES {
        let (camera, pose, point) = state(&mut random);
        let block = pose_block_by_differences(&camera, &pose, &point);
        let rows = block.svd(false, true).v_t.expect("it was asked for");
        let onto_null_space = Matrix6::identity() - rows.transpose() * rows;
        let basis = formula(&pose, &point).qr().q();
        comparison.add((basis * basis.transpose()).as_slice(), onto_null_space.as_slice());
    }
    comparison
}

fn lens(chapter: &mut Chapter) {
    let mutants: [(_, Distort); 4] = [
        ("p1 and p2 exchanged", |lens, p| {
            with_coefficients(lens, |[k1, k2, p1, p2, k3]| [k1, k2, p2, p1, k3]).distort(p)
        }),
        ("k3 before p1 and p2", |lens, p| {
            with_coefficients(lens, |[k1, k2, p1, p2, k3]| [k1, k2, k3, p1, p2]).distort(p)
        }),
        ("tangential part dropped", |lens, p| {
            with_coefficients(lens, |[k1, k2, _, _, k3]| [k1, k2, 0.0, 0.0, k3]).distort(p)
        }),
        ("radius for its square", |lens, p| {
            let [k1, k2, ..] = lens.coefficients();
            (1.0 + k1 * p.norm() + k2 * p.norm_squared()) * p
        }),
    ];
    chapter.equation("distortion", distortion, RadialTangential::distort, &mutants);

    let mutants: [(_, LensJacobian); 4] = [
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
        ("tangential part dropped", |lens, p| {
            with_coefficients(lens, |[k1, k2, _, _, k3]| [k1, k2, 0.0, 0.0, k3]).jacobian(p)
        }),
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
    let coefficients = [within(0.3), within(0.1), within(0.02), within(0.02), within(0.03)];
    lens_with(coefficients)
}

fn lens_with([k1, k2, p1, p2, k3]: [f64; 5]) -> RadialTangential {
    RadialTangential::new(k1, k2, p1, p2, k3).expect("finite coefficients")
}

fn with_coefficients(
    lens: &RadialTangential,
    change: fn([f64; 5]) -> [f64; 5],
) -> RadialTangential {
    lens_with(change(lens.coefficients()))
}

fn random_slope(random: &mut Random) -> Vector2<f64> {
    Vector2::new(random.uniform(-0.9..0.9), random.uniform(-0.9..0.9))
}

type Distort = fn(&RadialTangential, &Vector2<f64>) -> Vector2<f64>;

fn distortion(formula: Distort) -> Comparison {
    let against = "central differences of the scalar whose gradient it is";
    let mut comparison = Comparison::absolute(against, 1e-10, "");
    let mut random = Random::new(9);
    for _ in 0..STATES {
        let (lens, ideal) = (random_lens(&mut random), random_slope(&mut random));
        let gradient = differences(STEP, |step: &Vector2<f64>| {
            SMatrix::<f64, 1, 1>::new(oracle::lens_potential(&lens, &(ideal + step)))
        });
        comparison.add(formula(&lens, &ideal).as_slice(), gradient.as_slice());
    }
    comparison
}

type LensJacobian = fn(&RadialTangential, &Vector2<f64>) -> Matrix2<f64>;

fn distortion_jacobian(formula: LensJacobian) -> Comparison {
    let mut comparison =
        Comparison::absolute("central differences of the distorted point", 1e-9, "");
    let mut random = Random::new(10);
    for _ in 0..STATES {
        let (lens, ideal) = (random_lens(&mut random), random_slope(&mut random));
        let expected = differences(STEP, |step| lens.distort(&(ideal + step)));
        comparison.add(formula(&lens, &ideal).as_slice(), expected.as_slice());
    }
    comparison
}

/// Takes k1, k2, k3 and the square of the radius.
type Fold = fn([f64; 3], f64) -> f64;

fn fold(formula: Fold) -> Comparison {
    let against = "differences of the distorted radius along a ray";
    let mut comparison = Comparison::absolute(against, 1e-9, "");
    let mut random = Random::new(11);
    for _ in 0..STATES {
        let mut within = |size: f64| random.uniform(-size..size);
        let (k1, k2, k3) = (within(0.6), within(0.4), within(0.2));
        let lens = lens_with([k1, k2, 0.0, 0.0, k3]);
        let direction = random.uniform(0.0..std::f64::consts::TAU);
        let ray = Vector2::new(direction.cos(), direction.sin());
        let radius = random.uniform(0.1..1.2);
        let shown = |step: &SMatrix<f64, 1, 1>| lens.distort(&((radius + step[0]) * ray));
        let slope = ray.dot(&differences(STEP, shown));
        comparison.add(&[formula([k1, k2, k3], radius * radius)], &[slope]);
    }
    comparison
}

fn lens_and_noise(chapter: &mut Chapter) {
    let formula: UndistortedNoise = |lens, p, sigma| {
        let inverse = inverse_of(&lens.jacobian(p));
        sigma * sigma * inverse * inverse.transpose()
    };
    let mutants: [(_, UndistortedNoise); 4] = [
        ("unchanged", |_, _, sigma| sigma * sigma * Matrix2::identity()),
        ("Jacobian for its inverse", |lens, p, sigma| {
            sigma * sigma * lens.jacobian(p) * lens.jacobian(p).transpose()
        }),
        ("inverse on one side only", |lens, p, sigma| {
            sigma * sigma * inverse_of(&lens.jacobian(p))
        }),
        ("at the distorted point", |lens, p, sigma| {
            let inverse = inverse_of(&lens.jacobian(&lens.distort(&lens.distort(p))));
            sigma * sigma * inverse * inverse.transpose()
        }),
    ];
    chapter.equation("undistorted-noise", undistorted_noise, formula, &mutants);
}

fn inverse_of(matrix: &Matrix2<f64>) -> Matrix2<f64> {
    matrix.try_inverse().unwrap_or(Matrix2::repeat(f64::NAN))
}

/// Takes a lens, an ideal point and the deviation of the distorted one.
type UndistortedNoise = fn(&RadialTangential, &Vector2<f64>, f64) -> Matrix2<f64>;

fn undistorted_noise(formula: UndistortedNoise) -> Comparison {
    let against = "the scatter of 20,000 noisy points that were undistorted, for each state";
    let mut comparison = Comparison::relative(against, 0.035);
    let mut random = Random::new(12);
    let euroc = worked::euroc().lens;
    for _ in 0..20 {
        let direction = random.uniform(0.0..std::f64::consts::TAU);
        let ideal = random.uniform(0.75..0.95) * Vector2::new(direction.cos(), direction.sin());
        let sigma = random.uniform(1e-3..3e-3);
        let shown = euroc.distort(&ideal);
        let (mut scatter, draws) = (Matrix2::zeros(), 20_000);
        for _ in 0..draws {
            let noise = Vector2::new(random.normal(sigma), random.normal(sigma));
            let off = euroc
                .undistort(&(shown + noise))
                .map_or(Vector2::repeat(f64::NAN), |found| found - ideal);
            scatter += off * off.transpose() / f64::from(draws);
        }
        comparison.add(formula(&euroc, &ideal, sigma).as_slice(), scatter.as_slice());
    }
    comparison
}

fn conventions(chapter: &mut Chapter) {
    let formula: ByAdjoint = |left, t| left * se3::adjoint(t);
    let mutants: [(_, ByAdjoint); 5] = [
        ("inverse of the adjoint", |left, t| left * se3::adjoint(&t.inverse())),
        ("adjoint transposed", |left, t| left * se3::adjoint(t).transpose()),
        ("translation dropped", |left, t| {
            left * se3::adjoint(&Isometry3::from_parts(Default::default(), t.rotation))
        }),
        ("unchanged", |left, _| *left),
        ("rotation before translation", |left, t| {
            let adjoint = se3::adjoint(t);
            left * Matrix6::from_fn(|row, column| adjoint[((row + 3) % 6, (column + 3) % 6)])
        }),
    ];
    chapter.equation("left-right", left_right, formula, &mutants);
}

/// Takes the 2×6 block of a step on the left, and the pose.
type ByAdjoint = fn(&Matrix2x6<f64>, &Isometry3<f64>) -> Matrix2x6<f64>;

fn left_right(formula: ByAdjoint) -> Comparison {
    let against = "central differences on the right, from central differences on the left";
    let mut comparison = Comparison::relative(against, 1e-8);
    let mut random = Random::new(13);
    for _ in 0..STATES {
        let (camera, pose, point) = state(&mut random);
        let left = differences(STEP, |xi| image_of(&camera, &moved_on_the_left(&pose, xi, &point)));
        let right = pose_block_by_differences(&camera, &pose, &point);
        comparison.add(formula(&left, &pose).as_slice(), right.as_slice());
    }
    comparison
}

fn mixed(chapter: &mut Chapter) {
    let formula: MixedError = |t, error| error - se3::adjoint(t) * error;
    let mutants: [(_, MixedError); 4] = [
        ("sign", |t, error| error + se3::adjoint(t) * error),
        ("inverse of the adjoint", |t, error| error - se3::adjoint(&t.inverse()) * error),
        ("identity dropped", |t, error| -se3::adjoint(t) * error),
        ("translation dropped", |t, error| {
            let turn = Isometry3::from_parts(Default::default(), t.rotation);
            error - se3::adjoint(&turn) * error
        }),
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
    let mut comparison = Comparison::relative(against, 1e-3);
    let mut random = Random::new(14);
    for _ in 0..100 {
        let camera = random.camera();
        let rotation = random.rotation(3.0);
        let truth = Isometry3::from_parts(random.direction(2.0).into(), rotation.into());
        let seen: Vec<_> = (0..20).map(|_| (random.point(2.0..10.0), Vector2::zeros())).collect();
        let (first, second) = (random.direction(1e-6), random.direction(1e-6));
        let error = Vector6::new(first.x, first.y, first.z, second.x, second.y, second.z);
        let after = after_a_mixed_step(&camera, &truth, &error, &seen);
        comparison.add((1e6 * formula(&truth, &error)).as_slice(), (1e6 * after).as_slice());
    }
    comparison
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
    se3::local(truth, &se3::retract(&start, &step.unwrap_or(Vector6::repeat(f64::NAN))))
}

/// Takes the angle by which a camera is turned from the world.
type MixedRate = fn(f64) -> f64;

fn mixed_rate(formula: MixedRate) -> Comparison {
    let against = "the largest eigenvalue of the error's 6×6 matrix, computed numerically";
    let mut comparison = Comparison::absolute(against, 1e-5, "");
    let mut random = Random::new(15);
    for _ in 0..STATES {
        let angle = random.uniform(0.05..3.1);
        let rotation = Rotation3::new(random.direction(angle));
        let pose = Isometry3::from_parts(random.direction(2.0).into(), rotation.into());
        let map = Matrix6::identity() - se3::adjoint(&pose);
        let eigenvalues = map.complex_eigenvalues();
        let largest = eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        comparison.add(&[formula(angle)], &[largest]);
    }
    comparison
}
