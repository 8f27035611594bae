//! What a filter and what stereo pictures say of two keyframes.

use nalgebra::{DMatrix, Isometry3, Matrix6, Rotation3, Vector3};
use vislam::filtering::Belief;
use vislam::inertial::BodyPose;
use vislam::loop_closure::{LoopClosureError, RelativeMeasurement, StereoPixels};
use vislam::manifold::se3;
use vislam::reprojection::Pinhole;
use vislam::two_views::StereoPinhole;

use crate::simulated::Draws;

const SIGMA: f64 = 0.5;

fn camera() -> StereoPinhole {
    let camera = Pinhole { fx: 250.0, fy: 250.0, cx: 320.0, cy: 240.0 };
    StereoPinhole::new(camera, 0.3).unwrap()
}

/// The camera looks along the body's first axis, a little off its origin.
fn body_from_camera() -> Isometry3<f64> {
    let axes = [-Vector3::y(), -Vector3::z(), Vector3::x()];
    let rotation = Rotation3::from_basis_unchecked(&axes);
    Isometry3::from_parts(Vector3::new(0.1, 0.05, -0.02).into(), rotation.into())
}

/// How two keyframes stand to each other, and what both saw of so many landmarks.
fn scene(
    landmarks: usize,
    noise: f64,
    draws: &mut Draws,
) -> (Isometry3<f64>, Vec<[Vector3<f64>; 2]>) {
    let second = se3::exp(&draws.twist(0.3, 0.05));
    let mut seen = |body: &Isometry3<f64>, point: &Vector3<f64>| {
        let camera_from_world = (body * body_from_camera()).inverse();
        let exact = camera().project_with_jacobians(&camera_from_world, point).unwrap();
        exact.observation + noise * Vector3::from_fn(|_, _| draws.number())
    };
    let place = |number: usize| {
        let turn = number as f64;
        let (y, z) = (4.0 * (2.4 * turn).sin(), 2.0 * (1.7 * turn).cos());
        Vector3::new(5.0 + 3.0 * (0.9 * turn).sin(), y, z)
    };
    let sight =
        |number: usize| [Isometry3::identity(), second].map(|body| seen(&body, &place(number)));
    let sights = (0..landmarks).map(sight).collect();
    (second, sights)
}

fn measured(
    sights: &[[Vector3<f64>; 2]],
) -> Result<RelativeMeasurement<Isometry3<f64>, 6>, LoopClosureError> {
    let pixels = StereoPixels { camera: camera(), sigma: SIGMA, least_disparity: 3.0 };
    RelativeMeasurement::from_stereo(pixels, &body_from_camera(), sights, [4, 9])
}

#[test]
fn perfect_stereo_pixels_say_exactly_how_two_bodies_stand() {
    let (second, sights) = scene(20, 0.0, &mut Draws::new(1));
    let seen = measured(&sights).unwrap();
    assert_eq!([seen.first, seen.second], [4, 9]);
    assert!(se3::local(&seen.measured, &second).norm() < 1e-8);
}

#[test]
fn the_errors_of_stereo_loops_are_as_large_as_they_say() {
    let mut draws = Draws::new(2);
    let runs = 200;
    let square = |_| {
        let (second, sights) = scene(40, SIGMA, &mut draws);
        let seen = measured(&sights).unwrap();
        let error = se3::local(&seen.measured, &second);
        error.dot(&(seen.information * error))
    };
    let mean = (0..runs).map(square).sum::<f64>() / f64::from(runs);
    // The mean of so many has a standard deviation of a quarter.
    assert!((5.0..7.0).contains(&mean), "{mean}");
}

#[test]
fn too_few_landmarks_say_nothing_in_all_directions() {
    let (_, sights) = scene(2, 0.0, &mut Draws::new(3));
    assert_eq!(measured(&sights).unwrap_err(), LoopClosureError::Unsure { first: 4, second: 9 });
    let (_, mut sights) = scene(20, 0.0, &mut Draws::new(3));
    // Pixels of the right camera that are those of the left one are infinitely far away.
    sights.iter_mut().flatten().for_each(|seen| seen.z = seen.x);
    assert!(measured(&sights).is_err());
}

#[test]
fn an_error_that_two_poses_share_is_none_between_them() {
    let mut belief = Belief::new();
    let start = BodyPose { world_from_body: Rotation3::identity(), position: Vector3::zeros() };
    let first = belief.add(start, &DMatrix::identity(6, 6)).unwrap();
    let second = belief.clone_variable(first).unwrap();
    // A copy stands exactly where the first one does, wherever that is.
    let seen = RelativeMeasurement::believed(&belief, [first, second], [0, 1]);
    assert_eq!(seen.unwrap_err(), LoopClosureError::Unsure { first: 0, second: 1 });
    let little = 1e-4 * DMatrix::<f64>::identity(6, 6);
    let noisy = belief.add_function(start, &DMatrix::identity(6, 12), &little).unwrap();
    let seen = RelativeMeasurement::believed(&belief, [first, noisy], [0, 1]).unwrap();
    assert!((seen.information - 1e4 * Matrix6::<f64>::identity()).amax() < 1e-3);
    // Keys from before others were dropped name nothing any more.
    belief.keep(&[second.index(), noisy.index()]).unwrap();
    let seen = RelativeMeasurement::believed(&belief, [second, noisy], [0, 1]);
    assert_eq!(seen.unwrap_err(), LoopClosureError::Unsure { first: 0, second: 1 });
}

#[test]
fn a_sight_that_is_not_finite_is_named_by_its_place_among_all() {
    let (_, mut sights) = scene(20, 0.0, &mut Draws::new(1));
    sights[0][0].z = sights[0][0].x;
    for broken in [Vector3::new(330.0, f64::NAN, 320.0), Vector3::new(f64::NAN, 240.0, 320.0)] {
        sights[1] = [broken; 2];
        let refused = measured(&sights).unwrap_err().to_string();
        assert!(refused.contains("point 1:"), "{refused}");
    }
}
