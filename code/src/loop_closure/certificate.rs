//! Whether a minimum is the lowest one there is.

use nalgebra::{Isometry3, Matrix3, Matrix3x4, Matrix4, Matrix4x3, Vector4};
use thiserror::Error;

use super::switches::positive;
use super::{Isotropy, LoopClosureError, RelativeMeasurement, SpatialGraph};
use crate::least_squares::SparseCholesky;
use crate::manifold::so3;

// ANCHOR: certificate
/// What can be said of poses as a minimum of the chordal cost of a graph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Certificate {
    /// No poses whatsoever cost less than the lower bound.
    Certified {
        /// What the poses cost.
        cost: f64,
        /// What any poses cost at least.
        lower_bound: f64,
        /// The certificate matrix is positive definite once this is added to its diagonal.
        shift: f64,
    },
    /// The certificate matrix has a negative eigenvalue. At a minimum that is not the lowest one it
    /// always has; at one that is, it has when the noise is so large that the relaxation is not tight, and
    /// also when the search for the minimum ended too early.
    Refused {
        /// What the poses cost.
        cost: f64,
        /// The smallest eigenvalue of the certificate matrix with the positions eliminated: an upper bound of
        /// it, which is the eigenvalue to a few digits.
        smallest_eigenvalue: f64,
    },
    /// Nothing can be said.
    NotApplicable(Inapplicable),
}
// ANCHOR_END: certificate

/// Why nothing can be said of poses as the lowest minimum.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Inapplicable {
    /// The cost is not a square in the entries of rotations.
    #[error(
        "the rotation of measurement {measurement} is not equally well known about all axes, and its \
         cost is no square of the entries of rotations; make the graph isotropic, which is another \
         problem"
    )]
    Rotation {
        /// The measurement's number.
        measurement: usize,
    },
    /// The cost is not a square in the entries of rotations and positions.
    #[error(
        "the translation of measurement {measurement} is not equally well known along all axes, so \
         that its weight turns with the first pose; make the graph isotropic, which is another problem"
    )]
    Translation {
        /// The measurement's number.
        measurement: usize,
    },
    /// Rotation and translation have errors in common.
    #[error(
        "measurement {measurement} has errors of rotation and translation that are correlated; make \
         the graph isotropic, which is another problem"
    )]
    Coupled {
        /// The measurement's number.
        measurement: usize,
    },
    /// The poses are no minimum.
    #[error(
        "the gradient of the chordal cost is {gradient_norm:.1e} standard deviations long, so this is no \
         minimum of it; solve the chordal problem first"
    )]
    NotStationary {
        /// Each coordinate measured by what it alone would move the cost.
        gradient_norm: f64,
    },
}

// ANCHOR: certify
/// Whether no poses have a lower chordal cost than these ([@carlonerosen2015; @rosen2019]).
///
/// With the rows of all rotations and positions side by side in a matrix X of three rows, the chordal
/// cost is ½ tr(X M Xᵀ). Let Λ have the symmetric part of Rᵢᵀ (X M)ᵢ in the block of each rotation and
/// zeros elsewhere: the Lagrange multipliers of Rᵢᵀ Rᵢ = I. If S = M − Λ is positive semidefinite, all
/// X whose rotations are orthogonal cost at least ½ tr Λ, and that is what a minimum costs. Implements
/// {eq:certificate-matrix} and {eq:dual-bound}; {thm:certificate} is the proof.
///
/// A computer cannot tell zero, which is an eigenvalue of S, from a little less. `tolerance` times the
/// mean of the rotations' entries on the diagonal of M, the shift ε, is added to the diagonal of all rotations, and what is then positive
/// definite, by a Cholesky factorization, proves the bound ½ tr Λ − 3/2 n ε for n poses. It is sound
/// for any tolerance above 1e-12, where rounding begins; what it is worth is the distance between bound
/// and cost. Usual is 1e-10.
///
/// # Errors
///
/// As those of [`PoseGraph::problem`](super::PoseGraph::problem), [`LoopClosureError::Poses`] and
/// [`LoopClosureError::Option`].
pub fn certify(
    graph: &SpatialGraph,
    poses: &[Isometry3<f64>],
    tolerance: f64,
) -> Result<Certificate, LoopClosureError> {
    positive("tolerance", tolerance, 0.0)?;
    graph.check_connected()?;
    if poses.len() != graph.poses.len() {
        let (given, poses) = (poses.len(), graph.poses.len());
        return Err(LoopClosureError::Poses { given, poses });
    }
    SpatialGraph::check_poses(poses)?;
    Ok(match QuadraticForm::of(graph, poses) {
        Err(reason) => Certificate::NotApplicable(reason),
        Ok(form) if form.gradient_norm() > STATIONARY => {
            let gradient_norm = form.gradient_norm();
            Certificate::NotApplicable(Inapplicable::NotStationary { gradient_norm })
        }
        Ok(form) => form.judge(tolerance),
    })
}
// ANCHOR_END: certify

