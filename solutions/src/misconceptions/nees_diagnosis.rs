//! Wrong answers to [`nees_diagnosis`](crate::nees_diagnosis).

use exercise_spec::nees_diagnosis::*;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};
use vislam::filtering::chi_square_quantile;
use vislam::manifold::so3;

use super::Wrong;
use crate::nees_diagnosis as right;

/// The reference answer.
pub const REFERENCE: Functions =
    Functions { parts_of: right::parts_of, band: right::band, diagnosis: right::diagnosis };

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let parts =
        |misconception, parts_of| Wrong::new(misconception, Functions { parts_of, ..REFERENCE });
    let band = |misconception, band| Wrong::new(misconception, Functions { band, ..REFERENCE });
    let verdict =
        |misconception, diagnosis| Wrong::new(misconception, Functions { diagnosis, ..REFERENCE });
    vec![
        parts(&NOT_DIVIDED, |estimate, truth, covariance, up| {
            let Parts { position, velocity, tilt, yaw } =
                right::parts_of(estimate, truth, covariance, up);
            Parts { position: 3.0 * position, velocity: 3.0 * velocity, tilt: 2.0 * tilt, yaw }
        }),
        parts(&BODY_AXES, |estimate, truth, covariance, up| {
            right::parts_of(estimate, truth, covariance, estimate.world_from_body * up)
        }),
        parts(&COVARIANCE_IN_BODY, |estimate, truth, covariance, up| {
            divided(&errors(&estimate, &truth), &covariance, &up, quotient)
        }),
        parts(&TURNED_BACK, |estimate, truth, covariance, up| {
            let turned = turned(&covariance, &estimate.world_from_body.inverse());
            divided(&errors(&estimate, &truth), &turned, &up, quotient)
        }),
        parts(&WORLD_AXIS, |estimate, truth, covariance, _| {
            right::parts_of(estimate, truth, covariance, Vector3::z())
        }),
        parts(&BLOCK_OF_INVERSE, |estimate, truth, covariance, up| {
            let turned = turned(&covariance, &estimate.world_from_body);
            let information = turned.try_inverse().unwrap_or_else(Matrix9::zeros);
            divided(&errors(&estimate, &truth), &information, &up, |error, block| {
                error.dot(&(block * error))
            })
        }),
        parts(&DIAGONAL_ALONE, |estimate, truth, covariance, up| {
            let turned = turned(&covariance, &estimate.world_from_body);
            divided(&errors(&estimate, &truth), &turned, &up, |error, block| {
                error.component_mul(error).component_div(&block.diagonal()).sum()
            })
        }),
        parts(&SIGMA_FOR_VARIANCE, |estimate, truth, covariance, up| {
            let turned = turned(&covariance, &estimate.world_from_body);
            divided(&errors(&estimate, &truth), &turned, &up, |error, block| {
                error.component_mul(error).component_div(&block.diagonal().map(f64::sqrt)).sum()
            })
        }),
        band(&ONE_SIDED, |dimensions, tests, outside| {
            (0.0, right::band(dimensions, tests, 2.0 * outside).1)
        }),
        verdict(&ONE_SIDED, |campaign, outside| {
            judged(campaign, |mean, [_, high]| mean > high, outside)
        }),
        band(&SINGLE_RUN, |dimensions, tests, outside| {
            right::band(vec![dimensions[0]], tests, outside)
        }),
        band(&RUNS_FOR_DEGREES, |dimensions, tests, outside| {
            right::band(vec![1; dimensions.len()], tests, outside)
        }),
        band(&EACH_TEST_ALONE, |dimensions, _, outside| right::band(dimensions, 1, outside)),
        verdict(&EACH_TEST_ALONE, |campaign, outside| {
            let runs = campaign.runs;
            let (low, high) = right::band(vec![2; runs], 1, outside);
            judged(campaign, move |mean, _| !(low..=high).contains(&mean), outside)
        }),
        band(&SUM_FOR_MEAN, |dimensions, tests, outside| {
            let degrees = dimensions.iter().sum::<usize>() as f64;
            let (low, high) = right::band(dimensions, tests, outside);
            (degrees * low, degrees * high)
        }),
        band(&NORMAL_BAND, |dimensions, tests, outside| {
            let degrees = dimensions.iter().sum::<usize>() as f64;
            let square = chi_square_quantile(1.0 - outside / tests as f64, 1).unwrap_or(f64::NAN);
            let away = (2.0 * square / degrees).sqrt();
            (1.0 - away, 1.0 + away)
        }),
        verdict(&MORE_NOISE, |campaign, outside| match right::diagnosis(campaign, outside) {
            Fault::Transition => Fault::Density,
            other => other,
        }),
        verdict(&MORE_NOISE, |campaign, outside| match right::diagnosis(campaign, outside) {
            Fault::Transition | Fault::Clones => Fault::Density,
            other => other,
        }),
        verdict(&FIRST_STEP_UNREAD, |mut campaign, outside| {
            for report in &mut campaign.reports {
                report.steps += 1;
            }
            right::diagnosis(campaign, outside)
        }),
        verdict(&UPDATE_AS_PREDICTION, |mut campaign, outside| {
            for report in &mut campaign.reports {
                report.displacements = 0;
            }
            right::diagnosis(campaign, outside)
        }),
        verdict(&UPDATE_AS_PREDICTION, |campaign, outside| {
            match right::diagnosis(campaign, outside) {
                Fault::Clones => Fault::Density,
                other => other,
            }
        }),
    ]
}

