//! The graph of `code/examples/two_keyframes.rs` in factrs 0.3.0: once as a page of its own parts, and once of the
//! very factors that the book's library has, so that the two can be held against each other.

pub mod convert;
pub mod graph;
pub mod identical;
pub mod predicted;
pub mod reprojection;
pub mod said;

#[allow(dead_code)]
#[path = "../../code/examples/two_keyframes.rs"]
pub mod two_keyframes;
