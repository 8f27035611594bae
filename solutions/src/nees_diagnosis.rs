//! What a filter promises.

use exercise_spec::nees_diagnosis::{Campaign, Fault, Matrix9, Parts, Report, State};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use vislam::filtering::chi_square_quantile;
use vislam::manifold::so3;

/// The NEES of an estimate in parts: eᵀ P⁻¹ e / d for an error e of d numbers, P being the
/// covariance of these numbers.
///
/// `covariance` is that of the step (φ, ν, ρ), in this order, from the estimate to the truth,
/// all of it **in the body frame of the estimate**: R̂ exp(φ) is the true rotation, v̂ + R̂ ν the
/// true velocity, p̂ + R̂ ρ the true position. It is positive definite.
///
/// Tilt and yaw are parts of the rotation that the **world** sees, the rotation vector θ of
/// exp(θ) R̂, which is the true rotation. Yaw is its coordinate along `up`, a vector of length
/// one in the world, which need not be an axis of the world. Tilt are its coordinates along
/// two horizontal axes at right angles to each other; it does not matter which.
pub fn parts_of(estimate: State, truth: State, covariance: Matrix9, up: Vector3<f64>) -> Parts {
    let body_from_world = estimate.world_from_body.inverse();
    let mut error = SVector::<f64, 9>::zeros();
    for (at, part) in [
        (0, so3::log(&(body_from_world * truth.world_from_body))),
        (3, body_from_world * (truth.velocity - estimate.velocity)),
        (6, body_from_world * (truth.position - estimate.position)),
    ] {
        error.fixed_rows_mut::<3>(at).copy_from(&part);
    }
    // θ is R̂ φ, so its coordinate along an axis is that of φ along the axis in the body.
    let up = body_from_world * up;
    let across = Vector3::ith(up.iamin(), 1.0).cross(&up).normalize();
    let horizontal = Matrix3::from_columns(&[across, up.cross(&across), up]).transpose();
    let three = |at| coordinates(at, Matrix3::identity());
    Parts {
        position: normalized(&three(6), &error, &covariance),
        velocity: normalized(&three(3), &error, &covariance),
        tilt: normalized(
            &coordinates(0, horizontal.fixed_rows::<2>(0).into()),
            &error,
            &covariance,
        ),
        yaw: normalized(&coordinates(0, horizontal.fixed_rows::<1>(2).into()), &error, &covariance),
    }
}

/// Coordinates along axes of one of the three parts of an error, as rows for the whole.
fn coordinates<const D: usize>(at: usize, axes: SMatrix<f64, D, 3>) -> SMatrix<f64, D, 9> {
    let mut rows = SMatrix::<f64, D, 9>::zeros();
    rows.fixed_columns_mut::<3>(at).copy_from(&axes);
    rows
}

/// The NEES of some coordinates of an error, divided by how many they are.
fn normalized<const D: usize>(
    rows: &SMatrix<f64, D, 9>,
    error: &SVector<f64, 9>,
    covariance: &Matrix9,
) -> f64 {
    let numbers = rows * error;
    // The covariance is positive definite, and so is that of independent coordinates.
    let factor = (rows * covariance * rows.transpose()).cholesky();
    factor.map_or(f64::NAN, |factor| numbers.dot(&factor.solve(&numbers)) / D as f64)
}

/// The lower and the upper end of the band in which a mean of NEES or NIS lies when the filter
/// is consistent. Its errors are normal and independent from run to run.
///
/// Run k has an error of `dimensions[k]` numbers. The mean is the sum of all eᵀ P⁻¹ e, over the
/// runs, divided by the sum of their dimensions. So many `tests` are made like this one, and a
/// consistent filter may leave any of their bands with the probability `outside` at most:
/// every end of every band has an equal share of it. There is at least one run and one test,
/// no dimension is zero, and `outside` is between zero and one.
pub fn band(dimensions: Vec<usize>, tests: usize, outside: f64) -> (f64, f64) {
    let degrees: usize = dimensions.iter().sum();
    let share = outside / (2 * tests) as f64;
    let end = |below| {
        chi_square_quantile(below, degrees).map_or(f64::NAN, |square| square / degrees as f64)
    };
    (end(share), end(1.0 - share))
}

/// Which fault the filter of a campaign has. It has one at most.
///
/// Every number of every report is a test, and `outside` is the probability with which all of
/// them together may call a consistent filter faulty. So the verdict is [`Fault::None`] when
/// every number lies in its band, and never otherwise.
pub fn diagnosis(campaign: Campaign, outside: f64) -> Fault {
    let Campaign { runs, reports } = campaign;
    let tests = reports.iter().flat_map(numbers).count();
    let (low, high) = band(vec![2; runs], tests, outside);
    let leaves = |report: &&Report| numbers(report).any(|mean| !(low..=high).contains(&mean));
    // Whatever was done before the first number left its band has been done well.
    match reports.iter().find(leaves) {
        None => Fault::None,
        Some(report) if report.displacements > 0 => Fault::Clones,
        Some(report) if report.steps > 1 => Fault::Transition,
        Some(_) => Fault::Density,
    }
}

fn numbers(report: &Report) -> impl Iterator<Item = f64> + use<> {
    let errors = [report.position, report.velocity, report.bias];
    errors.into_iter().chain(report.displacement)
}
