//! What two pictures say of the step between them.

use std::sync::OnceLock;

use nalgebra::{Isometry3, Vector2, Vector3};
use vislam::robust_two_view::{
    ConsensusOptions, Correspondences, Effort, GeneralMotion, Matches, RelativeMotion,
    eight_points, general_motion,
};
use vislam::two_views::{LEAST_PARALLAX, View, relative_pose, triangulate};

use super::from_above::{Layer, room};
use super::{camera_from_world, camera_path, centre, picture_at, place_of, recording};
use crate::chapter::Chapter;
use crate::figure::Figure;
use crate::random::Random;

/// How many seconds lie between the two pictures.
const APART: f64 = 1.0;
/// The length that is assumed of the step, in metres.
const ASSUMED: f64 = 1.0;

/// Two pictures, and the pixels at which they show the same.
struct Pair {
    pixels: Vec<[Vector2<f64>; 2]>,
    /// Where the landmarks are.
    places: Vec<Vector3<f64>>,
    /// The true motion.
    second_from_first: Isometry3<f64>,
}

impl Pair {
    fn of_flight() -> Self {
        let [first, second] = [0, picture_at(APART)];
        let features = |picture: usize| &recording().pictures[picture].features;
        let both = features(first).iter().filter_map(|one| {
            let other = features(second).iter().find(|other| other.track == one.track)?;
            Some(([one.pixel, other.pixel], place_of(one.track)))
        });
        let (pixels, places) = both.unzip();
        let second_from_first = camera_from_world(second) * camera_from_world(first).inverse();
        Self { pixels, places, second_from_first }
    }

    /// The same with so many wrong matches behind the right ones.
    fn with_wrong(mut self, count: usize) -> Self {
        let mut random = Random::new(super::SEED);
        let size = recording().flight.image;
        let mut pixel = || size.map(|length| random.uniform(0.0..length));
        self.pixels.extend((0..count).map(|_| [pixel(), pixel()]));
        self
    }

    fn matches(&self) -> Matches {
        let flight = &recording().flight;
        Matches::new([&flight.camera; 2], &self.pixels, flight.pixel_sigma).expect("finite pixels")
    }

    /// The motion that fits all matches best.
    fn fitting_all(&self) -> RelativeMotion {
        let matches = self.matches();
        let essential = eight_points(matches.rays()).expect("there are more than eight");
        let (start, _) = relative_pose(&essential, matches.rays()).expect("one motion fits best");
        let start = RelativeMotion::of(&start).expect("the camera moved");
        let all: Vec<usize> = (0..matches.len()).collect();
        GeneralMotion(&matches).refined(&start, &all, Effort::Converge).expect("a minimum")
    }

    /// The standard deviations of the turn and of the direction of the step of that motion, in degrees.
    fn sigmas(&self, motion: &RelativeMotion) -> [f64; 2] {
        let (matches, all) = (self.matches(), (0..self.pixels.len()).collect::<Vec<_>>());
        let covariance = GeneralMotion(&matches).covariance(motion, &all).expect("a minimum");
        [0..3, 3..5].map(|part| {
            let variances = covariance.diagonal().rows_range(part).sum();
            variances.sqrt().to_degrees()
        })
    }

    /// By how many degrees the direction of a step is wrong.
    fn direction_off(&self, motion: &RelativeMotion) -> f64 {
        motion.direction.angle(&self.second_from_first.translation.vector).to_degrees()
    }

    /// By how many degrees a turn is wrong.
    fn turn_off(&self, motion: &RelativeMotion) -> f64 {
        let truth = self.second_from_first.rotation.to_rotation_matrix();
        motion.rotation.rotation_to(&truth).angle().to_degrees()
    }
}

