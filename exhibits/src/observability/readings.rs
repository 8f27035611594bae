//! What the inertial sensor says to a similarity.

use nalgebra::{Rotation3, Vector1, Vector3};
use vislam::inertial::{GRAVITY, NavState};
use vislam::manifold::so3;
use vislam::observability::{BiasAssumption, Similarity, Window};
use vislam::preintegration::{Preintegrated, imu_residual};
use vislam::simulation::{EulerAngles, Flight, ScalarTrajectory, Trajectory};

use super::near::coasting;
use super::oracle::{force_on, path_of, similar_path};
use super::worked::{TURN, row_of, swaying, window};
use super::{STATES, draws};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, as_far_as, differences};
use crate::random::Random;

const WINDOWS: usize = 40;

/// What a reading is made of at one time, in m/s².
#[derive(Clone, Copy)]
pub struct Reading {
    pub rotation: Rotation3<f64>,
    /// Of the camera's centre, in the world.
    pub camera: Vector3<f64>,
    /// Of the body, in the world.
    pub body: Vector3<f64>,
    pub gravity: Vector3<f64>,
}

impl Reading {
    fn force(&self) -> Vector3<f64> {
        self.rotation.inverse() * (self.body - self.gravity)
    }

    /// What is read when the force changes by so much in the world.
    fn with(&self, change: Vector3<f64>) -> Vector3<f64> {
        self.force() + self.rotation.inverse() * change
    }

    /// The change of a bias that hides such a change of the force.
    fn hiding(&self, change: Vector3<f64>) -> Vector3<f64> {
        -(self.rotation.inverse() * change)
    }

    /// By how much gravity is off, seen from before the similarity.
    fn lean(&self, similarity: &Similarity) -> Vector3<f64> {
        self.gravity - similarity.rotation.inverse() * self.gravity
    }
}

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Moved = |of, s| of.with((s.scale - 1.0) * of.camera + of.lean(s));
    let mutants: [(_, Moved); 5] = [
        ("acceleration of the body", |of, s| of.with((s.scale - 1.0) * of.body + of.lean(s))),
        ("gravity grows too", |of, s| {
            of.with((s.scale - 1.0) * (of.camera - of.gravity) + of.lean(s))
        }),
        ("rotation of gravity transposed", |of, s| {
            of.with((s.scale - 1.0) * of.camera + of.gravity - s.rotation * of.gravity)
        }),
        ("in the world", |of, s| of.force() + (s.scale - 1.0) * of.camera + of.lean(s)),
        ("lean dropped", |of, s| of.with((s.scale - 1.0) * of.camera)),
    ];
    chapter.equation("moved-reading", moved_reading, formula, &mutants);

    let mutants: [(_, Hidden); 4] = [
        ("sign", |reading, s| -hidden(reading, s)),
        ("in the world", |reading, s| reading.rotation * hidden(reading, s)),
        ("rotation of gravity transposed", |reading, s| {
            hidden(reading, &Similarity { rotation: s.rotation.inverse(), ..*s })
        }),
        ("s for s − 1", |reading, s| hidden(reading, &Similarity { scale: s.scale + 1.0, ..*s })),
    ];
    chapter.equation("hidden-by-bias", hidden_by_bias, hidden, &mutants);

    let formula: Condition =
        |of, growth, turn| of.hiding(growth * of.camera + turn.cross(&of.gravity));
    let mutants: [(_, Condition); 4] = [
        ("sign of the lean", |of, growth, turn| {
            of.hiding(growth * of.camera - turn.cross(&of.gravity))
        }),
        ("sign", |of, growth, turn| -of.hiding(growth * of.camera + turn.cross(&of.gravity))),
        ("gravity grows too", |of, growth, turn| {
            of.hiding(growth * (of.camera - of.gravity) + turn.cross(&of.gravity))
        }),
        ("in the world", |of, growth, turn| -(growth * of.camera + turn.cross(&of.gravity))),
    ];
    chapter.equation("null-condition", null_condition, formula, &mutants);

    let formula: Objection =
        |first, second, _, t, s| objection(first, s - 1.0, beyond(first, second, t));
    let mutants: [(_, Objection); 5] = [
        ("gravity grows too", |first, second, gravity, t, s| {
            let (v, p) = beyond(first, second, t);
            objection(first, s - 1.0, (v - t * gravity, p - 0.5 * t * t * gravity))
        }),
        ("velocity, not its change", |first, second, _, t, s| {
            objection(first, s - 1.0, (second.velocity, beyond(first, second, t).1))
        }),
        ("in the world", |first, second, _, t, s| {
            let unturned = NavState { world_from_body: Rotation3::identity(), ..*first };
            objection(&unturned, s - 1.0, beyond(first, second, t))
        }),
        ("s for s − 1", |first, second, _, t, s| objection(first, s, beyond(first, second, t))),
        ("coasting forgotten", |first, second, _, _, s| {
            objection(first, s - 1.0, beyond(first, second, 0.0))
        }),
    ];
    chapter.equation("scale-objection", scale_objection, formula, &mutants);

    let mutants: [(_, False); 4] = [
        ("sign", |a, g| 1.0 + 2.0 * g.dot(a) / a.norm_squared()),
        ("factor of two dropped", |a, g| 1.0 - g.dot(a) / a.norm_squared()),
        ("by the square of gravity", |a, g| 1.0 - 2.0 * g.dot(a) / g.norm_squared()),
        ("not squared", |a, g| 1.0 - 2.0 * g.dot(a) / a.norm()),
    ];
    chapter.equation("false-scale", false_scale, other_scale, &mutants);
    conditions(chapter);
}

