//! How noisy each axis of an inertial measurement unit is.

use nalgebra::{Matrix6, Vector3};

use super::{ImuNoise, NoiseError};

/// Noise as continuous densities, as [`ImuNoise`] has them, but along each axis of the sensor.
/// Whatever takes a `&ImuNoise` for its densities takes a `&AxisNoise` too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisNoise {
    /// White noise of the gyroscope, in rad/s/√Hz.
    pub gyro: Vector3<f64>,
    /// White noise of the accelerometer, in m/s²/√Hz.
    pub accelerometer: Vector3<f64>,
    /// Random walk of the gyroscope's bias, in rad/s²/√Hz.
    pub gyro_walk: Vector3<f64>,
    /// Random walk of the accelerometer's bias, in m/s³/√Hz.
    pub accelerometer_walk: Vector3<f64>,
}

impl From<&ImuNoise> for AxisNoise {
    fn from(noise: &ImuNoise) -> Self {
        Self {
            gyro: Vector3::repeat(noise.gyro),
            accelerometer: Vector3::repeat(noise.accelerometer),
            gyro_walk: Vector3::repeat(noise.gyro_walk),
            accelerometer_walk: Vector3::repeat(noise.accelerometer_walk),
        }
    }
}

impl From<&AxisNoise> for AxisNoise {
    fn from(noise: &AxisNoise) -> Self {
        *noise
    }
}

impl AxisNoise {
    /// The 6×6 covariance of a reading that stands for a step of `dt` seconds, gyroscope first,
    /// as [`ImuNoise::discrete`].
    pub fn discrete(&self, dt: f64) -> Matrix6<f64> {
        squares(&self.gyro, &self.accelerometer) / dt
    }

    /// The 6×6 covariance of how far the biases walk in `seconds`, gyroscope first, as
    /// [`ImuNoise::bias_walk`].
    pub fn bias_walk(&self, seconds: f64) -> Matrix6<f64> {
        squares(&self.gyro_walk, &self.accelerometer_walk) * seconds
    }

    /// Whether the densities can be those of a sensor. Zero is allowed: it switches a source of
    /// noise off.
    ///
    /// # Errors
    ///
    /// [`NoiseError`] names the first density that is negative or not finite, with its axis
    /// unless all three are the same.
    pub fn check(&self) -> Result<(), NoiseError> {
        let named = [
            ("gyro", &self.gyro),
            ("accelerometer", &self.accelerometer),
            ("gyro_walk", &self.gyro_walk),
            ("accelerometer_walk", &self.accelerometer_walk),
        ];
        for (name, densities) in named {
            let bad = |value: &f64| !(*value >= 0.0 && value.is_finite());
            if let Some(place) = densities.iter().position(bad) {
                let value = densities[place];
                let same = densities.iter().all(|other| other.to_bits() == value.to_bits());
                let axis = (!same).then_some(['x', 'y', 'z'][place]);
                return Err(NoiseError { name, axis, value });
            }
        }
        Ok(())
    }
}

/// The diagonal matrix of squared densities, gyroscope first.
fn squares(gyro: &Vector3<f64>, accelerometer: &Vector3<f64>) -> Matrix6<f64> {
    let densities = Matrix6::from_fn(|row, column| match (row == column, row < 3) {
        (false, _) => 0.0,
        (true, true) => gyro[row],
        (true, false) => accelerometer[row - 3],
    });
    densities.component_mul(&densities)
}
