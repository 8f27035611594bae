//! Depth error against range: the first-order formula, and where draws leave it.

use plotters::coord::combinators::IntoLogRange;

use crate::bearing::noise::{Pair, quantile};
use crate::figure::{self, Draw, Figure, SERIES, decimals, letters_right_of};

/// Metres between the cameras.
const BASELINES: [f64; 4] = [0.1, 0.25, 0.5, 1.0];
/// Metres from the first camera.
const RANGES: [f64; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
const DRAWS: usize = 20_000;
const SEED: u64 = 32;

pub fn depth_error() -> Figure {
    let at = |baseline| RANGES.map(|range| Pair { baseline, ..Pair::at_depth(range) });
    let pairs = BASELINES.map(at).concat();
    let spreads: Vec<_> = pairs.iter().map(half_spread).collect();
    let spread = |spread: &Option<f64>| spread.map_or("unbounded".into(), |s| format!("{s:.3}"));
    let columns = vec![
        ("baseline (m)", pairs.iter().map(|pair| pair.baseline.to_string()).collect()),
        ("depth (m)", pairs.iter().map(|pair| pair.point.z.to_string()).collect()),
        ("first-order sigma (m)", decimals(3, pairs.iter().map(Pair::depth_sigma))),
        ("half the width of the middle 68.3 % of draws (m)", spreads.iter().map(spread).collect()),
    ];
    Figure::new(860, columns, |drawing| {
        let x_axis = ("depth (m)", (0.9..110.0).log_scale(), 3);
        let y_axis = ("depth error (m)", (0.002..200.0).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        let drawn = pairs.chunks(RANGES.len()).zip(spreads.chunks(RANGES.len()));
        for (index, (pairs, spreads)) in drawn.enumerate() {
            let sigmas = pairs.iter().map(|pair| (pair.point.z, pair.depth_sigma()));
            chart.line(sigmas, SERIES[index], 4)?;
            let places = RANGES.into_iter().zip(spreads);
            chart.marks(places.filter_map(|(range, spread)| Some((range, (*spread)?))), index)?;
            let last = &pairs[RANGES.len() - 1];
            let beside = (1.12 * last.point.z, last.depth_sigma());
            let name = format!("{} m", last.baseline);
            chart.write(&name, beside, letters_right_of(SERIES[index]))?;
        }
        Ok(())
    })
}

/// Half the width of the interval that holds the middle 68.3 % of all draws; one sigma, were they
/// normal. `None` when the interval reaches to infinity.
fn half_spread(pair: &Pair) -> Option<f64> {
    let mut depths: Vec<f64> = pair.depths(SEED).take(DRAWS).collect();
    let spread = (quantile(&mut depths, 0.8415) - quantile(&mut depths, 0.1585)) / 2.0;
    spread.is_finite().then_some(spread)
}
