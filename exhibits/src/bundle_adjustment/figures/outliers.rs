//! Wrong matches over many seeds.

use crate::bundle_adjustment::outliers::{Outcome, SEEDS, outcomes};
use crate::figure::{self, Draw, Drawing, Drawn, Figure, GRID, decimals, plain};

const NAMES: [&str; 3] = ["clean", "Huber", "least squares"];

pub fn outliers() -> Figure {
    let mut sorted = outcomes().to_vec();
    sorted.sort_by(|a, b| a[2].cameras_cm.total_cmp(&b[2].cameras_cm));
    let of = |way: usize, value: fn(&Outcome) -> f64| {
        decimals(2, sorted.iter().map(|ways| value(&ways[way])))
    };
    let columns = vec![
        ("scene in the order of the figure", plain(1..=SEEDS)),
        ("camera error clean (cm)", of(0, |outcome| outcome.cameras_cm)),
        ("with Huber (cm)", of(1, |outcome| outcome.cameras_cm)),
        ("with least squares (cm)", of(2, |outcome| outcome.cameras_cm)),
        ("RMSE of right matches clean (px)", of(0, |outcome| outcome.right_px)),
        ("with Huber (px)", of(1, |outcome| outcome.right_px)),
        ("with least squares (px)", of(2, |outcome| outcome.right_px)),
        ("RMSE of all matches with Huber (px)", of(1, |outcome| outcome.all_px)),
        ("with least squares (px)", of(2, |outcome| outcome.all_px)),
    ];
    Figure::new(1320, columns, |drawing| {
        let (above, below) = drawing.split_vertically(720);
        let titles = ("", "camera error (cm)");
        panel(&above, &sorted, titles, |outcome| outcome.cameras_cm, true)?;
        let titles = ("scene, by the error of least squares", "RMSE, right matches (px)");
        panel(&below, &sorted, titles, |outcome| outcome.right_px, false)
    })
}

fn panel(
    drawing: &Drawing,
    sorted: &[[Outcome; 3]],
    (x_title, y_title): (&str, &str),
    value: fn(&Outcome) -> f64,
    names: bool,
) -> Drawn {
    let highest = sorted.iter().flatten().map(value).fold(0.0_f64, f64::max);
    let top = if names { 1.3 * highest } else { 1.1 * highest };
    let x_axis = (x_title, 0.2..SEEDS as f64 + 0.8, 8);
    let mut chart = figure::axes(drawing, x_axis, (y_title, 0.0..top, 5))?;
    for (index, ways) in sorted.iter().enumerate() {
        let places = ways.each_ref().map(|outcome| (index as f64 + 1.0, value(outcome)));
        chart.line([places[1], places[2]], GRID, 6)?;
        for (way, place) in places.into_iter().enumerate() {
            chart.marks([place], way)?;
        }
    }
    for (way, name) in NAMES.iter().enumerate().filter(|_| names) {
        let (x, y) = (0.9 + 4.6 * way as f64, 0.92 * top);
        chart.key(way, name, (x, y), x + 0.45)?;
    }
    Ok(())
}
