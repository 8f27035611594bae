//! The smallest variance in single precision, by three forms.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, GRID, INK, letters_right_of, powers};
use crate::filtering::digits::{CONDITIONS, ROUNDING, lost};

const NAMES: [&str; 3] = ["difference", "Joseph", "root"];

pub fn digits() -> Figure {
    let lost = lost();
    let of = |form: usize| powers(1, lost.iter().map(move |lost| lost[form]));
    let columns = vec![
        ("condition of the covariance", powers(0, CONDITIONS)),
        ("relative error of the smallest variance: difference", of(0)),
        ("Joseph", of(1)),
        ("root", of(2)),
    ];
    Figure::new(1000, columns, |drawing| {
        let x_axis = ("condition of the covariance", (60.0..2e10).log_scale(), 9);
        let y_axis = ("relative error", (1e-8..3e4).log_scale(), 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line([(60.0, 1.0), (2e10, 1.0)], INK, 2)?;
        chart.write("no digit left", (90.0, 2.2), letters_right_of(INK))?;
        let bounds: [fn(f64) -> f64; 2] = [|c| ROUNDING * c, |c| 2.0 * ROUNDING * c.sqrt()];
        for bound in bounds {
            chart.line(CONDITIONS.map(|c| (c, bound(c))), GRID, 6)?;
        }
        for (form, name) in NAMES.into_iter().enumerate() {
            chart.marks(CONDITIONS.into_iter().zip(lost.iter().map(|lost| lost[form])), form)?;
            chart.key(form, name, (90.0, 3e3 / 7.0_f64.powi(form as i32)), 130.0)?;
        }
        Ok(())
    })
}
