//! What a second lens fixes.

use exercise_spec::stereo_gauge::{Camera, Scene};
use nalgebra::{DMatrix, Isometry3, Matrix2x3, Matrix2x6, Matrix3, Point3, Vector3};
use vislam::manifold::{se3, so3};

/// The pose of the right camera. It looks the same way as the left one and stands `baseline`
/// metres from it, along the x axis of the **left camera**.
pub fn right_from_world(left_from_world: Isometry3<f64>, baseline: f64) -> Isometry3<f64> {
    Isometry3::translation(-baseline, 0.0, 0.0) * left_from_world
}

/// The derivatives of the pixel in the **right** camera. First by a twist ξ = (ρ, φ) on the
/// left of the pose of the **left** camera, exp(ξ) T, at ξ = 0; the right camera is bolted to
/// it. Then by the point in the world. In pixels per metre and per radian.
pub fn right_blocks(
    camera: Camera,
    left_from_world: Isometry3<f64>,
    baseline: f64,
    point_in_world: Vector3<f64>,
) -> (Matrix2x6<f64>, Matrix2x3<f64>) {
    let point = Point3::from(point_in_world);
    let in_left = (left_from_world * point).coords;
    let in_right = (right_from_world(left_from_world, baseline) * point).coords;
    let projection = camera.pinhole().projection_jacobian(&in_right).unwrap_or_default();
    // The twist meets the point in the left camera, the projection meets it in the right one.
    let mut by_twist = Matrix2x6::zeros();
    by_twist.fixed_columns_mut::<3>(0).copy_from(&projection);
    by_twist.fixed_columns_mut::<3>(3).copy_from(&(-projection * so3::hat(&in_left)));
    (by_twist, projection * left_from_world.rotation.to_rotation_matrix())
}

/// The reduced camera system S: the Hessian of half the sum of squared whitened residuals, where
/// all residuals are zero, with the points eliminated. It has six rows for each rig, for the
/// twist on the left of its left pose, rig after rig. With `hold_first` rig 0 does not move and
/// has no rows. With a baseline each rig sees each point twice, both coordinates of both pixels
/// measured; without one, in its left camera alone.
pub fn reduced_system(scene: Scene, baseline: Option<f64>, hold_first: bool) -> DMatrix<f64> {
    let held = usize::from(hold_first);
    let size = 6 * (scene.left_from_world.len() - held);
    let mut reduced = DMatrix::zeros(size, size);
    for point in &scene.points {
        let mut own = Matrix3::zeros();
        let mut coupling = DMatrix::zeros(size, 3);
        for (rig, left_from_world) in scene.left_from_world.iter().enumerate() {
            // A left camera is a right one at no distance.
            for offset in [Some(0.0), baseline].into_iter().flatten() {
                let (by_twist, by_point) =
                    right_blocks(scene.camera, *left_from_world, offset, *point);
                own += by_point.tr_mul(&by_point);
                if rig >= held {
                    let row = 6 * (rig - held);
                    let mut block = reduced.fixed_view_mut::<6, 6>(row, row);
                    block += by_twist.tr_mul(&by_twist);
                    let mut meeting = coupling.fixed_view_mut::<6, 3>(row, 0);
                    meeting += by_twist.tr_mul(&by_point);
                }
            }
        }
        let inverse = own.try_inverse().unwrap_or_default();
        reduced -= &coupling * inverse * coupling.transpose();
    }
    reduced / (scene.sigma * scene.sigma)
}

/// The eigenvalues, ascending, of S when every unknown is measured in the unit in which its
/// entry on the diagonal of S is one. S is symmetric with a positive diagonal.
pub fn stiffnesses(reduced: DMatrix<f64>) -> Vec<f64> {
    let unit = reduced.diagonal().map(|stiffness| stiffness.sqrt().recip());
    let scaled = reduced.component_mul(&(&unit * unit.transpose()));
    let mut stiffnesses: Vec<f64> = scaled.symmetric_eigenvalues().iter().copied().collect();
    stiffnesses.sort_by(f64::total_cmp);
    stiffnesses
}

/// What the rigs do while the world is moved and all their pictures stay the same, as
/// velocities: six rows for each rig, as above, and six columns. In column i all points go from
/// P to exp(s e) P, where e is the i-th unit twist, and the entries are derivatives by s at zero.
pub fn rigid_motions(left_from_world: Vec<Isometry3<f64>>) -> DMatrix<f64> {
    let mut motions = DMatrix::zeros(6 * left_from_world.len(), 6);
    for (rig, pose) in left_from_world.iter().enumerate() {
        // T exp(-s e) sees the moved world as T saw the old one, and is exp(-s Ad(T) e) T.
        motions.fixed_view_mut::<6, 6>(6 * rig, 0).copy_from(&-se3::adjoint(pose));
    }
    motions
}
