//! Reference answers to the exercises, one module each as a student would write it, and
//! [`misconceptions`], the plausible wrong ones.

pub mod align_gravity;
pub mod along_or_across;
pub mod fill_in;
pub mod first_estimates;
pub mod left_perturbation;
pub mod misconceptions;
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
use misconceptions::Wrong;

/// The reference answer to an exercise and its wrong ones.
pub struct Answers {
    /// The exercise.
    pub slug: &'static str,
    /// The right answer.
    pub reference: Box<dyn Transport>,
    /// Answers that earn nothing where they are wrong.
    pub wrong: Vec<Wrong>,
    /// Answers of NaN, of infinities and of nothing.
    pub spoiled: Vec<Box<dyn Transport>>,
}

/// The answers to every exercise.
pub fn answers() -> Vec<Answers> {
    macro_rules! answers {
        ($($slug:ident),+ $(,)?) => {
            vec![$(Answers {
                slug: stringify!($slug),
                reference: Box::new(Native(misconceptions::$slug::REFERENCE)),
                wrong: misconceptions::$slug::wrong(),
                spoiled: exercise_spec::$slug::Functions::spoiled()
                    .map(|functions| Box::new(Native(functions)) as Box<dyn Transport>)
                    .into(),
            }),+]
        };
    }
    answers![
        left_perturbation,
        along_or_across,
        robust_motion,
        scale_null_space,
        outlier_rescue,
        stereo_gauge,
        residual_jacobian,
        noise_growth,
        scale_and_gravity,
        align_gravity,
        nees_diagnosis,
        null_space,
        fill_in,
        square_root_prior,
        first_estimates,
    ]
}
