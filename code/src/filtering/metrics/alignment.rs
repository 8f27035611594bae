//! The world of an estimate laid upon the world of the truth.

use nalgebra::{Matrix3, Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3};
use thiserror::Error;

use crate::inertial::NavState;
use crate::manifold::so3;
use crate::observability::Similarity;

// ANCHOR: freedom
/// What an alignment may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freedom {
    /// Yaw and translation, which camera and inertial sensor together cannot see. Tilt stays as it
    /// was estimated, for gravity shows it.
    Four,
    /// All of rotation and translation. For comparison: this turns an estimate upright that is not,
    /// and hides what the tilt did wrong.
    Six,
}
// ANCHOR_END: freedom

/// How little a rotation may decide, as a part of the mean square of the positions: a horizontal
/// extent of a millimetre, a kilometre from the origin.
const UNDECIDED: f64 = 1e-12;

// ANCHOR: align
/// The motion, of scale one, that takes the estimate's world to the truth's with the least sum of
/// squares of what is left between the positions of every two states, in closed form [@zhang2018].
///
/// The translation takes mean to mean, whatever the rotation is, and the rotation R makes the sum of
/// bᵀ R a largest, over the estimated positions a and the true ones b, less their means. For a turn
/// about the vertical that is {eq:aligned-yaw}.
///
/// # Errors
///
/// [`AlignmentError`] tells what is missing.
pub fn align(
    estimate: &[NavState],
    truth: &[NavState],
    freedom: Freedom,
) -> Result<Similarity, AlignmentError> {
    check(estimate, truth)?;
    let [a, b] = [estimate, truth].map(centre);
    let pairs = estimate.iter().zip(truth);
    let moment = pairs.map(|(e, t)| (t.position - b) * (e.position - a).transpose()).sum();
    let undecided = UNDECIDED * (square(estimate) * square(truth)).sqrt();
    let rotation = match freedom {
        Freedom::Four => yaw_towards(&moment, undecided).ok_or(AlignmentError::Yaw)?,
        Freedom::Six => rotation_towards(&moment, undecided).ok_or(AlignmentError::Rotation)?,
    };
    Ok(Similarity { scale: 1.0, rotation, translation: b - rotation * a })
}
// ANCHOR_END: align

/// The estimate in the world of the truth, by [`align`].
///
/// # Errors
///
/// Those of [`align`].
pub fn aligned(
    estimate: &[NavState],
    truth: &[NavState],
    freedom: Freedom,
) -> Result<Vec<NavState>, AlignmentError> {
    let alignment = align(estimate, truth, freedom)?;
    Ok(estimate.iter().map(|state| moved(&alignment, state)).collect())
}

/// A state after an alignment, which does not change its scale.
pub(super) fn moved(alignment: &Similarity, state: &NavState) -> NavState {
    alignment.state(state, &Vector3::zeros(), &Vector3::zeros())
}

// ANCHOR: align_one
/// The motion that takes one estimated state to the true one: all of it, or as far as a turn about
/// the vertical can, the one that leaves the least angle. `None` when one of them stands on its head.
pub(super) fn align_one(
    estimate: &NavState,
    truth: &NavState,
    freedom: Freedom,
) -> Option<Similarity> {
    let whole = truth.world_from_body * estimate.world_from_body.inverse();
    let rotation = match freedom {
        Freedom::Four => yaw_towards(whole.matrix(), UNDECIDED)?,
        Freedom::Six => whole,
    };
    let translation = truth.position - rotation * estimate.position;
    Some(Similarity { scale: 1.0, rotation, translation })
}
// ANCHOR_END: align_one

// ANCHOR: yaw_towards
/// The turn R about the vertical for which the trace of Rᵀ M is largest, or `None` when none does
/// better than another by more than `undecided`.
///
/// By the angle θ the trace is c cos θ + s sin θ and a rest without θ.
pub(crate) fn yaw_towards(moment: &Matrix3<f64>, undecided: f64) -> Option<Rotation3<f64>> {
    let (sine, cosine) = (moment.m21 - moment.m12, moment.m11 + moment.m22);
    let yaw = sine.atan2(cosine);
    (sine.hypot(cosine) > undecided).then(|| so3::exp(&Vector3::new(0.0, 0.0, yaw)))
}
// ANCHOR_END: yaw_towards

