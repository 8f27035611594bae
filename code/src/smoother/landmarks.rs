//! The pixels of a picture, and the landmarks that they make.

use nalgebra::{Vector2, Vector3};

use super::options::Parametrization;
use super::window::{Frame, Seen, Waiting};
use super::{Smoothed, Smoother, SmootherError};
use crate::bearing::back_project;
use crate::datasets::tracks::{Feature, Picture};
use crate::factors::{
    AnchoredPixel, BodyPixel, Exposure, PixelAtAnchor, PixelByAnchor, PixelByBody,
};
use crate::inertial::BodyPose;
use crate::initialization::Sensors;
use crate::least_squares::ProblemError;
use crate::manifold::se3;
use crate::reprojection::{RigCamera, Z_MIN};
use crate::two_views::{View, triangulate, triangulate_nonlinear};

/// Steps from infinity to the inverse depth that pixels have in common.
const STEPS: usize = 4;

impl Smoother {
    /// Adds the pixels of known landmarks; others wait.
    pub(super) fn see(
        &mut self,
        frame: &Frame,
        picture: &Picture,
        smoothed: &mut Smoothed,
    ) -> Result<(), SmootherError> {
        for feature in &picture.features {
            let mut numbers = feature.pixel.iter().chain(feature.right.iter().flatten());
            if numbers.all(|number| number.is_finite()) {
                self.see_feature(frame, feature, smoothed)?;
            } else {
                smoothed.gated += 1;
            }
        }
        Ok(())
    }

    // ANCHOR: see
    fn see_feature(
        &mut self,
        frame: &Frame,
        feature: &Feature,
        smoothed: &mut Smoothed,
    ) -> Result<(), SmootherError> {
        let Some(mut seen) = self.window.landmarks.get(&feature.track).copied() else {
            let waiting = self.window.waiting.entry(feature.track).or_default();
            waiting.push((frame.serial, *feature));
            return Ok(());
        };
        for sight in self.sights(feature) {
            let place = &self.problem.values()[seen.landmark];
            if !self.fits(frame, (seen.anchor, place), &sight) {
                smoothed.gated += 1;
                continue;
            }
            smoothed.pixels += 1;
            self.add_pixel(frame, &seen, sight)?;
            seen.last = if frame.is_keyframe { frame.serial } else { seen.last };
        }
        self.window.landmarks.insert(feature.track, seen);
        Ok(())
    }
    // ANCHOR_END: see

    /// The pixels of a feature, each with the camera that saw it.
    fn sights(&self, feature: &Feature) -> impl Iterator<Item = Sight> + use<> {
        let first = (RigCamera::first(self.options.sensors.camera), feature.pixel);
        [Some(first), self.options.right.zip(feature.right)].into_iter().flatten()
    }

    /// Where the body was when a picture was taken.
    pub(super) fn body(&self, frame: &Frame) -> BodyPose {
        let values = self.problem.values();
        let exposure = Exposure { angular_velocity: &frame.turning };
        exposure.body(&values[frame.state], values[self.window.delay].x)
    }

    /// Whether a pixel passes the gate. None behind the camera does, however wide it is.
    fn fits(&self, frame: &Frame, place: Place, sight: &Sight) -> bool {
        let off = self.off(frame, place, sight);
        off.is_finite() && off <= self.options.gate
    }

    // ANCHOR: off
    /// By how many standard deviations a pixel is off; infinite behind the camera.
    fn off(&self, frame: &Frame, (anchor, place): Place, (camera, pixel): &Sight) -> f64 {
        let values = self.problem.values();
        let (extrinsics, pixel) = (&values[self.window.extrinsics], *pixel);
        let inverse_sigma = 1.0 / self.options.sensors.pixel_sigma;
        let body = self.body(frame);
        let residual = match anchor.and_then(|serial| self.window.frame(serial)) {
            None => BodyPixel { camera, pixel, inverse_sigma }.residual((&body, place, extrinsics)),
            Some(anchor) => {
                let first = self.body(anchor);
                let seen = AnchoredPixel { camera, pixel, inverse_sigma };
                seen.residual((&first, &body, extrinsics, place))
            }
        };
        residual.map_or(f64::INFINITY, |residual| residual.norm())
    }
    // ANCHOR_END: off

