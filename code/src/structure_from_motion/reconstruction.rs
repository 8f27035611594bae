//! From matches to cameras and points.

use nalgebra::{Isometry3, Vector3};
use thiserror::Error;

use super::first_pair::first_pairs;
use super::growth::Attempt;
use super::map::Map;
use super::pictures::{Arranged, Picture, PictureMatch};
use super::tracks::tracks;
use super::verification::{VerifiedPair, verified_pairs};
use crate::filtering::chi_square_quantile;
use crate::reprojection::PinholeError;
use crate::robust_two_view::ConsensusError;
use crate::two_views::LEAST_PARALLAX;

// ANCHOR: reconstruction_options
/// How to make a map of matches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReconstructionOptions {
    /// The standard deviation of each coordinate of a keypoint, in pixels.
    pub sigma: f64,
    /// The probability with which a right pixel shall be taken for one: it gives the gates, quantiles
    /// of the chi-square distribution.
    pub inlier_probability: f64,
    /// The least angle between two rays of a point, in radians, while the map grows.
    pub least_parallax: f64,
    /// The angle between two rays, in radians, with which a match counts for the first pair.
    pub first_parallax: f64,
    /// How many such matches, and then points, the first pair needs.
    pub least_points: usize,
    /// With how many first pairs to try.
    pub most_starts: usize,
    /// What is adjusted while the map grows, and at the end.
    pub adjustments: Adjustments,
    /// The same seed gives the same result.
    pub seed: u64,
}

/// Which adjustments are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Adjustments {
    /// None but that of the first pair: each camera stays where it was joined.
    None,
    /// With each new camera those that share the most points with it.
    Local,
    /// Those, all together whenever the map has grown, and at the end.
    LocalAndGlobal,
}

impl Default for ReconstructionOptions {
    fn default() -> Self {
        Self {
            sigma: 1.0,
            inlier_probability: 0.9995,
            least_parallax: LEAST_PARALLAX,
            first_parallax: 4.0 * LEAST_PARALLAX,
            least_points: 20,
            most_starts: 5,
            adjustments: Adjustments::LocalAndGlobal,
            seed: 0,
        }
    }
}
// ANCHOR_END: reconstruction_options

// ANCHOR: reconstruction
/// Cameras and points, up to a similarity of the whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconstruction {
    /// For each picture the pose `camera_from_world`, or why it has none.
    pub cameras: Vec<Result<Isometry3<f64>, Refused>>,
    /// The points.
    pub points: Vec<MapPoint>,
    /// The pictures in the order in which they were joined, with the first two first.
    pub joined: Vec<Joined>,
    /// How many pairs of pictures were verified, and their matches.
    pub verified: Verified,
}

/// A point and where it was seen.
#[derive(Debug, Clone, PartialEq)]
pub struct MapPoint {
    /// Where it is.
    pub place: Vector3<f64>,
    /// The picture and keypoint of each sighting that it explains.
    pub sightings: Vec<[usize; 2]>,
}

/// A picture that was joined to the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joined {
    /// Which one.
    pub picture: usize,
    /// How many known points it was said to see; zero for the first two.
    pub seen: usize,
    /// How many agreed with its pose; zero for the first two.
    pub inliers: usize,
    /// How many points the map had afterwards.
    pub points: usize,
}

/// What is left of the matches before the map begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Verified {
    /// Pairs of pictures that have matches.
    pub pairs: usize,
    /// Those between which a motion was found.
    pub verified_pairs: usize,
    /// All matches, each counted once.
    pub matches: usize,
    /// Those that agree with the motions.
    pub verified_matches: usize,
    /// The tracks that they are joined to.
    pub tracks: usize,
}
// ANCHOR_END: reconstruction

