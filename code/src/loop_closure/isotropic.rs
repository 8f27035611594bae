//! Noise that is alike in all directions, and the chordal cost.

use nalgebra::{Isometry3, Matrix3, Matrix6};

use super::graph::{GraphProblem, SolvedGraph, SpatialGraph};
use super::{Inapplicable, LoopClosureError};
use crate::factors::ChordalPose;
use crate::least_squares::{Kernel, Options};

// ANCHOR: isotropy
/// Information that is alike in all directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Isotropy {
    /// κ, the information about each axis, in one over square radians.
    pub rotation: f64,
    /// τ, the information along each axis, in one over square metres.
    pub translation: f64,
}
// ANCHOR_END: isotropy

impl Isotropy {
    // ANCHOR: isotropic
    /// The two numbers of an information matrix, if it has no others. Translation stands first.
    ///
    /// # Errors
    ///
    /// [`Inapplicable::Rotation`], [`Inapplicable::Translation`] and [`Inapplicable::Coupled`] name the
    /// measurement by this number.
    pub fn of(information: &Matrix6<f64>, measurement: usize) -> Result<Self, Inapplicable> {
        let (along, about) = (block(information, 0), block(information, 3));
        let [translation, rotation] = [along, about].map(|block| block.trace() / 3.0);
        let is_alike = |block: Matrix3<f64>, mean: f64| {
            let spread = (block - Matrix3::from_diagonal_element(mean)).amax();
            mean > 0.0 && block.sum().is_finite() && spread <= ROUNDING * mean
        };
        if !is_alike(about, rotation) {
            return Err(Inapplicable::Rotation { measurement });
        }
        if !is_alike(along, translation) {
            return Err(Inapplicable::Translation { measurement });
        }
        let coupling = information.fixed_view::<3, 3>(0, 3);
        let is_small = coupling.amax() <= ROUNDING * (rotation * translation).sqrt();
        if !(is_small && coupling.sum().is_finite()) {
            return Err(Inapplicable::Coupled { measurement });
        }
        Ok(Self { rotation, translation })
    }
    // ANCHOR_END: isotropic
}

/// What text with a few digits makes of equal numbers.
const ROUNDING: f64 = 1e-6;

/// The block of three rows and columns on the diagonal, from this row on.
fn block(information: &Matrix6<f64>, first: usize) -> Matrix3<f64> {
    information.fixed_view::<3, 3>(first, first).into_owned()
}

impl SpatialGraph {
    // ANCHOR: made_isotropic
    /// The same graph with information that is alike in all directions: one over the mean variance of
    /// translation, and of rotation, which is what SE-Sync takes ([@rosen2019]). Another problem, with
    /// another minimum.
    pub fn isotropic(&self) -> Self {
        let mut graph = self.clone();
        for measurement in &mut graph.measurements {
            let mean = |first| {
                let variances = block(&measurement.information, first).try_inverse();
                3.0 / variances.map_or(f64::NAN, |variances| variances.trace())
            };
            let (along, about) = (mean(0), mean(3));
            measurement.information = Matrix6::from_fn(|row, column| {
                f64::from(u8::from(row == column)) * if row < 3 { along } else { about }
            });
        }
        graph
    }
    // ANCHOR_END: made_isotropic

    /// The least-squares problem with rotations compared by the chord, see [`ChordalPose`].
    ///
    /// # Errors
    ///
    /// As those of [`PoseGraph::problem`](super::PoseGraph::problem), and those of [`Isotropy::of`].
    pub fn chordal_problem(&self) -> Result<GraphProblem<Isometry3<f64>>, LoopClosureError> {
        let (mut problem, poses) = self.variables()?;
        for (number, measurement) in self.measurements.iter().enumerate() {
            let Isotropy { rotation, translation } =
                Isotropy::of(&measurement.information, number)?;
            let factor = ChordalPose {
                first: poses[measurement.first],
                second: poses[measurement.second],
                measured: measurement.measured,
                rotation_weight: rotation.sqrt(),
                translation_weight: translation.sqrt(),
            };
            problem.add_factor(factor, Kernel::Squared)?;
        }
        Ok(GraphProblem { problem, poses })
    }

    /// The poses for which the chordal cost is least, downhill from where they are.
    ///
    /// # Errors
    ///
    /// As those of [`SpatialGraph::chordal_problem`], and those of the solver.
    pub fn solve_chordal(
        &self,
        options: &Options,
    ) -> Result<SolvedGraph<Isometry3<f64>>, LoopClosureError> {
        self.chordal_problem()?.solve(options)
    }
}
