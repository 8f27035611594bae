//! The correlations of the nine errors as squares.

use plotters::chart::ChartBuilder;
use plotters::element::{PathElement, Rectangle, Text};
use plotters::style::Color;
use vislam::preintegration::Matrix9;

use crate::figure::{self, Drawing, Drawn, Figure, GRID, INK, SERIES, letters_around};
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
    let mut rows = Vec::new();
    for column in 0..9 {
        for row in column + 1..9 {
            let mut cells = vec![format!("{} and {}", NAMES[row], NAMES[column])];
            cells.extend(matrices.iter().map(|(_, matrix)| cell(matrix[(row, column)])));
            rows.push(cells);
        }
    }
    Figure {
        columns: vec!["errors", "correlation at rest", "correlation in the figure-eight"],
        rows,
        svg: figure::draw(680, |drawing| {
            let (left, right) = drawing.split_horizontally(640);
            panel(&left, matrices[0].0, &matrices[0].1)?;
            panel(&right, matrices[1].0, &matrices[1].1)
        }),
    }
}

fn cell(value: f64) -> String {
    let value = if value.abs() < LEAST { 0.0 } else { value };
    format!("{value:.2}")
}

fn panel(drawing: &Drawing, name: &str, matrix: &Matrix9) -> Drawn {
    let mut chart = ChartBuilder::on(drawing).build_cartesian_2d(0.0..640.0, 680.0..0.0)?;
    let middle = |index: usize| CELL * (index as f64 + 0.5);
    let title = Text::new(name.to_owned(), (LEFT + 4.5 * CELL, 34.0), letters_around(INK));
    chart.draw_series([title])?;
    for (index, name) in NAMES.iter().enumerate() {
        let places = [(LEFT + middle(index), TOP - 32.0), (LEFT - 40.0, TOP + middle(index))];
        chart.draw_series(places.map(|place| Text::new(*name, place, letters_around(INK))))?;
    }
    for line in 0..=9 {
        let (at, end) = (CELL * f64::from(line), 9.0 * CELL);
        let width = if line % 3 == 0 { 4 } else { 1 };
        let across = [(LEFT, TOP + at), (LEFT + end, TOP + at)];
        let down = [(LEFT + at, TOP), (LEFT + at, TOP + end)];
        let lines = [across, down].map(|ends| PathElement::new(ends, GRID.stroke_width(width)));
        chart.draw_series(lines)?;
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
            let corners = |half: f64| [(x - half, y - half), (x + half, y + half)];
            if value < 0.0 {
                // Its stroke lies half outside of the path.
                let half = (half - 4.5).max(2.0);
                let path = [(-half, -half), (half, -half), (half, half), (-half, half)];
                let path = [0, 1, 2, 3, 0, 1].map(|k: usize| (x + path[k].0, y + path[k].1));
                chart.draw_series([PathElement::new(path, SERIES[1].stroke_width(9))])?;
            } else {
                let colour = if row == column { GRID } else { SERIES[0] };
                chart.draw_series([Rectangle::new(corners(half.max(2.0)), colour.filled())])?;
            }
        }
    }
    Ok(())
}
