//! Two tapes have two spots, and a search finds the one that lies downhill.

use nalgebra::Vector2;
use plotters::element::{Circle, EmptyElement, Rectangle};
use plotters::style::Color;
use vislam::least_squares::Options;

use crate::figure::{self, Draw, ESTIMATED, Figure, INK, SERIES, decimals};
use crate::least_squares::worked::{self, POSTS, TWO_TAPE_STARTS, two_tapes};

/// Contours, by the length of the two residuals in metres.
const LEVELS: [f64; 5] = [0.5, 1.0, 2.0, 3.0, 4.0];
const STEPS: usize = 12;
const NAMES: [&str; 2] = ["Gauss-Newton", "Levenberg-Marquardt"];

/// Where a search is after every accepted step.
fn path(start: Vector2<f64>, options: Options) -> Vec<Vector2<f64>> {
    let options = Options { max_iterations: STEPS, ..options };
    let path = worked::path(&two_tapes(), start, &options).into_iter();
    let mut spots: Vec<_> = path.map(|(spot, _)| spot).collect();
    spots.dedup();
    spots
}

pub fn two_minima() -> Figure {
    // For each start the path of both methods.
    let paths = TWO_TAPE_STARTS
        .map(|start| [path(start, Options::gauss_newton()), path(start, Options::default())]);
    let mut listed = Vec::new();
    for (start, methods) in paths.iter().enumerate() {
        for (name, path) in NAMES.into_iter().zip(methods) {
            let places = path.iter().take(8).enumerate();
            listed.extend(places.map(|(step, spot)| (start + 1, name, step, spot)));
        }
    }
    let columns = vec![
        ("start", listed.iter().map(|row| row.0.to_string()).collect()),
        ("method", listed.iter().map(|row| row.1.to_owned()).collect()),
        ("accepted steps (the first 8)", listed.iter().map(|row| row.2.to_string()).collect()),
        ("x (m)", decimals(2, listed.iter().map(|row| row.3.x))),
        ("y (m)", decimals(2, listed.iter().map(|row| row.3.y))),
    ];
    Figure::new(1180, columns, |drawing| {
        let (x_axis, y_axis) = (("x (m)", -3.0..9.5, 6), ("y (m)", -6.5..8.2, 6));
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for contour in LEVELS.into_iter().flat_map(contours) {
            chart.line(contour, INK.mix(0.3), 3)?;
        }
        for post in &POSTS[..2] {
            let body = Rectangle::new([(-13, -13), (13, 13)], INK.filled());
            chart.draw_series([EmptyElement::at((post.x, post.y)) + body])?;
        }
        for methods in &paths {
            for (index, path) in methods.iter().enumerate() {
                for line in visible(path) {
                    chart.line(line, SERIES[index], 5)?;
                }
                let spots = path.iter().filter(|spot| is_visible(spot));
                chart.marks(spots.map(|spot| (spot.x, spot.y)), index)?;
            }
            let start = (methods[0][0].x, methods[0][0].y);
            chart.draw_series([Circle::new(start, 24, INK.stroke_width(3))])?;
        }
        let spot = worked::estimate(&two_tapes());
        for y in [spot.y, -spot.y] {
            chart.dots([(spot.x, y)], 11, ESTIMATED)?;
        }
        for (index, name) in NAMES.into_iter().enumerate() {
            let height = 7.7 - 0.75 * index as f64;
            chart.key(index, name, (-2.7, height), -2.4)?;
        }
        Ok(())
    })
}

fn is_visible(spot: &Vector2<f64>) -> bool {
    (-3.0..9.5).contains(&spot.x) && (-6.5..6.5).contains(&spot.y)
}

/// The parts of a path that lie in the figure.
fn visible(path: &[Vector2<f64>]) -> Vec<[(f64, f64); 2]> {
    let part = |pair: &[Vector2<f64>]| {
        let between = (0..=200).map(|step| pair[0].lerp(&pair[1], f64::from(step) / 200.0));
        let inside: Vec<Vector2<f64>> = between.filter(is_visible).collect();
        let [first, .., last] = inside[..] else { return None };
        Some([(first.x, first.y), (last.x, last.y)])
    };
    path.windows(2).filter_map(part).collect()
}

/// Where the two residuals have this length together. In the lengths of the tapes as coordinates a
/// contour is a circle, and two lengths give a spot on each side of the fence.
fn contours(level: f64) -> Vec<Vec<(f64, f64)>> {
    let [first, second] = two_tapes().map(|tape| tape.measured);
    let width = POSTS[1].x;
    let mut above: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    // Where the two lengths are too short to meet, the contour has reached the fence.
    let mut at_fence = None;
    for step in 0..=360 {
        let (sine, cosine) = f64::from(step).to_radians().sin_cos();
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
    let below: Vec<Vec<_>> =
        above.iter().map(|part| part.iter().map(|(x, y)| (*x, -y)).collect()).collect();
    above.into_iter().chain(below).collect()
}
