//! Estimates from data of which many are wrong.

use nalgebra::{Isometry3, Vector2};
use vislam::robust_two_view::{
    ConsensusError, ConsensusOptions, Correspondences, Effort, GeneralMotion, MatchError, Matches,
    OnePlane, RelativeMotion, consensus, draws_needed,
};

use super::scenes::{CAMERA, World, any_pixel, pixels, random, small_motion};

fn matches(pixels: &[[Vector2<f64>; 2]]) -> Matches {
    Matches::new([&CAMERA, &CAMERA], pixels, 1.0).unwrap()
}

/// The angle between two rotations, and between two directions, in degrees; the larger.
fn degrees_off(found: &RelativeMotion, truth: &Isometry3<f64>) -> f64 {
    let turn = found.rotation.rotation_to(&truth.rotation.to_rotation_matrix()).angle();
    turn.max(found.direction.angle(&truth.translation.vector)).to_degrees()
}

// ANCHOR: worked_example
#[test]
fn sixty_percent_of_wrong_matches_do_not_hide_the_motion() {
    let mut random = random(31);
    let truth = small_motion(&mut random);
    let pixels = pixels(&mut random, &truth, World::Deep, 200, 300);
    let matches = Matches::new([&CAMERA, &CAMERA], &pixels, 1.0).unwrap();

    let found = consensus(&GeneralMotion(&matches), &ConsensusOptions::default()).unwrap();

    assert!(degrees_off(&found.estimate, &truth) < 2.0);
    let right = found.inliers.iter().filter(|datum| **datum < 200).count();
    assert!(right > 190, "{right} right matches");
    let wrong = (found.inliers.len() - right) as f64;
    assert!(wrong < 3.0 * found.by_chance + 5.0, "{wrong} wrong ones");
}
// ANCHOR_END: worked_example

#[test]
fn the_same_seed_gives_the_same_result_and_another_one_the_same_motion() {
    let mut random = random(32);
    let truth = small_motion(&mut random);
    let pixels = pixels(&mut random, &truth, World::Deep, 100, 100);
    let matches = matches(&pixels);
    let with = |seed: u64| {
        let options = ConsensusOptions { seed, ..ConsensusOptions::default() };
        consensus(&GeneralMotion(&matches), &options).unwrap()
    };
    assert_eq!(with(5), with(5));
    let (one, other) = (with(5), with(6));
    assert!(degrees_off(&one.estimate, &other.estimate.second_from_first()) < 0.5);
}

#[test]
fn a_gate_keeps_the_share_of_right_matches_that_it_was_made_for() {
    let mut random = random(33);
    let truth = small_motion(&mut random);
    let pixels = pixels(&mut random, &truth, World::Deep, 2000, 0);
    let matches = matches(&pixels);
    for inlier_probability in [0.8, 0.95, 0.99] {
        let options = ConsensusOptions { inlier_probability, ..ConsensusOptions::default() };
        let found = consensus(&GeneralMotion(&matches), &options).unwrap();
        let share = found.inliers.len() as f64 / 2000.0;
        assert!((share - inlier_probability).abs() < 0.025, "{share} of {inlier_probability}");
    }
}

#[test]
fn local_optimization_saves_draws() {
    let mut random = random(34);
    let (mut with, mut without) = (0.0, 0.0);
    for seed in 0..10 {
        let truth = small_motion(&mut random);
        let pixels = pixels(&mut random, &truth, World::Deep, 100, 100);
        let matches = matches(&pixels);
        let draws = |local_optimization| {
            let options =
                ConsensusOptions { local_optimization, seed, least_draws: 0, ..Default::default() };
            consensus(&GeneralMotion(&matches), &options).unwrap().draws as f64
        };
        with += draws(true);
        without += draws(false);
    }
    assert!(with < without, "{with} {without}");
}

#[test]
fn the_number_of_draws_is_that_of_the_books() {
    // ln 0.01 / ln(1 - 0.5⁵) = 145.05, when samples are drawn from very many.
    assert_eq!(draws_needed(500_000_000, 1_000_000_000, 5, 0.99), 146);
    assert_eq!(draws_needed(100, 100, 5, 0.99), 1);
    assert_eq!(draws_needed(10, 100, 5, 1.5), usize::MAX);
    assert_eq!(draws_needed(4, 100, 5, 0.99), usize::MAX);
    // By counting: of ten pairs of five data, three are of the three right ones.
    assert_eq!(draws_needed(3, 5, 2, 1.0 - 0.7_f64.powi(4) + 1e-9), 5);
}

#[test]
fn wrong_matches_alone_are_refused() {
    let mut random = random(35);
    for seed in 0..5 {
        let pixels: Vec<_> =
            (0..100).map(|_| [any_pixel(&mut random), any_pixel(&mut random)]).collect();
        let options = ConsensusOptions { most_draws: 2000, seed, ..Default::default() };
        let refused = consensus(&GeneralMotion(&matches(&pixels)), &options);
        assert!(matches!(refused, Err(ConsensusError::Chance { count: 100, .. })), "{refused:?}");
        let refused = consensus(&OnePlane(&matches(&pixels)), &options);
        assert!(matches!(refused, Err(ConsensusError::Chance { .. })), "{refused:?}");
    }
}

