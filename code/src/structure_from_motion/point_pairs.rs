//! Points that are said to be the same in two worlds.

use nalgebra::{DMatrix, Matrix3, SMatrix, Vector3};

use super::absolute_orientation::{ScaleFreedom, absolute_orientation};
use crate::manifold::so3;
use crate::observability::Similarity;
use crate::robust_two_view::{Correspondences, Effort};

// ANCHOR: point_pairs
/// Points of a first and a second world that are said to be the same, not all of them rightly: data
/// about the [`Similarity`] that takes the first world to the second.
#[derive(Debug, Clone, Copy)]
pub struct PointPairs<'a> {
    /// Places in the first and the second world.
    pub pairs: &'a [(Vector3<f64>, Vector3<f64>)],
    /// The standard deviation of each coordinate of their difference, in the second world's unit.
    pub sigma: f64,
}

impl Correspondences for PointPairs<'_> {
    type Estimate = Similarity;
    const SAMPLE: usize = 3;
    const DEGREES: usize = 3;
    const PARAMETERS: usize = 7;

    fn count(&self) -> usize {
        self.pairs.len()
    }

    fn through(&self, sample: &[usize], give: &mut dyn FnMut(Similarity)) {
        if let Some(similarity) = self.of(sample) {
            give(similarity);
        }
    }

    fn squared_errors(&self, similarity: &Similarity, _gate: f64) -> impl Fn(usize, usize) -> f64 {
        let (similarity, variance) = (*similarity, self.sigma * self.sigma);
        move |here, there| {
            (similarity.point(&self.pairs[here].0) - self.pairs[there].1).norm_squared() / variance
        }
    }
    // ANCHOR_END: point_pairs

    /// In closed form, from wherever it starts.
    fn refined(&self, _: &Similarity, data: &[usize], _: Effort) -> Option<Similarity> {
        self.of(data)
    }

    /// By a shift of the second world, a rotation vector on the right, and the scale's logarithm.
    fn covariance(&self, similarity: &Similarity, data: &[usize]) -> Option<DMatrix<f64>> {
        let mut information = DMatrix::zeros(7, 7);
        let turned = similarity.scale * similarity.rotation.matrix();
        for datum in data {
            let point = self.pairs[*datum].0;
            let mut rows = SMatrix::<f64, 3, 7>::zeros();
            rows.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
            rows.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-turned * so3::hat(&point)));
            rows.set_column(6, &(turned * point));
            information += rows.tr_mul(&rows) / (self.sigma * self.sigma);
        }
        Some(information.cholesky()?.inverse())
    }
}

impl PointPairs<'_> {
    /// The similarity of some pairs.
    fn of(&self, data: &[usize]) -> Option<Similarity> {
        let pairs: Vec<_> = data.iter().map(|datum| self.pairs[*datum]).collect();
        absolute_orientation(&pairs, ScaleFreedom::Free).ok()
    }
}
