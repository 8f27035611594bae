//! From two cameras to as many as see enough of the map.

use nalgebra::Vector2;

use super::map::Map;
use super::sightings::Sightings;
use super::{Adjustments, Joined, Refused};
use crate::robust_two_view::{Consensus, ConsensusError, ConsensusOptions, consensus};

/// So many cameras move along with a new one.
const NEIGHBOURS: usize = 6;
/// All cameras are adjusted when so many times as many are there as the last time.
pub const GROWTH: f64 = 1.15;
/// A camera that was refused is tried again when it sees so many times as many points.
const MORE_SEEN: f64 = 1.1;
/// The least number of points for a pose: three fix it, and as many again contradict.
pub const LEAST_SEEN: usize = 6;
/// Into how many parts width and height are divided, to see how points are spread.
const GRIDS: [usize; 3] = [2, 4, 8];

// ANCHOR: attempt
/// What is remembered of a picture that could not be joined.
#[derive(Clone)]
pub(super) struct Attempt {
    seen: usize,
    error: ConsensusError,
}
// ANCHOR_END: attempt

impl Map<'_> {
    // ANCHOR: grow
    /// Joins one picture after another, the best one first, until none is left that sees enough.
    pub(super) fn grow(&mut self, joined: &mut Vec<Joined>, attempts: &mut [Option<Attempt>]) {
        let mut adjusted = self.registered();
        // ANCHOR: one_more
        while let Some((picture, seen)) = self.next_picture(attempts) {
            let found = match self.resected(picture) {
                Ok(found) => found,
                Err(error) => {
                    attempts[picture] = Some(Attempt { seen, error });
                    continue;
                }
            };
            self.poses[picture] = Some(found.estimate);
            self.look_again(picture);
            if self.options.adjustments != Adjustments::None {
                let near = self.neighbours(picture);
                self.adjust(&near);
                self.filter_seen_by(&near);
            }
            let is_due = self.registered() as f64 >= GROWTH * adjusted as f64;
            if is_due && self.options.adjustments == Adjustments::LocalAndGlobal {
                self.adjust_all();
                self.filter_all(self.options.least_parallax);
                self.look_again_everywhere();
                adjusted = self.registered();
            }
            let inliers = found.inliers.len();
            joined.push(Joined { picture, seen, inliers, points: self.points() });
        }
        // ANCHOR_END: one_more
    }
    // ANCHOR_END: grow

    // ANCHOR: next_picture
    /// The picture whose known points are spread widest, counted in the cells of several grids that
    /// they fall into [@schonberger2016], and how many points it sees.
    fn next_picture(&self, attempts: &[Option<Attempt>]) -> Option<(usize, usize)> {
        let mut best: Option<(usize, usize, usize)> = None;
        for picture in (0..self.poses.len()).filter(|picture| self.poses[*picture].is_none()) {
            let pixels: Vec<Vector2<f64>> =
                self.known_in(picture).map(|(_, pixel)| pixel).collect();
            let seen = pixels.len();
            let tried = attempts[picture].as_ref();
            let is_worth_it = tried.is_none_or(|tried| seen as f64 > MORE_SEEN * tried.seen as f64);
            if seen < LEAST_SEEN || !is_worth_it {
                continue;
            }
            let spread = self.spread(picture, &pixels);
            if best.is_none_or(|(_, most, many)| (spread, seen) > (most, many)) {
                best = Some((picture, spread, seen));
            }
        }
        best.map(|(picture, _, seen)| (picture, seen))
    }
    // ANCHOR_END: next_picture

    /// The tracks in a picture whose points are known, and their pixels there.
    fn known_in(&self, picture: usize) -> impl Iterator<Item = (usize, Vector2<f64>)> {
        let known =
            self.tracks_in(picture).filter(|(track, _)| self.tracks[*track].point.is_some());
        known.map(|(track, keypoint)| (track, self.arranged.pixel(keypoint)))
    }

    /// How many cells of the grids over a picture's keypoints have a pixel, those of a finer grid
    /// counted for more.
    fn spread(&self, picture: usize, pixels: &[Vector2<f64>]) -> usize {
        let keypoints = &self.arranged.pictures[picture].keypoints;
        let (low, high) = keypoints.iter().fold(
            (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY)),
            |(low, high), pixel| (low.inf(pixel), high.sup(pixel)),
        );
        let size = (high - low).map(|size| size.max(f64::MIN_POSITIVE));
        let cells = |parts: usize| {
            let mut is_hit = vec![false; parts * parts];
            for pixel in pixels {
                let place = (pixel - low).component_div(&size) * parts as f64;
                let cell = place.map(|at| (at as usize).min(parts - 1));
                is_hit[cell.y * parts + cell.x] = true;
            }
            parts * is_hit.iter().filter(|hit| **hit).count()
        };
        GRIDS.into_iter().map(cells).sum()
    }

    // ANCHOR: resected_picture
    /// The pose of a picture from the known points that it sees.
    fn resected(
        &self,
        picture: usize,
    ) -> Result<Consensus<nalgebra::Isometry3<f64>>, ConsensusError> {
        let (points, pixels): (Vec<_>, Vec<_>) = self
            .known_in(picture)
            .filter_map(|(track, pixel)| Some((self.tracks[track].point?, pixel)))
            .unzip();
        let camera = &self.arranged.pictures[picture].camera;
        let sigma = self.options.sigma;
        let data = Sightings { camera, points: &points, pixels: &pixels, sigma };
        let seed = self.options.seed.wrapping_add(picture as u64);
        let inlier_probability = self.options.inlier_probability;
        consensus(&data, &ConsensusOptions { inlier_probability, seed, ..Default::default() })
    }
    // ANCHOR_END: resected_picture

    /// Looks at the tracks in a picture that has just got a pose: which points explain them, and
    /// which points can be found now.
    fn look_again(&mut self, picture: usize) {
        for (track, _) in self.tracks_in(picture).collect::<Vec<_>>() {
            match self.tracks[track].point {
                Some(_) => self.filter(track, 0.0),
                None => self.triangulate(track, self.options.least_parallax),
            }
        }
    }

    /// Looks at all tracks that have no point.
    fn look_again_everywhere(&mut self) {
        for track in 0..self.tracks.len() {
            if self.tracks[track].point.is_none() {
                self.triangulate(track, self.options.least_parallax);
            }
        }
    }

    pub(super) fn filter_all(&mut self, least_parallax: f64) {
        (0..self.tracks.len()).for_each(|track| self.filter(track, least_parallax));
    }

    fn filter_seen_by(&mut self, pictures: &[usize]) {
        for picture in pictures {
            for (track, _) in self.tracks_in(*picture).collect::<Vec<_>>() {
                self.filter(track, self.options.least_parallax);
            }
        }
    }

    /// A camera and those that share the most points with it.
    fn neighbours(&self, picture: usize) -> Vec<usize> {
        let mut shared = vec![0; self.poses.len()];
        for (track, _) in
            self.tracks_in(picture).filter(|(track, _)| self.tracks[*track].point.is_some())
        {
            for keypoint in self.tracks[track].sightings() {
                shared[self.arranged.picture_of[keypoint]] += 1;
            }
        }
        shared[picture] = usize::MAX;
        let mut order: Vec<usize> = (0..shared.len()).filter(|at| shared[*at] > 0).collect();
        order.sort_by(|one, other| shared[*other].cmp(&shared[*one]).then(one.cmp(other)));
        order.truncate(1 + NEIGHBOURS);
        order
    }

    /// Why a picture has no pose.
    pub(super) fn refusal(&self, picture: usize, attempt: Option<&Attempt>) -> Refused {
        let tracks = self.tracks_in(picture).count();
        let seen = self.known_in(picture).count();
        match attempt {
            _ if tracks == 0 => Refused::NoMatches,
            Some(attempt) => Refused::NoPose { seen: attempt.seen, error: attempt.error },
            None => Refused::FewPoints { tracks, seen, needed: LEAST_SEEN },
        }
    }
}
