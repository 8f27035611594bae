//! Wrong matches over many seeds.

use plotters::element::{EmptyElement, PathElement, Text};
use plotters::style::Color;

use crate::bundle_adjustment::outliers::{Outcome, SEEDS, outcomes};
use crate::figure::{self, Drawing, Drawn, Figure, GRID, SERIES, letters_right_of, marker};

const NAMES: [&str; 3] = ["clean", "Huber", "least squares"];

pub fn outliers() -> Figure {
    let mut sorted = outcomes().to_vec();
    sorted.sort_by(|a, b| a[2].cameras_cm.total_cmp(&b[2].cameras_cm));
    let rows = sorted.iter().enumerate().map(|(scene, ways)| {
        let mut row = vec![(scene + 1).to_string()];
        row.extend(ways.iter().map(|way| format!("{:.2}", way.cameras_cm)));
        row.extend(ways.iter().map(|way| format!("{:.2}", way.right_px)));
        row.extend(ways[1..].iter().map(|way| format!("{:.2}", way.all_px)));
        row
    });
    Figure {
        columns: vec![
            "scene in the order of the figure",
            "camera error clean (cm)",
            "with Huber (cm)",
            "with least squares (cm)",
            "RMSE of right matches clean (px)",
            "with Huber (px)",
            "with least squares (px)",
            "RMSE of all matches with Huber (px)",
            "with least squares (px)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1320, |drawing| {
            let (above, below) = drawing.split_vertically(720);
            let cameras = |outcome: &Outcome| outcome.cameras_cm;
            panel(&above, &sorted, "", "camera error (cm)", cameras, true)?;
            let right = |outcome: &Outcome| outcome.right_px;
            let title = "scene, by the error of least squares";
            panel(&below, &sorted, title, "RMSE, right matches (px)", right, false)
        }),
    }
}

fn panel(
    drawing: &Drawing,
    sorted: &[[Outcome; 3]],
    x_title: &str,
    y_title: &str,
    value: fn(&Outcome) -> f64,
    names: bool,
) -> Drawn {
    let highest = sorted.iter().flatten().map(value).fold(0.0_f64, f64::max);
    let top = if names { 1.3 * highest } else { 1.1 * highest };
    let x_axis = (x_title, 0.2..SEEDS as f64 + 0.8, 8);
    let mut chart = figure::axes(drawing, x_axis, (y_title, 0.0..top, 5))?;
    for (index, ways) in sorted.iter().enumerate() {
        let x = index as f64 + 1.0;
        let line = [(x, value(&ways[1])), (x, value(&ways[2]))];
        chart.draw_series([PathElement::new(line, GRID.stroke_width(6))])?;
        let marks = ways.iter().enumerate();
        chart.draw_series(
            marks.map(|(way, outcome)| EmptyElement::at((x, value(outcome))) + marker(way)),
        )?;
    }
    for (way, name) in NAMES.iter().enumerate().filter(|_| names) {
        let place = (0.9 + 4.6 * way as f64, 0.92 * top);
        chart.draw_series([EmptyElement::at(place) + marker(way)])?;
        let beside = (place.0 + 0.45, place.1);
        chart.draw_series([Text::new(*name, beside, letters_right_of(SERIES[way]))])?;
    }
    Ok(())
}
