//! Many inertial readings between two states as one measurement that depends on neither: the
//! preintegration of @lupton2012, on the rotation group as @forster2017 have it.
//!
//! [`preintegrate`] sums readings into [`Deltas`], relative rotation, velocity and position
//! without gravity, with their covariance and their derivatives by the biases. [`imu_residual`]
//! compares them with two states.
//!
//! Errors of deltas are ordered (φ, v, p): a rotation vector that turns the last body frame,
//! ΔR exp(φ), in radians; velocity in m/s and position in metres, both in the first body frame.
//! Biases are ordered gyroscope, accelerometer.

mod block;
mod combined;
mod dynamics;
mod integrator;
mod joining;
mod residual;
mod turning;
mod white;

use nalgebra::{Rotation3, SMatrix, Vector3, Vector6};
use thiserror::Error;

pub use combined::{CombinedPreintegrated, CombinedPreintegrator, Matrix15};
pub use dynamics::{ErrorDynamics, error_dynamics};
pub use integrator::Preintegrator;
pub use residual::{
    BiasWalk, LinearizedBiasWalk, LinearizedImu, by_gravity, imu_residual, linearize,
};

use crate::inertial::{AxisNoise, ImuBias, ImuSample, NavState, NoiseError, StampedSample};
use crate::least_squares::{WhiteningError, sqrt_information};
use crate::manifold::so3;

/// Matrices over the nine errors (φ, v, p).
pub type Matrix9 = SMatrix<f64, 9, 9>;
/// Derivatives of the nine errors by the six biases.
pub type Matrix9x6 = SMatrix<f64, 9, 6>;
/// The nine errors (φ, v, p).
pub type Vector9 = SMatrix<f64, 9, 1>;

pub use crate::inertial::LONGEST_STEP;

// ANCHOR: deltas
/// What the readings of an interval say about the motion from its first to its last frame,
/// without gravity and without the velocity at the beginning. See {eq:deltas}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deltas {
    /// Takes coordinates of the last body frame to the first.
    pub rotation: Rotation3<f64>,
    /// In the first body frame, in m/s.
    pub velocity: Vector3<f64>,
    /// In the first body frame, in metres.
    pub position: Vector3<f64>,
}

// ANCHOR_END: deltas

// ANCHOR: preintegrated
/// The readings of one interval, summed up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preintegrated {
    /// Length of the interval, in seconds.
    pub duration: f64,
    /// Number of steps.
    pub steps: usize,
    /// The motion, at [`Preintegrated::bias`].
    pub deltas: Deltas,
    /// Covariance of the errors (φ, v, p).
    pub covariance: Matrix9,
    /// Derivative of (φ, v, p) by the biases, gyroscope first.
    pub bias_jacobian: Matrix9x6,
    /// The bias that was subtracted from the readings.
    pub bias: ImuBias,
    /// The greatest specific force of a step, in m/s².
    pub greatest_force: f64,
}
// ANCHOR_END: preintegrated

// ANCHOR: preintegrate
/// Sums up readings of equal steps of `dt` seconds by the Euler rule: each reading holds from its
/// time to that of the next one, so there are as many steps as readings.
/// Implements {eq:preintegrated-sums}.
///
/// # Errors
///
/// A [`PreintegrationError`] when there is no reading, when `dt` is not positive or longer than
/// [`LONGEST_STEP`] (set [`Preintegrator::longest_step`] for slower sensors), or with a number that cannot
/// be one.
pub fn preintegrate(
    samples: &[ImuSample],
    dt: f64,
    bias: &ImuBias,
    noise: impl Into<AxisNoise>,
) -> Result<Preintegrated, PreintegrationError> {
    let mut integrator = Preintegrator::new(bias, noise)?;
    for sample in samples {
        integrator.integrate(sample, dt)?;
    }
    integrator.finish()
}
// ANCHOR_END: preintegrate

