//! A picture whose rows are taken one after the other.

use nalgebra::{Isometry3, Point3, Vector2};
use vislam::inertial::CameraImu;
use vislam::manifold::se3;
use vislam::simulation::Kinematics;

use super::clock::{DEPTH, PACES, offset_error, paced};
use super::oracle::{camera, motion};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, RowPose); 5] = [
        ("sign of the row", |c, m, line, row| row_pose(c, m, -line, row)),
        ("row dropped", |c, m, line, _| row_pose(c, m, line, 0.0)),
        ("offset of the clocks dropped", |c, m, line, row| {
            row_pose(&CameraImu { time_offset: 0.0, ..*c }, m, line, row)
        }),
        ("offset times row", |c, m, line, row| {
            row_pose(&CameraImu { time_offset: c.time_offset * line * row, ..*c }, m, 0.0, row)
        }),
        ("moved on the left", |c, m, line, row| {
            let time = c.time_offset + line * row;
            se3::exp(&(time * c.twist(&m.state, &m.angular_velocity)))
                * c.world_from_camera(&m.state)
        }),
    ];
    chapter.equation("inertial-rolling-shutter", inertial_rolling_shutter, row_pose, &mutants);
    numbers(chapter);
}

/// Takes a camera, the motion at the stamp of its picture, the time of a line and a row; the pose
/// of the camera, world from camera, when that row was taken.
type RowPose = fn(&CameraImu, &Kinematics, f64, f64) -> Isometry3<f64>;

fn row_pose(camera: &CameraImu, at: &Kinematics, line: f64, row: f64) -> Isometry3<f64> {
    let taken = CameraImu { time_offset: camera.time_offset + line * row, ..*camera };
    taken.world_from_camera_at_same_reading(&at.state, &at.angular_velocity)
}

fn inertial_rolling_shutter(formula: RowPose) -> Comparison {
    let against = "the pixel whose row passes over the point's image on the known motion";
    let mut random = Random::new(64);
    let seen = std::iter::repeat_with(|| {
        let (motion, pinhole) = (motion(&mut random), random.camera());
        let time_offset = random.uniform(1e-4..2e-4);
        let (line, t) = (random.uniform(2e-7..4e-7), random.uniform(0.0..5.0));
        let camera = CameraImu { time_offset, ..camera(&mut random) };
        let point = Point3::from(random.point(2.0..20.0));
        let place = (camera.world_from_camera(&motion.at(t).state) * point).coords;
        let pixel = shutter_finds(|row| {
            let state = motion.at(t + time_offset + line * row).state;
            pinhole.project(&camera.world_from_camera(&state).inverse(), &place)
        })?;
        let pose = formula(&camera, &motion.at(t), line, pixel.y).inverse();
        Some((pinhole.project(&pose, &place), pixel))
    });
    Comparison::absolute(against, 5e-3, "px").each(seen.flatten().take(200), |both| both)
}

/// The pixel at which the shutter finds a point, given where it would see it while it takes a row:
/// rows are halved until one is taken as the point's image is on it.
fn shutter_finds(seen: impl Fn(f64) -> Option<Vector2<f64>>) -> Option<Vector2<f64>> {
    let [mut low, mut high] = [-2000.0, 4000.0];
    for _ in 0..60 {
        let row = 0.5 * (low + high);
        if seen(row)?.y > row { low = row } else { high = row }
    }
    seen(low)
}

/// Rows of the usual camera, and seconds in which it reads them.
const ROWS: f64 = 480.0;
const READOUT: f64 = 0.02;

fn numbers(chapter: &mut Chapter) {
    chapter.number("shutter_ms", 1e3 * READOUT, "ms", 0);
    chapter.number("shutter_rows", ROWS, "", 0);
    chapter.number("shutter_line_us", 1e6 * READOUT / ROWS, "µs", 0);
    chapter.number("shutter_depth", DEPTH, "m", 0);
    // The first and the last row are this far from the middle one.
    let error = |pace, corrected| offset_error(&paced(pace), DEPTH, 0.5 * READOUT, corrected);
    chapter.number("shutter_slow_px", error(PACES[0], false), "px", 1);
    chapter.number("shutter_fast_px", error(PACES[1], false), "px", 1);
    chapter.number("shutter_fast_left", error(PACES[1], true), "px", 2);
}
