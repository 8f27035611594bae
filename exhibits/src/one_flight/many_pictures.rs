//! What many pictures say of path and map, up to a similarity.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use nalgebra::{Vector3, Vector6};
use vislam::bundle_adjustment::{BaReport, Camera, PosedPinhole, TinyBa};
use vislam::least_squares::Options;
use vislam::observability::Similarity;
use vislam::reprojection::ReprojFactor;
use vislam::structure_from_motion::{
    Picture, PictureMatch, Reconstruction, ReconstructionOptions, ScaleFreedom,
    absolute_orientation, reconstruct,
};

use super::from_above::{Layer, room};
use super::{camera_from_world, camera_path, centre, picture_at, place_of, recording};
use crate::chapter::Chapter;
use crate::figure::Figure;
use crate::initialization::judged::root_mean_square;
use crate::random::Random;

/// How many seconds are adjusted, and how many are put together from nothing.
const ADJUSTED: f64 = 10.0;
const GROWN: f64 = 40.0;
/// Seconds from one of their pictures to the next.
const ADJUSTED_STEP: f64 = 0.5;
const GROWN_STEP: f64 = 0.2;
/// How far off the adjustment begins, on each axis: cameras in metres and radians, points in metres.
const OFF: [f64; 3] = [0.2, 0.05, 0.3];
/// Seconds by which the map that is grown is laid upon the truth, to see it drift.
const LAID: f64 = 10.0;

/// The pictures of so many seconds, so many seconds apart.
fn pictures(seconds: f64, step: f64) -> Vec<usize> {
    (0..=picture_at(seconds)).step_by(picture_at(step)).collect()
}

/// An adjustment of the first seconds, and the similarity that lays it upon the truth.
struct Adjusted {
    problem: TinyBa<PosedPinhole, 6>,
    report: BaReport,
    places: Vec<Vector3<f64>>,
    upon: Similarity,
}

impl Adjusted {
    fn of_flight() -> &'static Self {
        static ADJUSTED: OnceLock<Adjusted> = OnceLock::new();
        ADJUSTED.get_or_init(Self::new)
    }

    fn new() -> Self {
        let (mut problem, places) = off(&pictures(ADJUSTED, ADJUSTED_STEP));
        let report = problem.solve(&Options::default()).expect("a problem");
        let cameras = problem.cameras.iter().zip(pictures(ADJUSTED, ADJUSTED_STEP));
        let pairs: Vec<_> = cameras
            .map(|(camera, picture)| (camera.centre(), centre(&camera_from_world(picture))))
            .collect();
        let upon = absolute_orientation(&pairs, ScaleFreedom::Free).expect("a path that bends");
        Self { problem, report, places, upon }
    }

    /// The cameras' places, laid upon the truth.
    fn laid(&self) -> Vec<Vector3<f64>> {
        self.problem.cameras.iter().map(|camera| self.upon.point(&camera.centre())).collect()
    }
}

/// Pictures with a start that is off, and where their landmarks truly are.
fn off(pictures: &[usize]) -> (TinyBa<PosedPinhole, 6>, Vec<Vector3<f64>>) {
    let flight = &recording().flight;
    let (mut numbers, mut places, mut factors) = (BTreeMap::new(), Vec::new(), Vec::new());
    for (keyframe, picture) in pictures.iter().enumerate() {
        for feature in &recording().pictures[*picture].features {
            let number = *numbers.entry(feature.track).or_insert_with(|| {
                places.push(place_of(feature.track));
                places.len() - 1
            });
            let factor = ReprojFactor::new(keyframe, number, feature.pixel, flight.pixel_sigma);
            factors.push(factor.expect("a pixel"));
        }
    }
    let mut random = Random::new(super::SEED);
    let [shift, turn, point] = OFF;
    let cameras = pictures.iter().map(|picture| {
        let twist = Vector6::from_fn(|row, _| random.normal(if row < 3 { shift } else { turn }));
        let camera_from_world = camera_from_world(*picture);
        PosedPinhole { intrinsics: flight.camera, camera_from_world }.retract(&twist)
    });
    let cameras = cameras.collect();
    let points = places.iter().map(|place| place + Vector3::from_fn(|_, _| random.normal(point)));
    (TinyBa::new(cameras, points.collect(), factors), places)
}

