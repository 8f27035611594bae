//! The batch: what is fixed in it, and how sure it is of scale.

use nalgebra::{Matrix3, Rotation3, Vector1, Vector3};
use vislam::initialization::MotionOptions;
use vislam::manifold::so3;

use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};

const STATES: usize = 200;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Heading); 3] = [
        ("up in the world", |_, turn| turn.z),
        ("rotation transposed", |rotation, turn| (rotation * Vector3::z()).dot(turn)),
        ("all of the turn", |_, turn| turn.norm()),
    ];
    chapter.equation("batch-gauge", batch_gauge, heading, &mutants);

    let mutants: [(_, Sigma); 4] = [
        ("all directions", |way, spread| spread.trace().sqrt() / way.norm()),
        ("not the root", |way, spread| way.dot(&(spread * way)) / way.norm_squared()),
        ("not divided twice", |way, spread| way.dot(&(spread * way)).sqrt() / way.norm()),
        ("across the way", |way, spread| {
            let across = Matrix3::identity() - way * way.transpose() / way.norm_squared();
            (across * spread * across).trace().sqrt() / way.norm()
        }),
    ];
    chapter.equation("scale-sigma", scale_sigma, sigma, &mutants);
    numbers(chapter);
}

type Heading = fn(&Rotation3<f64>, &Vector3<f64>) -> f64;

/// What the gauge measures of a turn of the body.
fn heading(world_from_body: &Rotation3<f64>, turn: &Vector3<f64>) -> f64 {
    (world_from_body.inverse() * Vector3::z()).dot(turn)
}

fn batch_gauge(formula: Heading) -> Comparison {
    let against = "the vertical part of a turn of the world that does the same";
    Comparison::absolute(against, 1e-12, "rad").over(STATES, 91, |random| {
        let rotation = random.rotation(3.0);
        let angle = random.uniform(0.0..2.0);
        let about = random.direction(angle);
        let turned = Rotation3::new(about) * rotation;
        (formula(&rotation, &so3::log(&(rotation.inverse() * turned))), about.z)
    })
}

type Sigma = fn(&Vector3<f64>, &Matrix3<f64>) -> f64;

/// The standard deviation of a distance, as a part of it, from the covariance of its far end.
fn sigma(way: &Vector3<f64>, spread: &Matrix3<f64>) -> f64 {
    way.dot(&(spread * way)).sqrt() / way.norm_squared()
}

fn scale_sigma(formula: Sigma) -> Comparison {
    let against = "the covariance along the slope of the logarithm of the distance, by differences";
    Comparison::relative(against, 1e-7).over(STATES, 92, |random| {
        let length = random.logarithmic(0.1..10.0);
        let way = random.direction(length);
        let turn = random.rotation(3.0);
        let sizes = Vector3::from_fn(|_, _| random.logarithmic(1e-3..0.1).powi(2));
        let spread = turn * Matrix3::from_diagonal(&sizes) * turn.inverse();
        let slope =
            differences(1e-5 * length, |step: Vector3<f64>| Vector1::new((way + step).norm().ln()));
        (formula(&way, &spread), (slope * spread * slope.transpose()).x.sqrt())
    })
}

fn numbers(chapter: &mut Chapter) {
    let options = MotionOptions::default();
    chapter.number("scale_limit", 100.0 * options.scale_sigma, "%", 0);
    chapter.number("tilt_limit", options.tilt_sigma.to_degrees(), "°", 0);
}
