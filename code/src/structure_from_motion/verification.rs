//! Which matches of two pictures agree with one motion between them.

use super::pictures::{Arranged, Picture, PictureMatch};
use super::reconstruction::check;
use super::{ReconstructionError, ReconstructionOptions};
use crate::robust_two_view::{
    ConsensusOptions, Matches, NoMotion, RelativeMotion, general_motion, motion_of_matches,
};

// ANCHOR: verify
/// The matches that agree with a motion between their two pictures, ascending; whatever their order was.
///
/// # Errors
///
/// [`ReconstructionError`] when the input or an option is none.
pub fn verify(
    pictures: &[Picture],
    matches: &[PictureMatch],
    options: &ReconstructionOptions,
) -> Result<Vec<PictureMatch>, ReconstructionError> {
    check(options)?;
    let arranged = Arranged::new(pictures, matches)?;
    let pairs = verified_pairs(&arranged, options);
    let given = |pair: &[usize; 2]| {
        let mut ends = pair.map(|keypoint| arranged.given(keypoint));
        ends.sort_unstable();
        let [[a, i], [b, j]] = ends;
        PictureMatch { pictures: [a, b], keypoints: [i, j] }
    };
    let mut agreeing: Vec<_> = pairs.iter().flat_map(|pair| &pair.matches).map(given).collect();
    agreeing.sort_unstable();
    Ok(agreeing)
}
// ANCHOR_END: verify

// ANCHOR: verified_pair
/// Two pictures between which a motion was found, and the matches that agree with it.
pub(super) struct VerifiedPair {
    pub(super) pictures: [usize; 2],
    pub(super) motion: RelativeMotion,
    /// The keypoints, ascending.
    pub(super) matches: Vec<[usize; 2]>,
}

/// The pairs of pictures whose matches have a motion behind them, each with those that agree.
///
/// A turn or a plane is not told from a general motion here: for a match, what agrees with those
/// agrees with this.
pub(super) fn verified_pairs(
    arranged: &Arranged,
    options: &ReconstructionOptions,
) -> Vec<VerifiedPair> {
    let verified = arranged.pairs.iter().filter_map(|(&pictures, matches)| {
        let data = matches_of(arranged, pictures, matches, options.sigma)?;
        let found = general_motion(&data, &two_views(options, pictures)).ok()?;
        let matches = found.inliers.iter().map(|datum| matches[*datum]).collect();
        Some(VerifiedPair { pictures, motion: found.estimate, matches })
    });
    verified.collect()
}
// ANCHOR_END: verified_pair

/// The least number of draws: two pictures of one scene have few wrong matches as a rule, and what
/// a pair misses others of the same points find.
const LEAST_DRAWS: usize = 60;
/// So many find a motion when a third of the matches are right.
const MOST_DRAWS: usize = 10_000;

/// Options for two pictures, which have their own seed.
fn two_views(options: &ReconstructionOptions, [a, b]: [usize; 2]) -> ConsensusOptions {
    let seed = options.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ ((a as u64) << 32 | b as u64);
    ConsensusOptions {
        inlier_probability: options.inlier_probability,
        least_draws: LEAST_DRAWS,
        most_draws: MOST_DRAWS,
        seed,
        ..ConsensusOptions::default()
    }
}

fn matches_of(
    arranged: &Arranged,
    pictures: [usize; 2],
    matches: &[[usize; 2]],
    sigma: f64,
) -> Option<Matches> {
    let cameras = pictures.map(|picture| &arranged.pictures[picture].camera);
    let pixels: Vec<_> = matches.iter().map(|pair| pair.map(|k| arranged.pixel(k))).collect();
    Matches::new(cameras, &pixels, sigma).ok()
}

impl VerifiedPair {
    /// The angles between the two rays of each match, in radians.
    pub(super) fn parallaxes(&self, arranged: &Arranged, sigma: f64) -> Vec<f64> {
        let matches = matches_of(arranged, self.pictures, &self.matches, sigma);
        let angle = |(first, second): &crate::robust_two_view::RayPair| {
            (self.motion.rotation * first).angle(second)
        };
        matches.iter().flat_map(Matches::rays).map(angle).collect()
    }

    /// The motion between the two, or what explains their matches without one.
    pub(super) fn motion_of_all(
        &self,
        arranged: &Arranged,
        options: &ReconstructionOptions,
    ) -> Option<Result<RelativeMotion, NoMotion>> {
        let all = arranged.pairs.get(&self.pictures)?;
        let data = matches_of(arranged, self.pictures, all, options.sigma)?;
        let found = motion_of_matches(&data, &two_views(options, self.pictures));
        Some(found.map(|consensus| consensus.estimate))
    }
}
