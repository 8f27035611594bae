//! The picture of a flight and its filter.

use vislam::bearing::back_project;
use vislam::filtering::chi_square_band;

use super::run::{Frame, Run, above as seen_from_above};
use super::setting::{PICTURES, SECONDS};
use super::{ABOVE, ELLIPSE, NEES, POSITION, TRACKS, YAW};
use crate::curve::{rounded, thinned};
use crate::ellipse::ellipse;
use crate::{Scene, Shape, Style};

/// A place that ends a line.
const BREAK: [f64; 2] = [f64::NAN; 2];
/// Every so many pictures are a place of a path, and of a line over time.
const EVERY: [usize; 2] = [2, 3];
/// What a consistent filter leaves with this probability.
const OUTSIDE: f64 = 0.05;
/// Of the picture of the ellipses, over its width.
const HEIGHT: f64 = 0.75;
/// Of powers of ten of the NEES.
const LEAST_POWER: f64 = -2.0;

/// Where the body is and is believed to be, with the poses of the window and the rays of the last picture.
pub fn above(run: &Run, frames: &[Frame], scene: &mut Scene) {
    let truth = &run.recording().truth;
    let landmarks = truth.landmarks.iter().map(|place| [place.x, place.y]);
    scene.draw(ABOVE, (Shape::Discs, Style::Faint, 1.5), landmarks);
    let Some(last) = frames.last() else { return };
    let (right, wrong) = rays(run, frames.len() - 1, last);
    scene.draw(ABOVE, (Shape::Line, Style::Measured, 1.0), right);
    scene.draw(ABOVE, (Shape::Dashed, Style::Third, 1.5), wrong);
    let flown = truth.states[..frames.len()].iter().map(seen_from_above);
    scene.draw(ABOVE, (Shape::Dashed, Style::Ink, 1.5), thinned(EVERY[0], flown));
    let believed = frames.iter().map(|frame| seen_from_above(&frame.estimate));
    scene.draw(ABOVE, (Shape::Line, Style::Estimated, 2.0), thinned(EVERY[0], believed));
    scene.draw(ABOVE, (Shape::Rings, Style::Estimated, 3.0), last.poses.iter().copied());
    let now = [seen_from_above(&last.estimate)];
    scene.draw(ABOVE, (Shape::Discs, Style::Estimated, 5.0), now);
}

/// From where the body is believed to be along the pixels of a picture, as far as the landmarks are: of right pixels and
/// of wrong ones.
fn rays(run: &Run, number: usize, frame: &Frame) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let (flight, truth) = (&run.recording().flight, &run.recording().truth);
    let camera_from_world = flight.rig.camera_from_world(&truth.states[number]);
    let world_from_camera = flight.rig.world_from_camera(&frame.estimate);
    let centre = world_from_camera.translation.vector;
    let (mut right, mut wrong) = (Vec::new(), Vec::new());
    for feature in &run.recording().pictures[number].features {
        let landmark = truth.landmarks[truth.landmark_of_track[feature.track]];
        let depth = camera_from_world.transform_point(&landmark.into()).z;
        let end = back_project(&flight.camera, &feature.pixel, depth);
        let end = world_from_camera.transform_point(&end.into());
        let is_wrong = truth.outliers.binary_search(&(number, feature.track)).is_ok();
        let into = if is_wrong { &mut wrong } else { &mut right };
        into.extend([[centre.x, centre.y], [end.x, end.y], BREAK]);
    }
    (right, wrong)
}

/// Where the body is, seen from where it is believed to be, in centimetres.
pub fn ellipses(frames: &[Frame], scene: &mut Scene) {
    let Some(last) = frames.last() else { return };
    let around = ellipse(&last.covariance);
    let scaled =
        |sigmas: f64| around.iter().map(move |place| place.map(|metres| 100.0 * sigmas * metres));
    let truth = [100.0 * last.error.position.x, 100.0 * last.error.position.y];
    let wide = |[x, y]: [f64; 2]| x.abs().max(y.abs() / HEIGHT);
    let reach = rounded(1.1 * scaled(3.0).chain([truth]).map(wide).fold(0.0, f64::max));
    scene.view(ELLIPSE, [-reach, reach], [-HEIGHT * reach, HEIGHT * reach]);
    scene.draw(ELLIPSE, (Shape::Area, Style::Estimated, 1.0), scaled(1.0));
    scene.draw(ELLIPSE, (Shape::Line, Style::Estimated, 2.0), scaled(3.0));
    scene.draw(ELLIPSE, (Shape::Discs, Style::Estimated, 4.0), [[0.0, 0.0]]);
    scene.draw(ELLIPSE, (Shape::Crosses, Style::Ink, 5.0), [truth]);
}

