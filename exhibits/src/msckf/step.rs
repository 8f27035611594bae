//! The correction by a track, against the problem that keeps its landmark.

use nalgebra::{DMatrix, DVector};
use vislam::filtering::{Form, correct, innovation_squared};

use super::TRACKS;
use super::draws::{Linear, Track, covariance, least, nothing, stacked};
use super::track::eliminated;
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Eliminated = eliminated;
    let mutants: [(_, Eliminated); 4] = [
        ("added and not subtracted", |linear| {
            let Linear { by_poses: x, residual: r, .. } = linear;
            let (information, gradient) = eliminated(linear);
            (2.0 * x.tr_mul(x) - information, 2.0 * x.tr_mul(r) - gradient)
        }),
        ("the landmark held", |linear| {
            let Linear { by_poses: x, residual: r, .. } = linear;
            (x.tr_mul(x), x.tr_mul(r))
        }),
        ("gradient not reduced", |linear| {
            (eliminated(linear).0, linear.by_poses.tr_mul(&linear.residual))
        }),
        ("the landmark's coordinates one by one", |linear| {
            let Linear { by_landmark: f, by_poses: x, residual: r } = linear;
            let own = DMatrix::from_diagonal(&f.tr_mul(f).diagonal().map(f64::recip));
            let across = x.tr_mul(f) * own;
            (x.tr_mul(x) - &across * f.tr_mul(x), x.tr_mul(r) - &across * f.tr_mul(r))
        }),
    ];
    chapter.equation("track-eliminated", track_eliminated, formula, &mutants);

    let formula: Step = corrected;
    let mutants: [(_, Step); 4] = [
        ("sign", |p, h, r| -corrected(p, h, r)),
        ("noise of the pixels forgotten", |p, h, r| {
            let inverse = (h * p * h.transpose()).try_inverse();
            -p * h.transpose()
                * inverse.unwrap_or(DMatrix::repeat(h.nrows(), h.nrows(), f64::NAN))
                * r
        }),
        ("covariance of the poses forgotten", |p, h, r| -p * h.transpose() * r),
        ("rows independent", |p, h, r| {
            let innovation = (h * p * h.transpose()).diagonal().add_scalar(1.0);
            -p * h.transpose() * r.component_div(&innovation)
        }),
    ];
    chapter.equation("track-step", track_step, formula, &mutants);

    let formula: Gate = gate;
    let mutants: [(_, Gate); 3] = [
        ("covariance of the poses forgotten", |_, _, r| r.norm_squared()),
        ("divided by the number of rows", |p, h, r| gate(p, h, r) / r.len() as f64),
        ("noise of the pixels counted twice", |p, h, r| {
            let root = 0.5_f64.sqrt();
            gate(p, &(root * h), &(root * r))
        }),
    ];
    chapter.equation("track-gate", track_gate, formula, &mutants);
}

/// The step of the library's correction.
fn corrected(p: &DMatrix<f64>, h: &DMatrix<f64>, r: &DVector<f64>) -> DVector<f64> {
    correct(&mut p.clone(), h, r, Form::Difference).expect("a covariance").step
}

/// What the library's gate asks for.
fn gate(p: &DMatrix<f64>, h: &DMatrix<f64>, r: &DVector<f64>) -> f64 {
    innovation_squared(p, h, r).expect("a covariance")
}

type Eliminated = fn(&Linear) -> (DMatrix<f64>, DVector<f64>);

fn track_eliminated(formula: Eliminated) -> Comparison {
    let against = "the rows that the rotations leave, squared";
    Comparison::relative(against, 1e-7).over(TRACKS, 11, |random| {
        let track = Track::any(random).linearized();
        let Linear { by_poses, residual, .. } = Linear::projected(&track);
        let left = (by_poses.tr_mul(&by_poses), by_poses.tr_mul(&residual));
        (formula(&Linear::of(&track, 0)), left)
    })
}

/// A belief in the poses, the rows without the landmark, and those of the problem that keeps it.
fn both(
    track: &Track,
    sigma: f64,
    seed: u64,
) -> (DMatrix<f64>, Linear, (DMatrix<f64>, DVector<f64>)) {
    let mut random = crate::random::Random::new(seed);
    let p = covariance(&mut random, 6 * track.sights.len(), sigma);
    let rows = track.linearized();
    let whole = stacked(&p, &Linear::of(&rows, 0), nothing());
    (p, Linear::projected(&rows), whole)
}

type Step = fn(&DMatrix<f64>, &DMatrix<f64>, &DVector<f64>) -> DVector<f64>;

fn track_step(formula: Step) -> Comparison {
    let against = "one step of Gauss and Newton with the landmark kept, by a QR factorization";
    let mut seed = 0;
    Comparison::relative(against, 1e-6).over(TRACKS, 12, |random| {
        seed += 1;
        let track = Track::any(random);
        let (p, Linear { by_poses, residual, .. }, (a, b)) = both(&track, 0.01, seed);
        let poses = p.nrows();
        (formula(&p, &by_poses, &residual), least(&a, &b).0.rows(0, poses).into_owned())
    })
}

type Gate = fn(&DMatrix<f64>, &DMatrix<f64>, &DVector<f64>) -> f64;

fn track_gate(formula: Gate) -> Comparison {
    let against = "twice the least cost of belief and pixels, with the landmark kept";
    let mut seed = 1000;
    Comparison::relative(against, 1e-6).over(TRACKS, 13, |random| {
        seed += 1;
        let track = Track::any(random);
        let (p, Linear { by_poses, residual, .. }, (a, b)) = both(&track, 0.01, seed);
        (formula(&p, &by_poses, &residual), least(&a, &b).1)
    })
}
