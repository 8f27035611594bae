//! The batch of a real flight from above, with ellipses.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Vector2};

use crate::figure::{self, Draw, ESTIMATED, Extent, Figure, INK, Map, decimals, letters_right_of};
use crate::initialization::real::{ENLARGED, PATH, PATH_RATE, accepted_value};

fn place(name: &str, at: usize) -> (f64, f64) {
    let of = |axis| accepted_value(&format!("{name}_{at}_{axis}"));
    (of("x"), of("y"))
}

/// The ellipse of three standard deviations around a place, enlarged.
fn ellipse(at: usize) -> Vec<(f64, f64)> {
    let of = |name| 1e-4 * accepted_value(&format!("spread_{at}_{name}"));
    let spread = Matrix2::new(of("xx"), of("xy"), of("xy"), of("yy"));
    let (x, y) = place("path", at);
    let Some(root) = spread.cholesky() else { return Vec::new() };
    let point = |step: i32| {
        let (sine, cosine) = (TAU * f64::from(step) / 40.0).sin_cos();
        let off = 3.0 * ENLARGED * (root.l() * Vector2::new(cosine, sine));
        (x + off.x, y + off.y)
    };
    (0..=40).map(point).collect()
}

pub fn batch() -> Figure {
    let path: Vec<(f64, f64)> = (0..=PATH).map(|at| place("path", at)).collect();
    let truth: Vec<(f64, f64)> = (0..=PATH).map(|at| place("truth", at)).collect();
    let sigma = |at: usize| {
        let of = |name| accepted_value(&format!("spread_{}_{name}", at - at % PATH_RATE));
        (of("xx") + of("yy")).sqrt()
    };
    let each = || (0..=PATH).step_by(PATH_RATE);
    let columns = vec![
        ("time (s)", decimals(0, each().map(|at| at as f64 / PATH_RATE as f64))),
        ("x of the batch (m)", decimals(3, each().map(|at| path[at].0))),
        ("y of the batch (m)", decimals(3, each().map(|at| path[at].1))),
        ("x of the ground truth (m)", decimals(3, each().map(|at| truth[at].0))),
        ("y of the ground truth (m)", decimals(3, each().map(|at| truth[at].1))),
        ("reported σ in the plane (cm)", decimals(2, each().map(sigma))),
    ];
    let Map { x: across, y: up, width, height } = Extent::of(path.iter()).map(0.35, 0.16);
    let (left, top) = (across.start, up.end);
    Figure::new(height, columns, |drawing| {
        let mut chart = figure::axes(drawing, ("x (m)", across, 6), ("y (m)", up, 6))?;
        for at in (0..=PATH).step_by(PATH_RATE) {
            chart.line(ellipse(at), ESTIMATED, 2)?;
        }
        chart.line(path.iter().copied(), ESTIMATED, 5)?;
        chart.dots(truth.iter().copied(), 6, INK)?;
        let (x, step) = (left + 0.03 * width, 0.055 * width);
        let row = |row: f64| top - step * row;
        chart.line([(x, row(0.7)), (x + 0.05 * width, row(0.7))], ESTIMATED, 5)?;
        let beside = x + 0.07 * width;
        chart.write("batch", (beside, row(0.7)), letters_right_of(ESTIMATED))?;
        chart.line([(x + 0.3 * width, row(0.7)), (x + 0.35 * width, row(0.7))], ESTIMATED, 2)?;
        let enlarged = format!("three σ, {ENLARGED} times as large");
        chart.write(&enlarged, (x + 0.37 * width, row(0.7)), letters_right_of(ESTIMATED))?;
        chart.dots([(x + 0.025 * width, row(1.7))], 6, INK)?;
        chart.write("ground truth, twice a second", (beside, row(1.7)), letters_right_of(INK))?;
        Ok(())
    })
}
