//! The normal equations with the landmarks eliminated, one after the other.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, Vector3};

use super::blocks::{SchurComplement, add_multiple, add_product, dot, multiply_add};
use super::group::Point;
use super::linearized::Linearized;
use super::problem::Problem;
use super::solver::{LinearSystem, Prediction, SolveError};
use super::structure::{HELD, Structure};
use super::{Covariance, Manifold};

/// Pivots below this fraction of the curvature before elimination are rounding errors.
const ROUNDING: f64 = 1e-12;

/// No curvature counts as smaller than this when it is damped, so that an unknown that no
/// factor depends on stays where it is.
const SMALLEST_CURVATURE: f64 = 1e-6;

/// What has no inverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Singular {
    /// The 3×3 block of this landmark.
    Landmark(usize),
    /// The Schur complement.
    SchurComplement,
    /// A factor has no value here.
    Undefined,
}

// ANCHOR: landmark_elimination
/// The damped normal equations of one step with the landmarks, of three coordinates each,
/// eliminated. Every other variable that moves has `D` coordinates and a row of blocks in the
/// Schur complement S ([@triggs2000]; [@agarwal2010]).
#[derive(Debug, Clone)]
pub struct LandmarkElimination<const D: usize> {
    structure: Structure,
    /// The Schur complement S, and then its Cholesky factor.
    schur: SchurComplement<D>,
    /// The right-hand side, and then the step.
    rhs: Vec<[f64; D]>,
    /// The diagonal before damping and elimination.
    curvature: Vec<[f64; D]>,
    /// The gradient before elimination.
    gradient: Vec<[f64; D]>,
    /// What damping added to the diagonal.
    damping: Vec<[f64; D]>,
    /// Pivots must be above this.
    smallest: Vec<[f64; D]>,
    eliminated: Vec<Eliminated>,
    /// The squared norm of the landmarks' scaled gradient.
    landmark_gradient: f64,
    /// The factors of the landmark at hand, by run.
    linear: Vec<Linearized>,
    /// The D×3 matrices that couple landmarks to the variables that see them, in the order of the
    /// structure's rows: {eq:coupling-factor}.
    couplings: Vec<[[f64; D]; 3]>,
}
// ANCHOR_END: landmark_elimination

// ANCHOR: eliminated
/// What is kept of a landmark, enough to find its move once the others' are known.
#[derive(Debug, Clone, Copy)]
struct Eliminated {
    /// The lower triangular M with M H Mᵀ = I for the landmark's damped 3×3 block H.
    inverse_factor: Matrix3<f64>,
    /// M times the landmark's gradient.
    forward: Vector3<f64>,
    /// The diagonal of H before damping.
    curvature: Vector3<f64>,
    /// What damping added to it.
    damping: Vector3<f64>,
}
// ANCHOR_END: eliminated

impl<const D: usize> LandmarkElimination<D> {
    /// Room for all that the steps of a problem need, in which the variables of the kind `L` are
    /// landmarks.
    ///
    /// # Errors
    ///
    /// [`SolveError::Block`], [`SolveError::TiedLandmark`] and [`SolveError::Structure`] when the
    /// problem is not of this form, [`SolveError::NothingFree`] when nothing moves.
    pub fn new<L: Manifold>(problem: &Problem) -> Result<Self, SolveError> {
        let structure = Structure::new::<L>(problem, D)?;
        if structure.landmarks.is_empty() && structure.row_count() == 0 {
            return Err(SolveError::NothingFree);
        }
        let zeros = vec![[0.0; D]; structure.row_count()];
        let (zero, one) = (Vector3::zeros(), Matrix3::zeros());
        let nothing =
            Eliminated { inverse_factor: one, forward: zero, curvature: zero, damping: zero };
        let linear = room_for_linearized(problem, &structure);
        Ok(Self {
            schur: SchurComplement::new(structure.first_columns.clone()),
            rhs: zeros.clone(),
            curvature: zeros.clone(),
            gradient: zeros.clone(),
            damping: zeros.clone(),
            smallest: zeros,
            eliminated: vec![nothing; structure.landmarks.len()],
            landmark_gradient: 0.0,
            linear,
            couplings: vec![[[0.0; D]; 3]; structure.rows.len()],
            structure,
        })
    }