// ANCHOR: rotation_towards
/// The rotation R for which the trace of Rᵀ M is largest, or `None` when another one does as well.
///
/// By the unit quaternion q of R the trace is qᵀ N q, with a symmetric matrix N: the best q is its
/// eigenvector of the largest eigenvalue. Being a quaternion, it is never a reflection.
pub(crate) fn rotation_towards(moment: &Matrix3<f64>, undecided: f64) -> Option<Rotation3<f64>> {
    let skew = 2.0 * so3::vee(moment);
    let block = moment + moment.transpose() - Matrix3::from_diagonal_element(moment.trace());
    let mut form = Matrix4::from_element(moment.trace());
    form.fixed_view_mut::<3, 1>(1, 0).copy_from(&skew);
    form.fixed_view_mut::<1, 3>(0, 1).copy_from(&skew.transpose());
    form.fixed_view_mut::<3, 3>(1, 1).copy_from(&block);
    let eigen = form.symmetric_eigen();
    let best = eigen.eigenvalues.imax();
    let next = (0..4).filter(|at| *at != best).map(|at| eigen.eigenvalues[at]);
    let gap = eigen.eigenvalues[best] - next.fold(f64::NEG_INFINITY, f64::max);
    let q = eigen.eigenvectors.column(best);
    let rotation = UnitQuaternion::new_normalize(Quaternion::new(q[0], q[1], q[2], q[3]));
    (gap > undecided).then(|| rotation.to_rotation_matrix())
}
// ANCHOR_END: rotation_towards

/// The mean position, in metres.
fn centre(states: &[NavState]) -> Vector3<f64> {
    states.iter().map(|state| state.position).sum::<Vector3<f64>>() / states.len() as f64
}

/// The sum of squares of the positions.
fn square(states: &[NavState]) -> f64 {
    states.iter().map(|state| state.position.norm_squared()).sum()
}

/// That the states belong together and are numbers.
pub(super) fn check(estimate: &[NavState], truth: &[NavState]) -> Result<(), AlignmentError> {
    if estimate.len() != truth.len() {
        let (estimate, truth) = (estimate.len(), truth.len());
        return Err(AlignmentError::Lengths { estimate, truth });
    }
    if truth.len() < 2 {
        return Err(AlignmentError::TooFew { states: truth.len() });
    }
    let is_finite = |state: &NavState| {
        let vectors = state.position.iter().chain(state.velocity.iter());
        vectors.chain(state.world_from_body.matrix().iter()).all(|entry| entry.is_finite())
    };
    let both = |(estimate, truth)| is_finite(estimate) && is_finite(truth);
    match estimate.iter().zip(truth).position(|states| !both(states)) {
        Some(state) => Err(AlignmentError::NotFinite { state }),
        None => Ok(()),
    }
}

/// Why two trajectories cannot be aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum AlignmentError {
    /// There is no other state for every state.
    #[error(
        "there are {estimate} estimated and {truth} true states; give the two at the same times"
    )]
    Lengths {
        /// How many are estimated.
        estimate: usize,
        /// How many are true.
        truth: usize,
    },
    /// A trajectory has at least two.
    #[error("{states} states are no trajectory; give at least two")]
    TooFew {
        /// How many there are.
        states: usize,
    },
    /// A number is NaN or infinite.
    #[error(
        "state {state} has a number that is not finite, estimated or true; an estimator that has \
         diverged has no error to be averaged"
    )]
    NotFinite {
        /// The first of them, counted from zero.
        state: usize,
    },
    /// The positions do not say how the estimate's world is turned about the vertical.
    #[error(
        "the positions leave the yaw open: one of the trajectories has no horizontal extent, or \
         they do not resemble each other; align by the first state instead"
    )]
    Yaw,
    /// The positions do not say how the estimate's world is turned.
    #[error(
        "the positions leave the rotation open: one of the trajectories lies on a line, or they do \
         not resemble each other; align in four degrees of freedom instead"
    )]
    Rotation,
}
