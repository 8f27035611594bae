//! The library of the book as answers know it, by the name `vislam`.
//!
//! What would be the answer to an exercise is not here, so that whoever calls it is told so by the
//! compiler. The grader links answers with this, and so do the tests that students have.

/// Directions of pixels.
pub mod bearing {
    pub use vislam::bearing::*;
}

/// Quantiles.
pub mod filtering {
    pub use vislam::filtering::chi_square_quantile;
}

/// The constant of gravity.
pub mod inertial {
    pub use vislam::inertial::GRAVITY;
}

/// Rotations and rigid motions.
pub mod manifold {
    pub use vislam::manifold::{se2, se3, so3};
}

/// Types of residuals and of their derivatives.
pub mod preintegration {
    pub use vislam::preintegration::{Matrix9, Vector9};
}

/// What cameras give; a camera is made by `pinhole` of the plain data that an exercise declares.
pub mod reprojection {
    pub use vislam::reprojection::{Projection, Z_MIN};
}