    // ANCHOR: eliminate_all
    /// Linearizes and eliminates landmark by landmark, straight into the Schur complement.
    ///
    /// Implements {eq:damped-reduction}.
    pub(crate) fn eliminate_all(
        &mut self,
        problem: &Problem,
        at: Point,
        damping: f64,
    ) -> Result<(), Singular> {
        self.clear();
        for index in 0..self.structure.landmarks.len() {
            self.linearize_landmark(problem, at, index)?;
            self.add_variables(index);
            self.eliminate(index, damping)?;
            self.couple(index);
            self.subtract_pairs(index);
        }
        self.add_others(problem, at)?;
        self.damp(damping);
        Ok(())
    }
    // ANCHOR_END: eliminate_all

    /// Forgets the last step.
    fn clear(&mut self) {
        self.schur.clear();
        self.rhs.fill([0.0; D]);
        self.curvature.fill([0.0; D]);
        self.gradient.fill([0.0; D]);
        self.landmark_gradient = 0.0;
    }

    /// Linearizes the factors that see one landmark.
    fn linearize_landmark(
        &mut self,
        problem: &Problem,
        at: Point,
        index: usize,
    ) -> Result<(), Singular> {
        let runs = self.structure.landmarks[index].runs.clone();
        for (run, linear) in self.structure.runs[runs].iter().zip(&mut self.linear) {
            let factors = &self.structure.factors[run.factors.clone()];
            let outcome = problem.group(run.group).linearize(factors, at, linear);
            outcome.map_err(|_| Singular::Undefined)?;
        }
        Ok(())
    }

    // ANCHOR: add_variables
    /// Adds the factors of the landmark to the blocks of the other variables, as if it could not
    /// move.
    #[inline(never)]
    fn add_variables(&mut self, index: usize) {
        let Self { structure, linear, schur, gradient, curvature, .. } = self;
        let rows = &structure.rows[structure.landmarks[index].rows.clone()];
        each_factor::<D>(structure, linear, index, |seen| {
            let Some(row) = seen.slot.map(|slot| rows[slot]) else { return };
            add_outer(schur.block(row, row), seen.other, seen.other);
            add_gradient(&mut gradient[row], &mut curvature[row], seen.other, seen.residual);
        });
    }
    // ANCHOR_END: add_variables

    // ANCHOR: eliminate
    /// Forms, damps and factors the 3×3 block of the landmark.
    #[inline(never)]
    fn eliminate(&mut self, index: usize, damping: f64) -> Result<(), Singular> {
        let (mut block, gradient) = landmark_block::<D>(&self.structure, &self.linear, index);
        let curvature = block.diagonal();
        let damping = curvature.map(|h| damping * h.max(SMALLEST_CURVATURE));
        for axis in 0..3 {
            block[(axis, axis)] += damping[axis];
            let scaled = gradient[axis] * gradient[axis] / curvature[axis];
            self.landmark_gradient += if curvature[axis] > 0.0 { scaled } else { 0.0 };
        }
        let inverse_factor = inverse_factor(&block, ROUNDING).ok_or(Singular::Landmark(index))?;
        let forward = inverse_factor * gradient;
        self.eliminated[index] = Eliminated { inverse_factor, forward, curvature, damping };
        Ok(())
    }
    // ANCHOR_END: eliminate

    // ANCHOR: couple
    /// The D×3 matrices U = Jᵀ L Mᵀ that couple the landmark to each of the variables that see it,
    /// summed over factors. They are blocks of the Cholesky factor of the whole system.
    ///
    /// Implements {eq:coupling-factor}.
    #[inline(never)]
    fn couple(&mut self, index: usize) {
        let Self { structure, linear, couplings, eliminated, .. } = self;
        let couplings = &mut couplings[structure.landmarks[index].rows.clone()];
        couplings.fill([[0.0; D]; 3]);
        let inverse_factor = &eliminated[index].inverse_factor;
        each_factor::<D>(structure, linear, index, |seen| {
            let Some(slot) = seen.slot else { return };
            for (other, landmark) in seen.other.iter().zip(seen.landmark) {
                let scaled = inverse_factor * Vector3::from(*landmark);
                for (column, scaled) in couplings[slot].iter_mut().zip(scaled.iter()) {
                    add_multiple(column, *scaled, other);
                }
            }
        });
    }
    // ANCHOR_END: couple

