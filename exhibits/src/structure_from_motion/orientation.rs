//! One world laid upon another.

use nalgebra::{Rotation3, SVector, Vector3};
use vislam::manifold::so3;
use vislam::observability::Similarity;
use vislam::structure_from_motion::{ScaleFreedom, absolute_orientation};

use super::STATES;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Laid); 3] = [
        ("the scale by the second world", |pairs| {
            altered(laid(pairs), |found| found.scale = 1.0 / laid(&swapped(pairs)).scale)
        }),
        ("the rotation the other way", |pairs| {
            altered(laid(pairs), |found| found.rotation = found.rotation.inverse())
        }),
        ("means without scale", |pairs| {
            altered(laid(pairs), |found| {
                found.translation =
                    mean(pairs, |pair| pair.1) - found.rotation * mean(pairs, |pair| pair.0);
            })
        }),
    ];
    chapter.equation("laid-upon", laid_upon, laid, &mutants);
}

type Pair = (Vector3<f64>, Vector3<f64>);
type Pairs = [Pair];
type Laid = fn(&Pairs) -> Similarity;

fn laid(pairs: &Pairs) -> Similarity {
    absolute_orientation(pairs, ScaleFreedom::Free).expect("points beside a line")
}

fn swapped(pairs: &Pairs) -> Vec<Pair> {
    pairs.iter().map(|pair| (pair.1, pair.0)).collect()
}

fn mean(pairs: &Pairs, of: fn(&Pair) -> Vector3<f64>) -> Vector3<f64> {
    pairs.iter().map(of).sum::<Vector3<f64>>() / pairs.len() as f64
}

const POINTS: usize = 8;

/// What is left of all points after a similarity that is moved by seven numbers.
fn left(pairs: &Pairs, at: &Similarity, step: &SVector<f64, 7>) -> SVector<f64, { 3 * POINTS }> {
    let moved = Similarity {
        scale: at.scale * step[6].exp(),
        rotation: so3::retract(&at.rotation, &step.fixed_rows::<3>(3).into_owned()),
        translation: at.translation + step.fixed_rows::<3>(0),
    };
    SVector::from_fn(|row, _| {
        let (from, to) = pairs[row / 3];
        (moved.point(&from) - to)[row % 3]
    })
}

/// Steps of Gauss and Newton from a similarity.
fn by_steps(pairs: &Pairs, start: Similarity) -> Similarity {
    (0..30).fold(start, |at, _| {
        let slopes = differences(1e-5, |step| left(pairs, &at, &step));
        let gradient = slopes.tr_mul(&left(pairs, &at, &SVector::zeros()));
        let inverse = slopes.tr_mul(&slopes).try_inverse().expect("determined");
        let step = -inverse * gradient;
        Similarity {
            scale: at.scale * step[6].exp(),
            rotation: so3::retract(&at.rotation, &step.fixed_rows::<3>(3).into_owned()),
            translation: at.translation + step.fixed_rows::<3>(0),
        }
    })
}

fn entries(similarity: &Similarity) -> (f64, Rotation3<f64>, Vector3<f64>) {
    (similarity.scale, similarity.rotation, similarity.translation)
}

fn laid_upon(formula: Laid) -> Comparison {
    let against = "thirty steps of Gauss and Newton on the same sum";
    Comparison::relative(against, 1e-6).over(STATES, 4, |random| {
        let truth = Similarity {
            scale: random.logarithmic(0.3..3.0),
            rotation: random.rotation(1.5),
            translation: random.direction(4.0),
        };
        let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = (0..POINTS)
            .map(|_| {
                let from = random.point(2.0..6.0);
                let noise = Vector3::from_fn(|_, _| random.normal(0.1));
                (from, truth.point(&from) + noise)
            })
            .collect();
        (entries(&formula(&pairs)), entries(&by_steps(&pairs, truth)))
    })
}
