//! Errors of both forms in single precision, over the condition.

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
        (
            "Gaussians from the information matrix",
            figure::plain(all.iter().map(|d| d.gaussians[0])),
        ),
        ("Gaussians from the square root", figure::plain(all.iter().map(|d| d.gaussians[1]))),
    ];
    Figure::new(900, columns, |drawing| {
        let x_axis = ("log\u{2081}\u{2080} of the root's condition number", 2.2..7.2, 6);
        let y_axis = ("log\u{2081}\u{2080} of the error of a variance", -6.0..3.2, 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for form in 0..2 {
            let curve = (0..=200).map(|k| 2.2 + 5.0 * f64::from(k) / 200.0);
            let curve = curve.map(|digits| (digits, bound(10_f64.powf(digits), form).log10()));
            chart.line(curve.filter(|(_, bound)| (-6.0..1.2).contains(bound)), SERIES[form], 2)?;
            let points = all.iter().zip(errors(form));
            let points: Vec<(f64, f64)> = points
                .filter_map(|(d, error)| Some((d.condition.log10(), error?.log10())))
                .collect();
            chart.line(points.iter().copied(), SERIES[form], 5)?;
            chart.marks(points, form)?;
            let (x, y) = (2.45, 2.75 - 0.7 * form as f64);
            chart.key(form, NAMES[form], (x, y), x + 0.12)?;
        }
        chart.write("thin: bounds for one rounding", (4.3, 0.9), figure::letters_right_of(INK))
    })
}
