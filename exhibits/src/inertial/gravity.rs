//! What an accelerometer feels, and how gravity shows which way is up.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{GRAVITY, ImuNoise};
use vislam::manifold::so3;
use vislam::simulation::{EulerAngles, Kinematics, ScalarTrajectory, Trajectory};

use super::STATES;
use super::oracle::{bend, motion};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::manifold::oracle::small_vector;

pub fn exhibits(chapter: &mut Chapter) {
    felt(chapter);
    plumb_line(chapter);
    numbers(chapter);
}

fn felt(chapter: &mut Chapter) {
    let formula: SpecificForce = |kinematics, g| kinematics.sample(g).accelerometer;
    let mutants: [(_, SpecificForce); 5] = [
        ("acceleration alone", |m, _| m.sample(&Vector3::zeros()).accelerometer),
        ("gravity added", |m, g| m.sample(&-g).accelerometer),
        ("sign", |m, g| -m.sample(g).accelerometer),
        ("in the world", |m, g| m.acceleration - g),
        ("rotation transposed", |m, g| m.state.world_from_body * (m.acceleration - g)),
    ];
    chapter.equation("inertial-specific-force", inertial_specific_force, formula, &mutants);
}

type SpecificForce = fn(&Kinematics, &Vector3<f64>) -> Vector3<f64>;

fn inertial_specific_force(formula: SpecificForce) -> Comparison {
    let against = "the acceleration, seen from the sensor, of a stone that is let go";
    Comparison::absolute(against, 1e-6, "m/s²").over(STATES, 1, |random| {
        let motion = motion(random);
        let t = random.uniform(0.0..5.0);
        let released = motion.at(t);
        let seen = |s: f64| {
            let fallen = s * released.state.velocity + 0.5 * s * s * GRAVITY;
            let body = motion.at(t + s).state;
            body.world_from_body.inverse() * (released.state.position + fallen - body.position)
        };
        (formula(&released, &GRAVITY), -bend(seen, 4e-3))
    })
}

fn plumb_line(chapter: &mut Chapter) {
    let formula: Turned = |r, psi| at_rest(&(about(2, psi) * r));
    let mutants: [(_, Turned); 3] = [
        ("turned in the body", |r, psi| at_rest(&(r * about(2, psi)))),
        ("turned about a level axis", |r, psi| at_rest(&(about(0, psi) * r))),
        ("rotation transposed", |r, psi| at_rest(&(about(2, psi) * r).inverse())),
    ];
    chapter.equation("inertial-yaw-blind", inertial_yaw_blind, formula, &mutants);

    let mutants: [(_, Tilt); 4] = [
        ("sign of the pitch", |f| [tilt(f)[0], -tilt(f)[1]]),
        ("roll and pitch exchanged", |f| [tilt(f)[1], tilt(f)[0]]),
        ("roll without its quadrant", |f| [(f.y / f.z).atan(), tilt(f)[1]]),
        ("pitch from two axes", |f| [tilt(f)[0], (-f.x).atan2(f.z)]),
    ];
    chapter.equation("inertial-tilt", inertial_tilt, tilt, &mutants);

    let formula: TiltError = |e, b| b.cross(e) / GRAVITY.norm();
    let mutants: [(_, TiltError); 4] = [
        ("sign", |e, b| e.cross(b) / GRAVITY.norm()),
        ("the whole bias", |_, b| b / GRAVITY.norm()),
        ("not divided by gravity", |e, b| b.cross(e)),
        ("the component along the vertical", |e, b| b.dot(e) * e / GRAVITY.norm()),
    ];
    chapter.equation("inertial-tilt-bias", inertial_tilt_bias, formula, &mutants);
}

fn about(axis: usize, angle: f64) -> Rotation3<f64> {
    so3::exp(&Vector3::ith(axis, angle))
}

/// What a resting sensor's accelerometer reads.
fn at_rest(world_from_body: &Rotation3<f64>) -> Vector3<f64> {
    let mut kinematics = Trajectory::hover().at(0.0);
    kinematics.state.world_from_body = *world_from_body;
    kinematics.sample(&GRAVITY).accelerometer
}

