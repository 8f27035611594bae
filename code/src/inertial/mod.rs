//! What an inertial measurement unit measures, and how a state moves with it.
//!
//! The body frame is that of the sensor. Rotations are `world_from_body`, positions and
//! velocities are in the world, whose z axis points up against [`GRAVITY`]. The gyroscope
//! gives the angular velocity in the body frame, in rad/s. The accelerometer gives the
//! *specific force* in the body frame, in m/s²: acceleration less gravity, so that it reads
//! +9.81 upward at rest. Where two sensors stand in one vector, the gyroscope comes first.

mod axis_noise;
mod camera;
mod gravity;
mod noise;
mod sample;
mod state;

pub use axis_noise::AxisNoise;
pub use camera::{Calibrated, CameraImu};
pub use gravity::Gravity;
pub use noise::{ImuNoise, NoiseError};
pub use sample::{ImuBias, ImuSample, LONGEST_STEP, StampedSample, WindowError, between};
pub use state::{BodyPose, GRAVITY, NavState};
