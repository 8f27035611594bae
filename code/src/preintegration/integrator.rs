//! The sums over the readings, one reading at a time.
//!
//! The error of the attitude is held as a rotation vector θ in the *first* body frame.
//! There it stays where it is while the body turns, and of the error dynamics only two cross
//! products are left, {eq:covariance-first-frame}. What is handed out is in the order and frames
//! of the module.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::block::Block;
use super::turning::{Turn, Turning};
use super::white::{White, wide_either};
use super::{Deltas, LONGEST_STEP, Matrix9, Matrix9x6, Preintegrated, PreintegrationError};
use crate::inertial::{AxisNoise, ImuBias, ImuSample};

// ANCHOR: preintegrator
/// Sums up readings one by one. [`Preintegrator::finish`] gives the result so far, and more
/// readings may follow.
#[derive(Debug, Clone)]
pub struct Preintegrator {
    /// Steps longer than this, in seconds, are refused as gaps. At first [`LONGEST_STEP`].
    pub longest_step: f64,
    pub(super) bias: ImuBias,
    pub(super) noise: White,
    pub(super) duration: f64,
    steps: usize,
    greatest_force_squared: f64,
    rotation: Block,
    velocity: Vector3<f64>,
    position: Vector3<f64>,
    pub(super) covariance: Moments,
    pub(super) jacobian: Jacobian,
}
// ANCHOR_END: preintegrator

/// Second moments of the errors θ, v and p; the blocks on and below the diagonal.
#[derive(Debug, Clone, Default)]
pub(super) struct Moments {
    pub(super) tt: Block,
    pub(super) vt: Block,
    pub(super) vv: Block,
    pub(super) pt: Block,
    pub(super) pv: Block,
    pub(super) pp: Block,
}

/// Derivatives of θ, v and p by the biases of gyroscope and accelerometer. Those by the
/// gyroscope's are transposed, as their recursion wants them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Jacobian {
    pub(super) theta_gyro: Block,
    pub(super) velocity_gyro: Block,
    pub(super) position_gyro: Block,
    pub(super) velocity_accelerometer: Block,
    pub(super) position_accelerometer: Block,
}

// ANCHOR: step
/// What one step adds, by whichever rule.
pub(super) struct Increment {
    pub(super) dt: f64,
    /// The rotation at its end.
    pub(super) rotation: Block,
    /// The rotation that turns the force into the first frame.
    pub(super) along: Block,
    /// The force, in the frame that `along` turns.
    pub(super) force: Vector3<f64>,
    /// Derivative of θ at the end of the step by the angular velocity.
    pub(super) turned: Block,
    /// Covariance of what the gyroscope's noise adds to θ until the end of the step.
    pub(super) end_and_end: Block,
    /// What has come of it where the force acts, if that is not the beginning.
    pub(super) halfway: Option<Halfway>,
}

/// What an error of the angular velocity has done to θ in half a step.
pub(super) struct Halfway {
    /// Derivative by the angular velocity.
    pub(super) turned: Block,
    /// Covariance of what the noise adds until the end and until here.
    pub(super) end_and_halfway: Block,
    pub(super) halfway_and_halfway: Block,
}
// ANCHOR_END: step

impl Increment {
    /// What velocity gains.
    #[inline(always)]
    pub(super) fn gain(&self) -> Vector3<f64> {
        self.dt * (self.along * self.force)
    }

    // ANCHOR: step_euler
    /// The Euler rule. The turn φ is that of the step; R exp(φ) and R J(φ), with the left
    /// Jacobian J, are both R times a polynomial in φ^.
    #[inline(always)]
    fn euler(rotation: &Block, reading: &ImuSample, dt: f64, gyro: f64) -> Self {
        let turning = Turning::new(rotation, &(dt * reading.gyro));
        let Turn { sinc: s, cosc: c, sinc_remainder: r } = turning.coefficients;
        let variance = gyro * gyro * dt;
        Self {
            dt,
            rotation: turning.times(s, c),
            along: *rotation,
            force: reading.accelerometer,
            turned: dt * turning.times(c, r),
            end_and_end: turning.moment(variance, r * (1.0 + s) - c * c),
            halfway: None,
        }
    }
    // ANCHOR_END: step_euler

