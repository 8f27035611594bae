//! The normal equations with the landmarks eliminated, one after the other.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, Vector3};

use super::blocks::{SchurComplement, add_multiple, dot, first, multiply_add};
use super::group::Point;
use super::landmark_rows::{
    Rows, add_forward, add_gradient, add_pair, explained, inverse_factor, landmark_block,
};
use super::linearized::Linearized;
use super::problem::Problem;
use super::solver::{LinearSystem, Pivots, Prediction, SolveError};
use super::structure::{Landmark, Slot, Structure};
use super::tiles::{Member, Tiles};
use super::{Covariance, Manifold};
use crate::registers::wide;

/// What has no inverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Singular {
    /// The 3×3 block of this landmark.
    Landmark(usize),
    /// The Schur complement.
    SchurComplement,
}

// ANCHOR: landmark_elimination
/// The damped normal equations of one step with the landmarks, of three coordinates each,
/// eliminated. Every other variable that moves stands in a row of D×D blocks of the Schur complement
/// S ([@triggs2000]; [@agarwal2010]), alone or with others. Those that factors with landmarks see
/// take up the first `C` coordinates of a row.
#[derive(Debug, Clone)]
pub struct LandmarkElimination<const D: usize, const C: usize = D> {
    structure: Structure,
    /// The rows of the Jacobian that depend on landmarks.
    rows: Rows<D, C>,
    /// The factors that see no landmark, by group.
    others: Vec<Linearized>,
    landmarks: Vec<Eliminated>,
    /// The Schur complement S, and then its Cholesky factor.
    schur: SchurComplement<D>,
    /// The right-hand side, and then the step.
    rhs: Vec<[f64; D]>,
    /// The diagonal before damping and elimination.
    curvature: Vec<[f64; D]>,
    /// The gradient before elimination.
    gradient: Vec<[f64; D]>,
    /// The damping at hand.
    damping: f64,
    /// Pivots must be above this.
    smallest: Vec<[f64; D]>,
    /// The factors at hand.
    linear: Linearized,
    /// The rows Q of the landmark at hand.
    whitened: Vec<[f64; 3]>,
}
// ANCHOR_END: landmark_elimination

// ANCHOR: eliminated
/// What is kept of a landmark, enough to find its move once the others' are known.
#[derive(Debug, Clone, Copy, Default)]
struct Eliminated {
    /// Its 3×3 block H before damping, of which the lower triangle counts.
    hessian: Matrix3<f64>,
    gradient: Vector3<f64>,
    /// The lower triangular M with M H Mᵀ = I for the damped block.
    inverse_factor: Matrix3<f64>,
    /// M times the gradient.
    forward: Vector3<f64>,
}
// ANCHOR_END: eliminated

impl<const D: usize> LandmarkElimination<D> {
    /// Room for all that the steps of a problem need, in which the variables of the kind `L` are
    /// landmarks and every other one has a row of blocks of its own.
    ///
    /// # Errors
    ///
    /// [`SolveError::Block`], [`SolveError::TiedLandmark`] and [`SolveError::Structure`] when the
    /// problem is not of this form, [`SolveError::NoFactors`], and [`SolveError::NothingFree`] when nothing
    /// moves.
    pub fn new<L: Manifold>(problem: &Problem) -> Result<Self, SolveError> {
        Self::of_tiles::<L>(problem, None)
    }
}

impl<const D: usize, const C: usize> LandmarkElimination<D, C> {
    /// The same with rows of blocks that several variables share, given by number, as the state of a
    /// body and its biases: up to `D` coordinates, and of `C` the first, which alone may share a
    /// factor with a landmark. All that no row names stands in one more row, the border, which every
    /// factor may see: calibration, a time offset, gravity.
    ///
    /// # Errors
    ///
    /// Those of [`LandmarkElimination::new`] and [`SolveError::NoSuchVariable`].
    pub fn in_tiles<L: Manifold>(
        problem: &Problem,
        tiles: &[Vec<usize>],
    ) -> Result<Self, SolveError> {
        Self::of_tiles::<L>(problem, Some(tiles))
    }

