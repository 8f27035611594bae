//! How the window is drawn: as a matrix, as a graph, and what is known of two of its blocks.

use std::collections::BTreeSet;

use nalgebra::Matrix2;

use super::link::Ends;
use super::window::{Pair, Pattern};
use crate::ellipse::ellipse;
use crate::{Scene, Shape, Style};

pub const MATRIX: usize = 0;
pub const GRAPH: usize = 1;
pub const ENDS: [usize; 2] = [2, 3];

/// Keyframes of the window, and all blocks.
const KEYFRAMES: usize = 8;
const BLOCKS: usize = 20;

/// The words of the face.
pub const WORDS: &[&str] =
    &["keyframes", "landmarks", "a", "b", "no Gaussian is left", "not determined without odometry"];
const ENDS_WORDS: [usize; 2] = [2, 3];
const NO_GAUSSIAN: usize = 4;
const NOT_DETERMINED: usize = 5;

/// Couplings by where they come from.
pub struct Sorted {
    pub measured: Vec<Pair>,
    /// By no measurement, but before the last slide.
    pub filled: Vec<Pair>,
    /// In the last slide, or where a link was dropped.
    pub new: Vec<Pair>,
}

impl Sorted {
    /// Sorts the couplings of a window, a link of which may have been dropped.
    pub fn of(pattern: &Pattern, couplings: &BTreeSet<Pair>) -> Self {
        let mut sorted = Self { measured: Vec::new(), filled: Vec::new(), new: Vec::new() };
        for pair in couplings {
            let is_new = pattern.new.contains(pair) || !pattern.couplings.contains(pair);
            let kind = match (pattern.measured.contains(pair), is_new) {
                (true, _) => &mut sorted.measured,
                (false, false) => &mut sorted.filled,
                (false, true) => &mut sorted.new,
            };
            kind.push(*pair);
        }
        sorted
    }
}

type Places = Vec<[f64; 2]>;

const LANDMARKS_AT: f64 = 3.0;

/// Where a block stands in the graph: keyframes in a row, landmarks above it.
fn place(name: usize) -> [f64; 2] {
    if name < KEYFRAMES {
        return [name as f64, 0.0];
    }
    let apart = (KEYFRAMES - 1) as f64 / (BLOCKS - KEYFRAMES - 1) as f64;
    [apart * (name - KEYFRAMES) as f64, LANDMARKS_AT]
}

/// From one block to another, and then a break, for each pair. Blocks of one row are joined around those between them.
fn edges(pairs: &[Pair]) -> Places {
    let mut places = Vec::with_capacity(8 * pairs.len());
    for &(a, b) in pairs {
        let (from, to) = (place(a), place(b));
        let bend = match (a < KEYFRAMES, b < KEYFRAMES) {
            (true, true) => from[0] - to[0],
            (false, false) => to[0] - from[0],
            _ => 0.0,
        };
        let parts = if bend == 0.0 { 1 } else { 10 };
        for part in 0..=parts {
            let part = f64::from(part) / f64::from(parts);
            let between = |axis: usize| from[axis] + part * (to[axis] - from[axis]);
            places.push([between(0), between(1) + 1.2 * bend * part * (1.0 - part)]);
        }
        places.push([f64::NAN; 2]);
    }
    places
}

/// Both squares of each link.
fn squares(pairs: &[Pair]) -> Places {
    let mut places = Vec::with_capacity(2 * pairs.len());
    for &(a, b) in pairs {
        places.extend([[a as f64, b as f64], [b as f64, a as f64]]);
    }
    places
}

/// Across the matrix, before some blocks.
fn lines(blocks: std::ops::RangeInclusive<usize>) -> Places {
    let (least, most) = (-0.5, BLOCKS as f64 - 0.5);
    let mut places = Vec::new();
    for block in blocks {
        let at = block as f64 - 0.5;
        places.extend([[at, least], [at, most], [f64::NAN; 2]]);
        places.extend([[least, at], [most, at], [f64::NAN; 2]]);
    }
    places
}