    // ANCHOR: add_pixel
    /// Adds a pixel: of a point, of an anchored landmark in its anchor, or of one in another picture.
    fn add_pixel(
        &mut self,
        frame: &Frame,
        seen: &Seen,
        (camera, pixel): Sight,
    ) -> Result<(), ProblemError> {
        let (landmark, extrinsics, time_offset) =
            (seen.landmark, self.window.extrinsics, self.window.delay);
        let inverse_sigma = 1.0 / self.options.sensors.pixel_sigma;
        let (state, kernel) = (frame.state, self.options.kernel);
        let problem = &mut self.problem;
        match seen.anchor.and_then(|serial| self.window.frame(serial)) {
            None => {
                let angular_velocity = frame.turning;
                #[rustfmt::skip]
                let factor = PixelByBody {
                    state, landmark, extrinsics, time_offset, camera, angular_velocity, pixel,
                    inverse_sigma,
                };
                problem.add_factor(factor, kernel)?;
            }
            Some(anchor) if anchor.serial == frame.serial => {
                let factor = PixelAtAnchor { landmark, camera, pixel, inverse_sigma };
                problem.add_factor(factor, kernel)?;
            }
            Some(anchor) => {
                let angular_velocities = [anchor.turning, frame.turning];
                let anchor = anchor.state;
                #[rustfmt::skip]
                let factor = PixelByAnchor {
                    anchor, state, landmark, extrinsics, time_offset, camera, angular_velocities,
                    pixel, inverse_sigma,
                };
                problem.add_factor(factor, kernel)?;
            }
        }
        Ok(())
    }
    // ANCHOR_END: add_pixel

    // ANCHOR: place_landmarks
    /// Makes landmarks of the tracks of this picture that have waited long enough; a pair of pixels has.
    pub(super) fn place_landmarks(&mut self, frame: &Frame) -> Result<(), SmootherError> {
        let is_pair = |feature: &Feature| self.options.right.is_some() && feature.right.is_some();
        let ready = |(track, waiting): (&usize, &Waiting)| {
            let (_, feature) = waiting.last().filter(|(serial, _)| *serial == frame.serial)?;
            let is_ready = waiting.len() >= self.options.least_sightings || is_pair(feature);
            is_ready.then_some(*track)
        };
        let ready: Vec<usize> = self.window.waiting.iter().filter_map(ready).collect();
        for track in ready {
            let Some((anchor, place)) = self.place(&self.window.waiting[&track]) else { continue };
            let Some(waiting) = self.window.waiting.remove(&track) else { continue };
            let problem = &mut self.problem;
            let seen = self.window.add_landmark(problem, (track, anchor, frame.serial), place)?;
            for (serial, feature) in waiting {
                let Some(frame) = self.window.frame(serial).copied() else { continue };
                for sight in self.sights(&feature) {
                    self.add_pixel(&frame, &seen, sight)?;
                }
            }
        }
        Ok(())
    }
    // ANCHOR_END: place_landmarks

    // ANCHOR: place
    /// Where a landmark is most likely, if its rays meet and no pixel is far off: a point, or the picture
    /// that is its anchor, and ray and inverse depth there. An anchored landmark whose rays do not meet may
    /// still be known well enough from infinity.
    fn place(&self, waiting: &Waiting) -> Option<(Option<usize>, Vector3<f64>)> {
        let (first, _) = *waiting.first()?;
        let point = self.triangulated(waiting);
        let place = match self.options.landmarks {
            Parametrization::Point => (None, point?),
            Parametrization::InverseDepth { largest_sigma, .. } => {
                let near = point.and_then(|point| self.in_anchor(first, &point));
                let place = near.or_else(|| self.along_first_ray(waiting, largest_sigma))?;
                (Some(first), place)
            }
        };
        let (anchor, value) = &place;
        let fits = |(serial, feature): &(usize, Feature)| {
            let Some(frame) = self.window.frame(*serial) else { return false };
            self.sights(feature).all(|sight| self.fits(frame, (*anchor, value), &sight))
        };
        waiting.iter().all(fits).then_some(place)
    }
    // ANCHOR_END: place

