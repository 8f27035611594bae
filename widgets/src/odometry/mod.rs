//! The assembled system on a flight: readings and tracks go in, and where the body is comes out, or that it is lost.
//!
//! As in the picture of the filter, a flight is flown a little at a time and from the start whenever a control other than
//! the time has changed.

mod draw;
mod run;
mod setting;
mod tracker;

pub use run::{Frame, Known, Phase, Run, Why};
pub use setting::{Fault, PICTURES, SECONDS, STAND, STANDS, Setting};

use setting::LAST_FAULT;

use crate::{Axis, Control, Face, Kind, Panel, Reading, Scene, Steps, Widget};

/// An odometry that follows a flight.
#[derive(Default)]
pub struct Assembled {
    run: Option<Run>,
}

const ABOVE: usize = 0;
const ELLIPSE: usize = 1;
const POSITION: usize = 2;
const SEEN: usize = 3;

const TIME: Axis = Axis { label: "time, s", range: [0.0, SECONDS] };

const fn map(title: &'static str, [x, y]: [Axis; 2]) -> Panel {
    Panel { title, x, y, aspect: 0.66, span: 3, equal: true, down: false }
}

const fn over_time(title: &'static str, label: &'static str, range: [f64; 2]) -> Panel {
    let y = Axis { label, range };
    Panel { title, x: TIME, y, aspect: 0.42, span: 3, equal: false, down: false }
}

const fn reading(label: &'static str, unit: &'static str, digits: usize) -> Reading {
    Reading { label, unit, digits, none: "nothing known", veiled: false }
}

impl Widget for Assembled {
    const FACE: Face = Face {
        lead: "It stands, flies, and at 17 s stands again. Play, and press a button of what goes wrong: does it know? Dashed is where the body truly flew; rings and discs are states and landmarks of the window.",
        controls: &[
            Control {
                kind: Kind::Sweep,
                ..Control::slider("time", "Time flown", "s", [12.0, 0.0, SECONDS, 0.2])
            },
            Control::moment("pictures", "No pictures for a second", LAST_FAULT),
            Control::moment("tracks", "Wrong tracks for a second", LAST_FAULT),
            Control::moment("readings", "No readings for a second", LAST_FAULT),
            Control::choice("estimator", "Estimator", &["smoother", "MSCKF"]),
            Control::slider("pixel", "Noise of a pixel", "px", [1.0, 0.3, 2.0, 0.1]),
            Control::slider("track", "Longest track", "pictures", [12.0, 6.0, 20.0, 1.0]),
            Control::slider("delay", "Camera's clock late, untold", "ms", [0.0, -30.0, 30.0, 1.0]),
            Control::choice(
                "clock",
                "The clock is",
                &["taken to be right", "estimated on the way"],
            ),
            Control::slider("seed", "Seed of noise and room", "", [1.0, 1.0, 20.0, 1.0]),
        ],
        handles: &[],
        panels: &[
            map(
                "From above: truth (dashed), estimate",
                [
                    Axis { label: "x, m", range: [-6.0, 6.0] },
                    Axis { label: "y, m", range: [-4.7, 4.7] },
                ],
            ),
            map(
                "Truth (cross), one and three σ of x and y",
                [
                    Axis { label: "x, cm", range: [-1.0, 1.0] },
                    Axis { label: "y, cm", range: [-1.0, 1.0] },
                ],
            ),
            over_time("Position: error, reported 2 σ (dashed)", "cm", [0.0, 1.0]),
            over_time("Used of a picture (up), refused (down)", "pixels or tracks", [-1.0, 1.0]),
        ],
        readings: &[
            reading("Position error", "cm", 1),
            reading("Reported σ of the position, three axes", "cm", 1),
            reading("NEES of the position", "", 2),
            reading("Camera's clock, believed late by", "ms", 1),
            reading("Used of the last picture", "", 0),
            reading("Refused of the last picture", "", 0),
            reading("Worlds begun", "", 0),
        ],
        question: None,
        words: &[
            "waiting for a beginning",
            "standing",
            "lost: pictures contradict it",
            "lost: readings are missing",
            "lost: the estimate is no number",
            "lost: the estimator cannot go on",
            "no picture",
            "no readings",
        ],
    };

