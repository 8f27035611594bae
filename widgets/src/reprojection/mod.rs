//! What an optimizer does whose Jacobian was derived for one perturbation of its cameras and which moves them by another.

mod conventions;
mod draw;
mod run;

pub use conventions::{street, to_side};
use run::Run;

use nalgebra::Matrix3;
use vislam::least_squares::{Kernel, Problem, Values};

use crate::pixels;
use crate::{Axis, Control, Face, Panel, Question, Reading, Scene, Widget};

/// Most steps that are taken.
pub const STEPS: usize = 16;
/// The camera whose picture is shown.
const WATCHED: usize = 1;
/// The quotient of errors below this is not one of all digits any more.
const SETTLED: f64 = 1e-6;
/// Errors below this are rounding.
const ROUNDING: f64 = 1e-15;
/// Steps from the truth to the minimum of the cost.
const TO_OPTIMUM: usize = 12;
/// The side on which steps are taken.
const RIGHT: f64 = 0.0;

/// All controls but those of the shown step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// For which perturbation the mixed Jacobian is derived: zero for the right, one for the left.
    pub side: f64,
    /// By how much the cameras are turned from the world, in radians.
    pub angle: f64,
    /// Standard deviation of a coordinate of a pixel.
    pub noise: f64,
    /// How far off the start is, over how far the scene puts it.
    pub start: f64,
}

/// Both optimizers on one problem.
pub struct Comparison {
    setting: Setting,
    scene: vislam::simulation::Scene,
    problem: Problem,
    optimum: Values,
    consistent: Run,
    mixed: Run,
}

impl Comparison {
    fn new(setting: Setting) -> Option<Self> {
        let scene = street(setting.angle, setting.noise, setting.start);
        let problem = pixels::problem(&scene.problem, Kernel::Squared).ok()?;
        let mut truth = scene.clone();
        truth.problem.cameras.clone_from(&truth.true_cameras);
        truth.problem.points.clone_from(&truth.true_points);
        let truth = pixels::problem(&truth.problem, Kernel::Squared).ok()?;
        let mut optimum = Run::new(&problem, truth.values(), TO_OPTIMUM, RIGHT);
        let consistent = Run::new(&problem, problem.values(), STEPS, RIGHT);
        let optimum = optimum.states.pop()?;
        let comparison =
            Self { setting, scene, problem, optimum, consistent, mixed: Run::default() };
        Some(comparison.with_side(setting.side))
    }

    /// Only the mixed optimizer has another Jacobian.
    fn with_side(mut self, side: f64) -> Self {
        self.mixed = Run::new(&self.problem, self.problem.values(), STEPS, side);
        self.setting.side = side;
        self
    }

    /// What the optimizer of this run has after so many steps: the root of the mean squared residual in pixels, and how
    /// far off the cameras are.
    fn state(&self, run: &Run, at: usize) -> [Option<f64>; 2] {
        let factors = self.scene.problem.factors.len() as f64;
        let cost = run.states.get(at).map(|state| self.problem.cost(state));
        let sigma = if self.setting.noise > 0.0 { self.setting.noise } else { 1.0 };
        let rmse = cost.map(|cost| sigma * (2.0 * cost / factors).sqrt());
        [rmse, run.errors(&self.optimum).nth(at)].map(|number| number.filter(|n| n.is_finite()))
    }

    /// The modulus of what a mixed step leaves of an error to first order: the identity minus the turn between
    /// the two sides has it twice as a singular value, and zero.
    fn predicted(&self) -> f64 {
        let turn = self.scene.true_cameras[WATCHED].camera_from_world.rotation;
        let between = turn.powf(self.setting.side).to_rotation_matrix();
        (Matrix3::identity() - between.matrix()).norm() / 2.0_f64.sqrt()
    }
}

/// Two optimizers that a reader steps through.
#[derive(Default)]
pub struct Reprojection {
    comparison: Option<Comparison>,
}

const ERRORS: usize = 0;
const ARROWS: usize = 1;
const RESIDUALS: [usize; 2] = [2, 3];

const fn picture(title: &'static str) -> Panel {
    let x = Axis { label: "", range: [180.0, 540.0] };
    let y = Axis { label: "", range: [88.0, 358.0] };
    Panel { title, x, y, aspect: 0.75, span: 3, equal: true, down: true }
}

const fn reading(label: &'static str, unit: &'static str, digits: usize) -> Reading {
    Reading { label, unit, digits, none: "lost", veiled: false }
}

