//! What one picture says, and each picture alone.

use nalgebra::{Isometry3, Matrix3, Rotation3, SMatrix, Vector2, Vector3};
use vislam::bearing::{back_project, bearing};
use vislam::bundle_adjustment::PosedPinhole;
use vislam::factors::{MovingCamera, PixelByCamera};
use vislam::least_squares::{Kernel, Options, Problem};
use vislam::manifold::{se3, so3};
use vislam::structure_from_motion::resect;

use super::from_above::{Layer, is_inside, room};
use super::{camera_from_world, camera_path, centre, path, picture_at, recording, seen};
use crate::chapter::Chapter;
use crate::figure::Figure;
use crate::statistics::root_mean_square;

/// How far the rays of a picture are drawn at most, and a step along them, in metres along the axis of the camera.
const FARTHEST: f64 = 12.0;
const ALONG: f64 = 0.1;
/// How far off a camera begins, in degrees and metres.
const TURNED: f64 = 30.0;
const MOVED: f64 = 1.0;
/// How many seconds are seen picture by picture.
const ALONE: f64 = 10.0;
/// Ellipses stand at every so manieth picture, and so much enlarged.
const EVERY: usize = 5;
const ENLARGED: f64 = 5.0;

/// The directions of the first picture, and nothing else.
pub fn bearings(chapter: &mut Chapter) {
    let camera = &recording().flight.camera;
    let (places, pixels) = seen(0);
    let in_camera: Vec<Vector3<f64>> =
        places.iter().map(|place| se3::transform(&camera_from_world(0), place)).collect();
    let off = pixels.iter().zip(&in_camera);
    let off = off.map(|(pixel, place)| bearing(camera, pixel).angle(place));
    let sigma = pixels.iter().map(direction_sigma);
    let across = pixels.iter().zip(&in_camera);
    let across = across.map(|(pixel, place)| direction_sigma(pixel) * place.norm());
    chapter.number("flight_seen", places.len() as f64, "", 0);
    chapter.number("flight_focal", camera.fx, "px", 0);
    chapter.number("flight_noise", recording().flight.pixel_sigma, "px", 1);
    chapter.number("flight_angle", 1e3 * root_mean_square(off), "mrad", 1);
    chapter.number("flight_sigma", 1e3 * root_mean_square(sigma), "mrad", 1);
    chapter.number("flight_across", 100.0 * root_mean_square(across), "cm", 1);
    let depths = || in_camera.iter().map(|place| place.z);
    chapter.number("flight_nearest", depths().fold(f64::INFINITY, f64::min), "m", 1);
    chapter.number("flight_farthest", depths().fold(0.0, f64::max), "m", 1);
    chapter.figure("one_flight", rays);
}

/// The standard deviation of a pixel's direction, across and along the image together, in radians.
fn direction_sigma(pixel: &Vector2<f64>) -> f64 {
    let flight = &recording().flight;
    let ray = back_project(&flight.camera, pixel, 1.0);
    let direction = bearing(&flight.camera, pixel).into_inner();
    let across = (Matrix3::identity() - direction * direction.transpose()) / ray.norm();
    let by_pixel = [across.column(0) / flight.camera.fx, across.column(1) / flight.camera.fy];
    flight.pixel_sigma * by_pixel[0].norm().hypot(by_pixel[1].norm())
}

fn rays() -> Figure {
    let world_from_camera = camera_from_world(0).inverse();
    let (places, pixels) = seen(0);
    let ray = |pixel| {
        let place = |depth: f64| {
            let seen = back_project(&recording().flight.camera, pixel, depth);
            se3::transform(&world_from_camera, &seen)
        };
        let depths = (0..).map(|step| ALONG * f64::from(step));
        let places = depths.take_while(|depth| *depth < FARTHEST).map(place);
        let ends = places.take_while(|place| is_inside(&(place.x, place.y))).last();
        [place(0.0), ends.expect("the flight stays in the room")]
    };
    let rays: Vec<[Vector3<f64>; 2]> = pixels.iter().map(ray).collect();
    let truth = Layer::truth(&camera_path(0.0, ALONE));
    room(&[truth, Layer::landmarks(&places), Layer::rays("directions", 0, &rays)])
}

