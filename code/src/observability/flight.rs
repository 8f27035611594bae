//! Windows of flights that are known exactly.

use nalgebra::Vector3;

use super::{BiasAssumption, ObservabilityError, UnknownCalibration, Window};
use crate::factors::Exposure;
use crate::inertial::{ImuBias, ImuSample, NavState};
use crate::manifold::{se3, so3};
use crate::preintegration::{Preintegrated, preintegrate};
use crate::reprojection::ReprojFactor;
use crate::simulation::Flight;

impl Flight {
    // ANCHOR: reading
    /// What the sensor reads in the step after a time: the mean angular velocity of the step, and the
    /// force at its beginning. A motion made of such steps has the body's directions exactly.
    fn reading(&self, t: f64) -> ImuSample {
        let dt = self.step();
        let (now, next) = (self.motion.at(t), self.motion.at(t + dt));
        let turn = so3::local(&now.state.world_from_body, &next.state.world_from_body);
        ImuSample { gyro: turn / dt, ..now.sample(&self.gravity) }
    }

    /// The window of the flight as perfect sensors see it, with the landmarks that at least two
    /// pictures show. The states are those that the readings lead to, so that every residual is
    /// zero. Between two pictures there are equally many readings.
    ///
    /// # Errors
    ///
    /// An [`ObservabilityError`] when the numbers of the flight cannot be those of a motion.
    pub fn window(
        &self,
        landmarks: &[Vector3<f64>],
        assumption: BiasAssumption,
    ) -> Result<Window, ObservabilityError> {
        self.check()?;
        let (bias, dt, readings) = (ImuBias::default(), self.step(), self.readings_between());
        let mut states = vec![self.motion.at(0.0).state];
        let mut intervals = Vec::new();
        for k in 0..self.pictures() - 1 {
            let time = |step: usize| (k * readings + step) as f64 * dt;
            let samples: Vec<_> = (0..readings).map(|step| self.reading(time(step))).collect();
            let interval = preintegrate(&samples, dt, &bias, &self.noise)?;
            states.push(interval.predict(&states[k], &self.gravity, &bias));
            intervals.push(interval);
        }
        let seen = self.observe(&states, landmarks)?;
        Ok(self.assemble(states, intervals, seen, assumption))
    }
    // ANCHOR_END: reading

    fn readings_between(&self) -> usize {
        (self.imu_rate / self.picture_rate).round() as usize
    }

    /// That of the body at a picture.
    fn angular_velocity(&self, picture: usize) -> Vector3<f64> {
        let interval = self.readings_between() as f64 * self.step();
        self.motion.at(picture as f64 * interval).angular_velocity
    }

    fn assemble(
        &self,
        states: Vec<NavState>,
        intervals: Vec<Preintegrated>,
        (landmarks, observations): (Vec<Vector3<f64>>, Vec<ReprojFactor>),
        assumption: BiasAssumption,
    ) -> Window {
        let copies = if assumption.walk.is_some() { states.len() } else { 1 };
        Window {
            camera: self.camera,
            rig: self.rig,
            gravity: self.gravity,
            assumption,
            angular_velocities: (0..states.len()).map(|k| self.angular_velocity(k)).collect(),
            states,
            biases: vec![ImuBias::default(); copies],
            landmarks,
            observations,
            intervals,
            calibration: UnknownCalibration::default(),
        }
    }

    /// The landmarks that at least two pictures show, and where they show them.
    fn observe(
        &self,
        states: &[NavState],
        landmarks: &[Vector3<f64>],
    ) -> Result<(Vec<Vector3<f64>>, Vec<ReprojFactor>), ObservabilityError> {
        let in_camera = |k: usize, landmark: &Vector3<f64>| {
            let exposure = Exposure { angular_velocity: &self.angular_velocity(k) };
            let body = exposure.body(&states[k], self.rig.time_offset).at_rest();
            se3::transform(&self.rig.camera_from_world(&body), landmark)
        };
        let mut kept = Vec::new();
        let mut observations = Vec::new();
        for landmark in landmarks {
            let seen: Vec<_> = (0..states.len())
                .filter_map(|k| Some((k, self.pixel(&in_camera(k, landmark))?)))
                .collect();
            if seen.len() < 2 {
                continue;
            }
            for (k, pixel) in seen {
                observations.push(ReprojFactor::new(k, kept.len(), pixel, self.pixel_sigma)?);
            }
            kept.push(*landmark);
        }
        Ok((kept, observations))
    }
}
