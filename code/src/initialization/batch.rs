//! All states, biases and landmarks of a flight at once: the estimate that others are judged by.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, Isometry3, SMatrix, Vector1, Vector2, Vector3};

use super::rest::GAUGE_SIGMA;
use super::{BatchError, Sensors};
use crate::bearing::parallax;
use crate::factors::{BodyPixel, CombinedInertialFactor, Exposure, PixelByBody, Prior};
use crate::inertial::{Calibrated, Gravity, ImuBias, ImuNoise, NavState, StampedSample, between};
use crate::least_squares::{
    Covariance, Fronts, Kernel, Key, LinearPrior, Options, Problem, ProblemError, Solution,
    SolveError, Values, sqrt_information,
};
use crate::manifold::se3;
use crate::msckf::Start;
use crate::preintegration::{
    CombinedPreintegrated, CombinedPreintegrator, PreintegrationError, Rule, preintegrate_combined,
};

/// Where a track was seen: the number of the state, and the pixel.
pub type Sighting = (usize, Vector2<f64>);

// ANCHOR: batch
/// All states, biases and landmarks of a flight, and what was measured of them. Its minimum is that of
/// {eq:batch-cost}.
pub struct Batch {
    pub(super) sensors: Sensors,
    /// The problem, which holds the values where the search begins.
    pub problem: Problem,
    /// The body at each picture.
    pub states: Vec<Key<NavState>>,
    /// The biases at each picture.
    pub biases: Vec<Key<ImuBias>>,
    /// The landmarks, by track.
    pub landmarks: BTreeMap<usize, Key<Vector3<f64>>>,
    /// How the camera sits on the body. Held, unless [`Calibrated`] says that it is estimated.
    pub extrinsics: Key<Isometry3<f64>>,
    /// How much later the pictures were taken than known, in seconds. Held as well.
    pub delay: Key<Vector1<f64>>,
    gravity: Key<Gravity>,
    /// The body's angular velocity at each state, in its frame, in rad/s.
    turning: Vec<Vector3<f64>>,
}
// ANCHOR_END: batch

impl Batch {
    // ANCHOR: batch_new
    /// The states at some times on the sensor's clock, in nanoseconds, with the readings between
    /// them summed up by the midpoint rule, beginning at a guess.
    ///
    /// # Errors
    ///
    /// As those of [`Batch::by_rule`].
    pub fn new(
        sensors: &Sensors,
        readings: &[StampedSample],
        nanoseconds: &[i64],
        guess: &[(NavState, ImuBias)],
    ) -> Result<Self, BatchError> {
        Self::by_rule(Rule::Midpoint, sensors, readings, nanoseconds, guess)
    }

    /// The same by any rule: others hold a reading until the next one, and are compared with.
    ///
    /// # Errors
    ///
    /// A [`BatchError`] when there are fewer than two states or a guess is missing, when the readings do
    /// not reach from one state to the next or cannot be summed up, or when they have no noise.
    pub fn by_rule(
        rule: Rule,
        sensors: &Sensors,
        readings: &[StampedSample],
        nanoseconds: &[i64],
        guess: &[(NavState, ImuBias)],
    ) -> Result<Self, BatchError> {
        let (states, guesses) = (nanoseconds.len(), guess.len());
        if states < 2 || states != guesses {
            return Err(BatchError::States { states, guesses });
        }
        let mut problem = Problem::new();
        let (extrinsics, delay) = (sensors.rig.body_from_camera, Vector1::zeros());
        let mut batch = Self {
            sensors: *sensors,
            states: guess.iter().map(|(state, _)| problem.add_variable(*state)).collect(),
            biases: guess.iter().map(|(_, bias)| problem.add_variable(*bias)).collect(),
            landmarks: BTreeMap::new(),
            extrinsics: problem.add_variable(extrinsics),
            delay: problem.add_variable(delay),
            gravity: problem.add_variable(Gravity(sensors.gravity())),
            turning: Vec::with_capacity(states),
            problem,
        };
        calibrate(&mut batch.problem, (batch.extrinsics, batch.delay), sensors)?;
        batch.problem.hold(batch.gravity)?;
        for state in 1..states {
            let [start, end] = [nanoseconds[state - 1], nanoseconds[state]];
            let readings = between(readings, start, end)?;
            batch.add_interval(rule, state, &readings)?;
        }
        Ok(batch)
    }
    // ANCHOR_END: batch_new

    /// Adds the readings that lead to a state from the one before.
    fn add_interval(
        &mut self,
        rule: Rule,
        state: usize,
        readings: &[StampedSample],
    ) -> Result<(), BatchError> {
        let bias = self.problem.values()[self.biases[state - 1]];
        let sums = match rule {
            Rule::Midpoint => preintegrate_combined(readings, &bias, &self.sensors.noise)?,
            Rule::Euler => held(readings, &bias, &self.sensors.noise)?,
        };
        let (states, biases) = (&self.states, &self.biases);
        let factor = CombinedInertialFactor::new(
            [states[state - 1], states[state]],
            [biases[state - 1], biases[state]],
            self.gravity,
            &sums,
        )?;
        self.problem.add_factor(factor, Kernel::Squared)?;
        let first = readings.first().filter(|_| state == 1);
        let ends = [first, readings.last()].into_iter().flatten();
        self.turning.extend(ends.map(|end| end.sample.corrected(&bias).gyro));
        Ok(())
    }

