//! The numbers that the chapter quotes.

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, Matrix3, Matrix6, Rotation3, Vector3, Vector6};
use vislam::filtering::chi_square_quantile;
use vislam::manifold::{se3, so3};

use super::accuracy::{errors_near, errors_near_half_turn};
use super::uncertainty::{Drive, in_plane, plane_of};
use crate::chapter::Chapter;
use crate::comparison::inverse;

/// Registers the numbers.
pub fn numbers(chapter: &mut Chapter) {
    two_orders(chapter);
    numbers_that_fail(chapter);
    jacobian_of_a_quarter_turn(chapter);
    coning(chapter);
    digits(chapter);
    drive(chapter);
    near_a_half_turn(chapter);
    copied_covariance(chapter);
}

/// The rotation vector of a turn about z.
fn about_z(degrees: f64) -> Vector3<f64> {
    degrees.to_radians() * Vector3::z()
}

/// The angle between the two orders of a turn about x and one about z, in degrees.
fn between_orders(degrees: f64) -> f64 {
    let about_x = so3::exp(&(degrees.to_radians() * Vector3::x()));
    let about_z = so3::exp(&about_z(degrees));
    so3::local(&(about_x * about_z), &(about_z * about_x)).norm().to_degrees()
}

fn two_orders(chapter: &mut Chapter) {
    chapter.number("quarter_deg", 90.0, "°", 0);
    chapter.number("tenth_deg", 9.0, "°", 0);
    chapter.number("hundredth_deg", 0.9, "°", 1);
    chapter.number("orders_quarter_deg", between_orders(90.0), "°", 0);
    chapter.number("orders_tenth_deg", between_orders(9.0), "°", 2);
    chapter.number("orders_hundredth_deg", between_orders(0.9), "°", 3);
}

fn numbers_that_fail(chapter: &mut Chapter) {
    let quarter = so3::exp(&(0.5 * PI * Vector3::z()));
    let mean = 0.5 * (Matrix3::identity() + quarter.matrix());
    chapter.number("mean_length", mean.column(0).norm(), "", 2);
    chapter.number("mean_volume", mean.determinant(), "", 1);

    let (pitch, turn) = (89.0_f64, 1.0);
    let before = Rotation3::from_euler_angles(0.0, pitch.to_radians(), 0.0);
    let after = so3::retract(&before, &about_z(turn));
    let (roll_after, pitch_after, yaw_after) = after.euler_angles();
    chapter.number("gimbal_pitch_deg", pitch, "°", 0);
    chapter.number("gimbal_turn_deg", turn, "°", 0);
    chapter.number("gimbal_yaw_deg", yaw_after.to_degrees(), "°", 1);
    chapter.number("gimbal_roll_deg", roll_after.to_degrees(), "°", 1);
    chapter.number("gimbal_pitch_change_deg", (pitch_after.to_degrees() - pitch).abs(), "°", 2);

    let (first, second) = (179.0, -179.0);
    chapter.number("heading_first_deg", first, "°", 0);
    chapter.number("heading_second_deg", second, "°", 0);
    chapter.number("heading_mean_deg", 0.5 * (first + second), "°", 0);
    let [first, second] = [first, second].map(|degrees| so3::exp(&about_z(degrees)));
    let step = so3::local(&first, &second);
    let middle = so3::retract(&first, &(0.5 * step));
    chapter.number("heading_middle_deg", so3::log(&middle).norm().to_degrees(), "°", 0);
    chapter.number("heading_step_deg", step.norm().to_degrees(), "°", 0);
}

fn jacobian_of_a_quarter_turn(chapter: &mut Chapter) {
    let step = so3::right_jacobian(&(0.5 * PI * Vector3::z())) * Vector3::x();
    chapter.number("step_x", step.x, "", 3);
    chapter.number("step_y", step.y, "", 3);
    chapter.number("step_length", step.norm(), "", 3);
    chapter.number("step_direction_deg", step.y.atan2(step.x).to_degrees(), "°", 0);
    let moved = so3::exp(&Vector3::new(0.0, 0.0, 0.5 * PI));
    let left: Vector3<f64> = moved * (0.1 * Vector3::x());
    chapter.number("small_turn", 0.1, "rad", 1);
    chapter.number("small_turn_left_y", left.y, "rad", 1);

    let shrinks = |degrees| (so3::right_jacobian(&about_z(degrees)) * Vector3::x()).norm();
    chapter.number("half_turn_deg", 180.0, "°", 0);
    chapter.number("shrinks_half", shrinks(180.0), "", 2);
    chapter.number("grows_half", 1.0 / shrinks(180.0), "", 2);
    chapter.number("late_deg", 350.0, "°", 0);
    chapter.number("grows_late", 1.0 / shrinks(350.0), "", 0);
    chapter.number("grows_quarter", 1.0 / shrinks(90.0), "", 2);
}

