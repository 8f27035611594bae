//! Three circles that fail to meet, and where the estimate lies among them.

use std::iter;
use std::ops::Range;

use plotters::element::{EmptyElement, Rectangle};
use plotters::style::Color;

use crate::figure::{
    self, Draw, Drawing, Drawn, ESTIMATED, Figure, INK, MEASURED, decimals, letters_around,
    letters_right_of,
};
use crate::least_squares::cloud::Cloud;
use crate::least_squares::numbers::{CLOUD_DRAWS, CLOUD_SEED};
use crate::least_squares::worked::{POSTS, Tape, garden};

/// Rows of the table that are not posts.
const LISTED: usize = 50;

pub fn posts() -> Figure {
    let tapes = garden();
    let cloud = Cloud::of(&tapes, CLOUD_DRAWS, CLOUD_SEED);
    let estimates = iter::once(cloud.centre).chain(cloud.estimates.iter().take(LISTED).copied());
    let places: Vec<_> = POSTS.into_iter().chain(estimates).collect();
    let names = [["post"; 3].as_slice(), &["estimate"], &["from other readings"; LISTED]].concat();
    let mut lengths = decimals(2, tapes.map(|tape| tape.measured));
    lengths.resize(places.len(), String::new());
    let columns = vec![
        ("what (of the cloud: the first 50)", names.into_iter().map(String::from).collect()),
        ("x (m)", decimals(3, places.iter().map(|place| place.x))),
        ("y (m)", decimals(3, places.iter().map(|place| place.y))),
        ("tape (m)", lengths),
    ];
    Figure::new(640, columns, |drawing| {
        let (left, right) = drawing.split_horizontally(660);
        whole(&left, &tapes, &cloud)?;
        enlarged(&right, &tapes, &cloud)
    })
}

fn whole(drawing: &Drawing, tapes: &[Tape], cloud: &Cloud) -> Drawn {
    let (x_range, y_range) = (-2.5..8.5, -1.4..10.6);
    let window = (x_range.clone(), y_range.clone());
    let mut chart = figure::axes(drawing, ("x (m)", x_range, 5), ("y (m)", y_range, 5))?;
    let estimate = (cloud.centre.x, cloud.centre.y);
    for tape in tapes {
        for arc in arcs(tape, &window) {
            chart.line(arc, MEASURED, 4)?;
        }
        chart.line([(tape.post.x, tape.post.y), estimate], MEASURED, 2)?;
    }
    for post in POSTS {
        let body = Rectangle::new([(-13, -13), (13, 13)], INK.filled());
        chart.draw_series([EmptyElement::at((post.x, post.y)) + body])?;
    }
    chart.dots([estimate], 14, ESTIMATED)
}

fn enlarged(drawing: &Drawing, tapes: &[Tape], cloud: &Cloud) -> Drawn {
    let (x, y) = (cloud.centre.x, cloud.centre.y);
    let window = (x - 0.22..x + 0.22, y - 0.26..y + 0.26);
    let (x_range, y_range) = window.clone();
    let mut chart = figure::axes(drawing, ("x (m)", x_range, 4), ("", y_range, 4))?;
    let dots = cloud.estimates.iter().map(|spot| (spot.x, spot.y));
    let dots = dots.filter(|spot| window.0.contains(&spot.0) && window.1.contains(&spot.1));
    chart.dots(dots, 4, ESTIMATED.mix(0.5))?;
    for arc in tapes.iter().flat_map(|tape| arcs(tape, &window)) {
        chart.line(arc, MEASURED, 5)?;
    }
    chart.line(cloud.ellipse(), INK, 4)?;
    chart.dots([(x, y)], 14, ESTIMATED)?;
    chart.write("tapes", (x, y + 0.225), letters_around(MEASURED))?;
    chart.write("estimates", (x - 0.18, y - 0.19), letters_right_of(ESTIMATED))
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
