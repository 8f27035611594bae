//! The algorithms once more, in copies that count while they compute.

use nalgebra::{DMatrix, DVector, Isometry3, SMatrix, Vector3};
use vislam::filtering::{Form, correct, innovation_squared};
use vislam::preintegration::Preintegrated;
use vislam::reprojection::Pinhole;

use crate::chapter::Chapter;
use crate::counter::Counter;
use crate::random::Random;

/// Products of a pixel with both of its Jacobians, and the largest difference from the library's.
fn projection() -> (usize, f64) {
    let mut random = Random::new(7);
    let (camera, point) = (random.camera(), Vector3::new(0.4, -0.3, 5.0));
    let pose =
        Isometry3::from_parts(Vector3::new(0.1, 0.2, 0.3).into(), random.rotation(0.2).into());
    let (counter, rotation) = (Counter::default(), pose.rotation.to_rotation_matrix());
    let Pinhole { fx, fy, .. } = camera;
    let seen = counter.times(rotation.matrix(), &point) + pose.translation.vector;
    // The pixel is asked for twice: once for itself, and once by its derivative.
    counter.count(2 * 4);
    let (x, y, z) = (seen.x / seen.z, seen.y / seen.z, 1.0 / seen.z);
    counter.count(3);
    let lens = SMatrix::<f64, 2, 3>::new(fx * z, 0.0, -fx * z * x, 0.0, fy * z, -fy * z * y);
    counter.count(4);
    let by_point = counter.times(&lens, rotation.matrix());
    counter.count(2 * 6);
    let turned = [0, 1].map(|row| point.cross(&by_point.row(row).transpose()));
    let library = camera.project_with_jacobians(&pose, &point).expect("it is ahead");
    let turns = library.by_pose.fixed_columns::<3>(3).transpose();
    let off = [0, 1].map(|row| (turns.column(row) - turned[row]).amax());
    let off = off[0].max(off[1]).max((library.by_point - by_point).amax());
    (counter.products(), off / library.by_pose.amax())
}

/// Corrects a covariance by as many rows, and by a window of as many columns, as is said, and gives the products; with
/// `gate`, those of the innovation alone.
pub fn correction(rows: usize, columns: usize, gate: bool) -> usize {
    let mut random = Random::new(8);
    let root = DMatrix::from_fn(columns, columns, |_, _| random.normal(0.1));
    let mut covariance = &root * root.transpose() + 0.01 * DMatrix::identity(columns, columns);
    let jacobian = DMatrix::from_fn(rows, columns, |_, _| random.normal(1.0));
    let residual = DVector::from_fn(rows, |_, _| random.normal(1.0));
    let counter = Counter::default();
    let seen = counter.product(&jacobian, &covariance);
    let expected = counter.product(&seen, &jacobian.transpose()) + DMatrix::identity(rows, rows);
    let lower = counter.cholesky(&expected);
    let column = DMatrix::from_column_slice(rows, 1, residual.as_slice());
    let whitened = counter.solve_lower(&lower, &column).column(0).into_owned();
    if gate {
        let library = innovation_squared(&covariance, &jacobian, &residual).expect("a covariance");
        assert!((whitened.norm_squared() / library - 1.0).abs() < 1e-9, "the library's innovation");
        return counter.products();
    }
    let gain = counter.solve_lower(&lower, &seen);
    let step = -counter.transposed_times(&gain, &whitened);
    let mut after = covariance.clone();
    // The library computes both halves.
    counter.count(rows * columns * (columns - 1) / 2);
    counter.less_square(&mut after, &gain);
    let library = correct(&mut covariance, &jacobian, &residual, Form::Difference);
    let apart = (library.expect("a covariance").step - &step).amax();
    assert!(apart < 1e-8 * step.amax(), "the library's step: {apart}");
    assert!((after - &covariance).amax() < 1e-8 * covariance.amax(), "the library's covariance");
    counter.products()
}

pub fn numbers(chapter: &mut Chapter) {
    let (products, off) = projection();
    assert!(off < 1e-12, "the counted blocks are those of the library: {off}");
    chapter.number("projection_products", products as f64, "", 0);
    // Two rows of two blocks of six, through the three of the landmark.
    let pair = Counter::default();
    pair.times(&SMatrix::<f64, 2, 3>::zeros(), &SMatrix::<f64, 3, 6>::zeros());
    pair.times(&SMatrix::<f64, 6, 2>::zeros(), &SMatrix::<f64, 2, 6>::zeros());
    chapter.number("pair_products", pair.products() as f64, "", 0);
    let kept = size_of::<Preintegrated>() / size_of::<f64>();
    chapter.number("numbers_kept", kept as f64, "", 0);
}
