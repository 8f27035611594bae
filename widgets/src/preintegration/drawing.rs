//! The panels.

use std::f64::consts::TAU;

use vislam::inertial::{ImuBias, NavState};
use vislam::preintegration::{Matrix9, Vector9};

use super::interval::{Belief, DT, Interval, Left};
use crate::ellipse::ellipse;
use crate::{Scene, Shape, Style};

pub const END: usize = 0;
pub const FLIGHT: usize = 1;
pub const RESIDUAL: usize = 2;
pub const CORRELATIONS: usize = 3;
pub const CORRECTION: usize = 4;

/// The nine errors, and what marks mean.
#[rustfmt::skip]
pub const WORDS: &[&str] = &[
    "φx", "φy", "φz", "vx", "vy", "vz", "px", "py", "pz",
    "as summed", "corrected", "summed again", "truth", "in fact", "at most", "σ of the position",
    "sum again from here",
];
const AS_SUMMED: usize = 9;
const CORRECTED: usize = 10;
const SUMMED_AGAIN: usize = 11;
const TRUTH: usize = 12;
const IN_FACT: usize = 13;
const AT_MOST: usize = 14;
const SIGMA: usize = 15;
const SUM_AGAIN: usize = 16;

/// How places are drawn that the panels have in common.
const AS_SUMMED_LINE: Mark = (Shape::Dashed, Style::Measured, 2.0);
const AS_SUMMED_END: Mark = (Shape::Rings, Style::Measured, 4.0);
const CORRECTED_LINE: Mark = (Shape::Line, Style::Estimated, 2.5);
const CORRECTED_END: Mark = (Shape::Rings, Style::Estimated, 6.0);
const SUMMED_AGAIN_END: Mark = (Shape::Discs, Style::Ink, 2.5);
const TRUE_LINE: Mark = (Shape::Line, Style::Ink, 1.5);
const TRUE_END: Mark = (Shape::Crosses, Style::Ink, 5.0);

/// What is shown of what the correction leaves: powers of ten of moves in mrad/s, and of millimetres.
const MOVES: [f64; 2] = [0.0, 2.4];
const LEFT_BEHIND: [f64; 2] = [-4.0, 3.5];
/// Standard deviations of the ellipse.
const REACH: f64 = 3.0;
/// Correlations from which a cell is one shade darker, and those from which it is filled.
const SHADES: [f64; 4] = [0.1, 0.3, 0.5, 0.7];
const FILLED: f64 = 0.9;

type Mark = (Shape, Style, f64);
const THIN: Mark = (Shape::Line, Style::Faint, 1.0);
const BREAK: [f64; 2] = [f64::NAN; 2];

/// The whole motion, the way between the keyframes, and what the sums make of it.
pub fn flight(scene: &mut Scene, panel: usize, interval: &Interval, belief: &Belief) {
    let motion = interval.setting.trajectory();
    let ([x, y], seconds) = match interval.setting.motion {
        0 => ([[-3.4, 3.4], [-3.0, 1.9]], TAU / 0.8),
        1 => ([[-4.0, 4.0], [-1.5, 4.3]], TAU / 0.5),
        _ => ([[-1.0, 1.0], [-0.8, 0.6]], 1.0),
    };
    scene.view(panel, x, y);
    let places = |from: f64, to: f64, parts: usize| {
        let at = move |part: usize| motion.at(from + (to - from) * part as f64 / parts as f64);
        (0..=parts).map(move |part| above(&at(part).state))
    };
    scene.draw(panel, THIN, places(0.0, seconds, 100));
    scene.draw(panel, TRUE_LINE, places(0.0, interval.setting.steps as f64 * DT, 30));
    let unbiased = ImuBias::default();
    let [as_summed, corrected] =
        [&unbiased, &belief.bias].map(|bias| interval.way(bias).map(|state| above(&state)));
    scene.draw(panel, AS_SUMMED_LINE, as_summed);
    scene.draw(panel, CORRECTED_LINE, corrected);
    let end = above(&interval.second);
    let line = around(interval).map(|[x, y]| [end[0] + x, end[1] + y]);
    scene.draw(panel, (Shape::Line, Style::Ink, 1.0), line);
    scene.draw(panel, (Shape::Discs, Style::Ink, 4.0), [above(&interval.first)]);
    scene.draw(panel, TRUE_END, [end]);
    key(scene, panel, [x, y]);
}