    // ANCHOR: step_midpoint
    /// The midpoint rule. The turn φ is that of half the step, and what belongs to the whole of
    /// it is again a polynomial in φ^, by the formulas for the double angle.
    #[inline(always)]
    fn midpoint(rotation: &Block, reading: &ImuSample, dt: f64, gyro: f64) -> Self {
        let half = 0.5 * dt;
        let turning = Turning::new(rotation, &(half * reading.gyro));
        let Turn { sinc: s, cosc: c, sinc_remainder: r } = turning.coefficients;
        let (cosine, whole) = (1.0 - c * turning.square, r * (1.0 + s));
        let variance = gyro * gyro * dt;
        let skew = turning.skew(0.5 * variance * s * c);
        Self {
            dt,
            rotation: turning.times(2.0 * s * cosine, 2.0 * s * s),
            along: turning.times(s, c),
            force: reading.accelerometer,
            turned: dt * turning.times(s * s, r + s * c),
            end_and_end: turning.moment(variance, whole),
            halfway: Some(Halfway {
                turned: half * turning.times(c, r),
                end_and_halfway: turning.moment(0.5 * variance, whole) + skew,
                halfway_and_halfway: turning.moment(0.25 * variance, whole - c * c),
            }),
        }
    }
    // ANCHOR_END: step_midpoint
}

impl Preintegrator {
    /// Sums that are empty.
    ///
    /// # Errors
    ///
    /// [`PreintegrationError::Bias`] or [`PreintegrationError::Noise`] when these cannot be used.
    pub fn new(bias: &ImuBias, noise: impl Into<AxisNoise>) -> Result<Self, PreintegrationError> {
        let noise = noise.into();
        noise.check()?;
        if !bias.is_finite() {
            let (gyro, accelerometer) = (bias.gyro.into(), bias.accelerometer.into());
            return Err(PreintegrationError::Bias { gyro, accelerometer });
        }
        Ok(Self {
            longest_step: LONGEST_STEP,
            bias: *bias,
            noise: White::new(&noise),
            duration: 0.0,
            steps: 0,
            greatest_force_squared: 0.0,
            rotation: Block::diagonal(1.0),
            velocity: Vector3::zeros(),
            position: Vector3::zeros(),
            covariance: Moments::default(),
            jacobian: Jacobian::default(),
        })
    }

    // ANCHOR: integrate
    /// Adds a step of `dt` seconds in which the reading holds: the Euler rule.
    ///
    /// # Errors
    ///
    /// [`PreintegrationError::Step`], [`PreintegrationError::Gap`] or
    /// [`PreintegrationError::Sample`]; the sums stay as they were.
    pub fn integrate(&mut self, sample: &ImuSample, dt: f64) -> Result<(), PreintegrationError> {
        let reading = self.reading(sample, dt)?;
        wide_either(
            self.noise.isotropic,
            #[inline(always)]
            |isotropic| self.advance(&self.euler(&reading, dt), isotropic),
        );
        Ok(())
    }
    // ANCHOR_END: integrate

    /// Adds a step of `dt` seconds between two readings: the midpoint rule.
    /// Implements {eq:preint-midpoint}.
    ///
    /// Neighbouring steps share a reading and its noise. The covariance treats each step as one
    /// reading with noise of its own, which sums to the same but for half a reading at each end.
    ///
    /// # Errors
    ///
    /// As those of [`Preintegrator::integrate`].
    // ANCHOR: integrate_midpoint
    pub fn integrate_midpoint(
        &mut self,
        start: &ImuSample,
        end: &ImuSample,
        dt: f64,
    ) -> Result<(), PreintegrationError> {
        let mean = self.mean_reading(start, end, dt)?;
        wide_either(
            self.noise.isotropic,
            #[inline(always)]
            |isotropic| self.advance(&self.midpoint(&mean, dt), isotropic),
        );
        Ok(())
    }
    // ANCHOR_END: integrate_midpoint

    /// The step by the Euler rule in which a reading, free of bias, holds.
    #[inline(always)]
    pub(super) fn euler(&self, reading: &ImuSample, dt: f64) -> Increment {
        Increment::euler(&self.rotation, reading, dt, self.noise.gyro.x)
    }

    /// The step by the midpoint rule in which the mean of two readings, free of bias, holds.
    #[inline(always)]
    pub(super) fn midpoint(&self, mean: &ImuSample, dt: f64) -> Increment {
        Increment::midpoint(&self.rotation, mean, dt, self.noise.gyro.x)
    }

    /// A reading for a step, free of bias, if both can be used.
    #[inline]
    pub(super) fn reading(
        &self,
        sample: &ImuSample,
        dt: f64,
    ) -> Result<ImuSample, PreintegrationError> {
        self.check(sample, dt)?;
        Ok(sample.corrected(&self.bias))
    }

