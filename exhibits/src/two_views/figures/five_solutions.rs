//! What five correspondences leave open, and what a sixth one says about it.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{Circle, EmptyElement, PathElement, Text};
use plotters::style::Color;

use crate::figure::{self, Drawing, Drawn, Figure, INK, letters_right_of, marker};
use crate::two_views::five_points::{Solution, all_scenes};
use crate::two_views::numbers::NOISE;

/// Pixels at which a smaller miss is drawn.
const FLOOR: f64 = 0.01;

pub fn five_solutions() -> Figure {
    let [exact, noisy] = [0.0, NOISE].map(all_scenes);
    let rows = exact.iter().zip(&noisy).enumerate().map(|(scene, (exact, noisy))| {
        let mut row = vec![format!("{}", scene + 1)];
        for solutions in [exact, noisy] {
            let in_front = solutions.iter().filter(|solution| solution.in_front).count();
            let wrong = solutions[1..].iter().filter(|solution| solution.in_front);
            let best_wrong = wrong.map(|solution| solution.sixth).reduce(f64::min);
            row.push(format!("{}", solutions.len()));
            row.push(format!("{in_front}"));
            row.push(format!("{:.2}", solutions[0].sixth));
            row.push(best_wrong.map_or("none".to_owned(), |miss| format!("{miss:.2}")));
        }
        row
    });
    Figure {
        columns: vec![
            "scene",
            "solutions without noise",
            "with five points in front",
            "miss of the true one (px)",
            "smallest miss of another in front (px)",
            "solutions with noise",
            "with five points in front",
            "miss of the one nearest to the truth (px)",
            "smallest miss of another in front (px)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1260, |drawing| {
            let (above, below) = drawing.split_vertically(590);
            panel(&above, &exact, ("", "without noise"))?;
            panel(&below, &noisy, ("scene", "half a pixel of noise"))
        }),
    }
}

fn panel(drawing: &Drawing, scenes: &[Vec<Solution>], (title, name): (&str, &str)) -> Drawn {
    let misses = (0.6 * FLOOR..5000.0).log_scale();
    let x_axis = (title, 0.2..25.8, 6);
    let mut chart = figure::axes(drawing, x_axis, ("miss of the sixth (px)", misses, 6))?;
    for (index, solutions) in scenes.iter().enumerate() {
        let place = |solution: &Solution| ((index + 1) as f64, solution.sixth.max(FLOOR));
        let (in_front, behind): (Vec<_>, Vec<_>) = solutions[1..].iter().partition(|s| s.in_front);
        chart.draw_series(behind.into_iter().map(|s| EmptyElement::at(place(s)) + star()))?;
        chart.draw_series(in_front.into_iter().map(|s| EmptyElement::at(place(s)) + marker(1)))?;
        let truth = place(&solutions[0]);
        chart.draw_series([Circle::new(truth, 13, INK.filled())])?;
    }
    chart.draw_series([Text::new(name.to_owned(), (0.7, 2500.0), letters_right_of(INK))])?;
    Ok(())
}

/// For a motion that has not all points in front.
fn star() -> PathElement<(i32, i32)> {
    let corners =
        [(-12, -12), (0, -5), (12, -12), (5, 0), (12, 12), (0, 5), (-12, 12), (-5, 0), (-12, -12)];
    PathElement::new(corners.to_vec(), INK.stroke_width(2))
}
