//! How noisy an inertial measurement unit is.

use nalgebra::{Matrix6, Vector3, Vector6};
use thiserror::Error;

use super::{AxisNoise, ImuBias, ImuSample};

// ANCHOR: noise
/// Noise as continuous densities, the same along all axes. The variance of a reading depends on
/// the step it stands for; the density does not. See [`AxisNoise`] for axes that differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuNoise {
    /// White noise of the gyroscope, in rad/s/√Hz.
    pub gyro: f64,
    /// White noise of the accelerometer, in m/s²/√Hz.
    pub accelerometer: f64,
    /// Random walk of the gyroscope's bias, in rad/s²/√Hz.
    pub gyro_walk: f64,
    /// Random walk of the accelerometer's bias, in m/s³/√Hz.
    pub accelerometer_walk: f64,
}
// ANCHOR_END: noise

impl ImuNoise {
    // ANCHOR: sensors
    /// A poor sensor, as in cheap consumer devices.
    pub const fn mems() -> Self {
        Self { gyro: 3.5e-3, accelerometer: 2.0e-2, gyro_walk: 2e-4, accelerometer_walk: 1e-2 }
    }

    /// The sensor of the EuRoC flights, an ADIS16448, as its data set gives it [@burri2016].
    pub const fn euroc() -> Self {
        Self {
            gyro: 1.6968e-4,
            accelerometer: 2.0e-3,
            gyro_walk: 1.9393e-5,
            accelerometer_walk: 3.0e-3,
        }
    }
    // ANCHOR_END: sensors

    // ANCHOR: discrete
    /// The 6×6 covariance of a reading that stands for a step of `dt` seconds, gyroscope first.
    /// A shorter step averages over less time. Implements {eq:inertial-density}.
    pub fn discrete(&self, dt: f64) -> Matrix6<f64> {
        let (g, a) = (self.gyro * self.gyro / dt, self.accelerometer * self.accelerometer / dt);
        Matrix6::from_diagonal(&Vector6::new(g, g, g, a, a, a))
    }

    /// The 6×6 covariance of how far the biases walk in `seconds`, gyroscope first: density
    /// squared times the time.
    pub fn bias_walk(&self, seconds: f64) -> Matrix6<f64> {
        let (g, a) = (self.gyro_walk.powi(2) * seconds, self.accelerometer_walk.powi(2) * seconds);
        Matrix6::from_diagonal(&Vector6::new(g, g, g, a, a, a))
    }
    // ANCHOR_END: discrete

    /// Whether the densities can be those of a sensor. Zero is allowed: it switches a source of
    /// noise off.
    ///
    /// # Errors
    ///
    /// [`NoiseError`] names the first density that is negative or not finite.
    pub fn check(&self) -> Result<(), NoiseError> {
        AxisNoise::from(self).check()
    }
}

// ANCHOR: corrupt
impl ImuNoise {
    /// A perfect reading as a sensor with this noise and a bias gives it, for a step of `dt`
    /// seconds. `normal` draws with mean zero and variance one. Implements {eq:inertial-model}.
    pub fn corrupt(
        &self,
        sample: &ImuSample,
        bias: &ImuBias,
        dt: f64,
        mut normal: impl FnMut() -> f64,
    ) -> ImuSample {
        let root = dt.sqrt();
        let mut noise = |density: f64| Vector3::from_fn(|_, _| density / root * normal());
        let (gyro, accelerometer) = (noise(self.gyro), noise(self.accelerometer));
        sample.biased(bias).biased(&ImuBias { gyro, accelerometer })
    }

    /// The bias `seconds` later, after its random walk.
    pub fn walk(&self, bias: &ImuBias, seconds: f64, mut normal: impl FnMut() -> f64) -> ImuBias {
        let root = seconds.sqrt();
        let mut step = |density: f64| Vector3::from_fn(|_, _| density * root * normal());
        let (gyro, accelerometer) = (step(self.gyro_walk), step(self.accelerometer_walk));
        ImuBias { gyro: bias.gyro + gyro, accelerometer: bias.accelerometer + accelerometer }
    }
}
// ANCHOR_END: corrupt

/// A density is none.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "the noise density `{name}`{} is {value}; give a finite number that is not negative",
    .axis.map(|axis| format!(" along {axis}")).unwrap_or_default()
)]
pub struct NoiseError {
    /// Its field in [`ImuNoise`] or [`AxisNoise`].
    pub name: &'static str,
    /// Its axis, `x`, `y` or `z`, or `None` where all axes have the same.
    pub axis: Option<char>,
    /// The value given.
    pub value: f64,
}
