//! The street, and the errors of many rings.

use exhibits::bundle_adjustment::consistency::{RUNS, errors, summary};
use exhibits::bundle_adjustment::progress::{
    blocks_as_numbered, closed, long_street, shared_points, short_street, shuffled, unsolved,
};

#[test]
fn blocks_are_counted_as_the_library_does_and_a_shuffled_street_is_put_in_order() {
    let street = long_street();
    let stored = unsolved(&street).stored_blocks;
    assert_eq!(blocks_as_numbered(&street), stored);
    let shuffled = shuffled(&street);
    assert_eq!(unsolved(&shuffled).block_products, unsolved(&street).block_products);
    assert!(blocks_as_numbered(&shuffled) > 10 * stored);
    assert!(unsolved(&shuffled).stored_blocks < 2 * stored);
}

#[test]
fn the_closed_street_has_one_observation_more_and_loses_none() {
    let street = long_street();
    let closed = unsolved(&closed(street.clone()));
    assert_eq!(closed.dropped, unsolved(&street).dropped);
}

#[test]
fn cameras_of_the_street_share_points_with_near_ones_only() {
    for (first, second) in shared_points(&short_street()).into_keys() {
        assert!((1..=4).contains(&(first - second)));
    }
}

#[test]
fn errors_of_500_rings_lie_in_their_bands() {
    let (mean, [low, high], inside) = summary(&errors(RUNS, 1.0));
    assert!((low..high).contains(&mean), "{mean}");
    assert!((93.0..=97.0).contains(&inside), "{inside}");
}

#[test]
fn noise_that_is_understated_is_noticed() {
    let (mean, [_, high], _) = summary(&errors(20, 1.3));
    assert!(mean > high);
}