// ANCHOR: reconstruct
/// Incremental reconstruction: from matches of pictures, of which many may be wrong, to the cameras
/// and points that explain them [@schonberger2016].
///
/// Matches are verified pair by pair, then joined to tracks. The map begins with two pictures that
/// share many points with parallax, and takes in one picture after another: resection, the points
/// that follow, adjustment, and a look at what no longer fits. When no picture is left that sees enough,
/// all are adjusted, and what pixels are still unexplained are tried with the known cameras. A map
/// that leaves pictures out is tried again from another pair, and the one with the most pictures
/// counts.
///
/// The result does not depend on the order of pictures, keypoints and matches, but for the
/// numbers by which they are told, which are those given.
///
/// # Errors
///
/// [`ReconstructionError`] when the input is none, an option is out of its range, or no two pictures give a beginning. A picture
/// that cannot be joined is no error: its entry says why.
pub fn reconstruct(
    pictures: &[Picture],
    matches: &[PictureMatch],
    options: &ReconstructionOptions,
) -> Result<Reconstruction, ReconstructionError> {
    let gate = check(options)?;
    let arranged = Arranged::new(pictures, matches)?;
    let pairs = verified_pairs(&arranged, options);
    let agreeing: Vec<[usize; 2]> = pairs.iter().flat_map(|pair| &pair.matches).copied().collect();
    let (tracks, _) = tracks(&arranged, &agreeing);
    let verified = Verified {
        pairs: arranged.pairs.len(),
        verified_pairs: pairs.len(),
        matches: arranged.pairs.values().map(Vec::len).sum(),
        verified_matches: agreeing.len(),
        tracks: tracks.len(),
    };
    let candidates = first_pairs(&arranged, &pairs, options);
    let narrow = pairs.len() - candidates.len();
    let mut reasons = [0; 3];
    let (mut best, mut starts): (Option<Grown>, usize) = (None, 0);
    for index in candidates {
        let is_known = |grown: &Grown| {
            pairs[index].pictures.iter().all(|picture| grown.map.poses[*picture].is_some())
        };
        if best.as_ref().is_some_and(is_known) {
            continue;
        }
        if starts == options.most_starts || reasons.iter().sum::<usize>() == MOST_REFUSED {
            break;
        }
        let mut map = Map::new(&arranged, options, gate, &tracks);
        if let Err(reason) = map.begin(&pairs[index]) {
            reasons[reason as usize] += 1;
            continue;
        }
        starts += 1;
        let grown = Grown::from(map, &pairs[index]);
        if best.as_ref().is_none_or(|best| grown.size() > best.size()) {
            best = Some(grown);
        }
        if best.as_ref().is_some_and(Grown::is_whole) {
            break;
        }
    }
    let [rotations, planes, few] = reasons;
    let none = ReconstructionError::NoFirstPair {
        pairs: verified.pairs,
        verified: verified.verified_pairs,
        narrow,
        rotations,
        planes,
        few,
    };
    Ok(best.ok_or(none)?.told(verified))
}
// ANCHOR_END: reconstruct

/// After so many pairs that are no beginning, others are not tried.
const MOST_REFUSED: usize = 50;

/// A map that does not grow any more.
struct Grown<'a> {
    map: Map<'a>,
    joined: Vec<Joined>,
    attempts: Vec<Option<Attempt>>,
}

impl<'a> Grown<'a> {
    // ANCHOR: grown
    /// Grows a map that has begun: as far as it goes, and again after what the adjustment of all of it
    /// has brought, until that brings no picture anything new.
    fn from(mut map: Map<'a>, pair: &VerifiedPair) -> Self {
        let first = |picture| Joined { picture, seen: 0, inliers: 0, points: map.points() };
        let mut joined = pair.pictures.map(first).to_vec();
        let mut attempts = vec![None; map.poses.len()];
        loop {
            let before = map.registered();
            map.grow(&mut joined, &mut attempts);
            if map.options.adjustments != Adjustments::LocalAndGlobal {
                break;
            }
            map.complete();
            let known = map.registered();
            if known > before && known < map.poses.len() {
                continue;
            }
            map.grow(&mut joined, &mut attempts);
            if map.registered() == known {
                break;
            }
        }
        Self { map, joined, attempts }
    }
    // ANCHOR_END: grown

    fn size(&self) -> (usize, usize) {
        (self.map.registered(), self.map.sightings())
    }

    fn is_whole(&self) -> bool {
        let has_tracks = |picture: usize| self.map.tracks_in(picture).next().is_some();
        (0..self.map.poses.len()).all(|p| self.map.poses[p].is_some() || !has_tracks(p))
    }

