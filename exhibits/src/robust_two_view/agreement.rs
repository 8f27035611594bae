//! How far a match is from a motion, and how many samples have to be drawn.

use nalgebra::{Isometry3, Vector2};
use vislam::filtering::chi_square_quantile;
use vislam::reprojection::Pinhole;
use vislam::robust_two_view::{
    Correspondences, GeneralMotion, Matches, RelativeMotion, draws_needed,
};
use vislam::two_views::{View, essential_matrix, fundamental_matrix, triangulate_nonlinear};

use super::STATES;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Square); 5] = [
        ("root not squared", |pair| square(pair).map(f64::sqrt)),
        ("distance in the second image only", |pair| {
            let line = lines(pair)[1];
            Some((volume(pair) / line.norm()).powi(2))
        }),
        ("lengths added", |pair| {
            let [first, second] = lines(pair);
            Some((volume(pair) / (first.norm() + second.norm())).powi(2))
        }),
        ("noise of the images exchanged", |pair| {
            square(&Pair { sigma: [pair.sigma[1], pair.sigma[0]], ..*pair })
        }),
        ("algebraic", |pair| Some((volume(pair) / pair.sigma[0]).powi(2))),
    ];
    chapter.equation("epipolar-square", epipolar_square, square, &mutants);

    let mutants: [(_, Draws); 5] = [
        ("with repetition", |right, count, sample, confidence| {
            let share = right as f64 / count as f64;
            (1.0 - confidence).ln() / (1.0 - share.powi(sample as i32)).ln()
        }),
        ("confidence for what is left", |right, count, sample, confidence| {
            draws_needed(right, count, sample, 1.0 - confidence) as f64
        }),
        ("one datum too few", |right, count, sample, confidence| {
            draws_needed(right, count, sample - 1, confidence) as f64
        }),
        ("until one is expected", |right, count, sample, _| 1.0 / all_right(right, count, sample)),
        ("wrong for right", |right, count, sample, confidence| {
            (draws_needed(count - right, count, sample, confidence) as f64).min(1e9)
        }),
    ];
    let formula: Draws =
        |right, count, sample, confidence| draws_needed(right, count, sample, confidence) as f64;
    chapter.equation("draws", draws, formula, &mutants);
    numbers(chapter);
}

/// Two pixels, the cameras that saw them, the motion between these, and the noise.
#[derive(Clone, Copy)]
struct Pair {
    cameras: [Pinhole; 2],
    motion: Isometry3<f64>,
    pixels: [Vector2<f64>; 2],
    sigma: [f64; 2],
}

type Square = fn(&Pair) -> Option<f64>;

/// What the library says: pixels are turned into slopes, each with its own noise.
fn square(pair: &Pair) -> Option<f64> {
    let Pair { cameras: [first, second], motion, pixels, sigma } = pair;
    // A camera whose pixels are larger has as much less noise in them.
    let times = sigma[0] / sigma[1];
    let larger = Pinhole {
        fx: times * second.fx,
        fy: times * second.fy,
        cx: times * second.cx,
        cy: times * second.cy,
    };
    let pixels = [pixels[0], times * pixels[1]];
    let matches = Matches::new([first, &larger], &[pixels], sigma[0]).ok()?;
    let motion = RelativeMotion::of(motion)?;
    Some(GeneralMotion(&matches).squared_errors(&motion, 1e30)(0, 0))
}

fn volume(Pair { cameras: [first, second], motion, pixels, .. }: &Pair) -> f64 {
    let fundamental = fundamental_matrix(first, second, &essential_matrix(motion));
    pixels[1].push(1.0).dot(&(fundamental * pixels[0].push(1.0)))
}

/// The gradient by both pixels, times their noise.
fn lines(pair: &Pair) -> [Vector2<f64>; 2] {
    let Pair { cameras: [first, second], motion, pixels, sigma } = pair;
    let fundamental = fundamental_matrix(first, second, &essential_matrix(motion));
    let first = fundamental.transpose() * pixels[1].push(1.0);
    let second = fundamental * pixels[0].push(1.0);
    [sigma[0] * first.xy(), sigma[1] * second.xy()]
}

