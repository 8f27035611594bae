//! Cameras: from a point in space to a pixel, and what moves the pixel.
//!
//! [`Pinhole`] is the ideal camera, [`RadialTangential`] a lens that bends its image and
//! [`DistortedPinhole`] the two together. Both cameras give a [`Projection`]: the pixel of
//! a point in the world with its Jacobians by the camera's pose and by the point. From it
//! [`ReprojFactor`] makes what an estimator asks for, a residual in units of its noise.
//!
//! A pose is moved on the right, T exp(ξ) with ξ = (ρ, φ), as in
//! [`manifold::se3::retract`](crate::manifold::se3::retract). Nothing here allocates.

mod distorted;
mod distortion;
mod factor;
mod model;
mod pinhole;
mod rig_camera;

pub use distorted::DistortedPinhole;
pub use distortion::{DistortionError, RadialTangential, UndistortError};
pub use factor::{LinearizedReproj, ReprojFactor, ReprojFactorError};
pub use model::CameraModel;
pub use pinhole::{Pinhole, PinholeError, Projection, Z_MIN};
pub use rig_camera::RigCamera;
