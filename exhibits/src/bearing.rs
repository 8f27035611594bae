//! What chapter `bearing` shows: one image gives directions, a second one depth.
//!
//! Each part registers its equations, then checks them. In formulas `k` is a camera, `b` a
//! baseline, `s` a stretch and `rho` an inverse depth.

mod counterexamples;
mod figures;
mod noise;
mod numbers;
mod oracle;
mod worked;

use nalgebra::{Isometry3, Matrix2, Matrix2x3, Rotation3, Unit, Vector2, Vector3};
use vislam::bearing::{self as theory, InverseDepth};
use vislam::reprojection::Pinhole;

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;
use oracle::{central_difference, image_of, meeting_depth};

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Stands for the pixel of a formula that gives none; no comparison accepts it.
const NOWHERE: Vector2<f64> = Vector2::new(f64::NAN, f64::NAN);

/// Metres that stand for infinity: from there a point moves by less than 1e-11 px between two
/// cameras.
const FAR_AWAY: f64 = 1e15;

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    one_view(chapter);
    two_views(chapter);
    uncertain_depth(chapter);
    other_blindnesses(chapter);
    inverse_depth(chapter);
    projected_inverse_depth(chapter);
    counterexamples::counterexamples(chapter);
    numbers::numbers(chapter);
    figures::figures(chapter);
    noise::record(chapter);
}

fn one_view(chapter: &mut Chapter) {
    let mutants: [(_, Projection); 5] = [
        ("sign of x", |k, p| k.project_cam(&Vector3::new(-p.x, p.y, p.z))),
        ("distance for depth", |k, p| k.project_cam(&Vector3::new(p.x, p.y, p.norm()))),
        ("not divided by depth", |k, p| k.project_cam(&Vector3::new(p.x, p.y, 1.0))),
        ("focal lengths exchanged", |k, p| with_focal_lengths_exchanged(k).project_cam(p)),
        ("principal point dropped", |k, p| with_principal_point_dropped(k).project_cam(p)),
    ];
    chapter.equation("projection", projection, Pinhole::project_cam, &mutants);

    let mutants: [(_, Bearing); 4] = [
        ("K for its inverse", |k, pixel| {
            Unit::new_normalize(oracle::calibration(k) * pixel.push(1.0))
        }),
        ("focal lengths exchanged", |k, pixel| {
            theory::bearing(&with_focal_lengths_exchanged(k), pixel)
        }),
        ("principal point dropped", |k, pixel| {
            theory::bearing(&with_principal_point_dropped(k), pixel)
        }),
        ("not normalized", |k, pixel| Unit::new_unchecked(theory::back_project(k, pixel, 1.0))),
    ];
    chapter.equation("bearing", bearing, theory::bearing, &mutants);

    let mutants: [(_, Stretched); 3] = [
        ("stretched along the axis only", |k, p, s| {
            k.project_cam(&Vector3::new(p.x, p.y, s * p.z))
        }),
        ("stretched across the axis only", |k, p, s| {
            k.project_cam(&Vector3::new(s * p.x, s * p.y, p.z))
        }),
        ("pushed along the axis", |k, p, s| k.project_cam(&(p + s * Vector3::z()))),
    ];
    chapter.equation("depth-blind", depth_blind, |k, p, s| k.project_cam(&(s * p)), &mutants);
}

type Projection = fn(&Pinhole, &Vector3<f64>) -> Option<Vector2<f64>>;

fn projection(formula: Projection) -> Comparison {
    let against = "the line through the optical centre and the point, cut with the plane z = 1";
    let mut comparison = Comparison::absolute(against, 1e-11, "px");
    let mut random = Random::new(1);
    for _ in 0..STATES {
        let camera = random.camera();
        let point = random.point(0.1..100.0);
        let pixel = formula(&camera, &point).unwrap_or(NOWHERE);
        comparison.add(pixel.as_slice(), image_of(&camera, &point).as_slice());
    }
    comparison
}

type Bearing = fn(&Pinhole, &Vector2<f64>) -> Unit<Vector3<f64>>;

