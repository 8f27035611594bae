//! Bundle adjustment step by step: where cameras and points are believed to be, which blocks the linear
//! system has, and how the cost falls.

mod draw;
mod run;
mod world;

pub use run::{Run, State};
pub use world::{Setting, World};

use crate::{Axis, Control, Face, Panel, Question, Reading, Scene, Shape, Style, Widget};

/// Most steps that a reader can ask for.
pub const MOST_STEPS: usize = 40;

/// The solve that a reader is stepping through.
#[derive(Default)]
pub struct BundleAdjustment {
    run: Option<Run>,
}

const ABOVE: usize = 0;
const PROGRESS: usize = 1;
const WHOLE: usize = 2;
const REDUCED: usize = 3;

const fn panel(title: &'static str, [x, y]: [Axis; 2], equal: bool) -> Panel {
    Panel { title, x, y, aspect: 0.92, span: 3, equal, down: false }
}

const fn pattern(title: &'static str) -> Panel {
    let axis = Axis { label: "", range: [-0.5, 9.5] };
    Panel { aspect: 1.0, down: true, ..panel(title, [axis, axis], true) }
}

const fn reading(label: &'static str, unit: &'static str, digits: usize) -> Reading {
    Reading { label, unit, digits, none: "cannot be said", veiled: false }
}

impl Widget for BundleAdjustment {
    const FACE: Face = Face {
        lead: "Press Step until the solver has converged, and compare the two curves. \
               Then hold nothing: the same steps are taken again, and camera 0 has gone. The ring has another S.",
        controls: &[
            Control::count("step", "Step", MOST_STEPS as f64),
            Control::choice("world", "World", &["street", "ring", "ring of stereo pairs"]),
            Control::choice("held", "Gauge", &["camera 0 held", "nothing held"]),
            Control::choice("kernel", "Kernel", &["squared", "Huber", "Cauchy"]),
            Control::slider("outliers", "Share of outliers", "%", [0.0, 0.0, 20.0, 1.0]),
            Control::slider("start", "Start off, times 5 cm and 1°", "", [6.0, 0.0, 8.0, 0.5]),
            Control::slider("seed", "Seed", "", [1.0, 1.0, 20.0, 1.0]),
        ],
        handles: &[],
        panels: &[
            panel(
                "Cameras and points from above",
                [
                    Axis { label: "x, m", range: [-1.2, 10.2] },
                    Axis { label: "y, m", range: [-2.2, 9.2] },
                ],
                true,
            ),
            panel(
                "Cost and gradient",
                [
                    Axis { label: "steps tried", range: [0.0, 12.0] },
                    Axis { label: "power of ten", range: [-4.0, 6.0] },
                ],
                false,
            ),
            pattern("H: cameras, then points"),
            pattern("S: points eliminated"),
        ],
        readings: &[
            Reading { veiled: true, ..reading("Cost", "", 3) },
            reading("Length of the scaled gradient", "", 6),
            Reading { veiled: true, ..reading("Camera 0 has moved by", "mm", 1) },
            reading("Size, over the true one", "", 4),
            reading("RMS error of the cameras, gauge taken out", "cm", 2),
            reading("RMSE of the right matches", "px", 2),
            reading("RMSE of all matches", "px", 2),
        ],
        question: Some(Question {
            ask: "Camera 0 is no longer held: six more unknowns, the same pixels. What becomes of the cost at the minimum?",
            choices: &[
                "it is smaller",
                "it is the same, but camera 0 has drifted",
                "there is no minimum, for the system is singular",
            ],
            right: 1,
            why: "The pixels do not say where the world is: the damped solver moves along with it at no cost.",
        }),
        words: &["cost", "gradient", "cost at the truth", "held", "converged", "not converged"],
    };

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let Some((setting, steps)) = Setting::of(controls) else { return };
        if self.run.as_ref().is_none_or(|run| run.setting != setting) {
            self.run = Run::new(setting);
        }
        let Some(run) = &mut self.run else {
            Self::FACE.readings.iter().for_each(|_| scene.read(None));
            return;
        };
        run.advance(steps);
        let last = steps.min(run.states.len() - 1);
        draw::above(run, last, scene);
        draw::progress(run, last, scene);
        draw::patterns(run, scene);
        let state = &run.states[last];
        scene.read(state.cost);
        scene.read(state.gradient_norm);
        scene.read(1000.0 * run.drift(state));
        scene.read(run.size(state));
        scene.read(100.0 * run.camera_error(state));
        scene.read(run.rmse(state, false));
        scene.read(run.rmse(state, true));
        if run.ended.is_some() && last + 1 == run.states.len() && steps > 0 {
            scene.say(&format!("After {last} steps the solver has nothing more to do."));
        }
    }
}
