//! The figures of the chapter.

mod allan;
mod averages;
mod boxes;
mod drift;
mod eight;
mod offset;
mod orders;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("boxes", boxes::boxes);
    chapter.figure("eight", eight::eight);
    chapter.figure("allan", allan::allan);
    chapter.figure("averages", averages::averages);
    chapter.figure("orders", orders::orders);
    chapter.figure("drift", drift::drift);
    chapter.figure("offset", offset::offset);
}
