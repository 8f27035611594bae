//! Singular values of the Jacobian, a strip for each motion and assumption.

use plotters::element::{PathElement, Rectangle, Text};
use plotters::style::Color;
use vislam::observability::{BiasAssumption, Direction, FreeDirections};
use vislam::simulation::Trajectory;

use crate::figure::{self, Figure, GRID, INK, SERIES, letters_right_of};
use crate::observability::worked::{cases, free, table, window};

/// What is shown of the table.
const SHOWN: [&str; 8] = ["eight", "coast", "turn", "sway", "climb", "level", "hover", "spot"];
/// The gap in which no value may lie.
const GAP: [f64; 2] = [-13.0, -10.0];
/// All that is below this is shown here.
const LEAST: f64 = -17.4;

struct Strip {
    heading: Option<String>,
    biases: &'static str,
    free: FreeDirections,
}

fn strips() -> Vec<Strip> {
    let mut vision = window(Trajectory::figure_eight(), BiasAssumption::KNOWN);
    vision.intervals.clear();
    let heading = Some("pictures alone: figure-eight".to_owned());
    let mut strips = vec![Strip { heading, biases: "none", free: free(&vision) }];
    for (case, row) in cases().iter().zip(table()) {
        if SHOWN.contains(&case.word) {
            let heading = Some(case.name.replace(';', ","));
            strips.push(Strip { heading, biases: "unknown", free: row[0].clone() });
            strips.push(Strip { heading: None, biases: "known", free: row[2].clone() });
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

fn title(free: &FreeDirections) -> String {
    let beside = beside_four(free);
    if beside.is_empty() {
        format!("{}", free.count())
    } else {
        format!("{}: {beside}", free.count())
    }
}

pub fn spectra() -> Figure {
    let strips = strips();
    let mut motion = String::new();
    let mut rows = Vec::new();
    for strip in &strips {
        motion = strip.heading.clone().unwrap_or(motion);
        let (values, zeros) = (&strip.free.spectrum.singular_values, strip.free.count());
        rows.push(vec![
            motion.replace(',', ";"),
            strip.biases.to_owned(),
            zeros.to_string(),
            beside_four(&strip.free),
            format!("{:.0e}", values[zeros - 1]),
            format!("{:.0e}", values[zeros]),
            values.len().to_string(),
        ]);
    }
    Figure {
        columns: vec![
            "motion",
            "accelerometer bias",
            "free directions",
            "beside translation and yaw",
            "greatest that is zero (of the largest)",
            "least that is not",
            "singular values",
        ],
        rows,
        svg: draw(&strips),
    }
}

/// Heights are in rows, downwards: one for a heading, one for a strip.
fn draw(strips: &[Strip]) -> String {
    let headings = strips.iter().filter(|strip| strip.heading.is_some()).count();
    let height = 0.9 * headings as f64 + strips.len() as f64 + 0.3;
    figure::draw(150 + (62.0 * height) as u32, |drawing| {
        let x_axis = ("log\u{2081}\u{2080} of singular value", -17.9..0.5, 6);
        let mut chart = figure::axes(drawing, x_axis, ("", -height..0.0, 0))?;
        let shade = Rectangle::new([(GAP[0], -height), (GAP[1], 0.0)], GRID.mix(0.5).filled());
        chart.draw_series([shade])?;
        let mut top = -0.1;
        for strip in strips {
            if let Some(heading) = &strip.heading {
                let place = (-17.7, top - 0.5);
                chart.draw_series([Text::new(heading.clone(), place, letters_right_of(INK))])?;
                top -= 0.9;
            }
            let zeros = strip.free.count();
            let values = &strip.free.spectrum.singular_values;
            for (index, value) in values.iter().enumerate() {
                let colour = if index < zeros { SERIES[1] } else { SERIES[0] };
                let at = value.log10().max(LEAST);
                let tick = [(at, top - 0.14), (at, top - 0.86)];
                chart.draw_series([PathElement::new(tick, colour.stroke_width(4))])?;
            }
            let place = (-14.2, top - 0.5);
            chart.draw_series([Text::new(
                title(&strip.free),
                place,
                letters_right_of(SERIES[1]),
            )])?;
            let place = (-6.9, top - 0.5);
            let biases = if strip.biases == "none" { "" } else { strip.biases };
            chart.draw_series([Text::new(biases, place, letters_right_of(INK))])?;
            top -= 1.0;
        }
        Ok(())
    })
}
