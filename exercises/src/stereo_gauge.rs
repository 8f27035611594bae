//! What a second lens fixes. Edition 1.
//!
//! `cargo test -p exercises stereo_gauge`

use exercise_spec::stereo_gauge::{Camera, Scene};
use nalgebra::{DMatrix, Isometry3, Matrix2x3, Matrix2x6, Vector3};

/// The pose of the right camera. It looks the same way as the left one and stands `baseline`
/// metres from it, along the x axis of the **left camera**.
pub fn right_from_world(left_from_world: Isometry3<f64>, baseline: f64) -> Isometry3<f64> {
    let _ = (left_from_world, baseline);
    todo!("from the world to the left camera, and on to the right one")
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
    let _ = (camera, left_from_world, baseline, point_in_world);
    todo!("how the right pixel moves with the rig, and how with the point")
}

/// The reduced camera system S: the Hessian of half the sum of squared whitened residuals, where
/// all residuals are zero, with the points eliminated. It has six rows for each rig, for the
/// twist on the left of its left pose, rig after rig. With `hold_first` rig 0 does not move and
/// has no rows. With a baseline each rig sees each point twice, both coordinates of both pixels
/// measured; without one, in its left camera alone.
pub fn reduced_system(scene: Scene, baseline: Option<f64>, hold_first: bool) -> DMatrix<f64> {
    let _ = (scene, baseline, hold_first);
    todo!("what the rigs feel of each other, through points that give way")
}

/// The eigenvalues, ascending, of S when every unknown is measured in the unit in which its
/// entry on the diagonal of S is one. S is symmetric with a positive diagonal.
pub fn stiffnesses(reduced: DMatrix<f64>) -> Vec<f64> {
    let _ = reduced;
    todo!("first the units, then the eigenvalues")
}

/// What the rigs do while the world is moved and all their pictures stay the same, as
/// velocities: six rows for each rig, as above, and six columns. In column i all points go from
/// P to exp(s e) P, where e is the i-th unit twist, and the entries are derivatives by s at zero.
pub fn rigid_motions(left_from_world: Vec<Isometry3<f64>>) -> DMatrix<f64> {
    let _ = left_from_world;
    todo!("a 6×6 block for each rig")
}
