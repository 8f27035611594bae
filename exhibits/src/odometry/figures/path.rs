//! The real flight from above: what was known at once, two seconds later, and in the end.

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_right_of};
use crate::odometry::real::{PATH, recorded};

const LINES: [(&str, &str); 4] = [
    ("filter", "filter, at once"),
    ("causal", "smoother, at once"),
    ("delayed", "smoother, two seconds later"),
    ("smoothed", "batch, in the end"),
];

fn points(name: &str) -> Vec<(f64, f64)> {
    let of = |at: usize, axis: &str| recorded(&format!("path_{name}_{at}_{axis}"));
    (0..PATH).map(|at| (of(at, "x"), of(at, "y"))).collect()
}

pub fn path() -> Figure {
    let truth = points("truth");
    let lines = LINES.map(|(name, _)| points(name));
    let off = |line: &[(f64, f64)]| {
        let away = |(own, true_): (&(f64, f64), &(f64, f64))| {
            100.0 * (own.0 - true_.0).hypot(own.1 - true_.1)
        };
        line.iter().zip(&truth).map(away).collect::<Vec<_>>()
    };
    let mut columns = vec![
        ("time since the beginning (s)", decimals(1, (0..PATH).map(|at| 0.5 * at as f64))),
        ("x of the ground truth (m)", decimals(3, truth.iter().map(|at| at.0))),
        ("y (m)", decimals(3, truth.iter().map(|at| at.1))),
    ];
    let titles = ["filter off by (cm)", "smoother (cm)", "two seconds later (cm)", "batch (cm)"];
    columns.extend(titles.iter().zip(&lines).map(|(title, line)| (*title, decimals(1, off(line)))));
    let all = || lines.iter().flatten().chain(&truth);
    let range = |of: fn(&(f64, f64)) -> f64| {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        all().map(of).fold((low, high), |(low, high), x| (low.min(x), high.max(x)))
    };
    let ((left, right), (low, high)) = (range(|at| at.0), range(|at| at.1));
    // A metre is as long in both directions: the plot is 1070 units wide.
    let margin = 0.25;
    let width = right - left + 2.0 * margin;
    let above = 0.33 * width;
    let tall = high - low + 2.0 * margin + above;
    let height = (1070.0 * tall / width) as u32 + 150;
    Figure::new(height, columns, |drawing| {
        let x_axis = ("x (m)", left - margin..right + margin, 6);
        let y_axis = ("y (m)", low - margin..high + margin + above, 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (series, line) in lines.iter().enumerate() {
            chart.line(line.iter().copied(), SERIES[series], 4)?;
            chart.marks(line.iter().copied().skip(series).step_by(6), series)?;
        }
        chart.dots(truth.iter().copied(), 6, INK)?;
        let x = left - margin + 0.03 * width;
        let row = |row: f64| high + margin + above - 0.055 * width * row;
        for (series, (_, name)) in LINES.iter().enumerate() {
            let height = row(0.8 + series as f64);
            chart.key(series, name, (x, height), x + 0.03 * width)?;
        }
        chart.dots([(x, row(4.8))], 6, INK)?;
        chart.write(
            "ground truth, twice a second",
            (x + 0.03 * width, row(4.8)),
            letters_right_of(INK),
        )
    })
}
