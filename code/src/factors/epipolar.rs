//! Two pixels of one point by the motion between their cameras.

use nalgebra::{Matrix3, SMatrix, Vector1, Vector2, Vector3};

use crate::least_squares::{Factor, Key};
use crate::manifold::so3;
use crate::robust_two_view::RelativeMotion;

// ANCHOR: epipolar_factor
/// Two pictures of one point whose depth is not asked for. The residual is the Sampson distance
/// [@hartley2004]: the volume that two rays span with the baseline, over its standard deviation.
#[derive(Debug, Clone, Copy)]
pub struct Epipolar {
    /// How the second camera stands to the first.
    pub motion: Key<RelativeMotion>,
    /// The slopes in the first camera, with a one below.
    pub first: Vector3<f64>,
    /// The slopes in the second camera, with a one below.
    pub second: Vector3<f64>,
    /// The standard deviations of the slopes in the first and the second.
    pub sigmas: [Vector2<f64>; 2],
}
// ANCHOR_END: epipolar_factor

/// The volume of two rays with the baseline, and what becomes of their noise in it.
struct Volume {
    value: f64,
    sigma: f64,
    /// The line Eᵀ b of the first picture.
    line_in_first: Vector3<f64>,
    /// Of both lines the first two entries, times the squared sigmas.
    weighted: [Vector3<f64>; 2],
}

impl Epipolar {
    /// The volume, or `None` where the rays have no epipolar lines.
    fn volume(&self, essential: &Matrix3<f64>) -> Option<Volume> {
        let lines = [essential.tr_mul(&self.second), essential * self.first];
        let weighted = [0, 1].map(|picture| {
            let (line, sigma): (&Vector3<f64>, &Vector2<f64>) =
                (&lines[picture], &self.sigmas[picture]);
            Vector3::new(line.x * sigma.x * sigma.x, line.y * sigma.y * sigma.y, 0.0)
        });
        let sigma = (weighted[0].dot(&lines[0]) + weighted[1].dot(&lines[1])).sqrt();
        let value = self.second.dot(&lines[1]);
        (sigma > 0.0).then_some(Volume { value, sigma, line_in_first: lines[0], weighted })
    }
}

impl Factor<1> for Epipolar {
    type Variables = (RelativeMotion,);
    type Jacobians = (SMatrix<f64, 1, 5>,);

    fn variables(&self) -> (Key<RelativeMotion>,) {
        (self.motion,)
    }

    // ANCHOR: epipolar_residual
    fn residual(&self, (motion,): (&RelativeMotion,)) -> Option<Vector1<f64>> {
        let Volume { value, sigma, .. } = self.volume(&motion.essential())?;
        Some(Vector1::new(value / sigma))
    }

    fn linearize(&self, (motion,): (&RelativeMotion,)) -> Option<(Vector1<f64>, Self::Jacobians)> {
        let Volume { value, sigma, line_in_first, weighted } = self.volume(&motion.essential())?;
        let rotation = motion.rotation.matrix();
        let (turned, by_tilt) = (rotation * self.first, motion.direction_by_step());
        let mut second_by_step = SMatrix::<f64, 3, 5>::zeros();
        let by_turn = -motion.essential() * so3::hat(&self.first);
        second_by_step.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_turn);
        second_by_step.fixed_view_mut::<3, 2>(0, 3).copy_from(&(-so3::hat(&turned) * by_tilt));
        let mut first_by_step = SMatrix::<f64, 3, 5>::zeros();
        first_by_step.fixed_view_mut::<3, 3>(0, 0).copy_from(&so3::hat(&line_in_first));
        let by_direction = rotation.tr_mul(&(so3::hat(&self.second) * by_tilt));
        first_by_step.fixed_view_mut::<3, 2>(0, 3).copy_from(&by_direction);
        // The standard deviation moves with the lines.
        let residual = value / sigma;
        let shrinking = residual / sigma;
        let by_second = self.second - shrinking * weighted[1];
        let jacobian =
            by_second.tr_mul(&second_by_step) - (shrinking * weighted[0]).tr_mul(&first_by_step);
        Some((Vector1::new(residual), (jacobian / sigma,)))
    }
    // ANCHOR_END: epipolar_residual
}
