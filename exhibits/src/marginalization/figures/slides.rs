//! The pattern of an information matrix while its window slides.

use std::collections::BTreeSet;

use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::marginalization::{Couplings, Layout, fill_in};

use crate::figure::{self, Draw, Drawing, Drawn, Figure, GRID, INK, PAPER, SERIES, letters, plain};

/// The pattern after some slides.
struct Pattern {
    names: Vec<usize>,
    pairs: BTreeSet<(usize, usize)>,
    /// Pairs that no measurement coupled, from this slide or an earlier one.
    filled: BTreeSet<(usize, usize)>,
    new: usize,
}

impl Pattern {
    /// The part of all blocks on one side of the diagonal that is not zero, in per cent.
    fn density(&self) -> f64 {
        let count = self.names.len();
        100.0 * self.pairs.len() as f64 / (count * (count - 1) / 2) as f64
    }
}

/// The window of the chapter without its odometry, before and after its first three slides.
fn patterns() -> Vec<Pattern> {
    let layout = Layout::eight_keyframes().without_odometry();
    let mut couplings: Couplings = layout.couplings();
    let measured = couplings.pairs();
    let mut names: Vec<usize> = (0..layout.keyframes + layout.seen_by.len()).collect();
    let pattern = |couplings: &Couplings, names: &[usize], new: usize| {
        let pairs = couplings.pairs();
        let filled = pairs.difference(&measured).copied().collect();
        Pattern { names: names.to_vec(), pairs, filled, new }
    };
    let mut all = vec![pattern(&couplings, &names, 0)];
    for keyframe in 0..3 {
        let gone: Vec<usize> =
            layout.slide(keyframe).into_iter().filter(|name| names.contains(name)).collect();
        let left = fill_in(&couplings, &gone).expect("they are there");
        names.retain(|name| !gone.contains(name));
        couplings = left.couplings;
        all.push(pattern(&couplings, &names, left.new.len()));
    }
    all
}

pub fn slides() -> Figure {
    let patterns = patterns();
    let columns = vec![
        ("slides", plain(0..patterns.len())),
        ("blocks", plain(patterns.iter().map(|p| p.names.len()))),
        ("coupled pairs", plain(patterns.iter().map(|p| p.pairs.len()))),
        ("pairs new in this slide", plain(patterns.iter().map(|p| p.new))),
        ("pairs that no measurement coupled", plain(patterns.iter().map(|p| p.filled.len()))),
        ("coupled (%)", figure::decimals(0, patterns.iter().map(Pattern::density))),
    ];
    Figure::new(1420, columns, |drawing| {
        let panels = drawing.split_evenly((2, 2));
        for (number, (panel, pattern)) in panels.iter().zip(&patterns).enumerate() {
            paint(panel, number, pattern)?;
        }
        Ok(())
    })
}

fn paint(drawing: &Drawing, number: usize, pattern: &Pattern) -> Drawn {
    let all = 20.0;
    let mut chart = plotters::chart::ChartBuilder::on(drawing)
        .margin(20)
        .build_cartesian_2d(-0.5..all + 1.5, -all - 0.5..3.2)?;
    let title = match number {
        0 => "before".to_owned(),
        1 => "one slide".to_owned(),
        _ => format!("{number} slides"),
    };
    let counted =
        format!("{title}: {} pairs, {} dotted", pattern.pairs.len(), pattern.filled.len());
    chart.write(&counted, (0.0, 2.6), letters(INK))?;
    let place = |name: usize| pattern.names.iter().position(|own| *own == name);
    let mut square = |row: usize, column: usize, colour: plotters::style::RGBColor| -> Drawn {
        let (x, y) = (column as f64, -(row as f64));
        let corners = [(x + 0.06, y - 0.06), (x + 0.94, y - 0.94)];
        chart.draw_series([Rectangle::new(corners, colour.filled())])?;
        Ok(())
    };
    for own in 0..pattern.names.len() {
        square(own, own, INK)?;
    }
    for pair in &pattern.pairs {
        let (Some(row), Some(column)) = (place(pair.0), place(pair.1)) else { continue };
        let colour = if pattern.filled.contains(pair) { SERIES[1] } else { SERIES[0] };
        square(row, column, colour)?;
        square(column, row, colour)?;
    }
    let size = pattern.names.len() as f64;
    let frame = [(0.0, 0.0), (size, 0.0), (size, -size), (0.0, -size), (0.0, 0.0)];
    chart.line(frame, GRID, 3)?;
    // What is filled in has a dot, for readers who do not go by colour.
    let dots = pattern.filled.iter().flat_map(|(a, b)| [(*a, *b), (*b, *a)]);
    let dots = dots.filter_map(|(a, b)| Some((place(b)? as f64 + 0.5, -(place(a)? as f64) - 0.5)));
    chart.dots(dots.collect::<Vec<_>>(), 6, PAPER)
}
