//! The filter on its flight: the poses of its window, the tracks it follows, and how far off it is.

#[allow(dead_code)]
#[path = "../../code/examples/filter.rs"]
mod example;

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use vislam::bearing::back_project;
use vislam::inertial::{BodyPose, NavState};
use vislam::msckf::{Msckf, MsckfOptions};
use vislam::simulation::FlightRecording;

use crate::layout::{Beside, Layout};
use crate::stage::{colour, coordinates, ellipsoids, lines, points};
use crate::{Ellipsoid, Stage, StageError, frustum};

pub const SHOWS: &str =
    "the filter on its flight, with its window, its tracks and what it believes";

/// Seconds of the flight, and its seed.
const SECONDS: f64 = 13.0;
const SEED: u64 = 0;
/// How many standard deviations the ellipsoid is drawn large.
const LARGE: f64 = 3.0;
/// How many pictures back a track is drawn: as many as the filter keeps poses.
const TAIL: usize = 11;
/// How far ahead of its centre a camera's image is drawn, in metres.
const IMAGE: f64 = 0.25;

pub fn play(stage: &Stage) -> Result<(), StageError> {
    stage.arrange(&Layout {
        title: "The flight, from outside the room",
        eye: Vector3::new(-2.2, -9.4, 4.8),
        target: Vector3::new(2.0, 0.4, -0.1),
        up: Vector3::z(),
        floor: None,
        beside: vec![
            Beside::Picture { title: "Tracks in the image, px", of: "image" },
            Beside::Curves { title: "Error and three standard deviations, cm", of: "position" },
        ],
        timeline: "time",
        speed: 1.0,
    })?;
    let recording = example::flown(&example::flight(SECONDS), SEED).map_err(StageError::scene)?;
    let truth = &recording.truth;
    stage.always("world/landmarks", &points(&truth.landmarks, colour::GONE, 1.6))?;
    let way = truth.states.iter().map(|state| state.position).collect();
    stage.always("world/truth", &lines([way], (colour::TRUTH, 120), 1.0))?;
    stage.curve("position/error", "error", colour::NEUTRAL)?;
    stage.curve("position/sigma", "three standard deviations", colour::ESTIMATED)?;
    let options = MsckfOptions::of_flight(&recording.flight);
    let start = example::start(&recording, SEED);
    let mut seen = Seen::default();
    let mut written = Ok(());
    example::fly(&recording, options, &start, |number, filter, _| {
        if written.is_ok() {
            written = seen.draw(stage, &recording, number, filter);
        }
    })
    .map_err(StageError::scene)?;
    written
}

/// What was seen on the way.
#[derive(Default)]
struct Seen {
    way: Vec<Vector3<f64>>,
    tails: BTreeMap<usize, Vec<Vector2<f64>>>,
}

impl Seen {
    fn draw(
        &mut self,
        stage: &Stage,
        recording: &FlightRecording,
        number: usize,
        filter: &Msckf,
    ) -> Result<(), StageError> {
        let state = filter.state();
        stage.at_seconds("time", number as f64 / recording.flight.picture_rate);
        self.way.push(state.position);
        stage.now("world/filter/way", &lines([self.way.clone()], (colour::ESTIMATED, 255), 2.0))?;
        window(stage, recording, filter)?;
        let covariance = filter.covariance().fixed_view::<3, 3>(6, 6).into_owned();
        let ellipsoid = Ellipsoid::of(&state.position, &covariance, LARGE);
        let entity = "world/filter/ellipsoid";
        stage.now(entity, &ellipsoids([ellipsoid], colour::ESTIMATED))?;
        rays(stage, recording, number, state)?;
        self.image(stage, recording, number)?;
        let error = (recording.truth.states[number].position - state.position).norm();
        stage.value("position/error", 100.0 * error)?;
        stage.value("position/sigma", 300.0 * covariance.trace().sqrt())
    }

