//! Scenes that several chapters look at.

use nalgebra::{Isometry3, Point3, Rotation3, Vector2, Vector3};
use vislam::reprojection::{Pinhole, ReprojFactor};

use crate::random::Random;

const CAMERAS: usize = 8;
const POINTS: usize = 40;
/// Metres from the axis of the ring to each camera, and along it to the middle of the points.
const RADIUS: f64 = 1.5;
const DISTANCE: f64 = 6.0;
/// Half the side of the cube that holds the points, in metres.
const CUBE: f64 = 1.5;

/// Eight cameras on a circle that look at the middle of forty points in a cube before them; all see
/// all.
#[derive(Clone)]
pub struct Ring {
    pub camera: Pinhole,
    /// Camera from world, for each camera.
    pub poses: Vec<Isometry3<f64>>,
    /// In the world, in metres.
    pub points: Vec<Vector3<f64>>,
    /// What was measured, camera by camera.
    pub factors: Vec<ReprojFactor>,
}

impl Ring {
    /// The ring with noise of `noise` pixels, whitened as if it were one pixel. The axis of the
    /// ring is the world's z axis.
    pub fn new(noise: f64) -> Self {
        let camera = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };
        let mut random = Random::new(40);
        let middle = Vector3::new(0.0, 0.0, DISTANCE);
        let mut coordinate = || random.uniform(-CUBE..CUBE);
        let mut point = || middle + Vector3::from_fn(|_, _| coordinate());
        let points: Vec<_> = (0..POINTS).map(|_| point()).collect();
        let poses: Vec<_> = (0..CAMERAS).map(|index| looking_at(&middle, index)).collect();
        let mut random = Random::new(41);
        let mut factors = Vec::new();
        for (keyframe, pose) in poses.iter().enumerate() {
            for (point, place) in points.iter().enumerate() {
                let seen = camera.project(pose, place).expect("all cameras see all points");
                let error = Vector2::new(random.normal(noise), random.normal(noise));
                let factor = ReprojFactor::new(keyframe, point, seen + error, 1.0);
                factors.push(factor.expect("the scene is finite"));
            }
        }
        Self { camera, poses, points, factors }
    }

    /// The same ring with the same pictures, described in a world frame that is turned.
    pub fn in_world(&self, new_from_old: &Rotation3<f64>) -> Self {
        let old_from_new = Isometry3::from_parts(Default::default(), new_from_old.inverse().into());
        Self {
            camera: self.camera,
            poses: self.poses.iter().map(|pose| pose * old_from_new).collect(),
            points: self.points.iter().map(|point| new_from_old * point).collect(),
            factors: self.factors.clone(),
        }
    }
}

/// Camera from world of the camera with this index, which looks at a point of the world.
fn looking_at(target: &Vector3<f64>, index: usize) -> Isometry3<f64> {
    let (sine, cosine) = (std::f64::consts::TAU * index as f64 / CAMERAS as f64).sin_cos();
    let centre = RADIUS * Vector3::new(cosine, sine, 0.0);
    let forward = (target - centre).normalize();
    // The shortest turn from the world's z axis to the view.
    let world_from_camera =
        Rotation3::rotation_between(&Vector3::z(), &forward).expect("no camera looks backwards");
    let pose = Isometry3::from_parts(Point3::from(centre).into(), world_from_camera.into());
    pose.inverse()
}
