//! The same noisy measurements as depth and as inverse depth.

use plotters::element::{Rectangle, Text};
use plotters::style::Color;
use vislam::bearing::inverse_depth_sigma;

use crate::bearing::noise::Pair;
use crate::figure::{self, Draw, Drawing, Drawn, ESTIMATED, Figure, INK, decimals, letters_around};

const DEPTH: f64 = 40.0;
const DRAWS: usize = 100_000;
const SEED: u64 = 31;
const BINS: usize = 30;

/// How often a quantity was drawn, in percent of all draws, and what first order says of it.
struct Histogram {
    first_edge: f64,
    width: f64,
    percent: [f64; BINS],
    mean: f64,
    sigma: f64,
}

impl Histogram {
    fn of(draws: impl Iterator<Item = f64>, edges: (f64, f64), mean: f64, sigma: f64) -> Self {
        let width = (edges.1 - edges.0) / BINS as f64;
        let mut percent = [0.0; BINS];
        for draw in draws.take(DRAWS) {
            let bin = (draw - edges.0) / width;
            if (0.0..BINS as f64).contains(&bin) {
                percent[bin as usize] += 100.0 / DRAWS as f64;
            }
        }
        Self { first_edge: edges.0, width, percent, mean, sigma }
    }

    fn centre(&self, bin: usize) -> f64 {
        self.first_edge + (bin as f64 + 0.5) * self.width
    }

    /// The normal distribution of first order, in percent for a bin around `value`.
    fn first_order(&self, value: f64) -> f64 {
        let standardized = (value - self.mean) / self.sigma;
        let density =
            (-0.5 * standardized.powi(2)).exp() / (std::f64::consts::TAU.sqrt() * self.sigma);
        100.0 * self.width * density
    }
}

pub fn inverse_depth() -> Figure {
    let pair = Pair::at_depth(DEPTH);
    let depth = Histogram::of(pair.depths(SEED), (0.0, 120.0), DEPTH, pair.depth_sigma());
    let sigma = inverse_depth_sigma(&pair.camera, pair.baseline, pair.disparity_sigma());
    let draws = pair.inverse_depths(SEED);
    let inverse = Histogram::of(draws, (-0.005, 0.055), 1.0 / DEPTH, sigma);
    let columns_of = |name, histogram: &Histogram, digits| {
        let centres = (0..BINS).map(|bin| histogram.centre(bin));
        let first_order = centres.clone().map(|centre| histogram.first_order(centre));
        [
            (name, decimals(digits, centres)),
            ("draws (%)", decimals(2, histogram.percent)),
            ("first order (%)", decimals(2, first_order)),
        ]
    };
    let columns =
        [columns_of("depth (m)", &depth, 0), columns_of("inverse depth (1/m)", &inverse, 3)];
    Figure::new(640, columns.concat(), |drawing| {
        let (left, right) = drawing.split_horizontally(680);
        panel(&left, &depth, "depth (m)", ("share of draws (%)", 4))?;
        panel(&right, &inverse, "inverse depth (1/m)", ("", 0))?;
        drawing.draw(&Text::new("draws", (520, 110), letters_around(ESTIMATED)))?;
        drawing.draw(&Text::new("first order", (520, 165), letters_around(INK)))?;
        Ok(())
    })
}

fn panel(
    drawing: &Drawing,
    histogram: &Histogram,
    title: &str,
    (share_title, share_ticks): (&str, usize),
) -> Drawn {
    let (start, end) = (histogram.first_edge, histogram.first_edge + BINS as f64 * histogram.width);
    let shares = (share_title, 0.0..20.0, share_ticks);
    let mut chart = figure::axes(drawing, (title, start..end, 4), shares)?;
    chart.draw_series((0..BINS).map(|bin| {
        let left = histogram.centre(bin) - 0.5 * histogram.width;
        let corners = [(left, 0.0), (left + histogram.width, histogram.percent[bin])];
        Rectangle::new(corners, ESTIMATED.mix(0.6).filled())
    }))?;
    let values = (0..=120).map(|step| start + (end - start) * f64::from(step) / 120.0);
    chart.line(values.map(|value| (value, histogram.first_order(value))), INK, 5)
}
