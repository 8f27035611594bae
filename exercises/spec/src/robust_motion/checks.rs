//! What is asked about an answer, and on which instances.

use nalgebra::{Isometry3, Vector2, Vector3, Vector4};
use vislam::manifold::se3;

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::camera::point_in_view;
use crate::check::{Check, Failure, Misconception, compare_list, compare_number};
use crate::draw::Draw;

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "robust_motion",
    title: "Robust relative pose with wrong matches",
    chapter: "robust_two_view",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Camera", "Match"],
    forbidden: &["factors", "robust_two_view", "simulation", "structure_from_motion", "two_views"],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    WITH_REPETITION, "with_repetition":
        "This is the number for samples in which one match may come twice. When a right one has been \
         drawn, how many right ones are left for the next place, and of how many?";
    USEFUL_FORGOTTEN, "useful_forgotten":
        "This number would do without noise. Of the samples that are all right only a part leads \
         anywhere: where does that part enter, and which probability does it make smaller?";
    USEFUL_AFTERWARDS, "useful_afterwards":
        "The number for samples without noise was divided by the part that is useful. A logarithm \
         stands in between: is ln(1 − s q) the same as s times ln(1 − q)?";
    CONFIDENCE_EXCHANGED, "confidence_exchanged":
        "So few samples all fail with the probability that was asked for success. Which of the two \
         does (1 − q) to the power of N compute?";
    ROUNDED_DOWN, "rounded_down":
        "This is one sample too few: the confidence is not quite reached. To which side does a number \
         of draws have to be rounded?";
    MEAN_WAIT, "mean_wait":
        "After so many samples one success is expected on average. With which probability has none \
         come by then?";
    ONE_PICTURE, "one_picture":
        "The variance has the noise of one pixel in it and leaves out that of the other. How many \
         numbers of a match were measured?";
    DISTANCES_ADDED, "distances_added":
        "These are the squared distances from both epipolar lines, added. The two have one error in \
         common: how many conditions does a match have to satisfy?";
    ALGEBRAIC, "algebraic":
        "This is the left side of the constraint, squared, and not over its variance. What would it \
         be for a baseline twice as long, and should that matter?";
    NOISE_IGNORED, "noise_ignored":
        "These errors are in square pixels. The pixels of a match have deviations of their own: how \
         many of them is the match off by?";
    DEVIATIONS_NOT_SQUARED, "deviations_not_squared":
        "The deviations stand in the sum as they are. What adds up when independent errors do, \
         deviations or their squares?";
    DEVIATIONS_EXCHANGED, "deviations_exchanged":
        "The noise of the first pixel was given to the second and the other way round. With which of \
         the two does F z₁ have to be multiplied, the line in the second picture?";
    NOT_SQUARED, "not_squared":
        "These are deviations and not variances. Is the gate a bound of the error or of its square?";
    MOTION_INVERTED, "motion_inverted":
        "These are the errors for the motion the other way round. Does `second_from_first` take the \
         coordinates of the first camera, or give them?";
    INLIERS_COUNTED, "inliers_counted":
        "This counts matches and does not ask how well they fit. What does a match cost whose squared \
         error is half of the gate?";
    OUTLIERS_FREE, "outliers_free":
        "What lies beyond the gate costs nothing here. Which motion would then be the best of all, \
         one that many matches agree with or one that none does?";
    UNTRUNCATED, "untruncated":
        "Every square counts in full. How much may a single wrong match add to the score of the right \
         motion?";
    EXACTLY_SO_MANY, "exactly_so_many":
        "This is for exactly so many matches within the gate. Would one more have surprised you less?";
    MORE_THAN_SO_MANY, "more_than_so_many":
        "This is for more matches than `agree`, and `agree` itself is left out. What does \"or more\" \
         begin with?";
    TRIED_ONCE, "tried_once":
        "This is the probability for one motion. You have tried many and kept the best: how often \
         does something come about that you give many chances?";
    MEAN_COUNT, "mean_count":
        "So many matches agree on average. What is asked is how many motions have as many as \
         `agree`.";
    MOST_INLIERS, "most_inliers":
        "This motion has the most matches within the gate, and another one has a smaller score. \
         Which of the two was asked for?";
    LEAST_SQUARES, "least_squares":
        "This motion has the least sum of squares over all matches, wrong ones among them. What does \
         the gate do to their squares?";
    NEVER_REFUSED, "never_refused":
        "This motion has the least score, and luck would have found one as good. What does the \
         specification ask for then?";
    REFUSED_AT_ONCE, "refused_at_once":
        "There are far more matches within the gate than luck explains, and no motion came back. When \
         is a number of false alarms good news, when it is large or when it is small?";
}