    /// The mean of the readings at both ends of a step, free of bias.
    #[inline]
    pub(super) fn mean_reading(
        &self,
        start: &ImuSample,
        end: &ImuSample,
        dt: f64,
    ) -> Result<ImuSample, PreintegrationError> {
        self.check(start, dt)?;
        self.check(end, dt)?;
        Ok(ImuSample::mean(start, end).corrected(&self.bias))
    }

    /// Whether a reading and the step it stands for can be used.
    fn check(&self, sample: &ImuSample, dt: f64) -> Result<(), PreintegrationError> {
        let (step, longest) = (self.steps, self.longest_step);
        if dt > 0.0 && dt <= longest && sample.is_finite() {
            return Ok(());
        }
        Err(if dt.is_nan() || dt <= 0.0 {
            PreintegrationError::Step { step, dt }
        } else if sample.is_finite() {
            PreintegrationError::Gap { step, dt, longest }
        } else {
            let (gyro, accelerometer) = (sample.gyro.into(), sample.accelerometer.into());
            PreintegrationError::Sample { step, gyro, accelerometer }
        })
    }

    // ANCHOR: advance
    /// Covariance and Jacobians use the deltas and one another as they are before the step, so
    /// the order of the lines matters.
    #[inline(always)]
    pub(super) fn advance(&mut self, step: &Increment, isotropic: bool) {
        let noise = White { isotropic, ..self.noise };
        let by_axis = noise.turning(step);
        let step = by_axis.as_ref().unwrap_or(step);
        let (dt, gain) = (step.dt, step.gain());
        self.covariance.advance(step, &gain, &noise);
        self.jacobian.advance(step, &gain, 1.0);
        self.position += dt * (self.velocity + 0.5 * gain);
        self.velocity += gain;
        self.rotation = step.rotation;
        self.duration += dt;
        self.steps += 1;
        self.greatest_force_squared = self.greatest_force_squared.max(step.force.norm_squared());
    }
    // ANCHOR_END: advance

    /// The sums so far.
    ///
    /// # Errors
    ///
    /// [`PreintegrationError::Empty`] before the first step, [`PreintegrationError::Overflow`]
    /// when something was too large to be summed.
    // ANCHOR: finish
    pub fn finish(&self) -> Result<Preintegrated, PreintegrationError> {
        let Self { duration, steps, bias, velocity, position, .. } = *self;
        if steps == 0 {
            return Err(PreintegrationError::Empty);
        }
        let rotation = Rotation3::from_matrix_unchecked(self.rotation.matrix());
        let body_from_first = rotation.matrix().transpose();
        let covariance = self.covariance.assemble(&body_from_first);
        let bias_jacobian = self.jacobian.assemble(&body_from_first);
        let greatest_force = self.greatest_force_squared.sqrt();
        let deltas = Deltas { rotation, velocity, position };
        #[rustfmt::skip]
        let sums = Preintegrated {
            duration, steps, deltas, covariance, bias_jacobian, bias, greatest_force,
        };
        sums.checked()
    }
    // ANCHOR_END: finish
}

impl Moments {
    /// The covariance after a step in which the errors become θ + N η, v + d and p + (v + d/2) dt.
    /// Here d = −u × θ with the gain u in velocity and θ where the force acts, besides the noise
    /// of the accelerometer; so the moment of an error and d is that with θ, times u^.
    #[inline(always)]
    // ANCHOR: advance_covariance
    fn advance(&mut self, step: &Increment, gain: &Vector3<f64>, noise: &White) {
        let (dt, half) = (step.dt, 0.5 * step.dt);
        let white = noise.pushing(&step.along, dt);
        let (mut acting, mut across) = (self.tt, self.tt);
        if let Some(halfway) = &step.halfway {
            acting = acting + halfway.halfway_and_halfway;
            across = across + halfway.end_and_halfway;
        }
        let (vd, pd) = (self.vt.times_hat(gain), self.pt.times_hat(gain));
        let dd = acting.times_hat(gain).transpose().times_hat(gain) + white;
        let dt_theta = across.times_hat(gain).transpose();
        let carried = self.vv + vd;
        let pp = dt * (self.pv + half * carried) + half * pd + 0.5 * half * half * dd;
        self.pp = self.pp + pp + pp.transpose();
        self.pv = self.pv + pd + dt * carried + half * (vd.transpose() + dd);
        self.vv = carried + vd.transpose() + dd;
        self.pt = self.pt + dt * self.vt + half * dt_theta;
        self.vt = self.vt + dt_theta;
        self.tt = self.tt + step.end_and_end;
    }
    // ANCHOR_END: advance_covariance

