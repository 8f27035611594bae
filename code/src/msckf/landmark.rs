//! Where the landmark of a track is if the poses that saw it are right.

use nalgebra::{Cholesky, Isometry3, Matrix3, Vector3};
use thiserror::Error;

use super::Sight;
use crate::factors::BodyPixel;
use crate::reprojection::Pinhole;
use crate::two_views::{TriangulationError, View, triangulate, widest_parallax};

/// Steps of the search.
const MOST_STEPS: usize = 10;
/// A step that is shorter than this part of a standard deviation is the last.
const LAST_STEP: f64 = 1e-3;
/// So many standard deviations of a pixel are no noise any more.
const WIDE: f64 = 30.0;

// ANCHOR: landmark
/// The point at which the pixels of a track are most likely, the poses being what they are believed
/// to be: the linear triangulation, and steps of Gauss and Newton from there.
///
/// # Errors
///
/// A [`LandmarkError`]: two rays at least have to meet at `least_parallax` radians.
pub fn landmark(
    sights: &[Sight],
    body_from_camera: &Isometry3<f64>,
    (camera, sigma): (&Pinhole, f64),
    least_parallax: f64,
) -> Result<Vector3<f64>, LandmarkError> {
    let views = views(sights, body_from_camera, (camera, sigma));
    let mut point = triangulate(&views, least_parallax)?;
    for _ in 0..MOST_STEPS {
        let step = step(sights, &point, body_from_camera, (camera, sigma));
        let (step, length) = step.ok_or(LandmarkError::Lost)?;
        point += step;
        if length < LAST_STEP {
            return Ok(point);
        }
    }
    Err(LandmarkError::Lost)
}
// ANCHOR_END: landmark

/// Whether a track that has no landmark contradicts the poses: its rays are much farther from parallel than noise makes
/// them, so that it does not do so because it is far away or the body stands.
pub(super) fn contradicts(
    sights: &[Sight],
    body_from_camera: &Isometry3<f64>,
    (camera, sigma): (&Pinhole, f64),
) -> bool {
    widest_parallax(&views(sights, body_from_camera, (camera, sigma))) > WIDE * sigma / camera.fx
}

fn views(
    sights: &[Sight],
    body_from_camera: &Isometry3<f64>,
    (camera, sigma): (&Pinhole, f64),
) -> Vec<View> {
    let view = |sight: &Sight| {
        let world_from_camera = sight.pose.at_rest().pose() * body_from_camera;
        let camera_from_world = world_from_camera.inverse();
        View { camera: *camera, camera_from_world, pixel: sight.pixel, sigma }
    };
    sights.iter().map(view).collect()
}

/// A step of Gauss and Newton for the landmark alone, and its length in standard deviations.
fn step(
    sights: &[Sight],
    point: &Vector3<f64>,
    body_from_camera: &Isometry3<f64>,
    (camera, sigma): (&Pinhole, f64),
) -> Option<(Vector3<f64>, f64)> {
    let (mut hessian, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
    for &Sight { pose, pixel, .. } in sights {
        let seen = BodyPixel { camera, pixel, inverse_sigma: 1.0 / sigma };
        let (residual, (_, by_landmark, _)) = seen.linearize((&pose, point, body_from_camera))?;
        hessian += by_landmark.tr_mul(&by_landmark);
        gradient += by_landmark.tr_mul(&residual);
    }
    let step = -Cholesky::new(hessian)?.solve(&gradient);
    Some((step, (-step.dot(&gradient)).max(0.0).sqrt()))
}

/// Why a track has no landmark.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LandmarkError {
    /// The rays do not meet.
    #[error(transparent)]
    Triangulation(#[from] TriangulationError),
    /// The search left the cameras' view or did not end.
    #[error("no landmark fits the pixels of the track; leave it out")]
    Lost,
}
