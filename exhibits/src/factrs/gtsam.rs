//! The same graph in GTSAM: of the book's factors, where all three agree, and of GTSAM's own.

use std::time::Instant;

use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3, Vector6};
use vislam::inertial::{ImuBias, NavState};
use vislam::least_squares::{Kernel, Options};

use super::predicted::overshoot;
use super::two_keyframes::{BIAS, Estimate, Graph, HUBER, STATE, STEP, Scene};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::python::{Exported, Python, pose_numbers, state_numbers};
use crate::record::{RecordValue, accepted};

const RUNS: usize = 200;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![("graph", "that of examples/two_keyframes.rs, seed 0".to_owned())];
    chapter.record_of_data("factrs_gtsam", &[], inputs, of_gtsam);
}

pub fn numbers(chapter: &mut Chapter) {
    let of = |value: &str| accepted("factrs_gtsam", value);
    let ratio = of("turn_off") / of("turn_predicted");
    chapter.number("gtsam_turn_ratio", ratio, "", 2);
    chapter.number("own_predicted", moved_by_overshoot(&Scene::drawn(0)), "", 3);
}

/// How far an estimate moves, at most, in standard deviations of the bound, when the turn between its keyframes is
/// summed up too long by what is predicted.
fn moved_by_overshoot(scene: &Scene) -> f64 {
    let mut longer = scene.clone();
    let rate = overshoot(&rates(scene), STEP) / (STEP * scene.readings.len() as f64);
    longer.readings.iter_mut().for_each(|reading| reading.gyro += rate);
    let [before, after] = [scene, &longer].map(|scene| {
        let graph = Graph::new(scene, Kernel::Huber(HUBER)).expect("the sensors fit the graph");
        graph.solved().expect("priors leave nothing free")
    });
    let bound = Graph::bound(scene).expect("priors leave nothing free");
    apart(&before, &after, &bound)[1]
}

/// The angular velocities of a scene, less the bias that is known.
fn rates(scene: &Scene) -> Vec<Vector3<f64>> {
    scene.readings.iter().map(|reading| reading.gyro - scene.known_bias.gyro).collect()
}

/// What GTSAM prints.
struct Said {
    identical: Estimate,
    own: Estimate,
    turn: Rotation3<f64>,
    milliseconds: f64,
}

fn of_gtsam() -> Result<Vec<RecordValue>, NotMade> {
    let python = Python::with_gtsam()?;
    let scene = Scene::drawn(0);
    let said = theirs(&python, &scene)?;
    let graph = Graph::new(&scene, Kernel::Huber(HUBER)).expect("the sensors fit the graph");
    let ours = graph.solved().expect("priors leave nothing free");
    let bound = Graph::bound(&scene).expect("priors leave nothing free");
    let [_, sigmas] = apart(&ours, &said.own, &bound);
    let [worst, worst_sigmas] = apart(&ours, &said.identical, &bound);
    let sums = scene.preintegrated().expect("the readings can be summed up").sums;
    let off = said.turn.scaled_axis() - sums.deltas.rotation.scaled_axis();
    let predicted = overshoot(&rates(&scene), STEP);
    let value = RecordValue::new;
    Ok(vec![
        value("identical", 1e9 * worst, "10⁻⁹", 1, 10.0),
        value("identical_sigmas", 1e9 * worst_sigmas, "10⁻⁹", 1, 10.0),
        value("own_sigmas", sigmas, "", 3, 1e-3),
        value("turn_off", 1e6 * off.norm(), "µrad", 1, 1e-3),
        value("turn_predicted", 1e6 * predicted.norm(), "µrad", 1, 1e-3),
        value("gtsam", said.milliseconds, "ms", 2, 3.0),
        value("ours", least(&graph), "ms", 2, 3.0),
    ])
}

/// The largest difference between two estimates, and the largest in standard deviations of the bound.
fn apart(ours: &Estimate, theirs: &Estimate, bound: &[f64]) -> [f64; 2] {
    let step = ours.step_to(theirs);
    let sigmas = step.iter().zip(bound).map(|(step, variance)| step.abs() / variance.sqrt());
    [step.iter().fold(0.0, |worst, step| step.abs().max(worst)), sigmas.fold(0.0, f64::max)]
}

