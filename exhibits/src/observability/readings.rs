//! What the inertial sensor says to a similarity.

use nalgebra::{Rotation3, SMatrix, Vector3};
use vislam::inertial::{GRAVITY, NavState};
use vislam::manifold::so3;
use vislam::observability::{BiasAssumption, Similarity, Window};
use vislam::preintegration::{Preintegrated, imu_residual};
use vislam::simulation::{EulerAngles, Flight, Trajectory};

use super::near::coasting;
use super::oracle::{force_on, path_of, similar_path};
use super::worked::{TURN, free, of_flight, swaying, window};
use super::{STATES, draws};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
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

    /// By how much gravity is off, seen from before the similarity.
    fn lean(&self, similarity: &Similarity) -> Vector3<f64> {
        self.gravity - similarity.rotation.inverse() * self.gravity
    }
}

/// Registers the equations.
pub fn exhibits(chapter: &mut Chapter) {
    let formula: Moved = |reading, s| {
        let change = (s.scale - 1.0) * reading.camera + reading.lean(s);
        reading.force() + reading.rotation.inverse() * change
    };
    let mutants: [(_, Moved); 5] = [
        ("acceleration of the body", |reading, s| {
            let change = (s.scale - 1.0) * reading.body + reading.lean(s);
            reading.force() + reading.rotation.inverse() * change
        }),
        ("gravity grows too", |reading, s| {
            let acceleration = reading.camera - reading.gravity;
            let change = (s.scale - 1.0) * acceleration + reading.lean(s);
            reading.force() + reading.rotation.inverse() * change
        }),
        ("rotation of gravity transposed", |reading, s| {
            let lean = reading.gravity - s.rotation * reading.gravity;
            let change = (s.scale - 1.0) * reading.camera + lean;
            reading.force() + reading.rotation.inverse() * change
        }),
        ("in the world", |reading, s| {
            reading.force() + (s.scale - 1.0) * reading.camera + reading.lean(s)
        }),
        ("lean dropped", |reading, s| {
            let change = (s.scale - 1.0) * reading.camera;
            reading.force() + reading.rotation.inverse() * change
        }),
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

    let formula: Condition = |reading, growth, turn| {
        let change = growth * reading.camera + turn.cross(&reading.gravity);
        -(reading.rotation.inverse() * change)
    };
    let mutants: [(_, Condition); 4] = [
        ("sign of the lean", |reading, growth, turn| {
            let change = growth * reading.camera - turn.cross(&reading.gravity);
            -(reading.rotation.inverse() * change)
        }),
        ("sign", |reading, growth, turn| {
            let change = growth * reading.camera + turn.cross(&reading.gravity);
            reading.rotation.inverse() * change
        }),
        ("gravity grows too", |reading, growth, turn| {
            let acceleration = reading.camera - reading.gravity;
            let change = growth * acceleration + turn.cross(&reading.gravity);
            -(reading.rotation.inverse() * change)
        }),
        ("in the world", |reading, growth, turn| {
            -(growth * reading.camera + turn.cross(&reading.gravity))
        }),
    ];
    chapter.equation("null-condition", null_condition, formula, &mutants);

    let formula: Objection = |first, second, _, t, s| {
        let gained = second.velocity - first.velocity;
        let beyond = second.position - first.position - t * first.velocity;
        objection(first, s - 1.0, &gained, &beyond)
    };
    let mutants: [(_, Objection); 5] = [
        ("gravity grows too", |first, second, gravity, t, s| {
            let gained = second.velocity - first.velocity - t * gravity;
            let beyond = second.position - first.position - t * first.velocity;
            objection(first, s - 1.0, &gained, &(beyond - 0.5 * t * t * gravity))
        }),
        ("velocity, not its change", |first, second, _, t, s| {
            let beyond = second.position - first.position - t * first.velocity;
            objection(first, s - 1.0, &second.velocity, &beyond)
        }),
        ("in the world", |first, second, _, t, s| {
            let gained = second.velocity - first.velocity;
            let beyond = second.position - first.position - t * first.velocity;
            let unturned = NavState { world_from_body: Rotation3::identity(), ..*first };
            objection(&unturned, s - 1.0, &gained, &beyond)
        }),
        ("s for s − 1", |first, second, _, t, s| {
            let gained = second.velocity - first.velocity;
            let beyond = second.position - first.position - t * first.velocity;
            objection(first, s, &gained, &beyond)
        }),
        ("coasting forgotten", |first, second, _, _, s| {
            let gained = second.velocity - first.velocity;
            objection(first, s - 1.0, &gained, &(second.position - first.position))
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
    let mut comparison = Comparison::absolute(against, 1e-4, "m/s²");
    let mut random = Random::new(11);
    for _ in 0..STATES {
        let (motion, rig) = (draws::motion(&mut random), draws::rig(&mut random));
        let (similarity, gravity) = (draws::similarity(&mut random), draws::gravity(&mut random));
        let t = random.uniform(0.0..3.0);
        let path = path_of(&motion);
        let similar = |t| similar_path(&path, &rig, &similarity, t);
        let oracle = force_on(&similar, &gravity, t);
        let reading = at(&motion, &rig.body_from_camera.translation.vector, &gravity, t);
        comparison.add(formula(&reading, &similarity).as_slice(), oracle.as_slice());
    }
    comparison
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
pub fn hidden(reading: &Reading, s: &Similarity) -> Vector3<f64> {
    let change = (s.scale - 1.0) * reading.camera + reading.lean(s);
    -(reading.rotation.inverse() * change)
}

type Hidden = fn(&Reading, &Similarity) -> Vector3<f64>;

fn hidden_by_bias(formula: Hidden) -> Comparison {
    let against = "zero, for the inertial residuals of degenerate motions after the similarity";
    let mut comparison = Comparison::absolute(against, 1e-9, "rad, m/s and m");
    let mut random = Random::new(12);
    for state in 0..WINDOWS {
        let (motion, similarity) = degenerate(&mut random, state % 3);
        let flight = Flight { seconds: 0.75, ..Flight::brief(motion) };
        let window = of_flight(&flight, BiasAssumption::KNOWN);
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
        comparison.add(&residuals, &vec![0.0; residuals.len()]);
    }
    comparison
}

/// A motion, and a similarity that a bias can hide on it.
fn degenerate(random: &mut Random, kind: usize) -> (Trajectory, Similarity) {
    let any = draws::similarity(random);
    let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), random.uniform(0.2..1.0));
    let acceleration = random.direction(1.5);
    // A body that does not turn stands in any way.
    let standing = || EulerAngles {
        yaw: vislam::simulation::ScalarTrajectory::constant(0.4),
        roll: vislam::simulation::ScalarTrajectory::constant(-0.7),
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
    let mut comparison = Comparison::absolute(against, 1e-4, "m/s²");
    let mut random = Random::new(13);
    for _ in 0..STATES {
        let (motion, rig) = (draws::motion(&mut random), draws::rig(&mut random));
        let gravity = draws::gravity(&mut random);
        let (growth, turn) = (random.uniform(-1.0..1.0), random.direction(1.0));
        let t = random.uniform(0.0..3.0);
        let path = path_of(&motion);
        let step = 1e-3;
        let read = |step: f64| {
            let rotation = so3::exp(&(step * turn));
            let scale = 1.0 + step * growth;
            let similarity = Similarity { scale, rotation, translation: Vector3::zeros() };
            force_on(&|t| similar_path(&path, &rig, &similarity, t), &gravity, t)
        };
        let oracle = -(read(step) - read(-step)) / (2.0 * step);
        let reading = at(&motion, &rig.body_from_camera.translation.vector, &gravity, t);
        comparison.add(formula(&reading, growth, &turn).as_slice(), oracle.as_slice());
    }
    comparison
}

fn conditions(chapter: &mut Chapter) {
    let (known, unknown) = (BiasAssumption::KNOWN, BiasAssumption::CONSTANT);
    let (turn, eight) = (Trajectory::level_turn(TURN.0, TURN.1), Trajectory::figure_eight());
    let steady = [(turn, unknown), (eight, unknown)];
    chapter.counterexample("vi-similar", "steady", larger_copy, steady);
    let zero = [(coasting(), known), (turn, known)];
    chapter.counterexample("vi-similar", "zero", larger_copy, zero);
    chapter.counterexample("vi-similar", "constant-bias", steady_change, [turn, eight]);
    let motions = [coasting(), Trajectory::hover()];
    chapter.counterexample("vi-similar", "pictures", only_scale_is_free, motions);
}

/// What all measurements of a window say to a copy of it that is a fifth larger, with the bias that hides it best.
fn larger_copy((motion, assumption): (Trajectory, BiasAssumption)) -> Comparison {
    let mut comparison = Comparison::absolute("zero", 1e-6, "standard deviations");
    let larger = Similarity { scale: 1.2, ..Similarity::identity() };
    if let Ok(residual) = window(motion, assumption).transformed(&larger).residual() {
        comparison.add(&[residual.norm()], &[0.0]);
    }
    comparison
}

/// The change of a bias that gives a larger copy the readings of the original at all times, and the change at the
/// beginning.
fn steady_change(motion: Trajectory) -> Comparison {
    let mut comparison = Comparison::absolute("the change at the beginning", 1e-4, "m/s²");
    let path = path_of(&motion);
    let larger = Similarity { scale: 1.2, ..Similarity::identity() };
    let rig = Flight::brief(motion).rig;
    let copy = |t| similar_path(&path, &rig, &larger, t);
    let change = |t| force_on(&path, &GRAVITY, t) - force_on(&copy, &GRAVITY, t);
    for step in 0..20 {
        comparison.add(change(0.1 * f64::from(step)).as_slice(), change(0.0).as_slice());
    }
    comparison
}

/// How many directions are free when the camera's velocity is constant and the biases are known: position, yaw and
/// scale, if there are no other copies than similar ones.
fn only_scale_is_free(motion: Trajectory) -> Comparison {
    let mut comparison = Comparison::absolute("position, yaw and scale", 0.1, "directions");
    let free = free(&window(motion, BiasAssumption::KNOWN)).count();
    comparison.add(&[free as f64], &[5.0]);
    comparison
}

/// By how much velocity and position residual of an interval change.
fn objection(
    first: &NavState,
    growth: f64,
    gained: &Vector3<f64>,
    beyond: &Vector3<f64>,
) -> SMatrix<f64, 6, 1> {
    let body_from_world = first.world_from_body.inverse();
    let (v, p) = (growth * (body_from_world * gained), growth * (body_from_world * beyond));
    SMatrix::<f64, 6, 1>::new(v.x, v.y, v.z, p.x, p.y, p.z)
}

/// Takes the states at both ends, gravity, the seconds between and the factor of growth.
type Objection = fn(&NavState, &NavState, &Vector3<f64>, f64, f64) -> SMatrix<f64, 6, 1>;

fn scale_objection(formula: Objection) -> Comparison {
    let against = "the residual of the grown states less that of the states";
    let mut comparison = Comparison::absolute(against, 1e-11, "m/s and m");
    let mut random = Random::new(14);
    for _ in 0..WINDOWS {
        let window = draws::short_window(draws::motion(&mut random), Vector3::zeros());
        let scale = random.logarithmic(0.6..1.6);
        let states: Vec<NavState> = (0..2).map(|_| draws::state(&mut random)).collect();
        let grown = |state: &NavState| NavState {
            velocity: scale * state.velocity,
            position: scale * state.position,
            ..*state
        };
        let (interval, bias) = (&window.intervals[0], &window.biases[0]);
        let gravity = draws::gravity(&mut random);
        let residual = |first: &NavState, second: &NavState| {
            imu_residual(interval, first, second, &gravity, bias).fixed_rows::<6>(3).into_owned()
        };
        let oracle =
            residual(&grown(&states[0]), &grown(&states[1])) - residual(&states[0], &states[1]);
        let given = formula(&states[0], &states[1], &gravity, interval.duration, scale);
        comparison.add(given.as_slice(), oracle.as_slice());
    }
    comparison
}

/// The other scale at which a constant acceleration and gravity give the same force.
pub fn other_scale(acceleration: &Vector3<f64>, gravity: &Vector3<f64>) -> f64 {
    1.0 - 2.0 * gravity.dot(acceleration) / acceleration.norm_squared()
}

type False = fn(&Vector3<f64>, &Vector3<f64>) -> f64;

fn false_scale(formula: False) -> Comparison {
    let against = "bisection for the scale at which gravity has its strength again";
    let mut comparison = Comparison::relative(against, 1e-9);
    let mut random = Random::new(15);
    for _ in 0..STATES {
        let acceleration = draws::climbing(&mut random);
        let excess = |scale: f64| (GRAVITY + (scale - 1.0) * acceleration).norm() - GRAVITY.norm();
        // Strength is least somewhere between the two scales at which it is right.
        let (mut low, mut high) = (-400.0, 400.0);
        for _ in 0..200 {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if excess(left) < excess(right) { high = right } else { low = left }
        }
        let least = 0.5 * (low + high);
        let (mut inside, mut outside) = (least, least + 4.0 * (least - 1.0));
        for _ in 0..200 {
            let middle = 0.5 * (inside + outside);
            if excess(middle) < 0.0 { inside = middle } else { outside = middle }
        }
        comparison.add(&[formula(&acceleration, &GRAVITY)], &[0.5 * (inside + outside)]);
    }
    comparison
}
