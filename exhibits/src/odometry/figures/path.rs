//! The real flight from above: what was known at once, two seconds later, and in the end.

use crate::figure::{self, Draw, Extent, Figure, INK, Map, SERIES, decimals, letters_right_of};
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
    let map = Extent::of(lines.iter().flatten().chain(&truth)).map(0.25, 0.33);
    let Map { x: across, y: up, width, height } = map;
    let (left, top) = (across.start, up.end);
    Figure::new(height, columns, |drawing| {
        let mut chart = figure::axes(drawing, ("x (m)", across, 6), ("y (m)", up, 6))?;
        for (series, line) in lines.iter().enumerate() {
            chart.line(line.iter().copied(), SERIES[series], 4)?;
            chart.marks(line.iter().copied().skip(series).step_by(6), series)?;
        }
        chart.dots(truth.iter().copied(), 6, INK)?;
        let x = left + 0.03 * width;
        let row = |row: f64| top - 0.055 * width * row;
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
