//! Curves over time, and axes that hold them.

/// Every so many places one, and the last one.
pub fn thinned(
    every: usize,
    places: impl ExactSizeIterator<Item = [f64; 2]>,
) -> impl Iterator<Item = [f64; 2]> {
    let last = places.len().saturating_sub(1);
    let numbered = places.enumerate();
    numbered.filter(move |(at, _)| at % every == 0 || *at == last).map(|(_, place)| place)
}

/// The next of 1, 2, 5, 10 and so on, so that an axis does not change all the time.
pub fn rounded(reach: f64) -> f64 {
    if !(reach > 0.0 && reach.is_finite()) {
        return 1.0;
    }
    let ten = 10_f64.powf(reach.log10().floor());
    let part = [1.0, 2.0, 5.0].into_iter().find(|part| part * ten >= reach);
    part.unwrap_or(10.0) * ten
}