    fn of_tiles<L: Manifold>(
        problem: &Problem,
        variables: Option<&[Vec<usize>]>,
    ) -> Result<Self, SolveError> {
        const { assert!(C <= D, "what is seen is a part of the row") };
        problem.columns_to_solve()?;
        let structure = Structure::new::<L>(problem, &Tiles { size: D, seen: C, variables })?;
        let on_border = if structure.on_border.is_empty() { 0 } else { structure.rows };
        let zeros = vec![[0.0; D]; structure.row_count()];
        let most_rows = structure.landmarks.iter().map(|landmark| landmark.rows.len()).max();
        Ok(Self {
            rows: Rows {
                residual: vec![0.0; structure.rows],
                landmark: vec![[0.0; 3]; structure.rows],
                variable: vec![[0.0; C]; structure.rows],
                border: vec![[0.0; D]; on_border],
            },
            others: vec![Linearized::default(); structure.others.len()],
            landmarks: vec![Eliminated::default(); structure.landmarks.len()],
            schur: SchurComplement::new(structure.first_columns.clone()),
            rhs: zeros.clone(),
            curvature: zeros.clone(),
            gradient: zeros.clone(),
            damping: 0.0,
            smallest: zeros,
            linear: room_for_linearized(problem, &structure),
            whitened: vec![[0.0; 3]; most_rows.unwrap_or(0)],
            structure,
        })
    }

    /// Linearizes the factors that see one landmark, and adds up what does not depend on damping.
    #[inline(always)]
    fn linearize_landmark(
        &mut self,
        problem: &Problem,
        at: Point,
        index: usize,
    ) -> Result<(), SolveError> {
        let Self { structure, rows, linear, .. } = self;
        let landmark = &structure.landmarks[index];
        for run in &structure.runs[landmark.runs.clone()] {
            let factors = &structure.factors[run.factors.clone()];
            let outcome = problem.group(run.group).linearize(factors, at, linear);
            outcome.map_err(|at| problem.undefined(run.group, at))?;
            rows.take(run, linear, structure);
        }
        self.sum_up(index);
        Ok(())
    }

    /// Adds up what does not depend on damping.
    #[inline(always)]
    fn sum_up(&mut self, index: usize) {
        let Self { structure, rows, .. } = self;
        let landmark = &structure.landmarks[index];
        let (slopes, residuals) =
            (&rows.landmark[landmark.rows.clone()], &rows.residual[landmark.rows.clone()]);
        let (hessian, gradient) = landmark_block(slopes, residuals);
        self.landmarks[index] = Eliminated { hessian, gradient, ..Eliminated::default() };
        for Slot { variable, rows: own } in &structure.slots[landmark.slots.clone()] {
            let (gradient, curvature) =
                (&mut self.gradient[*variable], &mut self.curvature[*variable]);
            let (slopes, residuals) = (&rows.variable[own.clone()], &rows.residual[own.clone()]);
            add_gradient(gradient, curvature, slopes, residuals);
        }
        if let Some(border) = landmark.border {
            let (gradient, curvature) = (&mut self.gradient[border], &mut self.curvature[border]);
            add_gradient(gradient, curvature, &rows.border[landmark.rows.clone()], residuals);
        }
    }

    /// Eliminates all landmarks with the widest registers that the processor has.
    pub(crate) fn eliminate_all(&mut self, damping: f64) -> Result<(), Singular> {
        wide(
            #[inline(always)]
            || self.eliminate_each(damping),
        )
    }

    #[inline(always)]
    // ANCHOR: eliminate_each
    /// Eliminates landmark by landmark, straight into the Schur complement.
    ///
    /// Implements {eq:damped-reduction}.
    fn eliminate_each(&mut self, damping: f64) -> Result<(), Singular> {
        self.damping = damping;
        self.schur.clear();
        let gradient = self.gradient.as_flattened().iter();
        self.rhs.as_flattened_mut().iter_mut().zip(gradient).for_each(|(rhs, g)| *rhs = -g);
        for index in 0..self.landmarks.len() {
            self.eliminate(index, damping)?;
            self.add_pairs(index);
            self.add_border(index);
        }
        self.add_others();
        self.damp(damping);
        Ok(())
    }
    // ANCHOR_END: eliminate_each