    // ANCHOR: subtract_pairs
    /// Subtracts what the landmark's freedom takes from each pair of variables that see it, and
    /// from their right-hand sides.
    ///
    /// Implements {eq:covisible-pairs}.
    #[inline(never)]
    fn subtract_pairs(&mut self, index: usize) {
        let range = self.structure.landmarks[index].rows.clone();
        let (rows, couplings) = (&self.structure.rows[range.clone()], &self.couplings[range]);
        let forward = &self.eliminated[index].forward;
        for (i, (row, left)) in rows.iter().zip(couplings).enumerate() {
            let (blocks, first) = self.schur.row(*row);
            for (column, right) in rows[..=i].iter().zip(couplings) {
                add_product(&mut blocks[column - first], -1.0, left, right);
            }
            for (column, forward) in left.iter().zip(forward.iter()) {
                add_multiple(&mut self.rhs[*row], *forward, column);
            }
        }
    }
    // ANCHOR_END: subtract_pairs

    /// Adds the factors that see no landmark.
    fn add_others(&mut self, problem: &Problem, at: Point) -> Result<(), Singular> {
        let Self { structure, linear, schur, gradient, curvature, .. } = self;
        for other in &structure.others {
            let linear = &mut linear[0];
            let outcome = problem.group(other.group).linearize(&[other.factor], at, linear);
            outcome.map_err(|_| Singular::Undefined)?;
            let moving = || {
                let rows = other.rows.iter().enumerate();
                rows.filter_map(|(slot, row)| Some(((*row)?, linear.rows_of::<D>(slot))))
            };
            for (row, left) in moving() {
                add_gradient(&mut gradient[row], &mut curvature[row], left, linear.residuals());
                for (column, right) in moving().filter(|(column, _)| *column <= row) {
                    add_outer(schur.block(row, column), left, right);
                }
            }
        }
        Ok(())
    }

    /// Damps the variables and completes their right-hand side, when all factors are in.
    fn damp(&mut self, damping: f64) {
        for row in 0..self.rhs.len() {
            for axis in 0..D {
                let curvature = self.curvature[row][axis];
                let added = damping * curvature.max(SMALLEST_CURVATURE);
                self.damping[row][axis] = added;
                self.smallest[row][axis] = ROUNDING * (curvature + added);
                self.schur.block(row, row)[axis][axis] += added;
                self.rhs[row][axis] -= self.gradient[row][axis];
            }
        }
        for &(row, axis) in &self.structure.held {
            self.schur.isolate(row, axis);
            self.rhs[row][axis] = 0.0;
        }
    }