type Moved = fn(&Reading, &Similarity) -> Vector3<f64>;

fn moved_reading(formula: Moved) -> Comparison {
    let against = "second differences of the path of a body hung on a camera that moves similarly";
    Comparison::absolute(against, 1e-4, "m/s²").over(STATES, 11, |random| {
        let (motion, rig) = (draws::motion(random), draws::rig(random));
        let (similarity, gravity) = (draws::similarity(random), draws::gravity(random));
        let t = random.uniform(0.0..3.0);
        let path = path_of(&motion);
        let oracle = force_on(&|t| similar_path(&path, &rig, &similarity, t), &gravity, t);
        let reading = at(&motion, &rig.body_from_camera.translation.vector, &gravity, t);
        (formula(&reading, &similarity), oracle)
    })
}

/// What a motion's reading is made of.
fn at(motion: &Trajectory, lever: &Vector3<f64>, gravity: &Vector3<f64>, t: f64) -> Reading {
    let path = path_of(motion);
    let centre = |t| {
        let (rotation, position) = path(t);
        (rotation, position + rotation * lever)
    };
    // A free fall of nothing: what the centre of the camera does, in the world.
    let rotation = path(t).0;
    let camera = rotation * force_on(&centre, &Vector3::zeros(), t);
    Reading { rotation, camera, body: motion.at(t).acceleration, gravity: *gravity }
}

/// The change of the accelerometer's bias that hides a similarity.
fn hidden(reading: &Reading, s: &Similarity) -> Vector3<f64> {
    reading.hiding((s.scale - 1.0) * reading.camera + reading.lean(s))
}

type Hidden = fn(&Reading, &Similarity) -> Vector3<f64>;

fn hidden_by_bias(formula: Hidden) -> Comparison {
    let against = "zero, for the inertial residuals of degenerate motions after the similarity";
    let mut random = Random::new(12);
    Comparison::absolute(against, 1e-9, "rad, m/s and m").each(0..WINDOWS, |state| {
        let (motion, similarity) = degenerate(&mut random, state % 3);
        let window = draws::short_window(motion, Vector3::zeros());
        let kinematics = motion.at(0.0);
        let reading = Reading {
            rotation: kinematics.state.world_from_body,
            camera: kinematics.acceleration,
            body: kinematics.acceleration,
            gravity: GRAVITY,
        };
        let mut copy = window.transformed(&similarity);
        copy.biases[0].accelerometer += formula(&reading, &similarity);
        let residuals = inertial_residuals(&copy);
        let zeros = vec![0.0; residuals.len()];
        (residuals, zeros)
    })
}