/// The motion between two pictures without wrong matches.
pub fn motion(chapter: &mut Chapter) {
    let pair = Pair::of_flight();
    let found = pair.fitting_all();
    chapter.number("flight_apart", APART, "s", 0);
    chapter.number("flight_shared", pair.pixels.len() as f64, "", 0);
    chapter.number("flight_turn", pair.turn_off(&found), "°", 2);
    chapter.number("flight_direction", pair.direction_off(&found), "°", 2);
    let [turn_sigma, direction_sigma] = pair.sigmas(&found);
    chapter.number("flight_turn_sigma", turn_sigma, "°", 2);
    chapter.number("flight_direction_sigma", direction_sigma, "°", 2);
    chapter.number("flight_assumed", ASSUMED, "m", 0);
    chapter.number("flight_step", pair.second_from_first.translation.vector.norm(), "m", 2);
    chapter.figure("one_flight", too_small);
}

/// The second camera of a motion, whose first one is where it truly is.
fn second_camera(motion: &RelativeMotion, length: f64) -> Isometry3<f64> {
    let mut second_from_first = motion.second_from_first();
    second_from_first.translation.vector *= length;
    second_from_first * camera_from_world(0)
}

/// The landmarks and the step, if the step had the length that is assumed.
fn too_small() -> Figure {
    let pair = Pair::of_flight();
    let flight = &recording().flight;
    let cameras = [camera_from_world(0), second_camera(&pair.fitting_all(), ASSUMED)];
    let view = |at: usize, pixel| View {
        camera: flight.camera,
        camera_from_world: cameras[at],
        pixel,
        sigma: flight.pixel_sigma,
    };
    let points = pair.pixels.iter().filter_map(|[first, second]| {
        triangulate(&[view(0, *first), view(1, *second)], LEAST_PARALLAX).ok()
    });
    let points: Vec<Vector3<f64>> = points.collect();
    let step = cameras.map(|camera| centre(&camera));
    room(&[
        Layer::truth(&camera_path(0.0, APART)),
        Layer::landmarks(&pair.places),
        Layer::line("step", 0, &step),
        Layer::points("landmarks by this step", 1, &points),
    ])
}

/// The same pair when a third of the matches is wrong: by all of them, and by those that agree.
fn third_wrong() -> &'static (Pair, RelativeMotion, RelativeMotion, [usize; 2]) {
    static FOUND: OnceLock<(Pair, RelativeMotion, RelativeMotion, [usize; 2])> = OnceLock::new();
    FOUND.get_or_init(|| {
        let right = Pair::of_flight().pixels.len();
        let pair = Pair::of_flight().with_wrong(right / 2);
        let found = general_motion(&pair.matches(), &ConsensusOptions::default());
        let found = found.expect("most matches are right");
        let agree = found.inliers.iter().filter(|datum| **datum < right).count();
        let all = pair.fitting_all();
        (pair, all, found.estimate, [agree, found.inliers.len() - agree])
    })
}

/// The motion among wrong matches.
pub fn robust(chapter: &mut Chapter) {
    let (pair, all, found, [right, wrong]) = third_wrong();
    let count = pair.pixels.len();
    chapter.number("flight_matches", count as f64, "", 0);
    chapter.number("flight_wrong", (count - pair.places.len()) as f64, "", 0);
    chapter.number("flight_all", pair.direction_off(all), "°", 0);
    chapter.number("flight_agreed", pair.direction_off(found), "°", 1);
    chapter.number("flight_agreed_right", *right as f64, "", 0);
    chapter.number("flight_agreed_wrong", *wrong as f64, "", 0);
    chapter.figure("one_flight", directions);
}

fn directions() -> Figure {
    let (pair, all, found, _) = third_wrong();
    let length = pair.second_from_first.translation.vector.norm();
    let step = |motion| {
        let cameras = [camera_from_world(0), second_camera(motion, length)];
        cameras.map(|camera| centre(&camera))
    };
    room(&[
        Layer::truth(&camera_path(0.0, APART)),
        Layer::landmarks(&pair.places),
        Layer::line("step by those that agree", 0, &step(found)),
        Layer::line("step by all matches", 1, &step(all)),
    ])
}
