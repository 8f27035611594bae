//! The multi-state constraint Kalman filter on a flight: what it believes of where it is, and whether that is so.
//!
//! A whole flight takes longer than a picture of the screen may. So it is flown picture by picture, from the start
//! whenever a control other than the time has changed, and only as far as the time that is asked for: what is shown in
//! the end depends on the controls alone, each step on the way is short on a slow machine too, and to move the time back
//! costs nothing.

mod draw;
mod run;
mod setting;

pub use run::{Frame, Run};
pub use setting::{PICTURES, SECONDS, SIGMAS, Setting};

use vislam::filtering::BlockNees;
use vislam::msckf::{PictureReport, Refusals};

use crate::{Axis, Control, Face, Kind, Panel, Question, Reading, Scene, Steps, Widget};

/// A filter that follows a flight.
#[derive(Default)]
pub struct Filter {
    run: Option<Run>,
}

const ABOVE: usize = 0;
const ELLIPSE: usize = 1;
const POSITION: usize = 2;
const YAW: usize = 3;
const TRACKS: usize = 4;
const NEES: usize = 5;

const TIME: Axis = Axis { label: "time, s", range: [0.0, SECONDS] };

const fn map(title: &'static str, [x, y]: [Axis; 2]) -> Panel {
    Panel { title, x, y, aspect: 0.66, span: 3, equal: true, down: false }
}

const fn over_time(title: &'static str, label: &'static str, range: [f64; 2]) -> Panel {
    let y = Axis { label, range };
    Panel { title, x: TIME, y, aspect: 0.42, span: 3, equal: false, down: false }
}

const fn reading(label: &'static str, unit: &'static str, digits: usize) -> Reading {
    Reading { label, unit, digits, none: "no estimate", veiled: false }
}

impl Widget for Filter {
    const FACE: Face = Face {
        lead: "Answer the question, then press Play: the cross, where the body truly is, should nearly always be within the outer ellipse. Rings are the poses of the window, rays the last pixels, dashed ones wrong. Then switch the gate off; then on again, keep ten landmarks in the state and watch σ of the yaw.",
        controls: &[
            Control {
                kind: Kind::Sweep,
                ..Control::slider("time", "Time flown", "s", [12.0, 0.0, SECONDS, 0.1])
            },
            Control::slider(
                "window",
                "Poses in the window, longest track",
                "",
                [11.0, 5.0, 16.0, 1.0],
            ),
            Control::slider("features", "Features in a picture", "", [20.0, 5.0, 30.0, 1.0]),
            Control::slider("pixel", "Noise of a pixel", "px", [1.0, 0.3, 3.0, 0.1]),
            Control {
                kind: Kind::Logarithmic,
                ..Control::slider(
                    "imu",
                    "Noise of the IMU, over that of EuRoC",
                    "",
                    [1.0, 0.1, 10.0, 0.01],
                )
            },
            Control::slider("outliers", "Share of wrong pixels", "%", [1.0, 0.0, 5.0, 0.5]),
            Control::switch("gate", "Gate"),
            Control::choice(
                "landmarks",
                "Landmarks in the state",
                &["none", "ten, latest estimates", "ten, first estimates"],
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
            over_time("Position: error, reported σ (dashed)", "cm", [0.0, 1.0]),
            over_time("Yaw: error, ±σ (dashed), start (shaded)", "degrees", [-1.0, 1.0]),
            over_time("Tracks used (up), refused (down)", "tracks", [-1.0, 1.0]),
            over_time(
                "NEES, to stay in the band: position, yaw (dashed)",
                "power of ten",
                [-2.0, 4.0],
            ),
        ],
        readings: &[
            reading("Position error", "cm", 1),
            reading("Reported σ of the position, three axes", "cm", 1),
            reading("Yaw error", "°", 2),
            Reading { veiled: true, ..reading("Reported σ of the yaw", "°", 2) },
            Reading { veiled: true, ..reading("The same, over that at the start", "", 2) },
            reading("NEES of the position, mean until now", "", 2),
            Reading { veiled: true, ..reading("NEES of the yaw, mean until now", "", 2) },
            reading("Tracks used", "", 0),
            reading("Tracks refused by the gate", "", 0),
            reading("Tracks too short, or without a landmark", "", 0),
        ],
        question: Some(Question {
            ask: "Neither camera nor IMU can tell which way is north. Ten landmarks now stay in the state, with derivatives at the latest estimates. What becomes of the reported σ of the yaw?",
            choices: &[
                "it stays near what it was at the start",
                "it falls to about half, and the error with it",
                "it falls to about half, and the error does not",
            ],
            right: 2,
            why: "Derivatives at ever other estimates contradict each other, and the filter takes the contradiction for a view of north; first estimates do not. In a single flight the error may be small by luck: try other seeds.",
        }),
        words: &[],
    };

    const STEPS: Steps = Steps {
        decisions: &["used", "too short", "no landmark", "rank", "gated", "lost"],
        numbers: &["x", "y", "z", "yaw error", "σ of the position", "σ of the yaw", "NEES"],
        lost: Some("lost"),
    };

    fn advance(&mut self, controls: &[f64]) -> bool {
        let Some((setting, picture)) = Setting::of(controls) else { return false };
        if self.run.as_ref().is_none_or(|run| run.setting != setting) {
            self.run = Run::new(setting);
        }
        self.run.as_mut().is_some_and(|run| run.advance(picture))
    }

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let Some((run, frames, last)) = self.flown(controls) else {
            Self::FACE.readings.iter().for_each(|_| scene.read(None));
            return;
        };
        draw::above(run, frames, scene);
        draw::ellipses(frames, scene);
        draw::position(frames, scene);
        draw::yaw(frames, scene);
        draw::tracks(frames, scene);
        draw::nees(frames, scene);
        read(frames, last, scene);
    }

