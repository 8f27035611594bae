//! A camera at the end of a lever arm.

use nalgebra::Vector3;
use vislam::inertial::CameraImu;
use vislam::simulation::Kinematics;

use super::STATES;
use super::oracle::{bend, camera, motion, slope};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Velocity = |camera, kinematics| {
        let twist = camera.twist(&kinematics.state, &kinematics.angular_velocity);
        let rotation = camera.world_from_camera(&kinematics.state).rotation;
        rotation * Vector3::from(twist.fixed_rows::<3>(0))
    };
    let mutants: [(_, Velocity); 4] = [
        ("lever arm forgotten", |_, m| m.state.velocity),
        ("sign of the product", |c, m| m.state.velocity - m.state.world_from_body * swing_of(c, m)),
        ("swing not turned", |c, m| m.state.velocity + swing_of(c, m)),
        ("lever arm from the camera", |c, m| {
            let lever = c.body_from_camera.inverse().translation.vector;
            m.state.velocity + m.state.world_from_body * m.angular_velocity.cross(&lever)
        }),
    ];
    chapter.equation("inertial-camera-velocity", inertial_camera_velocity, formula, &mutants);

    let formula: Acceleration = |camera, own, w, alpha| camera.acceleration(own, w, alpha);
    let mutants: [(_, Acceleration); 4] = [
        ("outward", |c, own, w, alpha| own + alpha.cross(&arm(c)) - w.cross(&w.cross(&arm(c)))),
        ("turning speeds up by itself", |c, own, w, _| c.acceleration(own, w, &Vector3::zeros())),
        ("steady turn forgotten", |c, own, _, alpha| c.acceleration(own, &Vector3::zeros(), alpha)),
        ("sign of the speeding up", |c, own, w, alpha| c.acceleration(own, w, &-alpha)),
    ];
    let check = inertial_camera_acceleration;
    chapter.equation("inertial-camera-acceleration", check, formula, &mutants);
    numbers(chapter);
}

fn arm(camera: &CameraImu) -> Vector3<f64> {
    camera.body_from_camera.translation.vector
}

/// ω × l, in the body frame.
fn swing_of(camera: &CameraImu, kinematics: &Kinematics) -> Vector3<f64> {
    kinematics.angular_velocity.cross(&arm(camera))
}

/// Where the camera is in the world.
fn place(camera: &CameraImu, kinematics: &Kinematics) -> Vector3<f64> {
    let body = kinematics.state;
    body.position + body.world_from_body * arm(camera)
}

/// The velocity of the camera in the world.
type Velocity = fn(&CameraImu, &Kinematics) -> Vector3<f64>;

fn inertial_camera_velocity(formula: Velocity) -> Comparison {
    let against = "differences of the camera's place along known motions";
    Comparison::absolute(against, 1e-8, "m/s").over(STATES, 50, |random| {
        let (motion, camera) = (motion(random), camera(random));
        let t = random.uniform(0.0..5.0);
        let place = |s: f64| place(&camera, &motion.at(t + s));
        (formula(&camera, &motion.at(t)), slope(place, 1e-3))
    })
}

/// Takes the body's acceleration, its angular velocity and its angular acceleration.
type Acceleration = fn(&CameraImu, &Vector3<f64>, &Vector3<f64>, &Vector3<f64>) -> Vector3<f64>;

fn inertial_camera_acceleration(formula: Acceleration) -> Comparison {
    let against = "second differences of the camera's place along known motions";
    Comparison::absolute(against, 1e-6, "m/s²").over(STATES, 51, |random| {
        let (motion, camera) = (motion(random), camera(random));
        let t = random.uniform(0.0..5.0);
        let place = |s: f64| place(&camera, &motion.at(t + s));
        let kinematics = motion.at(t);
        let body_from_world = kinematics.state.world_from_body.inverse();
        let alpha = slope(|s| motion.at(t + s).angular_velocity, 1e-3);
        let own = body_from_world * kinematics.acceleration;
        let found = formula(&camera, &own, &kinematics.angular_velocity, &alpha);
        (found, body_from_world * bend(place, 4e-3))
    })
}

fn numbers(chapter: &mut Chapter) {
    let (arm, rate) = (0.1, 3.0);
    chapter.number("arm_cm", 100.0 * arm, "cm", 0);
    chapter.number("arm_rate", rate, "rad/s", 0);
    chapter.number("arm_speed", 100.0 * arm * rate, "cm/s", 0);
    chapter.number("arm_inward", arm * rate * rate, "m/s²", 1);
}
