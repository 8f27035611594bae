//! Two tapes have two spots, and a search finds the one that lies downhill.

use nalgebra::Vector2;
use plotters::element::{Circle, EmptyElement, PathElement, Rectangle, Text};
use plotters::style::Color;
use vislam::least_squares::Options;

use crate::figure::{self, ESTIMATED, Figure, INK, SERIES, letters_right_of, marker};
use crate::least_squares::worked::{self, POSTS, SIGMA, TWO_TAPE_STARTS, Tape, two_tapes};

/// Contours, by the length of the two residuals in metres.
const LEVELS: [f64; 5] = [0.5, 1.0, 2.0, 3.0, 4.0];
const STEPS: usize = 12;
const NAMES: [&str; 2] = ["Gauss-Newton", "Levenberg-Marquardt"];

/// Where a search is after every accepted step.
fn path(start: Vector2<f64>, options: &Options) -> Vec<Vector2<f64>> {
    let mut path: Vec<Vector2<f64>> = Vec::new();
    for steps in 0..=STEPS {
        let options = Options { max_iterations: steps, ..*options };
        let (spot, _) = worked::solve(&two_tapes(), start, &options);
        if path.last() != Some(&spot) {
            path.push(spot);
        }
    }
    path
}

/// For each start the path of both methods.
fn paths() -> Vec<[Vec<Vector2<f64>>; 2]> {
    let paths = TWO_TAPE_STARTS
        .map(|start| [path(start, &Options::gauss_newton()), path(start, &Options::default())]);
    paths.to_vec()
}

pub fn two_minima() -> Figure {
    let paths = paths();
    let mut rows = Vec::new();
    for (start, methods) in paths.iter().enumerate() {
        for (name, path) in NAMES.iter().zip(methods) {
            for (step, spot) in path.iter().take(8).enumerate() {
                rows.push(vec![
                    format!("{}", start + 1),
                    name.to_string(),
                    format!("{step}"),
                    format!("{:.2}", spot.x),
                    format!("{:.2}", spot.y),
                ]);
            }
        }
    }
    Figure {
        columns: vec!["start", "method", "accepted steps (the first 8)", "x (m)", "y (m)"],
        rows,
        svg: figure::draw(1180, |drawing| {
            let (x_axis, y_axis) = (("x (m)", -3.0..9.5, 6), ("y (m)", -6.5..8.2, 6));
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            for contour in LEVELS.into_iter().flat_map(contours) {
                chart.draw_series([PathElement::new(contour, INK.mix(0.3).stroke_width(3))])?;
            }
            for post in &POSTS[..2] {
                let body = Rectangle::new([(-13, -13), (13, 13)], INK.filled());
                chart.draw_series([EmptyElement::at((post.x, post.y)) + body])?;
            }
            for methods in &paths {
                for (index, path) in methods.iter().enumerate() {
                    for line in visible(path) {
                        chart
                            .draw_series([PathElement::new(line, SERIES[index].stroke_width(5))])?;
                    }
                    let marks = path.iter().filter(|spot| is_visible(spot));
                    let marks =
                        marks.map(|spot| EmptyElement::at((spot.x, spot.y)) + marker(index));
                    chart.draw_series(marks)?;
                }
                let start = (methods[0][0].x, methods[0][0].y);
                chart.draw_series([Circle::new(start, 24, INK.stroke_width(3))])?;
            }
            let spot = worked::estimate(&two_tapes());
            for y in [spot.y, -spot.y] {
                chart.draw_series([Circle::new((spot.x, y), 11, ESTIMATED.filled())])?;
            }
            for (index, name) in NAMES.into_iter().enumerate() {
                let place = (-2.7, 7.7 - 0.75 * index as f64);
                chart.draw_series([EmptyElement::at(place) + marker(index)])?;
                let beside = (place.0 + 0.3, place.1);
                chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[index]))])?;
            }
            Ok(())
        }),
    }
}

fn is_visible(spot: &Vector2<f64>) -> bool {
    (-3.0..9.5).contains(&spot.x) && (-6.5..6.5).contains(&spot.y)
}

/// The parts of a path that lie in the figure.
fn visible(path: &[Vector2<f64>]) -> Vec<Vec<(f64, f64)>> {
    let mut parts = Vec::new();
    for pair in path.windows(2) {
        let between = (0..=200).map(|step| pair[0].lerp(&pair[1], f64::from(step) / 200.0));
        let inside: Vec<Vector2<f64>> = between.filter(is_visible).collect();
        if let [first, .., last] = inside[..] {
            parts.push(vec![(first.x, first.y), (last.x, last.y)]);
        }
    }
    parts
}

/// Where the two residuals have this length together. In the lengths of the tapes as coordinates a
/// contour is a circle, and two lengths give a spot on each side of the fence.
fn contours(level: f64) -> Vec<Vec<(f64, f64)>> {
    let [first, second] = two_tapes().map(|tape: Tape| {
        debug_assert_eq!(tape.sigma, SIGMA);
        tape.measured
    });
    let width = POSTS[1].x;
    let mut above: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    // Where the two lengths are too short to meet, the contour has reached the fence.
    let mut at_fence = None;
    for step in 0..=720 {
        let (sine, cosine) = (f64::from(step) * 0.5).to_radians().sin_cos();
        let lengths = (first + level * cosine, second + level * sine);
        let x = (lengths.0.powi(2) - lengths.1.powi(2) + width * width) / (2.0 * width);
        let y_squared = lengths.0.powi(2) - x * x;
        let spot = Vector2::new(x, y_squared.max(0.0).sqrt());
        let is_open = !above[0].is_empty();
        if y_squared > 0.0 && is_visible(&spot) {
            above[0].extend(at_fence.filter(|_| !is_open));
            above[0].push((spot.x, spot.y));
        } else if is_open {
            above[0].extend((y_squared <= 0.0).then_some((x, 0.0)));
            above.insert(0, Vec::new());
        }
        at_fence = (y_squared <= 0.0).then_some((x, 0.0));
    }
    above.retain(|part| part.len() > 1);
    let below: Vec<Vec<(f64, f64)>> =
        above.iter().map(|part| part.iter().map(|(x, y)| (*x, -y)).collect()).collect();
    above.into_iter().chain(below).collect()
}
