//! The hidden checks: those of the specification, on instances that nobody has seen.
//!
//! A module for each exercise draws the instances from a seed. They differ from the public ones
//! in their numbers, their geometries and how near they come to what is allowed, and in nothing
//! that a student could not know.

pub mod align_gravity;
pub mod along_or_across;
pub mod fill_in;
pub mod first_estimates;
pub mod left_perturbation;
pub mod nees_diagnosis;
pub mod noise_growth;
pub mod null_space;
pub mod outlier_rescue;
pub mod residual_jacobian;
pub mod robust_motion;
pub mod scale_and_gravity;
pub mod scale_null_space;
pub mod square_root_prior;
pub mod stereo_gauge;

use exercise_spec::check::Check;

/// The hidden checks of an exercise, on instances drawn from a seed. Nothing where there is no
/// such exercise.
pub fn hidden_checks(slug: &str, seed: u128) -> Option<Vec<Check>> {
    let seed = mixed(slug, seed);
    match slug {
        "left_perturbation" => Some(left_perturbation::checks(seed)),
        "along_or_across" => Some(along_or_across::checks(seed)),
        "robust_motion" => Some(robust_motion::checks(seed)),
        "scale_null_space" => Some(scale_null_space::checks(seed)),
        "outlier_rescue" => Some(outlier_rescue::checks(seed)),
        "stereo_gauge" => Some(stereo_gauge::checks(seed)),
        "residual_jacobian" => Some(residual_jacobian::checks(seed)),
        "noise_growth" => Some(noise_growth::checks(seed)),
        "scale_and_gravity" => Some(scale_and_gravity::checks(seed)),
        "align_gravity" => Some(align_gravity::checks(seed)),
        "nees_diagnosis" => Some(nees_diagnosis::checks(seed)),
        "null_space" => Some(null_space::checks(seed)),
        "fill_in" => Some(fill_in::checks(seed)),
        "square_root_prior" => Some(square_root_prior::checks(seed)),
        "first_estimates" => Some(first_estimates::checks(seed)),
        _ => None,
    }
}

/// A seed of an exercise: the whole secret, and which exercise it is for. Public instances have seeds
/// of another form.
fn mixed(slug: &str, seed: u128) -> [u8; 32] {
    // FNV-1a. It keeps exercises apart; what nobody knows is the seed.
    let hash = slug.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let mut mixed = [0; 32];
    mixed[..16].copy_from_slice(&seed.to_le_bytes());
    mixed[16..24].copy_from_slice(&hash.to_le_bytes());
    mixed
}
