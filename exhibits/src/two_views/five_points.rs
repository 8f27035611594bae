//! All motions that five correspondences allow, looked for by Newton's method from many starts.

use std::sync::OnceLock;

use nalgebra::{
    Const, Isometry3, Matrix3, Matrix5, Quaternion, SMatrix, UnitQuaternion, Vector2, Vector3,
    Vector4, Vector5,
};
use vislam::bearing::bearing;
use vislam::manifold::so3;
use vislam::two_views::{essential_matrix, fundamental_matrix, relative_pose, sampson_distance};

use super::worked::CAMERA;
use crate::random::Random;

/// How many scenes are looked at.
pub const SCENES: usize = 25;
/// Pixels of noise in the scenes that have any.
pub const NOISE: f64 = 0.5;
/// Starts of Newton's method in each scene.
pub const STARTS: usize = 500;
/// Pairs that are asked which solution is right, where not only the sixth one is.
pub const JUDGES: usize = 20;
/// Entries of two essential matrices of length one differ by more than this, or they are one.
const SAME: f64 = 1e-5;

/// Points seen by two cameras: five to solve with and some to ask afterwards.
pub struct Scene {
    truth: Isometry3<f64>,
    /// In the first and in the second image.
    pixels: Vec<(Vector2<f64>, Vector2<f64>)>,
}

/// An essential matrix that five correspondences satisfy.
pub struct Solution {
    /// Whether one of its four motions puts all five points in front of both cameras.
    pub in_front: bool,
    /// By how many pixels the sixth pair misses it.
    pub sixth: f64,
    /// Root of the mean squared miss of all pairs that were not used.
    pub all_others: f64,
    /// Distance to the true matrix, of lengths one and up to sign.
    pub error: f64,
}

/// All solutions that were found.
pub struct Found {
    /// The one nearest to the truth first.
    pub solutions: Vec<Solution>,
    /// After how many starts the last of them was found.
    pub last_start: usize,
}

impl Found {
    /// How many have all five points in front.
    pub fn in_front(&self) -> usize {
        self.solutions.iter().filter(|solution| solution.in_front).count()
    }

    /// The smallest miss of the sixth pair by a wrong solution with all five points in front.
    pub fn best_wrong(&self) -> Option<f64> {
        let wrong = self.solutions[1..].iter().filter(|solution| solution.in_front);
        wrong.map(|solution| solution.sixth).reduce(f64::min)
    }
}

impl Scene {
    /// A random scene without noise, all of it on one slanted plane.
    pub fn on_plane(seed: u64) -> Self {
        Self::of(seed, 0.0, |point| point * (5.0 / Vector3::new(0.3, 0.2, 1.0).dot(&point)))
    }

    fn of(seed: u64, sigma: f64, place: fn(Vector3<f64>) -> Vector3<f64>) -> Self {
        let mut random = Random::new(700 + seed);
        let truth =
            Isometry3::from_parts(random.direction(1.0).into(), random.rotation(0.4).into());
        let mut points = Vec::new();
        while points.len() < 5 + JUDGES {
            let point = place(random.point(3.0..8.0));
            let second = truth.rotation * point + truth.translation.vector;
            if second.z > 1.0 {
                points.push((point, second));
            }
        }
        let mut noisy = |point: &Vector3<f64>| {
            let pixel = CAMERA.project_cam(point).unwrap_or(super::NOWHERE);
            pixel + Vector2::new(random.normal(sigma), random.normal(sigma))
        };
        let pixels = points.iter().map(|(first, second)| (noisy(first), noisy(second))).collect();
        Self { truth, pixels }
    }

    /// How many directions the linear equations of all pairs leave free.
    pub fn free_directions(&self) -> usize {
        let products = self.directions().into_iter().map(|(first, second)| {
            // One row of the linear equations for the nine entries, times its own transpose.
            let row = (second * first.transpose()).reshape_generic(Const::<9>, Const::<1>);
            row * row.transpose()
        });
        let sum: SMatrix<f64, 9, 9> = products.sum();
        let eigenvalues = sum.symmetric_eigenvalues();
        eigenvalues.iter().filter(|value| **value < 1e-12 * eigenvalues.max()).count()
    }

