//! A weight between springs in a box: on a table, falling, and in a lift that starts.

use nalgebra::Vector3;
use plotters::element::{PathElement, Polygon, Rectangle, Text};
use plotters::style::Color;
use vislam::inertial::GRAVITY;
use vislam::simulation::{EulerAngles, Trajectory};

use crate::figure::{
    Drawing, Drawn, Figure, GRID, INK, MEASURED, SERIES, decimals, letters_around,
};

/// What happens to the box, and its acceleration upward in m/s².
const CASES: [(&str, f64); 3] = [("on a table", 0.0), ("falling", -9.81), ("a lift starts", 3.0)];

/// Where the middle of the boxes is, and half their size.
const MIDDLE: i32 = 300;
const HALF: i32 = 150;
/// Units of the drawing by which the weight sinks for one m/s².
const SAG: f64 = 6.0;

pub fn boxes() -> Figure {
    let columns = vec![
        ("case", CASES.map(|(name, _)| name.to_owned()).to_vec()),
        ("acceleration upward (m/s²)", decimals(2, CASES.map(|(_, up)| up))),
        ("reading upward (m/s²)", decimals(2, CASES.map(|(_, up)| reading(up)))),
    ];
    Figure::new(600, columns, |drawing| {
        for (index, (name, up)) in CASES.into_iter().enumerate() {
            one(drawing, 230 + 410 * index as i32, name, up)?;
        }
        Ok(())
    })
}

fn reading(up: f64) -> f64 {
    let motion = Trajectory::constant_acceleration(&(up * Vector3::z()), EulerAngles::default());
    motion.at(0.0).sample(&GRAVITY).accelerometer.z
}

fn one(drawing: &Drawing, x: i32, name: &str, up: f64) -> Drawn {
    let read = reading(up);
    let sunk = MIDDLE + (SAG * read).round() as i32;
    drawing.draw(&PathElement::new([(x - 80, MIDDLE), (x + 80, MIDDLE)], GRID.stroke_width(4)))?;
    for (from, to) in [(MIDDLE - HALF, sunk - 28), (sunk + 28, MIDDLE + HALF)] {
        drawing.draw(&PathElement::new(spring(x, from, to), INK.stroke_width(4)))?;
    }
    let weight = [(x - 45, sunk - 28), (x + 45, sunk + 28)];
    drawing.draw(&Rectangle::new(weight, SERIES[0].filled()))?;
    let (left, right, top, bottom) = (x - HALF, x + HALF, MIDDLE - HALF, MIDDLE + HALF);
    let walls = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
    drawing.draw(&PathElement::new(walls, INK.stroke_width(6)))?;
    if up == 0.0 {
        let top = MIDDLE + HALF + 6;
        drawing.draw(&PathElement::new([(x - 190, top), (x + 190, top)], INK.stroke_width(12)))?;
    } else {
        // A metre per second squared is ten units long.
        let tip = MIDDLE - (10.0 * up).round() as i32 - if up > 0.0 { 40 } else { -20 };
        let tail = MIDDLE + if up > 0.0 { 40 } else { -60 };
        arrow(drawing, x + HALF + 35, tail, tip)?;
    }
    drawing.draw(&Text::new(name.to_owned(), (x, 70), letters_around(INK)))?;
    let told = format!("reads {read:.2}");
    drawing.draw(&Text::new(told, (x, 540), letters_around(MEASURED)))?;
    Ok(())
}

fn spring(x: i32, from: i32, to: i32) -> Vec<(i32, i32)> {
    let turns = 8;
    let place = |k: i32| from + (to - from) * k / turns;
    let middle = (1..turns).map(|k| (x + if k % 2 == 0 { 26 } else { -26 }, place(k)));
    std::iter::once((x, from)).chain(middle).chain(std::iter::once((x, to))).collect()
}

fn arrow(drawing: &Drawing, x: i32, tail: i32, tip: i32) -> Drawn {
    let back = if tip < tail { 26 } else { -26 };
    drawing.draw(&PathElement::new([(x, tail), (x, tip + back)], SERIES[1].stroke_width(7)))?;
    let head = vec![(x, tip), (x - 16, tip + back), (x + 16, tip + back)];
    drawing.draw(&Polygon::new(head, SERIES[1].filled()))?;
    Ok(())
}
