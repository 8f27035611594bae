//! Beside the fence: Gauss-Newton leaves the minimum, Levenberg-Marquardt finds it.

use plotters::element::{EmptyElement, PathElement, Text};
use plotters::style::Color;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};
use crate::least_squares::numbers::{fence_path, fence_start};
use crate::least_squares::worked::{self, FAR_FROM_FENCE, fence};
use vislam::least_squares::{Method, Options};

const STEPS: usize = 20;

/// A search: its name, and where it is after every accepted step.
struct Search {
    name: &'static str,
    /// Metres across the fence, and the norm of the scaled gradient.
    path: Vec<(f64, f64)>,
}

fn searches() -> [Search; 3] {
    let tight = Options {
        method: Method::LevenbergMarquardt { initial_damping: 1e-4 },
        ..worked::unstopped(STEPS)
    };
    let gauss_newton = worked::unstopped(STEPS);
    [
        Search { name: "Gauss-Newton, near", path: fence_path(fence_start(), &gauss_newton) },
        Search { name: "Levenberg-Marquardt, near", path: fence_path(fence_start(), &tight) },
        Search { name: "Levenberg-Marquardt, far", path: fence_path(FAR_FROM_FENCE, &tight) },
    ]
}

pub fn fence_figure() -> Figure {
    let searches = searches();
    let rows = (0..=STEPS).map(|step| {
        let mut row = vec![format!("{step}")];
        for search in &searches {
            let cells = search.path.get(step).map_or([String::new(), String::new()], |place| {
                [format!("{:.4}", place.0), format!("{:.1e}", place.1)]
            });
            row.extend(cells);
        }
        row
    });
    Figure {
        columns: vec![
            "iteration",
            "y of Gauss-Newton (m)",
            "its gradient",
            "y of Levenberg-Marquardt (m)",
            "its gradient",
            "y of Levenberg-Marquardt from afar (m)",
            "its gradient",
        ],
        rows: rows.collect(),
        svg: figure::draw(1180, |drawing| {
            let (above, below) = drawing.split_vertically(580);
            across(&above, &searches)?;
            gradients(&below, &searches)
        }),
    }
}

fn across(drawing: &Drawing, searches: &[Search]) -> Drawn {
    let x_axis = ("iteration", -0.5..20.5, 6);
    let mut chart = figure::axes(drawing, x_axis, ("across the fence (m)", -0.1..1.15, 5))?;
    let minimum = worked::estimate(&fence()).y;
    let level = vec![(-0.5, minimum), (20.5, minimum)];
    chart.draw_series([PathElement::new(level, INK.stroke_width(2))])?;
    for (index, search) in searches.iter().enumerate() {
        let places: Vec<_> =
            search.path.iter().enumerate().map(|(step, place)| (step as f64, place.0)).collect();
        let line = PathElement::new(places.clone(), SERIES[index].stroke_width(4));
        chart.draw_series([line])?;
        let marks = places.into_iter().map(|place| EmptyElement::at(place) + marker(index));
        chart.draw_series(marks)?;
        let height = 1.06 - 0.14 * index as f64;
        chart.draw_series([EmptyElement::at((6.2, height)) + marker(index)])?;
        let name = Text::new(search.name, (6.7, height), letters_right_of(SERIES[index]));
        chart.draw_series([name])?;
    }
    Ok(())
}

fn gradients(drawing: &Drawing, searches: &[Search]) -> Drawn {
    let x_axis = ("iteration", -0.5..20.5, 6);
    let y_axis = ("log\u{2081}\u{2080} of gradient", -12.0..3.0, 5);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    for (index, search) in searches.iter().enumerate() {
        let places: Vec<_> = search
            .path
            .iter()
            .enumerate()
            .map(|(step, place)| (step as f64, place.1.log10()))
            .filter(|place| place.1 > -12.0)
            .collect();
        let line = PathElement::new(places.clone(), SERIES[index].stroke_width(4));
        chart.draw_series([line])?;
        let marks = places.into_iter().map(|place| EmptyElement::at(place) + marker(index));
        chart.draw_series(marks)?;
    }
    Ok(())
}
