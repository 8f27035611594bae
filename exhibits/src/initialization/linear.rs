//! Scale, velocity, bias and gravity in linear equations.

use nalgebra::Vector3;

use super::exact::{Row, Told, Unknowns};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

const MOTIONS: usize = 60;
const CAMERAS: usize = 6;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Left); 6] = [
        ("gravity points up", |row, x| left(row, &negated(x, 7))),
        ("sign of the bias", |row, x| left(row, &negated(x, 4))),
        ("velocity dropped", |row, x| left(row, x) + row.seconds * part(x, 1)),
        ("t² not halved", |row, x| left(row, x) - 0.5 * row.seconds * row.seconds * part(x, 7)),
        ("arm swings the other way", |row, x| left(row, x) - 2.0 * row.swung),
        ("centre of the body", |row, x| left(row, x) + row.swung),
    ];
    chapter.equation("align-row", align_row, left, &mutants);
}

type Left = fn(&Row, &Unknowns) -> Vector3<f64>;

fn part(x: &Unknowns, from: usize) -> Vector3<f64> {
    x.fixed_rows::<3>(from).into_owned()
}

fn negated(x: &Unknowns, from: usize) -> Unknowns {
    let mut x = *x;
    x.fixed_rows_mut::<3>(from).neg_mut();
    x
}

/// What the unknowns say of the forces.
fn left(row: &Row, x: &Unknowns) -> Vector3<f64> {
    let t = row.seconds;
    x[0] * row.moved
        - t * part(x, 1)
        - row.by_bias * part(x, 4)
        - 0.5 * t * t * part(x, 7)
        - row.swung
}

fn align_row(formula: Left) -> Comparison {
    let against = "forces on exact motions, summed twice by Simpson's rule";
    Comparison::absolute(against, 1e-7, "m").over(MOTIONS, 31, |random| {
        let told = Told::drawn(random, CAMERAS);
        let (rows, truth) = (told.rows(), told.truth());
        let (lefts, rights): (Vec<_>, Vec<_>) =
            rows.iter().map(|row| (formula(row, &truth), row.forces)).unzip();
        (lefts, rights)
    })
}
