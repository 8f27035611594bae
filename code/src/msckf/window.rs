//! The poses of a filter, and the tracks that wait until they can correct it.

use std::collections::BTreeMap;

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
    /// as many poses wait for them as the window holds.
    pub fn due(&mut self, picture: &Picture, clones: usize) -> Vec<(usize, Waiting)> {
        let is_due = |track: &usize, waiting: &mut Waiting| {
            seen(picture, *track).is_none() || waiting.len() >= clones
        };
        self.waiting.extract_if(.., is_due).collect()
    }
    // ANCHOR_END: due

    // ANCHOR: leaving
    /// The places of the poses that go now.
    pub fn leaving(&self, capacity: usize, policy: WindowPolicy) -> Vec<usize> {
        let count = self.clones.len();
        match policy {
            _ if count < capacity => Vec::new(),
            WindowPolicy::Oldest => (0..count + 1 - capacity).collect(),
            WindowPolicy::Thin => (1..count - 1).step_by(3).collect(),
        }
    }
    // ANCHOR_END: leaving

    /// Forgets poses by their places, and the pixels that were seen from them.
    pub fn forget(&mut self, places: &[usize]) {
        let gone: Vec<usize> = places.iter().map(|place| self.clones[*place].serial).collect();
        self.clones.retain(|clone| !gone.contains(&clone.serial));
        for waiting in self.waiting.values_mut() {
            waiting.retain(|(serial, _)| !gone.contains(serial));
        }
        self.waiting.retain(|_, waiting| !waiting.is_empty());
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
    /// Tracks that corrected the filter.
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
    /// Without a landmark, and with so little parallax that noise can be the reason.
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
