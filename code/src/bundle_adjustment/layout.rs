//! The observations in the order in which elimination wants them: landmark by landmark,
//! and within a landmark by the rig that saw it.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use nalgebra::{Vector2, Vector3};

use super::{BaError, Camera, TinyBa};

// ANCHOR: sighting
/// One observation, with all that linearizing it needs.
#[derive(Debug, Clone, Copy)]
pub struct Sighting {
    /// Index of the camera.
    pub camera: u32,
    /// Which of the landmark's slots the camera's rig has, or [`HELD`].
    pub slot: u32,
    /// The pixel.
    pub pixel: Vector2<f64>,
    /// In 1/pixel.
    pub inverse_sigma: f64,
}
// ANCHOR_END: sighting

/// The slot of a camera that does not move.
pub const HELD: u32 = u32::MAX;

// ANCHOR: landmark
/// A point that is to be adjusted, and where the lists of its sightings and of the rigs
/// that saw it begin and end.
#[derive(Debug, Clone)]
pub struct Landmark {
    /// Index of the point.
    pub point: usize,
    /// Its part of [`Layout::sightings`].
    pub sightings: Range<usize>,
    /// Its part of [`Layout::slots`].
    pub slots: Range<usize>,
}
// ANCHOR_END: landmark

// ANCHOR: layout
/// The problem's structure. It stays the same from step to step.
#[derive(Debug, Clone)]
pub struct Layout {
    /// By landmark, and within a landmark by rig.
    pub sightings: Vec<Sighting>,
    /// For each landmark the moving rigs that see it, by their row in the reduced system,
    /// ascending.
    pub slots: Vec<usize>,
    /// The points that are adjusted.
    pub landmarks: Vec<Landmark>,
    /// For each camera, the row of its rig in the reduced system, unless it is held.
    pub row_of: Vec<Option<usize>>,
    /// How many rows of blocks the reduced system has.
    pub rows: usize,
    /// What was left out.
    pub dropped: Dropped,
}
// ANCHOR_END: layout

// ANCHOR: dropped
/// What does not take part in a solve. It stays as it is, and the cost does not count it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Observations whose point has no pixel at the start, because it lies behind the
    /// camera or too near. Points that start in front stay there: a step that would take
    /// one behind is rejected.
    pub without_pixel: usize,
    /// Observations of points that are seen only once: two equations for three unknowns.
    pub seen_once: usize,
    /// Points that have no usable observation, or only one.
    pub points: usize,
    /// Cameras, among those not fixed, that see none of the points that are left.
    pub cameras: usize,
}
// ANCHOR_END: dropped

impl Layout {
    /// Checks a problem and sorts its observations.
    pub fn new<C: Camera<D>, const D: usize>(problem: &TinyBa<C, D>) -> Result<Self, BaError> {
        check(problem)?;
        let mut dropped = Dropped::default();
        let by_point = usable_by_point(problem, &mut dropped);
        let row_of = number_rigs(problem, &by_point, &mut dropped);
        let rows = row_of.iter().flatten().max().map_or(0, |last| last + 1);
        let sightings = by_point.iter().map(Vec::len).sum();
        let mut layout = Self {
            sightings: Vec::with_capacity(sightings),
            slots: Vec::with_capacity(sightings),
            landmarks: Vec::with_capacity(by_point.len()),
            row_of,
            rows,
            dropped,
        };
        for (point, seen_by) in by_point.into_iter().enumerate() {
            if !seen_by.is_empty() {
                layout.add_landmark(problem, point, seen_by);
            }
        }
        if layout.landmarks.is_empty() {
            return Err(BaError::Empty { observations: problem.factors.len() });
        }
        Ok(layout)
    }

    /// Adds a point with the indices of its observations.
    fn add_landmark<C, const D: usize>(
        &mut self,
        problem: &TinyBa<C, D>,
        point: usize,
        mut seen_by: Vec<usize>,
    ) {
        seen_by.sort_by_key(|index| self.row_of[problem.factors[*index].keyframe]);
        let (sightings, slots) = (self.sightings.len(), self.slots.len());
        for index in seen_by {
            let factor = &problem.factors[index];
            let slot = self.row_of[factor.keyframe].map_or(HELD, |row| {
                if self.slots[slots..].last() != Some(&row) {
                    self.slots.push(row);
                }
                (self.slots.len() - slots - 1) as u32
            });
            let (pixel, inverse_sigma) = (factor.pixel, factor.inverse_sigma);
            self.sightings.push(Sighting {
                camera: factor.keyframe as u32,
                slot,
                pixel,
                inverse_sigma,
            });
        }
        let (sightings, slots) = (sightings..self.sightings.len(), slots..self.slots.len());
        self.landmarks.push(Landmark { point, sightings, slots });
    }

