//! Worlds whose truth is known, for experiments. The same seed makes the same scene.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector2, Vector3};

use crate::bundle_adjustment::{Camera, PosedPinhole, TinyBa};
use crate::reprojection::{Pinhole, ReprojFactor};

// ANCHOR: scene
/// What cameras saw of a world, and the truth about it.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The problem: noisy pixels, and a start away from the truth. The first camera is
    /// fixed where it is.
    pub problem: TinyBa<PosedPinhole, 6>,
    /// The cameras as they are.
    pub true_cameras: Vec<PosedPinhole>,
    /// The points as they are, in metres.
    pub true_points: Vec<Vector3<f64>>,
    /// Indices of the observations that are outliers, ascending.
    pub outliers: Vec<usize>,
}
// ANCHOR_END: scene

/// How far the start lies from the truth: standard deviations for the axes of a twist, in
/// metres and radians, and for the coordinates of a point in metres.
const START: (f64, f64, f64) = (0.05, 0.02, 0.1);

/// Focal length 400 px, 640 by 480 pixels.
const INTRINSICS: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };

impl Scene {
    // ANCHOR: ring
    /// Cameras on a circle of 4 m radius, evenly, all looking at its centre, and points in
    /// a cube of 2 m around it. Every camera sees every point. `pixel_sigma` is the standard
    /// deviation of the noise of each coordinate, in pixels. Without noise the solver is
    /// told that it is 1 px.
    pub fn ring(cameras: usize, points: usize, pixel_sigma: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let camera = |k: usize| {
            let (sin, cos) = (TAU * k as f64 / cameras as f64).sin_cos();
            looking(&Vector3::new(4.0 * cos, 4.0 * sin, 0.0), &Vector3::new(-cos, -sin, 0.0))
        };
        let true_cameras: Vec<_> = (0..cameras).map(camera).collect();
        let true_points: Vec<_> =
            (0..points).map(|_| Vector3::from_fn(|_, _| random.uniform(-1.0, 1.0))).collect();
        Self::observed(true_cameras, true_points, |_, _| true, pixel_sigma, &mut random)
    }
    // ANCHOR_END: ring

    // ANCHOR: street
    /// A camera every metre along a street, all looking at the facades on its left, 5 to
    /// 8 m away, with ten points for every camera. A camera sees the points that lie less
    /// than `reach` metres ahead of it or behind.
    pub fn street(cameras: usize, reach: f64, pixel_sigma: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let camera = |k: usize| looking(&Vector3::new(k as f64, 0.0, 0.0), &Vector3::y());
        let true_cameras: Vec<_> = (0..cameras).map(camera).collect();
        let length = cameras.saturating_sub(1) as f64;
        let point = |_| {
            let along = random.uniform(0.0, length);
            Vector3::new(along, random.uniform(5.0, 8.0), random.uniform(-2.0, 2.0))
        };
        let true_points: Vec<_> = (0..10 * cameras).map(point).collect();
        let sees = |camera: &PosedPinhole, point: &Vector3<f64>| {
            (camera.centre().x - point.x).abs() < reach
        };
        Self::observed(true_cameras, true_points, sees, pixel_sigma, &mut random)
    }
    // ANCHOR_END: street

    /// A street that comes back to where it began: a circle with a camera every metre, all looking
    /// at the facades outside, 5 to 8 m away, with ten points for every metre of the way. A camera
    /// sees the points beside the way less than `reach` metres ahead of it or behind.
    pub fn closed_street(cameras: usize, reach: f64, pixel_sigma: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let length = cameras as f64;
        let radius = length / TAU;
        let outward = |along: f64| {
            let (sin, cos) = (along / radius).sin_cos();
            Vector3::new(cos, sin, 0.0)
        };
        let camera = |k: usize| looking(&(radius * outward(k as f64)), &outward(k as f64));
        let true_cameras: Vec<_> = (0..cameras).map(camera).collect();
        let point = |_| {
            let (along, away) = (random.uniform(0.0, length), random.uniform(5.0, 8.0));
            (radius + away) * outward(along) + random.uniform(-2.0, 2.0) * Vector3::z()
        };
        let true_points: Vec<_> = (0..10 * cameras).map(point).collect();
        let sees = |camera: &PosedPinhole, point: &Vector3<f64>| {
            radius * camera.centre().xy().angle(&point.xy()) < reach
        };
        Self::observed(true_cameras, true_points, sees, pixel_sigma, &mut random)
    }

    // ANCHOR: stereo_ring
    /// The [`Scene::ring`] with a second camera on each rig, `baseline` metres to the right
    /// of the first. Camera 2k and camera 2k + 1 are on rig k.
    pub fn stereo_ring(
        rigs: usize,
        points: usize,
        baseline: f64,
        pixel_sigma: f64,
        seed: u64,
    ) -> Self {
        let mono = Self::ring(rigs, points, pixel_sigma, seed);
        let right_from_left = Isometry3::translation(-baseline, 0.0, 0.0);
        let pair = |left: &PosedPinhole| {
            let camera_from_world = right_from_left * left.camera_from_world;
            [*left, PosedPinhole { camera_from_world, ..*left }]
        };
        let true_cameras: Vec<_> = mono.true_cameras.iter().flat_map(pair).collect();
        let mut random = Random::new(seed ^ 1);
        let all = |_: &PosedPinhole, _: &Vector3<f64>| true;
        let mut scene =
            Self::observed(true_cameras, mono.true_points, all, pixel_sigma, &mut random);
        scene.problem.cameras = mono.problem.cameras.iter().flat_map(pair).collect();
        scene.problem.rig = (0..2 * rigs).map(|camera| camera / 2).collect();
        scene.problem.fixed = (0..2 * rigs).map(|camera| camera < 2).collect();
        scene
    }
    // ANCHOR_END: stereo_ring

