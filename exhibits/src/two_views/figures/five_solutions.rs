//! What five correspondences leave open, and what a sixth one says about it.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{Circle, EmptyElement, PathElement};
use plotters::style::Color;

use crate::figure::{self, Column, Draw, Drawing, Drawn, Figure, INK, decimals, letters_right_of};
use crate::two_views::five_points::{SCENES, Solution, all_scenes};
use crate::two_views::numbers::NOISE;

/// Pixels at which a smaller miss is drawn.
const FLOOR: f64 = 0.01;

pub fn five_solutions() -> Figure {
    let [exact, noisy] = [0.0, NOISE].map(all_scenes);
    let mut columns = vec![("scene", (1..=SCENES).map(|scene| scene.to_string()).collect())];
    let (number, miss) = ("solutions without noise", "miss of the true one (px)");
    columns.extend(described(&exact, [number, miss]));
    let (number, miss) = ("solutions with noise", "miss of the one nearest to the truth (px)");
    columns.extend(described(&noisy, [number, miss]));
    Figure::new(1260, columns, |drawing| {
        let (above, below) = drawing.split_vertically(590);
        panel(&above, &exact, ("", "without noise"))?;
        panel(&below, &noisy, ("scene", "half a pixel of noise"))
    })
}

fn described(scenes: &[Vec<Solution>], [number, miss]: [&'static str; 2]) -> [Column; 4] {
    let in_front = |solutions: &[Solution]| solutions.iter().filter(|s| s.in_front).count();
    let best_wrong = |solutions: &[Solution]| {
        let wrong = solutions[1..].iter().filter(|solution| solution.in_front);
        let miss = wrong.map(|solution| solution.sixth).reduce(f64::min);
        miss.map_or("none".to_owned(), |miss| format!("{miss:.2}"))
    };
    [
        (number, scenes.iter().map(|solutions| solutions.len().to_string()).collect()),
        ("with five points in front", scenes.iter().map(|s| in_front(s).to_string()).collect()),
        (miss, decimals(2, scenes.iter().map(|solutions| solutions[0].sixth))),
        ("smallest miss of another in front (px)", scenes.iter().map(|s| best_wrong(s)).collect()),
    ]
}

fn panel(drawing: &Drawing, scenes: &[Vec<Solution>], (title, name): (&str, &str)) -> Drawn {
    let misses = (0.6 * FLOOR..5000.0).log_scale();
    let x_axis = (title, 0.2..25.8, 6);
    let mut chart = figure::axes(drawing, x_axis, ("miss of the sixth (px)", misses, 6))?;
    for (index, solutions) in scenes.iter().enumerate() {
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
