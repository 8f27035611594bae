//! Points that are known, and pixels that are said to show them.

use nalgebra::{DMatrix, Isometry3, Vector2, Vector3};

use super::resection::of_points;
use super::three_points::poses_of_three;
use crate::bearing::back_project;
use crate::reprojection::Pinhole;
use crate::robust_two_view::{Correspondences, Effort};

// ANCHOR: sightings
/// Points of the world and the pixels that are said to show them, not all of them rightly: data
/// about `camera_from_world`, as many as both lists have.
#[derive(Debug, Clone, Copy)]
pub struct Sightings<'a> {
    /// The intrinsics.
    pub camera: &'a Pinhole,
    /// Places in the world, in metres.
    pub points: &'a [Vector3<f64>],
    /// A pixel for each.
    pub pixels: &'a [Vector2<f64>],
    /// The standard deviation of each coordinate, in pixels.
    pub sigma: f64,
}

impl Correspondences for Sightings<'_> {
    type Estimate = Isometry3<f64>;
    const SAMPLE: usize = 3;
    const DEGREES: usize = 2;
    const PARAMETERS: usize = 6;

    fn count(&self) -> usize {
        self.points.len().min(self.pixels.len())
    }

    fn through(&self, sample: &[usize], give: &mut dyn FnMut(Isometry3<f64>)) {
        let Ok(sample) = <&[usize; 3]>::try_from(sample) else { return };
        let directions = sample.map(|datum| back_project(self.camera, &self.pixels[datum], 1.0));
        if let Ok(poses) = poses_of_three(&sample.map(|datum| self.points[datum]), &directions) {
            poses.iter().copied().for_each(give);
        }
    }

    /// Of the reprojection error; infinite behind the camera.
    fn squared_errors(&self, pose: &Isometry3<f64>, _gate: f64) -> impl Fn(usize, usize) -> f64 {
        let rotation = pose.rotation.to_rotation_matrix().into_inner();
        let translation = pose.translation.vector;
        move |here, there| {
            let pixel = self.camera.project_cam(&(rotation * self.points[here] + translation));
            let off = pixel.map(|pixel| (pixel - self.pixels[there]).norm_squared());
            off.filter(|square| square.is_finite())
                .map_or(f64::INFINITY, |square| square / (self.sigma * self.sigma))
        }
    }
    // ANCHOR_END: sightings

    fn refined(
        &self,
        start: &Isometry3<f64>,
        data: &[usize],
        effort: Effort,
    ) -> Option<Isometry3<f64>> {
        let (problem, pose) = of_points(self.camera, self.of(data), self.sigma, start);
        Some(problem.solve(&effort.options()).ok()?.values[pose].0.camera_from_world)
    }

    fn covariance(&self, pose: &Isometry3<f64>, data: &[usize]) -> Option<DMatrix<f64>> {
        let (problem, pose) = of_points(self.camera, self.of(data), self.sigma, pose);
        problem.covariance(problem.values()).ok()?.of(pose)
    }
}

impl Sightings<'_> {
    /// Some of the points, and their pixels.
    fn of(&self, data: &[usize]) -> impl Iterator<Item = (Vector3<f64>, Vector2<f64>)> {
        data.iter().map(|datum| (self.points[*datum], self.pixels[*datum]))
    }
}