/// What the marks of both pictures of the flight mean, below them.
fn key(scene: &mut Scene, panel: usize, [x, y]: [[f64; 2]; 2]) {
    let (width, height) = (x[1] - x[0], y[1] - y[0]);
    let entries: [(&[Mark], usize); 4] = [
        (&[AS_SUMMED_LINE, AS_SUMMED_END], AS_SUMMED),
        (&[CORRECTED_LINE, CORRECTED_END], CORRECTED),
        (&[SUMMED_AGAIN_END], SUMMED_AGAIN),
        (&[TRUE_LINE, TRUE_END], TRUTH),
    ];
    for (number, (marks, word)) in entries.into_iter().enumerate() {
        let left = x[0] + width * [0.02, 0.52][number % 2];
        let at = y[0] + height * [0.16, 0.05][number / 2];
        for mark in marks {
            let [start, end] = [[left, at], [left + 0.08 * width, at]];
            let middle = [left + 0.04 * width, at];
            let is_line = matches!(mark.0, Shape::Line | Shape::Dashed);
            scene.draw(panel, *mark, if is_line { [start, end] } else { [middle, BREAK] });
        }
        scene.word(panel, word, Style::Ink, [left + 0.11 * width, at - 0.025 * height]);
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
    let off = |state: &NavState| {
        centimetres(above(&NavState {
            position: state.position - interval.second.position,
            ..*state
        }))
    };
    let again = || interval.curve.iter().map(|left| off(&left.again));
    let believed = |part| interval.believe(part).predicted;
    let line = [believed(0.0), believed(Interval::believed(interval.curve.len() - 1))];
    let line = line.map(|state| off(&state));
    let around = || around(interval).map(centimetres);
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
    scene.draw(panel, TRUE_END, [[0.0, 0.0]]);
    scene.draw(panel, AS_SUMMED_END, [line[0]]);
    scene.draw(panel, CORRECTED_END, [off(&belief.predicted)]);
    scene.draw(panel, SUMMED_AGAIN_END, [off(&belief.left.again)]);
}

/// Bars of the nine residuals, with lines at one and three standard deviations.
pub fn residual(scene: &mut Scene, panel: usize, belief: &Belief) {
    let most = (1.15 * belief.in_sigmas.amax()).max(4.0);
    scene.view(panel, [0.3, 9.7], [-1.15 * most, most]);
    let level = |y: f64| [[0.3, y], [9.7, y], BREAK];
    scene.draw(panel, (Shape::Line, Style::Ink, 1.0), level(0.0));
    scene.draw(panel, (Shape::Dashed, Style::Ink, 1.0), [3.0, -3.0].map(level).concat());
    let bar =
        |(at, sigmas): (usize, &f64)| [[at as f64 + 1.0, 0.0], [at as f64 + 1.0, *sigmas], BREAK];
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
    scene.draw(panel, (Shape::PaleCells, Style::Faint, 1.0), diagonal);
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
    let at = |part: f64, left: f64| [(part * gyro).log10(), (1e3 * left).log10()];
    let ([left, right], [bottom, top]) = (MOVES, LEFT_BEHIND);
    scene.view(panel, MOVES, LEFT_BEHIND);
    let marks = [
        ((Shape::Line, Style::Estimated, 2.5), IN_FACT),
        ((Shape::Dashed, Style::Ink, 1.5), AT_MOST),
        ((Shape::Line, Style::Third, 1.5), SIGMA),
        ((Shape::Dashed, Style::Second, 2.0), SUM_AGAIN),
    ];
    for (row, (mark, word)) in marks.into_iter().enumerate() {
        let [x, y] = [left + 1.3, bottom + (0.29 - 0.075 * row as f64) * (top - bottom)];
        scene.draw(panel, mark, [[x, y], [x + 0.12, y]]);
        scene.word(panel, word, Style::Ink, [x + 0.15, y - 0.02 * (top - bottom)]);
    }
    if gyro > 0.0 {
        let [error, bound] = [|left: &Left| left.error, |left: &Left| left.bound];
        let drawn = |of: fn(&Left) -> f64| {
            curve().skip(1).map(move |(place, left)| at(Interval::believed(place), of(left)))
        };
        scene.draw(panel, marks[0].0, drawn(error));
        scene.draw(panel, marks[1].0, drawn(bound));
        let sigma = at(1.0, interval.sums().sigmas()[2])[1];
        scene.draw(panel, marks[2].0, [[left, sigma], [right, sigma]]);
        if let Some(part) = interval.again_beyond {
            let [x, _] = at(part, 1.0);
            scene.draw(panel, marks[3].0, [[x, bottom], [x, 0.5 * (bottom + top)]]);
        }
        let now = at(belief.part, belief.left.error);
        scene.draw(panel, (Shape::Rings, Style::Estimated, 6.0), [now]);
    }
}

/// Around the second keyframe, in metres: where positions seen from above should lie.
fn around(interval: &Interval) -> impl Iterator<Item = [f64; 2]> {
    let rotation = interval.first.world_from_body;
    let covariance = interval.sums().covariance.fixed_view::<3, 3>(6, 6).into_owned();
    let covariance = rotation * covariance * rotation.inverse();
    let level = covariance.fixed_view::<2, 2>(0, 0).into_owned();
    ellipse(&level).into_iter().map(|place| place.map(|metres| REACH * metres))
}

fn above(state: &NavState) -> [f64; 2] {
    [state.position.x, state.position.y]
}

fn centimetres(place: [f64; 2]) -> [f64; 2] {
    place.map(|metres| 1e2 * metres)
}
