//! Bundle adjustment of a part of the map, or of all of it.

use super::map::Map;
use crate::bundle_adjustment::{PosedPinhole, TinyBa};
use crate::least_squares::Options;
use crate::reprojection::ReprojFactor;

/// A part changes little; what is left the adjustment of all of them finds.
const LOCAL_STEPS: usize = 10;

impl Map<'_> {
    // ANCHOR: adjust
    /// Moves some cameras, and the points that they see, to the least sum of squared errors; all
    /// other cameras are held. Does nothing where there is nothing to adjust.
    pub(super) fn adjust(&mut self, moving: &[usize]) {
        let pictures: Vec<usize> =
            (0..self.poses.len()).filter(|picture| self.poses[*picture].is_some()).collect();
        let mut number = vec![0; self.poses.len()];
        pictures.iter().enumerate().for_each(|(at, picture)| number[*picture] = at);
        let mut is_moving = vec![false; self.poses.len()];
        moving.iter().for_each(|picture| is_moving[*picture] = true);
        let picture_of = &self.arranged.picture_of;
        let (mut adjusted, mut points, mut factors) = (Vec::new(), Vec::new(), Vec::new());
        for (index, track) in self.tracks.iter().enumerate() {
            let Some(point) = track.point else { continue };
            if !track.sightings().any(|keypoint| is_moving[picture_of[keypoint]]) {
                continue;
            }
            for keypoint in track.sightings() {
                let keyframe = number[picture_of[keypoint]];
                let pixel = self.arranged.pixel(keypoint);
                let inverse_sigma = 1.0 / self.options.sigma;
                factors.push(ReprojFactor { keyframe, point: points.len(), pixel, inverse_sigma });
            }
            adjusted.push(index);
            points.push(point);
        }
        let posed = pictures.iter().filter_map(|picture| {
            let intrinsics = self.arranged.pictures[*picture].camera;
            self.poses[*picture]
                .map(|camera_from_world| PosedPinhole { intrinsics, camera_from_world })
        });
        let mut problem = TinyBa::new(posed.collect(), points, factors);
        problem.fixed = pictures.iter().map(|picture| !is_moving[*picture]).collect();
        let is_all = pictures.iter().all(|picture| is_moving[*picture]);
        let mut options = Options::large_problem();
        if is_all {
            problem.fixed.iter_mut().take(1).for_each(|fixed| *fixed = true);
        } else {
            options.max_iterations = LOCAL_STEPS;
        }
        if problem.solve(&options).is_err() {
            return;
        }
        for (picture, camera) in pictures.iter().zip(&problem.cameras) {
            self.poses[*picture] = Some(camera.camera_from_world);
        }
        for (track, point) in adjusted.iter().zip(&problem.points) {
            self.tracks[*track].point = Some(*point);
        }
    }
    // ANCHOR_END: adjust

    /// Adjusts everything.
    pub(super) fn adjust_all(&mut self) {
        let all: Vec<usize> = (0..self.poses.len()).collect();
        self.adjust(&all);
    }
}
