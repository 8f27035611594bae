//! What is still to be explained once the cameras are known.

use std::collections::BTreeSet;

use nalgebra::Vector3;

use super::map::{Map, Track};

/// The last rounds change hardly anything.
const MOST_ROUNDS: usize = 12;
/// So many rounds that lower the truncated cost by less than this part are the last: one alone may raise
/// it, when it makes one point of two.
const IDLE_ROUNDS: usize = 2;
const LEAST_DECREASE: f64 = 3e-4;

/// Gates of the first rounds, in squares of the gate: what a wrong place of a camera keeps outside can
/// pull it back.
const WIDER: [f64; 3] = [9.0, 4.0, 2.0];

impl Map<'_> {
    // ANCHOR: complete
    /// Rounds of explaining more pixels and of adjusting everything: first with wider gates, then until
    /// the truncated cost does not fall any more.
    pub(super) fn complete(&mut self) {
        let gate = self.gate;
        for factor in WIDER {
            self.gate = factor * gate;
            self.explain_more();
            self.adjust_all();
        }
        self.gate = gate;
        self.filter_all(0.0);
        let (mut least, mut idle) = (self.truncated_cost(), 0);
        for _ in 0..MOST_ROUNDS {
            self.explain_more();
            self.adjust_all();
            self.filter_all(0.0);
            let now = self.truncated_cost();
            idle = if now < (1.0 - LEAST_DECREASE) * least { 0 } else { idle + 1 };
            if idle == IDLE_ROUNDS {
                break;
            }
            least = least.min(now);
        }
    }
    // ANCHOR_END: complete

    /// Half the sum of squared errors of all keypoints, in pixels: at most the gate of each, and the gate
    /// where there is no point.
    fn truncated_cost(&self) -> f64 {
        let known = self.tracks.iter().filter_map(|track| Some((track, track.point?)));
        let explained: f64 = known
            .flat_map(|(track, point)| track.sightings().map(move |k| (k, point)))
            .map(|(keypoint, point)| self.squared_error(keypoint, &point) - self.gate)
            .sum();
        0.5 * (explained + self.gate * self.arranged.count() as f64)
    }

    // ANCHOR: explain_more
    /// Looks for the points that tracks still lack, with the known cameras alone and whatever their
    /// parallax: what a point leaves over of its track becomes another one, and matches that were
    /// refused between two pictures are tried with the poses of all.
    fn explain_more(&mut self) {
        for track in 0..self.tracks.len() {
            self.improve(track);
        }
        for track in 0..self.tracks.len() {
            self.split(track);
        }
        let (mut open, mut tried) = (Vec::new(), BTreeSet::new());
        for &[a, b] in self.arranged.pairs.values().flatten() {
            match (self.explaining(a), self.explaining(b)) {
                (Some(track), None) => self.extend(track, b),
                (None, Some(track)) => self.extend(track, a),
                (None, None) => open.push([a, b]),
                (Some(one), Some(other)) if one != other => {
                    if tried.insert([one.min(other), one.max(other)]) {
                        self.merge(one, other);
                    }
                }
                (Some(_), Some(_)) => {}
            }
        }
        self.join_open(&open);
    }
    // ANCHOR_END: explain_more

    /// The track whose point explains a keypoint.
    fn explaining(&self, keypoint: usize) -> Option<usize> {
        let index = self.track_of[keypoint]?;
        let Track { keypoints, fits, point } = &self.tracks[index];
        let at = keypoints.binary_search(&keypoint).ok()?;
        (point.is_some() && fits[at]).then_some(index)
    }

    /// Looks for a point that explains more of a track.
    fn improve(&mut self, index: usize) {
        let track = &self.tracks[index];
        let posed = || track.keypoints.iter().copied().filter(|keypoint| self.is_posed(*keypoint));
        if track.point.is_some() && track.sightings().count() == posed().count() {
            return;
        }
        let before = track.point.map_or(f64::INFINITY, |point| self.cost_of(posed(), &point));
        let found = self.triangulated(&track.keypoints, 0.0);
        if let Some((point, fits)) =
            found.filter(|(point, _)| self.cost_of(posed(), point) < before)
        {
            (self.tracks[index].point, self.tracks[index].fits) = (Some(point), fits);
        }
    }

    /// Makes one track of two between which there is a match, when one point explains all that the two
    /// explain.
    fn merge(&mut self, one: usize, other: usize) {
        let mut all: Vec<usize> =
            self.tracks[one].sightings().chain(self.tracks[other].sightings()).collect();
        all.sort_unstable();
        let picture = |at: usize| self.arranged.picture_of[all[at]];
        if (1..all.len()).any(|at| picture(at) == picture(at - 1)) {
            return;
        }
        if let Some((point, fits)) = self.triangulated(&all, 0.0)
            && fits.iter().all(|fits| *fits)
        {
            self.add(all, point);
            for track in [one, other] {
                self.tracks[track].point = None;
                self.tracks[track].fits.fill(false);
            }
        }
    }

    /// Makes a track of what the point of another one leaves over, when two or more pixels of that
    /// show one point.
    fn split(&mut self, track: usize) {
        let Track { keypoints, fits, point } = &self.tracks[track];
        let left = keypoints.iter().zip(fits).filter(|(k, fits)| !**fits && self.is_posed(**k));
        let left: Vec<usize> = left.map(|(keypoint, _)| *keypoint).collect();
        if point.is_none() || left.len() < 2 {
            return;
        }
        if let Some((point, fits)) = self.triangulated(&left, 0.0) {
            let showing = left.iter().zip(fits).filter(|(_, fits)| *fits).map(|(k, _)| *k);
            self.add(showing.collect(), point);
        }
    }

    /// Takes keypoints from whatever tracks they are in, and makes one of them.
    fn add(&mut self, keypoints: Vec<usize>, point: Vector3<f64>) {
        for keypoint in &keypoints {
            self.take(*keypoint);
            self.track_of[*keypoint] = Some(self.tracks.len());
        }
        let fits = vec![true; keypoints.len()];
        self.tracks.push(Track { keypoints, fits, point: Some(point) });
    }

    /// Takes a keypoint from its track.
    fn take(&mut self, keypoint: usize) {
        let Some(track) = self.track_of[keypoint].take() else { return };
        let track = &mut self.tracks[track];
        if let Ok(at) = track.keypoints.binary_search(&keypoint) {
            track.keypoints.remove(at);
            track.fits.remove(at);
        }
    }

    /// Adds a keypoint to a track when its point explains it, and no other keypoint of the picture
    /// is explained by it.
    fn extend(&mut self, track: usize, keypoint: usize) {
        let Some(point) = self.tracks[track].point else { return };
        let picture = self.arranged.picture_of[keypoint];
        let in_picture = |k: &usize| self.arranged.picture_of[*k] == picture;
        let own = self.tracks[track].keypoints.iter().position(in_picture);
        let is_free = own.is_none_or(|at| !self.tracks[track].fits[at]);
        if !is_free || self.squared_error(keypoint, &point) > self.gate {
            return;
        }
        if let Some(at) = own {
            let other = self.tracks[track].keypoints[at];
            self.take(other);
        }
        self.take(keypoint);
        self.track_of[keypoint] = Some(track);
        let track = &mut self.tracks[track];
        let at = track.keypoints.partition_point(|k| *k < keypoint);
        track.keypoints.insert(at, keypoint);
        track.fits.insert(at, true);
    }

    /// Makes tracks of matches of which neither keypoint is explained, those that fit best first.
    fn join_open(&mut self, open: &[[usize; 2]]) {
        let mut found: Vec<(f64, [usize; 2], Vector3<f64>)> = Vec::new();
        for &pair in open {
            if let Some((point, _)) = self.triangulated(&pair, 0.0) {
                let error: f64 = pair.iter().map(|k| self.squared_error(*k, &point)).sum();
                found.push((error, pair, point));
            }
        }
        found.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        for (_, pair, point) in found {
            if pair.iter().all(|keypoint| self.explaining(*keypoint).is_none()) {
                self.add(pair.to_vec(), point);
            }
        }
    }
}
