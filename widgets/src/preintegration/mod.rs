//! The readings between two keyframes as one measurement: what they predict, how sure they are, what a factor says of
//! them, and what becomes of them when their bias moves.

mod cloud;
mod drawing;
mod interval;

use cloud::Cloud;
use drawing::{CORRECTION, CORRELATIONS, END, FLIGHT, RESIDUAL};
use interval::Interval;
pub use interval::{DT, Setting};

use crate::{Axis, Control, Face, Kind, Panel, Question, Reading, Scene, Widget};

/// An interval of a flight, and what other flights with the same motion would have made of it.
#[derive(Default)]
pub struct Preintegration {
    interval: Option<Interval>,
    cloud: Cloud,
}

const fn panel(title: &'static str, [x, y]: [&'static str; 2], aspect: f64) -> Panel {
    let (x, y) = (Axis { label: x, range: [-1.0, 1.0] }, Axis { label: y, range: [-1.0, 1.0] });
    Panel { title, x, y, aspect, span: 3, equal: false, down: false }
}

const fn reading(label: &'static str, unit: &'static str, digits: usize) -> Reading {
    Reading { label, unit, digits, none: "none", veiled: false }
}

impl Widget for Preintegration {
    const FACE: Face = Face {
        lead: "The readings were summed before their bias was known. Draw the believed bias from the true one down to nothing and up again: the corrected sums (ring) move along a straight line, sums made again (dot) along a curve. Then put two seconds between the keyframes and the bias at one and a half: the dot leaves the ring.",
        controls: &[
            Control {
                kind: Kind::Sweep,
                ..Control::slider(
                    "believed",
                    "Bias believed, over the true one",
                    "",
                    [1.0, 0.0, 1.5, 0.01],
                )
            },
            Control::slider("seconds", "Time between the keyframes", "s", [1.0, 0.1, 2.0, 0.05]),
            Control::slider("gyro", "Bias of the gyroscope", "mrad/s", [100.0, 0.0, 150.0, 1.0]),
            Control::choice("axis", "Axis of that bias", &["ahead", "up"]),
            Control::slider(
                "force",
                "Bias of the accelerometer, to the left",
                "m/s²",
                [0.0, 0.0, 0.5, 0.01],
            ),
            Control {
                kind: Kind::Logarithmic,
                ..Control::slider(
                    "noise",
                    "Noise, over that of a poor sensor",
                    "",
                    [1.0, 0.05, 5.0, 0.01],
                )
            },
            Control::choice(
                "motion",
                "Motion",
                &["figure-eight", "level turn", "turn on the spot"],
            ),
            Control::count("other", "Other noise", 999.0),
        ],
        handles: &[],
        panels: &[
            Panel {
                equal: true,
                ..panel("Second keyframe, 3σ ellipse", ["x from the truth, cm", "y, cm"], 0.62)
            },
            Panel { equal: true, ..panel("Seen from above", ["x, m", "y, m"], 0.62) },
            panel("Residual of the inertial factor", ["", "standard deviations"], 0.8),
            Panel { down: true, ..panel("Correlations of the nine errors", ["", ""], 0.8) },
            Panel {
                span: 6,
                ..panel(
                    "What the first-order correction leaves",
                    [
                        "move of the gyroscope's bias, power of ten of mrad/s",
                        "position, power of ten of mm",
                    ],
                    0.44,
                )
            },
        ],
        readings: &[
            reading("Steps summed", "", 0),
            reading("σ of the rotation", "mrad", 2),
            reading("σ of the velocity", "cm/s", 2),
            reading("σ of the position", "cm", 2),
            reading("Largest of the nine residuals", "σ", 1),
            reading("Squared whitened residual, nine on average", "", 1),
            Reading { veiled: true, ..reading("Left of the position by first order", "mm", 3) },
            Reading { veiled: true, ..reading("Bound on what is left", "mm", 3) },
            Reading {
                none: "nothing is left",
                ..reading("Sum again beyond a move of", "mrad/s", 1)
            },
        ],
        question: Some(Question {
            ask: "The same move of the bias, and twice the time between the keyframes: how many times as much of the position does the first-order correction leave?",
            choices: &["about twice", "about four times", "about sixteen times"],
            right: 2,
            why: "What is left grows with the square of the move and the fourth power of the time: read it off the last panel, where each unit is a factor of ten.",
        }),
        words: drawing::WORDS,
    };

    fn advance(&mut self, controls: &[f64]) -> bool {
        let Some((setting, _)) = Setting::of(controls) else { return false };
        self.sum(setting);
        self.interval.as_ref().is_some_and(|interval| self.cloud.advance(interval))
    }

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let Some((setting, believed)) = Setting::of(controls) else { return };
        self.sum(setting);
        let Some(interval) = &self.interval else { return };
        let other_ends = self.cloud.ends();
        let belief = interval.believe(believed);
        drawing::flight(scene, FLIGHT, interval, &belief);
        drawing::end(scene, END, interval, &belief, other_ends);
        drawing::residual(scene, RESIDUAL, &belief);
        drawing::correlations(scene, CORRELATIONS, &interval.sums().covariance);
        drawing::correction(scene, CORRECTION, interval, &belief);
        read(scene, interval, &belief);
    }
}

impl Preintegration {
    /// Sums the readings of a setting, if they are not summed yet.
    fn sum(&mut self, setting: Setting) {
        if self.interval.as_ref().is_none_or(|interval| interval.setting != setting) {
            self.interval = Interval::new(setting);
        }
    }
}

fn read(scene: &mut Scene, interval: &Interval, belief: &interval::Belief) {
    let [rotation, velocity, position] = interval.sums().sigmas();
    scene.read(interval.sums().steps as f64);
    scene.read(1e3 * rotation);
    scene.read(1e2 * velocity);
    scene.read(1e2 * position);
    scene.read(belief.in_sigmas.amax());
    scene.read(belief.squared);
    scene.read(1e3 * belief.left.error);
    scene.read(1e3 * belief.left.bound);
    scene.read(interval.again_beyond.map(|part| part * interval.setting.gyro));
}
