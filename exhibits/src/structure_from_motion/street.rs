//! A street with cameras along it.

use std::sync::OnceLock;

use nalgebra::{Isometry3, Rotation3, Vector2, Vector3};
use vislam::manifold::se3;
use vislam::observability::Similarity;
use vislam::reprojection::Pinhole;
use vislam::structure_from_motion::{
    Adjustments, GROWTH, LEAST_SEEN, Picture, PictureMatch, Reconstruction, ReconstructionOptions,
    ScaleFreedom, absolute_orientation, reconstruct,
};

use crate::chapter::Chapter;
use crate::random::Random;

const CAMERA: Pinhole = Pinhole { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0 };
/// Metres between two pictures.
const APART: f64 = 1.2;

/// Pictures of a street, and what is true of them.
pub struct Street {
    pub poses: Vec<Isometry3<f64>>,
    pub points: Vec<Vector3<f64>>,
    pub pictures: Vec<Picture>,
    /// For each picture and keypoint the point that it shows.
    pub shown: Vec<Vec<usize>>,
    pub matches: Vec<PictureMatch>,
}

/// Cameras that look sideways along a bent street, at points 2 to 8 m away.
pub fn street(count: usize, points: usize, random: &mut Random) -> Street {
    let length = APART * count as f64;
    let at =
        |x: f64| Vector3::new(x, 0.0, 0.1 * length * (std::f64::consts::TAU * x / length).sin());
    let pose = |k: usize| Isometry3::from_parts((-at(APART * k as f64)).into(), Default::default());
    let poses: Vec<Isometry3<f64>> = (0..count).map(pose).collect();
    let points: Vec<Vector3<f64>> = (0..points)
        .map(|_| {
            let x = random.uniform(-2.0..length + 2.0);
            at(x) + Vector3::new(0.0, random.uniform(-2.0..2.0), random.uniform(2.0..8.0))
        })
        .collect();
    let (mut pictures, mut shown) = (Vec::new(), Vec::new());
    for pose in &poses {
        let (mut keypoints, mut of) = (Vec::new(), Vec::new());
        for (index, point) in points.iter().enumerate() {
            let is_inside = |pixel: &Vector2<f64>| {
                (0.0..640.0).contains(&pixel.x) && (0.0..480.0).contains(&pixel.y)
            };
            if let Some(pixel) = CAMERA.project(pose, point).filter(is_inside) {
                keypoints.push(pixel + Vector2::new(random.normal(1.0), random.normal(1.0)));
                of.push(index);
            }
        }
        pictures.push(Picture { camera: CAMERA, keypoints });
        shown.push(of);
    }
    let mut matches = Vec::new();
    for (b, of_b) in shown.iter().enumerate() {
        for (a, of_a) in shown[..b].iter().enumerate() {
            for (j, point) in of_b.iter().enumerate() {
                if let Ok(i) = of_a.binary_search(point) {
                    matches.push(PictureMatch { pictures: [a, b], keypoints: [i, j] });
                }
            }
        }
    }
    Street { poses, points, pictures, shown, matches }
}

impl Street {
    /// Mixes in matches at random: `share` of all are wrong then.
    pub fn with_wrong(mut self, share: f64, random: &mut Random) -> Self {
        let right = self.matches.len();
        let count = (right as f64 * share / (1.0 - share)) as usize;
        let mut below = |count: usize| random.uniform(0.0..count as f64) as usize;
        for _ in 0..count {
            let pictures = self.matches[below(right)].pictures;
            let keypoints = pictures.map(|at| below(self.shown[at].len()));
            let [i, j] = [0, 1].map(|side| self.shown[pictures[side]][keypoints[side]]);
            if i != j {
                self.matches.push(PictureMatch { pictures, keypoints });
            }
        }
        self
    }

    /// The share of points seen twice or more whose keypoints are a track, all of them and no other.
    pub fn whole(&self, tracks: &[Vec<[usize; 2]>]) -> f64 {
        let mut views = vec![0; self.points.len()];
        self.shown.iter().flatten().for_each(|point| views[*point] += 1);
        let shown = |[picture, keypoint]: &[usize; 2]| self.shown[*picture][*keypoint];
        let is_whole = |track: &&Vec<[usize; 2]>| {
            let point = shown(&track[0]);
            track.len() == views[point] && track.iter().all(|one| shown(one) == point)
        };
        let whole = tracks.iter().filter(is_whole).count();
        whole as f64 / views.iter().filter(|views| **views > 1).count() as f64
    }

