//! Planes, turns, and how much better a richer model fits by chance.

use std::sync::OnceLock;

use nalgebra::{Isometry3, Matrix2, Matrix3, Vector2, Vector3, Vector4};
use vislam::bearing::back_project;
use vislam::reprojection::Pinhole;
use vislam::robust_two_view::{
    Correspondences, Effort, GeneralMotion, Matches, OnePlane, OnlyTurned, RelativeMotion,
};

use super::STATES;
use super::scenes::{CAMERA, SIGMA, Scene, World};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences, inverse};
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Homography = |m, n, d| turn(m) + m.translation.vector * n.transpose() / d;
    let mutants: [(_, Homography); 5] = [
        ("rotation transposed", |m, n, d| {
            turn(m).transpose() + m.translation.vector * n.transpose() / d
        }),
        ("sign", |m, n, d| turn(m) - m.translation.vector * n.transpose() / d),
        ("product transposed", |m, n, d| turn(m) + n * m.translation.vector.transpose() / d),
        ("times the distance", |m, n, d| turn(m) + m.translation.vector * n.transpose() * d),
        ("centre for translation", |m, n, d| {
            turn(m) + m.inverse().translation.vector * n.transpose() / d
        }),
    ];
    chapter.equation("plane-homography", plane_homography, formula, &mutants);

    let mutants: [(_, Transfer); 4] = [
        ("noise of the second image only", |pair| {
            let Parts { off, second, .. } = parts(pair);
            off.dot(&(inverse(second) * off))
        }),
        ("noise of the first image only", |pair| {
            let Parts { off, first, slopes, .. } = parts(pair);
            off.dot(&(inverse(slopes * first * slopes.transpose()) * off))
        }),
        ("derivative left out", |pair| {
            let Parts { off, first, second, .. } = parts(pair);
            off.dot(&(inverse(first + second) * off))
        }),
        ("not inverted", |pair| {
            let Parts { off, first, second, slopes } = parts(pair);
            let covariance = second + slopes * first * slopes.transpose();
            off.dot(&(covariance * off)) / covariance.determinant()
        }),
    ];
    chapter.equation("transfer-square", transfer_square, transferred, &mutants);

    let formula: Excess = |n, [of_simple, of_rich]| {
        n * (of_simple.degrees - of_rich.degrees) + of_rich.parameters - of_simple.parameters
    };
    let mutants: [(_, Excess); 4] = [
        ("parameters dropped", |n, [simple, rich]| n * (simple.degrees - rich.degrees)),
        ("matches dropped", |_, [simple, rich]| rich.parameters - simple.parameters),
        ("sign of the parameters", |n, [simple, rich]| {
            n * (simple.degrees - rich.degrees) - rich.parameters + simple.parameters
        }),
        ("parameters of the richer model only", |n, [simple, rich]| {
            n * (simple.degrees - rich.degrees) + rich.parameters
        }),
    ];
    chapter.equation("model-excess", model_excess, formula, &mutants);
}

/// Takes the motion, the normal of the plane and its distance, both in the first camera.
type Homography = fn(&Isometry3<f64>, &Vector3<f64>, f64) -> Matrix3<f64>;

fn turn(motion: &Isometry3<f64>) -> Matrix3<f64> {
    motion.rotation.to_rotation_matrix().into_inner()
}

fn plane_homography(formula: Homography) -> Comparison {
    let against = "where the second camera sees the point at which a ray meets the plane";
    Comparison::absolute(against, 1e-12, "rad").over(STATES, 31, |random| {
        let length = random.uniform(0.2..1.0);
        let motion =
            Isometry3::from_parts(random.direction(length).into(), random.rotation(0.4).into());
        let normal = (Vector3::z() + random.direction(0.4)).normalize();
        let distance = random.uniform(2.0..6.0);
        let ray = random.point(1.0..1.1);
        let point = ray * (distance / normal.dot(&ray));
        let second = motion.rotation * point + motion.translation.vector;
        ((formula(&motion, &normal, distance) * ray).normalize(), second.normalize())
    })
}

/// Two cameras, the homography between their slopes, and two pixels.
struct Pair {
    cameras: [Pinhole; 2],
    homography: Matrix3<f64>,
    pixels: [Vector2<f64>; 2],
}

type Transfer = fn(&Pair) -> f64;

/// Standard deviation of the pixels.
const FINE: f64 = 1e-3;

fn transferred(Pair { cameras: [first, second], homography, pixels }: &Pair) -> f64 {
    let matches = Matches::new([first, second], &[*pixels], FINE).expect("finite pixels");
    OnePlane(&matches).squared_errors(homography, 1e30)(0, 0)
}

/// What the transferred slopes miss the measured ones by, the covariances of the slopes, and the derivative of the
/// transfer.
struct Parts {
    off: Vector2<f64>,
    first: Matrix2<f64>,
    second: Matrix2<f64>,
    slopes: Matrix2<f64>,
}

fn parts(Pair { cameras, homography, pixels }: &Pair) -> Parts {
    let [from, to] = [0, 1].map(|at| back_project(&cameras[at], &pixels[at], 1.0).xy());
    let variances = cameras.map(|camera| {
        Matrix2::from_diagonal(&Vector2::new(FINE / camera.fx, FINE / camera.fy).map(|s| s * s))
    });
    let moved = |slopes: Vector2<f64>| transfer(homography, &slopes);
    let slopes = differences(1e-6, |change| moved(from + change));
    Parts { off: moved(from) - to, first: variances[0], second: variances[1], slopes }
}

