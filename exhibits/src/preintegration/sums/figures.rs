//! The figures.

mod any_start;
mod correction;
mod cost;
mod guess;
mod order;

use crate::chapter::Chapter;

pub use correction::left_by;
pub use guess::{TRUE_BIAS, at_guess, unaware};

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("any_start", any_start::any_start);
    chapter.figure("cost", cost::cost);
    chapter.figure("correction", correction::correction);
    chapter.figure("guess", guess::guess);
    chapter.figure("order", order::order);
}