#[test]
fn what_cannot_be_matches_is_refused_with_its_place() {
    let pixel = Vector2::new(100.0, 100.0);
    let refused = |pixels: &[[Vector2<f64>; 2]], sigma| {
        Matches::new([&CAMERA, &CAMERA], pixels, sigma).unwrap_err()
    };
    let broken = [[pixel, pixel], [pixel, Vector2::new(f64::NAN, 0.0)]];
    assert_eq!(refused(&broken, 1.0), MatchError::Pixel { at: 1 });
    assert_eq!(refused(&[], 0.0), MatchError::Sigma { sigma: 0.0 });
    let mut camera = CAMERA;
    camera.fx = -1.0;
    let refused = Matches::new([&CAMERA, &camera], &[], 1.0).unwrap_err();
    assert_eq!(refused, MatchError::Camera { camera: 1 });
}

#[test]
fn too_few_repeated_and_impossible_data_are_errors() {
    let options = ConsensusOptions::default();
    let five = vec![[Vector2::new(1.0, 2.0), Vector2::new(3.0, 4.0)]; 5];
    let refused = consensus(&GeneralMotion(&matches(&five)), &options);
    assert_eq!(refused, Err(ConsensusError::TooFew { count: 5, needed: 6 }));
    let same = vec![five[0]; 50];
    let fewer = ConsensusOptions { most_draws: 50, ..options };
    let refused = consensus(&GeneralMotion(&matches(&same)), &fewer);
    assert_eq!(refused, Err(ConsensusError::NoEstimate { draws: 50 }));
    for (name, impossible) in [
        ("confidence", ConsensusOptions { confidence: 1.0, ..options }),
        ("inlier_probability", ConsensusOptions { inlier_probability: f64::NAN, ..options }),
        ("false_alarms", ConsensusOptions { false_alarms: 0.0, ..options }),
        ("most_draws", ConsensusOptions { most_draws: 0, ..options }),
    ] {
        let refused = consensus(&GeneralMotion(&matches(&same)), &impossible);
        assert!(
            matches!(refused, Err(ConsensusError::Probability { name: said, .. }) if said == name)
        );
    }
}

/// A straight line through the origin: the smallest thing that can be estimated.
struct Slopes<'a>(&'a [[f64; 2]]);

impl Correspondences for Slopes<'_> {
    type Estimate = f64;
    const SAMPLE: usize = 1;
    const DEGREES: usize = 1;
    const PARAMETERS: usize = 1;

    fn count(&self) -> usize {
        self.0.len()
    }

    fn through(&self, sample: &[usize], give: &mut dyn FnMut(f64)) {
        let [x, y] = self.0[sample[0]];
        give(y / x);
    }

    fn squared_errors(&self, slope: &f64, _: f64) -> impl Fn(usize, usize) -> f64 {
        move |here, there| (slope * self.0[here][0] - self.0[there][1]).powi(2)
    }

    fn refined(&self, _: &f64, data: &[usize], _: Effort) -> Option<f64> {
        let sum = |f: fn(&[f64; 2]) -> f64| data.iter().map(|k| f(&self.0[*k])).sum::<f64>();
        Some(sum(|[x, y]| x * y) / sum(|[x, _]| x * x))
    }

    fn covariance(&self, _: &f64, _: &[usize]) -> Option<nalgebra::DMatrix<f64>> {
        None
    }

    fn leverages(&self, _: &f64, data: &[usize]) -> Option<Vec<f64>> {
        let square = |datum: &usize| self.0[*datum][0].powi(2);
        let all: f64 = data.iter().map(square).sum();
        Some(data.iter().map(|datum| square(datum) / all).collect())
    }
}

#[test]
fn anything_with_a_sample_and_an_error_can_be_estimated() {
    let mut data: Vec<[f64; 2]> = (1..=30).map(|k| [10.0 * k as f64, 20.0 * k as f64]).collect();
    data.extend((1..=30).map(|k| [10.0 * k as f64, 700.0 * ((k * k) % 31) as f64 - 9000.0]));
    let found = consensus(&Slopes(&data), &ConsensusOptions::default()).unwrap();
    assert_eq!(found.inliers, (0..30).collect::<Vec<_>>());
    assert!((found.estimate - 2.0).abs() < 1e-12);
    assert!((found.score - 30.0 * found.gate).abs() < 1e-9);
}

#[test]
fn a_datum_that_only_itself_confirms_does_not_make_the_estimate() {
    let mut data: Vec<[f64; 2]> = (0..30).map(|k| [1.0 + (k % 10) as f64, 0.0]).collect();
    for (k, [x, y]) in data.iter_mut().enumerate() {
        *y = 2.0 * *x + 0.3 * (7.0 * k as f64).sin();
    }
    data.push([100.0, 204.0]);
    let estimate = |local_optimization| {
        let options = ConsensusOptions { local_optimization, ..Default::default() };
        consensus(&Slopes(&data), &options).unwrap()
    };
    let (with, without) = (estimate(true), estimate(false));
    assert!(without.inliers.contains(&30) && (without.estimate - 2.0).abs() > 0.03);
    assert!((with.estimate - 2.0).abs() < 0.015, "{}", with.estimate);
    assert_eq!(with.inliers, (0..30).collect::<Vec<_>>());
}
