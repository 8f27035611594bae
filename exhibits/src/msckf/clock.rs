//! The pose of a picture whose time is not quite known.

use nalgebra::{Isometry3, SVector, Vector3};
use vislam::datasets::tracks::Picture;
use vislam::inertial::{
    BodyPose, Calibrated, CameraImu, GRAVITY, ImuBias, ImuNoise, ImuSample, StampedSample,
};
use vislam::least_squares::Manifold;
use vislam::msckf::{Msckf, MsckfOptions, Start};
use vislam::preintegration::Matrix15;
use vislam::reprojection::Pinhole;
use vislam::simulation::{Kinematics, Trajectory};

use super::TRACKS;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};

type Vector6 = SVector<f64, 6>;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: ByTime = cloned;
    let mutants: [(_, ByTime); 4] = [
        ("sign", |moving| -cloned(moving)),
        ("angular velocity in the world", |moving| {
            together(
                &(moving.state.world_from_body * moving.angular_velocity),
                &moving.state.velocity,
            )
        }),
        ("velocity in the body", |moving| {
            let velocity = moving.state.world_from_body.inverse() * moving.state.velocity;
            together(&moving.angular_velocity, &velocity)
        }),
        ("turn forgotten", |moving| together(&Vector3::zeros(), &moving.state.velocity)),
    ];
    chapter.equation("clone-clock", clone_clock, formula, &mutants);
}

fn together(turn: &Vector3<f64>, shift: &Vector3<f64>) -> Vector6 {
    Vector6::from_iterator(turn.iter().chain(shift).copied())
}

/// The covariance that the library gives to a new pose and the time offset, over the variance of
/// the latter.
fn cloned(moving: &Kinematics) -> Vector6 {
    let sigma = 0.01;
    let calibrated = Calibrated { time_offset: Some(sigma), extrinsics: None };
    let camera = Pinhole { fx: 250.0, fy: 250.0, cx: 320.0, cy: 240.0 };
    let options = MsckfOptions { calibrated, ..MsckfOptions::new(camera, 1.0, ImuNoise::euroc()) };
    let rig = CameraImu { body_from_camera: Isometry3::identity(), time_offset: 0.0 };
    let start = Start {
        nanoseconds: 0,
        state: moving.state,
        bias: ImuBias::default(),
        covariance: 1e-4 * Matrix15::identity(),
        rig,
    };
    let mut filter = Msckf::new(options, &start).expect("a covariance");
    let ImuSample { gyro, accelerometer } = moving.sample(&GRAVITY);
    let sample = ImuSample { gyro, accelerometer };
    filter.reading(StampedSample { nanoseconds: 0, sample }).expect("the first");
    filter.picture(&Picture { nanoseconds: 0, features: Vec::new() }).expect("of the same time");
    filter.belief().covariance().fixed_view::<6, 1>(16, 15) / (sigma * sigma)
}

type ByTime = fn(&Kinematics) -> Vector6;

fn clone_clock(formula: ByTime) -> Comparison {
    let against = "central differences of the pose along the flight";
    let motion = Trajectory::figure_eight();
    Comparison::relative(against, 1e-6).over(TRACKS, 51, |random| {
        let time = random.uniform(0.0..20.0);
        let moving = motion.at(time);
        let pose = BodyPose::from(&moving.state);
        let oracle = differences(1e-4, |later: nalgebra::Vector1<f64>| {
            let mut step = Vector6::zeros();
            pose.local(&BodyPose::from(&motion.at(time + later.x).state), step.as_mut_slice());
            step
        });
        (formula(&moving), oracle)
    })
}
