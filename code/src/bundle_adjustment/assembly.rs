//! From cameras, points and observations to variables and factors.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::{BaError, Camera, TinyBa};
use crate::factors::{MovingCamera, PixelByCamera};
use crate::least_squares::{Kernel, Key, Problem, ProblemError};
use crate::reprojection::ReprojFactor;

// ANCHOR: dropped
/// What does not take part in a solve. It stays as it is, and the cost does not count it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Observations whose point has no pixel at the start: it lies behind the camera, too near or
    /// beyond what its lens shows, or the camera is not finite. A step after which a point that is used
    /// has no pixel is rejected.
    pub without_pixel: usize,
    /// Observations of points that are seen only once: two equations for three unknowns.
    pub seen_once: usize,
    /// Points that have no usable observation, or only one.
    pub points: usize,
    /// Cameras, among those not fixed, of whose rig none sees any of the points that are left.
    pub cameras: usize,
}
// ANCHOR_END: dropped

/// A problem of the core, and what is what in it.
pub(super) struct Assembly<C, const D: usize> {
    pub(super) problem: Problem,
    pub(super) cameras: Vec<Key<MovingCamera<C, D>>>,
    pub(super) points: Vec<Key<Vector3<f64>>>,
    /// The points that are adjusted, ascending.
    pub(super) landmarks: Vec<usize>,
    /// The observations that are used, by point.
    pub(super) observations: Vec<ReprojFactor>,
    pub(super) dropped: Dropped,
}

impl<C: Camera<D>, const D: usize> Assembly<C, D> {
    // ANCHOR: assemble
    /// Checks a problem and makes a variable of each camera and point and a factor of each
    /// observation. What is fixed or sees nothing is held; cameras on one rig are tied.
    pub(super) fn new(ba: &TinyBa<C, D>) -> Result<Self, BaError> {
        check(ba)?;
        let mut dropped = Dropped::default();
        let by_point = usable_by_point(ba, &mut dropped);
        let observations: Vec<ReprojFactor> =
            by_point.iter().flatten().map(|index| ba.factors[*index]).collect();
        let landmarks: Vec<usize> =
            (0..ba.points.len()).filter(|point| !by_point[*point].is_empty()).collect();
        if landmarks.is_empty() {
            return Err(BaError::Empty { observations: ba.factors.len() });
        }
        let mut problem = Problem::new();
        let cameras: Vec<_> =
            ba.cameras.iter().map(|c| problem.add_variable(MovingCamera(c.clone()))).collect();
        let points: Vec<_> = ba.points.iter().map(|p| problem.add_variable(*p)).collect();
        let mut assembly = Self { problem, cameras, points, landmarks, observations, dropped };
        assembly.connect(ba).expect("all indices have been checked");
        Ok(assembly)
    }
    // ANCHOR_END: assemble

    /// Holds and ties variables, and adds factors.
    fn connect(&mut self, ba: &TinyBa<C, D>) -> Result<(), ProblemError> {
        let seeing: BTreeSet<usize> =
            self.observations.iter().map(|factor| ba.rig[factor.keyframe]).collect();
        let mut first_of_rig = BTreeMap::new();
        for (index, rig) in ba.rig.iter().enumerate() {
            let sees = seeing.contains(rig);
            self.dropped.cameras += usize::from(!ba.fixed[index] && !sees);
            if ba.fixed[index] || !sees {
                self.problem.hold(self.cameras[index])?;
            }
            let first = *first_of_rig.entry(*rig).or_insert(index);
            self.problem.tie(self.cameras[index], self.cameras[first])?;
        }
        let mut adjusted = self.landmarks.iter().peekable();
        for (index, point) in self.points.iter().enumerate() {
            if adjusted.next_if_eq(&&index).is_none() {
                self.problem.hold(*point)?;
            }
        }
        let kernel =
            ba.huber.filter(|huber| huber.is_finite()).map_or(Kernel::Squared, Kernel::Huber);
        for &ReprojFactor { keyframe, point, pixel, inverse_sigma } in &self.observations {
            let (camera, landmark) = (self.cameras[keyframe], self.points[point]);
            self.problem
                .add_factor(PixelByCamera { camera, landmark, pixel, inverse_sigma }, kernel)?;
        }
        Ok(())
    }
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