fn epipolar_square(formula: Square) -> Comparison {
    let against = "twice the cost of the most likely point, for small noise";
    Comparison::absolute(against, 1e-4, "variances").over(STATES, 11, |random| {
        let pair = pair(random);
        let views = [0, 1].map(|at| View {
            camera: pair.cameras[at],
            camera_from_world: [Isometry3::identity(), pair.motion][at],
            pixel: pair.pixels[at],
            sigma: pair.sigma[at],
        });
        let rays = [0, 1].map(|at| vislam::bearing::bearing(&pair.cameras[at], &pair.pixels[at]));
        let depths = vislam::two_views::ray_depths(&pair.motion, &rays[0], &rays[1]);
        let moved = triangulate_nonlinear(&views, &(depths.0 * rays[0].into_inner()));
        (formula(&pair), moved.map_or(f64::NAN, |point| 2.0 * point.cost))
    })
}

/// Pixels of a point in two different cameras, a few thousandths of a pixel off.
fn pair(random: &mut Random) -> Pair {
    let cameras = [random.camera(), random.camera()];
    let sigma = [random.uniform(1e-3..3e-3), random.uniform(1e-3..3e-3)];
    let length = random.uniform(0.3..1.0);
    let motion =
        Isometry3::from_parts(random.direction(length).into(), random.rotation(0.3).into());
    let point = random.point(2.5..8.0);
    let pixels = [0, 1].map(|at| {
        let pose = [Isometry3::identity(), motion][at];
        let pixel = cameras[at].project(&pose, &point).expect("in front of both");
        pixel + Vector2::new(random.normal(sigma[at]), random.normal(sigma[at]))
    });
    Pair { cameras, motion, pixels, sigma }
}

/// Takes how many are right, of how many, the size of a sample and the confidence.
type Draws = fn(usize, usize, usize, f64) -> f64;

fn draws(formula: Draws) -> Comparison {
    let against = "samples counted one by one, and draws added until the confidence is reached";
    Comparison::absolute(against, 0.5, "draws").over(60, 12, |random| {
        let count = random.uniform(6.0..13.0) as usize;
        let sample = random.uniform(2.0..5.0) as usize;
        let right = random.uniform(sample as f64..count as f64) as usize;
        let confidence = random.uniform(0.6..0.999);
        let of_all = all_right(right, count, sample);
        let (mut drawn, mut none) = (0, 1.0);
        while none > 1.0 - confidence {
            none *= 1.0 - of_all;
            drawn += 1;
        }
        (formula(right, count, sample, confidence), drawn as f64)
    })
}

/// The share of all samples that hold right data alone, by listing them.
fn all_right(right: usize, count: usize, sample: usize) -> f64 {
    let samples = (0_u32..1 << count).filter(|chosen| chosen.count_ones() as usize == sample);
    let (good, all) = samples
        .fold((0, 0), |(good, all), chosen| (good + usize::from(chosen >> right == 0), all + 1));
    good as f64 / all as f64
}

/// How many samples of five, four and two, for shares of wrong matches out of very many.
fn numbers(chapter: &mut Chapter) {
    const MANY: usize = 1_000_000;
    let needed = |share: f64, sample| {
        draws_needed(((1.0 - share) * MANY as f64).round() as usize, MANY, sample, 0.99) as f64
    };
    for (name, share, sample) in [
        ("draws_20_five", 0.2, 5),
        ("draws_40_five", 0.4, 5),
        ("draws_60_five", 0.6, 5),
        ("draws_80_five", 0.8, 5),
        ("draws_20_eight", 0.2, 8),
        ("draws_40_eight", 0.4, 8),
        ("draws_60_eight", 0.6, 8),
        ("draws_80_eight", 0.8, 8),
        ("draws_20_two", 0.2, 2),
        ("draws_40_two", 0.4, 2),
        ("draws_60_two", 0.6, 2),
        ("draws_80_two", 0.8, 2),
    ] {
        chapter.number(name, needed(share, sample), "", 0);
    }
    let times = needed(0.6, 8) / needed(0.6, 5);
    chapter.number("eight_times_60", times, "", 0);
    let gate = chi_square_quantile(0.99, 1).expect("a probability");
    chapter.number("gate", gate, "", 2);
    chapter.number("gate_sigmas", gate.sqrt(), "", 2);
}