/// How readings at the ends of a step stand for what happens between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// The reading at the beginning of the step holds for all of it, and its force acts as the body
    /// stands there. The error is of the order of the step.
    Euler,
    /// The mean of both readings holds, and its force acts as the body stands halfway. The error
    /// is of the order of the step squared.
    Midpoint,
}

/// Sums up readings from the time of the first to that of the last, which with the Euler rule
/// counts only by its time. Steps longer than `longest_step` seconds are gaps.
///
/// # Errors
///
/// A [`PreintegrationError`] when there are fewer than two readings, when times do not increase
/// or leave a gap, or with a number that cannot be one.
// ANCHOR: preintegrate_stamped
pub fn preintegrate_stamped(
    samples: &[StampedSample],
    rule: Rule,
    longest_step: f64,
    bias: &ImuBias,
    noise: impl Into<AxisNoise>,
) -> Result<Preintegrated, PreintegrationError> {
    let mut integrator = Preintegrator::new(bias, noise)?;
    integrator.longest_step = longest_step;
    for pair in samples.windows(2) {
        let dt = pair[0].seconds_to(&pair[1]);
        match rule {
            Rule::Euler => integrator.integrate(&pair[0].sample, dt)?,
            Rule::Midpoint => {
                integrator.integrate_midpoint(&pair[0].sample, &pair[1].sample, dt)?;
            }
        }
    }
    integrator.finish()
}
// ANCHOR_END: preintegrate_stamped

/// Sums up readings whose bias walks, from the time of the first to that of the last by the midpoint
/// rule. Steps longer than [`LONGEST_STEP`] are gaps. `bias` is that at the time of the first.
///
/// # Errors
///
/// As those of [`preintegrate_stamped`].
// ANCHOR: preintegrate_combined
pub fn preintegrate_combined(
    samples: &[StampedSample],
    bias: &ImuBias,
    noise: impl Into<AxisNoise>,
) -> Result<CombinedPreintegrated, PreintegrationError> {
    let mut integrator = CombinedPreintegrator::new(bias, noise)?;
    for pair in samples.windows(2) {
        let dt = pair[0].seconds_to(&pair[1]);
        integrator.integrate_midpoint(&pair[0].sample, &pair[1].sample, dt)?;
    }
    integrator.finish()
}
// ANCHOR_END: preintegrate_combined

// ANCHOR: correct_for_bias
/// The deltas as they would be at another bias, to first order in the difference [@forster2017],
/// at the cost of a few small products. Implements {eq:bias-update}.
pub fn correct_for_bias(preintegrated: &Preintegrated, bias: &ImuBias) -> Deltas {
    let Deltas { rotation, velocity, position } = preintegrated.deltas;
    let step = preintegrated.bias_jacobian * preintegrated.bias_step(bias);
    Deltas {
        rotation: so3::retract(&rotation, &step.fixed_rows::<3>(0).into()),
        velocity: velocity + step.fixed_rows::<3>(3),
        position: position + step.fixed_rows::<3>(6),
    }
}
// ANCHOR_END: correct_for_bias

// ANCHOR: linearization_error_bound
/// The most that a first-order correction can be wrong by, up to terms of third order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearizationErrorBound {
    /// Of the rotation, in radians.
    pub rotation: f64,
    /// Of the velocity, in m/s.
    pub velocity: f64,
    /// Of the position, in metres.
    pub position: f64,
}
// ANCHOR_END: linearization_error_bound

impl Preintegrated {
    /// The same, if its numbers are finite.
    fn checked(self) -> Result<Self, PreintegrationError> {
        let entries = self.covariance.iter().chain(&self.bias_jacobian);
        let mut entries = entries.chain(&self.deltas.position).chain([&self.greatest_force]);
        let overflow = PreintegrationError::Overflow { steps: self.steps };
        if entries.all(|entry| entry.is_finite()) { Ok(self) } else { Err(overflow) }
    }

    /// How far a bias is from that of the deltas, gyroscope first.
    pub(crate) fn bias_step(&self, bias: &ImuBias) -> Vector6<f64> {
        bias.vector() - self.bias.vector()
    }

