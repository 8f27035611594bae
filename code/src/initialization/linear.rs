//! The equations that are linear in scale, velocity, gravity and the accelerometer's bias.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

use super::alignment::intervals;
use super::sphere::{SphereMinimum, minima_on_sphere};
use super::{AlignmentRefused, Sensors, VisualMotion};
use crate::filtering::chi_square_quantile;
use crate::inertial::{ImuBias, StampedSample};

/// Scale, velocity, the accelerometer's bias, gravity.
pub(super) const UNKNOWNS: usize = 10;
/// Noise alone stays below what is compared with it with that probability.
const PROBABILITY: f64 = 0.999;

// ANCHOR: linear_alignment
/// The rows s (c_k − c_0) − t v − P b − ½ t² g = A + (R_k − R_0) l, three for each camera but the
/// first, with the unknowns in the order (s, v, b, g): the scale in metres in a unit of the motion, velocity
/// and gravity in the motion's axes, in m/s and m/s², and the bias in the body's, in m/s². A and P are
/// what the forces between the cameras, turned as these are, and a bias of them do to the position.
/// Implements {eq:align-row}.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearAlignment {
    /// The matrix, of ten columns.
    pub matrix: DMatrix<f64>,
    /// The right side, in metres.
    pub right: DVector<f64>,
    /// The size of gravity, in m/s².
    pub gravity: f64,
}
// ANCHOR_END: linear_alignment