    /// A map of it, and the similarity that lays its cameras upon the true ones.
    fn map(&self, adjustments: Adjustments) -> (Reconstruction, Similarity) {
        let options = ReconstructionOptions { adjustments, ..Default::default() };
        let found = reconstruct(&self.pictures, &self.matches, &options).expect("a beginning");
        let both = found.cameras.iter().zip(&self.poses);
        let pairs: Vec<_> = both
            .filter_map(|(own, truth)| Some((centre(own.as_ref().ok()?), centre(truth))))
            .collect();
        let laid = absolute_orientation(&pairs, ScaleFreedom::Free).expect("a bent street");
        (found, laid)
    }

    /// How far each camera is from where it is, in metres, with the first two laid upon the truth.
    fn off(&self, found: &Reconstruction) -> Vec<f64> {
        let own = |k: usize| found.cameras[k].as_ref().expect("registered");
        let from_first = |pose: &Isometry3<f64>, first: &Isometry3<f64>| first * pose.inverse();
        let place = |k: usize| from_first(own(k), own(0)).translation.vector;
        let truth = |k: usize| from_first(&self.poses[k], &self.poses[0]).translation.vector;
        let scale = truth(BEGIN).norm() / place(BEGIN).norm();
        let turn = Rotation3::rotation_between(&place(BEGIN), &truth(BEGIN)).expect("apart");
        (0..self.poses.len()).map(|k| (scale * (turn * place(k)) - truth(k)).norm()).collect()
    }
}

/// The first few cameras say how the map lies.
const BEGIN: usize = 4;

pub fn centre(camera_from_world: &Isometry3<f64>) -> Vector3<f64> {
    se3::transform(&camera_from_world.inverse(), &Vector3::zeros())
}

pub const ADJUSTMENTS: [(&str, Adjustments); 3] = [
    ("no adjustment", Adjustments::None),
    ("near cameras", Adjustments::Local),
    ("near ones, and all", Adjustments::LocalAndGlobal),
];

/// A street with its map.
pub struct Shown {
    pub street: Street,
    pub found: Reconstruction,
    pub laid: Similarity,
    /// For each kind of adjustment how far each camera is off, in metres.
    pub off: [Vec<f64>; 3],
}

const SHOWN: usize = 40;

pub fn shown() -> &'static Shown {
    static ONCE: OnceLock<Shown> = OnceLock::new();
    ONCE.get_or_init(|| {
        let mut random = Random::new(9);
        let street = street(SHOWN, 1500, &mut random).with_wrong(0.2, &mut random);
        let off = ADJUSTMENTS.map(|(_, kind)| street.off(&street.map(kind).0));
        let (found, laid) = street.map(Adjustments::LocalAndGlobal);
        Shown { street, found, laid, off }
    })
}

pub fn numbers(chapter: &mut Chapter) {
    let Shown { street, found, off, .. } = shown();
    chapter.number("street_cameras", SHOWN as f64, "", 0);
    chapter.number("street_metres", APART * (SHOWN - 1) as f64, "m", 0);
    chapter.number("street_matches", street.matches.len() as f64, "", 0);
    chapter.number("begin", BEGIN as f64, "", 0);
    chapter.number("least_seen", LEAST_SEEN as f64, "", 0);
    chapter.number("growth", 100.0 * (GROWTH - 1.0), "%", 0);
    chapter.number("street_points", found.points.len() as f64, "", 0);
    chapter.number("street_kept", found.verified.verified_matches as f64, "", 0);
    let largest = |way: usize| off[way].iter().copied().fold(0.0, f64::max);
    chapter.number("off_none", largest(0), "m", 1);
    chapter.number("off_local", 100.0 * largest(1), "cm", 0);
    chapter.number("off_global", 100.0 * largest(2), "cm", 0);
}
