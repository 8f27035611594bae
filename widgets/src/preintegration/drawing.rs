//! The panels.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Vector2};
use vislam::inertial::{ImuBias, NavState};
use vislam::preintegration::{Matrix9, Vector9};

use super::interval::{Belief, DT, Interval};
use crate::{Scene, Shape, Style};

pub const FLIGHT: usize = 0;
pub const END: usize = 1;
pub const RESIDUAL: usize = 2;
pub const CORRELATIONS: usize = 3;
pub const CORRECTION: usize = 4;

/// The nine errors, and what marks mean.
#[rustfmt::skip]
pub const WORDS: &[&str] = &[
    "φx", "φy", "φz", "vx", "vy", "vz", "px", "py", "pz",
    "as summed", "corrected", "summed again", "first keyframe", "second keyframe", "in fact", "at most",
    "σ of the position", "to be summed again",
];
const AS_SUMMED: usize = 9;
const CORRECTED: usize = 10;
const SUMMED_AGAIN: usize = 11;
const FIRST_KEYFRAME: usize = 12;
const SECOND_KEYFRAME: usize = 13;
const IN_FACT: usize = 14;
const AT_MOST: usize = 15;
const SIGMA: usize = 16;
const TO_BE_SUMMED_AGAIN: usize = 17;

/// Standard deviations of the ellipse.
const REACH: f64 = 3.0;
/// Correlations from which a cell is one shade darker, and those from which it is filled.
const SHADES: [f64; 4] = [0.1, 0.3, 0.5, 0.7];
const FILLED: f64 = 0.9;

const THIN: (Shape, Style, f64) = (Shape::Line, Style::Faint, 1.0);
const BREAK: [f64; 2] = [f64::NAN; 2];

/// The whole motion, the way between the keyframes, and what the sums make of it.
pub fn flight(scene: &mut Scene, panel: usize, interval: &Interval, belief: &Belief) {
    let motion = interval.setting.trajectory();
    let ([x, y], seconds) = match interval.setting.motion {
        0 => ([[-3.4, 3.4], [-1.9, 1.9]], TAU / 0.8),
        1 => ([[-2.3, 2.3], [-0.3, 4.3]], TAU / 0.5),
        _ => ([[-1.0, 1.0], [-0.6, 0.6]], 1.0),
    };
    scene.view(panel, x, y);
    let places = |from: f64, to: f64, parts: usize| {
        let at = move |part: usize| motion.at(from + (to - from) * part as f64 / parts as f64);
        (0..=parts).map(move |part| above(&at(part).state))
    };
    scene.draw(panel, THIN, places(0.0, seconds, 100));
    let truth = places(0.0, interval.setting.steps as f64 * DT, 30);
    scene.draw(panel, (Shape::Line, Style::Ink, 1.5), truth);
    let unbiased = ImuBias::default();
    let [as_summed, corrected] =
        [&unbiased, &belief.bias].map(|bias| interval.way(bias).map(|state| above(&state)));
    scene.draw(panel, (Shape::Dashed, Style::Measured, 2.0), as_summed);
    scene.draw(panel, (Shape::Line, Style::Estimated, 2.5), corrected);
    let end = above(&interval.second);
    let around = ellipse(interval).map(|[x, y]| [end[0] + x, end[1] + y]);
    scene.draw(panel, (Shape::Line, Style::Ink, 1.0), around);
    scene.draw(panel, (Shape::Discs, Style::Ink, 4.0), [above(&interval.first)]);
    scene.draw(panel, (Shape::Crosses, Style::Ink, 5.0), [end]);
    let below = 0.06 * (x[1] - x[0]);
    let [x, y] = above(&interval.first);
    scene.word(panel, FIRST_KEYFRAME, Style::Ink, [x, y - below]);
    if interval.setting.motion < 2 {
        scene.word(panel, SECOND_KEYFRAME, Style::Ink, [end[0], end[1] + below]);
    }
}

