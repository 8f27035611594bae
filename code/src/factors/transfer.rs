//! Two pixels of one point by what takes the first picture to the second.

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Rotation3, SMatrix, SVector, Vector2, Vector3};

use crate::least_squares::{Factor, Key, Manifold};
use crate::manifold::so3;

// ANCHOR: transfer
/// What takes the rays of one picture to those of another whatever their depths are, as a variable of
/// `D` coordinates.
pub trait Transfer<const D: usize>: Manifold {
    /// Its matrix.
    fn matrix(&self) -> Matrix3<f64>;

    /// The derivative of the transferred ray by a step.
    fn ray_by_step(&self, ray: &Vector3<f64>) -> SMatrix<f64, 3, D>;
}

/// A camera that only turned.
impl Transfer<3> for Rotation3<f64> {
    fn matrix(&self) -> Matrix3<f64> {
        *Rotation3::matrix(self)
    }

    fn ray_by_step(&self, ray: &Vector3<f64>) -> Matrix3<f64> {
        -Rotation3::matrix(self) * so3::hat(ray)
    }
}

/// The homography of a plane, column by column.
impl Transfer<9> for SVector<f64, 9> {
    fn matrix(&self) -> Matrix3<f64> {
        Matrix3::from_column_slice(self.as_slice())
    }

    fn ray_by_step(&self, ray: &Vector3<f64>) -> SMatrix<f64, 3, 9> {
        let identity = Matrix3::identity();
        ray.transpose().kronecker(&identity)
    }
}
// ANCHOR_END: transfer

// ANCHOR: transferred
/// Two pictures of one point that the same matrix takes one to the other. The residual is W times the
/// transferred slopes less the measured ones.
#[derive(Debug, Clone, Copy)]
pub struct Transferred<T> {
    /// What takes the first ray to the second.
    pub transfer: Key<T>,
    /// The slopes in the first camera, with a one below.
    pub first: Vector3<f64>,
    /// The slopes in the second camera.
    pub second: Vector2<f64>,
    /// The matrix W, from [`transfer_covariance`].
    pub sqrt_information: Matrix2<f64>,
}
// ANCHOR_END: transferred

// ANCHOR: transfer_covariance
/// The covariance of the transferred slopes less the measured ones, when both have been measured with
/// these standard deviations: what the first becomes on its way, and the second. `None` for a ray
/// that does not come to lie in front.
pub fn transfer_covariance(
    matrix: &Matrix3<f64>,
    first: &Vector3<f64>,
    sigmas: &[Vector2<f64>; 2],
) -> Option<Matrix2<f64>> {
    let way = slopes_by_ray(&(matrix * first))? * matrix.fixed_columns::<2>(0);
    let squares = sigmas.map(|sigma| Matrix2::from_diagonal(&sigma.component_mul(&sigma)));
    Some(way * squares[0] * way.transpose() + squares[1])
}
// ANCHOR_END: transfer_covariance

/// The 2×3 derivative of the slopes of a ray, when it points forward.
fn slopes_by_ray(ray: &Vector3<f64>) -> Option<Matrix2x3<f64>> {
    let (x, y) = (ray.x / ray.z, ray.y / ray.z);
    let matrix = Matrix2x3::new(1.0, 0.0, -x, 0.0, 1.0, -y) / ray.z;
    (ray.z > 0.0 && matrix.iter().all(|entry| entry.is_finite())).then_some(matrix)
}

macro_rules! transferred {
    ($kind:ty, $dimension:literal) => {
        impl Factor<2> for Transferred<$kind> {
            type Variables = ($kind,);
            type Jacobians = (SMatrix<f64, 2, $dimension>,);

            fn variables(&self) -> (Key<$kind>,) {
                (self.transfer,)
            }

            fn residual(&self, (transfer,): (&$kind,)) -> Option<Vector2<f64>> {
                let ray = Transfer::matrix(transfer) * self.first;
                let is_in_front = ray.z > 0.0;
                let off = ray.xy() / ray.z - self.second;
                is_in_front.then(|| self.sqrt_information * off)
            }

            fn linearize(&self, (transfer,): (&$kind,)) -> Option<(Vector2<f64>, Self::Jacobians)> {
                let residual = self.residual((transfer,))?;
                let by_ray = slopes_by_ray(&(Transfer::matrix(transfer) * self.first))?;
                let by_step = self.sqrt_information * by_ray * transfer.ray_by_step(&self.first);
                Some((residual, (by_step,)))
            }
        }
    };
}

transferred!(Rotation3<f64>, 3);
transferred!(SVector<f64, 9>, 9);