impl Widget for Reprojection {
    const FACE: Face = Face {
        lead: "Both optimizers move their cameras by steps on the right. The mixed one has the Jacobian for a step on the left, so that \
               what it says of a trial step (hollow) misses what happens (filled). Slide it to the right, and both optimizers are one. Then turn the world, and watch the slope of each curve.",
        controls: &[
            Control::slider(
                "side",
                "Jacobian for a step on the: 0 left, 1 right",
                "",
                [0.0, 0.0, 1.0, 0.02],
            ),
            Control::slider(
                "angle",
                "Cameras turned from the world by",
                "°",
                [40.0, 0.0, 120.0, 1.0],
            ),
            Control { start: 3.0, ..Control::count("step", "Step", STEPS as f64) },
            Control {
                start: 1.0,
                ..Control::choice(
                    "axis",
                    "Trial step of one camera",
                    &[
                        "40 cm along x, the axis of the turn",
                        "40 cm along y",
                        "40 cm along z",
                        "6° about x",
                        "6° about y",
                        "6° about z",
                    ],
                )
            },
            Control::slider("noise", "Noise of a pixel", "px", [0.0, 0.0, 3.0, 0.1]),
            Control::slider("start", "Start off, times 5 cm and 1°", "", [2.0, 0.0, 6.0, 0.5]),
        ],
        handles: &[],
        panels: &[
            Panel {
                x: Axis { label: "Gauss-Newton steps", range: [-0.5, STEPS as f64 + 0.5] },
                y: Axis { label: "way to the minimum, power of ten", range: [-15.5, 2.5] },
                equal: false,
                down: false,
                ..picture("Both optimizers")
            },
            picture("Trial step: filled what it does, hollow what the Jacobian says"),
            picture("Residuals of the consistent optimizer"),
            picture("Residuals of the mixed optimizer"),
        ],
        readings: &[
            reading("Trial step: the Jacobian errs by", "px", 2),
            reading("RMSE, consistent", "px", 3),
            reading("RMSE, mixed", "px", 3),
            reading("Way to the minimum, consistent", "mm, mrad", 4),
            reading("Way to the minimum, mixed", "mm, mrad", 4),
            Reading {
                veiled: true,
                none: "no step, or rounding",
                ..reading("Way after the last mixed step, over that before", "", 3)
            },
            Reading { veiled: true, ..reading("The theorem predicts, near the minimum", "", 3) },
        ],
        question: Some(Question {
            ask: "The Jacobian is the left one, the steps are taken on the right, and the cameras are turned from the world by 80°. Where does the mixed optimizer go?",
            choices: &[
                "to the minimum, later",
                "to a wrong map that fits the pixels worse",
                "away from the minimum, however close it begins",
            ],
            right: 2,
            why: "By the theorem a step leaves more than the whole error: set the angle to 80°, and read how much.",
        }),
        words: &["consistent", "mixed", "lost"],
    };

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let &[side, angle, step, axis, noise, start] = controls else { return };
        let side = 1.0 - side;
        let setting = Setting { side, angle: angle.to_radians(), noise, start };
        self.comparison = match self.comparison.take() {
            Some(known) if known.setting == setting => Some(known),
            Some(known) if (Setting { side, ..known.setting }) == setting => {
                Some(known.with_side(side))
            }
            _ => Comparison::new(setting),
        };
        let Some(comparison) = &self.comparison else {
            Self::FACE.readings.iter().for_each(|_| scene.read(None));
            return;
        };
        let (at, axis) = (step as usize, axis as usize);
        let predicted = comparison.predicted();
        let differ = draw::arrows(comparison, axis, scene);
        scene.read(differ);
        draw::errors(comparison, at, predicted, scene);
        draw::residuals(comparison, at, scene);
        let [consistent, mixed] =
            [&comparison.consistent, &comparison.mixed].map(|run| comparison.state(run, at));
        let small = |error: Option<f64>| error.map(|error| 1e3 * error);
        let shown = [consistent[0], mixed[0], small(consistent[1]), small(mixed[1])];
        shown.into_iter().for_each(|number| scene.read(number));
        let before = at.checked_sub(1).and_then(|at| comparison.state(&comparison.mixed, at)[1]);
        let left = mixed[1].zip(before).map(|(error, before)| error / before);
        scene.read(left.filter(|left| left.is_finite() && mixed[1] > Some(SETTLED)));
        scene.read(predicted);
        let last = comparison.mixed.states.len() - 1;
        if last < STEPS {
            scene.say(&format!("After step {last} the mixed optimizer is lost."));
        }
    }
}
