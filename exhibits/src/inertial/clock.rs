//! Two clocks that disagree, and what that does to pixels.

use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Vector2, Vector3, Vector6};
use vislam::inertial::CameraImu;
use vislam::manifold::se3;
use vislam::reprojection::Pinhole;
use vislam::simulation::{EulerAngles, Kinematics, ScalarTrajectory, Trajectory};

use super::STATES;
use super::oracle::{camera, motion, slope};
use super::rules::exponent;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    moved(chapter);
    left_over(chapter);
    pixels(chapter);
    numbers(chapter);
}

fn moved(chapter: &mut Chapter) {
    let formula: Moved = |c, m| c.world_from_camera_at_same_reading(&m.state, &m.angular_velocity);
    let mutants: [(_, Moved); 5] = [
        ("sign", |c, m| carried(c, m, -c.time_offset * twist(c, m))),
        ("offset forgotten", |c, m| c.world_from_camera(&m.state)),
        ("moved on the left", |c, m| {
            se3::exp(&(c.time_offset * twist(c, m))) * c.world_from_camera(&m.state)
        }),
        ("twist of the body", |c, m| {
            let still = CameraImu { body_from_camera: Isometry3::identity(), ..*c };
            carried(c, m, c.time_offset * twist(&still, m))
        }),
        ("lever arm forgotten", |c, m| {
            let mut near = *c;
            near.body_from_camera.translation = Translation3::identity();
            carried(c, m, c.time_offset * twist(&near, m))
        }),
    ];
    chapter.equation("inertial-time-offset", inertial_time_offset, formula, &mutants);
}

/// The camera's pose at the moment, moved by a step in its own frame.
fn carried(camera: &CameraImu, moment: &Kinematics, step: Vector6<f64>) -> Isometry3<f64> {
    se3::retract(&camera.world_from_camera(&moment.state), &step)
}

/// The camera's pose when its clock shows the time of the moment.
type Moved = fn(&CameraImu, &Kinematics) -> Isometry3<f64>;

fn inertial_time_offset(formula: Moved) -> Comparison {
    let against = "the pose on the known motion, a few microseconds later";
    Comparison::absolute(against, 1e-8, "m, no unit").over(STATES, 60, |random| {
        let motion = motion(random);
        let time_offset = random.uniform(5e-6..1e-5);
        let camera = CameraImu { time_offset, ..camera(random) };
        let t = random.uniform(0.0..5.0);
        let truth = camera.world_from_camera(&motion.at(t + time_offset).state);
        (formula(&camera, &motion.at(t)), truth)
    })
}

fn left_over(chapter: &mut Chapter) {
    let formula: LeftOver = |_, rate| 0.5 * rate;
    let mutants: [(_, LeftOver); 4] = [
        ("sign", |_, rate| -0.5 * rate),
        ("without the half", |_, rate| *rate),
        ("the twist for its rate", |twist, _| 0.5 * twist),
        ("a bracket too many", |twist, rate| {
            let (rho, phi) = halves(twist);
            let turned = phi.cross(&rho);
            0.5 * rate + 0.5 * Vector6::new(turned.x, turned.y, turned.z, 0.0, 0.0, 0.0)
        }),
    ];
    chapter.equation("inertial-time-remainder", inertial_time_remainder, formula, &mutants);
}

/// Takes the twist of the camera and its rate; what is left over, by the squared offset.
type LeftOver = fn(&Vector6<f64>, &Vector6<f64>) -> Vector6<f64>;

fn halves(twist: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (twist.fixed_rows::<3>(0).into(), twist.fixed_rows::<3>(3).into())
}

fn inertial_time_remainder(formula: LeftOver) -> Comparison {
    let against = "the pose on the known motion 2 and 4 ms later, extrapolated";
    Comparison::relative(against, 3e-3).over(200, 61, |random| {
        let (motion, camera) = (motion(random), camera(random));
        let t = random.uniform(0.0..5.0);
        let twist = |s: f64| twist(&camera, &motion.at(t + s));
        let left = |offset: f64| {
            let late = CameraImu { time_offset: offset, ..camera };
            let now = motion.at(t);
            let found = late.world_from_camera_at_same_reading(&now.state, &now.angular_velocity);
            let truth = camera.world_from_camera(&motion.at(t + offset).state);
            se3::local(&found, &truth) / (offset * offset)
        };
        (formula(&twist(0.0), &slope(twist, 1e-3)), 2.0 * left(2e-3) - left(4e-3))
    })
}

