//! The smallest variance in single precision, by three forms.

use crate::figure::{self, Draw, Figure, GRID, INK, letters_right_of, plain, powers};
use crate::filtering::digits::{CONDITIONS, ROUNDING, lost};

const NAMES: [&str; 3] = ["difference", "Joseph", "root"];

pub fn digits() -> Figure {
    let lost = lost();
    let of = |form: usize| powers(1, lost.iter().map(move |lost| lost.error[form]));
    let below_zero = |form: usize| plain(lost.iter().map(move |lost| lost.below_zero[form]));
    let columns = vec![
        ("condition of the covariance", powers(0, CONDITIONS)),
        ("relative error of the smallest variance: difference", of(0)),
        ("Joseph", of(1)),
        ("root", of(2)),
        ("below zero, of a hundred: difference", below_zero(0)),
        ("Joseph", below_zero(1)),
        ("root", below_zero(2)),
    ];
    Figure::new(1000, columns, |drawing| {
        let x_axis = ("condition of the covariance, power of ten", 1.7..10.3, 9);
        let y_axis = ("relative error, power of ten", -6.9..4.4, 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line([(1.7, 0.0), (10.3, 0.0)], INK, 2)?;
        chart.write("no digit left", (2.0, 0.35), letters_right_of(INK))?;
        let bounds: [fn(f64) -> f64; 2] = [|c| ROUNDING * c, |c| 2.0 * ROUNDING * c.sqrt()];
        for bound in bounds {
            chart.line(CONDITIONS.map(|c| (c.log10(), bound(c).log10())), GRID, 6)?;
        }
        for (form, name) in NAMES.into_iter().enumerate() {
            let points = CONDITIONS.into_iter().zip(lost);
            chart.marks(points.map(|(c, lost)| (c.log10(), lost.error[form].log10())), form)?;
            chart.key(form, name, (2.0, 3.8 - 0.9 * form as f64), 2.2)?;
        }
        Ok(())
    })
}