/// Where the sums say that the body is, from where it is, in centimetres.
pub fn end(
    scene: &mut Scene,
    panel: usize,
    interval: &Interval,
    belief: &Belief,
    other: &[[f64; 2]],
) {
    let off = |state: &NavState| centimetres(above(&NavState {
        position: state.position - interval.second.position,
        ..*state
    }));
    let again = || interval.curve.iter().map(|left| off(&left.again));
    let believed = |part| interval.believe(part).predicted;
    let line = [believed(0.0), believed(Interval::believed(interval.curve.len() - 1))];
    let line = line.map(|state| off(&state));
    let around = || ellipse(interval).map(centimetres);
    let reach = |axis: usize| {
        let places = again().chain(line).chain(around());
        1.15 * places.map(|place| place[axis].abs()).fold(0.0, f64::max)
    };
    let (x, y) = (reach(0), reach(1));
    scene.view(panel, [-x, x], [-y, y]);
    scene.draw(panel, (Shape::Discs, Style::Faint, 2.0), other.iter().copied().map(centimetres));
    scene.draw(panel, (Shape::Line, Style::Ink, 1.5), around());
    scene.draw(panel, (Shape::Line, Style::Estimated, 1.0), line);
    scene.draw(panel, (Shape::Dashed, Style::Ink, 1.0), again());
    scene.draw(panel, (Shape::Crosses, Style::Ink, 5.0), [[0.0, 0.0]]);
    scene.draw(panel, (Shape::Rings, Style::Measured, 4.0), [line[0]]);
    scene.draw(panel, (Shape::Rings, Style::Estimated, 6.0), [off(&belief.predicted)]);
    scene.draw(panel, (Shape::Discs, Style::Ink, 2.5), [off(&belief.left.again)]);
}

/// Bars of the nine residuals, with lines at one and three standard deviations.
pub fn residual(scene: &mut Scene, panel: usize, belief: &Belief) {
    let most = (1.15 * belief.in_sigmas.amax()).max(4.0);
    scene.view(panel, [0.3, 9.7], [-1.15 * most, most]);
    let level = |y: f64| [[0.3, y], [9.7, y], BREAK];
    scene.draw(panel, (Shape::Line, Style::Ink, 1.0), level(0.0));
    scene.draw(panel, (Shape::Dashed, Style::Ink, 1.0), [3.0, -3.0].map(level).concat());
    let bar = |(at, sigmas): (usize, &f64)| [[at as f64 + 1.0, 0.0], [at as f64 + 1.0, *sigmas], BREAK];
    let bars = belief.in_sigmas.iter().enumerate().flat_map(bar);
    scene.draw(panel, (Shape::Line, Style::Estimated, 12.0), bars);
    for word in 0..9 {
        scene.word(panel, word, Style::Ink, [word as f64 + 0.75, -1.1 * most]);
    }
}

/// Shades for the correlations; a negative one has a minus sign.
pub fn correlations(scene: &mut Scene, panel: usize, covariance: &Matrix9) {
    scene.view(panel, [-0.4, 9.5], [-0.4, 9.5]);
    let sigmas: Vector9 = covariance.diagonal().map(f64::sqrt);
    let cells = |wanted: fn(f64, f64) -> bool, least: f64| {
        let all = (0..9).flat_map(|row| (0..9).map(move |column| (row, column)));
        all.filter(move |&(row, column)| {
            let correlation = covariance[(row, column)] / (sigmas[row] * sigmas[column]);
            row != column && wanted(correlation, least)
        })
    };
    let place = |(row, column): (usize, usize)| [column as f64 + 1.0, row as f64 + 1.0];
    let [more, less]: [fn(f64, f64) -> bool; 2] = [|c, least| c >= least, |c, least| c <= -least];
    for (style, wanted) in [(Style::First, more), (Style::Second, less)] {
        for least in SHADES {
            scene.draw(panel, (Shape::PaleCells, style, 1.0), cells(wanted, least).map(place));
        }
        scene.draw(panel, (Shape::Cells, style, 1.0), cells(wanted, FILLED).map(place));
    }
    let diagonal = (0..9).map(|at| place((at, at)));
    scene.draw(panel, (Shape::Cells, Style::Faint, 1.0), diagonal);
    let minus = cells(less, SHADES[0]).map(place);
    let minus = minus.flat_map(|[x, y]| [[x - 0.2, y], [x + 0.2, y], BREAK]);
    scene.draw(panel, (Shape::Line, Style::Ink, 1.5), minus);
    let between = [3.5, 6.5].map(|at| [[at, 0.5], [at, 9.5], BREAK, [0.5, at], [9.5, at], BREAK]);
    scene.draw(panel, (Shape::Line, Style::Ink, 1.0), between.concat());
    for word in 0..9 {
        let at = word as f64 + 1.0;
        scene.word(panel, word, Style::Ink, [at - 0.25, 0.3]);
        scene.word(panel, word, Style::Ink, [-0.3, at + 0.15]);
    }
}