/// A body whose axis wobbles around a circle without spinning about itself: the small vectors add
/// up to nothing, and the body has turned.
fn coning(chapter: &mut Chapter) {
    let (radius_deg, circles, steps): (f64, u32, u32) = (5.0, 10, 1000);
    let radius = radius_deg.to_radians();
    let corner = |k: u32| {
        let angle = TAU * f64::from(k) / f64::from(steps);
        radius * Vector3::new(angle.cos(), angle.sin(), 0.0)
    };
    let mut rotation = Rotation3::identity();
    for k in 0..circles * steps {
        rotation = so3::retract(&rotation, &(corner(k + 1) - corner(k)));
    }
    chapter.number("cone_radius_deg", radius_deg, "°", 0);
    chapter.number("cone_circles", f64::from(circles), "", 0);
    chapter.number("cone_turn_deg", so3::log(&rotation).z.to_degrees(), "°", 1);
    let area = PI * radius * radius;
    chapter.number("cone_area_deg", (f64::from(circles) * area).to_degrees(), "°", 1);
}

fn digits(chapter: &mut Chapter) {
    let digits = |error: f64| (-error.log10()).round();
    let [angle, jacobian, corner, _, _, library] = errors_near(1e-3);
    chapter.number("digits_angle_mrad", 1.0, "mrad", 0);
    chapter.number("digits_angle", digits(angle), "", 0);
    chapter.number("digits_jacobian", digits(jacobian), "", 0);
    chapter.number("digits_corner", digits(corner), "", 0);
    chapter.number("digits_library", digits(library), "", 0);
    chapter.number("digits_of_a_double", digits(f64::EPSILON), "", 0);
    chapter.number("digits_near_half", digits(errors_near_half_turn(1e-3)[0]), "", 0);
}

const DRAWS: usize = 100_000;

fn drive(chapter: &mut Chapter) {
    let drive = Drive::WORKED;
    let (expected, covariance) = (drive.expected(), plane_of(&drive.covariance()));
    chapter.number("drive_length", drive.length, "m", 0);
    chapter.number("drive_heading_deg", drive.start[2].to_degrees(), "°", 0);
    chapter.number("drive_sideways", covariance[(1, 1)].sqrt(), "m", 1);
    chapter.number("drive_along", covariance[(0, 0)].sqrt(), "m", 2);
    let correlation = covariance[(1, 2)] / (covariance[(1, 1)] * covariance[(2, 2)]).sqrt();
    chapter.number("drive_correlation", correlation, "", 2);
    chapter.number("drive_draws", DRAWS as f64, "", 0);
    let (information, largest) =
        (inverse(covariance), chi_square_quantile(0.95, 3).expect("a probability"));
    let inside = |error: Vector3<f64>| error.dot(&(information * error)) < largest;
    let (mut in_world, mut in_tangent) = (0, 0);
    for end in drive.ends(40).take(DRAWS) {
        let moved = end.translation.vector - expected.translation.vector;
        let heading = so3::log_quaternion(&end.rotation).z;
        // The robot is expected to look along x, so its frame is the world's at first order.
        in_world += usize::from(inside(Vector3::new(moved.x, moved.y, heading)));
        in_tangent += usize::from(inside(in_plane(&se3::local(&expected, &end))));
    }
    let percent = |count: usize| 100.0 * count as f64 / DRAWS as f64;
    chapter.number("promised_percent", 95.0, "%", 0);
    chapter.number("drive_world_percent", percent(in_world), "%", 1);
    chapter.number("drive_tangent_percent", percent(in_tangent), "%", 1);

    let heading_deg: f64 = 1.0;
    chapter.number("lever_heading_deg", heading_deg, "°", 0);
    chapter.number("lever_sideways_cm", 100.0 * drive.length * heading_deg.to_radians(), "cm", 0);
}

fn near_a_half_turn(chapter: &mut Chapter) {
    let (angle, step) = (179.9, 0.2);
    let before = so3::exp(&about_z(angle));
    let after = so3::retract(&before, &about_z(step));
    chapter.number("near_half_deg", angle, "°", 1);
    chapter.number("near_half_step_deg", step, "°", 1);
    chapter.number("near_half_after_deg", so3::log(&after).z.to_degrees(), "°", 1);
    chapter.number("near_half_local_deg", so3::local(&before, &after).z.to_degrees(), "°", 1);
}

/// A covariance of a twist on the right, read as one of a twist on the left.
fn copied_covariance(chapter: &mut Chapter) {
    let (distance, position, heading_deg): (f64, f64, f64) = (100.0, 0.01, 0.1);
    let heading = heading_deg.to_radians();
    let deviations = Vector6::new(position, position, position, 0.0, 0.0, heading);
    let copied = Matrix6::from_diagonal(&deviations.map(|deviation| deviation * deviation));
    let back = se3::adjoint(&Isometry3::translation(distance, 0.0, 0.0).inverse());
    let believed = back * copied * back.transpose();
    chapter.number("copy_distance", distance, "m", 0);
    chapter.number("copy_position_cm", 100.0 * position, "cm", 0);
    chapter.number("copy_heading_deg", heading_deg, "°", 1);
    chapter.number("copy_believed_cm", 100.0 * believed[(1, 1)].sqrt(), "cm", 0);
}