/// Path and map of the first seconds, floating.
pub fn adjusted(chapter: &mut Chapter) {
    let Adjusted { problem, report, upon, .. } = Adjusted::of_flight();
    let laid = Adjusted::of_flight().laid();
    let truth = pictures(ADJUSTED, ADJUSTED_STEP)
        .into_iter()
        .map(|picture| centre(&camera_from_world(picture)));
    let missed = laid.iter().zip(truth).map(|(place, truth)| 100.0 * (place - truth).norm());
    chapter.number("flight_seconds", ADJUSTED, "s", 0);
    chapter.number("flight_pictures", problem.cameras.len() as f64, "", 0);
    chapter.number("flight_points", (problem.points.len() - report.dropped.points) as f64, "", 0);
    chapter.number("flight_path", root_mean_square(missed), "cm", 1);
    chapter.number("flight_size", 100.0 * (upon.scale.recip() - 1.0), "%", 1);
    chapter.number("flight_turned", upon.rotation.angle().to_degrees(), "°", 1);
    chapter.figure("one_flight", floating);
}

/// The map as it came out, and not laid upon the truth.
fn floating() -> Figure {
    let Adjusted { problem, .. } = Adjusted::of_flight();
    let cameras: Vec<Vector3<f64>> = problem.cameras.iter().map(PosedPinhole::centre).collect();
    room(&[
        Layer::truth(&camera_path(0.0, ADJUSTED)),
        Layer::landmarks(&Adjusted::of_flight().places),
        Layer::line("path", 0, &cameras),
        Layer::points("map", 1, &problem.points),
    ])
}

/// The pictures of the flight as a reconstruction is given them, which does not know their order.
fn matched(numbers: &[usize]) -> (Vec<Picture>, Vec<PictureMatch>) {
    let features = |at: usize| &recording().pictures[numbers[at]].features;
    let picture = |at| Picture {
        camera: recording().flight.camera,
        keypoints: features(at).iter().map(|feature| feature.pixel).collect(),
    };
    let mut matches = Vec::new();
    for (first, second) in
        (0..numbers.len()).flat_map(|second| (0..second).map(move |first| (first, second)))
    {
        for (one, feature) in features(first).iter().enumerate() {
            let other = features(second).iter().position(|other| other.track == feature.track);
            let pair = |other| PictureMatch { pictures: [first, second], keypoints: [one, other] };
            matches.extend(other.map(pair));
        }
    }
    ((0..numbers.len()).map(picture).collect(), matches)
}

/// A map that grew from matches, and its cameras laid upon the truth by the first seconds alone.
fn grown() -> &'static (Reconstruction, Similarity) {
    static GROWN_MAP: OnceLock<(Reconstruction, Similarity)> = OnceLock::new();
    GROWN_MAP.get_or_init(|| {
        let (pictures, matches) = matched(&pictures(GROWN, GROWN_STEP));
        let map = reconstruct(&pictures, &matches, &ReconstructionOptions::default());
        let map = map.expect("pictures with parallax");
        let first = (LAID / GROWN_STEP) as usize;
        let pairs: Vec<_> =
            known(&map).filter(|(at, ..)| *at <= first).map(|at| (at.1, at.2)).collect();
        let upon = absolute_orientation(&pairs, ScaleFreedom::Free).expect("a path that bends");
        (map, upon)
    })
}

/// The number of each picture that has a pose, where it is on the map, and where it truly was.
fn known(map: &Reconstruction) -> impl Iterator<Item = (usize, Vector3<f64>, Vector3<f64>)> {
    let numbers = pictures(GROWN, GROWN_STEP);
    map.cameras.iter().enumerate().filter_map(move |(at, camera)| {
        let camera = camera.as_ref().ok()?;
        Some((at, centre(camera), centre(&camera_from_world(numbers[at]))))
    })
}

/// A map from nothing but matches, and how far it drifts.
pub fn from_nothing(chapter: &mut Chapter) {
    let (map, upon) = grown();
    let missed =
        |at: &(usize, Vector3<f64>, Vector3<f64>)| 100.0 * (upon.point(&at.1) - at.2).norm();
    let first = (LAID / GROWN_STEP) as usize;
    let early = known(map).filter(|at| at.0 <= first).map(|at| missed(&at));
    chapter.number("flight_pictures", map.cameras.len() as f64, "", 0);
    chapter.number("flight_posed", known(map).count() as f64, "", 0);
    chapter.number("flight_laid", LAID, "s", 0);
    chapter.number("flight_seconds", GROWN, "s", 0);
    chapter.number("flight_early", root_mean_square(early), "cm", 1);
    chapter.number("flight_late", known(map).last().map_or(f64::NAN, |at| missed(&at)), "cm", 0);
    chapter.figure("one_flight", drifting);
}

fn drifting() -> Figure {
    let (map, upon) = grown();
    let line: Vec<Vector3<f64>> = known(map).map(|at| upon.point(&at.1)).collect();
    let points: Vec<Vector3<f64>> =
        map.points.iter().map(|point| upon.point(&point.place)).collect();
    room(&[
        Layer::truth(&camera_path(0.0, GROWN)),
        Layer::line("path", 0, &line),
        Layer::points("map", 1, &points),
    ])
}
