//! A motion with a camera and an inertial sensor on board, and what is wrong with them.

use nalgebra::{Isometry3, Rotation3, Vector2, Vector3};
use thiserror::Error;

use super::Trajectory;
use crate::inertial::{CameraImu, GRAVITY, ImuBias, ImuNoise, NoiseError};
use crate::reprojection::{Pinhole, RigCamera};
use crate::two_views::StereoPinhole;

/// A motion with a camera and an inertial sensor on board. The numbers by which readings and pixels
/// are disturbed are those by which an estimator whitens them.
#[derive(Debug, Clone, PartialEq)]
pub struct Flight {
    /// How the body moves.
    pub motion: Trajectory,
    /// How long it flies, in seconds.
    pub seconds: f64,
    /// The acceleration of free fall, in the world, in m/s².
    pub gravity: Vector3<f64>,
    /// Readings in a second.
    pub imu_rate: f64,
    /// The densities of the noise of the readings and of the walk of their biases.
    pub noise: ImuNoise,
    /// The biases at the beginning.
    pub initial_bias: ImuBias,
    /// Pictures in a second, the first one at the beginning.
    pub picture_rate: f64,
    /// The camera, with an image of `image` pixels.
    pub camera: Pinhole,
    /// Width and height of the image, in pixels.
    pub image: Vector2<f64>,
    /// How the camera sits on the body and how its clock goes. The clock of a camera that is late
    /// by a number of seconds has them as its time offset.
    pub rig: CameraImu,
    /// How far to the right of the camera a second one of the same kind sits, in metres, if there
    /// is one.
    pub baseline: Option<f64>,
    /// The standard deviation of each coordinate of a pixel.
    pub pixel_sigma: f64,
    /// The least and the greatest depth at which a landmark is recognized, in metres.
    pub depths: [f64; 2],
    /// How many landmarks are followed at a time, at most.
    pub tracks: usize,
    /// The share of the observations whose pixels are anywhere in the image.
    pub outliers: f64,
    /// From when to when readings are lost, in seconds, if any are.
    pub gap: Option<[f64; 2]>,
}

impl Flight {
    /// Half a minute of a motion: readings at 200 Hz by the EuRoC sensor, pictures at 20 Hz by a
    /// wide camera that looks ahead along the body's x axis from the body's origin. Biases are zero
    /// at the beginning, and nothing is wrong.
    pub fn new(motion: Trajectory) -> Self {
        // Camera axes right, down and ahead, in the body's ahead, left and up.
        let axes = [-Vector3::y(), -Vector3::z(), Vector3::x()];
        let body_from_camera = Rotation3::from_basis_unchecked(&axes);
        let body_from_camera =
            Isometry3::from_parts(Vector3::zeros().into(), body_from_camera.into());
        Self {
            motion,
            seconds: 30.0,
            gravity: GRAVITY,
            imu_rate: 200.0,
            noise: ImuNoise::euroc(),
            initial_bias: ImuBias::default(),
            picture_rate: 20.0,
            camera: Pinhole { fx: 250.0, fy: 250.0, cx: 320.0, cy: 240.0 },
            image: Vector2::new(640.0, 480.0),
            rig: CameraImu { body_from_camera, time_offset: 0.0 },
            baseline: None,
            pixel_sigma: 1.0,
            depths: [0.3, 30.0],
            tracks: 100,
            outliers: 0.0,
            gap: None,
        }
    }

    /// Two seconds of a motion with nine pictures and a reading every hundredth of a second.
    pub fn brief(motion: Trajectory) -> Self {
        Self { seconds: 2.0, imu_rate: 100.0, picture_rate: 4.0, ..Self::new(motion) }
    }

    /// The same with the camera `lever` metres from the sensor, in the body frame.
    pub fn with_lever(mut self, lever: Vector3<f64>) -> Self {
        self.rig.body_from_camera.translation.vector = lever;
        self
    }

    /// The second camera on the rig of the first one, if there is one.
    pub fn right(&self) -> Option<RigCamera> {
        let Self { camera, baseline, .. } = *self;
        baseline.map(|baseline| {
            let camera_from_first = StereoPinhole { camera, baseline }.right_from_left();
            RigCamera { camera, camera_from_first }
        })
    }

    /// Seconds from one reading to the next.
    pub fn step(&self) -> f64 {
        1.0 / self.imu_rate
    }

    /// How many pictures are taken.
    pub fn pictures(&self) -> usize {
        // As many as fit; a product that is whole but for its rounding counts as whole.
        ((self.seconds * self.picture_rate + 1e-9) as usize).saturating_add(1)
    }