    /// Who sees a landmark: its sightings, and the rows of its rigs in the reduced system.
    #[inline]
    pub fn seen(&self, landmark: &Landmark) -> (&[Sighting], &[usize]) {
        let sightings = &self.sightings[landmark.sightings.clone()];
        (sightings, &self.slots[landmark.slots.clone()])
    }

    /// The memory that it holds, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Sighting>() * self.sightings.capacity()
            + size_of::<Landmark>() * self.landmarks.capacity()
            + size_of::<usize>() * self.slots.capacity()
            + size_of::<Option<usize>>() * self.row_of.capacity()
    }

    // ANCHOR: first_column
    /// For each row of blocks of the reduced system the first column in which something
    /// stands: the first rig that shares a point with the row's rig.
    pub fn first_columns(&self) -> Vec<usize> {
        let mut first: Vec<usize> = (0..self.rows).collect();
        for landmark in &self.landmarks {
            let slots = &self.slots[landmark.slots.clone()];
            for &row in slots {
                first[row] = first[row].min(slots[0]);
            }
        }
        first
    }

    /// Products of two blocks that elimination takes: one for each pair of rigs that share
    /// a point, a rig and itself included.
    ///
    /// Implements {eq:block-products}.
    pub fn block_products(&self) -> usize {
        let pairs = |landmark: &Landmark| landmark.slots.len() * (landmark.slots.len() + 1) / 2;
        self.landmarks.iter().map(pairs).sum()
    }
    // ANCHOR_END: first_column
}

/// The lists have the right lengths and all numbers make sense.
fn check<C, const D: usize>(problem: &TinyBa<C, D>) -> Result<(), BaError> {
    let cameras = problem.cameras.len();
    for (list, found) in [("fixed", problem.fixed.len()), ("rig", problem.rig.len())] {
        if found != cameras {
            return Err(BaError::Length { list, found, cameras });
        }
    }
    if let Some(value) = problem.huber.filter(|value| value.is_nan() || *value <= 0.0) {
        return Err(BaError::Huber { value });
    }
    let mut fixed_rigs = BTreeMap::new();
    for (rig, fixed) in problem.rig.iter().zip(&problem.fixed) {
        if *fixed_rigs.entry(*rig).or_insert(*fixed) != *fixed {
            return Err(BaError::Rig { rig: *rig });
        }
    }
    let finite = |point: &Vector3<f64>| point.iter().all(|x| x.is_finite());
    if let Some(point) = problem.points.iter().position(|point| !finite(point)) {
        return Err(BaError::Point { point });
    }
    for (observation, factor) in problem.factors.iter().enumerate() {
        let indices =
            [("camera", factor.keyframe, cameras), ("point", factor.point, problem.points.len())];
        for (what, index, count) in indices {
            if index >= count {
                return Err(BaError::Index { observation, what, index, count });
            }
        }
        let (u, v, value) = (factor.pixel.x, factor.pixel.y, factor.inverse_sigma);
        if !(u.is_finite() && v.is_finite()) {
            return Err(BaError::Pixel { observation, u, v });
        }
        if !(value.is_finite() && value > 0.0) {
            return Err(BaError::Sigma { observation, value });
        }
    }
    Ok(())
}

/// For each point its usable observations: those that have a pixel at the start, if there
/// are two.
fn usable_by_point<C: Camera<D>, const D: usize>(
    problem: &TinyBa<C, D>,
    dropped: &mut Dropped,
) -> Vec<Vec<usize>> {
    let mut by_point = vec![Vec::new(); problem.points.len()];
    for (index, factor) in problem.factors.iter().enumerate() {
        let point = &problem.points[factor.point];
        if problem.cameras[factor.keyframe].project(point).is_some() {
            by_point[factor.point].push(index);
        } else {
            dropped.without_pixel += 1;
        }
    }
    for seen_by in &mut by_point {
        if seen_by.len() < 2 {
            dropped.seen_once += seen_by.len();
            dropped.points += 1;
            seen_by.clear();
        }
    }
    by_point
}

/// For each camera the row of its rig in the reduced system; `None` when it is fixed or
/// sees nothing.
fn number_rigs<C, const D: usize>(
    problem: &TinyBa<C, D>,
    by_point: &[Vec<usize>],
    dropped: &mut Dropped,
) -> Vec<Option<usize>> {
    let mut rig_sees = BTreeSet::new();
    for &index in by_point.iter().flatten() {
        rig_sees.insert(problem.rig[problem.factors[index].keyframe]);
    }
    // Rigs are numbered in the order of their first camera, so that a band stays a band.
    let mut row_of_rig = BTreeMap::new();
    let mut row_of = Vec::with_capacity(problem.cameras.len());
    for (rig, fixed) in problem.rig.iter().zip(&problem.fixed) {
        let moves = !fixed && rig_sees.contains(rig);
        dropped.cameras += usize::from(!fixed && !moves);
        let rows = row_of_rig.len();
        row_of.push(moves.then(|| *row_of_rig.entry(*rig).or_insert(rows)));
    }
    row_of
}
