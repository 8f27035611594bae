//! How far a sensor drifts that nobody corrects, at rest and in flight.

use plotters::coord::combinators::IntoLogRange;
use vislam::simulation::Trajectory;

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, geometric, letters_right_of,
};
use crate::inertial::drift::{TIMES, drifted, expected, sources};

type Series = [[f64; TIMES.len()]; 4];

pub fn drift() -> Figure {
    let motions = [Trajectory::hover(), Trajectory::figure_eight()];
    let found = motions.map(|motion| sources().map(|source| drifted(&source, &motion)));
    let each = || sources().into_iter().flat_map(|source| TIMES.map(|t| (source, t)));
    let columns = vec![
        ("source", each().map(|(source, _)| source.name.to_owned()).collect()),
        ("time (s)", each().map(|(_, t)| format!("{t}")).collect()),
        ("formula (m)", decimals(3, each().map(|(source, t)| expected(&source, t)))),
        ("at rest (m)", decimals(3, found[0].concat())),
        ("in flight (m)", decimals(3, found[1].concat())),
    ];
    Figure::new(1620, columns, |drawing| {
        let (above, below) = drawing.split_vertically(860);
        panel(&above, "", "at rest", &found[0])?;
        panel(&below, "time (s)", "in flight", &found[1])
    })
}

fn panel(drawing: &Drawing, x_title: &str, name: &str, found: &Series) -> Drawn {
    let with_names = x_title.is_empty();
    let high = if with_names { 2e5 } else { 2e3 };
    let y_axis = ("drift (m)", (4e-4..high).log_scale(), 4);
    let mut chart = figure::axes(drawing, (x_title, (0.8..120.0).log_scale(), 3), y_axis)?;
    for (index, source) in sources().into_iter().enumerate() {
        chart.line(
            geometric(1.0, 60.0, 40).map(|t| (t, expected(&source, t))),
            SERIES[index],
            4,
        )?;
        chart.marks(TIMES.into_iter().zip(found[index]), index)?;
        if with_names {
            chart.key(index, source.name, (1.0, 6e4 / 6_f64.powi(index as i32)), 1.14)?;
        }
    }
    chart.write(name, (25.0, 2e-3), letters_right_of(INK))
}