    /// The scene with its start so many times as far from the truth.
    pub fn with_start(mut self, times: f64) -> Self {
        for (camera, truth) in self.problem.cameras.iter_mut().zip(&self.true_cameras) {
            *camera = truth.retract(&(times * truth.local(camera)));
        }
        for (point, truth) in self.problem.points.iter_mut().zip(&self.true_points) {
            *point = truth.lerp(point, times);
        }
        self
    }

    // ANCHOR: outliers
    /// The scene with this fraction of its observations moved by so many pixels, each in a
    /// direction of its own.
    pub fn with_outliers(mut self, fraction: f64, pixels: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        for (index, factor) in self.problem.factors.iter_mut().enumerate() {
            if random.uniform(0.0, 1.0) < fraction {
                let (sin, cos) = random.uniform(0.0, TAU).sin_cos();
                factor.pixel += pixels * Vector2::new(cos, sin);
                self.outliers.push(index);
            }
        }
        self.outliers.sort_unstable();
        self.outliers.dedup();
        self
    }
    // ANCHOR_END: outliers

    // ANCHOR: observed
    /// The scene in which each camera sees the points that it sees.
    fn observed(
        true_cameras: Vec<PosedPinhole>,
        true_points: Vec<Vector3<f64>>,
        sees: impl Fn(&PosedPinhole, &Vector3<f64>) -> bool,
        pixel_sigma: f64,
        random: &mut Random,
    ) -> Self {
        let inverse_sigma = if pixel_sigma > 0.0 { 1.0 / pixel_sigma } else { 1.0 };
        let mut factors = Vec::new();
        for (point, position) in true_points.iter().enumerate() {
            for (camera, true_camera) in true_cameras.iter().enumerate() {
                let pixel = true_camera.project(position).filter(|_| sees(true_camera, position));
                factors.extend(pixel.map(|pixel| {
                    let noise = Vector2::from_fn(|_, _| random.normal(pixel_sigma));
                    ReprojFactor { keyframe: camera, point, pixel: pixel + noise, inverse_sigma }
                }));
            }
        }
        let problem = Self::start(&true_cameras, &true_points, factors, random);
        Self { problem, true_cameras, true_points, outliers: Vec::new() }
    }
    // ANCHOR_END: observed

    /// The problem that starts away from the truth, except for the first camera.
    fn start(
        cameras: &[PosedPinhole],
        points: &[Vector3<f64>],
        factors: Vec<ReprojFactor>,
        random: &mut Random,
    ) -> TinyBa<PosedPinhole, 6> {
        let (metres, radians, point_metres) = START;
        let mut moved = cameras.to_vec();
        for camera in moved.iter_mut().skip(1) {
            let sigma = |axis| if axis < 3 { metres } else { radians };
            *camera = camera.retract(&nalgebra::Vector6::from_fn(|i, _| random.normal(sigma(i))));
        }
        let points =
            points.iter().map(|p| p + Vector3::from_fn(|_, _| random.normal(point_metres)));
        let mut problem = TinyBa::new(moved, points.collect(), factors);
        problem.fixed.iter_mut().take(1).for_each(|fixed| *fixed = true);
        problem
    }
}

/// The camera at a place that looks in a horizontal direction of length one, upright.
fn looking(centre: &Vector3<f64>, forward: &Vector3<f64>) -> PosedPinhole {
    let right = forward.cross(&Vector3::z());
    let down = forward.cross(&right);
    let rows = [right.transpose(), down.transpose(), forward.transpose()];
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows));
    let translation = -(rotation * centre);
    let camera_from_world = Isometry3::from_parts(translation.into(), rotation.into());
    PosedPinhole { intrinsics: INTRINSICS, camera_from_world }
}

/// A source of random numbers that depends on nothing but its seed: SplitMix64.
struct Random(u64);

impl Random {
    /// Neighbouring seeds are far apart in the sequence.
    fn new(seed: u64) -> Self {
        let mut random = Self(seed);
        random.0 = random.bits();
        random
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn uniform(&mut self, from: f64, to: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        from + (to - from) * unit
    }

    /// By the method of Box and Muller.
    fn normal(&mut self, sigma: f64) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform(0.0, 1.0)).ln()).sqrt();
        sigma * radius * self.uniform(0.0, TAU).cos()
    }
}

/// An estimate's cameras, grown about the first of the true ones until the sum of squares of what
/// is left of their positions' errors is least: single cameras do not know the scale. The
/// lists belong together, camera by camera.
pub fn at_true_scale(estimate: &[PosedPinhole], truth: &[PosedPinhole]) -> Vec<PosedPinhole> {
    let Some(first) = truth.first() else { return estimate.to_vec() };
    let fixed = first.centre();
    let (mut product, mut square) = (0.0, 0.0);
    for (estimated, true_camera) in estimate.iter().zip(truth) {
        let arm = estimated.centre() - fixed;
        product += arm.dot(&(true_camera.centre() - fixed));
        square += arm.norm_squared();
    }
    let scale = if square > 0.0 { product / square } else { 1.0 };
    let grown = |camera: &PosedPinhole| {
        let centre = fixed + scale * (camera.centre() - fixed);
        let rotation = camera.camera_from_world.rotation;
        let translation = -(rotation * centre);
        let camera_from_world = Isometry3::from_parts(translation.into(), rotation);
        PosedPinhole { camera_from_world, ..*camera }
    };
    estimate.iter().map(grown).collect()
}