    // ANCHOR: add_landmark
    /// Adds a landmark and where it was seen.
    ///
    /// # Errors
    ///
    /// [`BatchError::Sighting`] names a state that does not exist, and [`BatchError::Problem`] refuses the
    /// kernel.
    pub fn add_landmark(
        &mut self,
        track: usize,
        place: Vector3<f64>,
        sightings: &[Sighting],
        kernel: Kernel,
    ) -> Result<(), BatchError> {
        let states = self.states.len();
        if let Some((state, _)) = sightings.iter().find(|(state, _)| *state >= states) {
            return Err(BatchError::Sighting { track, state: *state, states });
        }
        let landmark = self.problem.add_variable(place);
        self.landmarks.insert(track, landmark);
        for &(state, pixel) in sightings {
            let factor = PixelByBody {
                state: self.states[state],
                landmark,
                extrinsics: self.extrinsics,
                time_offset: self.delay,
                camera: self.sensors.camera,
                angular_velocity: self.turning[state],
                pixel,
                inverse_sigma: 1.0 / self.sensors.pixel_sigma,
            };
            self.problem.add_factor(factor, kernel)?;
        }
        Ok(())
    }
    // ANCHOR_END: add_landmark

    /// Whether a place lies in front of the camera at all of these states, where they begin.
    pub(super) fn is_in_front(&self, place: &Vector3<f64>, sightings: &[Sighting]) -> bool {
        let values = self.problem.values();
        sightings.iter().all(|(state, _)| {
            let camera_from_world =
                self.sensors.rig.camera_from_world(&values[self.states[*state]]);
            let in_camera = se3::transform(&camera_from_world, place);
            self.sensors.camera.project_cam(&in_camera).is_some()
        })
    }

    /// The widest angle at which two rays of a landmark meet, in radians; infinite when it is no
    /// landmark of this batch, and none when it lies behind a camera.
    pub(super) fn parallax(&self, values: &Values, track: usize, sightings: &[Sighting]) -> f64 {
        let Some(landmark) = self.landmarks.get(&track) else { return f64::INFINITY };
        let place = values[*landmark];
        let body_from_camera = &values[self.extrinsics];
        let mut centres = Vec::with_capacity(sightings.len());
        for (state, pixel) in sightings {
            if !self.off(values, (*state, *landmark), *pixel).is_finite() {
                return 0.0;
            }
            let state = &values[self.states[*state]];
            let lever = body_from_camera.translation.vector;
            centres.push(state.position + state.world_from_body * lever);
        }
        let angles = centres.iter().enumerate().flat_map(|(at, centre)| {
            centres[..at].iter().map(move |other| parallax(&place, centre, other))
        });
        angles.fold(0.0, f64::max)
    }

    // ANCHOR: know
    /// Adds what is known of the first state and its biases: standard deviations of turns, velocity
    /// and position, and of the biases of gyroscope and accelerometer, in rad, m/s, m, rad/s and
    /// m/s². An infinite one says nothing.
    ///
    /// # Errors
    ///
    /// [`BatchError::Problem`].
    pub fn know(
        &mut self,
        (state, bias): (NavState, ImuBias),
        state_sigmas: [f64; 9],
        bias_sigmas: [f64; 6],
    ) -> Result<(), BatchError> {
        let state = Prior::near(self.states[0], state, state_sigmas);
        self.problem.add_factor(state, Kernel::Squared)?;
        let bias = Prior::near(self.biases[0], bias, bias_sigmas);
        self.problem.add_factor(bias, Kernel::Squared)?;
        Ok(())
    }

    /// What is known of a state and its biases from a start, with its covariance.
    ///
    /// # Errors
    ///
    /// [`BatchError::State`] when there is no such state, and [`BatchError::Whitening`] when the covariance
    /// is none.
    pub fn know_start(&mut self, state: usize, start: &Start) -> Result<(), BatchError> {
        self.check_state(state)?;
        let root = sqrt_information(&start.covariance)?;
        let mut anchors = self.problem.values().clone();
        anchors.set(self.states[state], start.state);
        anchors.set(self.biases[state], start.bias);
        let variables = [self.states[state].index(), self.biases[state].index()];
        let root = DMatrix::from_fn(15, 15, |row, column| root[(row, column)]);
        let prior = LinearPrior::of_root(&anchors, &variables, root, DVector::zeros(15))?;
        self.problem.add_prior(prior)?;
        Ok(())
    }