/// The least milliseconds of a search.
fn least(graph: &Graph) -> f64 {
    let time = |_| {
        let start = Instant::now();
        graph.problem.solve(&Options::default()).expect("priors leave nothing free");
        1e3 * start.elapsed().as_secs_f64()
    };
    (0..RUNS).map(time).fold(f64::INFINITY, f64::min)
}

/// What GTSAM says of a graph.
fn theirs(python: &Python, scene: &Scene) -> Result<Said, NotMade> {
    match &python.says("two_keyframes_gtsam.py", &exported(scene))?[..] {
        [identical, own, sums, time] if sums.len() == 10 && time.len() == 1 => Ok(Said {
            identical: estimate(identical),
            own: estimate(own),
            turn: rotation(sums),
            milliseconds: time[0],
        }),
        lines => {
            let counts: Vec<usize> = lines.iter().map(Vec::len).collect();
            let shape = format!("two_keyframes_gtsam.py prints {counts:?} numbers by lines");
            Err(NotMade::Failed(shape))
        }
    }
}

fn rotation(numbers: &[f64]) -> Rotation3<f64> {
    let quaternion = Quaternion::new(numbers[0], numbers[1], numbers[2], numbers[3]);
    UnitQuaternion::new_normalize(quaternion).to_rotation_matrix()
}

/// An estimate as the script prints it: sixteen numbers a keyframe, then the landmarks.
fn estimate(numbers: &[f64]) -> Estimate {
    let vector = |at: usize| Vector3::from_column_slice(&numbers[at..at + 3]);
    Estimate {
        states: [0, 16].map(|at| NavState {
            world_from_body: rotation(&numbers[at..]),
            position: vector(at + 4),
            velocity: vector(at + 7),
        }),
        biases: [10, 26]
            .map(|at| ImuBias::from_vector(&Vector6::from_column_slice(&numbers[at..at + 6]))),
        landmarks: (32..numbers.len()).step_by(3).map(vector).collect(),
    }
}

/// The graph as the script reads it.
fn exported(scene: &Scene) -> Exported {
    let mut lines = Exported::default();
    let mut line = |kind: &str, numbers: &[f64]| lines.line(kind, numbers);
    let Scene { camera, guess, noise, .. } = scene;
    guess.states.iter().for_each(|guess| line("state", &state_numbers(guess)));
    guess.biases.iter().for_each(|bias| line("bias", bias.vector().as_slice()));
    guess.landmarks.iter().for_each(|landmark| line("landmark", landmark.as_slice()));
    line("extrinsics", &pose_numbers(&scene.body_from_camera));
    line("camera", &[camera.fx, camera.fy, camera.cx, camera.cy, scene.pixel_sigma, HUBER]);
    for (j, pixels) in scene.pixels.iter().enumerate() {
        for (k, pixel) in pixels.iter().enumerate() {
            line("pixel", &[k as f64, j as f64, pixel.x, pixel.y]);
        }
    }
    line("noise", &[noise.gyro, noise.accelerometer, noise.gyro_walk, noise.accelerometer_walk]);
    line("step", &[STEP]);
    for reading in &scene.readings {
        line("reading", &[reading.gyro.as_slice(), reading.accelerometer.as_slice()].concat());
    }
    line("known_state", &state_numbers(&scene.known_state));
    line("known_bias", scene.known_bias.vector().as_slice());
    line("sigmas", &[&STATE[..], &BIAS[..]].concat());
    let combined = scene.preintegrated().expect("the readings can be summed up");
    let (sums, deltas) = (&combined.sums, &combined.sums.deltas);
    let turn = UnitQuaternion::from_rotation_matrix(&deltas.rotation);
    let moved = [deltas.velocity.as_slice(), deltas.position.as_slice()].concat();
    line("sums", &[&[sums.duration, turn.w, turn.i, turn.j, turn.k], &moved[..]].concat());
    line("by_bias", sums.bias_jacobian.transpose().as_slice());
    line("covariance", combined.covariance().as_slice());
    lines
}
