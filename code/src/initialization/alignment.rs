//! What readings add to a motion that is known up to scale: the gyroscope's bias, then scale,
//! velocity, gravity and the accelerometer's bias, by equations that are linear in all of them.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

use super::{AlignmentRefused, Sensors, VisualMotion};
use crate::inertial::{ImuBias, NavState, StampedSample, between};
use crate::preintegration::{LONGEST_STEP, Preintegrated, Rule, linearize, preintegrate_stamped};

/// Unknowns of the linear system: scale, velocity, the accelerometer's bias, gravity.
const UNKNOWNS: usize = 10;

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
    /// How many directions of gravity do equally well: one, two, or any, told as three.
    pub solutions: usize,
    /// The singular values of the system without prior, its columns scaled to the length of one.
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
/// The gyroscope's bias with which the readings turn as the cameras do.
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
        let step = hessian.cholesky().ok_or(AlignmentRefused::Cameras { found: 1 })?;
        bias.gyro -= step.solve(&gradient);
    }
    Ok(bias.gyro)
}
// ANCHOR_END: gyro_bias

/// The turns of readings depend on the bias nearly linearly.
const GYRO_ROUNDS: usize = 3;

// ANCHOR: linear_system
/// The rows s (c_k − c_0) − t v − J b − ½ t² g = A + (R_k − R_0) l, three for each camera but the
/// first, with the unknowns in the order (s, v, b, g). A and J are what the forces between the
/// cameras, turned as these are, and a bias of them do to the position.
pub(super) fn linear_system(
    sensors: &Sensors,
    motion: &VisualMotion,
    sums: &[Preintegrated],
) -> (DMatrix<f64>, DVector<f64>) {
    let rows = 3 * sums.len();
    let (mut system, mut right) = (DMatrix::zeros(rows, UNKNOWNS), DVector::zeros(rows));
    let lever = sensors.rig.body_from_camera.translation.vector;
    let (mut velocity, mut position) = (Vector3::zeros(), Vector3::zeros());
    let (mut velocity_by_bias, mut position_by_bias) = (Matrix3::zeros(), Matrix3::zeros());
    for (k, sums) in sums.iter().enumerate() {
        let rotation = motion.rotations[k].matrix();
        let by_bias = |row| rotation * sums.bias_jacobian.fixed_view::<3, 3>(row, 3);
        position += sums.duration * velocity + rotation * sums.deltas.position;
        velocity += rotation * sums.deltas.velocity;
        position_by_bias += sums.duration * velocity_by_bias + by_bias(6);
        velocity_by_bias += by_bias(3);
        let (row, seconds) = (3 * k, motion.seconds(k + 1));
        let moved = motion.centres[k + 1] - motion.centres[0];
        system.fixed_view_mut::<3, 1>(row, 0).copy_from(&moved);
        system.fixed_view_mut::<3, 3>(row, 1).fill_diagonal(-seconds);
        system.fixed_view_mut::<3, 3>(row, 4).copy_from(&-position_by_bias);
        system.fixed_view_mut::<3, 3>(row, 7).fill_diagonal(-0.5 * seconds * seconds);
        let swung = (motion.rotations[k + 1].matrix() - motion.rotations[0].matrix()) * lever;
        right.fixed_rows_mut::<3>(row).copy_from(&(position + swung));
    }
    (system, right)
}
// ANCHOR_END: linear_system

// ANCHOR: align
/// Aligns a motion with readings: the gyroscope's bias first, then all others at once, with gravity
/// on its sphere. `accelerometer_bias` is how large the accelerometer's bias may be on each axis, as
/// a standard deviation in m/s².
///
/// # Errors
///
/// An [`AlignmentRefused`].
pub fn align_motion(
    sensors: &Sensors,
    readings: &[StampedSample],
    motion: &VisualMotion,
    accelerometer_bias: f64,
) -> Result<Alignment, AlignmentRefused> {
    let found = motion.centres.len();
    if found < LEAST_CAMERAS {
        return Err(AlignmentRefused::Cameras { found });
    }
    let gyro = gyro_bias(sensors, readings, motion)?;
    let bias = ImuBias { gyro, accelerometer: Vector3::zeros() };
    let sums = intervals(sensors, readings, &motion.nanoseconds, &bias)?;
    let (system, right) = linear_system(sensors, motion, &sums);
    let spectrum = spectrum(&system);
    // What a row is worth: first unknown and the same for all, then by the scale of the first round.
    let mut sigma = FIRST_SIGMA;
    let mut solved = None;
    for _ in 0..2 {
        let weight = sigma * sigma / accelerometer_bias.powi(2);
        let (x, solutions) = on_sphere(&system, &right, weight, sensors.gravity)
            .ok_or(AlignmentRefused::Undetermined)?;
        if !(x[0] > 0.0 && x.iter().all(|number| number.is_finite())) {
            return Err(AlignmentRefused::Scale { scale: x[0] });
        }
        sigma = x[0] * motion.sigma(sensors);
        solved = Some((x, solutions));
    }
    let (x, solutions) = solved.ok_or(AlignmentRefused::Undetermined)?;
    let part = |from| x.fixed_rows::<3>(from).into_owned();
    let bias = ImuBias { gyro, accelerometer: part(4) };
    Ok(Alignment { scale: x[0], velocity: part(1), gravity: part(7), bias, solutions, spectrum })
}
// ANCHOR_END: align