/// Errors of rotation, velocity and position, all of them in the world.
fn errors(estimate: &State, truth: &State) -> [Vector3<f64>; 3] {
    let in_body = so3::local(&estimate.world_from_body, &truth.world_from_body);
    [
        estimate.world_from_body * in_body,
        truth.velocity - estimate.velocity,
        truth.position - estimate.position,
    ]
}

/// A covariance whose three parts are turned.
fn turned(covariance: &Matrix9, rotation: &Rotation3<f64>) -> Matrix9 {
    let mut whole = Matrix9::zeros();
    for at in [0, 3, 6] {
        whole.fixed_view_mut::<3, 3>(at, at).copy_from(rotation.matrix());
    }
    whole * covariance * whole.transpose()
}

fn quotient(error: &DVector<f64>, block: &DMatrix<f64>) -> f64 {
    block.clone().cholesky().map_or(f64::NAN, |factor| error.dot(&factor.solve(error)))
}

/// The parts by some quotient of an error and its block, each divided by its dimension.
fn divided(
    [rotation, velocity, position]: &[Vector3<f64>; 3],
    matrix: &Matrix9,
    up: &Vector3<f64>,
    by: impl Fn(&DVector<f64>, &DMatrix<f64>) -> f64,
) -> Parts {
    let across = up.cross(&Vector3::ith(up.iamin(), 1.0)).normalize();
    let axes = Matrix3::from_columns(&[across, up.cross(&across), *up]);
    let part = |error: &Vector3<f64>, at: usize, axes: &[Vector3<f64>]| {
        let axes = DMatrix::from_fn(3, axes.len(), |row, column| axes[column][row]);
        let block = axes.tr_mul(&matrix.fixed_view::<3, 3>(at, at)) * &axes;
        by(&axes.tr_mul(error).column(0).into_owned(), &block) / axes.ncols() as f64
    };
    let [x, y, up] = [0, 1, 2].map(|axis| axes.column(axis).into_owned());
    let world = [Vector3::x(), Vector3::y(), Vector3::z()];
    Parts {
        position: part(position, 6, &world),
        velocity: part(velocity, 3, &world),
        tilt: part(rotation, 0, &[x, y]),
        yaw: part(rotation, 0, &[up]),
    }
}

/// The diagnosis when a number is called wrong by something else.
fn judged(campaign: Campaign, wrong: impl Fn(f64, [f64; 2]) -> bool, outside: f64) -> Fault {
    let numbers = |report: &Report| {
        [report.position, report.velocity, report.bias].into_iter().chain(report.displacement)
    };
    let tests = campaign.reports.iter().flat_map(numbers).count();
    let (low, high) = right::band(vec![2; campaign.runs], tests, outside);
    let first =
        campaign.reports.iter().find(|report| numbers(report).any(|mean| wrong(mean, [low, high])));
    match first {
        None => Fault::None,
        Some(report) if report.displacements > 0 => Fault::Clones,
        Some(report) if report.steps > 1 => Fault::Transition,
        Some(_) => Fault::Density,
    }
}