/// Samples to be drawn.
#[derive(Debug, Clone, Copy)]
pub struct Drawing {
    right: usize,
    matches: usize,
    sample: usize,
    useful: f64,
    confidence: f64,
}

/// Two pictures and the matches between them.
#[derive(Debug, Clone)]
pub struct Pictures {
    cameras: [Camera; 2],
    motion: Isometry3<f64>,
    matches: Vec<Match>,
}

/// Motions of which one is to be chosen, or none.
#[derive(Debug, Clone)]
pub struct Choice {
    pictures: Pictures,
    motions: Vec<Isometry3<f64>>,
    gate: f64,
    chance: f64,
    most_alarms: f64,
}

/// Of what instances are drawn.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// How many matches.
    pub matches: usize,
    /// The part of them that is wrong.
    pub wrong: f64,
    /// Standard deviations of the pixels.
    pub sigma: [f64; 2],
    /// How many motions are tried.
    pub tried: usize,
    /// How far the second camera turned, in radians.
    pub turn: f64,
}

/// The range of the public instances.
const PUBLIC: Range = Range { matches: 60, wrong: 0.4, sigma: [0.5, 2.0], tried: 24, turn: 0.3 };

/// How many logarithms stand to one another, before rounding.
fn draws_for(success: f64, left: f64) -> f64 {
    left.ln() / (1.0 - success).ln()
}

impl Drawing {
    /// A drawing whose wrong numbers all differ from each other and from the right one.
    pub fn drawn(draw: &mut Draw, most_matches: usize) -> Self {
        loop {
            let matches = draw.index(12..most_matches);
            let sample = draw.index(2..6);
            let right = draw.index(sample + 1..matches);
            let useful = draw.uniform(0.3..0.8);
            let drawing =
                Self { right, matches, sample, useful, confidence: draw.uniform(0.9..0.999) };
            let (right, wrong) = (drawing.expected(), drawing.wrong());
            let differ = |(at, (name, number)): (usize, &(&Misconception, f64))| {
                *number != right
                    && wrong[..at]
                        .iter()
                        .all(|(other, same)| other.name == name.name || same != number)
            };
            if right < 1e6 && wrong.iter().enumerate().all(differ) {
                return drawing;
            }
        }
    }

    /// The probability that a sample is all right, by drawing from what is left.
    fn all_right(&self) -> f64 {
        (0..self.sample).map(|k| (self.right - k) as f64 / (self.matches - k) as f64).product()
    }

    /// Draws until so many fail with no more than what confidence leaves: halved and doubled.
    fn expected(&self) -> f64 {
        let fails = 1.0 - self.useful * self.all_right();
        let is_enough = |draws: u64| fails.powf(draws as f64) <= 1.0 - self.confidence;
        let (mut low, mut high) = (0_u64, 1_u64);
        while !is_enough(high) {
            high *= 2;
        }
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            *(if is_enough(middle) { &mut high } else { &mut low }) = middle;
        }
        high as f64
    }

    fn wrong(&self) -> Vec<(&'static Misconception, f64)> {
        let Self { right, matches, sample, useful, confidence } = *self;
        let (all, left) = (self.all_right(), 1.0 - confidence);
        let repeated = (right as f64 / matches as f64).powi(sample as i32);
        let success = useful * all;
        let without = draws_for(all, left);
        vec![
            (&WITH_REPETITION, draws_for(useful * repeated, left).ceil()),
            (&USEFUL_FORGOTTEN, without.ceil()),
            (&USEFUL_AFTERWARDS, (without / useful).ceil()),
            (&USEFUL_AFTERWARDS, (without.ceil() / useful).ceil()),
            (&CONFIDENCE_EXCHANGED, draws_for(success, confidence).ceil()),
            (&ROUNDED_DOWN, self.expected() - 1.0),
            (&MEAN_WAIT, (1.0 / success).ceil()),
            (&MEAN_WAIT, (1.0 / success).round()),
        ]
    }
}