    /// In the numbers that were given.
    fn told(self, verified: Verified) -> Reconstruction {
        let Self { map, joined, attempts } = self;
        let arranged = map.arranged;
        let mut cameras = vec![Err(Refused::NoMatches); map.poses.len()];
        for (picture, given) in arranged.given_picture.iter().enumerate() {
            let refusal = || map.refusal(picture, attempts[picture].as_ref());
            cameras[*given] = map.poses[picture].ok_or_else(refusal);
        }
        let known = map.tracks.iter().filter_map(|track| Some((track, track.point?)));
        let points = known.map(|(track, place)| MapPoint {
            place,
            sightings: track.sightings().map(|k| arranged.given(k)).collect(),
        });
        let points = points.collect();
        let given = |one: Joined| Joined { picture: arranged.given_picture[one.picture], ..one };
        let joined = joined.into_iter().map(given).collect();
        Reconstruction { cameras, points, joined, verified }
    }
}

/// That options are in their ranges; the gate for both coordinates of a pixel, in variances.
pub(super) fn check(options: &ReconstructionOptions) -> Result<f64, ReconstructionError> {
    let ReconstructionOptions { sigma, inlier_probability, least_parallax, first_parallax, .. } =
        *options;
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    let positive =
        [("sigma", sigma), ("least_parallax", least_parallax), ("first_parallax", first_parallax)];
    if let Some((name, value)) = positive.into_iter().find(|(_, value)| !is_positive(*value)) {
        return Err(ReconstructionError::Option { name, value });
    }
    if options.most_starts == 0 {
        return Err(ReconstructionError::Option { name: "most_starts", value: 0.0 });
    }
    let (name, value) = ("inlier_probability", inlier_probability);
    let is_probability = value > 0.0 && value < 1.0;
    let gate = is_probability.then(|| chi_square_quantile(value, 2).ok()).flatten();
    gate.ok_or(ReconstructionError::Option { name, value })
}

/// Why a pair is no beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoFirstPair {
    /// A rotation explains its matches.
    Rotation,
    /// A plane does.
    Plane,
    /// Too few points follow from it.
    Points,
}

/// Why a picture is not in the map.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Refused {
    /// None of its matches agrees with a motion.
    #[error("none of its matches agrees with a motion; give more right ones")]
    NoMatches,
    /// It sees too little of the map.
    #[error(
        "it has {tracks} tracks, of which the map knows {seen} points; {needed} are needed: give \
         matches with pictures of the map"
    )]
    FewPoints {
        /// Its tracks.
        tracks: usize,
        /// Those whose points are known.
        seen: usize,
        /// The least number.
        needed: usize,
    },
    /// The points that it is said to see do not give a pose.
    #[error("it is said to see {seen} points of the map, which give no pose: {error}")]
    NoPose {
        /// How many points.
        seen: usize,
        /// Why not.
        error: ConsensusError,
    },
}

/// Why there is no map.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ReconstructionError {
    /// The intrinsics are none.
    #[error("picture {picture}: {error}")]
    Camera {
        /// Which picture.
        picture: usize,
        /// What is wrong.
        error: PinholeError,
    },
    /// A pixel is NaN or infinite.
    #[error("picture {picture}: keypoint {keypoint} is not finite; leave it out")]
    Keypoint {
        /// Which picture.
        picture: usize,
        /// Which keypoint.
        keypoint: usize,
    },
    /// A match names what is not there.
    #[error("match {at}: there is no keypoint {keypoint} in a picture {picture}; count from zero")]
    Match {
        /// Which match.
        at: usize,
        /// Which picture it names.
        picture: usize,
        /// Which keypoint.
        keypoint: usize,
    },
    /// A match is one within a picture.
    #[error("match {at} joins two keypoints of picture {picture}; leave it out")]
    WithItself {
        /// Which match.
        at: usize,
        /// Which picture.
        picture: usize,
    },
    /// An option is out of its range.
    #[error("{name} is {value}; give a positive, finite number, below 1 if it is a probability")]
    Option {
        /// Which option.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// No two pictures give a beginning.
    #[error(
        "no two pictures give a beginning: {verified} of {pairs} pairs have a motion behind their \
         matches; {narrow} of them have too few matches with parallax, {rotations} are turns, {planes} show \
         a plane, and from {few} too few points follow; give more right matches, or pictures of a scene \
         with depth from places farther apart"
    )]
    NoFirstPair {
        /// Pairs that have matches.
        pairs: usize,
        /// Those with evidence for a motion.
        verified: usize,
        /// Of those, how many have too few matches with parallax.
        narrow: usize,
        /// Of the others that were tried, how many a rotation explains.
        rotations: usize,
        /// How many a plane explains.
        planes: usize,
        /// From how many too few points follow.
        few: usize,
    },
}
