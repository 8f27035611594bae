//! White noise of the readings, seen from the first frame.

use nalgebra::Vector3;

use super::block::Block;
use super::integrator::{Halfway, Increment};
use crate::inertial::AxisNoise;
use crate::registers::wide;

/// Densities of white noise. Where all axes have the same, directions do not matter and moments
/// are closed forms; where they differ, each step turns its noise into the first frame.
#[derive(Debug, Clone, Copy)]
pub struct White {
    /// Of the gyroscope; closed forms take its first axis for all.
    pub gyro: Vector3<f64>,
    /// Of the accelerometer, likewise.
    pub accelerometer: Vector3<f64>,
    /// Whether all axes have the same.
    pub isotropic: bool,
}

impl White {
    pub fn new(noise: &AxisNoise) -> Self {
        let AxisNoise { gyro, accelerometer, .. } = *noise;
        let same = |v: &Vector3<f64>| v.x == v.y && v.y == v.z;
        Self { gyro, accelerometer, isotropic: same(&gyro) && same(&accelerometer) }
    }

    /// Covariance of what the accelerometer's noise adds to velocity in a step of `dt` seconds.
    #[inline(always)]
    pub fn pushing(&self, along: &Block, dt: f64) -> Block {
        if self.isotropic {
            return Block::diagonal(self.accelerometer.x * self.accelerometer.x * dt);
        }
        along.moment(&(dt * self.accelerometer.component_mul(&self.accelerometer)), along)
    }

    /// Where the axes differ, the step with other moments of what the gyroscope's noise adds to θ:
    /// derivative times the variances of a reading times derivative.
    #[inline(always)]
    pub fn turning(&self, step: &Increment) -> Option<Increment> {
        if self.isotropic {
            return None;
        }
        let variances = self.gyro.component_mul(&self.gyro) / step.dt;
        let halfway = step.halfway.as_ref().map(|Halfway { turned, .. }| Halfway {
            turned: *turned,
            end_and_halfway: step.turned.moment(&variances, turned),
            halfway_and_halfway: turned.moment(&variances, turned),
        });
        Some(Increment {
            end_and_end: step.turned.moment(&variances, &step.turned),
            halfway,
            ..*step
        })
    }
}

/// Calls a function with the widest registers, telling it whether all axes have the same noise. It
/// is compiled once for either case, so that neither has branches; in a page, which has to load what is compiled,
/// once for both.
#[inline(always)]
pub fn wide_either<T>(isotropic: bool, compute: impl FnOnce(bool) -> T) -> T {
    if cfg!(target_family = "wasm") {
        compute(isotropic)
    } else if isotropic {
        wide(
            #[inline(always)]
            || compute(true),
        )
    } else {
        wide(
            #[inline(always)]
            || compute(false),
        )
    }
}
