//! Three circles that fail to meet, and where the estimate lies among them.

use std::ops::Range;

use plotters::element::{Circle, EmptyElement, PathElement, Rectangle, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{
    self, Drawing, Drawn, ESTIMATED, Figure, INK, MEASURED, letters_around, letters_right_of,
};
use crate::least_squares::cloud::{Cloud, radius_of_95_percent};
use crate::least_squares::numbers::{CLOUD_DRAWS, CLOUD_SEED};
use crate::least_squares::worked::{POSTS, Tape, garden};

/// Rows of the table that are not posts.
const LISTED: usize = 50;

pub fn posts() -> Figure {
    let tapes = garden();
    let cloud = Cloud::of(&tapes, CLOUD_DRAWS, CLOUD_SEED);
    let row = |name: &str, x: f64, y: f64, tape: String| {
        vec![name.to_owned(), format!("{x:.3}"), format!("{y:.3}"), tape]
    };
    let mut rows = Vec::new();
    for tape in &tapes {
        rows.push(row("post", tape.post.x, tape.post.y, format!("{:.2}", tape.measured)));
    }
    rows.push(row("estimate", cloud.centre.x, cloud.centre.y, String::new()));
    for spot in cloud.estimates.iter().take(LISTED) {
        rows.push(row("from other readings", spot.x, spot.y, String::new()));
    }
    Figure {
        columns: vec!["what (of the cloud: the first 50)", "x (m)", "y (m)", "tape (m)"],
        rows,
        svg: figure::draw(640, |drawing| {
            let (left, right) = drawing.split_horizontally(660);
            whole(&left, &tapes, &cloud)?;
            enlarged(&right, &tapes, &cloud)
        }),
    }
}

fn whole(drawing: &Drawing, tapes: &[Tape], cloud: &Cloud) -> Drawn {
    let (x_range, y_range) = (-2.5..8.5, -1.4..10.6);
    let window = (x_range.clone(), y_range.clone());
    let mut chart = figure::axes(drawing, ("x (m)", x_range, 5), ("y (m)", y_range, 5))?;
    for tape in tapes {
        for arc in arcs(tape, &window) {
            chart.draw_series([PathElement::new(arc, MEASURED.stroke_width(4))])?;
        }
        let line = vec![(tape.post.x, tape.post.y), (cloud.centre.x, cloud.centre.y)];
        chart.draw_series([PathElement::new(line, MEASURED.stroke_width(2))])?;
    }
    for post in POSTS {
        let body = Rectangle::new([(-13, -13), (13, 13)], INK.filled());
        chart.draw_series([EmptyElement::at((post.x, post.y)) + body])?;
    }
    let estimate = (cloud.centre.x, cloud.centre.y);
    chart.draw_series([Circle::new(estimate, 14, ESTIMATED.filled())])?;
    Ok(())
}

fn enlarged(drawing: &Drawing, tapes: &[Tape], cloud: &Cloud) -> Drawn {
    let (half_width, half_height) = (0.22, 0.26);
    let x_range = cloud.centre.x - half_width..cloud.centre.x + half_width;
    let y_range = cloud.centre.y - half_height..cloud.centre.y + half_height;
    let window = (x_range.clone(), y_range.clone());
    let mut chart = figure::axes(drawing, ("x (m)", x_range, 4), ("", y_range, 4))?;
    let dots = cloud.estimates.iter().map(|spot| (spot.x, spot.y));
    let dots = dots.filter(|spot| window.0.contains(&spot.0) && window.1.contains(&spot.1));
    chart.draw_series(dots.map(|spot| Circle::new(spot, 4, ESTIMATED.mix(0.5).filled())))?;
    for tape in tapes {
        for arc in arcs(tape, &window) {
            chart.draw_series([PathElement::new(arc, MEASURED.stroke_width(5))])?;
        }
    }
    let ellipse = cloud.ellipse(radius_of_95_percent());
    chart.draw_series(LineSeries::new(ellipse, INK.stroke_width(4)))?;
    let estimate = (cloud.centre.x, cloud.centre.y);
    chart.draw_series([Circle::new(estimate, 14, ESTIMATED.filled())])?;
    let above = (cloud.centre.x, cloud.centre.y + half_height - 0.035);
    chart.draw_series([Text::new("tapes", above, letters_around(MEASURED))])?;
    let below = (cloud.centre.x - 0.18, cloud.centre.y - half_height + 0.07);
    chart.draw_series([Text::new("estimates", below, letters_right_of(ESTIMATED))])?;
    Ok(())
}

/// The parts of a tape's circle that lie in a window.
fn arcs(tape: &Tape, window: &(Range<f64>, Range<f64>)) -> Vec<Vec<(f64, f64)>> {
    let steps = 7200;
    let mut arcs = vec![Vec::new()];
    for step in 0..=steps {
        let (sine, cosine) = (f64::from(step) * 360.0 / f64::from(steps)).to_radians().sin_cos();
        let place = (tape.post.x + tape.measured * cosine, tape.post.y + tape.measured * sine);
        if window.0.contains(&place.0) && window.1.contains(&place.1) {
            arcs[0].push(place);
        } else if !arcs[0].is_empty() {
            arcs.insert(0, Vec::new());
        }
    }
    arcs.retain(|arc| arc.len() > 1);
    arcs
}
