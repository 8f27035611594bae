//! Two pictures of one scene: what binds them together, the points that they fix, and how
//! sure those points are.
//!
//! [`essential_matrix`] and its companions compare two pictures without asking for a point.
//! [`triangulate`] finds a point from two or more [`View`]s whose poses are known,
//! [`triangulate_nonlinear`] moves it to where it is most likely and says how sure that is, and
//! [`StereoFactor`] is what a pair of lenses at a known distance tells an estimator.
//!
//! Only [`triangulate_nonlinear`] allocates.

mod epipolar;
mod likelihood;
mod scale;
mod stereo;
mod triangulation;
mod uncertainty;

pub(crate) use epipolar::cofactors;
pub use epipolar::{
    EssentialError, epipolar_line, epipolar_residual, essential_matrix, fundamental_matrix,
    ray_depths, relative_pose, relative_poses, sampson_distance,
};
pub use likelihood::{Triangulated, triangulate_nonlinear};
pub use scale::scale_direction;
pub use stereo::{LinearizedStereo, StereoError, StereoFactor, StereoPinhole, StereoProjection};
pub(crate) use triangulation::widest_parallax;
pub use triangulation::{LEAST_PARALLAX, TriangulationError, View, triangulate};
pub use uncertainty::{depth_bias, point_condition, ray_sigma};