/// A gradient below this is that of a minimum.
const STATIONARY: f64 = 1e-2;

/// The cost as ½ tr(X M Xᵀ), and X M. The four columns of a pose are those of its rotation and its
/// position.
struct QuadraticForm {
    edges: Vec<Edge>,
    points: Vec<Matrix3x4<f64>>,
    /// By pose, its block on the diagonal of M.
    diagonal: Vec<Matrix4<f64>>,
    /// By pose, its columns of X M.
    products: Vec<Matrix3x4<f64>>,
    cost: f64,
}

/// Poses i and j, and the matrices A and B for which the residual is A xᵢ + B xⱼ, with x the columns of
/// a row of X.
struct Edge {
    poses: [usize; 2],
    by: [Matrix4<f64>; 2],
}

impl Edge {
    // ANCHOR: certificate_edge
    /// With √(κ/2) the weight of the chord and √τ that of the translation.
    fn new(
        measurement: &RelativeMeasurement<Isometry3<f64>, 6>,
        Isotropy { rotation, translation }: Isotropy,
    ) -> Self {
        let (chord, along) = ((0.5 * rotation).sqrt(), translation.sqrt());
        let Isometry3 { rotation: turn, translation: shift } = measurement.measured;
        let (mut by_first, mut by_second) = (Matrix4::zeros(), Matrix4::identity());
        let turn = turn.inverse().to_rotation_matrix();
        by_first.fixed_view_mut::<3, 3>(0, 0).copy_from(&(-chord * turn.matrix()));
        by_first.fixed_view_mut::<1, 3>(3, 0).copy_from(&(-along * shift.vector.transpose()));
        by_first[(3, 3)] = -along;
        by_second.set_diagonal(&Vector4::new(chord, chord, chord, along));
        Self { poses: [measurement.first, measurement.second], by: [by_first, by_second] }
    }
    // ANCHOR_END: certificate_edge
}

impl QuadraticForm {
    fn of(graph: &SpatialGraph, poses: &[Isometry3<f64>]) -> Result<Self, Inapplicable> {
        let edge = |(number, measurement): (usize, &RelativeMeasurement<_, 6>)| {
            Ok(Edge::new(measurement, Isotropy::of(&measurement.information, number)?))
        };
        let edges: Vec<Edge> =
            graph.measurements.iter().enumerate().map(edge).collect::<Result<_, Inapplicable>>()?;
        let points: Vec<Matrix3x4<f64>> = poses
            .iter()
            .map(|pose| pose.to_homogeneous().fixed_view::<3, 4>(0, 0).into())
            .collect();
        let mut diagonal = vec![Matrix4::zeros(); poses.len()];
        let mut products = vec![Matrix3x4::zeros(); poses.len()];
        let mut cost = 0.0;
        for Edge { poses: [first, second], by: [a, b] } in &edges {
            let residual: Matrix4x3<f64> =
                a * points[*first].transpose() + b * points[*second].transpose();
            cost += 0.5 * residual.norm_squared();
            for (pose, by) in [(*first, a), (*second, b)] {
                diagonal[pose] += by.tr_mul(by);
                products[pose] += residual.tr_mul(by);
            }
        }
        Ok(Self { edges, points, diagonal, products, cost })
    }

    /// Rᵢᵀ (X M)ᵢ: its symmetric part are the multipliers, the other one is the gradient.
    fn turned(&self, pose: usize) -> Matrix3<f64> {
        let rotation = self.points[pose].fixed_view::<3, 3>(0, 0);
        rotation.tr_mul(&self.products[pose].fixed_view::<3, 3>(0, 0))
    }

