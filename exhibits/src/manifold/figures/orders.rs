//! A book turned about two axes, in both orders.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Rotation3, Vector3};
use plotters::element::{PathElement, Polygon, Text};
use plotters::style::Color;
use vislam::manifold::so3;

use crate::figure::{self, Drawing, Drawn, Figure, GRID, INK, SERIES, letters_around};

/// Half the width, thickness and height of the book.
const HALF: Vector3<f64> = Vector3::new(0.62, 0.16, 0.85);

/// Units of the drawing for a unit of the book.
const SCALE: f64 = 125.0;

struct Order {
    turns: [(&'static str, Vector3<f64>); 2],
}

impl Order {
    /// Both orders of a quarter turn about the line to the right and one about the vertical.
    fn both() -> [Self; 2] {
        let tip = ("tipped", -FRAC_PI_2 * Vector3::x());
        let spin = ("spun", FRAC_PI_2 * Vector3::z());
        [Self { turns: [tip, spin] }, Self { turns: [spin, tip] }]
    }

    /// The book before, between and after the turns, about axes of the room.
    fn stages(&self) -> [(String, Rotation3<f64>); 3] {
        let [(first, first_turn), (second, second_turn)] = &self.turns;
        let between = so3::exp(first_turn);
        [
            ("at first".to_owned(), Rotation3::identity()),
            ((*first).to_owned(), between),
            (format!("then {second}"), so3::exp(second_turn) * between),
        ]
    }
}

pub fn orders() -> Figure {
    let rows = Order::both().into_iter().flat_map(|order| {
        let name = format!("{} then {}", order.turns[0].0, order.turns[1].0);
        order.stages().map(|(stage, rotation)| {
            let mut row = vec![name.clone(), stage];
            let (cover, head) = (rotation * -Vector3::y(), rotation * Vector3::z());
            row.extend([cover, head].map(|direction| {
                let [x, y, z] = <[f64; 3]>::from(direction).map(|c| c.round() as i32);
                format!("({x} {y} {z})")
            }));
            row
        })
    });
    Figure {
        columns: vec!["order", "stage", "cover faces", "head points"],
        rows: rows.collect(),
        svg: figure::draw(900, |drawing| {
            for (index, order) in Order::both().iter().enumerate() {
                row(drawing, order, 190 + 450 * index as i32)?;
            }
            drawing.draw(&PathElement::new(vec![(60, 450), (1220, 450)], GRID.stroke_width(3)))?;
            Ok(())
        }),
    }
}

fn row(drawing: &Drawing, order: &Order, height: i32) -> Drawn {
    for (stage, (name, rotation)) in order.stages().iter().enumerate() {
        let middle = (220 + 420 * stage as i32, height);
        book(drawing, rotation, middle)?;
        let below = (middle.0, height + 200);
        drawing.draw(&Text::new(name.clone(), below, letters_around(INK)))?;
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
            let (across, along) =
                (Vector3::ith((axis + 1) % 3, 1.0), Vector3::ith((axis + 2) % 3, 1.0));
            let corner = |a: f64, b: f64| place(outward + a * across + b * along);
            let outline = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let face: Vec<_> = outline.iter().map(|&(a, b)| corner(a, b)).collect();
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
                for leaf in 1..4 {
                    let b = f64::from(leaf) / 2.0 - 1.0;
                    let edge = if axis == 0 {
                        [corner(b, -1.0), corner(b, 1.0)]
                    } else {
                        [corner(-1.0, b), corner(1.0, b)]
                    };
                    drawing.draw(&PathElement::new(edge.to_vec(), GRID.stroke_width(3)))?;
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
