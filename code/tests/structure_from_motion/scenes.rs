//! Simulated pictures whose truth is known.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::reprojection::Pinhole;
use vislam::structure_from_motion::{
    Picture, PictureMatch, Reconstruction, ScaleFreedom, absolute_orientation,
};

pub const CAMERA: Pinhole = Pinhole { fx: 500.0, fy: 510.0, cx: 320.0, cy: 240.0 };

pub fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Pictures, and what is true of them.
#[derive(Clone)]
pub struct Scene {
    pub poses: Vec<Isometry3<f64>>,
    pub pictures: Vec<Picture>,
    /// For each picture and keypoint the point that it shows.
    pub shown: Vec<Vec<usize>>,
    pub matches: Vec<PictureMatch>,
}

/// A pose at a place, with the camera looking towards another one.
pub fn looking(from: Vector3<f64>, towards: Vector3<f64>) -> Isometry3<f64> {
    let down = Vector3::new(0.0, 1.0, 0.0);
    // nalgebra's `look_at_rh` looks along −z with y up.
    let turned = Isometry3::look_at_rh(&Point3::from(from), &Point3::from(towards), &-down);
    let flip = UnitQuaternion::from_scaled_axis(std::f64::consts::PI * Vector3::x());
    Isometry3::from_parts(nalgebra::Translation3::identity(), flip) * turned
}

/// Cameras on an arc of 60 degrees, at a distance of 8 from what they look at.
pub fn arc(count: usize) -> Vec<Isometry3<f64>> {
    let angle = |k: usize| (-30.0 + 60.0 * k as f64 / (count - 1) as f64).to_radians();
    let place = |k: usize| {
        Vector3::new(8.0 * angle(k).sin(), 0.4 * (1.7 * k as f64).sin(), -8.0 * angle(k).cos())
    };
    (0..count).map(|k| looking(place(k), Vector3::zeros())).collect()
}

/// Points in a ball of radius 3.
pub fn ball(count: usize, random: &mut ChaCha8Rng) -> Vec<Vector3<f64>> {
    let mut points = Vec::new();
    while points.len() < count {
        let point = Vector3::from_fn(|_, _| random.random_range(-3.0..3.0));
        if point.norm() < 3.0 {
            points.push(point);
        }
    }
    points
}

/// Cameras that look sideways along a bent street of 1.2 for each, at points 2 to 8 away.
pub fn street(count: usize, points: usize, random: &mut ChaCha8Rng) -> Scene {
    let length = 1.2 * count as f64;
    let bend = |x: f64| 0.1 * length * (std::f64::consts::TAU * x / length).sin();
    let at = |x: f64| Vector3::new(x, 0.0, bend(x));
    let pose = |k: usize| looking(at(1.2 * k as f64), at(1.2 * k as f64) + Vector3::z());
    let points: Vec<Vector3<f64>> = (0..points)
        .map(|_| {
            let mut within = |low: f64, high: f64| random.random_range(low..high);
            let x = within(-2.0, length + 4.0);
            at(x) + Vector3::new(0.0, within(-2.0, 2.0), within(2.0, 8.0))
        })
        .collect();
    scene((0..count).map(pose).collect(), &points, 1.0, random)
}

/// What cameras see of points, with noise, and all matches.
pub fn scene(
    poses: Vec<Isometry3<f64>>,
    points: &[Vector3<f64>],
    sigma: f64,
    random: &mut ChaCha8Rng,
) -> Scene {
    let (mut pictures, mut shown) = (Vec::new(), Vec::new());
    for pose in &poses {
        let (mut keypoints, mut of) = (Vec::new(), Vec::new());
        for (index, point) in points.iter().enumerate() {
            let is_inside = |pixel: &Vector2<f64>| {
                (0.0..640.0).contains(&pixel.x) && (0.0..480.0).contains(&pixel.y)
            };
            if let Some(pixel) = CAMERA.project(pose, point).filter(is_inside) {
                let mut normal = || -> f64 { StandardNormal.sample(random) };
                keypoints.push(pixel + sigma * Vector2::new(normal(), normal()));
                of.push(index);
            }
        }
        pictures.push(Picture { camera: CAMERA, keypoints });
        shown.push(of);
    }
    let mut scene = Scene { poses, pictures, shown, matches: Vec::new() };
    scene.matches = scene.right_matches();
    scene
}

impl Scene {
    pub fn right_matches(&self) -> Vec<PictureMatch> {
        let mut matches = Vec::new();
        for (b, of_b) in self.shown.iter().enumerate() {
            for (a, of_a) in self.shown[..b].iter().enumerate() {
                for (j, point) in of_b.iter().enumerate() {
                    if let Ok(i) = of_a.binary_search(point) {
                        matches.push(PictureMatch { pictures: [a, b], keypoints: [i, j] });
                    }
                }
            }
        }
        matches
    }

    /// Mixes in matches at random: `share` of all are wrong then.
    pub fn with_wrong(mut self, share: f64, random: &mut ChaCha8Rng) -> Self {
        let count = (self.matches.len() as f64 * share / (1.0 - share)) as usize;
        for _ in 0..count {
            let PictureMatch { pictures, .. } =
                self.matches[random.random_range(0..self.matches.len())];
            let keypoints =
                pictures.map(|at| random.random_range(0..self.pictures[at].keypoints.len()));
            let [i, j] = [0, 1].map(|side| self.shown[pictures[side]][keypoints[side]]);
            if i != j {
                self.matches.push(PictureMatch { pictures, keypoints });
            }
        }
        self
    }

    /// Only the matches that are wanted.
    pub fn only(mut self, is_wanted: impl Fn(&PictureMatch) -> bool) -> Self {
        self.matches.retain(is_wanted);
        self
    }

    /// The largest distance of a camera from where it is, after a similarity.
    pub fn largest_error(&self, found: &Reconstruction) -> f64 {
        let centre = |pose: &Isometry3<f64>| pose.inverse().translation.vector;
        let both = found.cameras.iter().zip(&self.poses);
        let pairs: Vec<_> = both
            .filter_map(|(own, truth)| Some((centre(own.as_ref().ok()?), centre(truth))))
            .collect();
        let similarity = absolute_orientation(&pairs, ScaleFreedom::Free).unwrap();
        pairs.iter().map(|(own, truth)| (similarity.point(own) - truth).norm()).fold(0.0, f64::max)
    }
}

/// Puts a list into another order.
pub fn shuffle<T>(list: &mut [T], random: &mut ChaCha8Rng) {
    for at in (1..list.len()).rev() {
        list.swap(at, random.random_range(0..=at));
    }
}
