//! The statistics of drawn depths.

use exhibits::bearing::noise::{Moments, quantile};

#[test]
fn moments_are_those_of_the_textbook() {
    let moments = Moments::of([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter());
    assert_eq!(moments.mean, 5.0);
    assert_eq!(moments.deviation(), 2.0);
}

#[test]
fn quantiles_count_infinity_as_the_largest_value() {
    let mut values = [3.0, f64::INFINITY, 1.0, 2.0, f64::INFINITY];
    assert_eq!(quantile(&mut values, 0.0), 1.0);
    assert_eq!(quantile(&mut values, 0.5), 3.0);
    assert_eq!(quantile(&mut values, 1.0), f64::INFINITY);
}