fn twist(camera: &CameraImu, kinematics: &Kinematics) -> Vector6<f64> {
    camera.twist(&kinematics.state, &kinematics.angular_velocity)
}

fn pixels(chapter: &mut Chapter) {
    let mutants: [(_, PixelVelocity); 4] = [
        ("sign", |k, p, xi| -pixel_velocity(k, p, xi)),
        ("sign of the turn", |k, p, xi| pixel_velocity(k, p, &scaled(xi, 1.0, -1.0))),
        ("turn dropped", |k, p, xi| pixel_velocity(k, p, &scaled(xi, 1.0, 0.0))),
        ("way dropped", |k, p, xi| pixel_velocity(k, p, &scaled(xi, 0.0, 1.0))),
    ];
    chapter.equation("inertial-pixel-velocity", inertial_pixel_velocity, pixel_velocity, &mutants);
}

/// A twist with its way and its turn scaled.
fn scaled(twist: &Vector6<f64>, way: f64, turn: f64) -> Vector6<f64> {
    Vector6::from_fn(|k, _| twist[k] * if k < 3 { way } else { turn })
}

/// Takes a camera, a point in its frame and the camera's twist.
type PixelVelocity = fn(&Pinhole, &Vector3<f64>, &Vector6<f64>) -> Vector2<f64>;

/// Pixels per second at which a resting point moves.
pub fn pixel_velocity(
    camera: &Pinhole,
    point_in_camera: &Vector3<f64>,
    twist: &Vector6<f64>,
) -> Vector2<f64> {
    let (rho, phi) = halves(twist);
    let motion = -rho - phi.cross(point_in_camera);
    let blocks = camera.jacobians(&Isometry3::identity(), point_in_camera);
    blocks.map_or(Vector2::repeat(f64::NAN), |both| both.1 * motion)
}

fn inertial_pixel_velocity(formula: PixelVelocity) -> Comparison {
    let against = "differences of the pixel along known motions";
    Comparison::relative(against, 1e-6).over(STATES, 62, |random| {
        let (motion, camera) = (motion(random), camera(random));
        let (pinhole, t) = (random.camera(), random.uniform(0.0..5.0));
        let point_in_camera = random.point(2.0..20.0);
        let pose = |s: f64| camera.world_from_camera(&motion.at(t + s).state);
        let place = pose(0.0) * Point3::from(point_in_camera);
        let pixel = |s: f64| pinhole.project(&pose(s).inverse(), &place.coords);
        let slope = slope(|s| pixel(s).unwrap_or(Vector2::repeat(f64::NAN)), 1e-3);
        (formula(&pinhole, &point_in_camera, &twist(&camera, &motion.at(t))), slope)
    })
}

/// The camera of the examples.
pub const PINHOLE: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };

/// A camera that looks ahead, ten centimetres before the sensor and five to its left.
pub fn rig() -> CameraImu {
    let ahead = Rotation3::from_matrix_unchecked(nalgebra::Matrix3::new(
        0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0,
    ));
    let lever = Vector3::new(0.1, 0.05, 0.0);
    CameraImu {
        body_from_camera: Isometry3::from_parts(lever.into(), ahead.into()),
        time_offset: 0.0,
    }
}

/// The figure-eight flown so many times as fast.
pub fn paced(pace: f64) -> Trajectory {
    let faster = |coordinate: ScalarTrajectory| ScalarTrajectory {
        frequency: pace * coordinate.frequency,
        ..coordinate
    };
    let Trajectory { position, angles, .. } = Trajectory::figure_eight();
    let EulerAngles { yaw, pitch, roll } = angles;
    let angles = EulerAngles { yaw: faster(yaw), pitch: faster(pitch), roll: faster(roll) };
    Trajectory { position: position.map(faster), angles, ..Trajectory::default() }
}

