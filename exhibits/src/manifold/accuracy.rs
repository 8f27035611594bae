//! Errors of formulas against power series that are summed in sixty digits.

use std::f64::consts::PI;

use dashu_float::{FBig, round::mode::HalfEven};
use nalgebra::{Matrix3, Matrix6, Rotation3, SMatrix, Vector3, Vector6};
use vislam::manifold::{se3, so3};

use super::oracle::{cross, small_vector, twist_of};

type Real = FBig<HalfEven, 2>;

const BITS: usize = 200;

/// A direction of length one in which all components differ.
pub const AXIS: Vector3<f64> = Vector3::new(0.48, 0.6, 0.64);

/// A translation that is neither along nor across it.
const RHO: Vector3<f64> = Vector3::new(0.7, -0.2, 0.4);

/// The largest relative errors at three angles around this one: those of the textbook's angle,
/// Jacobian, corner Q, logarithm and exponential, and that of the library.
pub fn errors_near(angle: f64) -> [f64; 6] {
    largest(angle, |angle| {
        let [of_angle, log, library_log] = log_errors(angle);
        let [diagonal, corner, library_jacobian] = jacobian_errors(angle);
        let [exp, library_exp] = exp_errors(angle);
        let library = library_log.max(library_jacobian).max(library_exp);
        [of_angle, diagonal, corner, log, exp, library]
    })
}

/// The same of the textbook's logarithm and of the library's, at angles about as far from π as `gap`.
pub fn errors_near_half_turn(gap: f64) -> [f64; 2] {
    largest(gap, |gap| {
        let [_, log, library] = log_errors(PI - gap);
        [log, library]
    })
}

fn largest<const N: usize>(angle: f64, errors: fn(f64) -> [f64; N]) -> [f64; N] {
    let three = [1.0, 0.9, 1.1].map(|factor| errors(factor * angle));
    std::array::from_fn(|k| three.iter().map(|errors| errors[k]).fold(0.0, f64::max))
}

/// Of Rodrigues' formula with its coefficients as they are printed, and of the library.
fn exp_errors(angle: f64) -> [f64; 2] {
    let phi = angle * AXIS;
    let truth = series::<3>(&cross(&phi), 0);
    [relative(&textbook_exp(&phi, 1.0), &truth), relative(so3::exp(&phi).matrix(), &truth)]
}

/// Of the angle as the arc cosine of the trace, of the vector with that angle over its sine in front
/// of the skew-symmetric part, and of the library's vector.
fn log_errors(angle: f64) -> [f64; 3] {
    let phi = angle * AXIS;
    let rotation = Rotation3::from_matrix_unchecked(series::<3>(&cross(&phi), 0));
    [
        (textbook_angle(&rotation) / phi.norm() - 1.0).abs(),
        relative(&textbook_log(&rotation), &phi),
        relative(&so3::log(&rotation), &phi),
    ]
}

/// Of the two blocks of a pose's left Jacobian by the textbook, and of the library's worse one.
fn jacobian_errors(angle: f64) -> [f64; 3] {
    let phi = angle * AXIS;
    let xi = twist_of(&RHO, &phi);
    let (truth, textbook) = (series::<6>(&bracket(&xi), 1), textbook_jacobian(&xi));
    let library = se3::left_jacobian(&xi);
    let block = |matrix: &Matrix6<f64>, column| matrix.fixed_view::<3, 3>(0, column).into_owned();
    let error = |matrix, column| relative(&block(matrix, column), &block(&truth, column));
    [error(&textbook, 0), error(&textbook, 3), error(&library, 0).max(error(&library, 3))]
}

/// The largest error of an entry against the largest entry; one when nothing is right.
fn relative<const R: usize, const C: usize>(
    computed: &SMatrix<f64, R, C>,
    truth: &SMatrix<f64, R, C>,
) -> f64 {
    let error = (computed - truth).amax() / truth.amax();
    if computed.iter().all(|entry| entry.is_finite()) { error.min(1.0) } else { 1.0 }
}

/// The exponential with its coefficients as printed, the second power times a factor.
pub fn textbook_exp(phi: &Vector3<f64>, factor: f64) -> Matrix3<f64> {
    let (turn, t) = (cross(phi), phi.norm());
    Matrix3::identity() + t.sin() / t * turn + factor * (1.0 - t.cos()) / t.powi(2) * turn * turn
}

fn textbook_angle(rotation: &Rotation3<f64>) -> f64 {
    (0.5 * (rotation.matrix().trace() - 1.0)).clamp(-1.0, 1.0).acos()
}

fn textbook_log(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let angle = textbook_angle(rotation);
    angle / angle.sin() * small_vector(rotation.matrix())
}

/// The left Jacobian of a pose with its coefficients as printed in most places.
fn textbook_jacobian(xi: &Vector6<f64>) -> Matrix6<f64> {
    let (rho, phi) = (xi.fixed_rows::<3>(0).into(), xi.fixed_rows::<3>(3).into_owned());
    let (step, turn, t) = (cross(&rho), cross(&phi), phi.norm());
    let (sine, cosine) = t.sin_cos();
    let first = (1.0 - cosine) / t.powi(2);
    let second = (t - sine) / t.powi(3);
    let third = (t * t + 2.0 * cosine - 2.0) / (2.0 * t.powi(4));
    let fourth = (2.0 * t - 3.0 * sine + t * cosine) / (2.0 * t.powi(5));
    let middle = turn * step * turn;
    let diagonal = Matrix3::identity() + first * turn + second * turn * turn;
    let corner = 0.5 * step
        + second * (turn * step + step * turn + middle)
        + third * (turn * turn * step + step * turn * turn - 3.0 * middle)
        + fourth * (middle * turn + turn * middle);
    triangular(&diagonal, &corner)
}

/// The 6×6 matrix of the bracket with a twist.
fn bracket(xi: &Vector6<f64>) -> Matrix6<f64> {
    triangular(&cross(&xi.fixed_rows::<3>(3).into()), &cross(&xi.fixed_rows::<3>(0).into()))
}

/// The 6×6 matrix of a block that stands twice on the diagonal and one in the upper right corner.
fn triangular(diagonal: &Matrix3<f64>, corner: &Matrix3<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(diagonal);
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(corner);
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(diagonal);
    matrix
}

/// The sum of Aⁿ/(n+shift)!, rounded once at the end.
fn series<const N: usize>(matrix: &SMatrix<f64, N, N>, shift: u32) -> SMatrix<f64, N, N> {
    let real =
        |value: f64| Real::try_from(value).expect("a finite number").with_precision(BITS).value();
    let factor: Vec<Real> = matrix.iter().map(|&entry| real(entry)).collect();
    let mut term: Vec<Real> = SMatrix::<f64, N, N>::identity().iter().map(|&e| real(e)).collect();
    let mut sum = term.clone();
    for n in 1..=50 {
        let divisor = real(f64::from(n + shift));
        let entry = |k: usize| {
            let (row, column) = (k % N, k / N);
            let products = (0..N).map(|i| &term[row + i * N] * &factor[i + column * N]);
            products.fold(real(0.0), |sum, product| sum + product) / &divisor
        };
        term = (0..N * N).map(entry).collect();
        sum.iter_mut().zip(&term).for_each(|(sum, term)| *sum += term);
        // The entries of the sum that are not zero are at least a tenth of the first power's.
        if term.iter().all(|entry| entry.to_f64().value().abs() < 1e-40 * matrix.amax()) {
            break;
        }
    }
    SMatrix::from_iterator(sum.iter().map(|entry| entry.to_f64().value()))
}