/// A motion, and a similarity that a bias can hide on it.
fn degenerate(random: &mut Random, kind: usize) -> (Trajectory, Similarity) {
    let any = draws::similarity(random);
    let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), random.uniform(0.2..1.0));
    let acceleration = random.direction(1.5);
    // A body that does not turn stands in any way.
    let standing = || EulerAngles {
        yaw: ScalarTrajectory::constant(0.4),
        roll: ScalarTrajectory::constant(-0.7),
        ..EulerAngles::default()
    };
    match kind {
        0 => {
            let rate = random.uniform(0.3..1.0);
            let motion = Trajectory::constant_body_acceleration(&acceleration, rate);
            (motion, Similarity { rotation: yaw, ..any })
        }
        1 => (Trajectory::constant_acceleration(&acceleration, standing()), any),
        _ => (swaying(standing()), Similarity { scale: 1.0, ..any }),
    }
}

/// All inertial residuals of a window, not whitened.
pub fn inertial_residuals(window: &Window) -> Vec<f64> {
    let pairs = window.states.windows(2).zip(&window.intervals);
    let residual = |(pair, interval): (&[NavState], &Preintegrated)| {
        let bias = &window.biases[0];
        let residual = imu_residual(interval, &pair[0], &pair[1], &window.gravity, bias);
        residual.as_slice().to_vec()
    };
    pairs.flat_map(residual).collect()
}

type Condition = fn(&Reading, f64, &Vector3<f64>) -> Vector3<f64>;

fn null_condition(formula: Condition) -> Comparison {
    let against = "central differences of the reading of a body whose camera moves similarly";
    Comparison::absolute(against, 1e-4, "m/s²").over(STATES, 13, |random| {
        let (motion, rig) = (draws::motion(random), draws::rig(random));
        let gravity = draws::gravity(random);
        let (growth, turn) = (random.uniform(-1.0..1.0), random.direction(1.0));
        let t = random.uniform(0.0..3.0);
        let path = path_of(&motion);
        let oracle = -differences(1e-3, |step: Vector1<f64>| {
            let rotation = so3::exp(&(step.x * turn));
            let scale = 1.0 + step.x * growth;
            let similarity = Similarity { scale, rotation, translation: Vector3::zeros() };
            force_on(&|t| similar_path(&path, &rig, &similarity, t), &gravity, t)
        });
        let reading = at(&motion, &rig.body_from_camera.translation.vector, &gravity, t);
        (formula(&reading, growth, &turn), oracle)
    })
}

fn conditions(chapter: &mut Chapter) {
    let (known, unknown) = (BiasAssumption::KNOWN, BiasAssumption::CONSTANT);
    let (turn, eight) = (Trajectory::level_turn(TURN.0, TURN.1), Trajectory::figure_eight());
    let steady = [(turn, unknown), (eight, unknown)];
    chapter.counterexample("vi-similar", "steady", larger_copy, steady);
    let zero = [(coasting(), known), (turn, known)];
    chapter.counterexample("vi-similar", "zero", larger_copy, zero);
    chapter.counterexample("vi-similar", "constant-bias", steady_change, [turn, eight]);
    chapter.counterexample("vi-similar", "pictures", only_scale_is_free, ["coast", "hover"]);
}

/// What all measurements of a window say to a copy of it that is a fifth larger, with the bias that hides it best.
fn larger_copy((motion, assumption): (Trajectory, BiasAssumption)) -> Comparison {
    let larger = Similarity { scale: 1.2, ..Similarity::identity() };
    let residual = window(motion, assumption).transformed(&larger).residual();
    let norm = residual.expect("a similar window is in front of its cameras").norm();
    Comparison::absolute("zero", 1e-6, "standard deviations").once(norm, 0.0)
}

