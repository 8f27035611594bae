//! The sums themselves: that no state is in them, how they follow the biases, their derivatives and
//! their rules.

mod bias;
mod breaks;
pub mod cost;
mod derivatives;
mod figures;
mod independence;
mod numbers;
mod oracle;
mod reintegration;
mod rules;

use crate::chapter::Chapter;

pub fn exhibits(chapter: &mut Chapter) {
    independence::exhibits(chapter);
    bias::exhibits(chapter);
    reintegration::exhibits(chapter);
    derivatives::exhibits(chapter);
    rules::exhibits(chapter);
    numbers::numbers(chapter);
    breaks::numbers(chapter);
    cost::numbers(chapter);
    figures::figures(chapter);
}
