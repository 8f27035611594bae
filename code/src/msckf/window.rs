//! The poses of a filter, and the tracks that wait until they can correct it.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Vector2, Vector3};

use super::WindowPolicy;
use super::update::seen;
use crate::consistency::Claimed;
use crate::datasets::tracks::Picture;
use crate::inertial::BodyPose;

/// A pose in the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clone {
    /// Its variable in the belief.
    pub variable: usize,
    /// Its number among all that there ever were.
    pub serial: usize,
    /// The picture that was taken there, counted from zero.
    pub picture: usize,
    /// The estimate that it began with.
    pub first: BodyPose,
}

/// A landmark that is kept in the state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kept {
    pub track: usize,
    pub variable: usize,
    /// Where its track was linearized when it came into the state.
    pub first: Vector3<f64>,
}

/// Pixels that have not corrected anything yet: the number of the pose, and where.
pub(super) type Waiting = Vec<(usize, Vector2<f64>)>;

/// Pixels of a track that are to correct the filter now.
#[derive(Debug, Clone)]
pub(super) struct Due {
    pub track: usize,
    pub waiting: Waiting,
    /// Whether the track goes on with the pixels that it has at other poses.
    pub is_part: bool,
}

/// What the belief has besides state, biases and calibration, and what it has not used yet.
#[derive(Debug, Clone, Default)]
pub(super) struct Window {
    /// Oldest first.
    pub clones: Vec<Clone>,
    pub kept: Vec<Kept>,
    pub waiting: BTreeMap<usize, Waiting>,
    pub next_serial: usize,
}

impl Window {
    /// The place of a pose in the window, by its number.
    pub fn place(&self, serial: usize) -> Option<usize> {
        self.clones.binary_search_by_key(&serial, |clone| clone.serial).ok()
    }

    // ANCHOR: due
    /// Takes out the tracks that are to correct the filter now, because they have ended or because
    /// they were seen from so many poses.
    pub fn due(&mut self, picture: &Picture, longest: usize) -> Vec<Due> {
        let is_due = |track: &usize, waiting: &mut Waiting| {
            seen(picture, *track).is_none() || waiting.len() >= longest
        };
        let due = self.waiting.extract_if(.., is_due);
        due.map(|(track, waiting)| Due { track, waiting, is_part: false }).collect()
    }
    // ANCHOR_END: due

    // ANCHOR: leaving
    /// The places of the poses that go now. The newest one never does.
    pub fn leaving(&self, capacity: usize, policy: WindowPolicy) -> Vec<usize> {
        let count = self.clones.len();
        if policy == WindowPolicy::Oldest {
            return (0..(count + 1).saturating_sub(capacity)).collect();
        }
        let needed = self.waiting.values().flatten().map(|(serial, _)| *serial);
        let needed: BTreeSet<usize> = needed.collect();
        let is_idle = |place: &usize| !needed.contains(&self.clones[*place].serial);
        let idle: Vec<usize> = (0..count - 1).filter(is_idle).collect();
        let is_full = count - idle.len() >= capacity;
        if is_full { (1..count - 1).step_by(3).collect() } else { idle }
    }
    // ANCHOR_END: leaving

    /// Takes out the pixels at poses that leave, given by their places: where a track has two of them,
    /// they are due.
    pub fn take(&mut self, places: &[usize]) -> Vec<Due> {
        let leaves = |serial| places.iter().any(|place| self.clones[*place].serial == serial);
        let mut due = Vec::new();
        for (track, waiting) in &mut self.waiting {
            let own: Waiting = waiting.extract_if(.., |(serial, _)| leaves(*serial)).collect();
            if own.len() > 1 {
                due.push(Due { track: *track, waiting: own, is_part: true });
            }
        }
        self.waiting.retain(|_, waiting| !waiting.is_empty());
        due
    }

    /// Calls the variables by other numbers.
    pub fn renumber(&mut self, number: impl Fn(usize) -> usize) {
        self.clones.iter_mut().for_each(|clone| clone.variable = number(clone.variable));
        self.kept.iter_mut().for_each(|kept| kept.variable = number(kept.variable));
    }
}

/// What became of the tracks of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PictureReport {
    /// Tracks that corrected the filter, those of kept landmarks among them.
    pub used: usize,
    /// Rows of the correction.
    pub rows: usize,
    /// Tracks that were refused, and why.
    pub refused: Refusals,
    /// Whether the body was at rest, so that the picture was not kept.
    pub at_rest: bool,
    /// What the correction claims to know of shifts and of a turn about the vertical.
    pub claimed: Claimed,
}

/// Tracks that did not correct a filter, by the reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Refusals {
    /// Seen in too few pictures.
    pub short: usize,
    /// Without a landmark, and with so little parallax that noise can be the reason; or behind where a pose
    /// is linearized, or of unknown truth.
    pub landmark: usize,
    /// The pixels leave the landmark too uncertain.
    pub rank: usize,
    /// Without a landmark although the rays are far from parallel: they contradict the belief.
    pub unmet: usize,
    /// The pixels contradict the belief.
    pub gated: usize,
}

impl Refusals {
    /// How many tracks did not show where their landmark is.
    pub fn without_landmark(&self) -> usize {
        self.short + self.landmark + self.unmet + self.rank
    }

    /// How many tracks were refused, whatever the reason.
    pub fn total(&self) -> usize {
        self.without_landmark() + self.gated
    }
}
