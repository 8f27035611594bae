//! The figures of the chapter.

mod consistency;
mod convergence;
mod gauge;
mod growth;
mod outliers;
mod sparsity;
mod stereo;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("sparsity", sparsity::sparsity);
    chapter.figure("convergence", convergence::convergence);
    chapter.figure("gauge", gauge::gauge);
    chapter.figure("stereo", stereo::stereo);
    chapter.figure("consistency", consistency::consistency);
    chapter.figure("outliers", outliers::outliers);
    chapter.figure("growth", growth::growth);
}
