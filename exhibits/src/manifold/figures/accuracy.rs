//! Digits that formulas lose at small angles and near a half turn.

use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};
use crate::manifold::accuracy::{
    LogErrors, exp_errors_near, jacobian_errors_near, log_errors_near, log_errors_near_half_turn,
};

/// Decimal logarithms of the angles and of their distances from π.
fn exponents() -> impl Iterator<Item = f64> {
    (0..=64).map(|k| -16.0 + 0.25 * f64::from(k))
}

/// The decimal logarithm of an error; no error at all is drawn below the rounding error.
fn size(error: f64) -> f64 {
    error.max(1e-17).log10()
}

/// Sizes of errors over the exponents, with a name, the number of a series or none for the
/// library, and the place of the name.
struct Curve {
    name: &'static str,
    series: Option<usize>,
    name_at: (f64, f64),
    sizes: Vec<(f64, f64)>,
}

pub fn accuracy() -> Figure {
    let (small, half) = (small_angles(), near_a_half_turn());
    let rows = (0..65).step_by(4).map(|k| {
        let mut row = vec![format!("{:.0}", small[0].sizes[k].0)];
        let curves = small.iter().chain(&half);
        row.extend(curves.map(|curve| format!("{:.1}", curve.sizes[k].1)));
        row
    });
    Figure {
        columns: vec![
            "angle (rad) as a power of ten",
            "error of the textbook's angle as a power of ten",
            "of its Jacobian",
            "of its corner Q",
            "of its log",
            "of its exp",
            "of the library",
            "of the textbook's log as far from a half turn",
            "of the library's there",
        ],
        rows: rows.collect(),
        svg: figure::draw(1520, |drawing| {
            let (above, below) = drawing.split_vertically(860);
            panel(&above, "angle (rad), power of ten", &small)?;
            panel(&below, "distance from a half turn (rad), power of ten", &half)
        }),
    }
}

fn small_angles() -> [Curve; 6] {
    let angles = || exponents().map(|exponent| (exponent, 10_f64.powf(exponent)));
    let logs: Vec<_> = angles().map(|(e, angle)| (e, log_errors_near(angle))).collect();
    let jacobians: Vec<_> = angles().map(|(e, angle)| (e, jacobian_errors_near(angle))).collect();
    let exps: Vec<_> = angles().map(|(_, angle)| exp_errors_near(angle)).collect();
    let of_logs = |sizes: Vec<f64>| logs.iter().map(|(e, _)| *e).zip(sizes).collect::<Vec<_>>();
    let all = logs.iter().zip(&jacobians).zip(&exps);
    let library =
        all.map(|(((_, l), (_, jacobian)), exp)| l.library.max(jacobian.library).max(exp.library));
    let curve = |name, series, name_at, errors: Vec<f64>| {
        let sizes = of_logs(errors.into_iter().map(size).collect());
        Curve { name, series, name_at, sizes }
    };
    [
        curve("angle", Some(0), (-5.2, -3.6), logs.iter().map(|l| l.1.textbook_angle).collect()),
        curve(
            "Jacobian",
            Some(1),
            (-13.6, -10.4),
            jacobians.iter().map(|j| j.1.textbook_diagonal).collect(),
        ),
        curve(
            "corner Q",
            Some(2),
            (-15.2, -5.4),
            jacobians.iter().map(|j| j.1.textbook_corner).collect(),
        ),
        curve("log", Some(3), (-9.6, -1.0), logs.iter().map(|l| l.1.textbook).collect()),
        curve("exp", Some(4), (-6.6, -17.1), exps.iter().map(|e| e.textbook).collect()),
        curve("the library", None, (-7.3, -14.4), library.collect()),
    ]
}

fn near_a_half_turn() -> [Curve; 2] {
    let errors: Vec<_> = exponents()
        .map(|exponent| (exponent, log_errors_near_half_turn(10_f64.powf(exponent))))
        .collect();
    let sizes = |error: fn(&LogErrors) -> f64| {
        errors.iter().map(|(exponent, errors)| (*exponent, size(error(errors)))).collect()
    };
    [
        Curve {
            name: "log",
            series: Some(3),
            name_at: (-4.6, -5.0),
            sizes: sizes(|errors| errors.textbook),
        },
        Curve {
            name: "the library",
            series: None,
            name_at: (-14.0, -14.3),
            sizes: sizes(|errors| errors.library),
        },
    ]
}

fn panel(drawing: &Drawing, title: &str, curves: &[Curve]) -> Drawn {
    let y_axis = ("error, power of ten", -17.9..1.0, 6);
    let mut chart = figure::axes(drawing, (title, -16.4..0.9, 8), y_axis)?;
    for Curve { name, series, name_at, sizes } in curves {
        let colour = series.map_or(INK, |index| SERIES[index]);
        chart.draw_series(LineSeries::new(sizes.clone(), colour.stroke_width(5)))?;
        if let Some(index) = *series {
            let marks = sizes.iter().skip(2 * index).step_by(8);
            chart.draw_series(marks.map(|place| EmptyElement::at(*place) + marker(index)))?;
        }
        chart.draw_series([Text::new(*name, *name_at, letters_right_of(colour))])?;
    }
    Ok(())
}
