//! What a wrong calibration costs in pixels.

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use vislam::inertial::CameraImu;
use vislam::simulation::Trajectory;

use super::clock::{offset_error, pixel_error, rig};
use crate::chapter::Chapter;

/// Metres to the points.
const DEPTHS: [f64; 3] = [2.0, 5.0, 20.0];
const ARM_ERROR: f64 = 0.01;
const ANGLE_ERROR_DEG: f64 = 1.0;
const OFFSET: f64 = 0.005;

pub fn numbers(chapter: &mut Chapter) {
    let motion = Trajectory::figure_eight();
    let axis = Unit::new_normalize(Vector3::repeat(1.0));
    let arm = Translation3::from(ARM_ERROR * axis.into_inner()).into();
    let turn = UnitQuaternion::from_axis_angle(&axis, ANGLE_ERROR_DEG.to_radians());
    let turn = Isometry3::from_parts(Translation3::identity(), turn);
    let names = [
        ["calibration_near_depth", "arm_near_px", "turn_near_px", "clock_near_px"],
        ["calibration_depth", "arm_px", "turn_px", "clock_px"],
        ["calibration_far_depth", "arm_far_px", "turn_far_px", "clock_far_px"],
    ];
    for (depth, names) in DEPTHS.into_iter().zip(names) {
        chapter.number(names[0], depth, "m", 0);
        chapter.number(names[1], wrong_by(&motion, depth, &arm), "px", 2);
        chapter.number(names[2], wrong_by(&motion, depth, &turn), "px", 1);
        chapter.number(names[3], offset_error(&motion, depth, OFFSET, false), "px", 1);
    }
    chapter.number("calibration_arm_cm", 100.0 * ARM_ERROR, "cm", 0);
    chapter.number("calibration_turn_deg", ANGLE_ERROR_DEG, "°", 0);
    chapter.number("calibration_offset_ms", 1e3 * OFFSET, "ms", 0);
}

/// Pixel error when the camera sits on the body differently by a small pose.
fn wrong_by(motion: &Trajectory, depth: f64, error: &Isometry3<f64>) -> f64 {
    let rig = rig();
    let wrong = CameraImu { body_from_camera: rig.body_from_camera * error, ..rig };
    pixel_error(depth, |t| {
        let state = motion.at(t).state;
        [rig.world_from_camera(&state), wrong.world_from_camera(&state)]
    })
}