/// Takes a rotation, world from body, and an angle.
type Turned = fn(&Rotation3<f64>, f64) -> Vector3<f64>;

fn inertial_yaw_blind(formula: Turned) -> Comparison {
    let against = "how far each of the sensor's axes points up, before the turn";
    Comparison::absolute(against, 1e-13, "m/s²").over(STATES, 2, |random| {
        let rotation = random.rotation(3.0);
        let turn = random.uniform(-3.0..3.0);
        let upward = [0, 1, 2].map(|axis| 9.81 * (rotation * Vector3::ith(axis, 1.0)).z);
        (formula(&rotation, turn), upward)
    })
}

/// Roll and pitch of a resting body from what its accelerometer reads.
fn tilt(force: &Vector3<f64>) -> [f64; 2] {
    [force.y.atan2(force.z), (-force.x).atan2(force.y.hypot(force.z))]
}

type Tilt = fn(&Vector3<f64>) -> [f64; 2];

fn inertial_tilt(formula: Tilt) -> Comparison {
    let against = "the roll and pitch of a resting body, at any yaw";
    Comparison::absolute(against, 1e-13, "rad").over(STATES, 3, |random| {
        let [yaw, roll] = [0, 1].map(|_| random.uniform(-3.1..3.1));
        let pitch = random.uniform(-1.5..1.5);
        let still = ScalarTrajectory::constant;
        let angles = EulerAngles { yaw: still(yaw), pitch: still(pitch), roll: still(roll) };
        let resting = Trajectory { angles, ..Trajectory::hover() };
        let force = resting.at(0.0).sample(&GRAVITY).accelerometer;
        (formula(&force), [roll, pitch])
    })
}

/// Takes the direction that is up, in the body frame, and the accelerometer's bias.
type TiltError = fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>;

fn inertial_tilt_bias(formula: TiltError) -> Comparison {
    let against = "the attitude found from a biased reading, by differences";
    Comparison::relative(against, 1e-6).over(STATES, 4, |random| {
        let rotation = Rotation3::from_euler_angles(
            random.uniform(-3.0..3.0),
            random.uniform(-1.2..1.2),
            random.uniform(-3.0..3.0),
        );
        let up = rotation.inverse() * Vector3::z();
        let bias = random.direction(1e-3);
        let yaw = rotation.euler_angles().2;
        let found = |sign: f64| {
            let [roll, pitch] = tilt(&(at_rest(&rotation) + sign * bias));
            let found = Rotation3::from_euler_angles(roll, pitch, yaw);
            small_vector((rotation.inverse() * found).matrix())
        };
        let error = 0.5 * (found(1.0) - found(-1.0));
        (formula(&up, &bias), error - error.dot(&up) * up)
    })
}

/// Speed and rate of the level turn in the text, in m/s and rad/s.
const TURN: (f64, f64) = (1.0, 0.5);

fn numbers(chapter: &mut Chapter) {
    let gravity = GRAVITY.norm();
    chapter.number("gravity", gravity, "m/s²", 2);
    let turn = Trajectory::level_turn(TURN.0, TURN.1).at(2.0).sample(&GRAVITY);
    chapter.number("turn_speed", TURN.0, "m/s", 0);
    chapter.number("turn_rate", TURN.1, "rad/s", 1);
    chapter.number("turn_inward", turn.accelerometer.y, "m/s²", 1);
    let [roll, _] = tilt(&turn.accelerometer);
    chapter.number("turn_roll_deg", roll.to_degrees(), "°", 1);

    let bias = 0.1;
    chapter.number("tilt_bias", bias, "m/s²", 1);
    chapter.number("tilt_bias_deg", (bias / gravity).to_degrees(), "°", 2);
    let average = ImuNoise::mems().discrete(1.0)[(3, 3)].sqrt() / gravity;
    chapter.number("tilt_noise_deg", average.to_degrees(), "°", 2);
    let (equator, pole) = (9.780, 9.832);
    chapter.number("gravity_spread", pole - equator, "m/s²", 2);
    let day = 86_164.0;
    chapter.number("earth_deg_per_hour", 360.0 * 3600.0 / day, "°/h", 1);
}