fn bearing(formula: Bearing) -> Comparison {
    let against = "the pixel of a point reached by walking along the ray, and the distance walked";
    let mut comparison = Comparison::relative(against, 1e-13);
    let mut random = Random::new(2);
    for _ in 0..STATES {
        let camera = random.camera();
        let pixel = image_of(&camera, &random.point(1.0..2.0));
        let walked = random.logarithmic(0.1..100.0);
        let reached = walked * formula(&camera, &pixel).into_inner();
        let seen = image_of(&camera, &reached);
        comparison.add(&[seen.x, seen.y, reached.norm()], &[pixel.x, pixel.y, walked]);
    }
    comparison
}

type Stretched = fn(&Pinhole, &Vector3<f64>, f64) -> Option<Vector2<f64>>;

fn depth_blind(formula: Stretched) -> Comparison {
    let against = "the pixel of the point before it was stretched";
    let mut comparison = Comparison::absolute(against, 1e-11, "px");
    let mut random = Random::new(3);
    for _ in 0..STATES {
        let camera = random.camera();
        let point = random.point(0.5..50.0);
        let stretch = random.logarithmic(0.2..20.0);
        let pixel = formula(&camera, &point, stretch).unwrap_or(NOWHERE);
        comparison.add(pixel.as_slice(), image_of(&camera, &point).as_slice());
    }
    comparison
}

fn two_views(chapter: &mut Chapter) {
    let mutants: [(_, Disparity); 5] = [
        ("sign", |k, b, depth| -theory::disparity(k, b, depth)),
        ("depth and baseline exchanged", |k, b, depth| theory::disparity(k, depth, b)),
        ("fy for fx", |k, b, depth| k.fy * b / depth),
        ("divided by depth twice", |k, b, depth| theory::disparity(k, b, depth) / depth),
        ("baseline dropped", |k, _, depth| k.fx / depth),
    ];
    chapter.equation("disparity", disparity, theory::disparity, &mutants);

    let mutants: [(_, Stretch); 4] = [
        ("sign", |k, b, depth, s| -theory::stretch_shift(k, b, depth, s)),
        ("s for 1/s", |k, b, depth, s| theory::stretch_shift(k, b, depth, 1.0 / s)),
        ("one dropped", |k, b, depth, s| -theory::disparity(k, b, depth) / s),
        ("linear in s", |k, b, depth, s| theory::disparity(k, b, depth) * (s - 1.0)),
    ];
    chapter.equation("stretch", stretch, theory::stretch_shift, &mutants);
}

/// Takes a camera, a baseline and a depth.
type Disparity = fn(&Pinhole, f64, f64) -> f64;

fn disparity(formula: Disparity) -> Comparison {
    let against = "the projections into both cameras";
    let mut comparison = Comparison::absolute(against, 1e-11, "px");
    let mut random = Random::new(4);
    for _ in 0..STATES {
        let camera = random.camera();
        let baseline = random.logarithmic(0.05..2.0);
        let point = random.point(0.5..100.0);
        let first = image_of(&camera, &point);
        let second = image_of(&camera, &(point - baseline * Vector3::x()));
        comparison.add(&[formula(&camera, baseline, point.z)], &[first.x - second.x]);
    }
    comparison
}

/// Takes a camera, a baseline, a depth and a stretch.
type Stretch = fn(&Pinhole, f64, f64, f64) -> f64;

fn stretch(formula: Stretch) -> Comparison {
    let against = "the second camera's pixels before and after";
    let mut comparison = Comparison::absolute(against, 1e-11, "px");
    let mut random = Random::new(5);
    for _ in 0..STATES {
        let camera = random.camera();
        let baseline = random.logarithmic(0.05..2.0);
        let point = random.point(0.5..100.0);
        let stretch = random.logarithmic(0.5..3.0);
        let seen = |point: Vector3<f64>| image_of(&camera, &(point - baseline * Vector3::x()));
        let shift = seen(stretch * point).x - seen(point).x;
        comparison.add(&[formula(&camera, baseline, point.z, stretch)], &[shift]);
    }
    comparison
}