    /// Damps and factors the block of the landmark, and gives its rows the coordinates in which
    /// that block is the identity.
    #[inline(always)]
    fn eliminate(&mut self, index: usize, damping: f64) -> Result<(), Singular> {
        let landmark = &mut self.landmarks[index];
        let mut block = landmark.hessian;
        (0..3).for_each(|axis| block[(axis, axis)] += Pivots::added(damping, block[(axis, axis)]));
        landmark.inverse_factor =
            inverse_factor(&block, Pivots::ROUNDING).ok_or(Singular::Landmark(index))?;
        landmark.forward = landmark.inverse_factor * landmark.gradient;
        let slopes = &self.rows.landmark[self.structure.landmarks[index].rows.clone()];
        for (whitened, slope) in self.whitened.iter_mut().zip(slopes) {
            *whitened = (landmark.inverse_factor * Vector3::from(*slope)).into();
        }
        Ok(())
    }

    #[inline(always)]
    // ANCHOR: add_pairs
    /// Adds to the block of each pair of variables, and to each right-hand side, what no motion of
    /// the landmark explains.
    ///
    /// Implements {eq:projected-pairs}.
    fn add_pairs(&mut self, index: usize) {
        let Self { structure, rows, whitened, schur, rhs, .. } = self;
        let (landmark, forward) = (&structure.landmarks[index], self.landmarks[index].forward);
        let slots = &structure.slots[landmark.slots.clone()];
        let rows_of = |slot: &Slot| {
            let local = slot.rows.start - landmark.rows.start..slot.rows.end - landmark.rows.start;
            (&rows.variable[slot.rows.clone()], &whitened[local])
        };
        for (number, slot) in slots.iter().enumerate() {
            let (own, (blocks, first)) = (rows_of(slot), schur.row(slot.variable));
            let explained = explained(own);
            for other in &slots[..number] {
                add_pair(&mut blocks[other.variable - first], &explained, None, rows_of(other));
            }
            add_pair(&mut blocks[slot.variable - first], &explained, Some(own.0), own);
            add_forward(&mut rhs[slot.variable], forward, &explained);
        }
    }
    // ANCHOR_END: add_pairs

    #[inline(always)]
    // ANCHOR: add_border
    /// Adds the same to the row that all factors may see.
    fn add_border(&mut self, index: usize) {
        let Self { structure, rows, whitened, schur, rhs, .. } = self;
        let landmark = &structure.landmarks[index];
        let Some(border) = landmark.border else { return };
        let (slopes, first) = (&rows.border[landmark.rows.clone()], landmark.rows.start);
        let own = (slopes, &whitened[..slopes.len()]);
        let (explained, (blocks, _)) = (explained(own), schur.row(border));
        for Slot { variable, rows: seen } in &structure.slots[landmark.slots.clone()] {
            let local = seen.start - first..seen.end - first;
            let other = (&rows.variable[seen.clone()], &whitened[local.clone()]);
            add_pair(&mut blocks[*variable], &explained, Some(&slopes[local]), other);
        }
        for (slopes, whitened) in own.0.chunks(2).zip(own.1.chunks(2)) {
            add_pair(&mut blocks[border], &explained, Some(slopes), (slopes, whitened));
        }
        add_forward(&mut rhs[border], self.landmarks[index].forward, &explained);
    }
    // ANCHOR_END: add_border

    /// Linearizes the factors that see no landmark.
    fn linearize_others(&mut self, problem: &Problem, at: Point) -> Result<(), SolveError> {
        for (others, linear) in self.structure.others.iter().zip(&mut self.others) {
            let outcome = problem.group(others.group).linearize(&others.factors, at, linear);
            outcome.map_err(|at| problem.undefined(others.group, at))?;
            for (factor, residuals) in linear.residuals().chunks(linear.rows()).enumerate() {
                for (place, slopes) in others.slopes(linear, factor) {
                    let gradient = &mut self.gradient[place.row][place.first..];
                    let curvature = &mut self.curvature[place.row][place.first..];
                    for (slopes, residual) in slopes.zip(residuals) {
                        for ((g, h), slope) in gradient.iter_mut().zip(&mut *curvature).zip(slopes)
                        {
                            (*g, *h) = (
                                multiply_add(*slope, *residual, *g),
                                multiply_add(*slope, *slope, *h),
                            );
                        }
                    }
                }
            }
        }
        Ok(())
    }

