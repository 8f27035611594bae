//! Seven ways to linearize one and the same filter.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::Chart;

// ANCHOR: point
/// Where a derivative is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Point {
    /// At the estimates of the moment.
    #[default]
    Latest,
    /// Of a pose or velocity at the first estimate that there was of it, and of a kept landmark
    /// where its track was linearized.
    First,
    /// At the truth, which only a simulation knows.
    Truth,
}
// ANCHOR_END: point

// ANCHOR: linearization
/// All that a filter can choose when it linearizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Linearization {
    /// Where the derivatives of a transition are taken.
    pub transitions: Point,
    /// Where those of pixels are taken.
    pub pixels: Point,
    /// In which coordinates the error stays the same when the estimate moves.
    pub chart: Chart,
    /// Whether derivatives are changed as little as possible until the free directions are free.
    pub constrained: bool,
}
// ANCHOR_END: linearization

// ANCHOR: policy
/// A way to linearize that somebody proposed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Policy {
    /// The extended Kalman filter as it stands in textbooks.
    #[default]
    Standard,
    /// First estimates [@huang2008; @huang2010].
    FirstEstimates,
    /// First estimates in transitions, the latest ones in pixels, whose derivatives are then
    /// projected [@chen2022].
    Fej2,
    /// The latest estimates everywhere, and all derivatives projected [@huang2010; @hesch2014].
    ObservabilityConstrained,
    /// The error of the group of rotation, velocity, position and landmarks, on the left
    /// [@barrau2015].
    RightInvariant,
    /// Everything relative to the body [@huai2018].
    Robocentric,
    /// Derivatives at the truth: no filter, but what a filter with perfect linearization would do.
    Ideal,
}

impl Policy {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Standard,
        Self::FirstEstimates,
        Self::Fej2,
        Self::ObservabilityConstrained,
        Self::RightInvariant,
        Self::Robocentric,
        Self::Ideal,
    ];

    // ANCHOR: choices
    /// What it chooses.
    pub const fn linearization(self) -> Linearization {
        use Chart::{RightInvariant, Robocentric, Separate};
        use Point::{First, Latest, Truth};
        let (transitions, pixels, chart, constrained) = match self {
            Self::Standard => (Latest, Latest, Separate, false),
            Self::FirstEstimates => (First, First, Separate, false),
            Self::Fej2 => (First, Latest, Separate, true),
            Self::ObservabilityConstrained => (Latest, Latest, Separate, true),
            Self::RightInvariant => (Latest, Latest, RightInvariant, false),
            Self::Robocentric => (Latest, Latest, Robocentric, false),
            Self::Ideal => (Truth, Truth, Separate, false),
        };
        Linearization { transitions, pixels, chart, constrained }
    }
    // ANCHOR_END: choices
    // ANCHOR_END: policy

    /// Its name, as [`Policy::from_str`] reads it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::FirstEstimates => "first_estimates",
            Self::Fej2 => "fej2",
            Self::ObservabilityConstrained => "observability_constrained",
            Self::RightInvariant => "right_invariant",
            Self::Robocentric => "robocentric",
            Self::Ideal => "ideal",
        }
    }
}

impl From<Policy> for Linearization {
    fn from(policy: Policy) -> Self {
        policy.linearization()
    }
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Policy {
    type Err = NoSuchPolicy;

    fn from_str(name: &str) -> Result<Self, NoSuchPolicy> {
        let found = Self::ALL.into_iter().find(|policy| policy.name() == name);
        found.ok_or_else(|| NoSuchPolicy { name: name.to_owned() })
    }
}

/// A word that names no policy.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "there is no policy “{name}”; give one of {}", Policy::ALL.map(Policy::name).join(", ")
)]
pub struct NoSuchPolicy {
    /// What was given.
    pub name: String,
}
