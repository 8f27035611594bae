//! What each measurement says of the variables that it depends on: the residual, prediction minus
//! measurement in standard deviations, and its derivatives. One file a measurement. Derivatives
//! of a camera's pixel and of preintegrated readings stand with those; all others stand here.

mod anchor_change;
mod anchored;
mod between_poses;
mod chordal_pose;
mod epipolar;
mod exposure;
mod inertial;
mod pixel_by_anchor;
mod pixel_by_body;
mod pixel_by_camera;
mod pose_up_to_scale;
mod prior;
mod relative_pose;
mod stereo;
mod switched;
mod transfer;

pub use anchor_change::AnchorChange;
pub(crate) use anchor_change::carried;
pub use between_poses::{BetweenPoses, GraphPose, LinearizedError};
pub use chordal_pose::ChordalPose;
pub use epipolar::Epipolar;
pub(crate) use exposure::Exposure;
pub use inertial::{BiasWalkFactor, CombinedInertialFactor, InertialFactor};
pub use pixel_by_anchor::{AnchoredPixel, PixelAtAnchor, PixelByAnchor};
pub use pixel_by_body::{BodyPixel, PixelByBody, pixel_by_state, twist_by_state};
pub use pixel_by_camera::{MovingCamera, PixelByCamera};
pub use pose_up_to_scale::PoseUpToScale;
pub use prior::Prior;
pub use relative_pose::RelativePose;
pub use stereo::StereoByPose;
pub use switched::Switched;
pub use transfer::{Transfer, Transferred, transfer_covariance};
