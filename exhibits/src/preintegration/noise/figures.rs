//! The figures of noise and covariance.

mod correlated;
mod correlation;
mod eigenvalues;
mod ellipse;
mod growth;
mod hinge;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("covariance_eigenvalues", eigenvalues::eigenvalues);
    chapter.figure("growth_hinge", hinge::hinge);
    chapter.figure("covariance_growth", growth::growth);
    chapter.figure("covariance_correlation", correlation::correlation);
    chapter.figure("covariance_ellipse", ellipse::ellipse);
    chapter.figure("noise_correlated", correlated::correlated);
}
