//! What is known of a camera and an inertial sensor on one body.

use nalgebra::Vector3;

use crate::inertial::{Calibrated, CameraImu, ImuNoise};

use crate::reprojection::Pinhole;
use crate::simulation::Flight;

// ANCHOR: sensors
/// What is known of a camera and an inertial sensor on one body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// The camera.
    pub camera: Pinhole,
    /// The standard deviation of each coordinate of a pixel.
    pub pixel_sigma: f64,
    /// The densities of the noise of the readings and of the walk of their biases.
    pub noise: ImuNoise,
    /// How the camera sits on the body and how its clock goes.
    pub rig: CameraImu,
    /// What of that is estimated.
    pub calibrated: Calibrated,
    /// The size of gravity, in m/s². The world's third axis points up.
    pub gravity: f64,
}
// ANCHOR_END: sensors

impl Sensors {
    /// Those of a simulated flight.
    pub fn of_flight(flight: &Flight) -> Self {
        let Flight { camera, pixel_sigma, noise, rig, gravity, .. } = *flight;
        let calibrated = Calibrated::default();
        Self { camera, pixel_sigma, noise, rig, calibrated, gravity: gravity.norm() }
    }

    /// The acceleration of free fall in the world, in m/s².
    pub fn gravity(&self) -> Vector3<f64> {
        Vector3::new(0.0, 0.0, -self.gravity)
    }
}
