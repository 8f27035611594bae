//! States, biases and landmarks, and the measurements between them.

use nalgebra::{DMatrix, DVector, Isometry3, Vector1, Vector3};

use super::ObservabilityError;
use crate::factors::{BiasWalkFactor, InertialFactor, PixelByBody};
use crate::inertial::{CameraImu, Gravity, ImuBias, ImuNoise, NavState};
use crate::least_squares::{Columns, Kernel, Key, Problem, ProblemError, SolveError};
use crate::preintegration::Preintegrated;
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

/// What is unknown of how the camera sits on the body and how its clock goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UnknownCalibration {
    /// Whether `body_from_camera` is unknown.
    pub extrinsics: bool,
    /// Whether the time offset is unknown.
    pub time_offset: bool,
}

/// A stretch of time: what is unknown in it, and what was measured.
#[derive(Debug, Clone, PartialEq)]
// ANCHOR: window
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
    /// What of the rig is unknown.
    pub calibration: UnknownCalibration,
}
// ANCHOR_END: window

impl Window {
    /// Index of the bias that holds in an interval, or at a state.
    pub(super) fn bias_index(&self, state: usize) -> usize {
        if self.assumption.walk.is_some() { state } else { 0 }
    }

    // ANCHOR: problem
    /// The window as a problem of states, biases, landmarks, and how the camera sits on the body
    /// and how late its clock is. What is known is held. Pictures alone know of no velocities or
    /// biases.
    ///
    /// # Errors
    ///
    /// An [`ObservabilityError`] when the window does not fit together or a covariance cannot be
    /// inverted.
    pub fn problem(&self) -> Result<Problem, ObservabilityError> {
        self.check()?;
        let (mut problem, variables) = self.unknowns();
        self.add_pixels(&variables, &mut problem)?;
        self.add_intervals(&variables, &mut problem)?;
        Ok(problem)
    }
    // ANCHOR_END: problem

    /// The variables, with what is known held, and no factors.
    fn unknowns(&self) -> (Problem, Variables) {
        let mut problem = Problem::new();
        let variables = Variables::add(self, &mut problem);
        self.hold_known(&variables, &mut problem).expect("the variables are the problem's");
        (problem, variables)
    }

    /// Which coordinates are unknown.
    pub(super) fn columns(&self) -> Columns {
        self.unknowns().0.columns()
    }

    // ANCHOR: hold_known
    /// Holds what is assumed to be known.
    fn hold_known(&self, variables: &Variables, problem: &mut Problem) -> Result<(), ProblemError> {
        let inertial = !self.intervals.is_empty();
        for state in variables.states.iter().filter(|_| !inertial) {
            problem.hold_coordinates(*state, 3..6)?;
        }
        for bias in &variables.biases {
            if !inertial || self.assumption.gyro_known {
                problem.hold_coordinates(*bias, 0..3)?;
            }
            if !inertial || self.assumption.accelerometer_known {
                problem.hold_coordinates(*bias, 3..6)?;
            }
        }
        problem.hold(variables.gravity)?;
        if !self.calibration.extrinsics {
            problem.hold(variables.extrinsics)?;
        }
        if !self.calibration.time_offset {
            problem.hold(variables.time_offset)?;
        }
        Ok(())
    }
    // ANCHOR_END: hold_known

    // ANCHOR: add_pixels
    /// A factor for each pixel, by its state, its landmark, and the camera's place and clock.
    fn add_pixels(&self, variables: &Variables, problem: &mut Problem) -> Result<(), ProblemError> {
        for &ReprojFactor { keyframe, point, pixel, inverse_sigma } in &self.observations {
            let factor = PixelByBody {
                state: variables.states[keyframe],
                landmark: variables.landmarks[point],
                extrinsics: variables.extrinsics,
                time_offset: variables.time_offset,
                camera: self.camera,
                angular_velocity: self.angular_velocities[keyframe],
                pixel,
                inverse_sigma,
            };
            problem.add_factor(factor, Kernel::Squared)?;
        }
        Ok(())
    }
    // ANCHOR_END: add_pixels

