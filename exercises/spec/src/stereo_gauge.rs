//! A second lens in bundle adjustment: what it fixes, and what it does not.

use nalgebra::{DMatrix, Isometry3, Matrix2x3, Matrix2x6, Vector3};
use serde::{Deserialize, Serialize};

pub use crate::camera::Camera;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: scene
/// Rigs that look at points. Each has a left camera and may have a right one of the same make.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The lens of all cameras.
    pub camera: Camera,
    /// The pose of each rig's left camera.
    pub left_from_world: Vec<Isometry3<f64>>,
    /// Points in world coordinates, in metres. Every camera sees every point.
    pub points: Vec<Vector3<f64>>,
    /// Standard deviation of each coordinate of a pixel, in pixels.
    pub sigma: f64,
}
// ANCHOR_END: scene

crate::signatures! {
    // ANCHOR: lens
    /// The pose of the right camera. It looks the same way as the left one and stands `baseline`
    /// metres from it, along the x axis of the **left camera**.
    fn right_from_world(left_from_world: Isometry3<f64>, baseline: f64) -> Isometry3<f64>;

    /// The derivatives of the pixel in the **right** camera. First by a twist ξ = (ρ, φ) on the
    /// left of the pose of the **left** camera, exp(ξ) T, at ξ = 0; the right camera is bolted to
    /// it. Then by the point in the world. In pixels per metre and per radian.
    fn right_blocks(
        camera: Camera,
        left_from_world: Isometry3<f64>,
        baseline: f64,
        point_in_world: Vector3<f64>,
    ) -> (Matrix2x6<f64>, Matrix2x3<f64>);
    // ANCHOR_END: lens

    // ANCHOR: system
    /// The reduced camera system S: the Hessian of half the sum of squared whitened residuals, where
    /// all residuals are zero, with the points eliminated. It has six rows for each rig, for the
    /// twist on the left of its left pose, rig after rig. With `hold_first` rig 0 does not move and
    /// has no rows. With a baseline each rig sees each point twice, both coordinates of both pixels
    /// measured; without one, in its left camera alone.
    fn reduced_system(scene: Scene, baseline: Option<f64>, hold_first: bool) -> DMatrix<f64>;

    /// The eigenvalues, ascending, of S when every unknown is measured in the unit in which its
    /// entry on the diagonal of S is one. S is symmetric with a positive diagonal.
    fn stiffnesses(reduced: DMatrix<f64>) -> Vec<f64>;
    // ANCHOR_END: system

    // ANCHOR: rigid
    /// What the rigs do while the world is moved and all their pictures stay the same, as
    /// velocities: six rows for each rig, as above, and six columns. In column i all points go from
    /// P to exp(s e) P, where e is the i-th unit twist, and the entries are derivatives by s at zero.
    fn rigid_motions(left_from_world: Vec<Isometry3<f64>>) -> DMatrix<f64>;
    // ANCHOR_END: rigid
}
