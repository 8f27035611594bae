//! What follows a flight that has begun.

use nalgebra::Vector3;

use super::{Estimate, Estimator, OdometryError, OdometryOptions};
use crate::datasets::tracks::Picture;
use crate::inertial::{BodyPose, CameraImu, NavState, StampedSample};
use crate::msckf::{Msckf, Refusals, Start};
use crate::smoother::{Smoother, SmootherOptions};

/// What follows a flight that has begun.
#[derive(Debug)]
pub(super) enum Engine {
    Window(Box<Smoother>),
    Filter(Box<Msckf>),
}

/// What an estimator made of a picture: what it used, and what contradicted it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Seen {
    pub used: usize,
    pub refused: usize,
}

impl Engine {
    // ANCHOR: engine
    pub fn new(options: &OdometryOptions, start: &Start) -> Result<Self, OdometryError> {
        let smoother = options.smoother;
        Ok(match options.estimator {
            Estimator::Smoother => Self::Window(Box::new(Smoother::new(smoother, start)?)),
            Estimator::Batch => {
                let all = SmootherOptions { lag: f64::INFINITY, ..smoother };
                Self::Window(Box::new(Smoother::new(all, start)?))
            }
            Estimator::Msckf => Self::Filter(Box::new(Msckf::new(options.msckf, start)?)),
        })
    }
    // ANCHOR_END: engine

    pub fn reading(&mut self, reading: StampedSample) -> Result<(), OdometryError> {
        match self {
            Self::Window(smoother) => smoother.reading(reading)?,
            Self::Filter(filter) => filter.reading(reading)?,
        }
        Ok(())
    }

    pub fn picture(&mut self, picture: &Picture) -> Result<Seen, OdometryError> {
        Ok(match self {
            Self::Window(smoother) => {
                let smoothed = smoother.picture(picture)?;
                Seen { used: smoothed.pixels, refused: smoothed.gated }
            }
            Self::Filter(filter) => {
                let report = filter.picture(picture)?;
                let Refusals { unmet, gated, .. } = report.refused;
                Seen { used: report.used, refused: unmet + gated }
            }
        })
    }

    /// The camera and its clock, as they are believed to be.
    pub fn rig(&self) -> CameraImu {
        match self {
            Self::Window(smoother) => smoother.rig(),
            Self::Filter(filter) => filter.rig(),
        }
    }

    /// The clock by which a picture is placed among the readings: that of a window is the nominal one, since what is
    /// estimated moves its pixels.
    pub fn clock(&self, nominal: &CameraImu) -> CameraImu {
        match self {
            Self::Window(_) => *nominal,
            Self::Filter(filter) => filter.rig(),
        }
    }

    /// The newest state.
    pub fn newest(&self) -> Estimate {
        match self {
            Self::Window(smoother) => {
                let (nanoseconds, state, bias) = smoother.state();
                Estimate { nanoseconds, state, bias, covariance: *smoother.covariance() }
            }
            Self::Filter(filter) => Estimate {
                nanoseconds: filter.nanoseconds(),
                state: *filter.state(),
                bias: *filter.bias(),
                covariance: filter.covariance(),
            },
        }
    }

    /// The states or poses of the window.
    pub fn window(&self) -> Vec<NavState> {
        match self {
            Self::Window(smoother) => smoother.states().map(|(_, state)| state).collect(),
            Self::Filter(filter) => {
                let poses = filter.belief().values().of_kind::<BodyPose>().iter();
                poses.map(BodyPose::at_rest).collect()
            }
        }
    }

    /// The landmarks of the window.
    pub fn points(&self) -> Vec<(usize, Vector3<f64>)> {
        match self {
            Self::Window(smoother) => smoother.points().collect(),
            Self::Filter(_) => Vec::new(),
        }
    }

    /// The state of some seconds ago, as it is believed now.
    pub fn ago(&self, seconds: f64) -> Option<(i64, NavState)> {
        match self {
            Self::Window(smoother) => {
                let (nanoseconds, state, _) = smoother.ago(seconds);
                Some((nanoseconds, state))
            }
            Self::Filter(_) => None,
        }
    }
}