    #[inline(always)]
    // ANCHOR: add_others
    /// Adds the factors that see no landmark.
    fn add_others(&mut self) {
        for (others, linear) in self.structure.others.iter().zip(&self.others) {
            for factor in 0..linear.len() {
                for (down, left) in others.slopes(linear, factor) {
                    let across = others.slopes(linear, factor);
                    for (across, right) in across.filter(|(across, _)| across.row <= down.row) {
                        let block = &mut self.schur.block(down.row, across.row)[across.first..];
                        for (left, right) in left.clone().zip(right) {
                            for (column, slope) in block.iter_mut().zip(right) {
                                let entries = column[down.first..].iter_mut().zip(left);
                                entries.for_each(|(e, l)| *e = multiply_add(*slope, *l, *e));
                            }
                        }
                    }
                }
            }
        }
    }
    // ANCHOR_END: add_others

    /// Damps the variables, when all factors are in.
    fn damp(&mut self, damping: f64) {
        for row in 0..self.rhs.len() {
            for axis in 0..D {
                let curvature = self.curvature[row][axis];
                let added = Pivots::added(damping, curvature);
                self.smallest[row][axis] = Pivots::smallest(damping, curvature);
                self.schur.block(row, row)[axis][axis] += added;
            }
        }
        for &(row, axis) in &self.structure.held {
            self.schur.isolate(row, axis);
            self.rhs[row][axis] = 0.0;
            self.smallest[row][axis] = 0.0;
        }
    }

    // ANCHOR: solve
    /// Factors the Schur complement and turns the right-hand side into the step. Returns its
    /// squared length in the coordinates of the factor: twice the decrease that the damped,
    /// linearized problem expects of these variables.
    fn solve(&mut self) -> Result<f64, Singular> {
        wide(
            #[inline(always)]
            || self.schur.factorize(&self.smallest),
        )
        .map_err(|_| Singular::SchurComplement)?;
        self.schur.solve_lower(&mut self.rhs);
        let forward = self.rhs.iter().map(|z| dot(z, z)).sum();
        self.schur.solve_upper(&mut self.rhs);
        Ok(forward)
    }
    // ANCHOR_END: solve

    // ANCHOR: back_substitute
    /// Writes the step of all coordinates. Returns twice the predicted decrease and the squared
    /// scaled length of the step; `forward` is what `solve` returned.
    ///
    /// Implements {eq:predicted-decrease-in-parts}.
    #[inline(always)]
    fn back_substitute(&self, forward: f64, step: &mut [f64]) -> (f64, f64) {
        let (damped, mut square) = self.squares();
        let mut twice_predicted = forward + damped;
        self.write_variables(step);
        for (landmark, eliminated) in self.structure.landmarks.iter().zip(&self.landmarks) {
            let change = self.landmark_step(landmark, eliminated);
            step[landmark.coordinate..landmark.coordinate + 3].copy_from_slice(change.as_slice());
            let (squares, curvature) =
                (change.component_mul(&change), eliminated.hessian.diagonal());
            let damped = curvature.map(|h| Pivots::added(self.damping, h)).dot(&squares);
            twice_predicted += eliminated.forward.norm_squared() + damped;
            square += curvature.dot(&squares);
        }
        (twice_predicted, square)
    }
    // ANCHOR_END: back_substitute

    /// Writes the step of the variables that have rows.
    fn write_variables(&self, step: &mut [f64]) {
        for (row, members) in self.rhs.iter().zip(&self.structure.variables) {
            for Member { coordinates, first } in members {
                step[coordinates.clone()].copy_from_slice(&row[*first..][..coordinates.len()]);
            }
        }
    }

    /// The move of a landmark, when the others' are known.
    ///
    /// Implements {eq:point-follows}.
    #[inline(always)]
    fn landmark_step(&self, landmark: &Landmark, eliminated: &Eliminated) -> Vector3<f64> {
        let mut pull = eliminated.gradient;
        for Slot { variable, rows } in &self.structure.slots[landmark.slots.clone()] {
            let both = (&self.rows.variable[rows.clone()], &self.rows.landmark[rows.clone()]);
            add_pull(&mut pull, both, first(&self.rhs[*variable]));
        }
        if let Some(border) = landmark.border {
            let rows = landmark.rows.clone();
            let both = (&self.rows.border[rows.clone()], &self.rows.landmark[rows]);
            add_pull(&mut pull, both, &self.rhs[border]);
        }
        let factor = &eliminated.inverse_factor;
        -factor.tr_mul(&(factor * pull))
    }