    /// The pixels of the tracks, with those of the pictures before.
    fn image(
        &mut self,
        stage: &Stage,
        recording: &FlightRecording,
        number: usize,
    ) -> Result<(), StageError> {
        let features = &recording.pictures[number].features;
        self.tails.retain(|track, _| features.iter().any(|feature| feature.track == *track));
        for feature in features {
            self.tails.entry(feature.track).or_default().push(feature.pixel);
        }
        let pixel = |pixel: &Vector2<f64>| [pixel.x as f32, pixel.y as f32];
        let tails = self.tails.values().map(|tail| {
            let latest = &tail[tail.len().saturating_sub(TAIL)..];
            latest.iter().map(pixel).collect::<Vec<_>>()
        });
        let [red, green, blue] = colour::MEASURED;
        let tails = rerun::LineStrips2D::new(tails)
            .with_colors([rerun::Color::from_rgb(red, green, blue)])
            .with_radii([rerun::Radius::new_ui_points(0.8)]);
        stage.now("image/tails", &tails)?;
        let corners = features.iter().map(|feature| pixel(&feature.pixel));
        let corners = rerun::Points2D::new(corners)
            .with_colors([rerun::Color::from_rgb(red, green, blue)])
            .with_radii([rerun::Radius::new_ui_points(2.5)]);
        stage.now("image/corners", &corners)?;
        let [red, green, blue] = colour::GONE;
        let grey = rerun::Color::from_rgb(red, green, blue);
        let size = pixel(&recording.flight.image);
        stage.now(
            "image/frame",
            &rerun::Boxes2D::from_mins_and_sizes([[0.0, 0.0]], [size]).with_colors([grey]),
        )
    }
}

/// The poses that the filter keeps, the last one larger.
fn window(stage: &Stage, recording: &FlightRecording, filter: &Msckf) -> Result<(), StageError> {
    let poses = filter.belief().values().of_kind::<BodyPose>();
    let camera = &recording.flight.camera;
    let frusta = |poses: &[BodyPose], depth: f64| {
        let rig = filter.rig();
        let of = |pose: &BodyPose| frustum(camera, &rig.camera_from_world(&pose.at_rest()), depth);
        poses.iter().flat_map(of).collect::<Vec<_>>()
    };
    let (kept, last) = poses.split_at(poses.len().saturating_sub(1));
    stage.now("world/filter/window", &lines(frusta(kept, IMAGE), (colour::ESTIMATED, 160), 1.0))?;
    let last = frusta(last, 2.0 * IMAGE);
    stage.now("world/filter/camera", &lines(last, (colour::ESTIMATED, 255), 2.2))
}

/// From where the filter believes to be, the rays of the pixels, as far as the landmarks are; and these.
fn rays(
    stage: &Stage,
    recording: &FlightRecording,
    number: usize,
    state: &NavState,
) -> Result<(), StageError> {
    let (flight, truth) = (&recording.flight, &recording.truth);
    let world_from_camera: Isometry3<f64> = flight.rig.world_from_camera(state);
    let centre = world_from_camera.translation.vector;
    let features = &recording.pictures[number].features;
    let landmark = |track: usize| truth.landmarks[truth.landmark_of_track[track]];
    let rays = features.iter().map(|feature| {
        let place = world_from_camera.inverse() * Point3::from(landmark(feature.track));
        let ray = back_project(&flight.camera, &feature.pixel, place.z);
        vec![centre, (world_from_camera * Point3::from(ray)).coords]
    });
    stage.now("world/tracks/rays", &lines(rays, (colour::MEASURED, 90), 0.7))?;
    let followed: Vec<_> = features.iter().map(|feature| landmark(feature.track)).collect();
    let followed = rerun::Points3D::new(followed.iter().map(coordinates))
        .with_colors([rerun::Color::from_rgb(0x6c, 0xb4, 0xf0)])
        .with_radii([rerun::Radius::new_ui_points(3.0)]);
    stage.now("world/tracks/landmarks", &followed)
}
