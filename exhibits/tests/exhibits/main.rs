//! The book's exhibits: all equations, counterexamples and figures, and what they are made with.

mod bearing;
mod book;
mod bundle_adjustment;
mod chapter;
mod comparison;
mod data;
mod diagram;
mod least_squares;
mod program;
mod random;
mod real_flights;
mod record;
mod reprojection;
mod scene;
