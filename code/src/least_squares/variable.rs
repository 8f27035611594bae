//! What a problem can move.

use nalgebra::{Isometry3, Rotation3, SVector, Vector3, Vector6};

use crate::manifold::{se3, so3};

// ANCHOR: manifold
/// A point that is moved by a small vector.
pub trait Manifold: Clone {
    /// How many numbers a step has.
    fn dimension(&self) -> usize;

    /// The point moved by a step of [`Manifold::dimension`] numbers; a step of zeros leaves it
    /// where it is.
    fn retract(&self, step: &[f64]) -> Self;
}

impl<const N: usize> Manifold for SVector<f64, N> {
    fn dimension(&self) -> usize {
        N
    }

    fn retract(&self, step: &[f64]) -> Self {
        self + SVector::from_column_slice(step)
    }
}
// ANCHOR_END: manifold

// ANCHOR: rotation
/// Moved on the right, R exp(φ), by a rotation vector in radians.
impl Manifold for Rotation3<f64> {
    fn dimension(&self) -> usize {
        3
    }

    fn retract(&self, step: &[f64]) -> Self {
        so3::retract(self, &Vector3::from_column_slice(step))
    }
}

/// Moved on the right, T exp(ξ), by a translation in metres and then a rotation vector in
/// radians.
impl Manifold for Isometry3<f64> {
    fn dimension(&self) -> usize {
        6
    }

    fn retract(&self, step: &[f64]) -> Self {
        se3::retract(self, &Vector6::from_column_slice(step))
    }
}
// ANCHOR_END: rotation

// ANCHOR: pose_or_point
/// A variable of a problem that has both poses and points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PoseOrPoint {
    /// A pose, with six directions to move in.
    Pose(Isometry3<f64>),
    /// A point, in metres, with three.
    Point(Vector3<f64>),
}

impl Manifold for PoseOrPoint {
    fn dimension(&self) -> usize {
        match self {
            Self::Pose(pose) => pose.dimension(),
            Self::Point(point) => point.dimension(),
        }
    }

    fn retract(&self, step: &[f64]) -> Self {
        match self {
            Self::Pose(pose) => Self::Pose(pose.retract(step)),
            Self::Point(point) => Self::Point(point.retract(step)),
        }
    }
}
// ANCHOR_END: pose_or_point

impl PoseOrPoint {
    /// The pose, or `None` when it is a point.
    pub fn pose(&self) -> Option<&Isometry3<f64>> {
        match self {
            Self::Pose(pose) => Some(pose),
            Self::Point(_) => None,
        }
    }

    /// The point, or `None` when it is a pose.
    pub fn point(&self) -> Option<&Vector3<f64>> {
        match self {
            Self::Pose(_) => None,
            Self::Point(point) => Some(point),
        }
    }
}