    // ANCHOR: add_intervals
    /// A factor for each interval, by the states at its ends and the bias in it, and one for each
    /// step of a bias that walks.
    fn add_intervals(
        &self,
        variables: &Variables,
        problem: &mut Problem,
    ) -> Result<(), ObservabilityError> {
        for (i, interval) in self.intervals.iter().enumerate() {
            let states = [variables.states[i], variables.states[i + 1]];
            let bias = variables.biases[self.bias_index(i)];
            let factor = InertialFactor::new(states, bias, variables.gravity, *interval)?;
            problem.add_factor(factor, Kernel::Squared)?;
            if let Some(noise) = &self.assumption.walk {
                let biases = [variables.biases[i], variables.biases[i + 1]];
                let factor = BiasWalkFactor::new(biases, noise, interval.duration)?;
                problem.add_factor(factor, Kernel::Squared)?;
            }
        }
        Ok(())
    }
    // ANCHOR_END: add_intervals

    // ANCHOR: residual
    /// The whitened residuals: pixels, then intervals, then steps of walking biases.
    ///
    /// # Errors
    ///
    /// An [`ObservabilityError`] when the window does not fit together, a landmark is not in front
    /// of its camera, or a number is not finite.
    pub fn residual(&self) -> Result<DVector<f64>, ObservabilityError> {
        let problem = self.problem()?;
        problem.residual(problem.values()).map_err(|error| self.explained(error))
    }

    /// The derivatives of the whitened residuals by all that is unknown, and the residuals.
    ///
    /// # Errors
    ///
    /// Those of [`Window::residual`].
    pub fn linearize(&self) -> Result<(DMatrix<f64>, DVector<f64>), ObservabilityError> {
        let problem = self.problem()?;
        problem.jacobian(problem.values()).map_err(|error| self.explained(error))
    }
    // ANCHOR_END: residual

    fn explained(&self, error: SolveError) -> ObservabilityError {
        // Pixels were added first, and nothing else is undefined anywhere.
        let SolveError::Undefined { factor: observation } = error else { return error.into() };
        let ReprojFactor { keyframe: state, point: landmark, .. } = self.observations[observation];
        ObservabilityError::NotInFront { observation, state, landmark }
    }

    // ANCHOR: retract
    /// How many coordinates are unknown.
    pub fn dimension(&self) -> usize {
        self.columns().count
    }

    /// The window moved by a step of all that is unknown: states (φ, v, p), then biases, then
    /// landmarks, then what is unknown of the calibration.
    pub fn retract(&self, step: &[f64]) -> Self {
        let (problem, _) = self.unknowns();
        let mut whole = vec![0.0; problem.values().dimension()];
        problem.columns().spread(step, &mut whole);
        let values = problem.values().retract(&whole);
        let rig = CameraImu {
            body_from_camera: values.of_kind::<Isometry3<f64>>()[0],
            time_offset: values.of_kind::<Vector1<f64>>()[0].x,
        };
        let (states, biases) = (values.of_kind().to_vec(), values.of_kind().to_vec());
        Self { states, biases, landmarks: values.of_kind().to_vec(), rig, ..self.clone() }
    }
    // ANCHOR_END: retract

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
        let is_finite = |state: &NavState| {
            let rotation = state.world_from_body.matrix().iter();
            rotation.chain(&state.velocity).chain(&state.position).all(|number| number.is_finite())
        };
        if let Some(state) = self.states.iter().position(|state| !is_finite(state)) {
            return Err(ObservabilityError::State { state });
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

/// The variables of a window's problem.
struct Variables {
    states: Vec<Key<NavState>>,
    biases: Vec<Key<ImuBias>>,
    landmarks: Vec<Key<Vector3<f64>>>,
    extrinsics: Key<Isometry3<f64>>,
    time_offset: Key<Vector1<f64>>,
    gravity: Key<Gravity>,
}

impl Variables {
    fn add(window: &Window, problem: &mut Problem) -> Self {
        Self {
            states: window.states.iter().map(|state| problem.add_variable(*state)).collect(),
            biases: window.biases.iter().map(|bias| problem.add_variable(*bias)).collect(),
            landmarks: window.landmarks.iter().map(|point| problem.add_variable(*point)).collect(),
            extrinsics: problem.add_variable(window.rig.body_from_camera),
            time_offset: problem.add_variable(Vector1::new(window.rig.time_offset)),
            gravity: problem.add_variable(Gravity(window.gravity)),
        }
    }
}
