//! A simulated flight from above: smoother and filter, with what they say of their error.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use vislam::odometry::Estimator;

use crate::figure::{self, Draw, Extent, Figure, INK, Map, SERIES, decimals, letters_right_of};
use crate::msckf::flights::example::flight as example;
use crate::msckf::flights::flown;
use crate::smoother::consistency::followed;

const SECONDS: f64 = 20.0;
const SEED: u64 = 1;
/// Ellipses stand at every so manieth picture, and so much enlarged.
const EVERY: usize = 40;
const ENLARGED: f64 = 5.0;
/// Every so manieth picture is in the table.
const SHOWN: usize = 5;

struct Line {
    path: Vec<(f64, f64)>,
    ellipses: Vec<Vec<(f64, f64)>>,
    error: Vec<f64>,
    sigma: Vec<f64>,
}

pub fn flight() -> Figure {
    let recording = flown(&example(SECONDS), SEED);
    let truth: Vec<(f64, f64)> =
        recording.truth.states.iter().map(|state| (state.position.x, state.position.y)).collect();
    let lines = [Estimator::Smoother, Estimator::Msckf].map(|estimator| {
        let followed = followed(&recording, estimator, SEED);
        let mut line = Line { path: vec![], ellipses: vec![], error: vec![], sigma: vec![] };
        for (number, estimate) in &followed.causal {
            let at = estimate.state.position;
            line.path.push((at.x, at.y));
            line.error.push(100.0 * (at - recording.truth.states[*number].position).norm());
            let spread = estimate.covariance.fixed_view::<3, 3>(6, 6);
            line.sigma.push(100.0 * spread.trace().sqrt());
            let plane = spread.fixed_view::<2, 2>(0, 0).into_owned();
            if let Some(root) = plane.cholesky().filter(|_| number % EVERY == 0) {
                let point = |step: i32| {
                    let (sine, cosine) = (TAU * f64::from(step) / 40.0).sin_cos();
                    let off = 3.0 * ENLARGED * (root.l() * Vector2::new(cosine, sine));
                    (at.x + off.x, at.y + off.y)
                };
                line.ellipses.push((0..=40).map(point).collect());
            }
        }
        line
    });
    let each = |of: &[f64]| decimals(2, of.iter().copied().step_by(SHOWN));
    let seconds = (1..=lines[0].path.len()).step_by(SHOWN).map(|at| 0.1 * at as f64);
    let columns = vec![
        ("time (s)", decimals(1, seconds)),
        ("error of the smoother (cm)", each(&lines[0].error)),
        ("its σ (cm)", each(&lines[0].sigma)),
        ("error of the filter (cm)", each(&lines[1].error)),
        ("its σ (cm)", each(&lines[1].sigma)),
    ];
    let extent = Extent::of(truth.iter());
    let margin = 0.12 * (extent.x.end - extent.x.start);
    let Map { x: across, y: up, width, height } = extent.map(margin, 0.2);
    let (left, top) = (across.start, up.end);
    Figure::new(height, columns, |drawing| {
        let mut chart = figure::axes(drawing, ("x (m)", across, 6), ("y (m)", up, 6))?;
        chart.dots(truth.iter().copied().step_by(SHOWN), 6, INK)?;
        for (series, line) in lines.iter().enumerate() {
            chart.line(line.path.iter().copied(), SERIES[series], 4)?;
            for ellipse in &line.ellipses {
                chart.line(ellipse.iter().copied(), SERIES[series], 3)?;
            }
            let ends = (EVERY - 1..line.path.len()).step_by(EVERY).map(|at| line.path[at]);
            chart.marks(ends, series)?;
        }
        let x = left + 0.03 * width;
        let row = |row: f64| top - 0.055 * width * row;
        let names = ["smoother", "filter"];
        for (series, name) in names.iter().enumerate() {
            chart.key(
                series,
                name,
                (x + 0.22 * width * series as f64, row(0.8)),
                x + 0.22 * width * series as f64 + 0.03 * width,
            )?;
        }
        let said = format!("three σ, {ENLARGED} times as large");
        chart.write(&said, (x + 0.42 * width, row(0.8)), letters_right_of(INK))?;
        chart.dots([(x, row(1.8))], 6, INK)?;
        chart.write("truth, twice a second", (x + 0.03 * width, row(1.8)), letters_right_of(INK))
    })
}
