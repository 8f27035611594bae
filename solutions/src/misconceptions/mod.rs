//! Plausible wrong answers: each changes the reference answer in one way.

pub mod align_gravity;
pub mod along_or_across;
pub mod fill_in;
pub mod first_estimates;
pub mod left_perturbation;
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

use exercise_spec::answer::{Native, Transport};
use exercise_spec::check::Misconception;
use exercise_spec::declaration::Dispatch;

/// A wrong answer and what it should be recognized as.
pub struct Wrong {
    /// What is wrong with it.
    pub misconception: &'static Misconception,
    /// The answer.
    pub answer: Box<dyn Transport>,
}

impl Wrong {
    /// A wrong answer of its functions.
    fn new(misconception: &'static Misconception, functions: impl Dispatch + 'static) -> Self {
        Self { misconception, answer: Box::new(Native(functions)) }
    }
}