    /// The squares of the variables' step, weighted with what damping added to the curvature and
    /// with the curvature.
    fn squares(&self) -> (f64, f64) {
        let steps = self.rhs.as_flattened().iter().zip(self.curvature.as_flattened());
        steps.fold((0.0, 0.0), |(damped, square), (step, curvature)| {
            let each = step * step;
            (damped + Pivots::added(self.damping, *curvature) * each, square + curvature * each)
        })
    }

    /// How many blocks of the Schur complement are kept.
    pub fn stored_blocks(&self) -> usize {
        self.schur.stored()
    }

    /// Products of two blocks that one elimination of all landmarks takes: {eq:block-products}.
    pub fn block_products(&self) -> usize {
        self.structure.block_products()
    }

    /// For each variable the row of blocks that it has in the Schur complement, `None` when it is
    /// held or a landmark.
    pub fn rows(&self, problem: &Problem) -> Vec<Option<usize>> {
        let firsts = self.firsts(problem).into_iter();
        firsts.map(|first| first.map(|first| first / D)).collect()
    }

    /// The same with the first of its coordinates in the Schur complement.
    pub(super) fn firsts(&self, problem: &Problem) -> Vec<Option<usize>> {
        let mut first_of_start = std::collections::BTreeMap::new();
        for (row, members) in self.structure.variables.iter().enumerate() {
            let of_member = |member: &Member| (member.coordinates.start, D * row + member.first);
            first_of_start.extend(members.iter().map(of_member));
        }
        let first = |index| {
            let start = problem.values().coordinates_of(index)?.start;
            first_of_start.get(&start).copied()
        };
        (0..problem.values().len()).map(first).collect()
    }

    /// The memory that it holds, in bytes.
    pub fn bytes(&self) -> usize {
        let rows = [&self.rhs, &self.curvature, &self.gradient, &self.smallest];
        rows.iter().map(|rows| size_of_val(rows.as_slice())).sum::<usize>()
            + D * D * size_of::<f64>() * self.schur.stored()
            + size_of_val(self.landmarks.as_slice())
            + size_of_val(self.whitened.as_slice())
            + self.others.iter().chain([&self.linear]).map(Linearized::bytes).sum::<usize>()
            + self.structure.rows * size_of::<f64>() * (1 + 3 + C)
            + size_of_val(self.rows.border.as_slice())
            + self.structure.bytes()
    }
}

/// What is asked about the point that was linearized last.
impl<const D: usize, const C: usize> LandmarkElimination<D, C> {
    /// The Schur complement as a dense matrix, with its right-hand side: `D` rows for each of
    /// [`LandmarkElimination::rows`]. Implements {eq:reduced-camera-system}, and
    /// {eq:damped-reduction} with a damping.
    ///
    /// # Errors
    ///
    /// [`Singular`] when a landmark is free, which needs a damping of zero.
    pub fn schur_complement(
        &mut self,
        damping: f64,
    ) -> Result<(DMatrix<f64>, DVector<f64>), Singular> {
        self.eliminate_all(damping)?;
        let rhs = DVector::from_column_slice(self.rhs.as_flattened());
        Ok((self.schur.to_matrix(), rhs))
    }

    /// The step of all coordinates that goes with a step of the variables that have rows, when the
    /// last elimination was [`LandmarkElimination::schur_complement`]. Gives the predicted decrease
    /// too; `forward` is twice the first term of {eq:predicted-decrease-in-parts}.
    pub fn complete(
        &mut self,
        problem: &Problem,
        rows: &DVector<f64>,
        forward: f64,
    ) -> (Vec<f64>, f64) {
        self.rhs.as_flattened_mut().copy_from_slice(rows.as_slice());
        let mut step = vec![0.0; problem.values().dimension()];
        let (twice, _) = self.back_substitute(forward, &mut step);
        (step, 0.5 * twice)
    }