fn uncertain_depth(chapter: &mut Chapter) {
    let mutants: [(_, DepthSigma); 4] = [
        ("depth not squared", |k, b, depth, sigma| theory::depth_sigma(k, b, depth, sigma) / depth),
        ("baseline above the line", |k, b, depth, sigma| {
            theory::depth_sigma(k, 1.0 / b, depth, sigma)
        }),
        ("focal length dropped", |_, b, depth, sigma| depth * depth * sigma / b),
        ("fy for fx", |k, b, depth, sigma| depth * depth * sigma / (k.fy * b)),
    ];
    chapter.equation("depth-sigma", depth_sigma, theory::depth_sigma, &mutants);

    let mutants: [(_, DisparityNoise); 4] = [
        ("deviations added", |first, second| first + second),
        ("deviations subtracted", |first, second| (first - second).abs()),
        ("noise in the first image only", |first, _| first),
        ("root dropped", |first, second| first * first + second * second),
    ];
    chapter.equation("disparity-noise", disparity_noise, theory::disparity_sigma, &mutants);

    let formula: DepthSigma = |k, b, depth, sigma| (sigma / k.fx) / (b / depth);
    let mutants: [(_, DepthSigma); 4] = [
        ("parallax squared", |k, b, depth, sigma| (sigma / k.fx) / (b / depth).powi(2)),
        ("times parallax", |k, b, depth, sigma| (sigma / k.fx) * (b / depth)),
        ("baseline for parallax", |k, b, _, sigma| (sigma / k.fx) / b),
        ("pixels for angle", |_, b, depth, sigma| sigma / (b / depth)),
    ];
    chapter.equation("parallax-depth", parallax_depth, formula, &mutants);
}

/// Takes a camera, a baseline, a depth and the standard deviation of the disparity.
type DepthSigma = fn(&Pinhole, f64, f64, f64) -> f64;

fn depth_sigma(formula: DepthSigma) -> Comparison {
    compared_with_meeting_rays(6, formula, |sigma, _| sigma)
}

fn parallax_depth(formula: DepthSigma) -> Comparison {
    compared_with_meeting_rays(7, formula, |sigma, depth| sigma / depth)
}

/// Compares `formula` with `expected`, which is given the true standard deviation of depth, and the
/// depth.
fn compared_with_meeting_rays(
    seed: u64,
    formula: DepthSigma,
    expected: fn(f64, f64) -> f64,
) -> Comparison {
    let against = "central differences of the depth at which the two rays meet";
    let mut comparison = Comparison::relative(against, 1e-7);
    let mut random = Random::new(seed);
    for _ in 0..STATES {
        let camera = random.camera();
        let baseline = random.logarithmic(0.05..2.0);
        let point = random.point(0.5..100.0);
        let sigma = random.uniform(0.2..3.0);
        let first = image_of(&camera, &point).x;
        let second = image_of(&camera, &(point - baseline * Vector3::x())).x;
        let depth = |second| meeting_depth(&camera, baseline, first, second);
        let slope = central_difference(depth, second, 1e-4 * (first - second));
        let true_sigma = slope.abs() * sigma;
        let value = formula(&camera, baseline, point.z, sigma);
        comparison.add(&[value], &[expected(true_sigma, point.z)]);
    }
    comparison
}

/// Takes the standard deviations of the noise in the first and in the second image.
type DisparityNoise = fn(f64, f64) -> f64;

fn disparity_noise(formula: DisparityNoise) -> Comparison {
    let against = "Monte Carlo with 20,000 noisy pairs of pixels for each state";
    let mut comparison = Comparison::relative(against, 0.02);
    let mut random = Random::new(8);
    for state in 0..25 {
        let first_sigma = random.uniform(0.5..2.0);
        let second_sigma = random.uniform(0.5..2.0);
        let measured = noise::Pair { first_sigma, second_sigma, ..noise::Pair::worked() };
        let drawn = noise::Moments::of(measured.disparities(100 + state).take(20_000));
        comparison.add(&[formula(first_sigma, second_sigma)], &[drawn.deviation()]);
    }
    comparison
}

