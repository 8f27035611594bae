//! Right matches that agree with each model, and which model is chosen.

use plotters::element::Circle;
use plotters::style::Color;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around, letters_right_of};
use crate::robust_two_view::selected::{MODELS, NAMES, all};

pub fn agree() -> Figure {
    let all = all();
    let rows = || (0..4).flat_map(|pair| (0..3).map(move |model| (pair, model)));
    let columns = vec![
        ("pictures of", rows().map(|(pair, _)| NAMES[pair].to_owned()).collect()),
        ("model", rows().map(|(_, model)| MODELS[model].to_owned()).collect()),
        ("right ones that agree (%)", decimals(0, rows().map(|(p, m)| 100.0 * all[p].right[m]))),
        ("wrong ones that agree (%)", decimals(0, rows().map(|(p, m)| 100.0 * all[p].wrong[m]))),
        (
            "chosen",
            rows().map(|(p, m)| if all[p].chosen == m { "yes" } else { "" }.to_owned()).collect(),
        ),
    ];
    Figure::new(860, columns, |drawing| {
        let axis = ("right matches that agree (%)", 0.0..140.0, 6);
        let mut chart = figure::axes(drawing, ("", 0.4..4.6, 0), axis)?;
        for (pair, judged) in all.iter().enumerate() {
            let middle = (pair + 1) as f64;
            chart.write(NAMES[pair], (middle, 114.0), letters_around(INK))?;
            for (model, part) in judged.right.into_iter().enumerate() {
                let at = (middle + 0.24 * (model as f64 - 1.0), 100.0 * part);
                chart.line([(at.0, 0.0), at], SERIES[model], 8)?;
                chart.marks([at], model)?;
                if judged.chosen == model {
                    chart.draw_series([Circle::new(at, 27, INK.stroke_width(4))])?;
                }
            }
        }
        for (model, name) in MODELS.into_iter().enumerate() {
            let x = 0.5 + 0.95 * model as f64;
            chart.key(model, name, (x, 130.0), x + 0.07)?;
        }
        chart.draw_series([Circle::new((3.55, 130.0), 20, INK.stroke_width(4))])?;
        chart.write("chosen", (3.68, 130.0), letters_right_of(INK))
    })
}