    // ANCHOR: solve
    /// Factors the Schur complement and turns the right-hand side into the step. Returns its
    /// squared length in the coordinates of the factor: twice the decrease that the damped,
    /// linearized problem expects of these variables.
    fn solve(&mut self) -> Result<f64, Singular> {
        self.schur.factorize(&self.smallest).map_err(|_| Singular::SchurComplement)?;
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
    fn back_substitute(&self, forward: f64, step: &mut [f64]) -> (f64, f64) {
        let (mut twice_predicted, mut square) = (forward + self.damped_square(), self.square());
        self.write_variables(step);
        for (index, landmark) in self.structure.landmarks.iter().enumerate() {
            let change = self.landmark_step(index);
            step[landmark.coordinate..landmark.coordinate + 3].copy_from_slice(change.as_slice());
            let Eliminated { forward, curvature, damping, .. } = &self.eliminated[index];
            let squares = change.component_mul(&change);
            twice_predicted += forward.norm_squared() + damping.dot(&squares);
            square += curvature.dot(&squares);
        }
        (twice_predicted, square)
    }
    // ANCHOR_END: back_substitute

    /// Writes the step of the variables that have rows.
    fn write_variables(&self, step: &mut [f64]) {
        for (row, variables) in self.structure.variables.iter().enumerate() {
            for start in variables {
                step[*start..start + D].copy_from_slice(&self.rhs[row]);
            }
        }
    }

    // ANCHOR: landmark_step
    /// The move of a landmark, when the others' are known.
    ///
    /// Implements {eq:point-follows}.
    #[inline(always)]
    fn landmark_step(&self, index: usize) -> Vector3<f64> {
        let Eliminated { inverse_factor, forward, .. } = &self.eliminated[index];
        let range = self.structure.landmarks[index].rows.clone();
        let mut pull = *forward;
        for (row, coupling) in self.structure.rows[range.clone()].iter().zip(&self.couplings[range])
        {
            for (pull, column) in pull.iter_mut().zip(coupling) {
                *pull += dot(column, &self.rhs[*row]);
            }
        }
        -inverse_factor.tr_mul(&pull)
    }
    // ANCHOR_END: landmark_step

    /// The square of the variables' step, each direction weighted with its damping.
    fn damped_square(&self) -> f64 {
        weighted_square(&self.rhs, &self.damping)
    }

    /// The square of the variables' step, each direction weighted with its curvature.
    fn square(&self) -> f64 {
        weighted_square(&self.rhs, &self.curvature)
    }

    /// The norm of the scaled gradient.
    fn scaled_gradient(&self) -> f64 {
        let pairs = self.gradient.as_flattened().iter().zip(self.curvature.as_flattened());
        let squares = pairs.map(|(g, h)| if *h > 0.0 { g * g / h } else { 0.0 });
        (squares.sum::<f64>() + self.landmark_gradient).sqrt()
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
        let mut row_of_start = std::collections::BTreeMap::new();
        for (row, starts) in self.structure.variables.iter().enumerate() {
            row_of_start.extend(starts.iter().map(|start| (*start, row)));
        }
        let row = |index| {
            let start = problem.values().coordinates_of(index)?.start;
            row_of_start.get(&start).copied()
        };
        (0..problem.values().len()).map(row).collect()
    }

    /// The memory that it holds, in bytes.
    pub fn bytes(&self) -> usize {
        let rows = [&self.rhs, &self.curvature, &self.gradient, &self.damping, &self.smallest];
        rows.iter().map(|rows| size_of_val(rows.as_slice())).sum::<usize>()
            + D * D * size_of::<f64>() * self.schur.stored()
            + size_of_val(self.eliminated.as_slice())
            + self.linear.iter().map(Linearized::bytes).sum::<usize>()
            + self.couplings.capacity() * size_of::<[[f64; D]; 3]>()
            + self.structure.bytes()
    }
}

/// What is asked about a point where a search stands or might stand.
impl<const D: usize> LandmarkElimination<D> {
    /// The Schur complement as a dense matrix, with its right-hand side: `D` rows for each of
    /// [`LandmarkElimination::rows`]. Implements {eq:reduced-camera-system}, and
    /// {eq:damped-reduction} with a damping.
    ///
    /// # Errors
    ///
    /// [`Singular`] when a landmark is free, which needs a damping of zero.
    pub fn schur_complement(
        &mut self,
        problem: &Problem,
        at: Point,
        damping: f64,
    ) -> Result<(DMatrix<f64>, DVector<f64>), Singular> {
        self.eliminate_all(problem, at, damping)?;
        let rhs = DVector::from_column_slice(self.rhs.as_flattened());
        Ok((self.schur.to_matrix(), rhs))
    }

    /// The step of all coordinates that goes with a step of the variables that have rows, when the
    /// last elimination was [`LandmarkElimination::schur_complement`]. Gives the predicted decrease
    /// too; `forward` is twice the part of it that is not the landmarks'.
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
    fn inverse_schur_complement(
        &mut self,
        problem: &Problem,
        at: Point,
    ) -> Result<DMatrix<f64>, Singular> {
        self.eliminate_all(problem, at, 0.0)?;
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
        problem: &Problem,
        at: Point,
        others: &DMatrix<f64>,
    ) -> Result<Vec<Matrix3<f64>>, Singular> {
        let mut covariances = Vec::with_capacity(self.structure.landmarks.len());
        for index in 0..self.structure.landmarks.len() {
            self.linearize_landmark(problem, at, index)?;
            self.eliminate(index, 0.0)?;
            self.couple(index);
            covariances.push(self.landmark_covariance(index, others));
        }
        Ok(covariances)
    }