    // ANCHOR: predict
    /// The state at the end of the interval, given that at its beginning and a bias.
    pub fn predict(&self, first: &NavState, gravity: &Vector3<f64>, bias: &ImuBias) -> NavState {
        let (deltas, t) = (correct_for_bias(self, bias), self.duration);
        let rotation = first.world_from_body;
        let coasting = first.position + t * first.velocity + 0.5 * t * t * gravity;
        NavState {
            world_from_body: rotation * deltas.rotation,
            velocity: first.velocity + t * gravity + rotation * deltas.velocity,
            position: coasting + rotation * deltas.position,
        }
    }
    // ANCHOR_END: predict

    /// The state at the beginning of the interval, given that at its end, if the bias is that of the
    /// deltas.
    pub fn before(&self, last: &NavState, gravity: &Vector3<f64>) -> NavState {
        let (deltas, t) = (&self.deltas, self.duration);
        let world_from_body = last.world_from_body * deltas.rotation.inverse();
        let velocity = last.velocity - t * gravity - world_from_body * deltas.velocity;
        let coasted = t * velocity + 0.5 * t * t * gravity + world_from_body * deltas.position;
        NavState { world_from_body, velocity, position: last.position - coasted }
    }

    // ANCHOR: sqrt_information
    /// The 9×9 matrix W with Wᵀ W = Σ⁻¹, which whitens the residual and its Jacobians.
    ///
    /// # Errors
    ///
    /// [`WhiteningError`] when some direction has no variance: after a single step position and
    /// velocity are tied to one another, and without noise densities nothing varies.
    pub fn sqrt_information(&self) -> Result<Matrix9, WhiteningError> {
        // Rounding may give the tied direction a variance, of a size that means nothing.
        if self.steps < 2 {
            return Err(WhiteningError::NotPositiveDefinite);
        }
        sqrt_information(&self.covariance)
    }
    // ANCHOR_END: sqrt_information

    /// Standard deviations of rotation, velocity and position, in radians, m/s and metres: the
    /// root mean square over the three axes.
    pub fn sigmas(&self) -> [f64; 3] {
        [0, 3, 6].map(|at| (self.covariance.fixed_view::<3, 3>(at, at).trace() / 3.0).sqrt())
    }

    // ANCHOR: linearization_error_bound_at
    /// What [`correct_for_bias`] leaves out, at most. With a gyroscope bias off by δ the
    /// direction of each reading is off by up to ¾ δ² t² in second order after a time t, and the
    /// force that is turned wrongly adds up; a force that is itself off by ε is turned by δ t.
    /// Implements {eq:correction-bound}.
    pub fn linearization_error_bound(&self, bias: &ImuBias) -> LinearizationErrorBound {
        let (t, force, step) = (self.duration, self.greatest_force, self.bias_step(bias));
        let (gyro, accelerometer) =
            (step.fixed_rows::<3>(0).norm(), step.fixed_rows::<3>(3).norm());
        LinearizationErrorBound {
            rotation: gyro.powi(2) * t.powi(2) / 4.0,
            velocity: gyro.powi(2) * force * t.powi(3) / 4.0
                + gyro * accelerometer * t.powi(2) / 2.0,
            position: gyro.powi(2) * force * t.powi(4) / 16.0
                + gyro * accelerometer * t.powi(3) / 6.0,
        }
    }
    // ANCHOR_END: linearization_error_bound_at

    // ANCHOR: squared_error_bound
    /// By how much, at most, the squared whitened residual grows on average when the deltas are
    /// corrected for a bias instead of being summed up again; without that its mean is nine.
    ///
    /// `sqrt_information` is that of [`Preintegrated::sqrt_information`]. It is needed because the
    /// nine errors are correlated: errors that are small beside every standard deviation may be
    /// large together. Implements {eq:reintegration-bound}.
    pub fn squared_error_bound(&self, bias: &ImuBias, sqrt_information: &Matrix9) -> f64 {
        let LinearizationErrorBound { rotation, velocity, position } =
            self.linearization_error_bound(bias);
        let norm = |at| largest_singular_value(&sqrt_information.fixed_columns::<3>(at).into());
        (norm(0) * rotation + norm(3) * velocity + norm(6) * position).powi(2)
    }
    // ANCHOR_END: squared_error_bound

