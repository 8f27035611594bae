//! Three kernels: cost, influence, weight, and what they make of one bad reading.

use plotters::element::{EmptyElement, Text};
use vislam::least_squares::Kernel;

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, SERIES, decimals, letters_right_of, marker, plain,
};
use crate::least_squares::robust::{self, KERNELS};

/// What a panel shows over the length of the residual.
type Quantity = fn(&Kernel, f64) -> f64;

pub fn kernels() -> Figure {
    let norms = || (0..=48).map(|step| 0.25 * f64::from(step));
    let column = |quantity: Quantity, kernel: usize| {
        decimals(3, norms().map(|norm| quantity(&KERNELS[kernel], norm)))
    };
    let columns = vec![
        ("length s (sigma)", plain(norms())),
        ("cost: squares", column(Kernel::cost, 0)),
        ("cost: Huber", column(Kernel::cost, 1)),
        ("cost: Cauchy", column(Kernel::cost, 2)),
        ("influence: squares", column(Kernel::influence, 0)),
        ("influence: Huber", column(Kernel::influence, 1)),
        ("influence: Cauchy", column(Kernel::influence, 2)),
        ("weight: squares", column(Kernel::weight, 0)),
        ("weight: Huber", column(Kernel::weight, 1)),
        ("weight: Cauchy", column(Kernel::weight, 2)),
        ("shift: squares", column(robust::shift, 0)),
        ("shift: Huber", column(robust::shift, 1)),
        ("shift: Cauchy", column(robust::shift, 2)),
    ];
    Figure::new(1180, columns, |drawing| {
        let (above, below) = drawing.split_vertically(590);
        let (cost, influence) = above.split_horizontally(640);
        let (weight, shift) = below.split_horizontally(640);
        let (length, slope) = (("length s (\u{3c3})", 6.0), "influence \u{3c1}\u{2032}(s)");
        panel(&cost, Kernel::cost, length, ("cost \u{3c1}(s)", 10.0))?;
        panel(&influence, Kernel::influence, length, (slope, 4.0))?;
        panel(&weight, Kernel::weight, length, ("weight \u{3c1}\u{2032}(s)/s", 1.2))?;
        let reading = ("bad reading at (\u{3c3})", 12.0);
        panel(&shift, robust::shift, reading, ("shift (\u{3c3})", 1.0))?;
        for (index, name) in ["squares", "Huber", "Cauchy"].into_iter().enumerate() {
            let y = 60 + 50 * index as i32;
            drawing.draw(&(EmptyElement::at((190, y)) + marker(index)))?;
            drawing.draw(&Text::new(name, (220, y), letters_right_of(SERIES[index])))?;
        }
        Ok(())
    })
}

fn panel(
    drawing: &Drawing,
    quantity: Quantity,
    (x_title, x_end): (&str, f64),
    (y_title, y_end): (&str, f64),
) -> Drawn {
    let mut chart = figure::axes(drawing, (x_title, 0.0..x_end, 4), (y_title, 0.0..y_end, 4))?;
    for (index, kernel) in KERNELS.iter().enumerate() {
        let norms = (0..=120).map(|step| x_end * f64::from(step) / 120.0);
        let curve = norms.map(|norm| (norm, quantity(kernel, norm)));
        let curve: Vec<_> = curve.take_while(|place| place.1 <= y_end).collect();
        chart.line(curve.iter().copied(), SERIES[index], 5)?;
        chart.marks(curve.into_iter().skip(24 + 8 * index).step_by(30), index)?;
    }
    Ok(())
}
