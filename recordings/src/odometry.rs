//! The assembled system on the first half minute of the flight V1_01 of EuRoC: the smoother's window, its landmarks, what
//! it says of the newest position, and where the body truly was. The data are not in the repository: the folder that
//! VISLAM_DATA names has them.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Matrix3, Vector3};
use vislam::datasets::calibration::read_calibration;
use vislam::datasets::euroc::{GroundTruth, read_ground_truth, truth_at};
use vislam::datasets::recording::read_recording;
use vislam::datasets::tracks::Picture;
use vislam::filtering::{Freedom, align};
use vislam::inertial::{NavState, StampedSample};
use vislam::initialization::Sensors;
use vislam::observability::Similarity;
use vislam::odometry::{Estimator, Odometry, OdometryOptions, Progress};
use vislam::reprojection::Pinhole;

use crate::layout::{Beside, Layout};
use crate::stage::{colour, ellipsoids, lines, points};
use crate::{Ellipsoid, Stage, StageError, frustum};

pub const SHOWS: &str =
    "the smoother on half a minute of a real flight, V1_01 of EuRoC; its data are in VISLAM_DATA";

/// The folder with the data, and its files: readings with tracks, and where the body was.
const FOLDER: &str = "VISLAM_DATA";
const FLIGHT: &str = "V1_01_30s_imu_and_tracks.csv";
const TRUTH: &str = "V1_01_groundtruth_20hz.csv";
/// What the camera and the sensor of EuRoC are.
const SENSORS: &str = include_str!("../../code/examples/odometry/euroc.toml");
/// Every so manieth picture is taken: ten in a second.
const EVERY: usize = 2;
/// How many standard deviations the ellipsoid is drawn large.
const LARGE: f64 = 3.0;
/// How far ahead of its centre a camera's image is drawn, in metres.
const IMAGE: f64 = 0.15;

pub fn play(stage: &Stage) -> Result<(), StageError> {
    let Input { sensors, readings, pictures, truth } = Input::read()?;
    let frames = flown(&sensors, &readings, &pictures)?;
    let known = frames.iter().filter_map(|frame| {
        let truth = truth_at(&truth, frame.nanoseconds)?;
        Some((frame.state, truth.state))
    });
    let (estimates, states): (Vec<NavState>, Vec<NavState>) = known.unzip();
    let true_from_world = align(&estimates, &states, Freedom::Four).map_err(StageError::scene)?;
    let middle = states.iter().map(|state| state.position).sum::<Vector3<f64>>();
    let middle = middle / states.len() as f64;
    stage.arrange(&Layout {
        title: "Truth, estimate and window",
        eye: middle + Vector3::new(-2.6, -3.2, 2.0),
        target: middle,
        up: Vector3::z(),
        floor: None,
        beside: vec![
            Beside::Curves { title: "Error and three standard deviations, cm", of: "position" },
            Beside::Curves { title: "Pixels used and refused", of: "pixels" },
        ],
        timeline: "time",
        speed: 1.0,
    })?;
    let way = states.iter().map(|state| state.position).collect();
    stage.always("world/truth", &lines([way], (colour::TRUTH, 120), 1.0))?;
    stage.curve("position/error", "error", colour::NEUTRAL)?;
    stage.curve("position/sigma", "three standard deviations", colour::ESTIMATED)?;
    stage.curve("pixels/used", "used", colour::MEASURED)?;
    stage.curve("pixels/refused", "refused", colour::STRIKING)?;
    let first = pictures.first().map_or(0, |picture| picture.nanoseconds);
    let mut way = Vec::new();
    for frame in &frames {
        stage.at_seconds("time", 1e-9 * (frame.nanoseconds - first) as f64);
        let moved = frame.moved(&true_from_world);
        way.push(moved.state.position);
        stage.now("world/smoother/way", &lines([way.clone()], (colour::ESTIMATED, 255), 2.0))?;
        moved.draw(stage, &sensors)?;
        let truth = truth_at(&truth, frame.nanoseconds).map(|truth| truth.state.position);
        if let Some(truth) = truth {
            stage.now("world/truth/body", &points([&truth], colour::TRUTH, 4.0))?;
            stage.value("position/error", 100.0 * (truth - moved.state.position).norm())?;
        }
        stage.value("position/sigma", 100.0 * LARGE * moved.covariance.trace().sqrt())?;
        stage.value("pixels/used", frame.seen[0] as f64)?;
        stage.value("pixels/refused", frame.seen[1] as f64)?;
    }
    Ok(())
}

/// What the files say.
struct Input {
    sensors: Sensors,
    readings: Vec<StampedSample>,
    pictures: Vec<Picture>,
    truth: Vec<GroundTruth>,
}

