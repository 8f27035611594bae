//! Is a covariance right?

use nalgebra::{DMatrix, Rotation3, Vector3};
use vislam::filtering::{Freedom, NeesBand, align, nees};
use vislam::inertial::NavState;

use super::{STATES, draws};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, as_far_as};
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Mean = |believed, true_one| {
        let inverse = believed.clone().try_inverse().expect("a covariance");
        (inverse * true_one).trace() / believed.nrows() as f64
    };
    let mutants: [(_, Mean); 3] = [
        ("the other way round", |believed, true_one| {
            let inverse = true_one.clone().try_inverse().expect("a covariance");
            (inverse * believed).trace() / believed.nrows() as f64
        }),
        ("traces apart", |believed, true_one| true_one.trace() / believed.trace()),
        ("only the diagonals", |believed, true_one| {
            let parts = true_one.diagonal().component_div(&believed.diagonal());
            parts.sum() / believed.nrows() as f64
        }),
    ];
    chapter.equation("expected-nees", expected_nees, formula, &mutants);

    let formula: Band = |runs, dimension, outside, tests| {
        let bands = NeesBand::family(runs, &vec![dimension; tests], outside);
        let band = bands.expect("a probability")[0];
        [band.low, band.high]
    };
    let mutants: [(_, Band); 3] = [
        ("for one test", |runs, dimension, outside, _| one(runs, dimension, outside)),
        ("runs without their numbers", |runs, _, outside, tests| {
            one(runs, 1, outside / tests as f64)
        }),
        ("one-sided", |runs, dimension, outside, tests| {
            one(runs, dimension, 2.0 * outside / tests as f64)
        }),
    ];
    chapter.equation("nees-band", nees_band, formula, &mutants);

    let formula: Yaw = |estimate, truth| {
        let alignment = align(estimate, truth, Freedom::Four).expect("the paths are wide");
        alignment.rotation
    };
    let mutants: [(_, Yaw); 3] = [
        ("the other way round", |estimate, truth| {
            align(truth, estimate, Freedom::Four).expect("the paths are wide").rotation
        }),
        ("means left in", |estimate, truth| {
            let [mut sine, mut cosine] = [0.0; 2];
            for (a, b) in estimate.iter().zip(truth) {
                let (a, b) = (a.position, b.position);
                sine += a.x * b.y - a.y * b.x;
                cosine += a.x * b.x + a.y * b.y;
            }
            Rotation3::from_axis_angle(&Vector3::z_axis(), sine.atan2(cosine))
        }),
        ("tilt too", |estimate, truth| {
            align(estimate, truth, Freedom::Six).expect("the paths are wide").rotation
        }),
    ];
    chapter.equation("aligned-yaw", aligned_yaw, formula, &mutants);
}

fn one(runs: usize, dimension: usize, outside: f64) -> [f64; 2] {
    let band = NeesBand::new(runs, dimension, outside).expect("a probability");
    [band.low, band.high]
}

type Mean = fn(&DMatrix<f64>, &DMatrix<f64>) -> f64;

fn expected_nees(formula: Mean) -> Comparison {
    let against = "the mean over errors that have the true covariance";
    Comparison::relative(against, 1e-9).over(STATES, 51, |random| {
        let [believed, true_one] = [(); 2].map(|()| draws::covariance(random, 4));
        let errors = draws::ensemble(&true_one);
        let of = |error: &nalgebra::DVector<f64>| nees(error, &believed).unwrap_or(f64::NAN);
        let mean = errors.iter().map(of).sum::<f64>() / errors.len() as f64;
        (formula(&believed, &true_one), mean)
    })
}

type Band = fn(usize, usize, f64, usize) -> [f64; 2];

fn nees_band(formula: Band) -> Comparison {
    let against = "the density of a sum of squares, integrated below and above the band";
    let families = [(2, 0.05, 1), (3, 0.05, 6), (3, 0.01, 12), (2, 0.1, 8)];
    let cases = [1, 3, 10, 30, 50].into_iter().flat_map(|runs| {
        families.map(|(dimension, outside, tests)| (runs, dimension, outside, tests))
    });
    // The share of each end is a number of its own size.
    Comparison::relative(against, 1e-5).each(cases, |(runs, dimension, outside, tests)| {
        let band = formula(runs, dimension, outside, tests);
        let degrees = (runs * dimension) as f64;
        let below = below(band[0] * degrees, degrees);
        let above = 1.0 - self::below(band[1] * degrees, degrees);
        let share = 0.5 * outside / tests as f64;
        ([below, above], [share, share])
    })
}

/// The probability that a sum of squares of independent normal numbers is smaller, by Simpson's rule
/// over the density of its root, with the constant from the whole integral.
fn below(sum: f64, degrees: f64) -> f64 {
    let peak = (degrees - 1.0).max(0.25).sqrt();
    let log_density = |root: f64| (degrees - 1.0) * root.ln() - 0.5 * root * root;
    let highest = log_density(peak);
    let density = |root: f64| match root > 0.0 {
        true => (log_density(root) - highest).exp(),
        false => f64::from(degrees == 1.0),
    };
    let integral = |until: f64| {
        let (pieces, step) = (4000_u32, until / 4000.0);
        let weight = |at: u32| match at {
            0 => 1.0,
            at if at == pieces => 1.0,
            at if at % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (0..=pieces).map(|at| weight(at) * density(f64::from(at) * step)).sum::<f64>() * step / 3.0
    };
    integral(sum.sqrt()) / integral(peak + 12.0)
}

type Yaw = fn(&[NavState], &[NavState]) -> Rotation3<f64>;

fn aligned_yaw(formula: Yaw) -> Comparison {
    let against = "a search for the angle of the least sum of squares";
    Comparison::absolute(against, 1e-6, "").over(50, 52, |random| {
        let yaw = random.uniform(-3.0..3.0);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
        let shift = random.direction(5.0);
        let truth: Vec<NavState> = (0..12).map(|_| draws::state(random)).collect();
        let estimate: Vec<NavState> =
            truth.iter().map(|state| moved(state, &turn, &shift, random)).collect();
        (formula(&estimate, &truth), searched(&estimate, &truth))
    })
}

fn moved(
    state: &NavState,
    turn: &Rotation3<f64>,
    shift: &Vector3<f64>,
    random: &mut Random,
) -> NavState {
    let position = turn * state.position + shift + random.direction(0.5);
    NavState { position, ..*state }
}

/// By halving an interval around the best of many angles.
fn searched(estimate: &[NavState], truth: &[NavState]) -> Rotation3<f64> {
    let mean = |states: &[NavState]| {
        states.iter().map(|state| state.position).sum::<Vector3<f64>>() / states.len() as f64
    };
    let (a, b) = (mean(estimate), mean(truth));
    let cost = |angle: f64| {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        let pairs = estimate.iter().zip(truth);
        let squares = pairs.map(|(estimate, truth)| {
            (turn * (estimate.position - a) - (truth.position - b)).norm_squared()
        });
        squares.sum::<f64>()
    };
    let slope = |angle: f64| cost(angle + 1e-4) - cost(angle - 1e-4);
    let angles = (0..360).map(|degree| f64::from(degree).to_radians());
    let best = angles.min_by(|one, other| cost(*one).total_cmp(&cost(*other))).unwrap_or(0.0);
    let lowest = as_far_as(best - 0.03, best + 0.03, |angle| slope(angle) <= 0.0);
    Rotation3::from_axis_angle(&Vector3::z_axis(), lowest)
}
