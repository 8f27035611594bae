//! What five correspondences leave open, and what a sixth one says about it.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{Circle, EmptyElement, PathElement};
use plotters::style::Color;

use crate::figure::{
    self, Column, Draw, Drawing, Drawn, Figure, INK, decimals, letters_right_of, plain,
};
use crate::two_views::five_points::{Found, SCENES, Solution, exact, noisy};

/// Pixels at which a smaller miss is drawn.
const FLOOR: f64 = 0.01;

pub fn five_solutions() -> Figure {
    let (exact, noisy) = (exact(), noisy());
    let mut columns = vec![("scene", plain(1..=SCENES))];
    let (number, miss) = ("solutions without noise", "miss of the true one (px)");
    columns.extend(described(exact, [number, miss]));
    let (number, miss) = ("solutions with noise", "miss of the one nearest to the truth (px)");
    columns.extend(described(noisy, [number, miss]));
    Figure::new(1260, columns, |drawing| {
        let (above, below) = drawing.split_vertically(590);
        panel(&above, exact, ("", "without noise"))?;
        panel(&below, noisy, ("scene", "half a pixel of noise"))
    })
}

fn described(scenes: &[Found], [number, miss]: [&'static str; 2]) -> [Column; 4] {
    let cells = |cell: fn(&Found) -> String| scenes.iter().map(cell).collect();
    let text = |miss: f64| format!("{miss:.2}");
    [
        (number, cells(|found| found.solutions.len().to_string())),
        ("with five points in front", cells(|found| found.in_front().to_string())),
        (miss, decimals(2, scenes.iter().map(|found| found.solutions[0].sixth))),
        (
            "smallest miss of another in front (px)",
            scenes.iter().map(|found| found.best_wrong().map_or("none".to_owned(), text)).collect(),
        ),
    ]
}

fn panel(drawing: &Drawing, scenes: &[Found], (title, name): (&str, &str)) -> Drawn {
    let misses = (0.6 * FLOOR..5000.0).log_scale();
    let x_axis = (title, 0.2..25.8, 6);
    let mut chart = figure::axes(drawing, x_axis, ("miss of the sixth (px)", misses, 6))?;
    for (index, Found { solutions, .. }) in scenes.iter().enumerate() {
        let place = |solution: &Solution| ((index + 1) as f64, solution.sixth.max(FLOOR));
        let (in_front, behind): (Vec<_>, Vec<_>) = solutions[1..].iter().partition(|s| s.in_front);
        chart.draw_series(behind.into_iter().map(|s| EmptyElement::at(place(s)) + star()))?;
        chart.marks(in_front.into_iter().map(place), 1)?;
        chart.draw_series([Circle::new(place(&solutions[0]), 13, INK.filled())])?;
    }
    chart.write(name, (0.7, 2500.0), letters_right_of(INK))
}

/// For a motion that has not all points in front.
fn star() -> PathElement<(i32, i32)> {
    let corners =
        [(-12, -12), (0, -5), (12, -12), (5, 0), (12, 12), (0, 5), (-12, 12), (-5, 0), (-12, -12)];
    PathElement::new(corners.to_vec(), INK.stroke_width(2))
}
