//! Shapes that several scenes draw.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};
use vislam::reprojection::Pinhole;

/// An ellipsoid in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// Its centre, in metres.
    pub centre: Vector3<f64>,
    /// Half of its axes, in metres.
    pub half_axes: Vector3<f64>,
    /// How its axes are turned.
    pub turn: UnitQuaternion<f64>,
}

impl Ellipsoid {
    /// The places that are this many standard deviations from a mean.
    pub fn of(centre: &Vector3<f64>, covariance: &Matrix3<f64>, sigmas: f64) -> Self {
        let SymmetricEigen { eigenvalues, mut eigenvectors } = covariance.symmetric_eigen();
        if eigenvectors.determinant() < 0.0 {
            eigenvectors.column_mut(0).neg_mut();
        }
        let turn = Rotation3::from_matrix_unchecked(eigenvectors);
        let half_axes = eigenvalues.map(|variance| sigmas * variance.max(0.0).sqrt());
        Self { centre: *centre, half_axes, turn: turn.into() }
    }
}

/// The edges of a camera: from its centre to the corners of its image, put so many metres ahead, and around the image.
pub fn frustum(
    camera: &Pinhole,
    camera_from_world: &Isometry3<f64>,
    depth: f64,
) -> Vec<Vec<Vector3<f64>>> {
    let world_from_camera = camera_from_world.inverse();
    // The principal point is the middle of the image.
    let corner = |across: f64, down: f64| {
        let ray = Vector3::new(across * camera.cx / camera.fx, down * camera.cy / camera.fy, 1.0);
        world_from_camera.rotation * (depth * ray) + world_from_camera.translation.vector
    };
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y));
    let centre = world_from_camera.translation.vector;
    let mut edges: Vec<_> = corners.iter().map(|corner| vec![centre, *corner]).collect();
    edges.push(corners.iter().chain(corners.first()).copied().collect());
    edges
}

/// A ring around a place of a path: the places across its direction that are this many standard deviations away.
pub fn ring_around(
    place: &Vector3<f64>,
    direction: &Vector3<f64>,
    covariance: &Matrix3<f64>,
    sigmas: f64,
) -> Vec<Vector3<f64>> {
    const PARTS: usize = 32;
    let ahead = direction.normalize();
    let least = ahead.iamin();
    let across = ahead.cross(&Vector3::ith(least, 1.0)).normalize();
    let basis = nalgebra::Matrix3x2::from_columns(&[across, ahead.cross(&across)]);
    let SymmetricEigen { eigenvalues, eigenvectors } =
        (basis.transpose() * covariance * basis).symmetric_eigen();
    let axes = basis * eigenvectors;
    let around = |part: usize| {
        let (sine, cosine) = (TAU * part as f64 / PARTS as f64).sin_cos();
        let lengths = eigenvalues.map(|variance| sigmas * variance.max(0.0).sqrt());
        place + axes * nalgebra::Vector2::new(cosine * lengths.x, sine * lengths.y)
    };
    (0..=PARTS).map(around).collect()
}
