//! The least change that sets directions free.

use nalgebra::DMatrix;

use super::*;

/// Rows that claim to know directions, and the covariance of errors.
#[derive(Debug, Clone)]
pub struct Claiming {
    rows: DMatrix<f64>,
    directions: DMatrix<f64>,
    covariance: DMatrix<f64>,
}

impl Claiming {
    /// Rows of so many coordinates, some of which are known much better than others.
    pub fn drawn(draw: &mut Draw, rows: usize, size: usize) -> Self {
        let mut normals =
            |rows: usize, columns| DMatrix::from_fn(rows, columns, |_, _| draw.normal());
        let (rows, directions) = (normals(rows, size), normals(size, 3));
        let mixing = DMatrix::<f64>::identity(size, size) + 0.2 * normals(size, size);
        let sigmas = DMatrix::from_fn(size, size, |row, column| {
            if row == column { 10.0_f64.powf(draw.uniform(-1.0..0.5)) } else { 0.0 }
        });
        let root = mixing * sigmas;
        Self { rows, directions, covariance: &root * root.transpose() }
    }
}

/// The inverse of a matrix of an instance, which has one.
fn inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, columns) = matrix.shape();
    matrix.clone().try_inverse().unwrap_or_else(|| DMatrix::zeros(rows, columns))
}

/// Rows against a projection in coordinates in which all errors are independent and of size one.
///
/// # Errors
///
/// A failure, which names what was made as small as can be where that is known.
pub fn least_change(answer: &dyn Transport, claiming: &Claiming) -> Result<(), Failure> {
    let Claiming { rows, directions, covariance } = claiming;
    let obtained = Answer(answer).restored(rows, directions, covariance)?;
    let size = directions.nrows();
    let root = covariance.clone().cholesky().map_or(DMatrix::zeros(size, size), |it| it.l());
    let whitened = inverse(&root);
    let basis = (&whitened * directions).qr().q();
    let in_units = rows * &root;
    let expected = (&in_units - &in_units * &basis * basis.transpose()) * whitened;
    let claimed = rows * directions;
    // What is taken away by directions that are measured with a matrix.
    let measured_by = |by: &DMatrix<f64>| {
        let measured = by * directions;
        rows - &claimed * inverse(&directions.tr_mul(&measured)) * measured.transpose()
    };
    let informed = inverse(covariance) * directions;
    let gram = directions.tr_mul(&informed);
    let mut one_by_one = rows.clone();
    for k in 0..directions.ncols() {
        one_by_one -= claimed.column(k) * informed.column(k).transpose() / gram[(k, k)];
    }
    compare("the table of rows", &obtained, &expected)
        .within(1e-8)
        .or(&UNWEIGHTED, &measured_by(&DMatrix::identity(size, size)))
        .or(&COVARIANCE_FOR_INFORMATION, &measured_by(covariance))
        .or(&GRAM_NOT_INVERTED, &(rows - &claimed * informed.transpose()))
        .or(&GRAM_NOT_INVERTED, &(rows - &claimed * &gram * informed.transpose()))
        .or(&ONE_BY_ONE, &one_by_one)
        .judge()
        .map_err(|failure| {
            failure.given(&[
                ("rows, by columns", &rows.as_slice()),
                ("directions, by columns", &directions.as_slice()),
                ("covariance, by columns", &covariance.as_slice()),
            ])
        })
}