impl LinearAlignment {
    // ANCHOR: linear_system
    /// The rows of a motion.
    ///
    /// # Errors
    ///
    /// [`AlignmentRefused::Lists`], [`AlignmentRefused::Sighting`], [`AlignmentRefused::Readings`] and
    /// [`AlignmentRefused::Preintegration`].
    pub fn new(
        sensors: &Sensors,
        readings: &[StampedSample],
        motion: &VisualMotion,
        bias: &ImuBias,
    ) -> Result<Self, AlignmentRefused> {
        motion.check()?;
        let sums = intervals(sensors, readings, &motion.nanoseconds, bias)?;
        let mut matrix = DMatrix::zeros(3 * sums.len(), UNKNOWNS);
        let mut right = DVector::zeros(3 * sums.len());
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
            matrix.fixed_view_mut::<3, 1>(row, 0).copy_from(&moved);
            matrix.fixed_view_mut::<3, 3>(row, 1).fill_diagonal(-seconds);
            matrix.fixed_view_mut::<3, 3>(row, 4).copy_from(&-position_by_bias);
            matrix.fixed_view_mut::<3, 3>(row, 7).fill_diagonal(-0.5 * seconds * seconds);
            let swung = (motion.rotations[k + 1].matrix() - motion.rotations[0].matrix()) * lever;
            right.fixed_rows_mut::<3>(row).copy_from(&(position + swung));
        }
        Ok(Self { matrix, right, gravity: sensors.gravity })
    }
    // ANCHOR_END: linear_system

    /// The normal equations, with a weight on each axis of the bias.
    fn normal(&self, weight: f64) -> SMatrix<f64, UNKNOWNS, UNKNOWNS> {
        let mut normal = SMatrix::from_fn(|row, column| {
            self.matrix.column(row).dot(&self.matrix.column(column))
        });
        (4..7).for_each(|row| normal[(row, row)] += weight);
        normal
    }

    // ANCHOR: linear_solve
    /// The unknowns that fit best with gravity on its sphere, when each row is worth `sigma` metres
    /// and the accelerometer's bias may be `accelerometer_bias` on each axis, as standard deviations; and
    /// the scale of another minimum, if noise cannot tell the two apart.
    ///
    /// Scale, velocity and bias are eliminated first. What remains is a function of gravity alone:
    /// [`minima_on_sphere`].
    ///
    /// # Errors
    ///
    /// [`AlignmentRefused::Undetermined`].
    pub fn solve(
        &self,
        sigma: f64,
        accelerometer_bias: f64,
    ) -> Result<(SVector<f64, UNKNOWNS>, Option<f64>), AlignmentRefused> {
        let normal = self.normal((sigma / accelerometer_bias).powi(2));
        let gradient = self.matrix.tr_mul(&self.right);
        let coupling = normal.fixed_view::<7, 3>(0, 7).into_owned();
        let others = normal.fixed_view::<7, 7>(0, 0).into_owned().cholesky();
        let others = others.ok_or(AlignmentRefused::Undetermined)?;
        let half = others.solve(&coupling);
        let rest = normal.fixed_view::<3, 3>(7, 7) - coupling.tr_mul(&half);
        let target = gradient.fixed_rows::<3>(7) - half.tr_mul(&gradient.fixed_rows::<7>(0));
        let all = |minimum: &SphereMinimum| {
            let first = others.solve(&(gradient.fixed_rows::<7>(0) - coupling * minimum.at));
            let mut x = SVector::<f64, UNKNOWNS>::zeros();
            x.fixed_rows_mut::<7>(0).copy_from(&first);
            x.fixed_rows_mut::<3>(7).copy_from(&minimum.at);
            x
        };
        let (least, other) =
            minima_on_sphere(&rest, &target, self.gravity).ok_or(AlignmentRefused::Undetermined)?;
        let told_apart =
            sigma * sigma * chi_square_quantile(PROBABILITY, 1).unwrap_or(f64::INFINITY);
        let other = other.filter(|other| other.value - least.value < told_apart);
        Ok((all(&least), other.map(|other| all(&other)[0])))
    }
    // ANCHOR_END: linear_solve

    // ANCHOR: beyond
    /// How much of the column of centres the other nine columns cannot imitate, with a prior on the
    /// bias whose rows weigh `ratio`; and what the noise of the centres, of a standard deviation `unit` on
    /// each axis, would leave of a column that they can imitate. Both are root sums of squares.
    /// Implements {eq:scale-information}.
    ///
    /// # Errors
    ///
    /// [`AlignmentRefused::Undetermined`] when the nine columns are dependent.
    pub fn beyond(&self, unit: f64, ratio: f64) -> Result<(f64, f64), AlignmentRefused> {
        let normal = self.normal(ratio * ratio);
        let others = normal.fixed_view::<9, 9>(1, 1).into_owned();
        let without_prior = self.normal(0.0).fixed_view::<9, 9>(1, 1).into_owned();
        let others = others.cholesky().ok_or(AlignmentRefused::Undetermined)?;
        let by_centres = normal.fixed_view::<9, 1>(1, 0).into_owned();
        let square = normal[(0, 0)] - by_centres.dot(&others.solve(&by_centres));
        let imitated = others.solve(&without_prior).trace().round() as usize;
        let degrees = self.matrix.nrows().saturating_sub(imitated).max(1);
        let limit = chi_square_quantile(PROBABILITY, degrees).unwrap_or(f64::INFINITY);
        Ok((square.max(0.0).sqrt(), unit * limit.sqrt()))
    }
    // ANCHOR_END: beyond

    // ANCHOR: alignment_spectrum
    /// The singular values of the matrix, its columns scaled to the length of one, descending: roots of
    /// eigenvalues of the normal equations, so that zero comes out as up to 1e-8.
    pub fn spectrum(&self) -> SVector<f64, UNKNOWNS> {
        let normal = self.normal(0.0);
        let lengths = normal.diagonal().map(f64::sqrt);
        let scaled = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|row, column| {
            let length = lengths[row] * lengths[column];
            if length > 0.0 { normal[(row, column)] / length } else { 0.0 }
        });
        let mut values = SymmetricEigen::new(scaled).eigenvalues.map(|value| value.max(0.0).sqrt());
        values.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
        values
    }
    // ANCHOR_END: alignment_spectrum
}

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
            return 1.0 / sensors.camera.fx;
        }
        let depth = *depths.select_nth_unstable_by(half, f64::total_cmp).1;
        depth * sensors.pixel_sigma / sensors.camera.fx
    }
}