    // ANCHOR: landmark_covariance
    /// The covariance of the landmark that has been eliminated last: what its own factors leave
    /// open, and what the variables that see it hand on. Implements {eq:ba-point-covariance}.
    fn landmark_covariance(&self, index: usize, others: &DMatrix<f64>) -> Matrix3<f64> {
        let block = |row: usize, column: usize| others.fixed_view::<D, D>(D * row, D * column);
        let matrix = |columns: &[[f64; D]; 3]| {
            SMatrix::<f64, D, 3>::from_fn(|row, column| columns[column][row])
        };
        let range = self.structure.landmarks[index].rows.clone();
        let rows = &self.structure.rows[range.clone()];
        let couplings: Vec<_> = self.couplings[range].iter().map(matrix).collect();
        let mut sum = Matrix3::identity();
        for (row, left) in rows.iter().zip(&couplings) {
            for (column, right) in rows.iter().zip(&couplings) {
                sum += left.transpose() * block(*row, *column) * right;
            }
        }
        let factor = &self.eliminated[index].inverse_factor;
        factor.tr_mul(&sum) * factor
    }
    // ANCHOR_END: landmark_covariance
}

impl<const D: usize> LinearSystem for LandmarkElimination<D> {
    /// Nothing is computed here: a step linearizes landmark by landmark what it needs.
    fn linearize(&mut self, _problem: &Problem, _at: Point) -> Result<(), SolveError> {
        Ok(())
    }

    // ANCHOR: attempt
    fn step(
        &mut self,
        problem: &Problem,
        at: Point,
        damping: f64,
        into: &mut [f64],
    ) -> Option<Prediction> {
        self.eliminate_all(problem, at, damping).ok()?;
        let gradient_norm = self.scaled_gradient();
        let forward = self.solve().ok()?;
        let (twice, square) = self.back_substitute(forward, into);
        Some(Prediction {
            step_norm: square.sqrt(),
            predicted_decrease: 0.5 * twice,
            gradient_norm,
        })
    }
    // ANCHOR_END: attempt

    fn gradient_norm(&mut self, problem: &Problem, at: Point) -> Result<f64, SolveError> {
        self.clear();
        for index in 0..self.structure.landmarks.len() {
            let outcome = self.linearize_landmark(problem, at, index);
            outcome.map_err(|_| SolveError::OutOfRange)?;
            self.add_variables(index);
            // A landmark without curvature adds its gradient before it is found singular.
            let _ = self.eliminate(index, 1.0);
        }
        self.add_others(problem, at).map_err(|_| SolveError::OutOfRange)?;
        let norm = self.scaled_gradient();
        if norm.is_finite() { Ok(norm) } else { Err(SolveError::OutOfRange) }
    }

    fn covariance(&mut self, problem: &Problem, at: Point) -> Result<Covariance, SolveError> {
        let null_space = problem.null_space_at(at)?;
        if null_space.nullity() > 0 {
            return Err(null_space.undetermined());
        }
        let inverse = self.inverse_schur_complement(problem, at);
        let whole = inverse.and_then(|inverse| self.with_landmarks(problem, at, inverse));
        whole.map_err(|_| null_space.undetermined())
    }
}

/// Room for the factors of any one landmark, run by run, and for any one factor without landmark.
fn room_for_linearized(problem: &Problem, structure: &Structure) -> Vec<Linearized> {
    let runs = structure.landmarks.iter().map(|landmark| landmark.runs.len()).max();
    let mut linear = vec![Linearized::default(); runs.unwrap_or(0).max(1)];
    let mut reserve = |place: usize, group: usize, factors: usize| {
        let group = problem.group(group);
        linear[place].begin(factors, group.rows(), group.columns());
    };
    for landmark in &structure.landmarks {
        for (place, run) in structure.runs[landmark.runs.clone()].iter().enumerate() {
            reserve(place, run.group, run.factors.len());
        }
    }
    structure.others.iter().for_each(|other| reserve(0, other.group, 1));
    linear
}

/// A factor as the elimination sees it.
#[derive(Clone, Copy)]
struct Seen<'a, const D: usize> {
    /// The place of its other variable among the landmark's rows, `None` when that is held.
    slot: Option<usize>,
    /// Derivatives by the other variable, row by row; empty when it is held.
    other: &'a [[f64; D]],
    /// Derivatives by the landmark.
    landmark: &'a [[f64; 3]],
    residual: &'a [f64],
}