/// With fewer there are not as many equations as unknowns.
const LEAST_CAMERAS: usize = 5;
/// What a position is worth before its scale is known, in metres.
const FIRST_SIGMA: f64 = 0.01;

impl VisualMotion {
    /// How well a centre is known across the line of sight, in the motion's unit: what a pixel is at
    /// the depth of half of the landmarks.
    pub(super) fn sigma(&self, sensors: &Sensors) -> f64 {
        let depths = self.landmarks.values().filter_map(|landmark| {
            let (place, _) = *landmark.sightings.first()?;
            Some((landmark.place - self.centres[place]).norm())
        });
        let mut depths: Vec<f64> = depths.collect();
        let half = depths.len() / 2;
        if depths.is_empty() {
            return FIRST_SIGMA;
        }
        let depth = *depths.select_nth_unstable_by(half, f64::total_cmp).1;
        depth * sensors.pixel_sigma / sensors.camera.fx
    }
}

/// The singular values of a matrix whose columns are scaled to the length of one, descending.
fn spectrum(system: &DMatrix<f64>) -> SVector<f64, UNKNOWNS> {
    let lengths = system.column_iter().map(|column| column.norm());
    let lengths: Vec<f64> = lengths.collect();
    let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
    for row in 0..UNKNOWNS {
        for column in 0..UNKNOWNS {
            let product = system.column(row).dot(&system.column(column));
            let length = lengths[row] * lengths[column];
            normal[(row, column)] = if length > 0.0 { product / length } else { 0.0 };
        }
    }
    let mut values = SymmetricEigen::new(normal).eigenvalues.map(|value| value.max(0.0).sqrt());
    values.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
    values
}

// ANCHOR: on_sphere
/// The x with the least norm of M x − r whose last three numbers have a given length, with a prior
/// of this weight on the bias; and in how many places it is reached.
///
/// The seven others are eliminated. What remains, gᵀ S g − 2 hᵀ g on a sphere, is least where
/// (S + μ I) g = h and no eigenvalue of S + μ I is negative.
fn on_sphere(
    system: &DMatrix<f64>,
    right: &DVector<f64>,
    weight: f64,
    length: f64,
) -> Option<(SVector<f64, UNKNOWNS>, usize)> {
    let normal = system.tr_mul(system);
    let gradient = system.tr_mul(right);
    let mut others = normal.fixed_view::<7, 7>(0, 0).into_owned();
    (4..7).for_each(|row| others[(row, row)] += weight);
    let coupling = normal.fixed_view::<7, 3>(0, 7).into_owned();
    let others = others.cholesky()?;
    let half = others.solve(&coupling);
    let rest = normal.fixed_view::<3, 3>(7, 7) - coupling.tr_mul(&half);
    let target = gradient.fixed_rows::<3>(7) - half.tr_mul(&gradient.fixed_rows::<7>(0));
    let (gravity, solutions) = least_on_sphere(&rest, &target, length)?;
    let first = others.solve(&(gradient.fixed_rows::<7>(0) - coupling * gravity));
    let mut x = SVector::<f64, UNKNOWNS>::zeros();
    x.fixed_rows_mut::<7>(0).copy_from(&first);
    x.fixed_rows_mut::<3>(7).copy_from(&gravity);
    Some((x, solutions))
}

/// Where gᵀ S g − 2 hᵀ g is least among vectors of a length, and in how many places: one; two, when
/// h has no part along the least eigenvector; or any, told as three, when it has none along a plane
/// of them. The length of (S + μ I)⁻¹ h falls as μ grows, so one μ is right, which halving an interval finds.
fn least_on_sphere(
    square: &Matrix3<f64>,
    target: &Vector3<f64>,
    length: f64,
) -> Option<(Vector3<f64>, usize)> {
    let symmetric = 0.5 * (square + square.transpose());
    let eigen = SymmetricEigen::try_new(symmetric, f64::EPSILON, 1000)?;
    let (values, parts) = (eigen.eigenvalues, eigen.eigenvectors.tr_mul(target));
    let (least, scale) = (values.min(), values.amax().max(target.norm() / length));
    let at = |shift: f64| values.zip_map(&parts, |value, part| part / (value - least + shift));
    let (mut low, mut high) = (f64::EPSILON * scale, target.norm() / length + f64::EPSILON * scale);
    if !(scale > 0.0 && high.is_finite()) {
        return None;
    }
    if at(low).norm() < length {
        // Along the least eigenvector nothing pulls: as far as the sphere, one way or the other.
        let mut found = at(low);
        let missing = (length * length - found.norm_squared()).max(0.0).sqrt();
        found[values.imin()] += missing;
        let flat = values.iter().filter(|value| **value - least < FLAT * scale).count();
        return Some((eigen.eigenvectors * found, 1 + flat.min(2)));
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if at(middle).norm() > length { low = middle } else { high = middle }
    }
    let found = at(high);
    Some((eigen.eigenvectors * found * (length / found.norm()), 1))
}
// ANCHOR_END: on_sphere

/// Eigenvalues that differ by less than this part of the largest are the same.
const FLAT: f64 = 1e-12;
/// Halvings until nothing is left of the digits of an interval.
const HALVINGS: usize = 200;
