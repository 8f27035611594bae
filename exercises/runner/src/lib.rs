//! What runs the exercises: the tests of an answer, their record, and the commands of
//! `cargo run -p exercises`.
//!
//! Each answer is a test target of its own, so that one that does not compile blocks no other.

pub mod edition;
pub mod folder;
pub mod hints;
pub mod judge;
pub mod names;
pub mod picture;
pub mod progress;
pub mod say;
pub mod selection;
pub mod tokens;
pub mod watch;

pub use judge::judge;
