//! A quadratic form on a sphere.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use vislam::initialization::minima_on_sphere;

use crate::chapter::Chapter;
use crate::comparison::{Comparison, inverse};
use crate::random::Random;

const FORMS: usize = 200;
/// The radius of the sphere.
const LENGTH: f64 = 9.81;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Least); 4] = [
        ("the unconstrained minimum, brought to the sphere", |form| {
            let free = inverse(form.square) * form.target;
            free * (LENGTH / free.norm())
        }),
        ("sign of the linear part", |form| least(&Form { target: -form.target, ..*form })),
        ("the other end of the spectrum", |form| {
            -least(&Form { square: -form.square, target: -form.target })
        }),
        ("along the least eigenvector", |form| {
            let eigen = SymmetricEigen::new(form.square);
            let axis = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
            LENGTH * axis * axis.dot(&form.target).signum()
        }),
    ];
    chapter.equation("sphere-condition", sphere_condition, least, &mutants);

    let mutants: [(_, Gap); 3] = [
        ("multiplier dropped", |form, _, off| off.dot(&(form.square * off))),
        ("sign of the multiplier", |form, mu, off| {
            off.dot(&((form.square - mu * Matrix3::identity()) * off))
        }),
        ("twice", |form, mu, off| 2.0 * gap(form, mu, off)),
    ];
    chapter.equation("sphere-gap", sphere_gap, gap, &mutants);
}

/// The function gᵀ S g − 2 hᵀ g.
#[derive(Clone, Copy)]
struct Form {
    square: Matrix3<f64>,
    target: Vector3<f64>,
}

impl Form {
    fn drawn(random: &mut Random) -> Self {
        let turn = random.rotation(PI);
        let values = Vector3::from_fn(|_, _| random.logarithmic(1e-2..10.0));
        let square = turn * Matrix3::from_diagonal(&values) * turn.inverse();
        let size = LENGTH * random.logarithmic(1e-2..10.0);
        Self { square: 0.5 * (square + square.transpose()), target: random.direction(size) }
    }

    fn at(&self, g: &Vector3<f64>) -> f64 {
        g.dot(&(self.square * g)) - 2.0 * self.target.dot(g)
    }
}

type Least = fn(&Form) -> Vector3<f64>;

fn least(form: &Form) -> Vector3<f64> {
    minima_on_sphere(&form.square, &form.target, LENGTH)
        .map_or(Vector3::repeat(f64::NAN), |(least, _)| least.at)
}

fn sphere_condition(formula: Least) -> Comparison {
    let against = "the least value on a grid over the sphere, refined";
    Comparison::relative(against, 1e-9).over(FORMS, 33, |random| {
        let form = Form::drawn(random);
        let size = form.square.norm() * LENGTH * LENGTH + form.target.norm() * LENGTH;
        let found = form.at(&formula(&form));
        ((found + size) / size, (form.at(&searched(&form)) + size) / size)
    })
}

/// Where the function is least, by trying directions: a grid over all, then ever finer ones about the best.
fn searched(form: &Form) -> Vector3<f64> {
    let place = |polar: f64, azimuth: f64| {
        let (sin, cos) = polar.sin_cos();
        LENGTH * Vector3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
    };
    let mut best = place(0.0, 0.0);
    for polar in 0..=60 {
        for azimuth in 0..120 {
            let tried = place(f64::from(polar) * PI / 60.0, f64::from(azimuth) * TAU / 120.0);
            if form.at(&tried) < form.at(&best) {
                best = tried;
            }
        }
    }
    let mut width = 0.1 * LENGTH;
    while width > 1e-9 {
        let around = Vector3::new(best.z, best.x, best.y).cross(&best).normalize();
        let sides = [around, best.cross(&around).normalize()];
        let tried = sides.iter().flat_map(|side| [best + width * side, best - width * side]);
        let better =
            tried.map(|at| at * (LENGTH / at.norm())).find(|at| form.at(at) < form.at(&best));
        match better {
            Some(at) => best = at,
            None => width *= 0.5,
        }
    }
    best
}

/// Takes μ, and a place on the sphere less the one where (S + μ I) g = h.
type Gap = fn(&Form, f64, &Vector3<f64>) -> f64;

fn gap(form: &Form, mu: f64, off: &Vector3<f64>) -> f64 {
    off.dot(&((form.square + mu * Matrix3::identity()) * off))
}

fn sphere_gap(formula: Gap) -> Comparison {
    let against = "the values of the function at two places of the sphere";
    Comparison::absolute(against, 1e-9, "").over(FORMS, 34, |random| {
        let square = Form::drawn(random).square;
        let (here, there) = (random.direction(LENGTH), random.direction(LENGTH));
        let mu = random.uniform(-10.0..10.0);
        let form = Form { square, target: (square + mu * Matrix3::identity()) * here };
        (formula(&form, mu, &(there - here)), form.at(&there) - form.at(&here))
    })
}