fn other_blindnesses(chapter: &mut Chapter) {
    let formula: Scaled = |k, r, centre, p, s| picture(k, r, &(s * centre), &(s * p));
    let mutants: [(_, Scaled); 3] = [
        ("centres stay", |k, r, centre, p, s| picture(k, r, centre, &(s * p))),
        ("points stay", |k, r, centre, p, s| picture(k, r, &(s * centre), p)),
        ("centres shrink", |k, r, centre, p, s| picture(k, r, &(centre / s), &(s * p))),
    ];
    chapter.equation("scale-blind", scale_blind, formula, &mutants);

    let mutants: [(_, Turned); 3] = [
        ("rotation transposed", |k, r, pixel| {
            theory::transfer_by_infinite_homography(k, &r.inverse(), pixel)
        }),
        ("K and its inverse dropped", |_, r, pixel| dehomogenized(r * pixel.push(1.0))),
        ("K and its inverse exchanged", |k, r, pixel| {
            let calibration = oracle::calibration(k);
            let turned = r * (calibration * pixel.push(1.0));
            dehomogenized(calibration.try_inverse()? * turned)
        }),
    ];
    chapter.equation(
        "rotation-blind",
        rotation_blind,
        theory::transfer_by_infinite_homography,
        &mutants,
    );
}

/// Takes a camera, its rotation from the world, its centre, a point and the scale of the world.
type Scaled =
    fn(&Pinhole, &Rotation3<f64>, &Vector3<f64>, &Vector3<f64>, f64) -> Option<Vector2<f64>>;

fn scale_blind(formula: Scaled) -> Comparison {
    let against = "the pixel in the world of the first size";
    let mut comparison = Comparison::absolute(against, 1e-10, "px");
    let mut random = Random::new(9);
    for _ in 0..STATES {
        let camera = random.camera();
        let rotation = random.rotation(3.0);
        let centre = random.direction(2.0);
        let point_in_camera = random.point(1.0..50.0);
        let point = rotation.inverse() * point_in_camera + centre;
        let scale = random.logarithmic(0.2..5.0);
        let pixel = formula(&camera, &rotation, &centre, &point, scale).unwrap_or(NOWHERE);
        comparison.add(pixel.as_slice(), image_of(&camera, &point_in_camera).as_slice());
    }
    comparison
}

/// What a camera with this centre sees of a point.
fn picture(
    camera: &Pinhole,
    camera_from_world: &Rotation3<f64>,
    centre: &Vector3<f64>,
    point: &Vector3<f64>,
) -> Option<Vector2<f64>> {
    let translation = -(camera_from_world * centre);
    let pose = Isometry3::from_parts(translation.into(), (*camera_from_world).into());
    camera.project(&pose, point)
}

type Turned = fn(&Pinhole, &Rotation3<f64>, &Vector2<f64>) -> Option<Vector2<f64>>;

fn rotation_blind(formula: Turned) -> Comparison {
    let against = "projections of points at any depth on the ray";
    let mut comparison = Comparison::absolute(against, 1e-10, "px");
    let mut random = Random::new(10);
    for _ in 0..STATES {
        let camera = random.camera();
        let rotation = random.rotation(0.35);
        let point = random.point(0.5..500.0);
        let pixel = image_of(&camera, &point);
        let turned = formula(&camera, &rotation, &pixel).unwrap_or(NOWHERE);
        comparison.add(turned.as_slice(), image_of(&camera, &(rotation * point)).as_slice());
    }
    comparison
}

fn dehomogenized(pixel: Vector3<f64>) -> Option<Vector2<f64>> {
    Some(pixel.xy() / pixel.z)
}

fn inverse_depth(chapter: &mut Chapter) {
    let formula: InverseDepthLine = |k, b, u, rho| u - k.fx * b * rho;
    let mutants: [(_, InverseDepthLine); 4] = [
        ("sign", |k, b, u, rho| u + k.fx * b * rho),
        ("inverse depth squared", |k, b, u, rho| u - k.fx * b * rho * rho),
        ("focal length dropped", |_, b, u, rho| u - b * rho),
        ("first pixel dropped", |k, b, _, rho| -k.fx * b * rho),
    ];
    chapter.equation("inverse-depth-line", inverse_depth_line, formula, &mutants);

    let formula = theory::inverse_depth_sigma;
    let mutants: [(_, InverseDepthSigma); 3] = [
        ("baseline above the line", |k, b, sigma| sigma * b / k.fx),
        ("focal length dropped", |_, b, sigma| sigma / b),
        ("fy for fx", |k, b, sigma| sigma / (k.fy * b)),
    ];
    chapter.equation("inverse-depth-sigma", inverse_depth_sigma, formula, &mutants);
}

/// Takes a camera, a baseline, the column of the first pixel and an inverse depth.
type InverseDepthLine = fn(&Pinhole, f64, f64, f64) -> f64;

