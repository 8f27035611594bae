//! How often so many draws lead to the right motion: as the textbook has it, and run.

use std::sync::{LazyLock, OnceLock};

use vislam::filtering::chi_square_quantile;
use vislam::robust_two_view::{
    ConsensusOptions, Correspondences, GeneralMotion, RelativeMotion, consensus, draws_needed,
};

use super::scenes::{SIGMA, Scene, World};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Right and wrong matches of a scene.
pub const RIGHT: usize = 40;
pub const WRONG: usize = 60;
/// How many scenes there are.
pub const SCENES: usize = 60;
/// After how many draws it is looked.
pub const AFTER: [usize; 7] = [10, 40, 100, 250, 525, 1200, 2500];
/// The place of the number of the textbook among them, for 99 %.
pub const TEXTBOOK: usize = 4;
/// So many of them are enough with local optimization.
const OPTIMIZED: usize = TEXTBOOK + 1;
const CONFIDENCE: f64 = 0.99;
/// This part of the right matches has to agree, so that the motion counts as the right one.
const AGREE: f64 = 0.9;

/// What is done with samples.
#[derive(Clone, Copy, PartialEq)]
pub enum Way {
    /// Pixels without noise.
    Exact,
    /// Noise, and each sample is taken as it is.
    Noisy,
    /// Noise, and the library's search with local optimization.
    Optimized,
}

pub const WAYS: [Way; 3] = [Way::Exact, Way::Noisy, Way::Optimized];

/// The part of all samples that hold right matches alone.
fn all_right() -> f64 {
    (0..5).map(|drawn| (RIGHT - drawn) as f64 / (RIGHT + WRONG - drawn) as f64).product()
}

/// The probability that one of so many samples does.
pub fn predicted(draws: f64) -> f64 {
    1.0 - (1.0 - all_right()).powf(draws)
}

static GATE: LazyLock<f64> = LazyLock::new(|| chi_square_quantile(0.99, 1).expect("a probability"));

fn scene(number: u64, way: Way) -> Scene {
    let sigma = if way == Way::Exact { 0.0 } else { SIGMA };
    Scene::new(&mut Random::new(4000 + number), World::Deep, sigma, RIGHT, WRONG)
}

/// Whether enough of the right matches agree.
fn is_right(data: &GeneralMotion, motion: &RelativeMotion) -> bool {
    let error = data.squared_errors(motion, *GATE);
    let agree = (0..RIGHT).filter(|datum| error(*datum, *datum) <= *GATE).count();
    agree as f64 >= AGREE * RIGHT as f64
}

/// The truncated sum of squares, or some number above `bound` when it is above.
fn score(data: &GeneralMotion, motion: &RelativeMotion, bound: f64) -> f64 {
    let error = data.squared_errors(motion, *GATE);
    let mut sum = 0.0;
    for datum in (0..data.count()).rev() {
        sum += error(datum, datum).min(*GATE);
        if sum > bound {
            break;
        }
    }
    sum
}

/// Whether the best motion is right after each of these numbers of draws. The samples are drawn by `draw`.
fn plain<const N: usize>(
    scene: &Scene,
    after: [usize; N],
    mut draw: impl FnMut() -> [usize; 5],
) -> [bool; N] {
    let matches = scene.matches();
    let data = GeneralMotion(&matches);
    let (mut best, mut drawn) = (None::<(f64, RelativeMotion)>, 0);
    after.map(|until| {
        while drawn < until {
            drawn += 1;
            data.through(&draw(), &mut |motion| {
                let least = best.map_or(f64::INFINITY, |(least, _)| least);
                let score = score(&data, &motion, least);
                if score < least {
                    best = Some((score, motion));
                }
            });
        }
        best.is_some_and(|(_, motion)| is_right(&data, &motion))
    })
}

/// Samples of five different matches.
fn samples(seed: u64) -> impl FnMut() -> [usize; 5] {
    let mut random = Random::new(9000 + seed);
    move || loop {
        let sample = [(); 5].map(|()| random.uniform(0.0..(RIGHT + WRONG) as f64) as usize);
        if (1..5).all(|k| !sample[..k].contains(&sample[k])) {
            break sample;
        }
    }
}

