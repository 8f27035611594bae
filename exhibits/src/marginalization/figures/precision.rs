//! Errors of both forms in single precision, over the condition.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, INK, SERIES, powers};
use crate::marginalization::digits::{all, bounds};

const NAMES: [&str; 2] = ["from the information matrix", "from the square root"];
/// One rounding in single precision.
pub const ROUNDING: f64 = 0.5 * f32::EPSILON as f64;

/// The bound of a form, as a relative change of a variance; nothing where there is none.
fn bound(condition: f64, form: usize) -> f64 {
    let [root, hessian] = bounds(ROUNDING, condition);
    let exists = ROUNDING * condition.powi(if form == 0 { 2 } else { 1 }) < 1.0;
    if exists { [hessian, root][form][1] - 1.0 } else { f64::NAN }
}

pub fn precision() -> Figure {
    let all = all();
    let errors = |form: usize| all.iter().map(move |d| d.errors[form]);
    let cells = |form: usize| {
        let cell = |error: Option<f64>| error.map_or("none".to_owned(), |e| format!("{e:.1e}"));
        errors(form).map(cell).collect()
    };
    let columns = vec![
        ("condition of the root", powers(1, all.iter().map(|d| d.condition))),
        ("largest error of a variance from the information matrix", cells(0)),
        ("from the square root", cells(1)),
        ("Gaussians from the information matrix", figure::plain(all.iter().map(|d| d.gaussians[0]))),
        ("Gaussians from the square root", figure::plain(all.iter().map(|d| d.gaussians[1]))),
    ];
    let ends = [all[0].condition / 2.0, all[all.len() - 1].condition * 2.0];
    Figure::new(900, columns, |drawing| {
        let x_axis = ("condition number of the root", (ends[0]..ends[1]).log_scale(), 5);
        let y_axis = ("largest error of a variance", (1e-7..1e4).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for form in 0..2 {
            let curve = figure::geometric(ends[0], ends[1] / ends[0], 200);
            let curve = curve.map(|condition| (condition, bound(condition, form)));
            let curve = curve.filter(|(_, bound)| (1e-7..2e2).contains(bound));
            chart.line(curve, SERIES[form], 2)?;
            let points = all.iter().zip(errors(form));
            let points: Vec<(f64, f64)> =
                points.filter_map(|(d, error)| Some((d.condition, error?))).collect();
            chart.line(points.iter().copied(), SERIES[form], 5)?;
            chart.marks(points, form)?;
            let (x, y) = (ends[0] * 1.6, 2e3 / 8.0_f64.powi(form as i32));
            chart.key(form, NAMES[form], (x, y), x * 1.4)?;
        }
        chart.write("thin: bounds for one rounding", (ends[0] * 2.24, 3e1), figure::letters_right_of(INK))
    })
}
