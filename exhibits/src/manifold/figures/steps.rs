//! Eight small changes of a rotation vector, and what they do to the rotation.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};
use plotters::element::{Circle, Cross, Text};
use plotters::style::Color;
use vislam::manifold::so3;

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, GRID, INK, SERIES, decimals, letters_around,
    letters_right_of, plain,
};

/// A turn of 2.2 rad about an upright axis that leans a little.
const PHI: Vector3<f64> = Vector3::new(0.5, 0.0, 2.142_428_528_562_855);

/// The length of every change, in radians.
const LENGTH: f64 = 0.25;

const COUNT: i32 = 8;

/// The change of the rotation vector, what it does, and what the right Jacobian says, as small
/// vectors in the frame of the turned body, across its z axis.
struct Step {
    change: Vector2<f64>,
    truth: Vector2<f64>,
    corrected: Vector2<f64>,
}

impl Step {
    fn of(direction: f64) -> Self {
        let change = LENGTH * Vector3::new(direction.cos(), direction.sin(), 0.0);
        let truth = so3::local(&so3::exp(&PHI), &so3::exp(&(PHI + change)));
        let corrected = so3::right_jacobian(&PHI) * change;
        Self { change: change.xy(), truth: truth.xy(), corrected: corrected.xy() }
    }
}

pub fn steps() -> Figure {
    let directions = (0..COUNT).map(|k| TAU * f64::from(k) / f64::from(COUNT));
    let steps: Vec<Step> = directions.map(Step::of).collect();
    let column = |of: fn(&Step) -> f64| decimals(4, steps.iter().map(of));
    let columns = vec![
        ("step", plain(1..=COUNT)),
        ("change x (rad)", column(|step| step.change.x)),
        ("change y (rad)", column(|step| step.change.y)),
        ("body turns by x (rad)", column(|step| step.truth.x)),
        ("body turns by y (rad)", column(|step| step.truth.y)),
        ("Jacobian says x (rad)", column(|step| step.corrected.x)),
        ("Jacobian says y (rad)", column(|step| step.corrected.y)),
    ];
    Figure::new(820, columns, |drawing| {
        let (panels, legend) = drawing.split_vertically(700);
        let (left, right) = panels.split_horizontally(690);
        panel(&left, "step δ taken as it is", &steps, |step| step.change, 3)?;
        panel(&right, "step corrected, J δ", &steps, |step| step.corrected, 0)?;
        key(&legend)
    })
}

fn panel(
    drawing: &Drawing,
    title: &str,
    steps: &[Step],
    said: fn(&Step) -> Vector2<f64>,
    ticks: usize,
) -> Drawn {
    let (heading, area) = drawing.split_vertically(70);
    let middle = if ticks == 0 { 310 } else { 400 };
    heading.draw(&Text::new(title.to_owned(), (middle, 45), letters_around(INK)))?;
    let y_title = if ticks == 0 { "" } else { "about y (rad)" };
    let x_axis = ("about x (rad)", -0.34..0.34, 3);
    let mut chart = figure::axes(&area, x_axis, (y_title, -0.34..0.34, ticks))?;
    let outline = |place: fn(&Step) -> Vector2<f64>| {
        let round = (0..=72).map(|k| Step::of(TAU * f64::from(k) / 72.0));
        round.map(move |step| (place(&step).x, place(&step).y))
    };
    chart.line(outline(|step| step.truth), GRID, 4)?;
    chart.line(outline(said), SERIES[1], 3)?;
    for (index, step) in steps.iter().enumerate() {
        let (truth, said) = (step.truth, said(step));
        chart.dots([(truth.x, truth.y)], 14, SERIES[0])?;
        chart.draw_series([Cross::new((said.x, said.y), 16, SERIES[1].stroke_width(6))])?;
        let number = (index + 1).to_string();
        let outside = said * (1.0 + 0.055 / said.norm());
        chart.write(&number, (outside.x, outside.y), letters_around(SERIES[1]))?;
        let inside = truth * (1.0 - 0.055 / truth.norm());
        chart.write(&number, (inside.x, inside.y), letters_around(SERIES[0]))?;
    }
    Ok(())
}

fn key(drawing: &Drawing) -> Drawn {
    drawing.draw(&Circle::new((190, 45), 14, SERIES[0].filled()))?;
    drawing.draw(&Text::new("what the body does", (220, 45), letters_right_of(INK)))?;
    drawing.draw(&Cross::new((690, 45), 16, SERIES[1].stroke_width(6)))?;
    drawing.draw(&Text::new("what is said of it", (720, 45), letters_right_of(INK)))?;
    Ok(())
}
