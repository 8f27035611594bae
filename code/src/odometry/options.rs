//! How an odometry works.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::initialization::{BeginOptions, Sensors};
use crate::msckf::MsckfOptions;
use crate::smoother::SmootherOptions;

/// What follows a flight once it has begun.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Estimator {
    /// All states since the beginning, solved for again with every picture.
    Batch,
    /// The states of the last seconds, and a prior of what has left them.
    #[default]
    Smoother,
    /// One state, and poses of the last pictures.
    Msckf,
}

impl Estimator {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Batch, Self::Smoother, Self::Msckf];

    /// Its name, as [`Estimator::from_str`] reads it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Batch => "batch",
            Self::Smoother => "smoother",
            Self::Msckf => "msckf",
        }
    }
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Estimator {
    type Err = NoSuchEstimator;

    fn from_str(name: &str) -> Result<Self, NoSuchEstimator> {
        let found = Self::ALL.into_iter().find(|estimator| estimator.name() == name);
        found.ok_or_else(|| NoSuchEstimator { name: name.to_owned() })
    }
}

/// A word that names no estimator.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "there is no estimator “{name}”; give one of {}", Estimator::ALL.map(Estimator::name).join(", ")
)]
pub struct NoSuchEstimator {
    /// What was given.
    pub name: String,
}

// ANCHOR: odometry_options
/// How an odometry works.
#[derive(Debug, Clone)]
pub struct OdometryOptions {
    /// What is known of the sensors, and what of that is estimated.
    pub sensors: Sensors,
    /// What follows the flight once it has begun.
    pub estimator: Estimator,
    /// How a beginning is looked for.
    pub begin: BeginOptions,
    /// How the smoother works; the batch is a smoother that forgets nothing.
    pub smoother: SmootherOptions,
    /// How the filter works.
    pub msckf: MsckfOptions,
    /// For so many seconds most of what pictures show may contradict what is believed, before the
    /// odometry says that it is lost.
    pub patience: f64,
}
// ANCHOR_END: odometry_options

impl OdometryOptions {
    /// Those for some sensors, with a beginning at rest or in motion.
    pub fn new(sensors: Sensors, estimator: Estimator) -> Self {
        Self::beginning(sensors, estimator, BeginOptions::default())
    }

    /// Those for some sensors and a beginning that is looked for in this way.
    pub fn beginning(sensors: Sensors, estimator: Estimator, begin: BeginOptions) -> Self {
        let Sensors { camera, pixel_sigma, noise, calibrated, .. } = sensors;
        let msckf = MsckfOptions {
            gravity: sensors.gravity(),
            calibrated,
            ..MsckfOptions::new(camera, pixel_sigma, noise)
        };
        let smoother = SmootherOptions::new(sensors);
        Self { sensors, estimator, begin, smoother, msckf, patience: 1.0 }
    }
}
