//! Noisy pairs of pixels, and what becomes of the depth computed from them.

use nalgebra::Vector3;
use vislam::bearing::{depth_from_disparity, depth_sigma, disparity_sigma};
use vislam::reprojection::Pinhole;

use super::oracle::{image_of, meeting_depth};
use super::worked;
use crate::chapter::Chapter;
use crate::random::Random;
use crate::record::RecordValue;

/// A point seen by two cameras side by side, with independent noise in the two images.
#[derive(Clone, Copy)]
pub struct Pair {
    pub camera: Pinhole,
    pub baseline: f64,
    pub point: Vector3<f64>,
    /// Standard deviation of the pixel in the first image.
    pub first_sigma: f64,
    /// Standard deviation of the pixel in the second image.
    pub second_sigma: f64,
}

impl Pair {
    /// The worked example, with a pixel of noise in each image.
    pub fn worked() -> Self {
        Self {
            camera: worked::CAMERA,
            baseline: worked::BASELINE,
            point: worked::POINT,
            first_sigma: 1.0,
            second_sigma: 1.0,
        }
    }

    /// The worked cameras, looking at a point straight ahead of the first.
    pub fn at_depth(depth: f64) -> Self {
        Self { point: depth * Vector3::z(), ..Self::worked() }
    }

    /// Any cameras and any point, with a pixel of noise in each image.
    pub fn random(random: &mut Random) -> Self {
        let (camera, baseline) = (random.camera(), random.logarithmic(0.05..2.0));
        Self { camera, baseline, point: random.point(0.5..100.0), ..Self::worked() }
    }

    /// Columns of the point in the two images.
    pub fn columns(&self) -> [f64; 2] {
        [0.0, self.baseline].map(|x| image_of(&self.camera, &(self.point - x * Vector3::x())).x)
    }

    /// The derivative by the second column of a function of the depth at which the rays of both
    /// columns meet: a central difference whose step is this part of the disparity.
    pub fn slope(&self, of_depth: fn(f64) -> f64, part: f64) -> f64 {
        let [first, second] = self.columns();
        let step = part * (first - second);
        let at = |second| of_depth(meeting_depth(&self.camera, self.baseline, first, second));
        (at(second + step) - at(second - step)) / (2.0 * step)
    }

    /// Disparities measured again and again, without end.
    pub fn disparities(&self, seed: u64) -> impl Iterator<Item = f64> + use<> {
        let [first, second] = self.columns();
        let (first_sigma, second_sigma) = (self.first_sigma, self.second_sigma);
        let mut random = Random::new(seed);
        std::iter::repeat_with(move || {
            (first + random.normal(first_sigma)) - (second + random.normal(second_sigma))
        })
    }

    /// Inverse depths computed from such disparities, in 1/metre.
    pub fn inverse_depths(&self, seed: u64) -> impl Iterator<Item = f64> + use<> {
        let pixel_metres = self.camera.fx * self.baseline;
        self.disparities(seed).map(move |disparity| disparity / pixel_metres)
    }

    /// Depths computed from such disparities; a point at infinity or beyond is infinitely far.
    pub fn depths(&self, seed: u64) -> impl Iterator<Item = f64> + use<> {
        let (camera, baseline) = (self.camera, self.baseline);
        self.disparities(seed).map(move |disparity| {
            depth_from_disparity(&camera, baseline, disparity).unwrap_or(f64::INFINITY)
        })
    }

    /// Standard deviation of the disparity, in pixels.
    pub fn disparity_sigma(&self) -> f64 {
        disparity_sigma(self.first_sigma, self.second_sigma)
    }

    /// Standard deviation of depth in metres, to first order.
    pub fn depth_sigma(&self) -> f64 {
        depth_sigma(&self.camera, self.baseline, self.point.z, self.disparity_sigma())
    }
}

/// Mean and standard deviation of values that are seen once and not kept.
#[derive(Default)]
pub struct Moments {
    count: f64,
    pub mean: f64,
    squares: f64,
}

impl Moments {
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut moments = Self::default();
        for value in values {
            let from_old_mean = value - moments.mean;
            moments.count += 1.0;
            moments.mean += from_old_mean / moments.count;
            moments.squares += from_old_mean * (value - moments.mean);
        }
        moments
    }

    pub fn deviation(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }
}

/// The value below which `share` of all values lie. Needs at least one value.
pub fn quantile(values: &mut [f64], share: f64) -> f64 {
    let index = (share * (values.len() - 1) as f64).round() as usize;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

const RECORD_DRAWS: usize = 10_000_000;
const RECORD_SEED: u64 = 7;

/// Registers the record of the worked example under noise.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("draws", RECORD_DRAWS.to_string()),
        ("seed", RECORD_SEED.to_string()),
        ("pixel_sigma", "1".to_owned()),
    ];
    chapter.record("disparity_noise", inputs, disparity_noise);
}

fn disparity_noise() -> Vec<RecordValue> {
    let both = Pair::worked();
    let first_only = Pair { second_sigma: 0.0, ..Pair::worked() };
    let moments_of_depth = |pair: &Pair| Moments::of(pair.depths(RECORD_SEED).take(RECORD_DRAWS));
    let disparity = Moments::of(both.disparities(RECORD_SEED).take(RECORD_DRAWS));
    let depth = moments_of_depth(&both);
    let depth_of_first_only = moments_of_depth(&first_only);
    let value = |name, value, unit, decimals| RecordValue::new(name, value, unit, decimals, 1e-9);
    vec![
        value("draws", RECORD_DRAWS as f64, "", 0),
        value("ratio", disparity.deviation() / both.first_sigma, "", 3),
        value("depth_sigma_first_only", depth_of_first_only.deviation(), "m", 3),
        value("depth_sigma_both", depth.deviation(), "m", 3),
        value("depth_bias_mm", 1e3 * (depth.mean - both.point.z), "mm", 1),
    ]
}