    fn directions(&self) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let direction = |pixel| bearing(&CAMERA, pixel).into_inner();
        self.pixels.iter().map(|(first, second)| (direction(first), direction(second))).collect()
    }

    /// Everything that Newton's method finds.
    pub fn solutions(&self) -> Found {
        let directions = self.directions();
        let five: [_; 5] = std::array::from_fn(|index| directions[index]);
        let mut random = Random::new(900);
        let (mut found, mut last_start): (Vec<Matrix3<f64>>, usize) = (Vec::new(), 0);
        for start in 0..STARTS {
            let Some(essential) = newton(&five, &mut random) else { continue };
            if found.iter().all(|known| distance(known, &essential) > SAME) {
                found.push(essential);
                last_start = start;
            }
        }
        let mut solutions: Vec<_> = found.iter().map(|e| self.judged(e, &five)).collect();
        solutions.sort_by(|one, other| one.error.total_cmp(&other.error));
        Found { solutions, last_start }
    }

    fn judged(
        &self,
        essential: &Matrix3<f64>,
        five: &[(Vector3<f64>, Vector3<f64>); 5],
    ) -> Solution {
        let fundamental = fundamental_matrix(&CAMERA, &CAMERA, essential);
        let misses = self.pixels[5..].iter().map(|(first, second)| {
            sampson_distance(&fundamental, first, second).map_or(f64::NAN, f64::abs)
        });
        let misses: Vec<f64> = misses.collect();
        let squares: f64 = misses.iter().map(|miss| miss * miss).sum();
        let true_matrix = essential_matrix(&self.truth).normalize();
        Solution {
            in_front: relative_pose(essential, five).is_ok_and(|(_, in_front)| in_front == 5),
            sixth: misses[0],
            all_others: (squares / JUDGES as f64).sqrt(),
            error: distance(essential, &true_matrix),
        }
    }
}

/// The smaller of the distances to a matrix and to its negative.
fn distance(one: &Matrix3<f64>, other: &Matrix3<f64>) -> f64 {
    (one - other).norm().min((one + other).norm())
}

/// Newton's method for the five numbers of a motion without scale, from a random motion. Gives the
/// matrix, of length one, when it comes to rest.
fn newton(five: &[(Vector3<f64>, Vector3<f64>); 5], random: &mut Random) -> Option<Matrix3<f64>> {
    let quaternion = Quaternion::from_vector(Vector4::from_fn(|_, _| random.normal(1.0)));
    let mut rotation = UnitQuaternion::new_normalize(quaternion).to_rotation_matrix();
    let mut translation = random.direction(1.0);
    for _ in 0..60 {
        let essential = so3::hat(&translation) * rotation.matrix();
        let across = translation.cross(&Vector3::ith(translation.iamin(), 1.0)).normalize();
        let tangents = [across, translation.cross(&across)];
        let (mut residual, mut jacobian) = (Vector5::zeros(), Matrix5::zeros());
        for (row, (first, second)) in five.iter().enumerate() {
            residual[row] = second.dot(&(essential * first));
            let by_turn = first.cross(&(essential.transpose() * second));
            let by_step = (rotation * first).cross(second);
            let entries = [by_turn.x, by_turn.y, by_turn.z]
                .into_iter()
                .chain(tangents.map(|tangent| tangent.dot(&by_step)));
            entries.enumerate().for_each(|(column, entry)| jacobian[(row, column)] = entry);
        }
        if residual.amax() < 1e-14 {
            return Some(essential.normalize());
        }
        let mut step = -jacobian.lu().solve(&residual)?;
        step *= (0.5 / step.norm()).min(1.0);
        rotation = so3::retract(&rotation, &step.fixed_rows::<3>(0).into());
        let moved = translation + step[3] * tangents[0] + step[4] * tangents[1];
        translation = moved.normalize();
    }
    None
}

/// What is found in the scenes without noise.
pub fn exact() -> &'static [Found] {
    static FOUND: OnceLock<Vec<Found>> = OnceLock::new();
    FOUND.get_or_init(|| in_all_scenes(0.0))
}

/// The same with noise.
pub fn noisy() -> &'static [Found] {
    static FOUND: OnceLock<Vec<Found>> = OnceLock::new();
    FOUND.get_or_init(|| in_all_scenes(NOISE))
}

fn in_all_scenes(sigma: f64) -> Vec<Found> {
    (0..SCENES as u64).map(|seed| Scene::of(seed, sigma, |point| point).solutions()).collect()
}

/// In how many scenes the solution with the smallest miss, among those with all five points in
/// front, is the one nearest to the truth.
pub fn decided(scenes: &[Found], miss: fn(&Solution) -> f64) -> usize {
    let is_right = |found: &&Found| {
        let candidates = found.solutions.iter().enumerate().filter(|(_, s)| s.in_front);
        let best = candidates.min_by(|one, other| miss(one.1).total_cmp(&miss(other.1)));
        best.is_some_and(|(index, _)| index == 0)
    };
    scenes.iter().filter(is_right).count()
}
