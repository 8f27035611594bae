//! How the nine errors hang together, and what is lost when their blocks are kept apart.

use nalgebra::{DMatrix, Matrix3, SymmetricEigen, Vector3};
use vislam::filtering::chi_square_quantile;
use vislam::inertial::{GRAVITY, ImuNoise, ImuSample};
use vislam::preintegration::{Matrix9, Preintegrated, Rule};
use vislam::simulation::Trajectory;

use super::runs::{DT, SECOND, at_rest, by_rule, of_readings};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Draws from the nine errors.
const DRAWS: usize = 100_000;

/// Correlations of velocity and position from the accelerometer alone; and from the gyroscope alone
/// those of attitude and velocity, attitude and position, velocity and position, of components that
/// know of one another.
type Correlations = fn() -> [f64; 4];

pub fn equations(chapter: &mut Chapter) {
    let formula: Correlations = || {
        [3.0_f64.sqrt() / 2.0, 3.0_f64.sqrt() / 2.0, 5.0_f64.sqrt() / 3.0, 15.0_f64.sqrt() / 4.0]
    };
    let mutants: [(_, Correlations); 4] = [
        ("covariances for correlations", || [0.5, 0.5, 1.0 / 6.0, 0.125]),
        ("squared", || [0.75, 0.75, 5.0 / 9.0, 15.0 / 16.0]),
        ("fully correlated", || [1.0; 4]),
        ("opposed", || [0.75, 0.75, 5.0 / 9.0, 15.0 / 16.0].map(|square: f64| -square.sqrt())),
    ];
    chapter.equation("growth-correlation", growth_correlation, formula, &mutants);
}

fn growth_correlation(formula: Correlations) -> Comparison {
    let against = "the recursion in many short steps at rest, for random sensors and times";
    const STEPS: usize = 4000;
    Comparison::absolute(against, 2e-3, "correlation").over(25, 451, |random| {
        let density = random.logarithmic(1e-4..1e-1);
        let dt = random.logarithmic(1e-4..1e-2);
        let force = random.uniform(1.0..20.0) * Vector3::z();
        let reading = ImuSample { gyro: Vector3::zeros(), accelerometer: force };
        let correlations = |gyro: f64, accelerometer: f64| {
            let noise = ImuNoise { gyro, accelerometer, ..ImuNoise::mems() };
            let covariance = of_readings(&[reading; STEPS], dt, &noise).covariance;
            move |a: usize, b: usize| {
                covariance[(a, b)] / (covariance[(a, a)] * covariance[(b, b)]).sqrt()
            }
        };
        let own = correlations(0.0, density);
        let leaked = correlations(density, 0.0);
        // A turn about y, velocity and position along x.
        (formula(), [own(3, 6), leaked(1, 3), leaked(1, 6), leaked(3, 6)])
    })
}

/// A second with a poor sensor, at rest and in a figure-eight.
pub fn seconds() -> [(&'static str, Preintegrated); 2] {
    let (mems, flight) = (ImuNoise::mems(), Trajectory::figure_eight());
    let flight = by_rule(Rule::Midpoint, &flight.samples(&GRAVITY, DT, SECOND + 1), &mems);
    [("at rest", at_rest(&mems, DT, SECOND)), ("figure-eight", flight)]
}

pub fn correlation(covariance: &Matrix9) -> Matrix9 {
    let scale =
        Matrix9::from_diagonal(&covariance.diagonal().map(|variance| 1.0 / variance.sqrt()));
    scale * covariance * scale
}

/// The covariance, seen by somebody who knows only its three diagonal blocks: their whitener on
/// both sides of it.
pub fn seen_apart(covariance: &Matrix9) -> Matrix9 {
    let mut whiten = Matrix9::zeros();
    for at in [0, 3, 6] {
        let block: Matrix3<f64> = covariance.fixed_view::<3, 3>(at, at).into();
        let SymmetricEigen { eigenvectors, eigenvalues } = block.symmetric_eigen();
        let roots = Matrix3::from_diagonal(&eigenvalues.map(|value| 1.0 / value.sqrt()));
        let root = eigenvectors * roots * eigenvectors.transpose();
        whiten.fixed_view_mut::<3, 3>(at, at).copy_from(&root);
    }
    whiten * covariance * whiten
}

/// Root mean square deviation of position when other errors are known exactly.
fn position_given(covariance: &Matrix9, known: &[usize]) -> f64 {
    let pick = |rows: &[usize], columns: &[usize]| {
        DMatrix::from_fn(rows.len(), columns.len(), |i, j| covariance[(rows[i], columns[j])])
    };
    let position = [6, 7, 8];
    let inverse = pick(known, known).try_inverse().expect("velocity varies in all directions");
    let across = pick(&position, known);
    let left = pick(&position, &position) - &across * inverse * across.transpose();
    (left.trace() / 3.0).sqrt()
}

/// Share of draws whose normalized square, by the blocks alone, is beyond a bound.
fn beyond(apart: &Matrix9, bound: f64) -> f64 {
    let eigenvalues = apart.symmetric_eigenvalues();
    let mut random = Random::new(452);
    let far = (0..DRAWS).filter(|_| {
        eigenvalues.iter().map(|value| value * random.normal(1.0).powi(2)).sum::<f64>() > bound
    });
    far.count() as f64 / DRAWS as f64
}

pub fn numbers(chapter: &mut Chapter) {
    let [(_, rest), (_, flight)] = seconds();
    let of_rest = correlation(&rest.covariance);
    chapter.number("covariance_vp_level", of_rest[(3, 6)], "", 2);
    chapter.number("covariance_phi_v", of_rest[(1, 3)], "", 2);
    chapter.number("covariance_phi_p", of_rest[(1, 6)], "", 2);
    chapter.number("covariance_vp_own", 3.0_f64.sqrt() / 2.0, "", 3);
    apart(chapter, &rest, &flight);
    let sure = position_given(&rest.covariance, &[3, 4, 5]);
    chapter.number("covariance_p_given_v", 1e2 * sure, "cm", 2);
    let given = rest.covariance[(6, 3)] / rest.covariance[(3, 3)];
    chapter.number("covariance_p_per_v", given, "s", 2);
}

fn apart(chapter: &mut Chapter, rest: &Preintegrated, flight: &Preintegrated) {
    let [rest, flight] = [rest, flight].map(|sums| seen_apart(&sums.covariance));
    let eigenvalues = rest.symmetric_eigenvalues();
    chapter.number("covariance_apart_least", 1.0 / eigenvalues.min(), "", 0);
    chapter.number("covariance_apart_most", eigenvalues.max(), "", 2);
    let bits = |matrix: &Matrix9| -0.5 * matrix.determinant().log2();
    chapter.number("covariance_lost_bits", bits(&rest), "bits", 1);
    chapter.number("covariance_lost_bits_flight", bits(&flight), "bits", 1);
    chapter.number("covariance_volume_ratio", 1.0 / rest.determinant().sqrt(), "", 0);
    let bound = chi_square_quantile(0.95, 9).expect("a probability");
    chapter.number("covariance_bound", bound, "", 1);
    chapter.number("covariance_apart_beyond", 100.0 * beyond(&rest, bound), "%", 0);
    chapter.number("covariance_apart_draws", DRAWS as f64, "", 0);
}
