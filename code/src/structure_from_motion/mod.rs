//! A camera's pose from points that are known, and the similarity between two worlds: what joins
//! one picture after another to a map.
//!
//! [`poses_of_three`] finds the poses from which three points are seen in given directions, [`resect`]
//! the most likely pose for many, with its covariance; [`Sightings`] are data for
//! [`consensus`](crate::robust_two_view::consensus) over both. [`absolute_orientation`] is for points
//! that are known in two worlds, and [`PointPairs`] for those of which some are wrong.
//!
//! [`reconstruct`] makes a map of [`Picture`]s and their matches with all of them. It begins with what
//! [`verify`] and [`join_matches`] do: matches are tried pair by pair, and joined to tracks.

mod absolute_orientation;
mod adjustment;
mod completion;
mod first_pair;
mod growth;
mod map;
mod pictures;
mod point_pairs;
mod reconstruction;
mod resection;
mod sightings;
mod three_points;
mod tracks;
mod verification;

pub use absolute_orientation::{OrientationError, ScaleFreedom, absolute_orientation};
pub use growth::{GROWTH, LEAST_SEEN};
pub use pictures::{Picture, PictureMatch};
pub use point_pairs::PointPairs;
use reconstruction::NoFirstPair;
pub use reconstruction::{
    Adjustments, Joined, MapPoint, Reconstruction, ReconstructionError, ReconstructionOptions,
    Refused, Verified, reconstruct,
};
pub use resection::{Resected, ResectionError, linear_pose, resect};
pub use sightings::Sightings;
pub use three_points::{ThreePointError, poses_of_three};
pub use tracks::{Tracks, join_matches};
pub use verification::verify;
