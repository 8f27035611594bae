//! How sure the window is of a quantity, and at best.

use nalgebra::{DMatrix, DVector, Vector3};
use vislam::least_squares::Spectrum;
use vislam::observability::{BiasAssumption, Similarity, Window};
use vislam::preintegration::{Matrix9, Vector9};
use vislam::simulation::{Flight, Trajectory};

use super::draws;
use super::near::{coasting, swaying};
use super::readings::beyond;
use super::worked::{log_distance, of_flight};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

const MATRICES: usize = 200;
const WINDOWS: usize = 40;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Sigma = |jacobian, gradient| {
        Spectrum::of(jacobian).ok().and_then(|s| s.sigma(gradient)).unwrap_or(f64::NAN)
    };
    let mutants: [(_, Sigma); 4] = [
        ("scaling forgotten", |jacobian, gradient| with_scaling(jacobian, gradient, |_| 1.0, 2)),
        ("scaling inverted", |jacobian, gradient| {
            with_scaling(jacobian, gradient, |length| length, 2)
        }),
        ("singular values not squared", |jacobian, gradient| {
            with_scaling(jacobian, gradient, f64::recip, 1)
        }),
        ("free directions not left out but held at one", |jacobian, gradient| {
            let stiff =
                jacobian.tr_mul(jacobian) + DMatrix::identity(gradient.len(), gradient.len());
            let inverse = stiff.try_inverse().unwrap_or_else(|| DMatrix::zeros(0, 0));
            gradient.dot(&(inverse * gradient)).sqrt()
        }),
    ];
    chapter.equation("quantity-sigma", quantity_sigma, formula, &mutants);

    let mutants: [(_, Bound); 4] = [
        ("gravity grows too", |window| {
            information(window, |v, p, t| {
                (v - t * window.gravity, p - 0.5 * t * t * window.gravity)
            })
        }),
        ("positions left out", |window| information(window, |v, p, _| (v, 0.0 * p))),
        ("whitened by the parts alone", |window| {
            let mut window = window.clone();
            for interval in &mut window.intervals {
                interval.covariance = Matrix9::from_diagonal(&interval.covariance.diagonal());
            }
            scale_information(&window)
        }),
        ("a mean and not a sum", |window| {
            scale_information(window) / window.intervals.len() as f64
        }),
    ];
    chapter.equation("scale-bound", scale_bound, scale_information, &mutants);

    let kept = Asked { motion: swaying(1.0), lever: 0.0, gradient: log_distance };
    for (condition, dropped) in [
        ("at-sensor", Asked { motion: coasting(), lever: 0.05, ..kept }),
        ("unchanged", Asked { gradient: far_coordinate, ..kept }),
        ("follows-scale", Asked { gradient: |window| 1e-3 * log_distance(window), ..kept }),
    ] {
        chapter.counterexample("scale-bound", condition, below_bound, [kept, dropped]);
    }
}

/// A motion with the camera on a lever arm, in metres, and the gradient of what is asked of its window.
#[derive(Clone, Copy)]
struct Asked {
    motion: Trajectory,
    lever: f64,
    gradient: fn(&Window) -> DVector<f64>,
}

/// The first position along x over a thousand kilometres: scale about a point that far away makes it grow by one.
fn far_coordinate(window: &Window) -> DVector<f64> {
    let mut gradient = DVector::zeros(window.dimension());
    gradient[6] = 1e-6;
    gradient
}

/// How far the standard deviation lies below the bound, as a fraction of it. Biases are unknown.
fn below_bound(case: Asked) -> Comparison {
    let flight = Flight::brief(case.motion).with_lever(case.lever * Vector3::x());
    let window = of_flight(&flight, BiasAssumption::CONSTANT);
    let (jacobian, _) = window.linearize().expect("every landmark is in front of its cameras");
    let sigma = with_scaling(&jacobian, &(case.gradient)(&window), f64::recip, 2);
    let over_bound = sigma * scale_information(&window).sqrt();
    Comparison::absolute("zero", 1e-9, "of the bound").once((1.0 - over_bound).max(0.0), 0.0)
}