/// What is measured of a match, and by which parts the constraint changes.
struct Linear {
    value: f64,
    by_first: Vector2<f64>,
    by_second: Vector2<f64>,
    sigmas: [f64; 2],
}

impl Linear {
    fn variance(&self, [first, second]: [f64; 2]) -> f64 {
        first * first * self.by_first.norm_squared()
            + second * second * self.by_second.norm_squared()
    }

    fn square(&self) -> f64 {
        self.value * self.value / self.variance(self.sigmas)
    }
}

fn ray(camera: &Camera, pixel: &Vector2<f64>) -> Vector3<f64> {
    Vector3::new((pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy, 1.0)
}

impl Pictures {
    /// Pixels of points in front of both cameras, and behind them wrong matches, in any order.
    pub fn drawn(draw: &mut Draw, range: Range) -> Self {
        let cameras = [Camera::drawn(draw), Camera::drawn(draw)];
        let shift = Vector3::new(1.0, 0.2, 0.0) + draw.vector(0.1..0.4);
        let turn = draw.rotation(0.3 * range.turn..range.turn);
        let motion = Isometry3::from_parts((draw.uniform(0.4..1.5) * shift).into(), turn.into());
        let mut pictures = Self { cameras, motion, matches: Vec::new() };
        let wrong = (range.wrong * range.matches as f64).round() as usize;
        while pictures.matches.len() < range.matches {
            let is_wrong = pictures.matches.len() < wrong;
            pictures.matches.extend(pictures.pair(draw, range, is_wrong));
        }
        draw.shuffle(&mut pictures.matches);
        pictures
    }

    /// A match, unless its point is behind the second camera.
    fn pair(&self, draw: &mut Draw, range: Range, is_wrong: bool) -> Option<Match> {
        let mut seen = || {
            let point = point_in_view(draw, 3.0, 9.0);
            let moved = self.motion.rotation * point + self.motion.translation.vector;
            let second = self.cameras[1].pinhole().project_cam(&moved)?;
            Some((self.cameras[0].pinhole().project_cam(&point)?, second))
        };
        let (first, second) = seen()?;
        let second = if is_wrong { seen()?.1 } else { second };
        let [sigma_first, sigma_second] =
            [(); 2].map(|()| draw.uniform(range.sigma[0]..range.sigma[1]));
        let mut noisy = |pixel: Vector2<f64>, sigma| pixel + sigma * draw.normals::<2, 1>();
        let (first, second) = (noisy(first, sigma_first), noisy(second, sigma_second));
        Some(Match { first, second, sigma_first, sigma_second })
    }

    /// The volume of two rays and the baseline, and its differences by all four coordinates: it is linear in each of
    /// them, so that differences have no error but rounding.
    fn linear(&self, motion: &Isometry3<f64>) -> Vec<Linear> {
        let [first, second] = &self.cameras;
        let volume = |seen: &Match, step: &Vector4<f64>| {
            let a = ray(first, &(seen.first + step.fixed_rows::<2>(0)));
            let b = ray(second, &(seen.second + step.fixed_rows::<2>(2)));
            b.dot(&motion.translation.vector.cross(&(motion.rotation * a)))
        };
        let of = |seen: &Match| {
            let slope = |axis| {
                let step: Vector4<f64> = Vector4::ith(axis, 16.0);
                (volume(seen, &step) - volume(seen, &-step)) / 32.0
            };
            Linear {
                value: volume(seen, &Vector4::zeros()),
                by_first: Vector2::new(slope(0), slope(1)),
                by_second: Vector2::new(slope(2), slope(3)),
                sigmas: [seen.sigma_first, seen.sigma_second],
            }
        };
        self.matches.iter().map(of).collect()
    }

    fn squares(&self, motion: &Isometry3<f64>) -> Vec<f64> {
        self.linear(motion).iter().map(Linear::square).collect()
    }

    fn wrong_squares(&self) -> Vec<(&'static Misconception, Vec<f64>)> {
        let linear = self.linear(&self.motion);
        let of = |wrong: fn(&Linear) -> f64| linear.iter().map(wrong).collect();
        let length = self.motion.translation.vector.norm();
        let unit = linear.iter().map(|l: &Linear| (l.value / length).powi(2)).collect();
        vec![
            (&ONE_PICTURE, of(|l| l.value.powi(2) / l.variance([0.0, l.sigmas[1]]))),
            (&ONE_PICTURE, of(|l| l.value.powi(2) / l.variance([l.sigmas[0], 0.0]))),
            (
                &DISTANCES_ADDED,
                of(|l| {
                    let [first, second] = [[l.sigmas[0], 0.0], [0.0, l.sigmas[1]]];
                    l.value.powi(2) * (1.0 / l.variance(first) + 1.0 / l.variance(second))
                }),
            ),
            (&ALGEBRAIC, of(|l| l.value.powi(2))),
            (&ALGEBRAIC, unit),
            (&NOISE_IGNORED, of(|l| l.value.powi(2) / l.variance([1.0; 2]))),
            (
                &DEVIATIONS_NOT_SQUARED,
                of(|l| l.value.powi(2) / l.variance(l.sigmas.map(f64::sqrt))),
            ),
            (
                &DEVIATIONS_EXCHANGED,
                of(|l| l.value.powi(2) / l.variance([l.sigmas[1], l.sigmas[0]])),
            ),
            (&NOT_SQUARED, of(|l| l.square().sqrt())),
            (&NOT_SQUARED, of(|l| l.square().sqrt().copysign(l.value))),
            (&MOTION_INVERTED, self.squares(&self.motion.inverse())),
        ]
    }
}

/// The truncated sum: what is below the gate adds up, and all others are gates.
fn truncated(squares: &[f64], gate: f64) -> f64 {
    let (below, beyond): (Vec<f64>, Vec<f64>) = squares.iter().partition(|square| **square <= gate);
    below.iter().sum::<f64>() + gate * beyond.len() as f64
}

fn agreeing(squares: &[f64], gate: f64) -> usize {
    squares.iter().filter(|square| **square <= gate).count()
}

/// With which probability 0, 1, 2 and so on of so many matches agree by chance: one match after the other.
fn by_chance(matches: usize, chance: f64) -> Vec<f64> {
    let mut counts = vec![0.0; matches + 1];
    counts[0] = 1.0;
    for _ in 0..matches {
        for agree in (0..=matches).rev() {
            let one_fewer = if agree == 0 { 0.0 } else { counts[agree - 1] };
            counts[agree] = (1.0 - chance) * counts[agree] + chance * one_fewer;
        }
    }
    counts
}

fn alarms(agree: usize, matches: usize, chance: f64, tried: usize) -> f64 {
    let counts = by_chance(matches, chance);
    // The small ones first, so that they are not lost.
    tried as f64 * counts[agree.min(matches + 1)..].iter().rev().sum::<f64>()
}

impl Choice {
    /// Motions near the true one and far from it. The one with the least score has neither the most inliers nor the
    /// least sum of squares. When `by_luck` is set, it could be luck, and would not be if one motion alone had been tried.
    pub fn drawn(draw: &mut Draw, range: Range, by_luck: bool) -> Self {
        loop {
            let wrong = if by_luck { 1.0 } else { range.wrong };
            let pictures = Pictures::drawn(draw, Range { wrong, ..range });
            let near = |draw: &mut Draw| {
                let away = draw.uniform(0.2..4.0) * 1e-3 * draw.normals::<6, 1>();
                se3::retract(&pictures.motion, &away)
            };
            let far = |draw: &mut Draw| draw.pose(0.05..0.4, 0.5..1.0);
            let mut motions: Vec<_> =
                (0..range.tried).map(|k| if k % 3 == 0 { far(draw) } else { near(draw) }).collect();
            draw.shuffle(&mut motions);
            let gate = draw.uniform(3.8..8.0);
            let chance = draw.uniform(0.03..0.09);
            let mut choice = Self { pictures, motions, gate, chance, most_alarms: 1e-3 };
            let best = choice.best();
            if by_luck {
                let single = choice.alarms_of(best, 1);
                choice.most_alarms = single * (range.tried as f64).sqrt();
            }
            let others =
                [choice.with_most(false), choice.with_most(true), choice.of_least_squares()];
            let is_told_apart =
                !others.contains(&best) && others[2] != others[0] && others[2] != others[1];
            let is_refused = choice.alarms_of(best, range.tried) > choice.most_alarms;
            if is_told_apart && is_refused == by_luck {
                return choice;
            }
        }
    }

    fn squares(&self, motion: usize) -> Vec<f64> {
        self.pictures.squares(&self.motions[motion])
    }

    /// Which has the least of something, the first of several.
    fn least(&self, of: impl Fn(&[f64]) -> f64) -> usize {
        let values: Vec<f64> = (0..self.motions.len()).map(|k| of(&self.squares(k))).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        values.iter().position(|value| *value == least).unwrap_or(0)
    }

    fn best(&self) -> usize {
        self.least(|squares| truncated(squares, self.gate))
    }

    fn of_least_squares(&self) -> usize {
        self.least(|squares| squares.iter().sum())
    }

    /// Which has the most inliers, the first or the last of several.
    fn with_most(&self, last: bool) -> usize {
        let counts: Vec<usize> =
            (0..self.motions.len()).map(|k| agreeing(&self.squares(k), self.gate)).collect();
        let most = counts.iter().max();
        let mut places = (0..counts.len()).filter(|k| Some(&counts[*k]) == most);
        let first = places.next().unwrap_or(0);
        if last { places.next_back().unwrap_or(first) } else { first }
    }

    fn alarms_of(&self, motion: usize, tried: usize) -> f64 {
        let agree = agreeing(&self.squares(motion), self.gate);
        alarms(agree, self.pictures.matches.len(), self.chance, tried)
    }
}

/// The instances that students have.
fn drawings() -> Vec<Drawing> {
    let mut draw = Draw::new(21);
    (0..20).map(|_| Drawing::drawn(&mut draw, 60)).collect()
}

fn pictures() -> Vec<Pictures> {
    let mut draw = Draw::new(22);
    (0..6).map(|_| Pictures::drawn(&mut draw, PUBLIC)).collect()
}

fn choices(by_luck: bool) -> Vec<Choice> {
    let mut draw = Draw::new(if by_luck { 23 } else { 24 });
    (0..6).map(|_| Choice::drawn(&mut draw, PUBLIC, by_luck)).collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("one_draw_fewer_would_be_too_few", |answer| {
            drawings().iter().try_for_each(|case| draws(answer, case))
        }),
        Check::new("errors_count_in_variances_of_both_pixels", |answer| {
            pictures().iter().try_for_each(|case| errors(answer, case))
        }),
        Check::new("no_match_costs_more_than_the_gate", |answer| {
            choices(false).iter().try_for_each(|case| scores(answer, case))
        }),
        Check::new("false_alarms_are_counted_over_all_that_was_tried", |answer| {
            choices(true).iter().try_for_each(|case| false_alarm(answer, case))
        }),
        Check::new("the_motion_with_the_least_score_is_chosen", |answer| {
            choices(false).iter().try_for_each(|case| chosen(answer, case))
        }),
        Check::new("what_luck_would_give_is_refused", |answer| {
            choices(true)
                .iter()
                .chain(&choices(false)[..2])
                .try_for_each(|case| chosen(answer, case))
        }),
    ]
}