    const STEPS: Steps = Steps {
        decisions: &["phase", "used", "refused", "worlds", "astray"],
        numbers: &["x", "y", "z", "error", "σ of the position", "NEES", "delay"],
        lost: Some("astray"),
    };

    fn advance(&mut self, controls: &[f64]) -> bool {
        let Some((setting, picture)) = Setting::of(controls) else { return false };
        if !self.run.as_mut().is_some_and(|run| run.becomes(setting)) {
            self.run = Run::new(setting);
        }
        self.run.as_mut().is_some_and(|run| run.advance(picture))
    }

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let Some((run, frames)) = self.flown(controls) else {
            Self::FACE.readings.iter().for_each(|_| scene.read(None));
            return;
        };
        draw::above(run, frames, scene);
        draw::ellipses(frames, scene);
        draw::position(run, frames, scene);
        draw::seen(run, frames, scene);
        let last = frames.last();
        read(last, scene);
        if let Some(last) = last {
            scene.say(phase(last.phase, draw::why(frames)));
        }
    }

    fn steps(&self, controls: &[f64], into: &mut Vec<f64>) {
        for frame in self.flown(controls).into_iter().flat_map(|(_, frames)| frames) {
            let [used, refused] = frame.seen;
            let astray = usize::from(frame.is_astray());
            let decisions = [frame.phase as usize, used, refused, frame.worlds, astray];
            into.extend(decisions.map(|count| count as f64));
            let known = frame.known.as_ref();
            let of = |number: fn(&Known) -> f64| known.map_or(f64::NAN, number);
            into.extend(
                [0, 1, 2].map(|axis| known.map_or(f64::NAN, |known| known.estimate.position[axis])),
            );
            into.extend([of(|known| known.error.norm()), of(|known| known.sigma)]);
            into.push(of(|known| known.nees.unwrap_or(f64::NAN)));
            into.push(frame.delay.unwrap_or(f64::NAN));
        }
    }
}

impl Assembled {
    /// What has been flown of what the controls ask for.
    fn flown(&self, controls: &[f64]) -> Option<(&Run, &[Frame])> {
        let (setting, picture) = Setting::of(controls)?;
        let run = self.run.as_ref().filter(|run| run.setting == setting)?;
        Some((run, &run.frames[..run.frames.len().min(picture + 1)]))
    }
}

/// The numbers after the last picture.
fn read(last: Option<&Frame>, scene: &mut Scene) {
    let known = last.and_then(|frame| frame.known.as_ref());
    scene.read(known.map(|known| 100.0 * known.error.norm()));
    scene.read(known.map(|known| 100.0 * known.sigma));
    scene.read(known.and_then(|known| known.nees));
    scene.read(last.and_then(|frame| frame.delay).map(|seconds| 1e3 * seconds));
    let count = |of: fn(&Frame) -> usize| last.map(|frame| of(frame) as f64);
    scene.read(count(|frame| frame.seen[0]));
    scene.read(count(|frame| frame.seen[1]));
    scene.read(count(|frame| frame.worlds));
}

/// What is said of the last picture.
fn phase(phase: Phase, why: Option<Why>) -> &'static str {
    match (phase, why) {
        (Phase::Missing, _) => {
            "There is no picture: the readings carry the estimate on when one comes."
        }
        (Phase::Early, _) => "No readings have come as far as this picture, so it cannot be used.",
        (Phase::Standing, _) => "The body stands, and is known to.",
        (Phase::Following, _) => "The estimator follows.",
        (_, None) => "Nothing is known yet: a beginning is looked for in the last seconds.",
        (_, Some(Why::Contradicted)) => {
            "Lost: most of what pictures showed has contradicted the estimate for a second. A new beginning is looked for, in a world of its own."
        }
        (_, Some(Why::Gap)) => {
            "Lost: readings are missing, and nobody knows what the body did meanwhile. A new beginning is looked for, in a world of its own."
        }
        (_, Some(Why::Undetermined)) => {
            "Lost: the estimate is no number any more. A new beginning is looked for, in a world of its own."
        }
        (_, Some(Why::Estimator)) => {
            "Lost: the estimator cannot go on. A new beginning is looked for, in a world of its own."
        }
    }
}
