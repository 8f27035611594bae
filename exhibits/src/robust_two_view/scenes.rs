//! Two pictures of one place, and matches between them of which some are wrong.

use nalgebra::{Isometry3, Vector2, Vector3};
use vislam::bearing::back_project;
use vislam::reprojection::Pinhole;
use vislam::robust_two_view::Correspondences;
use vislam::robust_two_view::{Effort, GeneralMotion, Matches, RelativeMotion};

use crate::random::Random;

pub const CAMERA: Pinhole = Pinhole { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0 };
/// Columns and rows of the pictures.
pub const SIZE: [f64; 2] = [640.0, 480.0];
/// Pixels of noise in each coordinate.
pub const SIGMA: f64 = 1.0;
/// Metres from the first camera to the second.
pub const BASELINE: f64 = 0.5;
/// The largest angle of the turn between them, in degrees.
const TURN: f64 = 10.0;
/// Depths of the points in metres.
pub const DEPTHS: [f64; 2] = [2.0, 8.0];

/// What lies before the first camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum World {
    /// Points at all depths.
    Deep,
    /// A wall that is turned against the pictures.
    Wall,
    /// Points as far away as those of [`World::Deep`], times this.
    Far(f64),
}

impl World {
    /// The depth of a point on a ray with a one below.
    fn depth(self, ray: &Vector3<f64>, random: &mut Random) -> f64 {
        match self {
            Self::Deep => random.uniform(DEPTHS[0]..DEPTHS[1]),
            Self::Wall => 4.0 / Vector3::new(0.3, -0.2, 1.0).dot(ray),
            Self::Far(times) => times * random.uniform(DEPTHS[0]..DEPTHS[1]),
        }
    }
}

/// Two pictures and the matches between them, the right ones first.
pub struct Scene {
    /// How the second camera stands to the first.
    pub truth: Isometry3<f64>,
    pub pixels: Vec<[Vector2<f64>; 2]>,
    pub right: usize,
}

impl Scene {
    /// Matches with noise of so many pixels, and wrong ones, which pair any pixel with any other.
    pub fn new(random: &mut Random, world: World, sigma: f64, right: usize, wrong: usize) -> Self {
        let turn = random.rotation(TURN.to_radians());
        let truth = Isometry3::from_parts(random.direction(BASELINE).into(), turn.into());
        Self::of_motion(random, truth, world, sigma, [right, wrong])
    }

    /// The same for a given motion.
    pub fn of_motion(
        random: &mut Random,
        truth: Isometry3<f64>,
        world: World,
        sigma: f64,
        [right, wrong]: [usize; 2],
    ) -> Self {
        let mut pixels = Vec::new();
        while pixels.len() < right {
            let first = any_pixel(random);
            let ray = back_project(&CAMERA, &first, 1.0);
            let point = world.depth(&ray, random) * ray;
            let second = CAMERA.project(&truth, &point).filter(is_inside);
            let mut noise = || Vector2::new(random.normal(sigma), random.normal(sigma));
            pixels.extend(second.map(|second| [first + noise(), second + noise()]));
        }
        pixels.extend((0..wrong).map(|_| [any_pixel(random), any_pixel(random)]));
        Self { truth, pixels, right }
    }

    /// What the library is given.
    pub fn matches(&self) -> Matches {
        Matches::new([&CAMERA, &CAMERA], &self.pixels, SIGMA).expect("finite pixels")
    }

    /// The larger of the angles by which rotation and direction are wrong, in degrees.
    pub fn degrees_off(&self, found: &RelativeMotion) -> f64 {
        let turn = found.rotation.rotation_to(&self.truth.rotation.to_rotation_matrix()).angle();
        turn.max(found.direction.angle(&self.truth.translation.vector)).to_degrees()
    }

    /// The motion that fits the right matches best, which only an oracle knows.
    pub fn of_oracle(&self) -> RelativeMotion {
        let truth = RelativeMotion::of(&self.truth).expect("it moved");
        let right: Vec<usize> = (0..self.right).collect();
        let matches = self.matches();
        let refined = GeneralMotion(&matches).refined(&truth, &right, Effort::Converge);
        refined.expect("a minimum near the truth")
    }
}

fn any_pixel(random: &mut Random) -> Vector2<f64> {
    Vector2::new(random.uniform(0.0..SIZE[0]), random.uniform(0.0..SIZE[1]))
}

fn is_inside(pixel: &Vector2<f64>) -> bool {
    (0.0..SIZE[0]).contains(&pixel.x) && (0.0..SIZE[1]).contains(&pixel.y)
}

/// What this part of some numbers stays below.
pub fn quantile(mut numbers: Vec<f64>, part: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[((numbers.len() - 1) as f64 * part).round() as usize]
}