    fn steps(&self, controls: &[f64], into: &mut Vec<f64>) {
        for frame in self.flown(controls).into_iter().flat_map(|(_, frames, _)| frames) {
            let Refusals { short, landmark, unmet, rank, gated } = frame.report.refused;
            let used = frame.report.used;
            let lost = usize::from(frame.is_lost());
            into.extend(
                [used, short, landmark + unmet, rank, gated, lost].map(|count| count as f64),
            );
            let nees = frame.nees.map_or(f64::NAN, |nees| nees.position);
            into.extend(frame.estimate.position.iter());
            into.extend([frame.error.yaw(), frame.sigma, frame.yaw_sigma, nees]);
        }
    }
}

impl Filter {
    /// What has been flown of what the controls ask for, and where the filter stands now, if it could go on.
    fn flown(&self, controls: &[f64]) -> Option<(&Run, &[Frame], Option<&Frame>)> {
        let (setting, picture) = Setting::of(controls)?;
        let run = self.run.as_ref().filter(|run| run.setting == setting)?;
        let frames = &run.frames[..run.frames.len().min(picture + 1)];
        Some((run, frames, run.last(picture)))
    }
}

/// The numbers after the last picture.
fn read(frames: &[Frame], last: Option<&Frame>, scene: &mut Scene) {
    scene.read(last.map(|frame| 100.0 * frame.error.position.norm()));
    scene.read(last.map(|frame| 100.0 * frame.sigma));
    scene.read(last.map(|frame| frame.error.yaw().to_degrees()));
    scene.read(last.map(|frame| frame.yaw_sigma.to_degrees()));
    let first = frames.first();
    scene.read(last.zip(first).map(|(last, first)| last.yaw_sigma / first.yaw_sigma));
    let mean = |of: fn(&BlockNees) -> f64| {
        let nees: Option<Vec<f64>> =
            frames.iter().map(|frame| frame.nees.as_ref().map(of)).collect();
        nees.filter(|all| !all.is_empty()).map(|all| all.iter().sum::<f64>() / all.len() as f64)
    };
    scene.read(mean(|nees| nees.position));
    scene.read(mean(|nees| nees.yaw));
    let sum = |of: fn(&PictureReport) -> usize| {
        frames.iter().map(|frame| of(&frame.report)).sum::<usize>() as f64
    };
    scene.read(sum(|report| report.used));
    scene.read(sum(|report| report.refused.gated));
    scene.read(sum(|report| report.refused.without_landmark()));
}