/// The number of draws, against halving an interval until one draw less would be too few.
///
/// # Errors
///
/// A failure, which names the number that came back where that is known.
pub fn draws(answer: &dyn Transport, case: &Drawing) -> Result<(), Failure> {
    let Drawing { right, matches, sample, useful, confidence } = case;
    let obtained = Answer(answer).draws(right, matches, sample, useful, confidence)?;
    let mut comparison =
        compare_number("the number of draws", obtained as f64, case.expected()).within(1e-9);
    for (misconception, number) in case.wrong() {
        comparison = comparison.or_number(misconception, number);
    }
    comparison.judge().map_err(|failure| failure.given(&[("the instance", case)]))
}

/// Squared errors, against the volume of two rays and the baseline and its differences by all four coordinates.
///
/// # Errors
///
/// A failure, which names the errors that came back where that is known.
pub fn errors(answer: &dyn Transport, case: &Pictures) -> Result<(), Failure> {
    let [first, second] = &case.cameras;
    let obtained = Answer(answer).squared_errors(first, second, &case.motion, &case.matches)?;
    let mut comparison =
        compare_list("the squared errors", &obtained, &case.squares(&case.motion)).within(1e-8);
    for (misconception, list) in case.wrong_squares() {
        comparison = comparison.or_list(misconception, &list);
    }
    comparison.judge()
}

