//! The picture of a flight and what an odometry makes of it.

use super::run::{Frame, Known, Phase, Run, Why};
use super::setting::{FAULTS, PICTURES, SECONDS};
use super::{ABOVE, ELLIPSE, POSITION, SEEN};
use crate::curve::rounded;
use crate::ellipse::ellipse;
use crate::{Scene, Shape, Style};

/// A place that ends a line.
const BREAK: [f64; 2] = [f64::NAN; 2];
/// Of the picture of the ellipses, over its width.
const HEIGHT: f64 = 0.66;
/// How far off an error is said to be still within what is reported.
pub const SIGMAS: f64 = 2.0;
/// Where words stand in the picture from above, in metres.
const CORNER: [f64; 2] = [-5.6, 3.4];

/// The room, where the body was and is believed to have been, and what is in the window.
pub fn above(run: &Run, frames: &[Frame], scene: &mut Scene) {
    let truth = &run.recording().truth;
    let landmarks = truth.landmarks.iter().map(|place| [place.x, place.y]);
    scene.draw(ABOVE, (Shape::Discs, Style::Faint, 1.5), landmarks);
    let Some(last) = frames.last() else { return };
    let flown = truth.states[..frames.len()].iter();
    let flown = flown.map(|state| [state.position.x, state.position.y]);
    scene.draw(ABOVE, (Shape::Dashed, Style::Ink, 1.5), flown);
    let mut world = 0;
    let believed = frames.iter().flat_map(|frame| {
        let is_same = std::mem::replace(&mut world, frame.worlds) == frame.worlds;
        let place = frame.known.as_ref().map(seen_from_above);
        let is_missing = frame.phase == Phase::Missing;
        // Another world has nothing to do with the last one, and a picture that is missing breaks no line.
        let before = (!is_same || place.is_none() && !is_missing).then_some(BREAK);
        before.into_iter().chain(place)
    });
    scene.draw(ABOVE, (Shape::Line, Style::Estimated, 2.0), believed);
    scene.draw(ABOVE, (Shape::Discs, Style::Estimated, 2.5), last.points.iter().copied());
    scene.draw(ABOVE, (Shape::Rings, Style::Estimated, 3.0), last.window.iter().copied());
    if let Some(known) = &last.known {
        let [x, y] = seen_from_above(known);
        let around = ellipse(&known.covariance).into_iter();
        let around = around.map(|[dx, dy]| [x + 3.0 * dx, y + 3.0 * dy]);
        scene.draw(ABOVE, (Shape::Area, Style::Estimated, 1.0), around);
        scene.draw(ABOVE, (Shape::Discs, Style::Estimated, 5.0), [[x, y]]);
    }
    let there = truth.states[frames.len() - 1].position;
    scene.draw(ABOVE, (Shape::Crosses, Style::Ink, 4.0), [[there.x, there.y]]);
    if let Some(word) = word(frames) {
        scene.word(ABOVE, word, Style::Third, CORNER);
    }
}

/// What is written into the picture, by its place among the words of the face.
fn word(frames: &[Frame]) -> Option<usize> {
    let last = frames.last()?;
    match last.phase {
        Phase::Following => None,
        Phase::Missing => Some(6),
        Phase::Early => Some(7),
        Phase::Standing => Some(1),
        Phase::Waiting | Phase::Lost => Some(match why(frames) {
            None => 0,
            Some(Why::Contradicted) => 2,
            Some(Why::Gap) => 3,
            Some(Why::Undetermined) => 4,
            Some(Why::Estimator) => 5,
        }),
    }
}

/// Why the odometry was lost after it had followed for the last time.
pub fn why(frames: &[Frame]) -> Option<Why> {
    let since = frames.iter().rposition(|frame| frame.phase == Phase::Following);
    let since = since.map_or(0, |following| following + 1);
    frames[since..].iter().rev().find_map(|frame| frame.lost)
}

/// Where the body is, seen from where it is believed to be, in centimetres.
pub fn ellipses(frames: &[Frame], scene: &mut Scene) {
    let Some(known) = frames.last().and_then(|frame| frame.known.as_ref()) else { return };
    let around = ellipse(&known.covariance);
    let scaled =
        |sigmas: f64| around.iter().map(move |place| place.map(|metres| 100.0 * sigmas * metres));
    let truth = [100.0 * known.error.x, 100.0 * known.error.y];
    let wide = |[x, y]: [f64; 2]| x.abs().max(y.abs() / HEIGHT);
    let reach = rounded(1.1 * scaled(3.0).chain([truth]).map(wide).fold(0.0, f64::max));
    scene.view(ELLIPSE, [-reach, reach], [-HEIGHT * reach, HEIGHT * reach]);
    scene.draw(ELLIPSE, (Shape::Area, Style::Estimated, 1.0), scaled(1.0));
    scene.draw(ELLIPSE, (Shape::Line, Style::Estimated, 2.0), scaled(3.0));
    scene.draw(ELLIPSE, (Shape::Discs, Style::Estimated, 4.0), [[0.0, 0.0]]);
    scene.draw(ELLIPSE, (Shape::Crosses, Style::Ink, 5.0), [truth]);
}

