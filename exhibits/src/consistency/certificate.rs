//! What a covariance claims along the free directions, through updates, transitions and forgetting.

use nalgebra::{DMatrix, DVector, SMatrix, Vector4};
use vislam::consistency::{Policy, certificate};
use vislam::filtering::{Form, attitude_in_world, correct};
use vislam::msckf::{Msckf, MsckfOptions, Start};
use vislam::simulation::{Flight, FlightRecording, Trajectory};

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

const STATES: usize = 100;
const SIZE: usize = 9;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Updated = |p, n, h| claimed(p, n) + claimed_by(h, n);
    let mutants: [(_, Updated); 3] = [
        ("taken off", |p, n, h| claimed(p, n) - claimed_by(h, n)),
        ("weighed by the innovation", |p, n, h| {
            let s = h * p * h.transpose() + DMatrix::identity(h.nrows(), h.nrows());
            let along = h * n;
            claimed(p, n) + fixed(&(along.transpose() * inverse(&s) * along))
        }),
        ("nothing gained", |p, n, _| claimed(p, n)),
    ];
    chapter.equation("certificate-update", certificate_update, formula, &mutants);

    let formula: Carried =
        |p, n, phi, q| claimed(p, n) - lost(p, n, &(phi.transpose() * inverse(q) * phi));
    let mutants: [(_, Carried); 4] = [
        ("sign", |p, n, phi, q| claimed(p, n) + lost(p, n, &(phi.transpose() * inverse(q) * phi))),
        ("noise not inverted", |p, n, phi, q| {
            claimed(p, n) - lost(p, n, &(phi.transpose() * q * phi))
        }),
        ("transition transposed", |p, n, phi, q| {
            claimed(p, n) - lost(p, n, &(phi * inverse(q) * phi.transpose()))
        }),
        ("nothing lost", |p, n, _, _| claimed(p, n)),
    ];
    chapter.equation("certificate-transition", certificate_transition, formula, &mutants);

    let formula: Floor = |p, n, g| {
        let omega = certificate(p, n).unwrap_or(SMatrix::repeat(f64::NAN));
        g.dot(&(crate::comparison::inverse(omega) * g))
    };
    let mutants: [(_, Floor); 3] = [
        ("each direction alone", |p, n, g| {
            let omega = claimed(p, n);
            (0..4).map(|at| g[at] * g[at] / omega[(at, at)]).sum()
        }),
        ("not inverted", |p, n, g| g.dot(&(claimed(p, n) * g))),
        ("covariance in place of information", |p, n, g| {
            g.dot(&(crate::comparison::inverse(fixed(&(n.transpose() * p * n))) * g))
        }),
    ];
    chapter.equation("certificate-floor", certificate_floor, formula, &mutants);
    numbers(chapter);
}

fn fixed(matrix: &DMatrix<f64>) -> SMatrix<f64, 4, 4> {
    SMatrix::from_column_slice(matrix.as_slice())
}

fn inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let failed = || DMatrix::from_element(matrix.nrows(), matrix.ncols(), f64::NAN);
    matrix.clone().try_inverse().unwrap_or_else(failed)
}

fn claimed(p: &DMatrix<f64>, n: &DMatrix<f64>) -> SMatrix<f64, 4, 4> {
    certificate(p, n).unwrap_or(SMatrix::repeat(f64::NAN))
}

fn claimed_by(h: &DMatrix<f64>, n: &DMatrix<f64>) -> SMatrix<f64, 4, 4> {
    let along = h * n;
    fixed(&along.tr_mul(&along))
}

/// What a transition takes, from the information about its beginning that its end would give.
fn lost(p: &DMatrix<f64>, n: &DMatrix<f64>, back: &DMatrix<f64>) -> SMatrix<f64, 4, 4> {
    let information = inverse(p);
    let along = &information * n;
    fixed(&(along.transpose() * inverse(&(information + back)) * along))
}

fn matrix(random: &mut Random, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| random.normal(1.0))
}

fn covariance(random: &mut Random) -> DMatrix<f64> {
    let root = matrix(random, 2 * SIZE, SIZE);
    root.tr_mul(&root) / SIZE as f64
}

type Updated = fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> SMatrix<f64, 4, 4>;

fn certificate_update(formula: Updated) -> Comparison {
    let against = "the inverse of the covariance that the gain leaves";
    Comparison::relative(against, 1e-9).over(STATES, 4, |random| {
        let (p, n) = (covariance(random), matrix(random, SIZE, 4));
        let h = matrix(random, 5, SIZE);
        let mut after = p.clone();
        let corrected = correct(&mut after, &h, &DVector::zeros(5), Form::Difference);
        corrected.expect("a covariance");
        (formula(&p, &n, &h), fixed(&(n.transpose() * inverse(&after) * &n)))
    })
}

type Carried = fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> SMatrix<f64, 4, 4>;

