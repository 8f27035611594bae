//! A camera that passes a landmark, for the tests of a track and what it costs.

use nalgebra::{Isometry3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use vislam::inertial::BodyPose;
use vislam::least_squares::Manifold;
use vislam::manifold::so3;
use vislam::msckf::Sight;
use vislam::reprojection::Pinhole;

pub const CAMERA: Pinhole = Pinhole { fx: 300.0, fy: 300.0, cx: 320.0, cy: 240.0 };
pub const SIGMA: f64 = 1.5;
/// The least angle between two rays, in radians.
pub const PARALLAX: f64 = 1e-3;

pub fn normal(random: &mut ChaCha8Rng) -> f64 {
    random.sample(StandardNormal)
}

/// A camera that passes a landmark, and where it sits on the body.
pub fn pass(poses: usize, seed: u64) -> (Vec<Sight>, Isometry3<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let draw = &mut random;
    let body_from_camera =
        Isometry3::new(Vector3::new(0.1, -0.05, 0.02), Vector3::new(0.02, -0.03, 0.05));
    let landmark = Vector3::new(0.4, -0.3, 5.0);
    let sight = |k: usize| {
        let along = 2.0 * k as f64 / (poses - 1) as f64 - 1.0;
        let turn = Vector3::from_fn(|_, _| 0.05 * normal(draw));
        let pose = BodyPose {
            world_from_body: so3::exp(&turn),
            position: Vector3::new(along, 0.2 * along * along, 0.3 * along)
                + Vector3::from_fn(|_, _| 0.02 * normal(draw)),
        };
        let world_from_camera = pose.at_rest().pose() * body_from_camera;
        let seen = CAMERA.project(&world_from_camera.inverse(), &landmark).unwrap();
        let pixel = seen + Vector2::from_fn(|_, _| SIGMA * normal(draw));
        // The filter has the poses a little off.
        let off: Vec<f64> = (0..6).map(|_| 0.003 * normal(draw)).collect();
        let pose = pose.retract(&off);
        Sight { pose, linearized_at: pose, pixel }
    };
    ((0..poses).map(sight).collect(), body_from_camera)
}