/// Goes through the linearized factors of a landmark.
#[inline(always)]
fn each_factor<'a, const D: usize>(
    structure: &'a Structure,
    linear: &'a [Linearized],
    index: usize,
    mut visit: impl FnMut(Seen<'a, D>),
) {
    let runs = &structure.runs[structure.landmarks[index].runs.clone()];
    for (run, linear) in runs.iter().zip(linear) {
        let (each, slots) = (linear.rows(), structure.groups[run.group]);
        let others = slots.other.map_or(&[][..], |slot| linear.rows_of::<D>(slot));
        let (landmarks, residuals) = (linear.rows_of::<3>(slots.landmark), linear.residuals());
        for (factor, slot) in structure.slots[run.factors.clone()].iter().enumerate() {
            let rows = factor * each..(factor + 1) * each;
            let slot = (*slot != HELD).then_some(*slot as usize);
            let other = if slot.is_some() { &others[rows.clone()] } else { &[] };
            visit(Seen {
                slot,
                other,
                landmark: &landmarks[rows.clone()],
                residual: &residuals[rows],
            });
        }
    }
}

/// Adds the product of the transposed rows of one variable with those of another to their block.
#[inline(always)]
fn add_outer<const D: usize>(block: &mut [[f64; D]; D], left: &[[f64; D]], right: &[[f64; D]]) {
    // Pixels have two rows; a length that is known when compiling keeps the sums in registers.
    match (left.as_array::<2>(), right.as_array::<2>()) {
        (Some(left), Some(right)) => add_product(block, 1.0, left, right),
        _ => add_product(block, 1.0, left, right),
    }
}

#[inline(always)]
fn add_gradient<const D: usize>(
    gradient: &mut [f64; D],
    curvature: &mut [f64; D],
    rows: &[[f64; D]],
    residual: &[f64],
) {
    for (row, residual) in rows.iter().zip(residual) {
        add_multiple(gradient, *residual, row);
        for (sum, slope) in curvature.iter_mut().zip(row) {
            *sum += slope * slope;
        }
    }
}

// ANCHOR: landmark_block
/// The lower triangle of a landmark's 3×3 block, and its gradient, from the factors that see it.
///
/// Implements the middle line of {eq:ba-blocks}.
#[inline(always)]
fn landmark_block<const D: usize>(
    structure: &Structure,
    linear: &[Linearized],
    index: usize,
) -> (Matrix3<f64>, Vector3<f64>) {
    let (mut block, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
    each_factor::<D>(structure, linear, index, |seen| {
        for (row, residual) in seen.landmark.iter().zip(seen.residual) {
            for column in 0..3 {
                gradient[column] = multiply_add(row[column], *residual, gradient[column]);
                for below in column..3 {
                    let sum = multiply_add(row[column], row[below], block[(below, column)]);
                    block[(below, column)] = sum;
                }
            }
        }
    });
    (block, gradient)
}
// ANCHOR_END: landmark_block

// ANCHOR: inverse_factor
/// The lower triangular M with M H Mᵀ = I, the inverse of the Cholesky factor of a 3×3
/// matrix H of which the lower triangle is read. `None` when a pivot is not above
/// `smallest` times its place on the diagonal.
#[inline(always)]
fn inverse_factor(h: &Matrix3<f64>, smallest: f64) -> Option<Matrix3<f64>> {
    let m11 = 1.0 / h.m11.sqrt();
    let (l21, l31) = (m11 * h.m21, m11 * h.m31);
    let second = h.m22 - l21 * l21;
    let m22 = 1.0 / second.sqrt();
    let l32 = m22 * (h.m32 - l31 * l21);
    let third = h.m33 - l31 * l31 - l32 * l32;
    let m33 = 1.0 / third.sqrt();
    let regular = h.m11 > 0.0 && second > smallest * h.m22 && third > smallest * h.m33;
    let m21 = -m22 * l21 * m11;
    let m31 = -m33 * (l31 * m11 + l32 * m21);
    let m32 = -m33 * l32 * m22;
    regular.then(|| Matrix3::new(m11, 0.0, 0.0, m21, m22, 0.0, m31, m32, m33))
}
// ANCHOR_END: inverse_factor

/// The sum of squares of a step, weighted.
fn weighted_square<const D: usize>(step: &[[f64; D]], weights: &[[f64; D]]) -> f64 {
    let pairs = step.as_flattened().iter().zip(weights.as_flattened());
    pairs.map(|(step, weight)| weight * step * step).sum()
}
