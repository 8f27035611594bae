//! Robust two-view geometry: from matches, of which many are wrong, to the motion between two
//! pictures, or to the reason why there is none in them.
//!
//! [`five_points`] finds all essential matrices of five pairs of rays, [`eight_points`] one of eight or
//! more; [`homography_of_four`] and [`rotation_of_rays`] are for planes and for turns.
//! [`consensus`] finds, over any of them, the estimate with which the most data agree, and who they
//! are. [`select_model`] chooses between rotation, plane and general motion, and
//! [`motion_of_matches`] gives the motion or says why there is none.

mod candidates;
mod chance;
mod consensus;
mod cubics;
mod eight_point;
mod five_point;
mod general;
mod homography;
mod linear;
mod matches;
mod motion;
mod plane;
mod real_roots;
mod rotation;
mod selection;

pub use candidates::Candidates;
pub use chance::false_alarms;
pub use consensus::{
    Consensus, ConsensusError, ConsensusOptions, Correspondences, Effort, consensus, draws_needed,
};
pub use eight_point::{EightPointError, eight_points};
pub use five_point::{FivePointError, five_points, motions_of_five};
pub use general::{GeneralMotion, general_motion};
pub use homography::{
    HomographyError, PlaneMotion, homography_of_four, homography_of_many, plane_motions,
};
pub(crate) use linear::least_vector;
pub use matches::{MatchError, Matches};
pub(crate) use motion::frame;
pub use motion::{RayPair, RelativeMotion};
pub use plane::{OnePlane, OnlyTurned};
pub use real_roots::real_roots;
pub use rotation::rotation_of_rays;
pub use selection::{NoMotion, TwoViewModel, motion_of_matches, select_model};

/// That all rays are finite and point forward; the first pair that has one which does not.
fn matches_are_finite(pairs: &[RayPair]) -> Result<(), usize> {
    let is_ray = |ray: &nalgebra::Vector3<f64>| {
        let slopes = ray.xy() / ray.z;
        ray.z > 0.0 && slopes.iter().all(|slope| slope.is_finite())
    };
    let is_wrong = |pair: &RayPair| !(is_ray(&pair.0) && is_ray(&pair.1));
    pairs.iter().position(is_wrong).map_or(Ok(()), Err)
}
