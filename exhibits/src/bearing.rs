//! What chapter `bearing` shows: one image gives directions, a second one depth.
//!
//! Each part registers its equations, then checks them. In formulas `k` is a camera, `b` a
//! baseline, `s` a stretch and `rho` an inverse depth.

mod counterexamples;
mod figures;
pub mod noise;
mod numbers;
mod oracle;
pub mod worked;

use nalgebra::{Isometry3, Matrix2, Matrix2x3, Rotation3, Unit, Vector2, Vector3};
use vislam::bearing::{self as theory, InverseDepth, transfer_by_infinite_homography as transfer};
use vislam::reprojection::Pinhole;

use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};
use crate::one_flight;
use crate::random::Random;
use noise::Pair;
use oracle::{calibration, image_of};

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Stands for the pixel of a point that has none; no comparison accepts it.
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
    one_flight::one_picture::bearings(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    noise::record(chapter);
}

fn one_view(chapter: &mut Chapter) {
    let mutants: [(_, Projection); 5] = [
        ("sign of x", |k, p| k.project_cam(&Vector3::new(-p.x, p.y, p.z))),
        ("distance for depth", |k, p| k.project_cam(&Vector3::new(p.x, p.y, p.norm()))),
        ("not divided by depth", |k, p| k.project_cam(&Vector3::new(p.x, p.y, 1.0))),
        ("focal lengths exchanged", |k, p| exchanged(k).project_cam(p)),
        ("principal point dropped", |k, p| uncentred(k).project_cam(p)),
    ];
    chapter.equation("projection", projection, Pinhole::project_cam, &mutants);

    let mutants: [(_, Bearing); 4] = [
        ("K for its inverse", |k, u| Unit::new_normalize(calibration(k) * u.push(1.0))),
        ("focal lengths exchanged", |k, u| theory::bearing(&exchanged(k), u)),
        ("principal point dropped", |k, u| theory::bearing(&uncentred(k), u)),
        ("not normalized", |k, u| Unit::new_unchecked(theory::back_project(k, u, 1.0))),
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

pub fn exchanged(camera: &Pinhole) -> Pinhole {
    Pinhole { fx: camera.fy, fy: camera.fx, ..*camera }
}

fn uncentred(camera: &Pinhole) -> Pinhole {
    Pinhole { cx: 0.0, cy: 0.0, ..*camera }
}

type Projection = fn(&Pinhole, &Vector3<f64>) -> Option<Vector2<f64>>;

fn projection(formula: Projection) -> Comparison {
    let against = "the line through the optical centre and the point, cut with the plane z = 1";
    Comparison::absolute(against, 1e-11, "px").over(STATES, 1, |random| {
        let (camera, point) = (random.camera(), random.point(0.1..100.0));
        (formula(&camera, &point), image_of(&camera, &point))
    })
}

type Bearing = fn(&Pinhole, &Vector2<f64>) -> Unit<Vector3<f64>>;

fn bearing(formula: Bearing) -> Comparison {
    let against = "the pixel of a point reached by walking along the ray, and the distance walked";
    Comparison::relative(against, 1e-13).over(STATES, 2, |random| {
        let camera = random.camera();
        let pixel = image_of(&camera, &random.point(1.0..2.0));
        let walked = random.logarithmic(0.1..100.0);
        let reached = walked * formula(&camera, &pixel).into_inner();
        ((image_of(&camera, &reached), reached.norm()), (pixel, walked))
    })
}

type Stretched = fn(&Pinhole, &Vector3<f64>, f64) -> Option<Vector2<f64>>;

fn depth_blind(formula: Stretched) -> Comparison {
    let against = "the pixel of the point before it was stretched";
    Comparison::absolute(against, 1e-11, "px").over(STATES, 3, |random| {
        let (camera, point) = (random.camera(), random.point(0.5..50.0));
        let stretched = formula(&camera, &point, random.logarithmic(0.2..20.0));
        (stretched, image_of(&camera, &point))
    })
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
    Comparison::absolute(against, 1e-11, "px").over(STATES, 4, |random| {
        let pair = Pair::random(random);
        let [first, second] = pair.columns();
        (formula(&pair.camera, pair.baseline, pair.point.z), first - second)
    })
}

/// Takes a camera, a baseline, a depth and a stretch.
type Stretch = fn(&Pinhole, f64, f64, f64) -> f64;

fn stretch(formula: Stretch) -> Comparison {
    let against = "the second camera's pixels before and after";
    Comparison::absolute(against, 1e-11, "px").over(STATES, 5, |random| {
        let (pair, s) = (Pair::random(random), random.logarithmic(0.5..3.0));
        let stretched = Pair { point: s * pair.point, ..pair };
        let shift = stretched.columns()[1] - pair.columns()[1];
        (formula(&pair.camera, pair.baseline, pair.point.z, s), shift)
    })
}

fn uncertain_depth(chapter: &mut Chapter) {
    let mutants: [(_, DepthSigma); 4] = [
        ("depth not squared", |k, b, z, sigma| theory::depth_sigma(k, b, z, sigma) / z),
        ("baseline above the line", |k, b, z, sigma| theory::depth_sigma(k, 1.0 / b, z, sigma)),
        ("focal length dropped", |_, b, z, sigma| z * z * sigma / b),
        ("fy for fx", |k, b, z, sigma| z * z * sigma / (k.fy * b)),
    ];
    chapter.equation("depth-sigma", depth_sigma, theory::depth_sigma, &mutants);

    let mutants: [(_, DisparityNoise); 4] = [
        ("deviations added", |first, second| first + second),
        ("deviations subtracted", |first, second| (first - second).abs()),
        ("noise in the first image only", |first, _| first),
        ("root dropped", |first, second| first * first + second * second),
    ];
    chapter.equation("disparity-noise", disparity_noise, theory::disparity_sigma, &mutants);

    let formula: DepthSigma = |k, b, z, sigma| (sigma / k.fx) / (b / z);
    let mutants: [(_, DepthSigma); 4] = [
        ("parallax squared", |k, b, z, sigma| (sigma / k.fx) / (b / z).powi(2)),
        ("times parallax", |k, b, z, sigma| (sigma / k.fx) * (b / z)),
        ("baseline for parallax", |k, b, _, sigma| (sigma / k.fx) / b),
        ("pixels for angle", |_, b, z, sigma| sigma / (b / z)),
    ];
    chapter.equation("parallax-depth", parallax_depth, formula, &mutants);
}

/// Takes a camera, a baseline, a depth and the standard deviation of the disparity.
type DepthSigma = fn(&Pinhole, f64, f64, f64) -> f64;

fn depth_sigma(formula: DepthSigma) -> Comparison {
    let against = "central differences of the depth at which the two rays meet";
    Comparison::relative(against, 1e-7).over(STATES, 6, |random| {
        let (pair, sigma) = (Pair::random(random), random.uniform(0.2..3.0));
        let true_sigma = pair.slope(|depth| depth, 1e-4).abs() * sigma;
        (formula(&pair.camera, pair.baseline, pair.point.z, sigma), true_sigma)
    })
}

fn parallax_depth(formula: DepthSigma) -> Comparison {
    let against = "central differences of the depth at which the two rays meet";
    Comparison::relative(against, 1e-7).over(STATES, 7, |random| {
        let (pair, sigma) = (Pair::random(random), random.uniform(0.2..3.0));
        let true_sigma = pair.slope(|depth| depth, 1e-4).abs() * sigma;
        let depth = pair.point.z;
        (formula(&pair.camera, pair.baseline, depth, sigma), true_sigma / depth)
    })
}

/// Takes the standard deviations of the noise in the first and in the second image.
type DisparityNoise = fn(f64, f64) -> f64;

fn disparity_noise(formula: DisparityNoise) -> Comparison {
    let against = "Monte Carlo with 20,000 noisy pairs of pixels for each state";
    let mut random = Random::new(8);
    Comparison::relative(against, 0.02).each(100..125, |seed| {
        let [first_sigma, second_sigma] = [(); 2].map(|()| random.uniform(0.5..2.0));
        let measured = Pair { first_sigma, second_sigma, ..Pair::worked() };
        let drawn = noise::Moments::of(measured.disparities(seed).take(20_000));
        (formula(first_sigma, second_sigma), drawn.deviation())
    })
}

fn other_blindnesses(chapter: &mut Chapter) {
    let formula: Scaled = |k, r, c, p, s| k.project(&pose(r, &(s * c)), &(s * p));
    let mutants: [(_, Scaled); 3] = [
        ("centres stay", |k, r, c, p, s| k.project(&pose(r, c), &(s * p))),
        ("points stay", |k, r, c, p, s| k.project(&pose(r, &(s * c)), p)),
        ("centres shrink", |k, r, c, p, s| k.project(&pose(r, &(c / s)), &(s * p))),
    ];
    chapter.equation("scale-blind", scale_blind, formula, &mutants);

    let mutants: [(_, Turned); 3] = [
        ("rotation transposed", |k, r, u| transfer(k, &r.inverse(), u)),
        ("K and its inverse dropped", |_, r, u| dehomogenized(r * u.push(1.0))),
        ("K and its inverse exchanged", |k, r, u| {
            dehomogenized(calibration(k).try_inverse()? * (r * (calibration(k) * u.push(1.0))))
        }),
    ];
    chapter.equation("rotation-blind", rotation_blind, transfer, &mutants);
}

/// Takes a camera, its rotation from the world, its centre, a point and the scale of the world.
type Scaled =
    fn(&Pinhole, &Rotation3<f64>, &Vector3<f64>, &Vector3<f64>, f64) -> Option<Vector2<f64>>;

fn scale_blind(formula: Scaled) -> Comparison {
    let against = "the pixel in the world of the first size";
    Comparison::absolute(against, 1e-10, "px").over(STATES, 9, |random| {
        let (camera, rotation) = (random.camera(), random.rotation(3.0));
        let (centre, in_camera) = (random.direction(2.0), random.point(1.0..50.0));
        let point = rotation.inverse() * in_camera + centre;
        let scale = random.logarithmic(0.2..5.0);
        (formula(&camera, &rotation, &centre, &point, scale), image_of(&camera, &in_camera))
    })
}

/// Camera from world, by the camera's rotation and its centre in the world.
fn pose(camera_from_world: &Rotation3<f64>, centre: &Vector3<f64>) -> Isometry3<f64> {
    let translation = -(camera_from_world * centre);
    Isometry3::from_parts(translation.into(), (*camera_from_world).into())
}

type Turned = fn(&Pinhole, &Rotation3<f64>, &Vector2<f64>) -> Option<Vector2<f64>>;

fn rotation_blind(formula: Turned) -> Comparison {
    let against = "projections of points at any depth on the ray";
    Comparison::absolute(against, 1e-10, "px").over(STATES, 10, |random| {
        let (camera, rotation) = (random.camera(), random.rotation(0.35));
        let point = random.point(0.5..500.0);
        let turned = formula(&camera, &rotation, &image_of(&camera, &point));
        (turned, image_of(&camera, &(rotation * point)))
    })
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
    let mut random = Random::new(11);
    Comparison::absolute(against, 1e-10, "px").each(0..STATES, |state| {
        let (camera, baseline) = (random.camera(), random.logarithmic(0.05..2.0));
        let (landmark, point) = landmark_and_point(&mut random, state);
        let [first, second] = Pair { camera, baseline, point, ..Pair::worked() }.columns();
        (formula(&camera, baseline, first, landmark.inverse_depth), second)
    })
}

/// Takes a camera, a baseline and the standard deviation of the disparity.
type InverseDepthSigma = fn(&Pinhole, f64, f64) -> f64;

fn inverse_depth_sigma(formula: InverseDepthSigma) -> Comparison {
    let against = "central differences of the inverse depth at which the two rays meet";
    Comparison::relative(against, 1e-9).over(STATES, 14, |random| {
        let (pair, sigma) = (Pair::random(random), random.uniform(0.2..3.0));
        let slope = pair.slope(|depth| 1.0 / depth, 1e-2);
        (formula(&pair.camera, pair.baseline, sigma), slope.abs() * sigma)
    })
}

fn projected_inverse_depth(chapter: &mut Chapter) {
    let formula = InverseDepth::project_into;
    let mutants: [(_, InverseDepthProjection); 5] = [
        ("translation not times inverse depth", |p, k, t| with_rho(1.0, p).project_into(k, t)),
        ("translation dropped", |p, k, t| with_rho(0.0, p).project_into(k, t)),
        ("sign of the translation", |p, k, t| {
            p.project_into(k, &Isometry3::from_parts(t.translation.inverse(), t.rotation))
        }),
        ("rotation transposed", |p, k, t| p.project_into(k, &turned_back(t))),
        ("motion inverted", |p, k, t| p.project_into(k, &t.inverse())),
    ];
    chapter.equation("inverse-depth-projection", inverse_depth_projection, formula, &mutants);

    let formula = InverseDepth::project_with_jacobian;
    let mutants: [(_, InverseDepthJacobian); 5] = [
        ("rotation transposed", |p, k, t| p.project_with_jacobian(k, &turned_back(t))),
        ("sign of the last column", |p, k, t| last_column_times(-1.0, p, k, t)),
        ("last column dropped", |p, k, t| last_column_times(0.0, p, k, t)),
        ("by depth for by inverse depth", |p, k, t| {
            last_column_times(-p.inverse_depth.powi(2), p, k, t)
        }),
        ("second depth held fixed", with_second_depth_held_fixed),
    ];
    chapter.equation("inverse-depth-jacobian", inverse_depth_jacobian, formula, &mutants);
}

type InverseDepthProjection = fn(&InverseDepth, &Pinhole, &Isometry3<f64>) -> Option<Vector2<f64>>;

fn inverse_depth_projection(formula: InverseDepthProjection) -> Comparison {
    let against = "the projection of the moved point, one in ten of them at infinity";
    let mut random = Random::new(12);
    Comparison::absolute(against, 1e-10, "px").each(0..STATES, |state| {
        let camera = random.camera();
        let (landmark, point) = landmark_and_point(&mut random, state);
        let second_from_first = small_motion(&mut random);
        let moved = second_from_first.transform_point(&point.into()).coords;
        (formula(&landmark, &camera, &second_from_first), image_of(&camera, &moved))
    })
}

/// The pixel and its derivatives by x, y and the inverse depth.
type PixelAndJacobian = Option<(Vector2<f64>, Matrix2x3<f64>)>;
type InverseDepthJacobian = fn(&InverseDepth, &Pinhole, &Isometry3<f64>) -> PixelAndJacobian;

fn inverse_depth_jacobian(formula: InverseDepthJacobian) -> Comparison {
    let against = "central differences, one in ten at infinity";
    let mut random = Random::new(13);
    Comparison::relative(against, 1e-9).each(0..STATES, |state| {
        let camera = random.camera();
        let (landmark, _) = landmark_and_point(&mut random, state);
        let second_from_first = small_motion(&mut random);
        let slope = differences(1e-5, |step: Vector3<f64>| {
            let ray = Vector3::new(landmark.x + step.x, landmark.y + step.y, 1.0);
            let lever = (landmark.inverse_depth + step.z) * second_from_first.translation.vector;
            image_of(&camera, &(second_from_first.rotation * ray + lever))
        });
        let projected = formula(&landmark, &camera, &second_from_first);
        (projected.map(|(_, jacobian)| jacobian), slope)
    })
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

fn with_rho(inverse_depth: f64, point: &InverseDepth) -> InverseDepth {
    InverseDepth { inverse_depth, ..*point }
}

fn turned_back(motion: &Isometry3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(motion.translation, motion.rotation.inverse())
}

fn last_column_times(
    factor: f64,
    landmark: &InverseDepth,
    camera: &Pinhole,
    second_from_first: &Isometry3<f64>,
) -> PixelAndJacobian {
    let (pixel, mut jacobian) = landmark.project_with_jacobian(camera, second_from_first)?;
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
