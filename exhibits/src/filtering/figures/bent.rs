//! What a distance says of a spot, and what one linearization makes of it.

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_right_of, plain};
use crate::filtering::figures::ellipse;
use crate::filtering::numbers::bent as beliefs;
use crate::filtering::spot::cost;
use nalgebra::Vector2;

/// One standard deviation around the least cost.
const LEVEL: f64 = 0.5;

pub fn bent() -> Figure {
    let [once, often] = beliefs();
    let both = [&once, &often];
    let least = cost(&often.estimate);
    let columns = vec![
        ("update", plain(["one linearization", "iterated"])),
        ("x (m)", decimals(3, both.map(|b| b.estimate.x))),
        ("y (m)", decimals(3, both.map(|b| b.estimate.y))),
        ("cost", decimals(2, both.map(|b| cost(&b.estimate)))),
        ("sigma along x (m)", decimals(3, both.map(|b| b.covariance.m11.sqrt()))),
        ("sigma along y (m)", decimals(3, both.map(|b| b.covariance.m22.sqrt()))),
    ];
    Figure::new(1080, columns, |drawing| {
        let mut chart = figure::axes(drawing, ("x (m)", 0.0..1.8, 6), ("y (m)", 0.9..2.2, 6))?;
        for side in crescent(least) {
            chart.line(side, INK, 4)?;
        }
        chart.write("posterior", (0.05, 1.25), letters_right_of(INK))?;
        let names = ["one linearization", "iterated"];
        for (index, belief) in both.into_iter().enumerate() {
            let colour = SERIES[index + 1];
            chart.line(ellipse(&belief.estimate, &belief.covariance), colour, 5)?;
            chart.marks([(belief.estimate.x, belief.estimate.y)], index + 1)?;
            chart.key(index + 1, names[index], (0.95, 2.12 - 0.1 * index as f64), 1.0)?;
        }
        Ok(())
    })
}

/// Both sides of the region whose cost is at most one half above the least, along rays from the post.
fn crescent(least: f64) -> Vec<Vec<(f64, f64)>> {
    let (mut inner, mut outer) = (Vec::new(), Vec::new());
    for step in 0..=600 {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(step) / 600.0;
        let (sine, cosine) = angle.sin_cos();
        let radii = (0..400).map(|k| 1.2 + 2.0e-3 * f64::from(k));
        let at = |radius: f64| Vector2::new(radius * cosine, radius * sine);
        let inside: Vec<f64> = radii.filter(|r| cost(&at(*r)) <= least + LEVEL).collect();
        if let (Some(first), Some(last)) = (inside.first(), inside.last()) {
            inner.push((at(*first).x, at(*first).y));
            outer.push((at(*last).x, at(*last).y));
        }
    }
    outer.extend(inner.iter().rev());
    outer.extend(outer.first().copied());
    vec![outer]
}
