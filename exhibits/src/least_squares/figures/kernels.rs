//! Three kernels: cost, influence, weight, and what they make of one bad reading.

use plotters::element::{EmptyElement, PathElement, Text};
use plotters::style::Color;
use vislam::least_squares::Kernel;

use crate::figure::{self, Drawing, Drawn, Figure, SERIES, letters_right_of, marker};
use crate::least_squares::robust::{self, KERNELS};

const NAMES: [&str; 3] = ["squares", "Huber", "Cauchy"];

/// What a panel shows over the length of the residual.
type Quantity = fn(&Kernel, f64) -> f64;

pub fn kernels() -> Figure {
    let quantities: [Quantity; 4] =
        [Kernel::cost, Kernel::influence, Kernel::weight, robust::shift];
    let rows = (0..=48).map(|step| {
        let norm = 0.25 * f64::from(step);
        let mut row = vec![format!("{norm}")];
        for quantity in quantities {
            row.extend(KERNELS.iter().map(|kernel| format!("{:.3}", quantity(kernel, norm))));
        }
        row
    });
    Figure {
        columns: vec![
            "length s (sigma)",
            "cost: squares",
            "cost: Huber",
            "cost: Cauchy",
            "influence: squares",
            "influence: Huber",
            "influence: Cauchy",
            "weight: squares",
            "weight: Huber",
            "weight: Cauchy",
            "shift: squares",
            "shift: Huber",
            "shift: Cauchy",
        ],
        rows: rows.collect(),
        svg: figure::draw(1180, |drawing| {
            let (above, below) = drawing.split_vertically(590);
            let (cost, influence) = above.split_horizontally(640);
            let (weight, shift) = below.split_horizontally(640);
            panel(&cost, Kernel::cost, ("length s (\u{3c3})", 6.0), ("cost \u{3c1}(s)", 10.0))?;
            panel(
                &influence,
                Kernel::influence,
                ("length s (\u{3c3})", 6.0),
                ("influence \u{3c1}\u{2032}(s)", 4.0),
            )?;
            panel(
                &weight,
                Kernel::weight,
                ("length s (\u{3c3})", 6.0),
                ("weight \u{3c1}\u{2032}(s)/s", 1.2),
            )?;
            panel(
                &shift,
                robust::shift,
                ("bad reading at (\u{3c3})", 12.0),
                ("shift (\u{3c3})", 1.0),
            )?;
            for (index, (name, place)) in
                NAMES.into_iter().zip([(190, 60), (190, 110), (190, 160)]).enumerate()
            {
                let beside = (place.0 + 30, place.1);
                drawing.draw(&(EmptyElement::at(place) + marker(index)))?;
                drawing.draw(&Text::new(name, beside, letters_right_of(SERIES[index])))?;
            }
            Ok(())
        }),
    }
}

fn panel(
    drawing: &Drawing,
    quantity: Quantity,
    (x_title, x_end): (&str, f64),
    (y_title, y_end): (&str, f64),
) -> Drawn {
    let mut chart = figure::axes(drawing, (x_title, 0.0..x_end, 4), (y_title, 0.0..y_end, 4))?;
    for (index, kernel) in KERNELS.iter().enumerate() {
        let curve = (0..=120).map(|step| {
            let norm = x_end * f64::from(step) / 120.0;
            (norm, quantity(kernel, norm))
        });
        let curve: Vec<_> = curve.take_while(|place| place.1 <= y_end).collect();
        let marks = curve.iter().skip(24 + 8 * index).step_by(30).copied();
        let marks = marks.map(|place| EmptyElement::at(place) + marker(index)).collect::<Vec<_>>();
        chart.draw_series([PathElement::new(curve, SERIES[index].stroke_width(5))])?;
        chart.draw_series(marks)?;
    }
    Ok(())
}