/// The scores of all motions of a choice.
///
/// # Errors
///
/// A failure, which names the score that came back where that is known.
pub fn scores(answer: &dyn Transport, case: &Choice) -> Result<(), Failure> {
    let gate = case.gate;
    for motion in 0..case.motions.len() {
        let squares = case.squares(motion);
        let obtained = Answer(answer).score(&squares, &gate)?;
        let inliers = agreeing(&squares, gate) as f64;
        let sum: f64 = squares.iter().sum();
        let below: f64 = squares.iter().filter(|square| **square <= gate).sum();
        compare_number("the score", obtained, truncated(&squares, gate))
            .within(1e-10)
            .or_number(&INLIERS_COUNTED, inliers)
            .or_number(&INLIERS_COUNTED, squares.len() as f64 - inliers)
            .or_number(&INLIERS_COUNTED, gate * (squares.len() as f64 - inliers))
            .or_number(&INLIERS_COUNTED, -inliers)
            .or_number(&OUTLIERS_FREE, below)
            .or_number(&UNTRUNCATED, sum)
            .judge()?;
    }
    Ok(())
}

/// Numbers of false alarms for the best motion and for one match more and less, against all that chance can do, one match after
/// the other.
///
/// # Errors
///
/// A failure, which names the number that came back where that is known.
pub fn false_alarm(answer: &dyn Transport, case: &Choice) -> Result<(), Failure> {
    let (matches, chance, tried) = (case.pictures.matches.len(), case.chance, case.motions.len());
    let most = agreeing(&case.squares(case.best()), case.gate);
    for agree in [most, most + 1, most.saturating_sub(2)] {
        let obtained = Answer(answer).false_alarms(&agree, &matches, &chance, &tried)?;
        let exactly = tried as f64 * by_chance(matches, chance)[agree];
        compare_number(
            "the number of false alarms",
            obtained,
            alarms(agree, matches, chance, tried),
        )
        .within(1e-8)
        .or_number(&EXACTLY_SO_MANY, exactly)
        .or_number(&MORE_THAN_SO_MANY, alarms(agree + 1, matches, chance, tried))
        .or_number(&TRIED_ONCE, alarms(agree, matches, chance, 1))
        .or_number(&MEAN_COUNT, matches as f64 * chance)
        .or_number(&MEAN_COUNT, tried as f64 * matches as f64 * chance)
        .judge()
        .map_err(|failure| {
            failure.given(&[
                ("agree", &agree),
                ("matches", &matches),
                ("chance", &chance),
                ("tried", &tried),
            ])
        })?;
    }
    Ok(())
}

