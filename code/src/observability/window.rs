//! States, biases and landmarks, and the measurements between them.

use nalgebra::{DMatrix, DVector, Matrix2x3, SMatrix, Vector3};

use super::ObservabilityError;
use crate::inertial::{CameraImu, ImuBias, ImuNoise, NavState};
use crate::least_squares::Manifold;
use crate::manifold::so3;
use crate::preintegration::{BiasWalk, Preintegrated, imu_residual, linearize};
use crate::reprojection::{Pinhole, ReprojFactor};

// ANCHOR: assumption
/// What is assumed of the biases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BiasAssumption {
    /// Whether the gyroscope's bias is known.
    pub gyro_known: bool,
    /// Whether the accelerometer's bias is known.
    pub accelerometer_known: bool,
    /// Densities of the random walk of the biases, or `None` when they are constant.
    pub walk: Option<ImuNoise>,
}

impl BiasAssumption {
    /// Both biases are known.
    pub const KNOWN: Self = Self { gyro_known: true, accelerometer_known: true, walk: None };
    /// Both biases are unknown, and constant over the window.
    pub const CONSTANT: Self = Self { gyro_known: false, accelerometer_known: false, walk: None };

    /// Both biases are unknown and walk.
    pub const fn walking(noise: ImuNoise) -> Self {
        Self { walk: Some(noise), ..Self::CONSTANT }
    }
}
// ANCHOR_END: assumption

// ANCHOR: window
/// A stretch of time: what is unknown in it, and what was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// The camera.
    pub camera: Pinhole,
    /// How the camera sits on the body.
    pub rig: CameraImu,
    /// The acceleration of free fall, in the world, in m/s².
    pub gravity: Vector3<f64>,
    /// What is assumed of the biases.
    pub assumption: BiasAssumption,
    /// The body at the time of each picture.
    pub states: Vec<NavState>,
    /// The body's angular velocity at each state, in its frame, in rad/s.
    pub angular_velocities: Vec<Vector3<f64>>,
    /// One bias when it is constant, one for each state when it walks.
    pub biases: Vec<ImuBias>,
    /// Landmarks in the world, in metres.
    pub landmarks: Vec<Vector3<f64>>,
    /// Pixels; a factor's keyframe is a state, its point a landmark.
    pub observations: Vec<ReprojFactor>,
    /// Readings between each two consecutive states, or none for pictures alone.
    pub intervals: Vec<Preintegrated>,
}
// ANCHOR_END: window

/// The whitened residuals of a window and their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearizedWindow {
    /// Two numbers for each pixel, nine for each interval, six for each step of walking biases.
    pub residual: DVector<f64>,
    /// The derivatives, with as many columns as [`Window`] has dimensions.
    pub jacobian: DMatrix<f64>,
}

// ANCHOR: by_state
/// The twist of `camera_from_world`, as its right retraction takes it, of a step (φ, v, p) of the
/// state: a 6×9 matrix. Neither the lever arm nor the camera's orientation appears in it.
///
/// Implements {eq:twist-by-state}.
pub fn twist_by_state(state: &NavState) -> SMatrix<f64, 6, 9> {
    let world_from_body = state.world_from_body.matrix();
    let mut twist = SMatrix::<f64, 6, 9>::zeros();
    let rho_by_phi = -so3::hat(&state.position) * world_from_body;
    twist.fixed_view_mut::<3, 3>(0, 0).copy_from(&rho_by_phi);
    twist.fixed_view_mut::<3, 3>(0, 6).fill_diagonal(-1.0);
    twist.fixed_view_mut::<3, 3>(3, 0).copy_from(&-world_from_body);
    twist
}
// ANCHOR_END: by_state

// ANCHOR: pixel_by_state
/// The 2×9 derivative of a pixel by a step (φ, v, p) of the state, from the 2×3 derivative by the
/// landmark. Implements {eq:pixel-by-state}.
pub fn pixel_by_state(
    state: &NavState,
    landmark: &Vector3<f64>,
    by_point: &Matrix2x3<f64>,
) -> SMatrix<f64, 2, 9> {
    let arm = so3::hat(&(landmark - state.position));
    let mut jacobian = SMatrix::<f64, 2, 9>::zeros();
    let by_phi = by_point * arm * state.world_from_body.matrix();
    jacobian.fixed_view_mut::<2, 3>(0, 0).copy_from(&by_phi);
    jacobian.fixed_view_mut::<2, 3>(0, 6).copy_from(&-by_point);
    jacobian
}
// ANCHOR_END: pixel_by_state

impl Window {
    /// Index of the bias that holds in an interval, or at a state.
    pub(super) fn bias_index(&self, state: usize) -> usize {
        if self.assumption.walk.is_some() { state } else { 0 }
    }

