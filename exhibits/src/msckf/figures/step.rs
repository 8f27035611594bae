//! One correction, the first step of an adjustment, and where the adjustment ends.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{Circle, EmptyElement};

use crate::figure::{self, Draw, Figure, INK, SERIES, letters_right_of, plain, powers};
use crate::msckf::passing::{Pass, SEED, STEPS, UNCERTAIN};
use plotters::style::Color;

/// What is nearer than this is there.
const LEAST: f64 = 1e-4;

pub fn step() -> Figure {
    let passes = UNCERTAIN.map(|uncertain| Pass::new(uncertain, SEED));
    let ways = passes.each_ref().map(Pass::ways);
    let corrected = passes.each_ref().map(|pass| {
        let steps = pass.adjusted(40);
        pass.apart(&pass.corrected().0, &steps[steps.len() - 1])
    });
    let of = |which: usize| powers(2, ways[which].iter().copied());
    // The filter takes one step.
    let mut rings = vec![String::new(); STEPS + 1];
    rings[1] = powers(2, corrected).join(", ");
    let columns = vec![
        ("steps", plain(0..=STEPS)),
        ("from the end, poses known to 1 cm (sigmas)", of(0)),
        ("to 4 cm (sigmas)", of(1)),
        ("to 16 cm (sigmas)", of(2)),
        ("the filter's correction, to 1 cm, 4 cm and 16 cm (sigmas)", rings),
    ];
    Figure::new(860, columns, |drawing| {
        let x_axis = ("steps of the adjustment", -0.3..STEPS as f64 + 0.3, 5);
        let y_axis = ("distance from its end (sigmas)", (LEAST..3e3).log_scale(), 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, (ways, uncertain)) in ways.iter().zip(UNCERTAIN).enumerate() {
            let places = ways.iter().enumerate().map(|(at, way)| (at as f64, *way));
            let shown: Vec<(f64, f64)> = places.filter(|(_, way)| *way > LEAST).collect();
            chart.line(shown.iter().copied(), SERIES[index], 4)?;
            chart.marks(shown, index)?;
            let height = 1e3 / 4_f64.powi(index as i32);
            let name = format!("poses known to {:.0} cm", 100.0 * uncertain);
            chart.key(index, &name, (2.0, height), 2.15)?;
        }
        for way in corrected {
            let ring = EmptyElement::at((1.0, way)) + Circle::new((0, 0), 24, INK.stroke_width(4));
            chart.draw_series([ring])?;
        }
        let height = 1e3 / 4_f64.powi(3);
        let ring = EmptyElement::at((2.0, height)) + Circle::new((0, 0), 22, INK.stroke_width(4));
        chart.draw_series([ring])?;
        chart.write("correction of the filter", (2.15, height), letters_right_of(INK))
    })
}
