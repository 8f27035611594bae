//! Which model two pictures call for: a rotation, a plane, or any motion.

use nalgebra::{Matrix3, Rotation3, Vector3};
use thiserror::Error;

use super::chance::{chance_of_agreement, false_alarms};
use super::consensus::{Consensus, ConsensusError, ConsensusOptions, Correspondences, consensus};
use super::{
    GeneralMotion, Matches, OnePlane, OnlyTurned, PlaneMotion, RelativeMotion, general_motion,
    plane_motions,
};
use crate::filtering::chi_square_above;

// ANCHOR: two_view_model
/// The simplest of three models that the matches do not contradict.
#[derive(Debug, Clone, PartialEq)]
pub enum TwoViewModel {
    /// The camera only turned, or moved by less than the noise shows: there is no depth.
    Rotation(Consensus<Rotation3<f64>>),
    /// All points lie in one plane, which up to two motions explain.
    Plane {
        /// The homography.
        plane: Consensus<Matrix3<f64>>,
        /// The motions.
        motions: Vec<PlaneMotion>,
    },
    /// Points at many depths.
    General(Consensus<RelativeMotion>),
}
// ANCHOR_END: two_view_model

// ANCHOR: select_model
/// The simplest model that no richer one contradicts: a rotation, else a plane, else any motion.
///
/// Two things contradict a simpler model. Its squared errors exceed those of the richer one, over the
/// matches that agree with both, by more than a chi-square quantile: that many degrees of freedom does
/// the simpler model leave more. Or more of the matches that are far off it agree with the richer
/// one than chance explains. Both probabilities of a false alarm are
/// [`ConsensusOptions::false_alarms`], for a baseline of one direction; the general motion chooses the
/// best of all directions, of which a handful are independent, and raises as many times more.
///
/// The standard deviation of the pixels decides with: one that is given too small makes the noise of
/// a turn a motion.
///
/// # Errors
///
/// [`ConsensusError`] of the richest model, when there is no evidence even for that, and when
/// [`ConsensusOptions::false_alarms`] is no probability.
pub fn select_model(
    matches: &Matches,
    options: &ConsensusOptions,
) -> Result<TwoViewModel, ConsensusError> {
    let value = options.false_alarms;
    if value >= 1.0 {
        return Err(ConsensusError::Probability { name: "false_alarms", value });
    }
    let (turned, on_plane) = (OnlyTurned(matches), OnePlane(matches));
    let rotation = consensus(&turned, options).ok();
    let plane = consensus(&on_plane, options).ok();
    let general = general_motion(matches, options);
    let against = |rotation: &Consensus<_>| {
        let of_plane = plane
            .as_ref()
            .is_some_and(|plane| contradicts((&on_plane, plane), (&turned, rotation), options));
        let general = general.as_ref().ok();
        of_plane
            || general.is_some_and(|general| {
                contradicts((&GeneralMotion(matches), general), (&turned, rotation), options)
            })
    };
    if let Some(rotation) = rotation.filter(|rotation| !against(rotation)) {
        return Ok(TwoViewModel::Rotation(rotation));
    }
    let against = |plane: &Consensus<_>| {
        general.as_ref().is_ok_and(|general| {
            contradicts((&GeneralMotion(matches), general), (&on_plane, plane), options)
        })
    };
    if let Some(plane) = plane.filter(|plane| !against(plane)) {
        let rays: Vec<Vector3<f64>> =
            plane.inliers.iter().map(|datum| matches.rays[*datum].0).collect();
        if let Ok(motions) = plane_motions(&plane.estimate, &rays) {
            return Ok(TwoViewModel::Plane { plane, motions: motions.to_vec() });
        }
    }
    general.map(TwoViewModel::General)
}
// ANCHOR_END: select_model

/// A consensus of a model with what it is about.
type Found<'a, C> = (&'a C, &'a Consensus<<C as Correspondences>::Estimate>);

// ANCHOR: contradicts
/// Whether the matches that a richer model explains contradict a simpler one.
fn contradicts<R: Correspondences, S: Correspondences>(
    (richer, rich): Found<R>,
    (simpler, simple): Found<S>,
    options: &ConsensusOptions,
) -> bool {
    let rich_error = richer.squared_errors(&rich.estimate, rich.gate);
    let simple_error = simpler.squared_errors(&simple.estimate, simple.gate);
    // ANCHOR: excess
    let both: Vec<usize> = simple
        .inliers
        .iter()
        .copied()
        .filter(|datum| rich_error(*datum, *datum) <= rich.gate)
        .collect();
    let excess: f64 =
        both.iter().map(|datum| simple_error(*datum, *datum) - rich_error(*datum, *datum)).sum();
    let freedom = both.len() * (S::DEGREES - R::DEGREES) + R::PARAMETERS;
    let is_excessive = freedom > S::PARAMETERS
        && chi_square_above(excess, freedom - S::PARAMETERS) < options.false_alarms;
    // ANCHOR_END: excess
    is_excessive || {
        // Farther off than the farthest of as many right ones.
        let count = simpler.count();
        let is_far = |datum: &usize| {
            let above = chi_square_above(simple_error(*datum, *datum), S::DEGREES);
            above < options.false_alarms / count as f64
        };
        let off: Vec<usize> = (0..count).filter(is_far).collect();
        let explained =
            off.iter().filter(|datum| rich_error(**datum, **datum) <= rich.gate).count();
        let chance = chance_of_agreement(count, rich.gate, &rich_error);
        false_alarms(off.len(), explained, FITTED, chance) <= options.false_alarms
    }
}
// ANCHOR_END: contradicts

/// How many matches a richer model can fit, beside those that a simpler one explains, whatever they
/// are: a baseline has two angles, and a homography that is no rotation five numbers, of which a
/// match fixes two.
const FITTED: usize = 3;

// ANCHOR: relative_motion_of_matches
/// The motion between two pictures, or why they do not say it.
///
/// # Errors
///
/// [`NoMotion`] names the model that explains the matches instead.
pub fn motion_of_matches(
    matches: &Matches,
    options: &ConsensusOptions,
) -> Result<Consensus<RelativeMotion>, NoMotion> {
    match select_model(matches, options)? {
        TwoViewModel::General(consensus) => Ok(consensus),
        TwoViewModel::Plane { motions, .. } => Err(NoMotion::Plane { motions }),
        TwoViewModel::Rotation(rotation) => {
            Err(NoMotion::Rotation { rotation: rotation.estimate, inliers: rotation.inliers.len() })
        }
    }
}
// ANCHOR_END: relative_motion_of_matches

/// Why two pictures do not say how the camera moved.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NoMotion {
    /// A rotation explains everything.
    #[error(
        "the camera only turned, or moved by less than the noise shows: a rotation explains all \
         {inliers} matches that agree; wait until it has moved"
    )]
    Rotation {
        /// The rotation, `second_from_first`.
        rotation: Rotation3<f64>,
        /// How many matches it explains.
        inliers: usize,
    },
    /// A plane explains everything.
    #[error(
        "all points lie in one plane; motions that explain it: {}; take points beside the plane, or a \
         third picture",
        motions.len()
    )]
    Plane {
        /// The motions.
        motions: Vec<PlaneMotion>,
    },
    /// There is no evidence for anything.
    #[error(transparent)]
    None(#[from] ConsensusError),
}