    /// How many readings are taken: as many as reach the last picture.
    pub(super) fn readings(&self) -> usize {
        ((self.seconds * self.imu_rate - 1e-9).ceil() as usize).saturating_add(1)
    }

    /// The pixel of a point in camera coordinates, if it is in the image.
    pub(crate) fn pixel(&self, point_in_camera: &Vector3<f64>) -> Option<Vector2<f64>> {
        let pixel = self.camera.project_cam(point_in_camera)?;
        let inside = pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x <= self.image.x;
        (inside && pixel.y <= self.image.y).then_some(pixel)
    }

    /// Whether the numbers can be those of a flight.
    pub(crate) fn check(&self) -> Result<(), FlightError> {
        self.noise.check()?;
        let stands = self.motion.stands;
        let are_apart = stands.windows(2).all(|pair| pair[0][1] + 2.0 <= pair[1][0]);
        let first = stands.iter().find(|[from, to]| from > to || !are_apart);
        if let Some(&[value, _]) = first {
            let wanted = "spans in order, two seconds apart";
            return Err(FlightError::Number { name: "stands", value, wanted });
        }
        for (name, value) in [
            ("seconds", self.seconds),
            ("imu_rate", self.imu_rate),
            ("picture_rate", self.picture_rate),
            ("image", self.image.x),
            ("image", self.image.y),
            ("camera", self.camera.fx),
            ("camera", self.camera.fy),
            ("baseline", self.baseline.unwrap_or(1.0)),
        ] {
            FlightError::positive(name, value)?;
        }
        let [from, to] = self.gap.unwrap_or([0.0, 0.0]);
        let [nearest, farthest] = self.depths;
        let bias = self.initial_bias.vector().sum();
        let most = self.seconds * self.imu_rate.max(self.picture_rate);
        let finite = "a finite number";
        let principal = self.camera.cx + self.camera.cy;
        let lever = self.rig.body_from_camera;
        let mounting = lever.translation.vector.sum() + lever.rotation.coords.sum();
        for (name, value, holds, wanted) in [
            ("seconds", self.seconds, most < MOST, "fewer, or lower rates"),
            ("initial_bias", bias, bias.is_finite(), "finite numbers"),
            ("camera", principal, principal.is_finite(), "finite numbers"),
            ("body_from_camera", mounting, mounting.is_finite(), "finite numbers"),
            ("time_offset", self.rig.time_offset, self.rig.time_offset.is_finite(), finite),
            ("gravity", self.gravity.sum(), self.gravity.sum().is_finite(), "finite numbers"),
            ("pixel_sigma", self.pixel_sigma, is_size(self.pixel_sigma), "zero or more pixels"),
            ("depths", nearest, nearest < farthest, "the smaller depth first"),
            ("outliers", self.outliers, (0.0..=1.0).contains(&self.outliers), "zero to one"),
            ("gap", from, from <= to, "the earlier time first"),
        ] {
            if !holds {
                return Err(FlightError::Number { name, value, wanted });
            }
        }
        Ok(())
    }
}

/// Readings and pictures that a flight may have, together with what it takes to hold them.
const MOST: f64 = 1e8;

fn is_size(value: f64) -> bool {
    value >= 0.0 && value.is_finite()
}

/// When what happens at a rate, in 1/s, happens for the `index`th time, counted from zero.
pub(super) fn nanoseconds(index: usize, rate: f64) -> i64 {
    (1e9 * index as f64 / rate).round() as i64
}

/// Why a flight cannot be flown.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum FlightError {
    /// A number can be none of a flight.
    #[error("`{name}` of the flight is {value}; give {wanted}")]
    Number {
        /// Its field, or the argument.
        name: &'static str,
        /// The value given.
        value: f64,
        /// What to give.
        wanted: &'static str,
    },
    /// The motion has no place or no direction at a time.
    #[error("the motion is not finite after {seconds} s; mend it, or end the flight before")]
    Motion {
        /// The time.
        seconds: f64,
    },
    /// A density of the noise is none.
    #[error(transparent)]
    Noise(#[from] NoiseError),
}

impl FlightError {
    pub(super) fn positive(name: &'static str, value: f64) -> Result<(), Self> {
        let wanted = "a positive, finite number";
        let holds = value > 0.0 && value.is_finite();
        if holds { Ok(()) } else { Err(Self::Number { name, value, wanted }) }
    }
}
