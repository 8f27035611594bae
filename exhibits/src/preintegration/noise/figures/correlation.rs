//! The correlations of the nine errors as squares.

use plotters::chart::ChartBuilder;
use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::preintegration::Matrix9;

use crate::figure::{Draw, Drawing, Drawn, Figure, GRID, INK, SERIES, decimals, letters_around};
use crate::preintegration::noise::blocks::{correlation as of, seconds};

const NAMES: [&str; 9] = ["φx", "φy", "φz", "vx", "vy", "vz", "px", "py", "pz"];
/// Sides of a cell, and where the first one begins.
const CELL: f64 = 56.0;
const LEFT: f64 = 84.0;
const TOP: f64 = 124.0;
/// Correlations below this are not drawn.
const LEAST: f64 = 0.005;

pub fn correlation() -> Figure {
    let matrices = seconds().map(|(name, sums)| (name, of(&sums.covariance)));
    let pairs = || (0..9).flat_map(|column| (column + 1..9).map(move |row| (row, column)));
    let name = |(row, column): (usize, usize)| format!("{} and {}", NAMES[row], NAMES[column]);
    let cells = |index: usize| {
        let values = pairs().map(|pair| matrices[index].1[pair]);
        decimals(2, values.map(|value| if value.abs() < LEAST { 0.0 } else { value }))
    };
    let columns = vec![
        ("errors", pairs().map(name).collect()),
        ("correlation at rest", cells(0)),
        ("correlation in the figure-eight", cells(1)),
    ];
    Figure::new(680, columns, |drawing| {
        let (left, right) = drawing.split_horizontally(640);
        panel(&left, matrices[0].0, &matrices[0].1)?;
        panel(&right, matrices[1].0, &matrices[1].1)
    })
}

fn panel(drawing: &Drawing, name: &str, matrix: &Matrix9) -> Drawn {
    let mut chart = ChartBuilder::on(drawing).build_cartesian_2d(0.0..640.0, 680.0..0.0)?;
    let middle = |index: usize| CELL * (index as f64 + 0.5);
    chart.write(name, (LEFT + 4.5 * CELL, 34.0), letters_around(INK))?;
    for (index, name) in NAMES.into_iter().enumerate() {
        chart.write(name, (LEFT + middle(index), TOP - 32.0), letters_around(INK))?;
        chart.write(name, (LEFT - 40.0, TOP + middle(index)), letters_around(INK))?;
    }
    for line in 0..=9 {
        let (at, end) = (CELL * f64::from(line), 9.0 * CELL);
        let width = if line % 3 == 0 { 4 } else { 1 };
        chart.line([(LEFT, TOP + at), (LEFT + end, TOP + at)], GRID, width)?;
        chart.line([(LEFT + at, TOP), (LEFT + at, TOP + end)], GRID, width)?;
    }
    for row in 0..9 {
        for column in 0..9 {
            let value = matrix[(row, column)];
            if value.abs() < LEAST {
                continue;
            }
            // Its area says how large it is; a negative one is hollow.
            let half = 0.46 * CELL * value.abs().sqrt();
            let (x, y) = (LEFT + middle(column), TOP + middle(row));
            if value < 0.0 {
                // Its stroke lies half outside of the path.
                let half = (half - 4.5).max(2.0);
                let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
                let path = [0, 1, 2, 3, 0, 1].map(|k: usize| (x + corners[k].0, y + corners[k].1));
                chart.line(path, SERIES[1], 9)?;
            } else {
                let half = half.max(2.0);
                let colour = if row == column { GRID } else { SERIES[0] };
                let corners = [(x - half, y - half), (x + half, y + half)];
                chart.draw_series([Rectangle::new(corners, colour.filled())])?;
            }
        }
    }
    Ok(())
}