    /// Columns before those of the biases, and before those of the landmarks, were every variable
    /// unknown.
    pub(super) fn starts(&self) -> (usize, usize) {
        let biases = 9 * self.states.len();
        (biases, biases + 6 * self.biases.len())
    }

    // ANCHOR: columns
    /// Which coordinates are unknown, among nine (φ, v, p) for each state, six for each bias,
    /// gyroscope first, and three for each landmark. Pictures alone know of no velocities or biases.
    pub(super) fn unknown(&self) -> Vec<usize> {
        let (biases, landmarks) = self.starts();
        let inertial = !self.intervals.is_empty();
        let assumption = &self.assumption;
        let is_unknown = |column: &usize| {
            if *column < biases {
                inertial || !(3..6).contains(&(column % 9))
            } else if *column < landmarks {
                let gyro = (column - biases) % 6 < 3;
                let known =
                    if gyro { assumption.gyro_known } else { assumption.accelerometer_known };
                inertial && !known
            } else {
                true
            }
        };
        (0..landmarks + 3 * self.landmarks.len()).filter(is_unknown).collect()
    }
    // ANCHOR_END: columns

    // ANCHOR: residual
    /// The whitened residuals: pixels, then intervals, then steps of walking biases.
    ///
    /// # Errors
    ///
    /// An [`ObservabilityError`] when the window does not fit together, a landmark is not in front
    /// of its camera, or a number is not finite.
    pub fn residual(&self) -> Result<DVector<f64>, ObservabilityError> {
        self.check()?;
        let mut rows = Vec::new();
        for (index, factor) in self.observations.iter().enumerate() {
            let pose = self.rig.camera_from_world(&self.states[factor.keyframe]);
            let pixel = self.camera.project(&pose, &self.landmarks[factor.point]);
            let pixel = pixel.ok_or_else(|| self.not_in_front(index))?;
            rows.extend_from_slice(factor.residual(&pixel).as_slice());
        }
        for (i, interval) in self.intervals.iter().enumerate() {
            let bias = &self.biases[self.bias_index(i)];
            let (first, second) = (&self.states[i], &self.states[i + 1]);
            let residual = imu_residual(interval, first, second, &self.gravity, bias);
            rows.extend_from_slice((interval.sqrt_information()? * residual).as_slice());
        }
        for (i, walk) in self.walks()?.iter().enumerate() {
            let residual = walk.linearize(&self.biases[i], &self.biases[i + 1]).residual;
            rows.extend_from_slice(residual.as_slice());
        }
        finite(DVector::from_vec(rows))
    }
    // ANCHOR_END: residual

    // ANCHOR: jacobian
    /// The whitened residuals with their derivatives by all that is unknown.
    ///
    /// # Errors
    ///
    /// Those of [`Window::residual`].
    pub fn linearize(&self) -> Result<LinearizedWindow, ObservabilityError> {
        let residual = self.residual()?;
        let (_, landmarks) = self.starts();
        let mut whole = DMatrix::zeros(residual.len(), landmarks + 3 * self.landmarks.len());
        let row = self.add_pixels(&mut whole)?;
        let row = self.add_intervals(&mut whole, row)?;
        self.add_walks(&mut whole, row)?;
        if let Some(row) = whole.row_iter().position(|row| !row.iter().all(|x| x.is_finite())) {
            return Err(ObservabilityError::NotFinite { row });
        }
        Ok(LinearizedWindow { residual, jacobian: whole.select_columns(&self.unknown()) })
    }
    // ANCHOR_END: jacobian

    // ANCHOR: add_pixels
    /// Two rows for each pixel, by its state and its landmark.
    fn add_pixels(&self, whole: &mut DMatrix<f64>) -> Result<usize, ObservabilityError> {
        let (_, landmarks) = self.starts();
        for (index, factor) in self.observations.iter().enumerate() {
            let (state, point) = (&self.states[factor.keyframe], &self.landmarks[factor.point]);
            let pose = self.rig.camera_from_world(state);
            let predicted = self.camera.project_with_jacobians(&pose, point);
            let predicted = predicted.ok_or_else(|| self.not_in_front(index))?;
            let by_point = factor.linearize(&predicted).by_point;
            let by_state = pixel_by_state(state, point, &by_point);
            let row = 2 * index;
            whole.fixed_view_mut::<2, 9>(row, 9 * factor.keyframe).copy_from(&by_state);
            let column = landmarks + 3 * factor.point;
            whole.fixed_view_mut::<2, 3>(row, column).copy_from(&by_point);
        }
        Ok(2 * self.observations.len())
    }
    // ANCHOR_END: add_pixels

