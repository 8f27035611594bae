//! What many pictures say of path and map, up to a similarity.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use nalgebra::{Cholesky, DMatrix, Matrix3, SMatrix, Vector3, Vector6};
use vislam::bundle_adjustment::{BaReport, Camera, PosedPinhole, Solver, TinyBa};
use vislam::least_squares::Options;
use vislam::manifold::so3;
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
use crate::random::Random;
use crate::statistics::root_mean_square;

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
    chapter.number("flight_late_sigma", 100.0 * late_sigma(), "cm", 0);
    chapter.figure("one_flight", drifting);
}

/// The map that is grown as an adjustment, and for each of its cameras the number of its picture.
fn as_adjustment(map: &Reconstruction) -> (TinyBa<PosedPinhole, 6>, Vec<usize>) {
    let flight = &recording().flight;
    let posed = map.cameras.iter().enumerate().filter_map(|(at, camera)| {
        let camera_from_world = *camera.as_ref().ok()?;
        Some((PosedPinhole { intrinsics: flight.camera, camera_from_world }, at))
    });
    let (cameras, numbers): (Vec<_>, Vec<usize>) = posed.unzip();
    let pictures = pictures(GROWN, GROWN_STEP);
    let sightings = map.points.iter().enumerate();
    let sightings = sightings.flat_map(|(at, point)| point.sightings.iter().map(move |s| (at, s)));
    let factors = sightings.map(|(point, [picture, keypoint])| {
        let camera = numbers.binary_search(picture).expect("it has a pose");
        let pixel = recording().pictures[pictures[*picture]].features[*keypoint].pixel;
        ReprojFactor::new(camera, point, pixel, flight.pixel_sigma).expect("a pixel")
    });
    let factors = factors.collect();
    let points = map.points.iter().map(|point| point.place).collect();
    (TinyBa::new(cameras, points, factors), numbers)
}

/// How sure the map is of the place of its last camera, in metres, when it is laid upon the truth by its first seconds.
///
/// What a similarity changes at the first cameras is taken from the last one as well. No pixel minds a similarity, so
/// any information may be added about it.
fn late_sigma() -> f64 {
    let (map, upon) = grown();
    let (problem, numbers) = as_adjustment(map);
    let solver = Solver::new(&problem, &Options::default()).expect("a problem");
    let (information, _) = solver.schur_complement(0.0).expect("each point has parallax");
    let centres: Vec<Vector3<f64>> = problem.cameras.iter().map(PosedPinhole::centre).collect();
    let last = centres.len() - 1;
    // The twist (ρ, φ) moves the centre c by c × φ - ρ, and a growth moves it by c.
    let by_twist = |camera: usize| {
        let mut moved = SMatrix::<f64, 3, 6>::zeros();
        moved.fixed_view_mut::<3, 3>(0, 0).copy_from(&-Matrix3::identity());
        moved.fixed_view_mut::<3, 3>(0, 3).copy_from(&so3::hat(&centres[camera]));
        moved
    };
    let by_similarity = |camera: usize| {
        let mut moved = SMatrix::<f64, 3, 7>::zeros();
        moved.fixed_view_mut::<3, 6>(0, 0).copy_from(&by_twist(camera));
        moved.set_column(6, &centres[camera]);
        moved
    };
    let first = (LAID / GROWN_STEP) as usize;
    let laid = numbers.iter().take_while(|at| **at <= first).count();
    let normal: SMatrix<f64, 7, 7> =
        (0..laid).map(|camera| by_similarity(camera).tr_mul(&by_similarity(camera))).sum();
    let normal = Cholesky::new(normal).expect("a path that bends");
    let mut end = DMatrix::zeros(information.nrows(), 3);
    let mut free = DMatrix::zeros(information.nrows(), 7);
    for (camera, centre) in centres.iter().enumerate() {
        let row = 6 * camera;
        if camera < laid {
            let fitted = normal.solve(&by_similarity(camera).tr_mul(&by_twist(camera)));
            end.view_mut((row, 0), (6, 3)).copy_from(&-(by_similarity(last) * fitted).transpose());
        }
        free.view_mut((row, 0), (6, 6)).fill_with_identity();
        free.view_mut((row, 6), (3, 1)).copy_from(&-centre);
    }
    let mut own = end.view_mut((6 * last, 0), (6, 3));
    own += by_twist(last).transpose();
    let weight = information.trace() / free.norm_squared();
    let fixed = Cholesky::new(information + weight * &free * free.transpose());
    let variances = end.tr_mul(&fixed.expect("seven directions are free").solve(&end));
    upon.scale * variances.trace().sqrt()
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