    // ANCHOR: should_reintegrate
    /// Whether the readings should be summed up again at a bias, because what the correction
    /// leaves out may raise the mean of the squared whitened residual by more than `fraction` of
    /// the nine that it is. A hundredth is a good fraction.
    ///
    /// This factors the covariance. Who keeps its square root asks
    /// [`Preintegrated::squared_error_bound`] instead. Where there is no square root no limit can
    /// be kept, and readings are to be summed up again as soon as the bias moves.
    pub fn should_reintegrate(&self, bias: &ImuBias, fraction: f64) -> bool {
        if self.bias_step(bias) == Vector6::zeros() {
            return false;
        }
        let bound = self.sqrt_information().map(|root| self.squared_error_bound(bias, &root));
        !bound.is_ok_and(|bound| bound <= 9.0 * fraction)
    }
    // ANCHOR_END: should_reintegrate
}

/// The most by which a matrix lengthens a vector, or NaN for one with entries that are not finite.
fn largest_singular_value(matrix: &SMatrix<f64, 9, 3>) -> f64 {
    let squared = matrix.tr_mul(matrix);
    // The search for eigenvalues would not return from an entry that is none.
    let is_finite = squared.iter().all(|entry| entry.is_finite());
    if is_finite { squared.symmetric_eigenvalues().max().sqrt() } else { f64::NAN }
}

/// Why readings cannot be summed up.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PreintegrationError {
    /// There is no step.
    #[error("there is no step to integrate; give a reading, or two with times")]
    Empty,
    /// A step has no length, or a negative one.
    #[error("step {step} lasts {dt} s; a step must last longer than zero, sort the readings")]
    Step {
        /// Which step, counted from zero.
        step: usize,
        /// Its length, in seconds.
        dt: f64,
    },
    /// A step is longer than allowed.
    #[error(
        "step {step} lasts {dt} s, longer than {longest} s; readings are missing, so end the \
         interval before them or allow longer steps"
    )]
    Gap {
        /// Which step, counted from zero.
        step: usize,
        /// Its length, in seconds.
        dt: f64,
        /// The limit, in seconds.
        longest: f64,
    },
    /// A reading has a number that is not finite.
    #[error("step {step}: gyroscope {gyro:?}, accelerometer {accelerometer:?}; leave it out")]
    Sample {
        /// Which step, counted from zero.
        step: usize,
        /// The reading, in rad/s.
        gyro: [f64; 3],
        /// The reading, in m/s².
        accelerometer: [f64; 3],
    },
    /// The bias has a number that is not finite.
    #[error("the bias is gyroscope {gyro:?}, accelerometer {accelerometer:?}; give finite numbers")]
    Bias {
        /// The bias, in rad/s.
        gyro: [f64; 3],
        /// The bias, in m/s².
        accelerometer: [f64; 3],
    },
    /// Two intervals that are to be joined were summed with different biases.
    #[error(
        "the first interval was summed with the bias {first:?}, the later one with {later:?}, \
         gyroscope first; sum one of them up again"
    )]
    BiasesDiffer {
        /// Of the first interval, in rad/s and m/s².
        first: [f64; 6],
        /// Of the later interval, in rad/s and m/s².
        later: [f64; 6],
    },
    /// A noise density is none.
    #[error(transparent)]
    Noise(#[from] NoiseError),
    /// Readings are finite and their sums are not.
    #[error(
        "the sums are not finite after {steps} steps; readings, steps or noise densities are too large"
    )]
    Overflow {
        /// How many steps were summed up.
        steps: usize,
    },
}
