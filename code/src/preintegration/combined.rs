//! Sums over readings whose bias walks within the interval.

use nalgebra::{Matrix6, SMatrix, Vector3};

use super::block::Block;
use super::integrator::{Increment, Jacobian, Moments, Preintegrator};
use super::white::wide_either;
use super::{Matrix9x6, Preintegrated, PreintegrationError};
use crate::inertial::{AxisNoise, ImuBias, ImuSample};
use crate::least_squares::{WhiteningError, sqrt_information};

/// Matrices over the nine errors (φ, v, p) and the change of the two biases.
pub type Matrix15 = SMatrix<f64, 15, 15>;

/// Sums up readings one by one as [`Preintegrator`] does, and counts that the bias walks
/// meanwhile, by the densities `gyro_walk` and `accelerometer_walk`. Then the error of the deltas
/// depends on the change of the bias, and with it the two need one covariance of 15×15.
///
/// The deltas are those of [`Preintegrator`]: one bias is subtracted, that at the *start* of the
/// interval. The bias of a reading is that at its time, so with the Euler rule a step has the
/// bias of its beginning and with the midpoint rule the mean of those at its ends.
///
/// What the deltas lack, r = (φ, v, p) as in [`imu_residual`](super::imu_residual), goes by
/// r' = A r − B (w + η) with the matrices of [`error_dynamics`](super::error_dynamics), white
/// noise η and the walk w since the start. The derivative by the bias goes by J' = A J − B. So
/// s = r − J w, which the deltas lack when corrected for the bias at the *end*, meets each piece
/// ξ of the walk once:
///
/// s' = A s − B η − M ξ, with M = J' by the Euler rule and M = J' + ½ B by the midpoint rule.
///
/// That is the usual recursion of the covariance with one more term, M Q Mᵀ Δt, where Q holds the
/// squared densities of the walk. With E\[r wᵀ\] = K Q, where K' = A K − τ B for the time τ at
/// which the reading stands, r = s + J w has the covariance
///
/// E\[r rᵀ\] = E\[s sᵀ\] + K Q Jᵀ + J Q Kᵀ − t J Q Jᵀ.
#[derive(Debug, Clone)]
pub struct CombinedPreintegrator {
    /// The usual sums, with the covariance of s in place of that of r.
    sums: Preintegrator,
    /// The matrix K, of the form of a Jacobian.
    by_time: Jacobian,
    /// Squared densities of the walk, of gyroscope and accelerometer.
    walk: [Vector3<f64>; 2],
}

/// The readings of one interval, summed up, when their bias walks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CombinedPreintegrated {
    /// The sums at the bias of the start. Their covariance includes what the walk does to the
    /// readings.
    pub sums: Preintegrated,
    /// The 9×6 covariance of the residual (φ, v, p), states against deltas, and the bias at the
    /// end less that at the start, gyroscope first.
    pub with_bias: Matrix9x6,
    /// The 6×6 covariance of the bias at the end less that at the start.
    pub walk: Matrix6<f64>,
}

impl CombinedPreintegrator {
    /// Sums that are empty. `bias` is that at the start of the interval.
    ///
    /// # Errors
    ///
    /// As those of [`Preintegrator::new`].
    pub fn new(bias: &ImuBias, noise: impl Into<AxisNoise>) -> Result<Self, PreintegrationError> {
        let noise = noise.into();
        let walk = [noise.gyro_walk, noise.accelerometer_walk].map(|v| v.component_mul(&v));
        Ok(Self { sums: Preintegrator::new(bias, noise)?, by_time: Jacobian::default(), walk })
    }

    /// Steps longer than this, in seconds, are refused as gaps. At first
    /// [`LONGEST_STEP`](super::LONGEST_STEP).
    pub fn set_longest_step(&mut self, seconds: f64) {
        self.sums.longest_step = seconds;
    }

    /// Adds a step of `dt` seconds in which the reading holds: the Euler rule.
    ///
    /// # Errors
    ///
    /// As those of [`Preintegrator::integrate`].
    pub fn integrate(&mut self, sample: &ImuSample, dt: f64) -> Result<(), PreintegrationError> {
        let reading = self.sums.reading(sample, dt)?;
        wide_either(
            self.sums.noise.isotropic,
            #[inline(always)]
            |isotropic| self.advance(&self.sums.euler(&reading, dt), isotropic),
        );
        Ok(())
    }

