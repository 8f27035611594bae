//! What readings add to a motion that is known up to scale: the gyroscope's bias, then scale,
//! velocity, gravity and the accelerometer's bias, by equations that are linear in all of them.

use nalgebra::{Matrix3, SVector, Vector3};

use super::linear::UNKNOWNS;
use super::{AlignmentRefused, LinearAlignment, Sensors, VisualMotion};
use crate::inertial::{ImuBias, NavState, StampedSample, between};
use crate::preintegration::{LONGEST_STEP, Preintegrated, Rule, linearize, preintegrate_stamped};

// ANCHOR: alignment
/// A motion up to scale that readings have given its scale and its direction of down.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// Metres in a unit of the pictures' motion.
    pub scale: f64,
    /// The velocity at the first camera, in m/s, in the coordinates of the pictures' motion.
    pub velocity: Vector3<f64>,
    /// Gravity there, in m/s².
    pub gravity: Vector3<f64>,
    /// The biases.
    pub bias: ImuBias,
    /// How much of the camera's path no velocity, no gravity and no bias can imitate: a root sum of
    /// squares over all cameras, in the motion's unit. The scale is known by it.
    pub beyond: f64,
    /// The singular values of the system without prior, its columns scaled to the length of one,
    /// descending.
    pub spectrum: SVector<f64, UNKNOWNS>,
}
// ANCHOR_END: alignment

/// Sums of readings between each two neighbouring cameras.
pub(super) fn intervals(
    sensors: &Sensors,
    readings: &[StampedSample],
    nanoseconds: &[i64],
    bias: &ImuBias,
) -> Result<Vec<Preintegrated>, AlignmentRefused> {
    let sums = |pair: &[i64]| {
        let readings = between(readings, pair[0], pair[1])?;
        Ok(preintegrate_stamped(&readings, Rule::Midpoint, LONGEST_STEP, bias, &sensors.noise)?)
    };
    nanoseconds.windows(2).map(sums).collect()
}

// ANCHOR: gyro_bias
/// The gyroscope's bias with which the readings turn as the cameras do. Implements {eq:gyro-step}.
pub(super) fn gyro_bias(
    sensors: &Sensors,
    readings: &[StampedSample],
    motion: &VisualMotion,
) -> Result<Vector3<f64>, AlignmentRefused> {
    let mut bias = ImuBias::default();
    for _ in 0..GYRO_ROUNDS {
        let (mut hessian, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
        let sums = intervals(sensors, readings, &motion.nanoseconds, &bias)?;
        for (sums, pair) in sums.iter().zip(motion.rotations.windows(2)) {
            let [first, second] = [pair[0], pair[1]]
                .map(|world_from_body| NavState { world_from_body, ..NavState::origin() });
            let linear = linearize(sums, &first, &second, &Vector3::zeros(), &bias);
            let by_bias = linear.by_bias.fixed_view::<3, 3>(0, 0);
            hessian += by_bias.tr_mul(&by_bias);
            gradient += by_bias.tr_mul(&linear.residual.fixed_rows::<3>(0));
        }
        let step = hessian.cholesky().ok_or(AlignmentRefused::Undetermined)?;
        bias.gyro -= step.solve(&gradient);
    }
    Ok(bias.gyro)
}
// ANCHOR_END: gyro_bias

/// The turns of readings depend on the bias nearly linearly.
const GYRO_ROUNDS: usize = 3;

// ANCHOR: align
/// Aligns a motion with readings: the gyroscope's bias first, then all others at once, with gravity
/// on its sphere. `accelerometer_bias` is how large the accelerometer's bias may be on each axis, as
/// a standard deviation in m/s².
///
/// # Errors
///
/// An [`AlignmentRefused`]: [`AlignmentRefused::Indistinct`] and [`AlignmentRefused::TwoScales`]
/// tell of motions that noise cannot tell from one whose scale the readings leave open.
pub fn align_motion(
    sensors: &Sensors,
    readings: &[StampedSample],
    motion: &VisualMotion,
    accelerometer_bias: f64,
) -> Result<Alignment, AlignmentRefused> {
    motion.check()?;
    let found = motion.pictures.len();
    if found < LEAST_CAMERAS {
        return Err(AlignmentRefused::Cameras { found });
    }
    let gyro = gyro_bias(sensors, readings, motion)?;
    let bias = ImuBias { gyro, accelerometer: Vector3::zeros() };
    let system = LinearAlignment::new(sensors, readings, motion, &bias)?;
    let unit = motion.sigma(sensors);
    // What a row is worth depends on the scale, which a first round finds.
    let (first, _) = system.solve(FIRST_SIGMA, accelerometer_bias)?;
    let sigma = first[0].abs() * unit;
    let (x, other) = system.solve(sigma, accelerometer_bias)?;
    let (beyond, noise) = system.beyond(unit, sigma / accelerometer_bias)?;
    if let Some(other) = other.filter(|other| *other > 0.0 && x[0] > 0.0) {
        return Err(AlignmentRefused::TwoScales { scale: x[0], other });
    }
    if beyond < noise {
        return Err(AlignmentRefused::Indistinct { beyond, noise });
    }
    if !(x[0] > 0.0 && x.iter().all(|number| number.is_finite())) {
        return Err(AlignmentRefused::Scale { scale: x[0] });
    }
    let part = |from| x.fixed_rows::<3>(from).into_owned();
    let bias = ImuBias { gyro, accelerometer: part(4) };
    let spectrum = system.spectrum();
    Ok(Alignment { scale: x[0], velocity: part(1), gravity: part(7), bias, beyond, spectrum })
}
// ANCHOR_END: align

/// With fewer there are not as many equations as unknowns.
const LEAST_CAMERAS: usize = 5;
/// What a position is worth before its scale is known, in metres.
const FIRST_SIGMA: f64 = 0.01;
