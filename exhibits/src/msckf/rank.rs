//! How uncertain a landmark stays when all poses are known.

use nalgebra::{Matrix3, Vector2, Vector3};
use vislam::msckf::{LinearizedTrack, TrackError};

use super::TRACKS;
use super::draws::{Plan, SIGMA, Track};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Sigma = |track| {
        let mut track = track.clone();
        match track.project(0.0) {
            Err(TrackError::Rank { sigma, .. }) => sigma,
            _ => f64::NAN,
        }
    };
    let mutants: [(_, Sigma); 4] = [
        ("the best direction", |track| 1.0 / root(track).singular_values().max()),
        ("a variance", |track| root(track).singular_values().min().powi(-2)),
        ("the last entry of the triangle", |track| 1.0 / root(track)[(2, 2)].abs()),
        ("all directions together", |track| {
            root(track).try_inverse().map_or(f64::NAN, |inverse| inverse.norm())
        }),
    ];
    chapter.equation("landmark-sigma", landmark_sigma, formula, &mutants);

    for (name, spread) in
        [("sigma_metre", 1.0), ("sigma_decimetre", 0.1), ("sigma_centimetre", 0.01)]
    {
        let plan = Plan { spread, off: 0.0, landmark_off: 0.0, ..Plan::new(6) };
        let mut track = Track::drawn(&mut crate::random::Random::new(5), plan);
        track.camera = vislam::reprojection::Pinhole { fx: 250.0, fy: 250.0, cx: 320.0, cy: 240.0 };
        chapter.number(name, formula(&track.linearized()), "m", if spread < 0.5 { 1 } else { 2 });
    }
}

/// The triangle of a track.
fn root(track: &LinearizedTrack) -> Matrix3<f64> {
    let mut track = track.clone();
    let _ = track.project(f64::INFINITY);
    track.landmark_root()
}

type Sigma = fn(&LinearizedTrack) -> f64;

fn landmark_sigma(formula: Sigma) -> Comparison {
    let against = "the covariance from central differences of the pixels";
    Comparison::relative(against, 1e-5).over(TRACKS, 31, |random| {
        let track = Track::any(random);
        let mut information = Matrix3::zeros();
        for sight in &track.sights {
            let camera_from_world = (sight.pose.at_rest().pose() * track.rig).inverse();
            let by_landmark = differences(1e-5, |step: Vector3<f64>| {
                let seen = track.camera.project(&camera_from_world, &(track.landmark + step));
                seen.unwrap_or(Vector2::repeat(f64::NAN)) / SIGMA
            });
            information += by_landmark.tr_mul(&by_landmark);
        }
        let covariance = information.try_inverse().expect("the landmark is seen");
        (formula(&track.linearized()), covariance.symmetric_eigenvalues().max().sqrt())
    })
}
