//! How much of a match's prediction is its own doing.

use nalgebra::{Isometry3, Vector2};
use vislam::robust_two_view::{Correspondences, Effort, GeneralMotion, Matches, RelativeMotion};

use super::STATES;
use super::scenes::CAMERA;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// So few that each of them has much leverage.
const COUNT: usize = 12;
/// By how much one of them is moved, in pixels.
const MOVED: f64 = 1e-3;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Leverage); 4] = [
        ("by the others' covariance", |matches, motion| {
            let own = leverage(matches, motion);
            own / (1.0 - own)
        }),
        ("root of it", |matches, motion| leverage(matches, motion).sqrt()),
        ("all the same", |_, _| 5.0 / COUNT as f64),
        ("what is left of it", |matches, motion| 1.0 - leverage(matches, motion)),
    ];
    chapter.equation("leverage", compared, leverage, &mutants);
}

type Leverage = fn(&Matches, &RelativeMotion) -> f64;

fn leverage(matches: &Matches, motion: &RelativeMotion) -> f64 {
    let all: Vec<usize> = (0..COUNT).collect();
    GeneralMotion(matches).leverages(motion, &all).map_or(f64::NAN, |leverages| leverages[0])
}

fn compared(formula: Leverage) -> Comparison {
    let against = "what is left of a small error after the motion has been fitted, from one";
    Comparison::absolute(against, 1e-3, "").over(STATES, 17, |random| {
        let (motion, mut pixels) = matched(random);
        let turned = random.uniform(0.0..std::f64::consts::TAU);
        pixels[0][1] += MOVED * Vector2::new(turned.cos(), turned.sin());
        let matches = Matches::new([&CAMERA, &CAMERA], &pixels, 1.0).expect("finite pixels");
        let all: Vec<usize> = (0..COUNT).collect();
        let data = GeneralMotion(&matches);
        let fitted = data.refined(&motion, &all, Effort::Converge);
        let error = |motion: &RelativeMotion| data.squared_errors(motion, 1e30)(0, 0).sqrt();
        let left = fitted.map_or(f64::NAN, |fitted| error(&fitted) / error(&motion));
        (formula(&matches, &motion), 1.0 - left)
    })
}

/// A motion, and where both cameras see points, without noise.
fn matched(random: &mut Random) -> (RelativeMotion, Vec<[Vector2<f64>; 2]>) {
    let second_from_first =
        Isometry3::from_parts(random.direction(0.7).into(), random.rotation(0.1).into());
    let seen = |_| {
        let point = random.point(2.5..8.0);
        [Isometry3::identity(), second_from_first]
            .map(|pose| CAMERA.project(&pose, &point).expect("in front of both"))
    };
    let pixels = (0..COUNT).map(seen).collect();
    (RelativeMotion::of(&second_from_first).expect("a baseline"), pixels)
}