impl Input {
    fn read() -> Result<Self, StageError> {
        let folder = std::env::var_os(FOLDER).map(PathBuf::from).ok_or_else(|| {
            StageError::scene(format!(
                "its data are not in the repository; get the files {FLIGHT} and {TRUTH}, and let {FOLDER} name their folder"
            ))
        })?;
        let recording = read_recording(&text(&folder, FLIGHT)?).map_err(StageError::scene)?;
        let truth = read_ground_truth(&text(&folder, TRUTH)?).map_err(StageError::scene)?;
        let known = read_calibration(SENSORS).map_err(StageError::scene)?;
        let mut sensors = known;
        // The file has normalized coordinates, and says how many pixels one is.
        sensors.rig.body_from_camera = recording.body_from_camera;
        sensors.pixel_sigma /= recording.camera.fx;
        sensors.camera = Pinhole { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 };
        let (first, last) = recording
            .samples
            .first()
            .zip(recording.samples.last())
            .ok_or_else(|| StageError::scene(format!("{FLIGHT} has no readings")))?;
        let span = first.nanoseconds..=last.nanoseconds;
        let is_covered =
            |picture: &Picture| span.contains(&sensors.rig.imu_nanoseconds(picture.nanoseconds));
        let pictures = recording.pictures.iter().filter(|picture| is_covered(picture));
        let pictures = pictures.step_by(EVERY).cloned().collect();
        Ok(Self { sensors, readings: recording.samples, pictures, truth })
    }
}

fn text(folder: &Path, file: &str) -> Result<String, StageError> {
    let path = folder.join(file);
    std::fs::read_to_string(&path).map_err(|error| {
        StageError::scene(format!(
            "{} cannot be read: {error}; let {FOLDER} name the folder that has {FLIGHT} and {TRUTH}",
            path.display()
        ))
    })
}

/// What is believed after a picture.
struct Frame {
    nanoseconds: i64,
    state: NavState,
    covariance: Matrix3<f64>,
    window: Vec<NavState>,
    points: Vec<Vector3<f64>>,
    /// What was used of the picture, and what was refused.
    seen: [usize; 2],
}

/// The flight as the odometry follows it. Of what comes after it was lost nothing could be shown in the same world.
fn flown(
    sensors: &Sensors,
    readings: &[StampedSample],
    pictures: &[Picture],
) -> Result<Vec<Frame>, StageError> {
    let mut odometry = Odometry::new(OdometryOptions::new(*sensors, Estimator::Smoother));
    let mut frames = Vec::new();
    let told = |odometry: &Odometry, progress: Progress| {
        let Progress::Following { used, refused } = progress else { return };
        let Some(newest) = odometry.newest().filter(|_| odometry.worlds() == 1) else { return };
        frames.push(Frame {
            nanoseconds: newest.nanoseconds,
            state: newest.state,
            covariance: newest.covariance.fixed_view::<3, 3>(6, 6).into_owned(),
            window: odometry.window(),
            points: odometry.points().into_iter().map(|(_, place)| place).collect(),
            seen: [used, refused],
        });
    };
    odometry.fly(readings, pictures, told).map_err(StageError::scene)?;
    Ok(frames)
}

impl Frame {
    /// The same in another world.
    fn moved(&self, by: &Similarity) -> Self {
        let none = Vector3::zeros();
        let state = |state: &NavState| by.state(state, &none, &none);
        let turn = by.rotation.matrix();
        Self {
            nanoseconds: self.nanoseconds,
            state: state(&self.state),
            covariance: turn * self.covariance * turn.transpose(),
            window: self.window.iter().map(state).collect(),
            points: self.points.iter().map(|place| by.point(place)).collect(),
            seen: self.seen,
        }
    }

    /// The cameras of the window, the last one larger, its landmarks, and how sure the newest position is.
    fn draw(&self, stage: &Stage, sensors: &Sensors) -> Result<(), StageError> {
        // A camera of EuRoC sees about so much to each side of its axis.
        let camera = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };
        let frusta = |states: &[NavState], depth: f64| {
            let pose =
                |state: &NavState| -> Isometry3<f64> { sensors.rig.camera_from_world(state) };
            let of = |state: &NavState| frustum(&camera, &pose(state), depth);
            states.iter().flat_map(of).collect::<Vec<_>>()
        };
        let (kept, last) = self.window.split_at(self.window.len().saturating_sub(1));
        let entity = "world/smoother/window";
        stage.now(entity, &lines(frusta(kept, IMAGE), (colour::ESTIMATED, 160), 1.0))?;
        let last = frusta(last, 2.0 * IMAGE);
        stage.now("world/smoother/camera", &lines(last, (colour::ESTIMATED, 255), 2.2))?;
        stage.now("world/smoother/landmarks", &points(&self.points, colour::ESTIMATED, 2.0))?;
        let ellipsoid = Ellipsoid::of(&self.state.position, &self.covariance, LARGE);
        stage.now("world/smoother/ellipsoid", &ellipsoids([ellipsoid], colour::ESTIMATED))
    }
}