/// The motion that is chosen, or none. In the comparison −1 stands for none.
///
/// # Errors
///
/// A failure, which names the choice that came back where that is known.
pub fn chosen(answer: &dyn Transport, case: &Choice) -> Result<(), Failure> {
    let [first, second] = &case.pictures.cameras;
    let Choice { motions, gate, chance, most_alarms, .. } = case;
    let matches = &case.pictures.matches;
    let obtained =
        Answer(answer).chosen_motion(first, second, motions, matches, gate, chance, most_alarms)?;
    let number = |place: Option<usize>| place.map_or(-1.0, |place| place as f64);
    let best = case.best();
    let is_luck = case.alarms_of(best, motions.len()) > *most_alarms;
    let expected = (!is_luck).then_some(best);
    let wrong = if is_luck { &NEVER_REFUSED } else { &REFUSED_AT_ONCE };
    let instead = if is_luck { Some(best) } else { None };
    let mut comparison = compare_number("the motion chosen", number(obtained), number(expected))
        .within(1e-9)
        .or_number(wrong, number(instead))
        .or_number(&LEAST_SQUARES, case.of_least_squares() as f64);
    for last in [false, true] {
        comparison = comparison.or_number(&MOST_INLIERS, case.with_most(last) as f64);
    }
    comparison.judge().map_err(|failure| {
        let failure = failure.unless("score", || scores(answer, case));
        let failure = failure.unless("squared_errors", || errors(answer, &case.pictures));
        failure.unless("false_alarms", || false_alarm(answer, case))
    })
}
