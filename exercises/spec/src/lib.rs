//! What the exercises of the book ask, said once.
//!
//! A module for each exercise declares its functions and data ([`signatures!`]). Below it are its
//! public checks with the instances they run on, the wrong answers it can name, and its hints. The
//! skeletons, the reference answers, the hidden checks and the grader all build on it. It holds
//! no answer: what checks compare with are oracles that find the same numbers another way, by
//! differences or by brute force. The grader compiles answers without the feature `checks`, so
//! that no answer can ask an oracle.

pub mod align_gravity;
pub mod along_or_across;
pub mod camera;
pub mod declaration;
pub mod fill_in;
pub mod first_estimates;
pub mod left_perturbation;
pub mod navigation;
pub mod nees_diagnosis;
pub mod noise_growth;
pub mod null_space;
pub mod outlier_rescue;
pub mod residual_jacobian;
pub mod robust_motion;
pub mod scale_and_gravity;
pub mod scale_null_space;
pub mod square_root_prior;
pub mod stereo_gauge;

#[cfg(feature = "checks")]
mod checking;
#[cfg(feature = "checks")]
pub use checking::{Exercise, answer, check, draw, picture};

/// Every exercise, in the order of the book.
#[cfg(feature = "checks")]
pub const EXERCISES: &[&Exercise] = &[
    &left_perturbation::EXERCISE,
    &along_or_across::EXERCISE,
    &robust_motion::EXERCISE,
    &scale_null_space::EXERCISE,
    &outlier_rescue::EXERCISE,
    &stereo_gauge::EXERCISE,
    &residual_jacobian::EXERCISE,
    &noise_growth::EXERCISE,
    &scale_and_gravity::EXERCISE,
    &align_gravity::EXERCISE,
    &nees_diagnosis::EXERCISE,
    &null_space::EXERCISE,
    &fill_in::EXERCISE,
    &square_root_prior::EXERCISE,
    &first_estimates::EXERCISE,
];

/// The exercise of a name.
#[cfg(feature = "checks")]
pub fn exercise(slug: &str) -> Option<&'static Exercise> {
    EXERCISES.iter().find(|exercise| exercise.slug == slug).copied()
}