pub fn draw_matrix(scene: &mut Scene, names: &[usize], sorted: &Sorted) {
    let own: Places = names.iter().map(|name| [*name as f64; 2]).collect();
    let (filled, new) = (squares(&sorted.filled), squares(&sorted.new));
    let dots = [&filled[..], &new[..]].concat();
    let mut draw =
        |shape, style, size, places: Places| scene.draw(MATRIX, (shape, style, size), places);
    draw(Shape::Cells, Style::Ink, 1.0, own);
    draw(Shape::Cells, Style::Measured, 1.0, squares(&sorted.measured));
    draw(Shape::PaleCells, Style::Prior, 1.0, filled);
    draw(Shape::Cells, Style::Prior, 1.0, new);
    draw(Shape::Discs, Style::Ink, 2.0, dots);
    draw(Shape::Line, Style::Faint, 1.0, lines(0..=BLOCKS));
    draw(Shape::Line, Style::Ink, 1.0, lines(KEYFRAMES..=KEYFRAMES));
    scene.word(MATRIX, 0, Style::Ink, [-0.4, -0.9]);
    scene.word(MATRIX, 1, Style::Ink, [KEYFRAMES as f64 - 0.4, -0.9]);
}

pub fn draw_graph(scene: &mut Scene, names: &[usize], sorted: &Sorted) {
    let (mut gone, mut keyframes, mut landmarks) = (Vec::new(), Vec::new(), Vec::new());
    for name in 0..BLOCKS {
        let row = match (names.contains(&name), name < KEYFRAMES) {
            (false, _) => &mut gone,
            (true, true) => &mut keyframes,
            (true, false) => &mut landmarks,
        };
        row.push(place(name));
    }
    let mut draw =
        |shape, style, size, places: Places| scene.draw(GRAPH, (shape, style, size), places);
    draw(Shape::Line, Style::Measured, 1.0, edges(&sorted.measured));
    draw(Shape::Dashed, Style::Prior, 1.2, edges(&sorted.filled));
    draw(Shape::Line, Style::Prior, 2.6, edges(&sorted.new));
    draw(Shape::Crosses, Style::Faint, 3.0, gone);
    draw(Shape::Discs, Style::Ink, 6.0, keyframes);
    draw(Shape::Rings, Style::Ink, 4.0, landmarks);
    scene.word(GRAPH, 1, Style::Ink, [-0.5, LANDMARKS_AT + 2.2]);
    scene.word(GRAPH, 0, Style::Ink, [-0.5, -2.2]);
}

/// The link in both pictures; crossed out if it has been dropped.
pub fn draw_link(scene: &mut Scene, (a, b): Pair, is_dropped: bool) {
    let shape = if is_dropped { Shape::Dashed } else { Shape::Line };
    scene.draw(GRAPH, (shape, Style::Estimated, 2.5), edges(&[(a, b)]));
    for (name, word) in [a, b].into_iter().zip(ENDS_WORDS) {
        let [x, y] = place(name);
        let above = if name < KEYFRAMES { -0.55 } else { 0.35 };
        scene.word(GRAPH, word, Style::Estimated, [x + 0.12, y + above]);
    }
    if is_dropped {
        scene.draw(MATRIX, (Shape::Crosses, Style::Estimated, 4.0), squares(&[(a, b)]));
    }
    scene.handle(MATRIX, 0, Style::Estimated, [a as f64, b as f64]);
}

/// The ellipses of an end: the true one, and what is reported.
pub fn draw_end(scene: &mut Scene, end: usize, truth: Option<&Ends>, reported: Option<&Ends>) {
    let panel = ENDS[end];
    let around = |ends: Option<&Ends>| {
        ends.map_or(Vec::new(), |ends| in_millimetres(&ends.seen_from_above(end)))
    };
    let (truth, reported) = (around(truth), around(reported));
    let reach = truth.iter().chain(&reported).flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
    let reach = if reach > 0.0 { 1.25 * reach } else { 1.0 };
    scene.view(panel, [-reach, reach], [-reach, reach]);
    if truth.is_empty() || reported.is_empty() {
        let word = if truth.is_empty() { NOT_DETERMINED } else { NO_GAUSSIAN };
        scene.word(panel, word, Style::Ink, [-reach, 0.0]);
    }
    scene.draw(panel, (Shape::Dashed, Style::Ink, 2.0), truth);
    scene.draw(panel, (Shape::Line, Style::Estimated, 2.0), reported);
}

/// One standard deviation around zero, in millimetres; nothing if there is none.
fn in_millimetres(covariance: &Matrix2<f64>) -> Places {
    ellipse(covariance).into_iter().map(|place| place.map(|metres| 1e3 * metres)).collect()
}