fn inverse_depth_line(formula: InverseDepthLine) -> Comparison {
    let against = "the projection of the point, one in ten of them at infinity";
    let mut comparison = Comparison::absolute(against, 1e-10, "px");
    let mut random = Random::new(11);
    for state in 0..STATES {
        let camera = random.camera();
        let baseline = random.logarithmic(0.05..2.0);
        let (landmark, point) = landmark_and_point(&mut random, state);
        let first = image_of(&camera, &point).x;
        let second = image_of(&camera, &(point - baseline * Vector3::x())).x;
        comparison.add(&[formula(&camera, baseline, first, landmark.inverse_depth)], &[second]);
    }
    comparison
}

/// Takes a camera, a baseline and the standard deviation of the disparity.
type InverseDepthSigma = fn(&Pinhole, f64, f64) -> f64;

fn inverse_depth_sigma(formula: InverseDepthSigma) -> Comparison {
    let against = "central differences of the inverse depth at which the two rays meet";
    let mut comparison = Comparison::relative(against, 1e-9);
    let mut random = Random::new(14);
    for _ in 0..STATES {
        let camera = random.camera();
        let baseline = random.logarithmic(0.05..2.0);
        let point = random.point(0.5..100.0);
        let sigma = random.uniform(0.2..3.0);
        let first = image_of(&camera, &point).x;
        let second = image_of(&camera, &(point - baseline * Vector3::x())).x;
        let inverse_depth = |second| 1.0 / meeting_depth(&camera, baseline, first, second);
        let slope = central_difference(inverse_depth, second, 1e-2 * (first - second));
        comparison.add(&[formula(&camera, baseline, sigma)], &[slope.abs() * sigma]);
    }
    comparison
}

fn projected_inverse_depth(chapter: &mut Chapter) {
    let formula = InverseDepth::project_into;
    let mutants: [(_, InverseDepthProjection); 5] = [
        ("translation not times inverse depth", |point, k, motion| {
            with_inverse_depth(1.0, point).project_into(k, motion)
        }),
        ("translation dropped", |point, k, motion| {
            with_inverse_depth(0.0, point).project_into(k, motion)
        }),
        ("sign of the translation", |point, k, motion| {
            point.project_into(k, &with_translation_negated(motion))
        }),
        ("rotation transposed", |point, k, motion| {
            point.project_into(k, &with_rotation_transposed(motion))
        }),
        ("motion inverted", |point, k, motion| point.project_into(k, &motion.inverse())),
    ];
    chapter.equation("inverse-depth-projection", inverse_depth_projection, formula, &mutants);

    let formula = InverseDepth::project_with_jacobian;
    let mutants: [(_, InverseDepthJacobian); 5] = [
        ("rotation transposed", |point, k, motion| {
            point.project_with_jacobian(k, &with_rotation_transposed(motion))
        }),
        ("sign of the last column", |point, k, motion| {
            with_last_column_times(-1.0, point.project_with_jacobian(k, motion))
        }),
        ("last column dropped", |point, k, motion| {
            with_last_column_times(0.0, point.project_with_jacobian(k, motion))
        }),
        ("by depth for by inverse depth", |point, k, motion| {
            let factor = -point.inverse_depth.powi(2);
            with_last_column_times(factor, point.project_with_jacobian(k, motion))
        }),
        ("second depth held fixed", with_second_depth_held_fixed),
    ];
    chapter.equation("inverse-depth-jacobian", inverse_depth_jacobian, formula, &mutants);
}

type InverseDepthProjection = fn(&InverseDepth, &Pinhole, &Isometry3<f64>) -> Option<Vector2<f64>>;

fn inverse_depth_projection(formula: InverseDepthProjection) -> Comparison {
    let against = "the projection of the moved point, one in ten of them at infinity";
    let mut comparison = Comparison::absolute(against, 1e-10, "px");
    let mut random = Random::new(12);
    for state in 0..STATES {
        let camera = random.camera();
        let (landmark, point) = landmark_and_point(&mut random, state);
        let second_from_first = small_motion(&mut random);
        let pixel = formula(&landmark, &camera, &second_from_first).unwrap_or(NOWHERE);
        let moved = second_from_first.transform_point(&point.into()).coords;
        comparison.add(pixel.as_slice(), image_of(&camera, &moved).as_slice());
    }
    comparison
}

