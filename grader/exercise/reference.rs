//! {title}.

/// TODO: what comes out and what goes in, with frames and units. For now, twice the number.
pub fn doubled(number: f64) -> f64 {
    2.0 * number
}