    /// The length of the gradient of the cost, each coordinate measured by its curvature in M.
    fn gradient_norm(&self) -> f64 {
        let square = |pose: usize| {
            let diagonal = &self.diagonal[pose];
            let turn = 2.0 * so3::vee(&self.turned(pose));
            let about = turn.norm_squared() / diagonal.fixed_view::<3, 3>(0, 0).trace();
            about + self.products[pose].column(3).norm_squared() / diagonal[(3, 3)]
        };
        (0..self.points.len()).map(square).sum::<f64>().sqrt()
    }

    // ANCHOR: judge
    /// The certificate, by a factorization of S + ε I.
    fn judge(&self, tolerance: f64) -> Certificate {
        let multipliers: Vec<Matrix3<f64>> =
            (0..self.points.len()).map(|pose| self.turned(pose).symmetric_part()).collect();
        let mut matrix = self.certificate_matrix(&multipliers);
        let rotations = 3.0 * self.points.len() as f64;
        let of_rotation = |block: &Matrix4<f64>| block.fixed_view::<3, 3>(0, 0).trace();
        let scale = self.diagonal.iter().map(of_rotation).sum::<f64>() / rotations;
        let shift = tolerance * scale;
        if is_definite(&mut matrix, shift) {
            let dual: f64 = multipliers.iter().map(|block| 0.5 * block.trace()).sum();
            let lower_bound = dual - 0.5 * rotations * shift;
            return Certificate::Certified { cost: self.cost, lower_bound, shift };
        }
        let smallest_eigenvalue = smallest_eigenvalue(&mut matrix, shift, self.points.len());
        Certificate::Refused { cost: self.cost, smallest_eigenvalue }
    }
    // ANCHOR_END: judge

    /// S, without the column of the first position: a shift of all positions costs nothing.
    fn certificate_matrix(&self, multipliers: &[Matrix3<f64>]) -> SparseCholesky {
        let mut sizes = vec![4; self.points.len()];
        sizes[0] = 3;
        let pairs: Vec<[usize; 2]> = self.edges.iter().map(|edge| edge.poses).collect();
        let mut matrix = SparseCholesky::new(&sizes, &pairs);
        for (pose, (block, multiplier)) in self.diagonal.iter().zip(multipliers).enumerate() {
            matrix.add(pose, pose, block);
            matrix.add(pose, pose, &-multiplier);
        }
        for Edge { poses: [first, second], by: [a, b] } in &self.edges {
            matrix.add(*first, *second, &a.tr_mul(b));
        }
        matrix
    }
}

/// Whether S with the positions eliminated is positive definite with this added to its diagonal. Where
/// the positions are, nothing has to be added.
fn is_definite(matrix: &mut SparseCholesky, shift: f64) -> bool {
    matrix.factorize(|_, coordinate| if coordinate < 3 { shift } else { 0.0 })
}

// ANCHOR: smallest_eigenvalue
/// The smallest eigenvalue of S with the positions eliminated, from above, by inverse iteration: the
/// inverse of S + ε I has its largest where S has its smallest. The shift, which is not enough to make S
/// positive definite, is doubled until it is.
fn smallest_eigenvalue(matrix: &mut SparseCholesky, mut shift: f64, poses: usize) -> f64 {
    while !is_definite(matrix, shift) {
        shift *= 2.0;
        if !shift.is_finite() {
            return f64::NAN;
        }
    }
    let mut vector: Vec<f64> = (1..4 * poses).map(|number| (number as f64).sin()).collect();
    let mut largest = 0.0;
    for _ in 0..MOST_ITERATIONS {
        make_unit_of_rotations(&mut vector);
        let unit = vector.clone();
        matrix.solve(&mut vector);
        let found: f64 = unit.iter().zip(&vector).map(|(before, after)| before * after).sum();
        let change = found - largest;
        largest = found;
        if change.abs() <= CONVERGED * found {
            break;
        }
    }
    1.0 / largest - shift
}
// ANCHOR_END: smallest_eigenvalue

/// Leaves positions out and makes the length one. The first pose has the numbers of its rotation alone.
fn make_unit_of_rotations(vector: &mut [f64]) {
    let positions = vector.iter_mut().skip(6).step_by(4);
    positions.for_each(|number| *number = 0.0);
    let length = vector.iter().map(|number| number * number).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|number| *number /= length);
}

/// Iterations for the smallest eigenvalue end here, or when it changes by less than this part of its
/// distance from the shift.
const MOST_ITERATIONS: usize = 500;
const CONVERGED: f64 = 1e-10;
