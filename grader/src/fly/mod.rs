//! A whole estimator, in whatever language, judged by whether it knows how wrong it is.
//!
//! [`export()`](export::export) writes flights for everybody on a roster, drawn from a key that stays with the
//! instructor. Students hand in where the body was and how sure that is; none of their code is run. [`judge`]
//! flies the flights again and holds the answers against the truth, and [`symptoms`] names the faults that the
//! statistics suggest.

use exercise_spec::Exercise;

pub mod answer;
pub mod canary;
pub mod export;
pub mod flights;
pub mod handed;
pub mod judge;
pub mod key;
pub mod measured;
pub mod reference;
pub mod run;
pub mod series;
pub mod symptoms;

/// The graded flight among the exercises.
pub static GRADED_FLIGHT: Exercise = Exercise {
    slug: "graded_flight",
    title: "A graded flight",
    chapter: "odometry",
    functions: &[],
    misconceptions: &[],
    types: &[],
    forbidden: &[],
    hints: "",
    checks: Vec::new,
};