/// The same by the library, which draws until it has drawn so often: up to the number of the textbook.
fn searched(scene: &Scene, seed: u64) -> [bool; OPTIMIZED] {
    let matches = scene.matches();
    let data = GeneralMotion(&matches);
    std::array::from_fn(|at| {
        let draws = AFTER[at];
        let options =
            ConsensusOptions { seed, least_draws: draws, most_draws: draws, ..Default::default() };
        consensus(&data, &options).is_ok_and(|found| is_right(&data, &found.estimate))
    })
}

/// By way and by number of draws, the part of the scenes with the right motion.
pub fn measured() -> &'static [Vec<f64>; 3] {
    static MEASURED: OnceLock<[Vec<f64>; 3]> = OnceLock::new();
    MEASURED.get_or_init(|| {
        WAYS.map(|way| {
            let mut sums = vec![0.0; if way == Way::Optimized { OPTIMIZED } else { AFTER.len() }];
            for number in 0..SCENES as u64 {
                let scene = scene(number, way);
                let found = match way {
                    Way::Optimized => searched(&scene, number).to_vec(),
                    _ => plain(&scene, AFTER, samples(number)).to_vec(),
                };
                sums.iter_mut().zip(found).for_each(|(sum, found)| *sum += f64::from(found));
            }
            sums.iter().map(|sum| sum / SCENES as f64).collect()
        })
    })
}

/// A case of the theorem: whether pixels are exact, and whether samples are drawn anew.
#[derive(Clone, Copy)]
struct Case {
    way: Way,
    anew: bool,
}

fn one_of_them(case: Case) -> Comparison {
    const FEWER: u64 = 60;
    let needed = draws_needed(RIGHT, RIGHT + WRONG, 5, CONFIDENCE);
    let is_found = |number: &u64| {
        let scene = scene(*number, case.way);
        let mut samples = samples(*number);
        let first = samples();
        let draw = || if case.anew { samples() } else { first };
        plain(&scene, [needed], draw)[0]
    };
    let found = (0..FEWER).filter(is_found).count() as f64 / FEWER as f64;
    // The mean of sixty scenes scatters by a hundredth.
    Comparison::absolute("the confidence", 0.04, "of the scenes").once(found, CONFIDENCE)
}

pub fn exhibits(chapter: &mut Chapter) {
    let kept = Case { way: Way::Exact, anew: true };
    let noisy = Case { way: Way::Noisy, ..kept };
    let same = Case { anew: false, ..kept };
    chapter.counterexample("draws", "exact", one_of_them, [kept, noisy]);
    chapter.counterexample("draws", "independent", one_of_them, [kept, same]);

    let needed = draws_needed(RIGHT, RIGHT + WRONG, 5, CONFIDENCE);
    assert_eq!(needed, AFTER[TEXTBOOK], "the figure looks after the textbook's number");
    chapter.number("textbook_draws", needed as f64, "", 0);
    chapter.number("textbook_percent", 100.0 * CONFIDENCE, "%", 0);
    chapter.number("success_all", (RIGHT + WRONG) as f64, "", 0);
    chapter.number("success_right", RIGHT as f64, "", 0);
    chapter.number("success_wrong", WRONG as f64, "", 0);
    chapter.number("success_scenes", SCENES as f64, "", 0);
    chapter.number("agree_percent", 100.0 * AGREE, "%", 0);
    let percent = |way: usize, at: usize| 100.0 * measured()[way][at];
    chapter.number("success_exact", percent(0, TEXTBOOK), "%", 0);
    chapter.number("success_noisy", percent(1, TEXTBOOK), "%", 0);
    chapter.number("success_optimized", percent(2, TEXTBOOK), "%", 0);
    chapter.number("success_noisy_last", percent(1, AFTER.len() - 1), "%", 0);
    chapter.number("draws_last", AFTER[AFTER.len() - 1] as f64, "", 0);
}