/// The formula with the columns scaled by a function of their length, and a power of the singular
/// values.
fn with_scaling(
    jacobian: &DMatrix<f64>,
    gradient: &DVector<f64>,
    scale: fn(f64) -> f64,
    power: i32,
) -> f64 {
    let lengths = jacobian.column_iter().map(|column| column.norm());
    let unit: Vec<f64> = lengths.map(f64::recip).collect();
    let scaled = jacobian * DMatrix::from_diagonal(&DVector::from_vec(unit.clone()));
    let wrong = DVector::from_iterator(unit.len(), unit.iter().map(|unit| scale(unit.recip())));
    let decomposition = scaled.svd(false, true);
    let Some(v_t) = decomposition.v_t else { return f64::NAN };
    let along = v_t * gradient.component_mul(&wrong);
    let values = decomposition.singular_values;
    let seen = (0..values.len()).filter(|i| values[*i] > 1e-10 * values.max());
    seen.map(|i| along[i].powi(2) / values[i].powi(power)).sum::<f64>().sqrt()
}

type Sigma = fn(&DMatrix<f64>, &DVector<f64>) -> f64;

fn quantity_sigma(formula: Sigma) -> Comparison {
    let against = "the inverse when equations hold the free directions";
    let (rows, columns, free) = (20, 8, 2);
    Comparison::relative(against, 1e-6).over(MATRICES, 21, |random| {
        let mut draw = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| random.normal(1.0));
        let null = draw(columns, free);
        let inverse = null.tr_mul(&null).try_inverse().expect("two random vectors differ");
        let seen = DMatrix::identity(columns, columns) - &null * inverse * null.transpose();
        let jacobian = draw(rows, columns) * &seen;
        // A quantity that the free directions do not change.
        let gradient = (&seen * draw(columns, 1)).column(0).into_owned();
        // Any equations that fix both free directions will do.
        let held = null.transpose() + 0.2 * draw(free, columns);
        let information = jacobian.tr_mul(&jacobian) + held.tr_mul(&held);
        let covariance = information.try_inverse().expect("the free directions are held");
        (formula(&jacobian, &gradient), gradient.dot(&(covariance * &gradient)).sqrt())
    })
}

/// Squared length of what the whitened inertial residuals say to a growth, per growth squared.
pub fn scale_information(window: &Window) -> f64 {
    information(window, |v, p, _| (v, p))
}

/// From the change of velocity, the way beyond coasting and the seconds of each interval.
fn information(
    window: &Window,
    part: impl Fn(Vector3<f64>, Vector3<f64>, f64) -> (Vector3<f64>, Vector3<f64>),
) -> f64 {
    let pairs = window.states.windows(2).zip(&window.intervals);
    let squares = pairs.map(|(states, interval)| {
        let (gained, beyond) = beyond(&states[0], &states[1], interval.duration);
        let (v, p) = part(gained, beyond, interval.duration);
        let body_from_world = states[0].world_from_body.inverse();
        let mut row = Vector9::zeros();
        row.fixed_rows_mut::<3>(3).copy_from(&(body_from_world * v));
        row.fixed_rows_mut::<3>(6).copy_from(&(body_from_world * p));
        let whiten = interval.sqrt_information().expect("many readings make an interval");
        (whiten * row).norm_squared()
    });
    squares.sum()
}

type Bound = fn(&Window) -> f64;

fn scale_bound(formula: Bound) -> Comparison {
    let against = "the squared residual of a window that has grown, per growth squared";
    Comparison::relative(against, 1e-5).over(WINDOWS, 22, |random| {
        let window = draws::short_window(draws::motion(random), Vector3::zeros());
        let growth = random.uniform(0.05..0.3);
        let larger = Similarity { scale: 1.0 + growth, ..Similarity::identity() };
        let residual = window.transformed(&larger).residual();
        let residual = residual.expect("a similar window is in front of its cameras");
        (formula(&window), residual.norm_squared() / (growth * growth))
    })
}