    /// Tells that the body stands at a state, to a standard deviation of its velocity in m/s on each
    /// axis.
    ///
    /// # Errors
    ///
    /// [`BatchError::State`] when there is no such state, and [`BatchError::Problem`].
    pub fn stand_still(&mut self, state: usize, sigma: f64) -> Result<(), BatchError> {
        self.check_state(state)?;
        let free = f64::INFINITY;
        let sigmas = [free, free, free, sigma, sigma, sigma, free, free, free];
        let anchor =
            NavState { velocity: Vector3::zeros(), ..self.problem.values()[self.states[state]] };
        let prior = Prior::near(self.states[state], anchor, sigmas);
        self.problem.add_factor(prior, Kernel::Squared)?;
        Ok(())
    }

    fn check_state(&self, state: usize) -> Result<(), BatchError> {
        let states = self.states.len();
        (state < states).then_some(()).ok_or(BatchError::State { state, states })
    }

    /// By how many standard deviations a pixel is off; infinite behind the camera.
    pub(super) fn off(
        &self,
        values: &Values,
        (state, landmark): (usize, Key<Vector3<f64>>),
        pixel: Vector2<f64>,
    ) -> f64 {
        let Sensors { camera, pixel_sigma, .. } = self.sensors;
        let body_from_camera = &values[self.extrinsics];
        let exposure = Exposure { angular_velocity: &self.turning[state] };
        let body = exposure.body(&values[self.states[state]], values[self.delay].x);
        let seen = BodyPixel { camera: &camera, pixel, inverse_sigma: 1.0 / pixel_sigma };
        let residual = seen.residual((&body, &values[landmark], body_from_camera));
        residual.map_or(f64::INFINITY, |residual| residual.norm())
    }

    /// Fixes what nothing measures: the first position, and the heading of the first state, a turn
    /// about the vertical. Implements {eq:batch-gauge}.
    ///
    /// # Errors
    ///
    /// [`BatchError::Problem`].
    pub fn fix_gauge(&mut self) -> Result<(), BatchError> {
        let anchor = self.problem.values()[self.states[0]];
        let mut root = SMatrix::<f64, 9, 9>::zeros();
        let up_in_body = anchor.world_from_body.inverse() * Vector3::z();
        root.fixed_view_mut::<1, 3>(0, 0).copy_from(&(up_in_body.transpose() / GAUGE_SIGMA));
        root.fixed_view_mut::<3, 3>(6, 6).fill_diagonal(1.0 / GAUGE_SIGMA);
        let prior = Prior { variable: self.states[0], anchor, sqrt_information: root };
        self.problem.add_factor(prior, Kernel::Squared)?;
        Ok(())
    }
    // ANCHOR_END: know

    // ANCHOR: solve
    /// The most likely values.
    ///
    /// # Errors
    ///
    /// A [`SolveError`].
    pub fn solve(&self, options: &Options) -> Result<Solution, SolveError> {
        self.problem.solve_with(Fronts::new(&self.problem)?, options)
    }
    // ANCHOR_END: solve

    /// The cost of values.
    pub fn cost(&self, values: &Values) -> f64 {
        self.problem.cost(values)
    }

    /// The covariance of values, by variables.
    ///
    /// # Errors
    ///
    /// A [`SolveError`], when something is not determined.
    pub fn covariance(&self, values: &Values) -> Result<Covariance, SolveError> {
        self.problem.covariance_with(Fronts::new(&self.problem)?, values)
    }
}

/// Holds what is known of the calibration, and adds how well the rest is known.
pub(crate) fn calibrate(
    problem: &mut Problem,
    (extrinsics, delay): (Key<Isometry3<f64>>, Key<Vector1<f64>>),
    sensors: &Sensors,
) -> Result<(), ProblemError> {
    let Calibrated { extrinsics: sigmas, time_offset } = sensors.calibrated;
    match sigmas {
        None => problem.hold(extrinsics)?,
        Some([shift, turn]) => {
            let sigmas = [shift, shift, shift, turn, turn, turn];
            let prior = Prior::near(extrinsics, sensors.rig.body_from_camera, sigmas);
            problem.add_factor(prior, Kernel::Squared)?;
        }
    }
    match time_offset {
        None => problem.hold(delay)?,
        Some(sigma) => {
            let prior = Prior::near(delay, Vector1::zeros(), [sigma]);
            problem.add_factor(prior, Kernel::Squared)?;
        }
    }
    Ok(())
}

/// Sums of readings each of which holds until the next one.
fn held(
    readings: &[StampedSample],
    bias: &ImuBias,
    noise: &ImuNoise,
) -> Result<CombinedPreintegrated, PreintegrationError> {
    let mut sums = CombinedPreintegrator::new(bias, noise)?;
    for pair in readings.windows(2) {
        sums.integrate(&pair[0].sample, pair[0].seconds_to(&pair[1]))?;
    }
    sums.finish()
}