/// The pose of the first picture among known landmarks, from a start that is far off.
pub fn from_far_off(chapter: &mut Chapter) {
    let iterates = iterates();
    let off = |at: usize| 100.0 * (centre(&iterates[at]) - centre(&camera_from_world(0))).norm();
    chapter.number("flight_turned", TURNED, "°", 0);
    chapter.number("flight_moved", MOVED, "m", 0);
    chapter.number("flight_steps", iterates.len() as f64 - 1.0, "", 0);
    chapter.number("flight_pose", off(iterates.len() - 1), "cm", 1);
    chapter.figure("one_flight", steps);
}

/// Where the camera is after no steps, one, and so on until the search stops.
fn iterates() -> Vec<Isometry3<f64>> {
    let truth = camera_from_world(0);
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), TURNED.to_radians());
    let start = Isometry3::from_parts(Default::default(), turn.into())
        * truth
        * Isometry3::translation(0.0, MOVED, 0.0);
    let mut after = vec![start];
    for most in 1.. {
        let (pose, steps) = adjusted(&start, most);
        after.push(pose);
        if steps < most {
            after.pop();
            break;
        }
    }
    after
}

/// The camera after so many steps at most, and how many there were.
fn adjusted(start: &Isometry3<f64>, max_iterations: usize) -> (Isometry3<f64>, usize) {
    let flight = &recording().flight;
    let mut problem = Problem::new();
    let posed = PosedPinhole { intrinsics: flight.camera, camera_from_world: *start };
    let camera = problem.add_variable(MovingCamera(posed));
    let (places, pixels) = seen(0);
    for (place, pixel) in places.into_iter().zip(pixels) {
        let landmark = problem.add_variable(place);
        problem.hold(landmark).expect("it is the problem's");
        let inverse_sigma = flight.pixel_sigma.recip();
        let factor = PixelByCamera { camera, landmark, pixel, inverse_sigma };
        problem.add_factor(factor, Kernel::Squared).expect("its variables are the problem's");
    }
    let options = Options { max_iterations, ..Options::default() };
    let solution = problem.solve(&options).expect("the start sees the landmarks");
    (solution.values[camera].0.camera_from_world, solution.report.iterations.len())
}

fn steps() -> Figure {
    let places: Vec<Vector3<f64>> = iterates().iter().map(centre).collect();
    room(&[
        Layer::truth(&camera_path(0.0, ALONE)),
        Layer::landmarks(&seen(0).0),
        Layer::line("camera", 0, &places),
        Layer::points("after each step", 0, &places),
    ])
}

/// Each picture alone, among known landmarks.
pub fn alone(chapter: &mut Chapter) {
    let found = each_alone();
    let off = found.iter().enumerate().map(|(picture, (place, _))| {
        100.0 * (place - recording().truth.states[picture].position).norm()
    });
    let sigma = found.iter().map(|(_, covariance)| 100.0 * covariance.trace().sqrt());
    chapter.number("flight_seconds", ALONE, "s", 0);
    chapter.number("flight_error", root_mean_square(off), "cm", 1);
    chapter.number("flight_sigma", root_mean_square(sigma), "cm", 1);
    chapter.figure("one_flight", poses);
}

/// Where the body is by each picture, and the covariance of the camera's place. A picture begins where the one before
/// it ended.
fn each_alone() -> Vec<(Vector3<f64>, Matrix3<f64>)> {
    let flight = &recording().flight;
    let mut pose = camera_from_world(0);
    let pictures = 0..=picture_at(ALONE);
    let alone = pictures.map(|picture| {
        let (places, pixels) = seen(picture);
        let found = resect(&flight.camera, &places, &pixels, flight.pixel_sigma, &pose)
            .expect("every picture shows many landmarks");
        pose = found.camera_from_world;
        let body = pose.inverse() * flight.rig.body_from_camera.inverse();
        // The twist (ρ, φ) moves the centre c by c × φ - ρ.
        let mut by_twist = SMatrix::<f64, 3, 6>::zeros();
        by_twist.fixed_view_mut::<3, 3>(0, 0).copy_from(&-Matrix3::identity());
        by_twist.fixed_view_mut::<3, 3>(0, 3).copy_from(&so3::hat(&centre(&pose)));
        (body.translation.vector, by_twist * found.covariance * by_twist.transpose())
    });
    alone.collect()
}

fn poses() -> Figure {
    let found = each_alone();
    let spreads = found.iter().step_by(EVERY).map(|(place, covariance)| (place, *covariance));
    room(&[
        Layer::truth(path(0.0, ALONE)),
        Layer::line("picture by picture", 0, found.iter().map(|(place, _)| place)),
        Layer::ellipses(ENLARGED, 0, spreads),
    ])
}