    /// Adds a step of `dt` seconds between two readings: the midpoint rule.
    ///
    /// # Errors
    ///
    /// As those of [`Preintegrator::integrate`].
    pub fn integrate_midpoint(
        &mut self,
        start: &ImuSample,
        end: &ImuSample,
        dt: f64,
    ) -> Result<(), PreintegrationError> {
        let mean = self.sums.mean_reading(start, end, dt)?;
        wide_either(
            self.sums.noise.isotropic,
            #[inline(always)]
            |isotropic| self.advance(&self.sums.midpoint(&mean, dt), isotropic),
        );
        Ok(())
    }

    /// K and M use the sums as they are before the step, so the order of the lines matters.
    #[inline(always)]
    fn advance(&mut self, step: &Increment, isotropic: bool) {
        let gain = step.gain();
        // How much of the walk of a step its own reading has not seen.
        let unseen = if step.halfway.is_some() { 0.5 } else { 1.0 };
        let time = self.sums.duration + (1.0 - unseen) * step.dt;
        self.by_time.advance(step, &gain, time);
        let mut met = self.sums.jacobian;
        met.advance(step, &gain, unseen);
        self.sums.advance(step, isotropic);
        self.sums.covariance.walk(&met, &self.walk.map(|squared| step.dt * squared));
    }

    /// The sums so far.
    ///
    /// # Errors
    ///
    /// As those of [`Preintegrator::finish`].
    pub fn finish(&self) -> Result<CombinedPreintegrated, PreintegrationError> {
        let mut sums = self.sums.finish()?;
        let [gyro, accelerometer] = &self.walk;
        let densities = Matrix6::from_diagonal(
            &ImuBias { gyro: *gyro, accelerometer: *accelerometer }.vector(),
        );
        let body_from_first = sums.deltas.rotation.matrix().transpose();
        let with_bias = self.by_time.assemble(&body_from_first) * densities;
        let walk = sums.duration * densities;
        let half = (with_bias - 0.5 * sums.bias_jacobian * walk) * sums.bias_jacobian.transpose();
        sums.covariance += half + half.transpose();
        Ok(CombinedPreintegrated { sums: sums.checked()?, with_bias, walk })
    }
}

impl Moments {
    /// Adds what pieces of the walk do, of these variances and through these derivatives.
    #[inline(always)]
    fn walk(&mut self, by: &Jacobian, [gyro, accelerometer]: &[Vector3<f64>; 2]) {
        let add = |moment: &mut Block, a: &Block, variances, b: &Block| {
            *moment = *moment + a.moment(variances, b);
        };
        let [theta, velocity, position] =
            [by.theta_gyro, by.velocity_gyro, by.position_gyro].map(|block| block.transpose());
        add(&mut self.tt, &theta, gyro, &theta);
        add(&mut self.vt, &velocity, gyro, &theta);
        add(&mut self.vv, &velocity, gyro, &velocity);
        add(&mut self.pt, &position, gyro, &theta);
        add(&mut self.pv, &position, gyro, &velocity);
        add(&mut self.pp, &position, gyro, &position);
        let [velocity, position] = [by.velocity_accelerometer, by.position_accelerometer];
        add(&mut self.vv, &velocity, accelerometer, &velocity);
        add(&mut self.pv, &position, accelerometer, &velocity);
        add(&mut self.pp, &position, accelerometer, &position);
    }
}

impl CombinedPreintegrated {
    /// The 15×15 covariance of the residual (φ, v, p, δb): states against deltas as in
    /// [`imu_residual`](super::imu_residual) at the bias of the start, then the bias at the end
    /// less that at the start, gyroscope first.
    pub fn covariance(&self) -> Matrix15 {
        let mut covariance = Matrix15::zeros();
        covariance.fixed_view_mut::<9, 9>(0, 0).copy_from(&self.sums.covariance);
        covariance.fixed_view_mut::<9, 6>(0, 9).copy_from(&self.with_bias);
        covariance.fixed_view_mut::<6, 9>(9, 0).copy_from(&self.with_bias.transpose());
        covariance.fixed_view_mut::<6, 6>(9, 9).copy_from(&self.walk);
        covariance
    }

    /// The 15×15 matrix W with Wᵀ W = Σ⁻¹, which whitens the residual.
    ///
    /// # Errors
    ///
    /// [`WhiteningError`] as [`Preintegrated::sqrt_information`], and when a bias does not walk.
    pub fn sqrt_information(&self) -> Result<Matrix15, WhiteningError> {
        if self.sums.steps < 2 {
            return Err(WhiteningError::NotPositiveDefinite);
        }
        sqrt_information(&self.covariance())
    }
}