/// Paces in the figure.
pub const PACES: [f64; 2] = [0.5, 2.0];
/// Metres to the points in the figure.
pub const DEPTH: f64 = 5.0;
/// Moments and points over which errors are averaged.
const LOOKS: usize = 400;

/// Root mean square length over moments, and for each a point in the camera's frame that the middle
/// of its image sees at `depth`.
fn root_mean_square(depth: f64, pixels: impl Fn(f64, Vector3<f64>) -> Vector2<f64>) -> f64 {
    let mut random = Random::new(63);
    let squares = (0..LOOKS).map(|_| {
        let (x, y) = (random.uniform(-0.5..0.5), random.uniform(-0.4..0.4));
        pixels(random.uniform(0.0..60.0), depth * Vector3::new(x, y, 1.0)).norm_squared()
    });
    (squares.sum::<f64>() / LOOKS as f64).sqrt()
}

/// Root mean square of distances between pixels over moments and points. The function gives two
/// poses, world from camera: the one that sees the point and the one that is believed.
pub fn pixel_error(depth: f64, poses: impl Fn(f64) -> [Isometry3<f64>; 2]) -> f64 {
    root_mean_square(depth, |t, point| {
        let [true_pose, believed] = poses(t);
        let place = (true_pose * Point3::from(point)).coords;
        let pixels = [true_pose, believed].map(|pose| PINHOLE.project(&pose.inverse(), &place));
        let [seen, expected] = pixels.map(|pixel| pixel.unwrap_or(Vector2::repeat(f64::NAN)));
        seen - expected
    })
}

/// Pixel error for a clock that is off by so many seconds, uncorrected or corrected to first order.
pub fn offset_error(motion: &Trajectory, depth: f64, offset: f64, corrected: bool) -> f64 {
    let rig = CameraImu { time_offset: offset, ..rig() };
    pixel_error(depth, |t| {
        let kinematics = motion.at(t);
        let believed = if corrected {
            rig.world_from_camera_at_same_reading(&kinematics.state, &kinematics.angular_velocity)
        } else {
            rig.world_from_camera(&kinematics.state)
        };
        [rig.world_from_camera(&motion.at(t + offset).state), believed]
    })
}

/// The same by the formulas: the pixel's velocity times the offset, or what is left over.
pub fn expected_error(motion: &Trajectory, offset: f64, corrected: bool) -> f64 {
    root_mean_square(DEPTH, |t, point| {
        let at = |s: f64| twist(&rig(), &motion.at(t + s));
        let moved =
            if corrected { 0.5 * offset * offset * slope(at, 1e-3) } else { offset * at(0.0) };
        pixel_velocity(&PINHOLE, &point, &moved)
    })
}

fn numbers(chapter: &mut Chapter) {
    chapter.number("offset_depth", DEPTH, "m", 0);
    let [slow, fast] = PACES.map(paced);
    let rate = |motion: &Trajectory| {
        let squares = (0..600).map(|k| motion.at(0.1 * f64::from(k)).angular_velocity);
        (squares.map(|w| w.norm_squared()).sum::<f64>() / 600.0).sqrt()
    };
    chapter.number("slow_rate", rate(&slow), "rad/s", 1);
    chapter.number("fast_rate", rate(&fast), "rad/s", 1);
    chapter.number("slow_5ms", offset_error(&slow, DEPTH, 0.005, false), "px", 1);
    chapter.number("fast_5ms", offset_error(&fast, DEPTH, 0.005, false), "px", 1);
    chapter.number("slow_5ms_left", offset_error(&slow, DEPTH, 0.005, true), "px", 3);
    chapter.number("fast_5ms_left", offset_error(&fast, DEPTH, 0.005, true), "px", 2);
    let offsets = [0.001, 0.002, 0.005, 0.01];
    let order = |corrected| {
        let errors = offsets.map(|offset| offset_error(&fast, DEPTH, offset, corrected));
        exponent(&offsets, &errors)
    };
    chapter.number("offset_order", order(false), "", 2);
    chapter.number("offset_order_left", order(true), "", 2);
}