/// The error of the position and what is reported of it.
pub fn position(frames: &[Frame], scene: &mut Scene) {
    let error = |frame: &Frame| 100.0 * frame.error.position.norm();
    let sigma = |frame: &Frame| 100.0 * frame.sigma;
    let reach = rounded(largest(frames, |frame| error(frame).max(sigma(frame))));
    scene.view(POSITION, [0.0, SECONDS], [0.0, reach]);
    scene.draw(POSITION, (Shape::Dashed, Style::Estimated, 2.0), over_time(frames, sigma));
    scene.draw(POSITION, (Shape::Line, Style::Ink, 2.0), over_time(frames, error));
}

/// The error of the yaw, what is reported of it, and what was known at the start.
pub fn yaw(frames: &[Frame], scene: &mut Scene) {
    let error = |frame: &Frame| frame.error.yaw().to_degrees();
    let sigma = |frame: &Frame| frame.yaw_sigma.to_degrees();
    let reach = rounded(1.1 * largest(frames, |frame| error(frame).abs().max(sigma(frame))));
    scene.view(YAW, [0.0, SECONDS], [-reach, reach]);
    let start = frames.first().map_or(0.0, sigma);
    let shaded = [[0.0, start], [SECONDS, start], [SECONDS, -start], [0.0, -start]];
    scene.draw(YAW, (Shape::Area, Style::Prior, 1.0), shaded);
    scene.draw(YAW, (Shape::Dashed, Style::Estimated, 2.0), over_time(frames, sigma));
    scene.draw(YAW, (Shape::Dashed, Style::Estimated, 2.0), over_time(frames, |f| -sigma(f)));
    scene.draw(YAW, (Shape::Line, Style::Ink, 2.0), over_time(frames, error));
}

/// For each picture the tracks that corrected the filter, and those that the gate refused.
pub fn tracks(frames: &[Frame], scene: &mut Scene) {
    let used = |frame: &Frame| frame.report.used as f64;
    let gated = |frame: &Frame| frame.report.refused.gated as f64;
    let [up, down] = [largest(frames, used).max(5.0), largest(frames, gated).max(2.0)];
    scene.view(TRACKS, [0.0, SECONDS], [-1.1 * down, 1.1 * up]);
    let end = seconds(frames.len().saturating_sub(1));
    let filled = |of: &dyn Fn(&Frame) -> f64| {
        let counts = frames.iter().enumerate().map(|(at, frame)| [seconds(at), of(frame)]);
        counts.chain([[end, 0.0], [0.0, 0.0]]).collect::<Vec<_>>()
    };
    scene.draw(TRACKS, (Shape::Area, Style::Estimated, 1.0), filled(&used));
    scene.draw(TRACKS, (Shape::Area, Style::Third, 1.0), filled(&|frame| -gated(frame)));
    scene.draw(TRACKS, (Shape::Line, Style::Ink, 1.0), [[0.0, 0.0], [SECONDS, 0.0]]);
}

/// The normalized errors squared, with the band in which that of the position mostly lies.
pub fn nees(frames: &[Frame], scene: &mut Scene) {
    if let Ok(band) = chi_square_band(OUTSIDE, 3) {
        let [low, high] = band.map(|end| (end / 3.0).log10());
        let shaded = [[0.0, low], [SECONDS, low], [SECONDS, high], [0.0, high]];
        scene.draw(NEES, (Shape::Area, Style::Faint, 1.0), shaded);
    }
    let power = |nees: Option<f64>| nees.map_or(f64::NAN, |nees| nees.log10().max(LEAST_POWER));
    let yaw = |frame: &Frame| power(frame.nees.map(|nees| nees.yaw));
    let position = |frame: &Frame| power(frame.nees.map(|nees| nees.position));
    scene.draw(NEES, (Shape::Dashed, Style::Second, 1.5), over_time(frames, yaw));
    scene.draw(NEES, (Shape::Line, Style::First, 2.0), over_time(frames, position));
}

/// When a picture was taken.
fn seconds(number: usize) -> f64 {
    number as f64 / PICTURES
}

fn over_time(frames: &[Frame], of: impl Fn(&Frame) -> f64) -> impl Iterator<Item = [f64; 2]> {
    let places = frames.iter().enumerate().map(move |(at, frame)| [seconds(at), of(frame)]);
    thinned(EVERY[1], places)
}

fn largest(frames: &[Frame], of: impl Fn(&Frame) -> f64) -> f64 {
    frames.iter().map(of).fold(0.0, f64::max)
}
