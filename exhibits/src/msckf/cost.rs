//! What the parts of the filter cost, and how that grows.

use std::hint::black_box;
use std::time::Instant;

use nalgebra::{DMatrix, DVector, Matrix6};
use vislam::filtering::{Belief, Form, Transition, innovation_squared};
use vislam::inertial::{BodyPose, GRAVITY, ImuBias, ImuNoise, NavState, StampedSample};
use vislam::least_squares::Key;
use vislam::msckf::{LinearizedTrack, MsckfOptions, Rows, landmark};
use vislam::preintegration::preintegrate_combined;
use vislam::simulation::{Flight, Trajectory};

use super::draws::{Linear, Plan, SIGMA, Track};
use super::flights::example::{flight, fly, start};
use crate::chapter::Chapter;
use crate::inertial::rules::exponent;
use crate::preintegration::speed::timed;
use crate::random::Random;
use crate::record::{RecordValue, accepted};

/// Sights of a track that is projected.
pub const LENGTHS: [usize; 6] = [6, 11, 20, 36, 64, 116];
/// Tracks of a picture.
pub const FEATURES: [usize; 5] = [10, 20, 40, 80, 160];
/// Poses in a window whose covariance is corrected by as many rows as it has.
pub const WINDOWS: [usize; 5] = [6, 11, 20, 36, 64];
/// The fastest of so many turns counts.
const TURNS: usize = 40;
/// The window and the readings of a typical picture.
const CLONES: usize = 11;
const READINGS: usize = 20;
/// Rows of a typical correction, and tracks whose rows are compressed.
const ROWS: usize = 52;
const MANY: usize = 16;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let list = |sizes: &[usize]| sizes.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
    let inputs = vec![
        ("lengths", list(&LENGTHS)),
        ("features", list(&FEATURES)),
        ("windows", list(&WINDOWS)),
        ("turns", TURNS.to_string()),
        ("typical", format!("{CLONES} poses, {READINGS} readings, {ROWS} rows, {MANY} tracks")),
    ];
    chapter.record("msckf_cost", inputs, cost);
}

/// The fastest of many calls, in microseconds.
fn fastest(calls: usize, mut call: impl FnMut()) -> f64 {
    (0..TURNS).map(|_| 1e6 * timed(calls, |_| call())).fold(f64::INFINITY, f64::min)
}

/// Microseconds to take the landmark out of a track of this length.
fn projection(sights: usize) -> f64 {
    let linearized = Track::drawn(&mut Random::new(1), Plan::new(sights)).linearized();
    let mut track = linearized.clone();
    let copied = fastest(200, || track.clone_from(black_box(&linearized)));
    let both = fastest(200, || {
        track.clone_from(black_box(&linearized));
        black_box(track.project(f64::INFINITY)).expect("nothing is refused");
    });
    both - copied
}

/// Microseconds of a picture with so many tracks, propagation included.
fn picture(tracks: usize) -> f64 {
    let flight = Flight { tracks, ..flight(10.0) };
    let landmarks = flight.room(3.0, 4000, 1).expect("a room");
    let recording = flight.record(&landmarks, 1).expect("it can be flown");
    let (options, start) = (MsckfOptions::of_flight(&flight), start(&recording, 1));
    let time = || {
        let begin = Instant::now();
        fly(&recording, options, &start, |_, _, _| ()).expect("the flight is followed");
        1e6 * begin.elapsed().as_secs_f64() / recording.pictures.len() as f64
    };
    (0..3).map(|_| time()).fold(f64::INFINITY, f64::min)
}

/// A belief in a state, biases and so many poses.
fn belief(clones: usize) -> (Belief, (Key<NavState>, Key<ImuBias>)) {
    let state = Trajectory::figure_eight().at(0.0).state;
    let unsure = |size| 1e-4 * DMatrix::identity(size, size);
    let mut belief = Belief::new();
    let keys = (
        belief.add(state, &unsure(9)).expect("a covariance"),
        belief.add(ImuBias::default(), &unsure(6)).expect("a covariance"),
    );
    for _ in 0..clones {
        belief.add(BodyPose::from(&state), &unsure(6)).expect("a covariance");
    }
    (belief, keys)
}

/// Microseconds to correct a belief in a window of this size by so many rows.
fn correction(clones: usize, rows: usize) -> f64 {
    let size = 15 + 6 * clones;
    let (h, r) = system(rows, size);
    let belief = belief(clones).0;
    let calls = (20_000_000 / size.pow(3)).clamp(1, 50);
    fastest(calls, || {
        let mut belief = belief.clone();
        belief.correct(&h, &r, Form::Difference).expect("a covariance");
        black_box(belief);
    })
}

fn system(rows: usize, columns: usize) -> (DMatrix<f64>, DVector<f64>) {
    let mut random = Random::new(3);
    let h = DMatrix::from_fn(rows, columns, |_, _| random.normal(3.0));
    let r = DVector::from_fn(rows, |_, _| random.normal(1.0));
    (h, r)
}

