//! What asks answers. Answers that are graded are compiled without it.

pub mod answer;
pub mod check;
pub mod draw;
mod exercise;
pub mod picture;
mod question;

pub use exercise::Exercise;
pub(crate) use exercise::FACTORIZATIONS;
pub use question::Question;