    /// The inverse of the Schur complement: the covariance of the variables that have rows.
    fn inverse_schur_complement(&mut self) -> Result<DMatrix<f64>, Singular> {
        self.eliminate_all(0.0)?;
        self.schur.factorize(&self.smallest).map_err(|_| Singular::SchurComplement)?;
        let size = D * self.structure.row_count();
        let mut inverse = DMatrix::zeros(size, size);
        let mut column = vec![[0.0; D]; self.structure.row_count()];
        for index in 0..size {
            column.fill([0.0; D]);
            column[index / D][index % D] = 1.0;
            self.schur.solve_lower(&mut column);
            self.schur.solve_upper(&mut column);
            inverse.column_mut(index).copy_from_slice(column.as_flattened());
        }
        for (row, axis) in &self.structure.held {
            inverse.row_mut(D * row + axis).fill(0.0);
            inverse.column_mut(D * row + axis).fill(0.0);
        }
        Ok(inverse)
    }

    /// The covariance of each landmark, from that of the other variables.
    pub(super) fn landmark_covariances(
        &mut self,
        others: &DMatrix<f64>,
    ) -> Result<Vec<Matrix3<f64>>, Singular> {
        let count = self.landmarks.len();
        let covariance = |index| {
            self.eliminate(index, 0.0)?;
            Ok(self.landmark_covariance(index, others))
        };
        (0..count).map(covariance).collect()
    }

    // ANCHOR: landmark_covariance
    /// The covariance of the landmark that has been eliminated last: what its own factors leave
    /// open, and what the variables that see it hand on. Implements {eq:ba-point-covariance}.
    fn landmark_covariance(&self, index: usize, others: &DMatrix<f64>) -> Matrix3<f64> {
        let block = |row: usize, column: usize| others.fixed_view::<D, D>(D * row, D * column);
        let factor = &self.landmarks[index].inverse_factor;
        let couplings = self.couplings(&self.structure.landmarks[index], factor);
        let mut sum = Matrix3::identity();
        for (row, left) in &couplings {
            for (column, right) in &couplings {
                sum += left.transpose() * block(*row, *column) * right;
            }
        }
        factor.tr_mul(&sum) * factor
    }
    // ANCHOR_END: landmark_covariance

    /// The rows of blocks that share factors with a landmark, and the block that couples each with
    /// it, times the factor of the landmark's own.
    fn couplings(
        &self,
        landmark: &Landmark,
        factor: &Matrix3<f64>,
    ) -> Vec<(usize, SMatrix<f64, D, 3>)> {
        let Rows { landmark: slopes, variable, border, .. } = &self.rows;
        let of_slot = |slot: &Slot| {
            let rows = slot.rows.clone();
            (slot.variable, coupling((&variable[rows.clone()], &slopes[rows]), factor))
        };
        let of_border = landmark.border.map(|row| {
            let rows = landmark.rows.clone();
            (row, coupling((&border[rows.clone()], &slopes[rows]), factor))
        });
        let slots = self.structure.slots[landmark.slots.clone()].iter();
        slots.map(of_slot).chain(of_border).collect()
    }
}

impl<const D: usize, const C: usize> LinearSystem for LandmarkElimination<D, C> {
    fn linearize(&mut self, problem: &Problem, at: Point) -> Result<Option<f64>, SolveError> {
        self.gradient.fill([0.0; D]);
        self.curvature.fill([0.0; D]);
        wide(
            #[inline(always)]
            || {
                let mut landmarks = 0..self.landmarks.len();
                landmarks.try_for_each(|index| self.linearize_landmark(problem, at, index))
            },
        )?;
        self.linearize_others(problem, at)?;
        for &(row, axis) in &self.structure.held {
            self.gradient[row][axis] = 0.0;
        }
        if self.gradient_norm().is_finite() { Ok(None) } else { Err(problem.not_finite(at)) }
    }

    // ANCHOR: attempt
    fn step(&mut self, damping: f64, into: &mut [f64]) -> Option<Prediction> {
        self.eliminate_all(damping).ok()?;
        let forward = self.solve().ok()?;
        let (twice, square) = wide(
            #[inline(always)]
            || self.back_substitute(forward, into),
        );
        Some(Prediction {
            step_norm: square.sqrt(),
            predicted_decrease: 0.5 * twice,
            gradient_norm: self.gradient_norm(),
        })
    }
    // ANCHOR_END: attempt