/// The change of a bias that gives a larger copy the readings of the original at all times, and the change at the
/// beginning.
fn steady_change(motion: Trajectory) -> Comparison {
    let path = path_of(&motion);
    let larger = Similarity { scale: 1.2, ..Similarity::identity() };
    let rig = Flight::brief(motion).rig;
    let copy = |t| similar_path(&path, &rig, &larger, t);
    let change = |t| force_on(&path, &GRAVITY, t) - force_on(&copy, &GRAVITY, t);
    Comparison::absolute("the change at the beginning", 1e-4, "m/s²")
        .each(0..20, |step| (change(0.1 * f64::from(step)), change(0.0)))
}

/// How many directions are free when the camera's velocity is constant and the biases are known: position, yaw and
/// scale, if there are no other copies than similar ones.
fn only_scale_is_free(word: &'static str) -> Comparison {
    let free = row_of(word)[2].count() as f64;
    Comparison::absolute("position, yaw and scale", 0.1, "directions").once(free, 5.0)
}

/// The change of velocity over an interval of so many seconds, and the way beyond coasting.
pub fn beyond(first: &NavState, second: &NavState, t: f64) -> (Vector3<f64>, Vector3<f64>) {
    let gained = second.velocity - first.velocity;
    (gained, second.position - first.position - t * first.velocity)
}

/// By how much velocity and position residual of an interval change.
fn objection(
    first: &NavState,
    growth: f64,
    (gained, beyond): (Vector3<f64>, Vector3<f64>),
) -> [Vector3<f64>; 2] {
    [gained, beyond].map(|change| growth * (first.world_from_body.inverse() * change))
}

/// Takes the states at both ends, gravity, the seconds between and the factor of growth.
type Objection = fn(&NavState, &NavState, &Vector3<f64>, f64, f64) -> [Vector3<f64>; 2];

fn scale_objection(formula: Objection) -> Comparison {
    let against = "the residual of the grown states less that of the states";
    Comparison::absolute(against, 1e-11, "m/s and m").over(WINDOWS, 14, |random| {
        let window = draws::short_window(draws::motion(random), Vector3::zeros());
        let scale = random.logarithmic(0.6..1.6);
        let states = [draws::state(random), draws::state(random)];
        let gravity = draws::gravity(random);
        let (interval, bias) = (&window.intervals[0], &window.biases[0]);
        let residual = |[first, second]: &[NavState; 2]| {
            imu_residual(interval, first, second, &gravity, bias).fixed_rows::<6>(3).into_owned()
        };
        let grown = states.map(|state| NavState {
            velocity: scale * state.velocity,
            position: scale * state.position,
            ..state
        });
        let given = formula(&states[0], &states[1], &gravity, interval.duration, scale);
        (given, residual(&grown) - residual(&states))
    })
}

/// The other scale at which a constant acceleration and gravity give the same force.
pub fn other_scale(acceleration: &Vector3<f64>, gravity: &Vector3<f64>) -> f64 {
    1.0 - 2.0 * gravity.dot(acceleration) / acceleration.norm_squared()
}

type False = fn(&Vector3<f64>, &Vector3<f64>) -> f64;

fn false_scale(formula: False) -> Comparison {
    let against = "bisection for the scale at which gravity has its strength again";
    Comparison::relative(against, 1e-9).over(STATES, 15, |random| {
        let acceleration = draws::climbing(random);
        let excess = |scale: f64| (GRAVITY + (scale - 1.0) * acceleration).norm() - GRAVITY.norm();
        // Strength is least somewhere between the two scales at which it is right.
        let (mut low, mut high) = (-400.0, 400.0);
        for _ in 0..200 {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if excess(left) < excess(right) { high = right } else { low = left }
        }
        let least = 0.5 * (low + high);
        let outside = least + 4.0 * (least - 1.0);
        let again = as_far_as(least, outside, |scale| excess(scale) < 0.0);
        (formula(&acceleration, &GRAVITY), again)
    })
}
