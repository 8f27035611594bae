//! The two pictures with which a map begins.

use nalgebra::Isometry3;

use super::map::Map;
use super::pictures::Arranged;
use super::verification::VerifiedPair;
use super::{NoFirstPair, ReconstructionOptions};
use crate::robust_two_view::{NoMotion, RelativeMotion};

/// The median depth of the first points, in the map's unit: far beyond what is too near to a camera
/// to be seen.
const MEDIAN_DEPTH: f64 = 10.0;

// ANCHOR: first_pairs
/// The verified pairs that have enough matches with parallax, those with the most of them first: an
/// angle of `first_parallax` or more is what makes a point's depth worth building on.
pub(super) fn first_pairs(
    arranged: &Arranged,
    pairs: &[VerifiedPair],
    options: &ReconstructionOptions,
) -> Vec<usize> {
    let wide = |pair: &VerifiedPair| {
        let angles = pair.parallaxes(arranged, options.sigma);
        angles.iter().filter(|angle| **angle >= options.first_parallax).count()
    };
    let mut order: Vec<(usize, usize)> =
        pairs.iter().enumerate().map(|(index, pair)| (wide(pair), index)).collect();
    order.retain(|(wide, _)| *wide >= options.least_points);
    order.sort_by(|one, other| other.0.cmp(&one.0).then(one.1.cmp(&other.1)));
    order.into_iter().map(|(_, index)| index).collect()
}
// ANCHOR_END: first_pairs

impl Map<'_> {
    // ANCHOR: begin
    /// Begins with a pair, when its matches ask for a motion, and enough points follow from it.
    pub(super) fn begin(&mut self, pair: &VerifiedPair) -> Result<(), NoFirstPair> {
        let motion = match pair.motion_of_all(self.arranged, self.options) {
            Some(Ok(motion)) => motion,
            Some(Err(NoMotion::Plane { .. })) => return Err(NoFirstPair::Plane),
            Some(Err(NoMotion::Rotation { .. })) => return Err(NoFirstPair::Rotation),
            Some(Err(NoMotion::None(_))) | None => return Err(NoFirstPair::Points),
        };
        self.place(pair, &motion, 1.0);
        let mut depths: Vec<f64> =
            self.tracks.iter().filter_map(|track| track.point).map(|point| point.z).collect();
        depths.sort_by(f64::total_cmp);
        let Some(median) = depths.get(depths.len() / 2) else { return Err(NoFirstPair::Points) };
        self.place(pair, &motion, MEDIAN_DEPTH / median);
        self.adjust_all();
        self.filter_all(self.options.least_parallax);
        match self.points() >= self.options.least_points {
            true => Ok(()),
            false => Err(NoFirstPair::Points),
        }
    }
    // ANCHOR_END: begin

    /// Puts two cameras at a distance, and their points.
    fn place(&mut self, pair: &VerifiedPair, motion: &RelativeMotion, baseline: f64) {
        let mut second = motion.second_from_first();
        second.translation.vector *= baseline;
        let [first, other] = pair.pictures;
        (self.poses[first], self.poses[other]) = (Some(Isometry3::identity()), Some(second));
        for (track, _) in self.tracks_in(first).collect::<Vec<_>>() {
            self.tracks[track].point = None;
            self.triangulate(track, self.options.least_parallax);
        }
    }
}