/// What is left of the position over how far the bias was moved, in millimetres.
pub fn correction(scene: &mut Scene, panel: usize, interval: &Interval, belief: &Belief) {
    let gyro = interval.setting.gyro;
    let curve = || interval.curve.iter().enumerate();
    let moved = |place: usize| Interval::believed(place) * gyro;
    let most = |top: f64| if top > 0.0 { top } else { 1.0 };
    let farthest = most(moved(interval.curve.len() - 1));
    let top = most(interval.curve.iter().fold(0.0, |top, left| 1080.0 * left.bound.max(top)));
    scene.view(panel, [0.0, farthest], [0.0, top]);
    let marks = [
        ((Shape::Line, Style::Estimated, 2.5), IN_FACT),
        ((Shape::Dashed, Style::Ink, 1.5), AT_MOST),
        ((Shape::Line, Style::Measured, 1.5), SIGMA),
        ((Shape::Dashed, Style::Prior, 2.0), TO_BE_SUMMED_AGAIN),
    ];
    for (row, (mark, word)) in marks.into_iter().enumerate() {
        let y = (0.92 - 0.11 * row as f64) * top;
        scene.draw(panel, mark, [[0.02 * farthest, y], [0.07 * farthest, y]]);
        scene.word(panel, word, Style::Ink, [0.085 * farthest, y - 0.03 * top]);
    }
    if gyro > 0.0 {
        scene.draw(panel, marks[0].0, curve().map(|(at, left)| [moved(at), 1e3 * left.error]));
        scene.draw(panel, marks[1].0, curve().map(|(at, left)| [moved(at), 1e3 * left.bound]));
        let sigma = 1e3 * interval.sums().sigmas()[2];
        scene.draw(panel, marks[2].0, [[0.0, sigma], [farthest, sigma]]);
        if let Some(part) = interval.again_beyond {
            scene.draw(panel, marks[3].0, [[part * gyro, 0.0], [part * gyro, top]]);
        }
        let now = [belief.part * gyro, 1e3 * belief.left.error];
        scene.draw(panel, (Shape::Rings, Style::Estimated, 6.0), [now]);
    }
}

/// Around the second keyframe, in metres: where positions seen from above should lie.
fn ellipse(interval: &Interval) -> impl Iterator<Item = [f64; 2]> {
    let rotation = interval.first.world_from_body;
    let covariance = interval.sums().covariance.fixed_view::<3, 3>(6, 6).into_owned();
    let covariance = rotation * covariance * rotation.inverse();
    let level: Matrix2<f64> = covariance.fixed_view::<2, 2>(0, 0).into_owned();
    let root = level.cholesky().map_or(Matrix2::zeros(), |factor| factor.l());
    (0..=48).map(move |part| {
        let angle = TAU * f64::from(part) / 48.0;
        let place = REACH * root * Vector2::new(angle.cos(), angle.sin());
        [place.x, place.y]
    })
}

fn above(state: &NavState) -> [f64; 2] {
    [state.position.x, state.position.y]
}

fn centimetres(place: [f64; 2]) -> [f64; 2] {
    place.map(|metres| 1e2 * metres)
}
