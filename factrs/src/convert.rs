//! Between the types of the book's library and those of factrs. The two use different versions of nalgebra, so
//! numbers are passed on one by one.

use factrs::linalg::{Matrix, Vector3};
use factrs::residuals::{Accel, Gyro};
use factrs::variables::{ImuBias, SE3, SO3, VectorVar3};
use nalgebra as ours;
use vislam::inertial::NavState;

pub fn vector(of: &ours::Vector3<f64>) -> Vector3 {
    Vector3::new(of.x, of.y, of.z)
}

pub fn our_vector(of: &Vector3) -> ours::Vector3<f64> {
    ours::Vector3::new(of.x, of.y, of.z)
}

pub fn point(of: &ours::Vector3<f64>) -> VectorVar3 {
    VectorVar3::new(of.x, of.y, of.z)
}

pub fn rotation(of: &ours::UnitQuaternion<f64>) -> SO3 {
    SO3::from_xyzw(of.i, of.j, of.k, of.w)
}

pub fn our_rotation(of: &SO3) -> ours::Rotation3<f64> {
    let quaternion = ours::Quaternion::new(of.w(), of.x(), of.y(), of.z());
    ours::UnitQuaternion::new_normalize(quaternion).to_rotation_matrix()
}

pub fn pose(of: &ours::Isometry3<f64>) -> SE3 {
    SE3::from_rot_trans(rotation(&of.rotation), vector(&of.translation.vector))
}

/// Pose and velocity of a state, apart as factrs has them.
pub fn our_state(pose: &SE3, velocity: &VectorVar3) -> NavState {
    NavState {
        world_from_body: our_rotation(pose.rot()),
        velocity: our_vector(&velocity.0),
        position: our_vector(&pose.xyz().into_owned()),
    }
}

pub fn bias(of: &vislam::inertial::ImuBias) -> ImuBias {
    ImuBias::new(Gyro(vector(&of.gyro)), Accel(vector(&of.accelerometer)))
}

pub fn our_bias(of: &ImuBias) -> vislam::inertial::ImuBias {
    let (gyro, accelerometer) = (our_vector(of.gyro()), our_vector(of.accel()));
    vislam::inertial::ImuBias { gyro, accelerometer }
}

pub fn matrix<const R: usize, const C: usize>(of: &ours::SMatrix<f64, R, C>) -> Matrix<R, C> {
    Matrix::from_iterator(of.iter().copied())
}

pub fn our_matrix<const R: usize, const C: usize>(of: &Matrix<R, C>) -> ours::SMatrix<f64, R, C> {
    ours::SMatrix::from_iterator(of.iter().copied())
}
