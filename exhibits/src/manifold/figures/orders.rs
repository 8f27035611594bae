//! A book turned about two axes, in both orders.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Rotation3, Vector3};
use plotters::element::{PathElement, Polygon, Text};
use plotters::style::Color;
use vislam::manifold::so3;

use crate::figure::{Drawing, Drawn, Figure, GRID, INK, SERIES, letters_around};

/// Half the width, thickness and height of the book.
const HALF: Vector3<f64> = Vector3::new(0.62, 0.16, 0.85);

/// Units of the drawing for a unit of the book.
const SCALE: f64 = 125.0;

/// A quarter turn, with what it does to the book.
type Turn = (&'static str, Vector3<f64>);

const TIP: Turn = ("tipped", Vector3::new(-FRAC_PI_2, 0.0, 0.0));
const SPIN: Turn = ("spun", Vector3::new(0.0, 0.0, FRAC_PI_2));

/// The turns about the line to the right and about the vertical, in both orders.
const ORDERS: [[Turn; 2]; 2] = [[TIP, SPIN], [SPIN, TIP]];

/// The book before, between and after the turns, about axes of the room.
fn stages(
    [(first, first_turn), (second, second_turn)]: [Turn; 2],
) -> [(String, Rotation3<f64>); 3] {
    let between = so3::exp(&first_turn);
    [
        ("at first".to_owned(), Rotation3::identity()),
        (first.to_owned(), between),
        (format!("then {second}"), so3::exp(&second_turn) * between),
    ]
}

pub fn orders() -> Figure {
    let all = ORDERS.map(stages).concat();
    let names = ORDERS.map(|[(first, _), (second, _)]| vec![format!("{first} then {second}"); 3]);
    let directions = |of: Vector3<f64>| {
        let cell = |(_, rotation): &(String, Rotation3<f64>)| {
            let [x, y, z] = <[f64; 3]>::from(rotation * of).map(|c| c.round() as i32);
            format!("({x} {y} {z})")
        };
        all.iter().map(cell).collect()
    };
    let columns = vec![
        ("order", names.concat()),
        ("stage", all.iter().map(|(stage, _)| stage.clone()).collect()),
        ("cover faces", directions(-Vector3::y())),
        ("head points", directions(Vector3::z())),
    ];
    Figure::new(900, columns, |drawing| {
        for (index, order) in ORDERS.into_iter().enumerate() {
            row(drawing, stages(order), 190 + 450 * index as i32)?;
        }
        drawing.draw(&PathElement::new(vec![(60, 450), (1220, 450)], GRID.stroke_width(3)))?;
        Ok(())
    })
}

fn row(drawing: &Drawing, stages: [(String, Rotation3<f64>); 3], height: i32) -> Drawn {
    for (stage, (name, rotation)) in stages.into_iter().enumerate() {
        let x = 220 + 420 * stage as i32;
        book(drawing, &rotation, (x, height))?;
        drawing.draw(&Text::new(name, (x, height + 200), letters_around(INK)))?;
    }
    Ok(())
}

/// The six faces by their outward directions; the reader stands in front, on the side of −y.
fn book(drawing: &Drawing, rotation: &Rotation3<f64>, middle: (i32, i32)) -> Drawn {
    let towards_reader = Vector3::new(0.42, -1.0, 0.48).normalize();
    let right = towards_reader.cross(&Vector3::z()).normalize() * -1.0;
    let up = towards_reader.cross(&right);
    let place = |point: Vector3<f64>| {
        let turned = rotation * point.component_mul(&HALF);
        let (x, y) = (turned.dot(&right), turned.dot(&up));
        (middle.0 + (SCALE * x).round() as i32, middle.1 - (SCALE * y).round() as i32)
    };
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let outward = Vector3::ith(axis, sign);
            if (rotation * outward).dot(&towards_reader) < 1e-6 {
                continue;
            }
            let [across, along] = [1, 2].map(|next| Vector3::ith((axis + next) % 3, 1.0));
            let corner = |a: f64, b: f64| place(outward + a * across + b * along);
            let face =
                vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            let colour = match (axis, sign < 0.0) {
                (1, true) => Some(SERIES[0].mix(0.75)),
                (1, false) => Some(SERIES[0].mix(0.3)),
                (0, true) => Some(SERIES[1].mix(0.85)),
                _ => None,
            };
            if let Some(colour) = colour {
                drawing.draw(&Polygon::new(face.clone(), colour.filled()))?;
            }
            if axis == 1 && sign < 0.0 {
                cover(drawing, &place)?;
            } else if colour.is_none() {
                for leaf in [-0.5, 0.0, 0.5] {
                    let end = |b| if axis == 0 { corner(leaf, b) } else { corner(b, leaf) };
                    let edge = vec![end(-1.0), end(1.0)];
                    drawing.draw(&PathElement::new(edge, GRID.stroke_width(3)))?;
                }
            }
            let closed = [face.as_slice(), &face[..1]].concat();
            drawing.draw(&PathElement::new(closed, INK.stroke_width(4)))?;
        }
    }
    Ok(())
}

/// A title above and a disc below, so that one sees where the head of the book is.
fn cover(drawing: &Drawing, place: &impl Fn(Vector3<f64>) -> (i32, i32)) -> Drawn {
    let on_cover = |x: f64, z: f64| place(Vector3::new(x, -1.0, z));
    let title = [(-0.65, 0.45), (0.65, 0.45), (0.65, 0.7), (-0.65, 0.7)];
    let title: Vec<_> = title.iter().map(|&(x, z)| on_cover(x, z)).collect();
    drawing.draw(&Polygon::new(title, INK.filled()))?;
    let disc = (0..24).map(|k| {
        let angle = TAU * f64::from(k) / 24.0;
        on_cover(0.34 * angle.cos(), -0.35 + 0.25 * angle.sin())
    });
    drawing.draw(&Polygon::new(disc.collect::<Vec<_>>(), INK.filled()))?;
    Ok(())
}
