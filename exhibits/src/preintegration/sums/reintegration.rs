//! When a first-order correction is no longer good enough.

use nalgebra::{Matrix3, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise};
use vislam::least_squares::sqrt_information;
use vislam::preintegration::{Matrix9, Preintegrated, correct_for_bias, preintegrate};
use vislam::simulation::Trajectory;

use super::oracle::{Readings, bias, difference, gyro_bias};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::noise::blocks::correlation;
use crate::preintegration::oracle::stack;
use crate::random::Random;

/// Random readings at which the bound is compared, and directions from which a search for the
/// worst errors begins.
const STATES: usize = 200;
const STARTS: usize = 4;

/// The share of the mean of the squared error that a correction may add.
const FRACTION: f64 = 0.01;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Bound); 5] = [
        ("each error by its own covariance", |sums, bias| whitened(sums, bias, own).norm_squared()),
        ("squares added", |sums, bias| whitened(sums, bias, largest).norm_squared()),
        ("the smallest singular value", |sums, bias| whitened(sums, bias, least).sum().powi(2)),
        ("velocity dropped", |sums, bias| {
            let by_part = whitened(sums, bias, largest);
            (by_part[0] + by_part[2]).powi(2)
        }),
        ("all columns at once", |sums, bias| {
            let longest = lengths(sums, bias).iter().sum::<f64>();
            (whitener(sums).singular_values().max() * longest).powi(2)
        }),
    ];
    let formula: Bound = |sums, bias| sums.squared_error_bound(bias, &whitener(sums));
    chapter.equation("reintegration-bound", reintegration_bound, formula, &mutants);
    numbers(chapter);
}

/// Takes sums and a bias, and gives the greatest squared length of the whitened error.
type Bound = fn(&Preintegrated, &ImuBias) -> f64;

fn whitener(sums: &Preintegrated) -> Matrix9 {
    sums.sqrt_information().expect("after many steps everything varies")
}

/// The three lengths, each times what whitening makes of a vector of length one in its block.
fn whitened(
    sums: &Preintegrated,
    bias: &ImuBias,
    of_block: fn(&Preintegrated, usize) -> f64,
) -> Vector3<f64> {
    let lengths = lengths(sums, bias);
    Vector3::from_fn(|block, _| of_block(sums, block) * lengths[block])
}

fn largest(sums: &Preintegrated, block: usize) -> f64 {
    whitener(sums).fixed_columns::<3>(3 * block).singular_values().max()
}

fn least(sums: &Preintegrated, block: usize) -> f64 {
    whitener(sums).fixed_columns::<3>(3 * block).singular_values().min()
}

/// By the covariance of the block alone.
fn own(sums: &Preintegrated, block: usize) -> f64 {
    let covariance = sums.covariance.fixed_view::<3, 3>(3 * block, 3 * block).into_owned();
    let root = sqrt_information(&covariance);
    root.map_or(f64::NAN, |root: Matrix3<f64>| root.singular_values().max())
}

fn lengths(sums: &Preintegrated, bias: &ImuBias) -> [f64; 3] {
    let bound = sums.linearization_error_bound(bias);
    [bound.rotation, bound.velocity, bound.position]
}

/// The greatest squared length of a whitened error whose three parts have these lengths, by ascent
/// from several directions: each part turns to where the gradient points, until nothing grows.
fn worst(random: &mut Random, whitener: &Matrix9, lengths: &[f64; 3]) -> f64 {
    let ascents = (0..STARTS).map(|_| {
        let [phi, v, p] = lengths.map(|length| random.direction(length));
        let mut error = stack(&phi, &v, &p);
        for _ in 0..300 {
            let gradient = whitener.tr_mul(&(whitener * error));
            for (block, length) in lengths.iter().enumerate() {
                let uphill = gradient.fixed_rows::<3>(3 * block).normalize();
                error.fixed_rows_mut::<3>(3 * block).copy_from(&(*length * uphill));
            }
        }
        (whitener * error).norm_squared()
    });
    ascents.fold(0.0, f64::max)
}