    fn is_suspicious(&self) -> bool {
        let small = |(row, smallest): (usize, &[f64; D])| {
            let diagonal = self.schur.diagonal(row);
            (0..D).any(|axis| Pivots::are_suspicious(smallest[axis], diagonal[axis][axis].powi(-2)))
        };
        let hidden = |landmark: &Eliminated| {
            let (curvatures, inverse) = (landmark.hessian.diagonal(), &landmark.inverse_factor);
            (0..3).any(|axis| {
                let smallest = Pivots::smallest(0.0, curvatures[axis]);
                Pivots::are_suspicious(smallest, inverse[(axis, axis)].powi(-2))
            })
        };
        self.smallest.iter().enumerate().any(small) || self.landmarks.iter().any(hidden)
    }

    fn gradient_norm(&self) -> f64 {
        let pairs = self.gradient.as_flattened().iter().zip(self.curvature.as_flattened());
        let variables: f64 = pairs.map(|(g, h)| Pivots::scaled_square(*g, *h)).sum();
        let of_landmark = |landmark: &Eliminated| {
            landmark.gradient.zip_map(&landmark.hessian.diagonal(), Pivots::scaled_square).sum()
        };
        (variables + self.landmarks.iter().map(of_landmark).sum::<f64>()).sqrt()
    }

    fn covariance(&mut self, problem: &Problem, at: Point) -> Result<Covariance, SolveError> {
        let null_space = problem.null_space_at(at)?;
        if null_space.nullity() > 0 {
            return Err(null_space.undetermined());
        }
        self.linearize(problem, at)?;
        let inverse = self.inverse_schur_complement();
        let whole = inverse.and_then(|inverse| self.with_landmarks(problem, inverse));
        whole.map_err(|_| null_space.undetermined())
    }
}

/// Adds to the gradient of a landmark what a step of another variable makes of it, from the rows that
/// depend on both.
#[inline(always)]
fn add_pull<const N: usize>(
    pull: &mut Vector3<f64>,
    (slopes, by_landmark): (&[[f64; N]], &[[f64; 3]]),
    step: &[f64; N],
) {
    for (slope, by_landmark) in slopes.iter().zip(by_landmark) {
        add_multiple(pull.as_mut(), dot(slope, step), by_landmark);
    }
}

/// The block that couples a variable with a landmark, times the factor of the landmark's own.
fn coupling<const D: usize, const N: usize>(
    (slopes, by_landmark): (&[[f64; N]], &[[f64; 3]]),
    factor: &Matrix3<f64>,
) -> SMatrix<f64, D, 3> {
    let mut coupling = SMatrix::<f64, D, 3>::zeros();
    for (slope, by_landmark) in slopes.iter().zip(by_landmark) {
        let whitened = factor * Vector3::from(*by_landmark);
        let mut seen = coupling.fixed_rows_mut::<N>(0);
        seen += SVector::from(*slope) * whitened.transpose();
    }
    coupling
}

/// Room for the factors of any one landmark.
fn room_for_linearized(problem: &Problem, structure: &Structure) -> Linearized {
    let mut linear = Linearized::default();
    for run in &structure.runs {
        let group = problem.group(run.group);
        linear.begin(run.factors.len(), group.rows(), group.columns());
    }
    linear
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle_adjustment::Solver;
    use crate::least_squares::Options;
    use crate::simulation::Scene;

    #[test]
    fn wide_registers_round_as_narrow_ones_do() {
        let ring = Scene::ring(8, 40, 1.0, 1).problem;
        let solver = Solver::new(&ring, &Options::default()).unwrap();
        let (problem, at) = (solver.problem(), Point { values: solver.values(), frozen: None });
        let mut wide = LandmarkElimination::<6>::new::<Vector3<f64>>(problem).unwrap();
        wide.linearize(problem, at).unwrap();
        let mut narrow = wide.clone();
        wide.eliminate_all(1e-3).unwrap();
        narrow.eliminate_each(1e-3).unwrap();
        assert_eq!(wide.schur.to_matrix(), narrow.schur.to_matrix());
        assert_eq!(wide.solve().unwrap(), {
            narrow.schur.factorize(&narrow.smallest).unwrap();
            narrow.schur.solve_lower(&mut narrow.rhs);
            narrow.rhs.iter().map(|z| dot(z, z)).sum::<f64>()
        });
    }
}
