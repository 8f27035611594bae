//! Trajectories and maps as texts that other programs read.

use std::fmt::Write;

use nalgebra::{Matrix6, Vector3};

use crate::inertial::NavState;

// ANCHOR: tum
/// A trajectory in the form of TUM's benchmark for RGB-D cameras, which tools that compare trajectories
/// read: a line `timestamp tx ty tz qx qy qz qw` for each time, in seconds and metres. Position and
/// quaternion are those of the body in the world. Times are given in nanoseconds.
pub fn tum<'a>(states: impl IntoIterator<Item = (i64, &'a NavState)>) -> String {
    let mut text = String::from("# timestamp tx ty tz qx qy qz qw\n");
    for (nanoseconds, state) in states {
        let pose = state.pose();
        let (t, q) = (pose.translation, pose.rotation);
        let numbers = [t.x, t.y, t.z, q.i, q.j, q.k, q.w];
        text += &line(nanoseconds, &numbers);
    }
    text
}
// ANCHOR_END: tum

// ANCHOR: pose_covariances
/// Covariances of poses: a line for each time with the time in seconds and the upper triangle of the
/// 6×6 matrix, row by row, 21 numbers. Rows and columns are those of a step of a
/// [`BodyPose`](crate::inertial::BodyPose): a turn φ of the body in its own frame,
/// `world_from_body` exp(φ), in radians, then the position in the world, in metres. Times are given in
/// nanoseconds.
pub fn pose_covariances<'a>(
    covariances: impl IntoIterator<Item = (i64, &'a Matrix6<f64>)>,
) -> String {
    let mut text = String::from(
        "# timestamp, then the upper triangle of the covariance of (rx ry rz px py pz), row by row: \
         rotation in the body [rad], position in the world [m]\n",
    );
    for (nanoseconds, covariance) in covariances {
        let upper = (0..6).flat_map(|row| (row..6).map(move |column| covariance[(row, column)]));
        text += &line(nanoseconds, &upper.collect::<Vec<f64>>());
    }
    text
}
// ANCHOR_END: pose_covariances

/// A time in seconds, with all its digits, and numbers behind it.
fn line(nanoseconds: i64, numbers: &[f64]) -> String {
    let (seconds, sign) = (nanoseconds.unsigned_abs(), if nanoseconds < 0 { "-" } else { "" });
    let time = format!("{sign}{}.{:09}", seconds / 1_000_000_000, seconds % 1_000_000_000);
    numbers.iter().fold(time, |line, number| format!("{line} {number}")) + "\n"
}

// ANCHOR: ply
/// Points with colours, red, green and blue, as PLY in ASCII, which viewers of point clouds open.
pub fn ply(points: &[(Vector3<f64>, [u8; 3])]) -> String {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", points.len());
    for property in ["double x", "double y", "double z", "uchar red", "uchar green", "uchar blue"] {
        text += &format!("property {property}\n");
    }
    text += "end_header\n";
    for (p, [red, green, blue]) in points {
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{} {} {} {red} {green} {blue}", p.x, p.y, p.z);
    }
    text
}
// ANCHOR_END: ply