fn transfer(homography: &Matrix3<f64>, slopes: &Vector2<f64>) -> Vector2<f64> {
    let ray = homography * slopes.push(1.0);
    ray.xy() / ray.z
}

fn transfer_square(formula: Transfer) -> Comparison {
    let against = "the least squares by which both pixels have to move, searched for";
    Comparison::absolute(against, 1e-3, "variances").over(STATES, 32, |random| {
        let cameras = [random.camera(), random.camera()];
        let tilt = random.direction(0.3);
        let rotation = random.rotation(0.3).into_inner();
        let homography = rotation + random.direction(0.4) * (Vector3::z() + tilt).transpose();
        let ray = random.point(1.0..1.1);
        let slopes = [ray.xy(), transfer(&homography, &ray.xy())];
        let pixels = [0, 1].map(|at| {
            let camera = &cameras[at];
            let pixel = Vector2::new(camera.fx, camera.fy).component_mul(&slopes[at]);
            let noise = Vector2::new(random.normal(FINE), random.normal(FINE));
            pixel + Vector2::new(camera.cx, camera.cy) + noise
        });
        let pair = Pair { cameras, homography, pixels };
        (formula(&pair), least_move(&pair))
    })
}

/// The least sum of squares, in variances, by steps of Gauss and Newton for where the first pixel should have been.
fn least_move(Pair { cameras, homography, pixels }: &Pair) -> f64 {
    let focal = |at: usize| Vector2::new(cameras[at].fx, cameras[at].fy) / FINE;
    let [from, to] = [0, 1].map(|at| back_project(&cameras[at], &pixels[at], 1.0).xy());
    let residual = |slopes: Vector2<f64>| -> Vector4<f64> {
        let here = (slopes - from).component_mul(&focal(0));
        let there = (transfer(homography, &slopes) - to).component_mul(&focal(1));
        Vector4::new(here.x, here.y, there.x, there.y)
    };
    let mut slopes = from;
    for _ in 0..6 {
        let by_slopes = differences::<4, 2>(1e-6, |change| residual(slopes + change));
        slopes -= inverse(by_slopes.tr_mul(&by_slopes)) * by_slopes.tr_mul(&residual(slopes));
    }
    residual(slopes).norm_squared()
}

/// What a model leaves free of a match, and how many numbers it has.
#[derive(Clone, Copy)]
struct Freedom {
    degrees: f64,
    parameters: f64,
}

const fn freedom<C: Correspondences>() -> Freedom {
    Freedom { degrees: C::DEGREES as f64, parameters: C::PARAMETERS as f64 }
}

const TURNED: Freedom = freedom::<OnlyTurned>();
const PLANE: Freedom = freedom::<OnePlane>();
const GENERAL: Freedom = freedom::<GeneralMotion>();

/// Takes the number of matches, the simpler and the richer model.
type Excess = fn(f64, [Freedom; 2]) -> f64;

/// Scenes for each mean.
const SCENES: usize = 250;

fn model_excess(formula: Excess) -> Comparison {
    let against = "the mean over scenes in which the simpler model is true";
    // Such a mean scatters by a quarter at most.
    Comparison::absolute(against, 0.8, "variances").each(means(), |(count, is_wall, mean)| {
        let models = if *is_wall { [PLANE, GENERAL] } else { [TURNED, PLANE] };
        (formula(*count as f64, models), *mean)
    })
}

/// Numbers of matches, whether they are of a wall or from one place, and the mean excess of the squared errors.
fn means() -> &'static [(usize, bool, f64)] {
    static MEANS: OnceLock<Vec<(usize, bool, f64)>> = OnceLock::new();
    MEANS.get_or_init(|| {
        let cases = (8..20).flat_map(|count| [(count, false), (count, true)]);
        let mean = |(count, is_wall): (usize, bool)| {
            let mut random = Random::new(330 + count as u64);
            let excess = (0..SCENES).map(|_| excess(&mut random, count, is_wall));
            (count, is_wall, excess.sum::<f64>() / SCENES as f64)
        };
        cases.map(mean).collect()
    })
}

/// By how much the simpler model's squared errors exceed those of the richer one. The noise is small, so that models
/// are linear in it.
fn excess(random: &mut Random, count: usize, is_wall: bool) -> f64 {
    const SMALL: f64 = 1e-2;
    let turn = random.rotation(0.15);
    let shift = if is_wall { random.direction(1.0) } else { Vector3::zeros() };
    let truth = Isometry3::from_parts(shift.into(), turn.into());
    let scene = Scene::of_motion(random, truth, World::Wall, SMALL * SIGMA, [count, 0]);
    let matches = Matches::new([&CAMERA, &CAMERA], &scene.pixels, SMALL).expect("finite pixels");
    let normal = Vector3::new(0.3, -0.2, 1.0) / 4.0;
    let homography = (turn.into_inner() + shift * normal.transpose()).normalize();
    let plane = fitted(&OnePlane(&matches), &homography);
    match RelativeMotion::of(&truth) {
        Some(motion) => plane - fitted(&GeneralMotion(&matches), &motion),
        None => fitted(&OnlyTurned(&matches), &turn) - plane,
    }
}

/// The least sum of squared errors of all matches.
fn fitted<C: Correspondences>(data: &C, start: &C::Estimate) -> f64 {
    let all: Vec<usize> = (0..data.count()).collect();
    let mut estimate = start.clone();
    for _ in 0..2 {
        estimate = data.refined(&estimate, &all, Effort::Converge).unwrap_or(estimate);
    }
    let squared_error = data.squared_errors(&estimate, 1e30);
    all.iter().map(|datum| squared_error(*datum, *datum)).sum()
}