/// The error of the position and what is reported of it, and where nothing is.
pub fn position(run: &Run, frames: &[Frame], scene: &mut Scene) {
    let error = |known: &Known| 100.0 * known.error.norm();
    let sigma = |known: &Known| 100.0 * SIGMAS * known.sigma;
    let reach = rounded(largest(frames, |frame| {
        frame.known.as_ref().map_or(0.0, |known| error(known).max(sigma(known)))
    }));
    scene.view(POSITION, [0.0, SECONDS], [0.0, reach]);
    shade(run, frames, (POSITION, [0.0, reach]), scene);
    let over = |of: &dyn Fn(&Known) -> f64| {
        let places = frames.iter().enumerate().filter(|(_, frame)| frame.phase != Phase::Missing);
        let value = |frame: &Frame| frame.known.as_ref().map_or(f64::NAN, of);
        places.map(|(at, frame)| [seconds(at), value(frame)]).collect::<Vec<_>>()
    };
    scene.draw(POSITION, (Shape::Dashed, Style::Estimated, 2.0), over(&sigma));
    scene.draw(POSITION, (Shape::Line, Style::Ink, 2.0), over(&error));
}

/// What was used of each picture, and what was refused.
pub fn seen(run: &Run, frames: &[Frame], scene: &mut Scene) {
    let [used, refused] = [0, 1].map(|at| move |frame: &Frame| frame.seen[at] as f64);
    let [up, down] = [largest(frames, used).max(10.0), largest(frames, refused).max(4.0)];
    scene.view(SEEN, [0.0, SECONDS], [-1.1 * down, 1.1 * up]);
    shade(run, frames, (SEEN, [-1.1 * down, 1.1 * up]), scene);
    let end = seconds(frames.len().saturating_sub(1));
    let filled = |of: &dyn Fn(&Frame) -> f64| {
        let counts = frames.iter().enumerate().map(|(at, frame)| [seconds(at), of(frame)]);
        counts.chain([[end, 0.0], [0.0, 0.0]]).collect::<Vec<_>>()
    };
    scene.draw(SEEN, (Shape::Area, Style::Estimated, 1.0), filled(&used));
    scene.draw(SEEN, (Shape::Area, Style::Third, 1.0), filled(&|frame| -refused(frame)));
    scene.draw(SEEN, (Shape::Line, Style::Ink, 1.0), [[0.0, 0.0], [SECONDS, 0.0]]);
}

/// Shades when nothing is known of the body, and when something goes wrong.
fn shade(run: &Run, frames: &[Frame], (panel, [low, high]): (usize, [f64; 2]), scene: &mut Scene) {
    let shaded = |[from, to]: [f64; 2]| [[from, low], [to, low], [to, high], [from, high], BREAK];
    let is_unknown = |frame: &Frame| frame.known.is_none() && frame.phase != Phase::Missing;
    let mut spans: Vec<[f64; 2]> = Vec::new();
    for (at, _) in frames.iter().enumerate().filter(|(_, frame)| is_unknown(frame)) {
        let [from, to] = [seconds(at) - 1.0 / PICTURES, seconds(at)];
        match spans.last_mut().filter(|last| last[1] > from - 0.5 / PICTURES) {
            Some(last) => last[1] = to,
            None => spans.push([from.max(0.0), to]),
        }
    }
    scene.draw(panel, (Shape::Area, Style::Faint, 1.0), spans.into_iter().flat_map(shaded));
    let faults = FAULTS.into_iter().filter_map(|fault| run.setting.span(fault));
    scene.draw(panel, (Shape::Area, Style::Prior, 1.0), faults.flat_map(shaded));
}

fn seen_from_above(known: &Known) -> [f64; 2] {
    [known.estimate.position.x, known.estimate.position.y]
}

/// When a picture was taken.
fn seconds(number: usize) -> f64 {
    number as f64 / PICTURES
}

fn largest(frames: &[Frame], of: impl Fn(&Frame) -> f64) -> f64 {
    frames.iter().map(of).fold(0.0, f64::max)
}
