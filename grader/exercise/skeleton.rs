//! {title}. Edition {edition}.
//!
//! `cargo test -p exercises {name}`

/// TODO: what comes out and what goes in, with frames and units. For now, twice the number.
pub fn doubled(number: f64) -> f64 {
    let _ = number;
    todo!("TODO: what to build, and not how")
}