type InverseDepthJacobian =
    fn(&InverseDepth, &Pinhole, &Isometry3<f64>) -> Option<(Vector2<f64>, Matrix2x3<f64>)>;

fn inverse_depth_jacobian(formula: InverseDepthJacobian) -> Comparison {
    let against = "central differences, one in ten at infinity";
    let mut comparison = Comparison::relative(against, 1e-9);
    let mut random = Random::new(13);
    for state in 0..STATES {
        let camera = random.camera();
        let (landmark, _) = landmark_and_point(&mut random, state);
        let second_from_first = small_motion(&mut random);
        let parameters = Vector3::new(landmark.x, landmark.y, landmark.inverse_depth);
        let pixel = |p: Vector3<f64>| {
            let ray = second_from_first.rotation * Vector3::new(p.x, p.y, 1.0);
            image_of(&camera, &(ray + p.z * second_from_first.translation.vector))
        };
        let step = 1e-5;
        let differences = Matrix2x3::from_fn(|row, column| {
            let along = |change| pixel(parameters + change * Vector3::ith(column, 1.0))[row];
            central_difference(along, 0.0, step)
        });
        let jacobian = formula(&landmark, &camera, &second_from_first)
            .map_or(Matrix2x3::repeat(f64::NAN), |(_, jacobian)| jacobian);
        comparison.add(jacobian.as_slice(), differences.as_slice());
    }
    comparison
}

/// A point in the first camera, as inverse depth and as coordinates; every tenth lies at infinity.
fn landmark_and_point(random: &mut Random, state: usize) -> (InverseDepth, Vector3<f64>) {
    let point = random.point(1.0..200.0);
    let ray = point / point.z;
    let (inverse_depth, depth) =
        if state.is_multiple_of(10) { (0.0, FAR_AWAY) } else { (1.0 / point.z, point.z) };
    (InverseDepth { x: ray.x, y: ray.y, inverse_depth }, depth * ray)
}

/// A motion after which every landmark is still in front of the camera.
fn small_motion(random: &mut Random) -> Isometry3<f64> {
    let rotation = random.rotation(0.35);
    let length = random.uniform(0.1..0.3);
    Isometry3::from_parts(random.direction(length).into(), rotation.into())
}

fn with_focal_lengths_exchanged(camera: &Pinhole) -> Pinhole {
    Pinhole { fx: camera.fy, fy: camera.fx, ..*camera }
}

fn with_principal_point_dropped(camera: &Pinhole) -> Pinhole {
    Pinhole { cx: 0.0, cy: 0.0, ..*camera }
}

fn with_inverse_depth(inverse_depth: f64, point: &InverseDepth) -> InverseDepth {
    InverseDepth { inverse_depth, ..*point }
}

fn with_translation_negated(motion: &Isometry3<f64>) -> Isometry3<f64> {
    let opposite = -motion.translation.vector;
    Isometry3::from_parts(opposite.into(), motion.rotation)
}

fn with_rotation_transposed(motion: &Isometry3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(motion.translation, motion.rotation.inverse())
}

type PixelAndJacobian = Option<(Vector2<f64>, Matrix2x3<f64>)>;

fn with_last_column_times(factor: f64, projected: PixelAndJacobian) -> PixelAndJacobian {
    let (pixel, mut jacobian) = projected?;
    jacobian.column_mut(2).scale_mut(factor);
    Some((pixel, jacobian))
}

fn with_second_depth_held_fixed(
    landmark: &InverseDepth,
    camera: &Pinhole,
    second_from_first: &Isometry3<f64>,
) -> PixelAndJacobian {
    let pixel = landmark.project_into(camera, second_from_first)?;
    let mut h_by_parameters = second_from_first.rotation.to_rotation_matrix().into_inner();
    h_by_parameters.set_column(2, &second_from_first.translation.vector);
    let depth = (h_by_parameters * Vector3::new(landmark.x, landmark.y, landmark.inverse_depth)).z;
    let scale = Matrix2::new(camera.fx, 0.0, 0.0, camera.fy) / depth;
    Some((pixel, scale * h_by_parameters.fixed_rows::<2>(0)))
}