    // ANCHOR: assemble
    /// The covariance of the errors: that of the rotation is θ seen from the last body frame.
    fn assemble(&self, body_from_first: &Matrix3<f64>) -> Matrix9 {
        let b = body_from_first;
        let Self { tt, vt, vv, pt, pv, pp } = self;
        let [tt, vt, vv, pt, pv, pp] = [tt, vt, vv, pt, pv, pp].map(Block::matrix);
        let (vt, pt) = (vt * b.transpose(), pt * b.transpose());
        let symmetric = |m: &Matrix3<f64>| 0.5 * (m + m.transpose());
        let mut covariance = Matrix9::zeros();
        let mut put = |row, column, block: &Matrix3<f64>| {
            covariance.fixed_view_mut::<3, 3>(row, column).copy_from(block);
            covariance.fixed_view_mut::<3, 3>(column, row).copy_from(&block.transpose());
        };
        put(0, 0, &symmetric(&(b * tt * b.transpose())));
        put(3, 0, &vt);
        put(6, 0, &pt);
        put(3, 3, &symmetric(&vv));
        put(6, 3, &pv);
        put(6, 6, &symmetric(&pp));
        covariance
    }
    // ANCHOR_END: assemble
}

impl Jacobian {
    // ANCHOR: advance_jacobian
    /// A bias enters like an angular velocity and a force of the opposite sign. `share` is how
    /// much of it acts in this step.
    #[inline(always)]
    pub(super) fn advance(&mut self, step: &Increment, gain: &Vector3<f64>, share: f64) {
        let (dt, half) = (step.dt, 0.5 * step.dt);
        let theta = match &step.halfway {
            Some(halfway) => self.theta_gyro - share * halfway.turned.transpose(),
            None => self.theta_gyro,
        };
        let (by_gyro, by_force) = (theta.times_hat(gain), (share * dt) * step.along);
        self.position_gyro = self.position_gyro + dt * self.velocity_gyro + half * by_gyro;
        self.velocity_gyro = self.velocity_gyro + by_gyro;
        self.theta_gyro = self.theta_gyro - share * step.turned.transpose();
        self.position_accelerometer =
            self.position_accelerometer + dt * self.velocity_accelerometer - half * by_force;
        self.velocity_accelerometer = self.velocity_accelerometer - by_force;
    }
    // ANCHOR_END: advance_jacobian

    /// The derivative of the deltas: that of the rotation is θ seen from the last body frame.
    pub(super) fn assemble(&self, body_from_first: &Matrix3<f64>) -> Matrix9x6 {
        let mut jacobian = Matrix9x6::zeros();
        let mut put = |row, column, block: &Matrix3<f64>| {
            jacobian.fixed_view_mut::<3, 3>(row, column).copy_from(block);
        };
        put(0, 0, &(body_from_first * self.theta_gyro.transpose().matrix()));
        put(3, 0, &self.velocity_gyro.transpose().matrix());
        put(6, 0, &self.position_gyro.transpose().matrix());
        put(3, 3, &self.velocity_accelerometer.matrix());
        put(6, 3, &self.position_accelerometer.matrix());
        jacobian
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::ImuNoise;

    #[test]
    fn wide_registers_round_as_narrow_ones_do() {
        let same = AxisNoise::from(&ImuNoise::euroc());
        let differing = AxisNoise { gyro: Vector3::new(1e-4, 2e-4, 3e-4), ..same };
        for noise in [same, differing] {
            let mut wide = Preintegrator::new(&ImuBias::default(), noise).unwrap();
            let mut narrow = wide.clone();
            let isotropic = wide.noise.isotropic;
            let gyro = Vector3::new(0.3, -0.7, 0.2);
            let reading = ImuSample { gyro, accelerometer: Vector3::new(0.5, 9.0, -2.0) };
            for _ in 0..200 {
                wide.integrate(&reading, 5e-3).unwrap();
                narrow.advance(&narrow.euler(&reading, 5e-3), isotropic);
                wide.integrate_midpoint(&reading, &reading, 5e-3).unwrap();
                narrow.advance(&narrow.midpoint(&reading, 5e-3), isotropic);
            }
            let [wide, narrow] = [wide, narrow].map(|sums| sums.finish().unwrap());
            assert_eq!(wide.covariance, narrow.covariance);
            assert_eq!(wide.bias_jacobian, narrow.bias_jacobian);
            assert_eq!(wide.deltas, narrow.deltas);
        }
    }
}
