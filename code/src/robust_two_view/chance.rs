//! How much agreement there is between data that have nothing to do with each other.

use statrs::function::factorial::ln_binomial;

/// So many wrong pairs are tried, or all that there are.
const PAIRS: usize = 20_000;

// ANCHOR: chance_of_agreement
/// The probability that a wrong datum has a squared error within the gate: the share of those pairs
/// of the here of one and the there of another that do, where one more of each is counted, so that
/// it is never zero.
pub(super) fn chance_of_agreement(
    count: usize,
    gate: f64,
    squared_error: &impl Fn(usize, usize) -> f64,
) -> f64 {
    let shifts = PAIRS.div_ceil(count).min(count - 1);
    let pairs = (1..=shifts).flat_map(|k| {
        // Shifts spread over all of the data, since neighbours may have something in common.
        let shift = k * count / (shifts + 1);
        (0..count).map(move |here| (here, (here + shift) % count))
    });
    let agree = pairs.filter(|(here, there)| squared_error(*here, *there) <= gate).count();
    (agree + 1) as f64 / (shifts * count + 1) as f64
}
// ANCHOR_END: chance_of_agreement

// ANCHOR: false_alarms
/// How many estimates, one through each sample of `sample` out of `count` wrong data, would find
/// `agree` data or more within their gates, each of them with probability `chance`: a bound of the
/// mean [@moisan2004]. A solver that gives several estimates of a sample multiplies it. Where it is far below one, the agreement is no accident.
///
/// Implements {eq:false-alarms}. Infinite when nothing beyond the sample agrees, or more than there are.
// ANCHOR: counted
pub fn false_alarms(count: usize, agree: usize, sample: usize, chance: f64) -> f64 {
    if agree <= sample || agree > count {
        return f64::INFINITY;
    }
    let (n, k, m) = (count as u64, agree as u64, sample as u64);
    let ways = ((n - m) as f64).ln() + ln_binomial(n, k) + ln_binomial(k, m);
    (ways + (k - m) as f64 * chance.ln()).exp()
}
// ANCHOR_END: counted
// ANCHOR_END: false_alarms
