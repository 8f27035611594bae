//! The rows of a track before and after the rotations.

use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::msckf::LinearizedTrack;

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, GRID, INK, SERIES, letters_around, powers,
};
use crate::msckf::draws::{Plan, Track};
use crate::random::Random;

const SIGHTS: usize = 5;
/// Entries of this size and above are black, and those a millionth of it are not drawn.
const LARGEST: f64 = 1e3;

/// The numbers of the rows, without those of the camera's place on the body.
fn numbers(track: &LinearizedTrack) -> Vec<Vec<f64>> {
    let width = track.rows().width();
    let shown = |row: &[f64]| [&row[..width - 7], &row[width - 1..]].concat();
    track.rows().from(0).map(shown).collect()
}

pub fn blocks() -> Figure {
    let before = Track::drawn(&mut Random::new(3), Plan::new(SIGHTS)).linearized();
    let mut after = before.clone();
    after.project(f64::INFINITY).expect("nothing is refused");
    let (before, after) = (numbers(&before), numbers(&after));
    let landmark =
        |row: &Vec<f64>| row[..3].iter().map(|number| number * number).sum::<f64>().sqrt();
    let residual = |row: &Vec<f64>| row[row.len() - 1];
    let poses = |row: &Vec<f64>| {
        let named = row[3..row.len() - 1].chunks(6).filter(|pose| pose.iter().any(|n| *n != 0.0));
        named.count().to_string()
    };
    let columns = vec![
        ("row", (1..=before.len()).map(|row| row.to_string()).collect()),
        ("length of the landmark's part (1/m)", powers(1, before.iter().map(landmark))),
        ("after", powers(1, after.iter().map(landmark))),
        ("poses that are named", before.iter().map(poses).collect()),
        ("poses after", after.iter().map(poses).collect()),
        ("residual", powers(1, before.iter().map(residual))),
        ("residual after", powers(1, after.iter().map(residual))),
    ];
    Figure::new(980, columns, |drawing| {
        let (above, below) = drawing.split_vertically(490);
        panel(&above, &before, false)?;
        panel(&below, &after, true)
    })
}

fn panel(drawing: &Drawing, rows: &[Vec<f64>], is_after: bool) -> Drawn {
    let (width, height) = (rows[0].len() as f64, rows.len() as f64);
    let y_axis = (if is_after { "after" } else { "before" }, -0.3..height + 1.6, 0);
    let mut chart = figure::axes(drawing, ("", -0.5..width + 0.5, 0), y_axis)?;
    for (row, numbers) in rows.iter().enumerate() {
        let top = height - row as f64;
        for (column, number) in numbers.iter().enumerate() {
            // What rounding leaves is no number.
            let dark = 1.0 + (number.abs().max(1e-300) / LARGEST).log10() / 6.0;
            if dark > 0.0 {
                let x = column as f64;
                let colour = if column < 3 { SERIES[1] } else { INK };
                let shade = colour.mix((0.25 + 0.75 * dark).min(1.0)).filled();
                let corners = [(x + 0.06, top - 0.06), (x + 0.94, top - 0.94)];
                chart.draw_series([Rectangle::new(corners, shade)])?;
            }
        }
    }
    for pose in 0..=SIGHTS {
        let x = 3.0 + 6.0 * pose as f64;
        chart.line([(x, 0.0), (x, height)], GRID, 3)?;
    }
    if is_after {
        chart.line([(-0.3, height - 3.0), (width + 0.3, height - 3.0)], INK, 4)?;
    }
    chart.write("f", (1.5, height + 0.9), letters_around(SERIES[1]))?;
    for pose in 0..SIGHTS {
        let x = 6.0 + 6.0 * pose as f64;
        chart.write(&format!("pose {}", pose + 1), (x, height + 0.9), letters_around(INK))?;
    }
    chart.write("r", (width - 0.5, height + 0.9), letters_around(INK))
}