fn certificate_transition(formula: Carried) -> Comparison {
    let against = "the inverse of the covariance after the transition";
    Comparison::relative(against, 1e-8).over(STATES, 5, |random| {
        let (p, n) = (covariance(random), matrix(random, SIZE, 4));
        let phi = DMatrix::identity(SIZE, SIZE) + 0.3 * matrix(random, SIZE, SIZE);
        let q = 0.1 * covariance(random);
        let after = &phi * &p * phi.transpose() + &q;
        let carried = &phi * &n;
        (formula(&p, &n, &phi, &q), fixed(&(carried.transpose() * inverse(&after) * &carried)))
    })
}

type Floor = fn(&DMatrix<f64>, &DMatrix<f64>, &Vector4<f64>) -> f64;

fn certificate_floor(formula: Floor) -> Comparison {
    let against = "the least variance of all gradients that change so along the directions";
    Comparison::relative(against, 1e-9).over(STATES, 6, |random| {
        let (p, n) = (covariance(random), matrix(random, SIZE, 4));
        let g = Vector4::from_fn(|_, _| random.normal(1.0));
        // One such gradient, and what may be added to it.
        let one = &n * inverse(&n.tr_mul(&n)) * g;
        let basis = matrix(random, SIZE, SIZE - 4);
        let across = &basis - &n * inverse(&n.tr_mul(&n)) * n.tr_mul(&basis);
        let added = inverse(&(across.tr_mul(&(&p * &across)))) * across.tr_mul(&(&p * &one));
        let best = one - across * added;
        (formula(&p, &n, &g), best.dot(&(&p * &best)))
    })
}

/// Landmarks that the filter of the worked flight keeps.
const KEPT: usize = 20;
const SECONDS: f64 = 10.0;
const PICTURE_RATE: f64 = 5.0;
/// At the beginning, the standard deviation of the yaw in rad.
const YAW: f64 = 0.05;

fn recorded() -> FlightRecording {
    let new = Flight::new(Trajectory::figure_eight());
    let flight = Flight { seconds: SECONDS, picture_rate: PICTURE_RATE, tracks: 40, ..new };
    let room = flight.room(3.0, 400, 3).expect("the flight has a room");
    flight.record(&room, 3).expect("it can be flown")
}

/// In degrees, the least that the certificate allows the yaw's standard deviation to be, and what
/// that is, after each picture.
fn followed(recording: &FlightRecording, policy: Policy) -> Vec<[f64; 2]> {
    let sigmas =
        [0.01, 0.01, YAW, 0.05, 0.05, 0.05, 0.1, 0.1, 0.1, 2e-3, 2e-3, 2e-3, 0.02, 0.02, 0.02];
    let start = Start::drawn(recording, &sigmas, 4).expect("there are pictures");
    let options = MsckfOptions {
        landmarks: KEPT,
        gate: 1.0,
        linearization: policy.into(),
        ..MsckfOptions::of_flight(&recording.flight)
    };
    let mut filter = Msckf::new(options, &start).expect("the start is finite");
    (0..recording.pictures.len())
        .map(|number| {
            filter.follow(recording, number).expect("the flight is followed");
            let omega = filter.certificate().unwrap_or(SMatrix::repeat(f64::NAN));
            let floor = crate::comparison::inverse(omega)[(3, 3)].sqrt();
            let covariance = filter.covariance();
            let attitude = attitude_in_world(filter.state(), &covariance.fixed_view::<3, 3>(0, 0));
            [floor, attitude[(2, 2)].sqrt()].map(f64::to_degrees)
        })
        .collect()
}

fn numbers(chapter: &mut Chapter) {
    let recording = recorded();
    let standard = followed(&recording, Policy::Standard);
    let first = followed(&recording, Policy::FirstEstimates);
    let last = standard.len() - 1;
    chapter.number("worked_seconds", SECONDS, "s", 0);
    chapter.number("worked_kept", KEPT as f64, "", 0);
    chapter.number("worked_start", YAW.to_degrees(), "°", 2);
    chapter.number("worked_floor_start", first[1][0], "°", 2);
    chapter.number("worked_floor_standard", standard[last][0], "°", 2);
    chapter.number("worked_sigma_standard", standard[last][1], "°", 2);
    chapter.number("worked_floor_first", first[last][0], "°", 2);
    chapter.number("worked_sigma_first", first[last][1], "°", 2);
    let falls = |floors: &[[f64; 2]]| {
        let pairs = floors.windows(2).skip(1);
        pairs.map(|pair| 1.0 - pair[1][0] / pair[0][0]).fold(f64::NEG_INFINITY, f64::max)
    };
    chapter.number("worked_falls_standard", 100.0 * falls(&standard), "%", 0);
    // How far from never falling: rounding alone.
    chapter.number("worked_falls_first", falls(&first).max(1e-16).log10().ceil(), "", 0);
}
