//! Singular values of the Jacobian, a strip for each motion and assumption.

use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::observability::{Direction, FreeDirections};

use crate::figure::{self, Draw, Figure, GRID, INK, SERIES, letters_right_of};
use crate::observability::worked::{cases, table, vision};

/// What is shown of the table.
const SHOWN: [&str; 8] = ["eight", "coast", "turn", "sway", "climb", "level", "hover", "spot"];
/// The gap in which no value may lie.
const GAP: [f64; 2] = [-13.0, -10.0];
/// All that is below this is shown here.
const LEAST: f64 = -17.4;

struct Strip {
    motion: &'static str,
    biases: &'static str,
    free: &'static FreeDirections,
}

impl Strip {
    /// The first strip of a motion stands below its name.
    fn has_heading(&self) -> bool {
        self.biases != "known"
    }

    /// A singular value that is zero or not, by its place.
    fn value(&self, index: usize) -> String {
        format!("{:.0e}", self.free.spectrum.singular_values[index])
    }
}

fn strips() -> Vec<Strip> {
    let motion = "pictures alone: figure-eight";
    let mut strips = vec![Strip { motion, biases: "none", free: vision() }];
    for (case, row) in cases().iter().zip(table()) {
        if SHOWN.contains(&case.word) {
            strips.push(Strip { motion: case.name, biases: "unknown", free: &row[0] });
            strips.push(Strip { motion: case.name, biases: "known", free: &row[2] });
        }
    }
    strips
}

/// What is free beside translation and yaw.
fn beside_four(free: &FreeDirections) -> String {
    let has = |direction| free.named.contains(&direction);
    let mut names = Vec::new();
    if has(Direction::Tilt(0)) || has(Direction::Tilt(1)) {
        names.push("tilts".to_owned());
    }
    if has(Direction::Scale) {
        names.push("scale".to_owned());
    }
    match free.named.iter().filter(|d| matches!(d, Direction::Depth(_))).count() {
        0 => {}
        depths => names.push(format!("{depths} depths")),
    }
    names.extend(free.mixtures.iter().map(|_| "scale with tilt".to_owned()));
    names.join(" + ")
}

/// Heights are in rows, downwards: one for a heading, one for a strip.
pub fn spectra() -> Figure {
    let strips = strips();
    let cells = |cell: fn(&Strip) -> String| strips.iter().map(cell).collect();
    let columns = vec![
        ("motion", cells(|strip| strip.motion.replace(',', ";"))),
        ("accelerometer bias", cells(|strip| strip.biases.to_owned())),
        ("free directions", cells(|strip| strip.free.count().to_string())),
        ("beside translation and yaw", cells(|strip| beside_four(strip.free))),
        ("greatest that is zero (of the largest)", cells(|s| s.value(s.free.count() - 1))),
        ("least that is not", cells(|strip| strip.value(strip.free.count()))),
        ("singular values", cells(|s| s.free.spectrum.singular_values.len().to_string())),
    ];
    let headings = strips.iter().filter(|strip| strip.has_heading()).count();
    let height = 0.9 * headings as f64 + strips.len() as f64 + 0.3;
    Figure::new(150 + (62.0 * height) as u32, columns, |drawing| {
        let x_axis = ("log\u{2081}\u{2080} of singular value", -17.9..0.5, 6);
        let mut chart = figure::axes(drawing, x_axis, ("", -height..0.0, 0))?;
        let shade = Rectangle::new([(GAP[0], -height), (GAP[1], 0.0)], GRID.mix(0.5).filled());
        chart.draw_series([shade])?;
        let mut top = -0.1;
        for strip in &strips {
            if strip.has_heading() {
                let heading = strip.motion.replace(';', ",");
                chart.write(&heading, (-17.7, top - 0.5), letters_right_of(INK))?;
                top -= 0.9;
            }
            let zeros = strip.free.count();
            for (index, value) in strip.free.spectrum.singular_values.iter().enumerate() {
                let at = value.log10().max(LEAST);
                let colour = if index < zeros { SERIES[1] } else { SERIES[0] };
                chart.line([(at, top - 0.14), (at, top - 0.86)], colour, 4)?;
            }
            let beside = beside_four(strip.free);
            let title =
                if beside.is_empty() { zeros.to_string() } else { format!("{zeros}: {beside}") };
            chart.write(&title, (-14.2, top - 0.5), letters_right_of(SERIES[1]))?;
            let biases = if strip.biases == "none" { "" } else { strip.biases };
            chart.write(biases, (-6.9, top - 0.5), letters_right_of(INK))?;
            top -= 1.0;
        }
        Ok(())
    })
}
