//! Ways to the chapter's results that do not use its formulas.

use nalgebra::{Matrix3, Matrix4, Rotation3, SMatrix, Vector3, Vector6};

/// The matrix whose product with a vector is the cross product.
pub fn cross(vector: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[0, 1, 2].map(|k| vector.cross(&Vector3::ith(k, 1.0))))
}

/// The rotation about an axis as the proof of Euler's theorem builds it: two vectors across the
/// axis turn in their plane, and the axis stays.
pub fn turned(phi: &Vector3<f64>) -> Rotation3<f64> {
    let angle = phi.norm();
    if angle == 0.0 {
        return Rotation3::identity();
    }
    let axis = phi / angle;
    let aside = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    let basis = Matrix3::from_columns(&[axis, aside, axis.cross(&aside)]);
    let (sine, cosine) = angle.sin_cos();
    let plane = Matrix3::new(1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine);
    Rotation3::from_matrix_unchecked(basis * plane * basis.transpose())
}

/// The rotation at time one of a body that starts unturned and turns at the constant rate `phi`
/// in its own axes: R' = R φ^ in steps of Runge and Kutta.
pub fn integrated(phi: &Vector3<f64>) -> Matrix3<f64> {
    let (rate, steps) = (cross(phi), 400);
    let dt = 1.0 / f64::from(steps);
    let mut rotation = Matrix3::identity();
    for _ in 0..steps {
        let first = rotation * rate;
        let second = (rotation + 0.5 * dt * first) * rate;
        let third = (rotation + 0.5 * dt * second) * rate;
        let fourth = (rotation + dt * third) * rate;
        rotation += dt / 6.0 * (first + 2.0 * second + 2.0 * third + fourth);
    }
    rotation
}

/// The twist of a translation and a rotation vector.
pub fn twist_of(rho: &Vector3<f64>, phi: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(rho.x, rho.y, rho.z, phi.x, phi.y, phi.z)
}

/// The pose of a twist, by the power series of the 4×4 matrix.
pub fn exponential_of(xi: &Vector6<f64>) -> Matrix4<f64> {
    let (rho, phi) = (xi.fixed_rows::<3>(0), cross(&xi.fixed_rows::<3>(3).into()));
    let mut matrix = Matrix4::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&phi);
    matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&rho);
    series(&matrix)
}

/// The power series of the matrix exponential, for matrices of a moderate size.
pub fn series<const N: usize>(matrix: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    let mut term = SMatrix::<f64, N, N>::identity();
    let mut sum = term;
    for n in 1..60 {
        term = term * matrix / f64::from(n);
        sum += term;
    }
    sum
}

/// The vector of a rotation that is hardly one: its skew-symmetric part.
pub fn small_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let skew = 0.5 * (rotation - rotation.transpose());
    Vector3::new(skew[(2, 1)], skew[(0, 2)], skew[(1, 0)])
}

/// The twist of a pose that is hardly one.
pub fn small_twist(pose: &Matrix4<f64>) -> Vector6<f64> {
    let rotation = pose.fixed_view::<3, 3>(0, 0).into_owned();
    twist_of(&pose.fixed_view::<3, 1>(0, 3).into_owned(), &small_vector(&rotation))
}
