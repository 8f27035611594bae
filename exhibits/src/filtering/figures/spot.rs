//! A belief before and after a measured distance.

use std::f64::consts::FRAC_PI_2;

use crate::figure::{
    self, Draw, ESTIMATED, Figure, INK, MEASURED, SERIES, decimals, letters_right_of, plain,
};
use crate::filtering::figures::ellipse;
use crate::filtering::spot::{DISTANCE, ESTIMATE, SIGMA, after, prior_covariance};

pub fn spot() -> Figure {
    let believed = after(1);
    let (before, now) = (prior_covariance(), believed.covariance);
    let both = [&before, &now];
    let columns = vec![
        ("belief", plain(["before", "after"])),
        ("x (m)", decimals(3, [ESTIMATE.x, believed.estimate.x])),
        ("y (m)", decimals(3, [ESTIMATE.y, believed.estimate.y])),
        ("variance of x (m²)", decimals(4, both.map(|c| c.m11))),
        ("covariance (m²)", decimals(4, both.map(|c| c.m12))),
        ("variance of y (m²)", decimals(4, both.map(|c| c.m22))),
    ];
    Figure::new(1080, columns, |drawing| {
        let mut chart = figure::axes(drawing, ("x (m)", -0.3..2.1, 5), ("y (m)", -0.6..2.2, 6))?;
        for off in [-SIGMA, SIGMA] {
            let arc = (0..=60).map(|k| {
                let (sine, cosine) = (FRAC_PI_2 * f64::from(k) / 60.0).sin_cos();
                ((DISTANCE + off) * cosine, (DISTANCE + off) * sine)
            });
            chart.line(arc, MEASURED, 4)?;
        }
        chart.dots([(0.0, 0.0)], 12, INK)?;
        chart.write("post", (0.06, -0.12), letters_right_of(INK))?;
        chart.write("measured distance", (1.2, 1.22), letters_right_of(MEASURED))?;
        // Short strokes, because the prior's colour is not all that tells it.
        let prior = ellipse(&ESTIMATE, &before);
        for dash in prior.chunks(4).map(|dash| dash[..dash.len().min(3)].to_vec()) {
            chart.line(dash, SERIES[0], 4)?;
        }
        chart.dots([(ESTIMATE.x, ESTIMATE.y)], 9, SERIES[0])?;
        chart.write("before", (1.0, 0.25), letters_right_of(SERIES[0]))?;
        chart.line(ellipse(&believed.estimate, &now), ESTIMATED, 6)?;
        chart.dots([(believed.estimate.x, believed.estimate.y)], 10, ESTIMATED)?;
        chart.write("after", (1.1, 1.85), letters_right_of(ESTIMATED))?;
        Ok(())
    })
}