fn reintegration_bound(formula: Bound) -> Comparison {
    let against = "the worst directions of the three errors, found by ascent: how far they exceed \
                   it, here nothing, or stay below two thirds of it";
    Comparison::absolute(against, 1e-9, "relative").over(STATES, 41, |random| {
        let readings = Readings::random(random);
        let sums = readings.summed();
        let step = bias(random, 0.05, 0.2);
        let moved = ImuBias::from_vector(&(sums.bias.vector() + step.vector()));
        let worst = worst(random, &whitener(&sums), &lengths(&sums, &moved));
        let part = worst / formula(&sums, &moved);
        ([(part - 1.0).max(0.0), (2.0 / 3.0 - part).max(0.0)], [0.0; 2])
    })
}

/// The sums of readings at rest, 200 in a second.
fn at_rest(noise: &ImuNoise, seconds: f64, bias: &ImuBias) -> Preintegrated {
    let samples = vec![Trajectory::hover().at(0.0).sample(&GRAVITY); (200.0 * seconds) as usize];
    preintegrate(&samples, 0.005, bias, noise).expect("finite numbers")
}

fn about_level_axis(rate: f64) -> ImuBias {
    gyro_bias(rate * Vector3::x())
}

/// How far the gyroscope's bias may move about a level axis until readings at rest are summed again.
fn farthest(noise: &ImuNoise, seconds: f64) -> f64 {
    let sums = at_rest(noise, seconds, &ImuBias::default());
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        let again = sums.should_reintegrate(&about_level_axis(middle), FRACTION);
        if again { high = middle } else { low = middle }
    }
    low
}

/// What the correction of a second at rest adds to the mean of the squared error, by summing again.
fn added(noise: &ImuNoise, rate: f64) -> f64 {
    let sums = at_rest(noise, 1.0, &ImuBias::default());
    let moved = about_level_axis(rate);
    let again = at_rest(noise, 1.0, &moved).deltas;
    (whitener(&sums) * difference(&again, &correct_for_bias(&sums, &moved))).norm_squared()
}

/// The least eigenvalue of the correlations of the nine errors.
fn least_correlated(noise: &ImuNoise, seconds: f64) -> f64 {
    let sums = at_rest(noise, seconds, &ImuBias::default());
    correlation(&sums.covariance).symmetric_eigenvalues().min()
}

fn numbers(chapter: &mut Chapter) {
    let (mems, euroc) = (ImuNoise::mems(), ImuNoise::euroc());
    chapter.number("again_limit", 9.0 * FRACTION, "", 2);
    chapter.number("again_mems_mrad", 1e3 * farthest(&mems, 1.0), "mrad/s", 0);
    chapter.number("again_mems_added", added(&mems, farthest(&mems, 1.0)), "", 3);
    chapter.number("again_euroc_mrad", 1e3 * farthest(&euroc, 1.0), "mrad/s", 0);
    chapter.number("again_euroc_short_mrad", 1e3 * farthest(&euroc, 0.1), "mrad/s", 0);
    let (least, least_long) = (least_correlated(&mems, 1.0), least_correlated(&mems, 5.0));
    chapter.number("again_least", least, "", 3);
    chapter.number("again_least_long", least_long, "", 3);
    // What three errors of a tenth of a standard deviation add, with and without correlations.
    let tenths = 3.0 * 0.1_f64.powi(2);
    chapter.number("again_tenths_apart", tenths, "", 2);
    chapter.number("again_tenths", tenths / least, "", 2);
    chapter.number("again_tenths_long", tenths / least_long, "", 1);
    // Standard deviations of the walk in a minute, which is how far a bias moves by itself.
    chapter.number("walk_minute_mrad", 1e3 * mems.gyro_walk * 60_f64.sqrt(), "mrad/s", 1);
}