    /// The point that its pixels show, if their rays meet.
    fn triangulated(&self, waiting: &Waiting) -> Option<Vector3<f64>> {
        let (sigma, rig) = (self.options.sensors.pixel_sigma, self.rig());
        let views = waiting.iter().filter_map(|(serial, feature)| {
            let body = self.body(self.window.frame(*serial)?);
            let first_from_world = rig.camera_from_world(&body.at_rest());
            Some(self.sights(feature).map(
                move |(RigCamera { camera, camera_from_first }, pixel)| {
                    let camera_from_world = camera_from_first * first_from_world;
                    View { camera, camera_from_world, pixel, sigma }
                },
            ))
        });
        let views: Vec<View> = views.flatten().collect();
        let start = triangulate(&views, self.options.least_angle()).ok()?;
        Some(triangulate_nonlinear(&views, &start).map_or(start, |found| found.point))
    }

    /// Ray and inverse depth of a point of the world in a picture.
    fn in_anchor(&self, serial: usize, point: &Vector3<f64>) -> Option<Vector3<f64>> {
        let values = self.problem.values();
        let body = self.body(self.window.frame(serial)?).at_rest();
        let world_from_camera = body.pose() * values[self.window.extrinsics];
        let in_camera = se3::transform(&world_from_camera.inverse(), point);
        (in_camera.z > Z_MIN).then(|| (in_camera.xy() / in_camera.z).push(1.0 / in_camera.z))
    }

    /// The point of the world where a landmark is, by its anchor if it has one.
    pub(super) fn in_world(&self, seen: &Seen) -> Option<Vector3<f64>> {
        let values = self.problem.values();
        let place = values[seen.landmark];
        let Some(anchor) = seen.anchor else { return Some(place) };
        let body = self.body(self.window.frame(anchor)?);
        let in_camera = place.xy().push(1.0) / place.z;
        let in_body = se3::transform(&values[self.window.extrinsics], &in_camera);
        (place.z > 0.0).then(|| body.world_from_body * in_body + body.position)
    }

    // ANCHOR: along_first_ray
    /// The most likely inverse depth along the first ray, in a few steps from zero, when the pixels tell it
    /// to a standard deviation: then the camera has moved so far that the landmark would have shown
    /// if it was near.
    fn along_first_ray(&self, waiting: &Waiting, largest_sigma: f64) -> Option<Vector3<f64>> {
        let (values, (first, feature)) = (self.problem.values(), waiting.first()?);
        let anchor = self.body(self.window.frame(*first)?);
        let Sensors { camera, pixel_sigma, .. } = self.options.sensors;
        let mut landmark = back_project(&camera, &feature.pixel, 1.0).xy().push(0.0);
        for _ in 0..STEPS {
            let (mut information, mut gradient) = (0.0, 0.0);
            for (serial, feature) in waiting {
                let body = self.body(self.window.frame(*serial)?);
                for (camera, pixel) in self.sights(feature) {
                    let camera = &camera;
                    let seen = AnchoredPixel { camera, pixel, inverse_sigma: 1.0 / pixel_sigma };
                    let around = (&anchor, &body, &values[self.window.extrinsics], &landmark);
                    let (residual, (.., by_landmark)) = seen.linearize(around)?;
                    information += by_landmark.column(2).norm_squared();
                    gradient += by_landmark.column(2).dot(&residual);
                }
            }
            if information.is_nan() || information * largest_sigma.powi(2) < 1.0 {
                return None;
            }
            landmark.z -= gradient / information;
        }
        Some(landmark)
    }
    // ANCHOR_END: along_first_ray
}

/// A pixel, and the camera that saw it.
type Sight = (RigCamera, Vector2<f64>);

/// The picture that is the anchor of a landmark, if it has one, and where the landmark is.
type Place<'a> = (Option<usize>, &'a Vector3<f64>);
