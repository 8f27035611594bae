//! Beside the fence: Gauss-Newton leaves the minimum, Levenberg-Marquardt finds it.

use nalgebra::Vector2;
use vislam::least_squares::{Method, Options};

use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, powers};
use crate::least_squares::numbers::fence_start;
use crate::least_squares::worked::{self, FAR_FROM_FENCE, fence};

const STEPS: usize = 20;
const NAMES: [&str; 3] =
    ["Gauss-Newton, near", "Levenberg-Marquardt, near", "Levenberg-Marquardt, far"];

/// Where a search is, and the norm of its scaled gradient, after every iteration.
type Path = Vec<(Vector2<f64>, f64)>;

pub fn fence_figure() -> Figure {
    let gauss_newton = worked::unstopped(STEPS);
    let method = Method::LevenbergMarquardt { initial_damping: 1e-4 };
    let tight = Options { method, ..gauss_newton };
    let paths = [
        worked::path(&fence(), fence_start(), &gauss_newton),
        worked::path(&fence(), fence_start(), &tight),
        worked::path(&fence(), FAR_FROM_FENCE, &tight),
    ];
    let filled = |mut cells: Vec<String>| {
        cells.resize(STEPS + 1, String::new());
        cells
    };
    let across = |path: &Path| filled(decimals(4, path.iter().map(|(spot, _)| spot.y)));
    let gradient = |path: &Path| filled(powers(1, path.iter().map(|(_, gradient)| *gradient)));
    let columns = vec![
        ("iteration", (0..=STEPS).map(|step| step.to_string()).collect()),
        ("y of Gauss-Newton (m)", across(&paths[0])),
        ("its gradient", gradient(&paths[0])),
        ("y of Levenberg-Marquardt (m)", across(&paths[1])),
        ("its gradient", gradient(&paths[1])),
        ("y of Levenberg-Marquardt from afar (m)", across(&paths[2])),
        ("its gradient", gradient(&paths[2])),
    ];
    Figure::new(1180, columns, |drawing| {
        let (above, below) = drawing.split_vertically(580);
        across_the_fence(&above, &paths)?;
        gradients(&below, &paths)
    })
}

fn across_the_fence(drawing: &Drawing, paths: &[Path]) -> Drawn {
    let x_axis = ("iteration", -0.5..20.5, 6);
    let mut chart = figure::axes(drawing, x_axis, ("across the fence (m)", -0.1..1.15, 5))?;
    let minimum = worked::estimate(&fence()).y;
    chart.line([(-0.5, minimum), (20.5, minimum)], INK, 2)?;
    for (index, path) in paths.iter().enumerate() {
        let places = path.iter().enumerate().map(|(step, (spot, _))| (step as f64, spot.y));
        chart.line(places.clone(), SERIES[index], 4)?;
        chart.marks(places, index)?;
        let height = 1.06 - 0.14 * index as f64;
        chart.key(index, NAMES[index], (6.2, height), 6.7)?;
    }
    Ok(())
}

fn gradients(drawing: &Drawing, paths: &[Path]) -> Drawn {
    let x_axis = ("iteration", -0.5..20.5, 6);
    let y_axis = ("log\u{2081}\u{2080} of gradient", -12.0..3.0, 5);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    for (index, path) in paths.iter().enumerate() {
        let places =
            path.iter().enumerate().map(|(step, (_, gradient))| (step as f64, gradient.log10()));
        let drawn = places.filter(|place| place.1 > -12.0);
        chart.line(drawn.clone(), SERIES[index], 4)?;
        chart.marks(drawn, index)?;
    }
    Ok(())
}
