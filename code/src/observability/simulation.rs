//! Windows of motions that are known exactly.

use nalgebra::{Isometry3, Rotation3, Vector2, Vector3};

use super::{BiasAssumption, ObservabilityError, UnknownCalibration, Window};
use crate::inertial::{CameraImu, GRAVITY, ImuBias, ImuNoise, ImuSample, NavState, Trajectory};
use crate::manifold::so3;
use crate::preintegration::preintegrate;
use crate::reprojection::{Pinhole, ReprojFactor};

// ANCHOR: flight
/// A motion with a camera and an inertial sensor on board, both without errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Flight {
    /// How the body moves.
    pub motion: Trajectory,
    /// The camera, with an image of `image` pixels.
    pub camera: Pinhole,
    /// Width and height of the image, in pixels.
    pub image: Vector2<f64>,
    /// How the camera sits on the body.
    pub rig: CameraImu,
    /// The acceleration of free fall, in the world, in m/s².
    pub gravity: Vector3<f64>,
    /// The densities by which the readings are whitened.
    pub noise: ImuNoise,
    /// The standard deviation by which pixels are whitened, in pixels.
    pub pixel_sigma: f64,
    /// How many pictures are taken.
    pub states: usize,
    /// How many readings there are from one picture to the next.
    pub readings: usize,
    /// Seconds from one reading to the next.
    pub dt: f64,
}
// ANCHOR_END: flight

impl Flight {
    /// Two seconds of a motion: nine pictures, a reading every hundredth of a second, a wide camera
    /// that looks ahead along the body's x axis from the body's origin, and the EuRoC sensor.
    pub fn new(motion: Trajectory) -> Self {
        // Camera axes right, down and ahead, in the body's ahead, left and up.
        let axes = [-Vector3::y(), -Vector3::z(), Vector3::x()];
        let body_from_camera = Rotation3::from_basis_unchecked(&axes);
        let body_from_camera =
            Isometry3::from_parts(Vector3::zeros().into(), body_from_camera.into());
        Self {
            motion,
            camera: Pinhole { fx: 250.0, fy: 250.0, cx: 320.0, cy: 240.0 },
            image: Vector2::new(640.0, 480.0),
            rig: CameraImu { body_from_camera, time_offset: 0.0 },
            gravity: GRAVITY,
            noise: ImuNoise::euroc(),
            pixel_sigma: 1.0,
            states: 9,
            readings: 25,
            dt: 0.01,
        }
    }

    /// The same with the camera `lever` metres from the sensor, in the body frame.
    pub fn with_lever(mut self, lever: Vector3<f64>) -> Self {
        self.rig.body_from_camera.translation.vector = lever;
        self
    }

    // ANCHOR: reading
    /// What the sensor reads in the step after a time: the mean angular velocity of the step, and the
    /// force at its beginning. A motion made of such steps has the body's directions exactly.
    fn reading(&self, t: f64) -> ImuSample {
        let (now, next) = (self.motion.at(t), self.motion.at(t + self.dt));
        let turn = so3::local(&now.state.world_from_body, &next.state.world_from_body);
        ImuSample { gyro: turn / self.dt, ..now.sample(&self.gravity) }
    }

    /// The window of the motion, with the landmarks that at least two pictures show. The states are
    /// those that the readings lead to, so that every residual is zero.
    ///
    /// # Errors
    ///
    /// An [`ObservabilityError`] when the numbers of the flight cannot be those of a motion.
    pub fn window(
        &self,
        landmarks: &[Vector3<f64>],
        assumption: BiasAssumption,
    ) -> Result<Window, ObservabilityError> {
        let bias = ImuBias::default();
        let mut states = vec![self.motion.at(0.0).state];
        let mut intervals = Vec::new();
        for k in 0..self.states.saturating_sub(1) {
            let time = |step: usize| (k * self.readings + step) as f64 * self.dt;
            let samples: Vec<_> = (0..self.readings).map(|step| self.reading(time(step))).collect();
            let interval = preintegrate(&samples, self.dt, &bias, &self.noise)?;
            states.push(interval.predict(&states[k], &self.gravity, &bias));
            intervals.push(interval);
        }
        let seen = self.observe(&states, landmarks)?;
        Ok(self.assemble(states, intervals, seen, assumption))
    }
    // ANCHOR_END: reading

    fn assemble(
        &self,
        states: Vec<NavState>,
        intervals: Vec<crate::preintegration::Preintegrated>,
        (landmarks, observations): (Vec<Vector3<f64>>, Vec<ReprojFactor>),
        assumption: BiasAssumption,
    ) -> Window {
        let interval = self.readings as f64 * self.dt;
        let rate = |k: usize| self.motion.at(k as f64 * interval).angular_velocity;
        let copies = if assumption.walk.is_some() { states.len() } else { 1 };
        Window {
            camera: self.camera,
            rig: self.rig,
            gravity: self.gravity,
            assumption,
            angular_velocities: (0..states.len()).map(rate).collect(),
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
        let mut kept = Vec::new();
        let mut observations = Vec::new();
        for landmark in landmarks {
            let seen: Vec<_> = (0..states.len())
                .filter_map(|k| Some((k, self.pixel(&states[k], landmark)?)))
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

    /// Where a landmark is in the picture of a state, if it is in it.
    fn pixel(&self, state: &NavState, landmark: &Vector3<f64>) -> Option<Vector2<f64>> {
        let pixel = self.camera.project(&self.rig.camera_from_world(state), landmark)?;
        let inside = pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x <= self.image.x;
        (inside && pixel.y <= self.image.y).then_some(pixel)
    }
}

/// Landmarks on all sides of a place, six to ten metres away, spread evenly by the golden angle.
pub fn landmarks_around(centre: &Vector3<f64>, count: usize) -> Vec<Vector3<f64>> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let landmark = |index: usize| {
        let height = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let radius = (1.0 - height * height).sqrt();
        let (sine, cosine) = (golden * index as f64).sin_cos();
        // A second irrational turn makes the distances different from one another.
        let distance = 6.0 + 4.0 * (0.754_877_666 * index as f64).fract();
        centre + distance * Vector3::new(radius * cosine, radius * sine, height)
    };
    (0..count).map(landmark).collect()
}