/// Microseconds of what a picture needs, part by part.
fn parts() -> Vec<(&'static str, f64)> {
    let samples = Trajectory::figure_eight().samples(&GRAVITY, 0.005, READINGS + 1);
    let stamped = |(k, sample): (i64, _)| StampedSample { nanoseconds: 5_000_000 * k, sample };
    let samples: Vec<StampedSample> = (0..).zip(samples).map(stamped).collect();
    let state = Trajectory::figure_eight().at(0.0).state;
    let bias = ImuBias::default();
    let (belief, keys) = belief(CLONES);
    let noise = ImuNoise::euroc();
    let carry = fastest(200, || {
        let sums = preintegrate_combined(&samples, &bias, &noise).expect("there are readings");
        let transition = Transition::new(&sums, &state, &bias, &GRAVITY).expect("finite");
        let mut belief = belief.clone();
        belief.carry_on(keys, &transition).expect("of the same variables");
        black_box(belief);
    });
    let every: Vec<usize> = (0..CLONES + 2).collect();
    let clone = fastest(200, || {
        let mut belief = belief.clone();
        belief.add_function(BodyPose::from(&state), &by_all(&belief), &zeros()).expect("finite");
        belief.keep(&every).expect("they exist");
        black_box(belief);
    });
    let track = Track::drawn(&mut Random::new(2), Plan { off: 0.001, ..Plan::new(CLONES) });
    let find = fastest(200, || {
        let camera = (&track.camera, SIGMA);
        black_box(landmark(black_box(&track.sights), &track.rig, camera, 1e-3))
            .expect("it is seen");
    });
    let mut linear = LinearizedTrack::default();
    let linearize = fastest(200, || {
        let camera = (&track.camera, SIGMA);
        linear
            .linearize(black_box(&track.sights), &track.landmark, &track.rig, camera)
            .expect("ahead");
    });
    let Linear { by_poses, residual, .. } = Linear::projected(&track.linearized());
    let poses = 6 * CLONES;
    let gate = fastest(200, || {
        let covariance = belief.covariance().view((15, 15), (poses, poses)).into_owned();
        black_box(innovation_squared(&covariance, black_box(&by_poses), &residual))
            .expect("a covariance");
    });
    let columns = 15 + poses;
    let compress = {
        let (h, r) = system(MANY * (2 * CLONES - 3), columns);
        let mut full = Rows::new(columns + 1);
        for (row, residual) in h.row_iter().zip(&r) {
            let into = full.add();
            row.iter().zip(&mut *into).for_each(|(number, into)| *into = *number);
            into[columns] = *residual;
        }
        fastest(100, || {
            let mut rows = full.clone();
            rows.compress();
            black_box(rows);
        })
    };
    vec![
        ("readings", carry),
        ("clone", clone),
        ("landmark", find),
        ("linearize", linearize),
        ("project", projection(CLONES)),
        ("gate", gate),
        ("compress", compress),
        ("correct", correction(CLONES, ROWS)),
    ]
}

fn by_all(belief: &Belief) -> DMatrix<f64> {
    let mut by_all = DMatrix::zeros(6, belief.dimension());
    by_all.view_mut((0, 0), (3, 3)).fill_with_identity();
    by_all.view_mut((3, 6), (3, 3)).fill_with_identity();
    by_all
}

fn zeros() -> DMatrix<f64> {
    let zeros = Matrix6::<f64>::zeros();
    DMatrix::from_column_slice(6, 6, zeros.as_slice())
}

fn cost() -> Vec<RecordValue> {
    // Times are those of a machine and an hour.
    let time = |name: String, micros: f64| {
        RecordValue::new(name, micros, "µs", if micros < 10.0 { 1 } else { 0 }, 3.0)
    };
    let slope = |name: &'static str, sizes: &[usize], times: &[f64]| {
        let sizes: Vec<f64> = sizes.iter().map(|size| *size as f64).collect();
        RecordValue::new(name, exponent(&sizes, times), "", 1, 1.0)
    };
    let mut values: Vec<RecordValue> =
        parts().into_iter().map(|(name, micros)| time(name.to_owned(), micros)).collect();
    let lengths = LENGTHS.map(projection);
    values.extend(LENGTHS.iter().zip(lengths).map(|(m, t)| time(format!("length_{m}"), t)));
    values.push(slope("exponent_length", &LENGTHS[2..], &lengths[2..]));
    let features = FEATURES.map(picture);
    values.extend(FEATURES.iter().zip(features).map(|(n, t)| time(format!("features_{n}"), t)));
    let without = picture(0);
    values.push(time("features_0".to_owned(), without));
    let more = features.map(|time| time - without);
    values.push(slope("exponent_features", &FEATURES[2..], &more[2..]));
    let each = more[2] / FEATURES[2] as f64;
    values.push(time("each_feature".to_owned(), each));
    let windows = WINDOWS.map(|clones| correction(clones, 15 + 6 * clones));
    values.extend(WINDOWS.iter().zip(windows).map(|(n, t)| time(format!("window_{n}"), t)));
    values.push(slope("exponent_window", &WINDOWS[2..], &windows[2..]));
    values
}

/// What the accepted record says, in microseconds, by sizes.
pub fn recorded(what: &str, sizes: &[usize]) -> Vec<(f64, f64)> {
    let of = |size: &usize| (*size as f64, accepted("msckf_cost", &format!("{what}_{size}")));
    sizes.iter().map(of).collect()
}
