//! {title}. TODO: what it is about, in a line.

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

crate::signatures! {
    // ANCHOR: signatures
    /// TODO: what comes out and what goes in, with frames and units. For now, twice the number.
    fn doubled(number: f64) -> f64;
    // ANCHOR_END: signatures
}