    // ANCHOR: add_intervals
    /// Nine rows for each interval, by the states at its ends and the bias in it.
    fn add_intervals(
        &self,
        whole: &mut DMatrix<f64>,
        start: usize,
    ) -> Result<usize, ObservabilityError> {
        let (biases, _) = self.starts();
        for (i, interval) in self.intervals.iter().enumerate() {
            let at = self.bias_index(i);
            let (first, second) = (&self.states[i], &self.states[i + 1]);
            let linear = linearize(interval, first, second, &self.gravity, &self.biases[at])
                .whitened(&interval.sqrt_information()?);
            let row = start + 9 * i;
            whole.fixed_view_mut::<9, 9>(row, 9 * i).copy_from(&linear.by_first);
            whole.fixed_view_mut::<9, 9>(row, 9 * (i + 1)).copy_from(&linear.by_second);
            whole.fixed_view_mut::<9, 6>(row, biases + 6 * at).copy_from(&linear.by_bias);
        }
        Ok(start + 9 * self.intervals.len())
    }
    // ANCHOR_END: add_intervals

    /// Six rows for each step of walking biases.
    fn add_walks(&self, whole: &mut DMatrix<f64>, start: usize) -> Result<(), ObservabilityError> {
        let (biases, _) = self.starts();
        for (i, walk) in self.walks()?.iter().enumerate() {
            let linear = walk.linearize(&self.biases[i], &self.biases[i + 1]);
            let (row, column) = (start + 6 * i, biases + 6 * i);
            whole.fixed_view_mut::<6, 6>(row, column).copy_from(&linear.by_first);
            whole.fixed_view_mut::<6, 6>(row, column + 6).copy_from(&linear.by_second);
        }
        Ok(())
    }

    fn walks(&self) -> Result<Vec<BiasWalk>, ObservabilityError> {
        let Some(noise) = &self.assumption.walk else { return Ok(Vec::new()) };
        let walk = |interval: &Preintegrated| Ok(BiasWalk::new(noise, interval.duration)?);
        self.intervals.iter().map(walk).collect()
    }

    fn not_in_front(&self, observation: usize) -> ObservabilityError {
        let ReprojFactor { keyframe: state, point: landmark, .. } = self.observations[observation];
        ObservabilityError::NotInFront { observation, state, landmark }
    }

    /// Whether the parts of the window fit together.
    pub(super) fn check(&self) -> Result<(), ObservabilityError> {
        let (states, landmarks) = (self.states.len(), self.landmarks.len());
        if states == 0 || landmarks == 0 {
            return Err(ObservabilityError::Empty { states, landmarks });
        }
        let intervals = self.intervals.len();
        if intervals != 0 && intervals + 1 != states {
            return Err(ObservabilityError::Intervals { states, intervals });
        }
        let (given, expected) = (self.biases.len(), self.bias_index(states - 1) + 1);
        if given != expected {
            return Err(ObservabilityError::Biases { given, expected });
        }
        let given = self.angular_velocities.len();
        if given != states {
            return Err(ObservabilityError::AngularVelocities { given, states });
        }
        let missing =
            |factor: &ReprojFactor| factor.keyframe >= states || factor.point >= landmarks;
        self.observations.iter().position(missing).map_or(Ok(()), |observation| {
            let ReprojFactor { keyframe: state, point: landmark, .. } =
                self.observations[observation];
            Err(ObservabilityError::NoSuchVariable { observation, state, landmark })
        })
    }
}

fn finite(residual: DVector<f64>) -> Result<DVector<f64>, ObservabilityError> {
    match residual.iter().position(|value| !value.is_finite()) {
        Some(row) => Err(ObservabilityError::NotFinite { row }),
        None => Ok(residual),
    }
}

// ANCHOR: retract
/// A step moves all that is unknown: states (φ, v, p), then biases, then landmarks.
impl Manifold for Window {
    fn dimension(&self) -> usize {
        self.unknown().len()
    }

    fn retract(&self, step: &[f64]) -> Self {
        let (biases, landmarks) = self.starts();
        let mut whole = vec![0.0; landmarks + 3 * self.landmarks.len()];
        for (column, change) in self.unknown().into_iter().zip(step) {
            whole[column] = *change;
        }
        let mut moved = self.clone();
        for (state, step) in moved.states.iter_mut().zip(whole.chunks_exact(9)) {
            *state = state.retract(step);
        }
        for (bias, step) in moved.biases.iter_mut().zip(whole[biases..].chunks_exact(6)) {
            *bias = ImuBias::from_vector(&bias.vector().retract(step));
        }
        for (landmark, step) in moved.landmarks.iter_mut().zip(whole[landmarks..].chunks_exact(3)) {
            *landmark = landmark.retract(step);
        }
        moved
    }
}
// ANCHOR_END: retract
