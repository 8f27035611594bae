//! The solver: a step of Levenberg-Marquardt with the points eliminated.

use std::fmt;

use nalgebra::{SVector, Vector3};

use super::landmark::{self, Eliminated, Equations};
use super::layout::{HELD, Layout};
use super::reduced::{Reduced, add_multiple, add_product, dot};
use super::{BaError, BaReport, Camera, TinyBa};

// ANCHOR: options
/// When to stop and how to begin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Stop after this many iterations, accepted or not.
    pub iterations: usize,
    /// Stop when a step lowers the cost, or promises to lower it, by less than this
    /// fraction.
    pub relative_decrease: f64,
    /// The damping λ at the start: λ times its own curvature is added to each unknown's.
    pub damping: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { iterations: 50, relative_decrease: 1e-6, damping: 1e-4 }
    }
}

/// Why a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The last step lowered the cost by hardly anything.
    SmallDecrease,
    /// The linearized problem promises hardly any decrease.
    SmallPromise,
    /// All iterations are used up.
    IterationLimit,
    /// Not even the shortest steps lower the cost.
    Stalled,
}
// ANCHOR_END: options

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SmallDecrease => "the last step lowered the cost by hardly anything",
            Self::SmallPromise => "the linearized problem promises hardly any decrease",
            Self::IterationLimit => "all iterations are used up",
            Self::Stalled => "not even the shortest steps lower the cost",
        })
    }
}

/// One iteration: a step that was tried, and what came of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration {
    /// The cost before.
    pub cost: f64,
    /// The length of the cost's gradient before, over all unknowns.
    pub gradient: f64,
    /// The damping λ.
    pub damping: f64,
    /// The cost that the step leads to; infinite when there was no step, or when a point
    /// lost its pixel.
    pub trial_cost: f64,
    /// The decrease over the one that the linearized problem promised.
    pub gain: f64,
    /// Whether the step was taken.
    pub accepted: bool,
}

/// A step that was computed and not taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Step<const D: usize> {
    /// For each camera its small vector, zero when the camera is held.
    pub cameras: Vec<SVector<f64, D>>,
    /// For each point its move in metres, zero when the point was dropped.
    pub points: Vec<Vector3<f64>>,
    /// The decrease of the cost that the linearized problem promises.
    pub promised: f64,
    /// The cost at the end of the step, infinite when a point loses its pixel there.
    pub cost: f64,
}

/// Pivots below this fraction of the undivided curvature are rounding errors.
const ROUNDING: f64 = 1e-12;

/// No curvature counts as smaller than this when it is damped, so that an unknown that no
/// pixel depends on stays where it is.
const SMALLEST_CURVATURE: f64 = 1e-6;

/// Beyond this damping a step is too short to matter.
const LARGEST_DAMPING: f64 = 1e16;

/// What has no inverse.
#[derive(Debug, Clone, Copy)]
pub(super) enum Singular {
    /// The 3×3 block of this point.
    Point(usize),
    /// The reduced system.
    Rigs,
}

// ANCHOR: solver
/// A problem taken apart and ready for steps, with all the memory they need.
#[derive(Debug, Clone)]
pub struct Solver<C, const D: usize> {
    pub(super) layout: Layout,
    huber: Option<f64>,
    options: Options,
    cameras: Vec<C>,
    pub(super) points: Vec<Vector3<f64>>,
    cost: f64,
    damping: f64,
    /// By how much the next rejection multiplies the damping.
    growth: f64,
    trace: Vec<Iteration>,
    pub(super) system: System<D>,
    trial_cameras: Vec<C>,
    trial_points: Vec<Vector3<f64>>,
}

/// The equations of one step, as far as they are kept.
#[derive(Debug, Clone)]
pub(super) struct System<const D: usize> {
    /// The reduced system, and then its Cholesky factor.
    pub reduced: Reduced<D>,
    /// Its right-hand side, and then the step of the rigs.
    pub rhs: Vec<[f64; D]>,
    /// What damping added to the diagonal.
    damping: Vec<[f64; D]>,
    /// Pivots must be above this.
    smallest: Vec<[f64; D]>,
    /// The diagonal before anything was added or eliminated.
    pub curvature: Vec<[f64; D]>,
    /// The right-hand side before elimination.
    gradient: Vec<[f64; D]>,
    /// By landmark.
    pub eliminated: Vec<Eliminated>,
    /// By slot: see [`landmark::couple`].
    pub couplings: Vec<[[f64; D]; 3]>,
    /// The sightings of the landmark at hand.
    equations: Vec<Equations<D>>,
    /// Sum of squares of the points' gradients.
    point_gradient: f64,
}
// ANCHOR_END: solver

impl<C: Camera<D>, const D: usize> Solver<C, D> {
    /// Checks a problem and prepares for it.
    ///
    /// # Errors
    ///
    /// [`BaError`] names the first thing that is wrong.
    pub fn new(problem: &TinyBa<C, D>, options: &Options) -> Result<Self, BaError> {
        let damping = options.damping;
        if !(damping.is_finite() && damping >= 0.0) {
            return Err(BaError::Damping { value: damping });
        }
        let layout = Layout::new(problem)?;
        let mut solver = Self {
            system: System::new(&layout),
            huber: problem.huber,
            options: *options,
            cameras: problem.cameras.clone(),
            points: problem.points.clone(),
            cost: 0.0,
            damping,
            growth: 2.0,
            trace: Vec::with_capacity(options.iterations),
            trial_cameras: problem.cameras.clone(),
            trial_points: problem.points.clone(),
            layout,
        };
        solver.cost = solver.trial_cost();
        Ok(solver)
    }

    // ANCHOR: iterate
    /// Tries one step and takes it if it lowers the cost. Says when to stop.
    pub fn iterate(&mut self) -> Option<StopReason> {
        if self.trace.len() >= self.options.iterations {
            return Some(StopReason::IterationLimit);
        }
        let (cost, damping) = (self.cost, self.damping);
        // A system that cannot be factored makes no promise, and is damped more.
        let (promised, trial_cost) = self.attempt(damping).unwrap_or((f64::NAN, f64::INFINITY));
        let gain = (cost - trial_cost) / promised;
        let accepted = gain > 0.0;
        let gradient = self.system.gradient_norm();
        self.trace.push(Iteration { cost, gradient, damping, trial_cost, gain, accepted });
        let negligible = self.options.relative_decrease * cost;
        if promised <= negligible {
            return Some(StopReason::SmallPromise);
        }
        self.judge(gain, trial_cost);
        if accepted && cost - trial_cost <= negligible {
            return Some(StopReason::SmallDecrease);
        }
        (self.damping > LARGEST_DAMPING).then_some(StopReason::Stalled)
    }

    /// Takes the step or not, and damps the next one less or more.
    fn judge(&mut self, gain: f64, trial_cost: f64) {
        if gain > 0.0 {
            std::mem::swap(&mut self.cameras, &mut self.trial_cameras);
            std::mem::swap(&mut self.points, &mut self.trial_points);
            self.cost = trial_cost;
            self.damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            self.growth = 2.0;
        } else {
            self.damping *= self.growth;
            self.growth *= 2.0;
        }
    }
    // ANCHOR_END: iterate

    // ANCHOR: attempt
    /// Computes a step and where it leads: the decrease that the linearized problem
    /// promises, and the cost at its end.
    fn attempt(&mut self, damping: f64) -> Result<(f64, f64), Singular> {
        self.eliminate(damping)?;
        self.factorize()?;
        let forward = self.solve();
        self.move_cameras();
        Ok(self.back_substitute(forward))
    }
    // ANCHOR_END: attempt

    // ANCHOR: eliminate
    /// Linearizes and eliminates landmark by landmark, straight into the reduced system.
    pub(super) fn eliminate(&mut self, damping: f64) -> Result<(), Singular> {
        let Self { layout, system, cameras, points, huber, .. } = self;
        system.clear();
        for (index, landmark) in layout.landmarks.iter().enumerate() {
            let point = &points[landmark.point];
            let sightings = &layout.sightings[landmark.sightings.clone()];
            system.equations.clear();
            system.equations.extend(sightings.iter().map(|sighting| {
                Equations::new(&cameras[sighting.camera as usize], point, sighting, *huber)
            }));
            let slots = &layout.slots[landmark.slots.clone()];
            system.add_cameras(sightings, slots);
            if !system.eliminate_point(index, damping) {
                return Err(Singular::Point(landmark.point));
            }
            let inverse_factor = &system.eliminated[index].inverse_factor;
            let couplings = &mut system.couplings[landmark.slots.clone()];
            landmark::couple(couplings, sightings, &system.equations, inverse_factor);
            system.subtract_pairs(index, landmark.slots.clone(), slots);
        }
        system.damp(damping);
        Ok(())
    }
    // ANCHOR_END: eliminate

    // ANCHOR: solve_reduced
    /// Factors the reduced system in place. Pivots that are mere rounding errors of the
    /// curvature that was there before elimination are refused.
    pub(super) fn factorize(&mut self) -> Result<(), Singular> {
        let System { reduced, curvature, damping, smallest, .. } = &mut self.system;
        for (row, smallest) in smallest.iter_mut().enumerate() {
            *smallest =
                std::array::from_fn(|axis| ROUNDING * (curvature[row][axis] + damping[row][axis]));
        }
        reduced.factorize(smallest).map_err(|_| Singular::Rigs)
    }

    /// Solves the reduced system in place. Returns the squared length of the right-hand
    /// side in the coordinates of the factor, which is twice what the rigs contribute to
    /// the promised decrease.
    fn solve(&mut self) -> f64 {
        let System { reduced, rhs, .. } = &mut self.system;
        reduced.solve_lower(rhs);
        let forward = rhs.iter().map(|z| dot(z, z)).sum();
        reduced.solve_upper(rhs);
        forward
    }

    fn move_cameras(&mut self) {
        for (camera, row) in self.layout.row_of.iter().enumerate() {
            if let Some(row) = row {
                let change = SVector::from(self.system.rhs[*row]);
                self.trial_cameras[camera] = self.cameras[camera].retract(&change);
            }
        }
    }
    // ANCHOR_END: solve_reduced

    // ANCHOR: back_substitute
    /// Moves the points along and sums the cost where they arrive. `forward` is what
    /// [`Solver::solve`] returned.
    fn back_substitute(&mut self, forward: f64) -> (f64, f64) {
        let Self { layout, system, .. } = self;
        // Twice the promise: the right-hand side in the factor's coordinates, squared, and
        // what the damping takes off.
        let mut twice_promised = forward + system.damped_square();
        let mut cost = 0.0;
        for (landmark, eliminated) in layout.landmarks.iter().zip(&system.eliminated) {
            let mut rest = eliminated.forward;
            for slot in landmark.slots.clone() {
                let (coupling, change) = (&system.couplings[slot], &system.rhs[layout.slots[slot]]);
                for axis in 0..3 {
                    rest[axis] -= dot(&coupling[axis], change);
                }
            }
            let change = eliminated.inverse_factor.tr_mul(&rest);
            let point = self.points[landmark.point] + change;
            self.trial_points[landmark.point] = point;
            let damped = eliminated.damping.component_mul(&change).dot(&change);
            twice_promised += eliminated.forward.norm_squared() + damped;
            for sighting in &layout.sightings[landmark.sightings.clone()] {
                let camera = &self.trial_cameras[sighting.camera as usize];
                cost += landmark::cost(camera, &point, sighting, self.huber);
            }
        }
        (0.5 * twice_promised, cost)
    }
    // ANCHOR_END: back_substitute

    /// The cost of the trial state.
    fn trial_cost(&self) -> f64 {
        let of_landmark = |landmark: &super::layout::Landmark| -> f64 {
            let point = &self.trial_points[landmark.point];
            let sightings = &self.layout.sightings[landmark.sightings.clone()];
            let cost = |sighting: &super::layout::Sighting| {
                let camera = &self.trial_cameras[sighting.camera as usize];
                landmark::cost(camera, point, sighting, self.huber)
            };
            sightings.iter().map(cost).sum()
        };
        self.layout.landmarks.iter().map(of_landmark).sum()
    }

    /// The step with a given damping from where the solver stands. It is not taken.
    ///
    /// # Errors
    ///
    /// With a damping of zero, [`BaError::RankDeficient`] or [`BaError::Ray`] when pixels
    /// leave something free.
    pub fn step(&mut self, damping: f64) -> Result<Step<D>, BaError> {
        if !(damping.is_finite() && damping >= 0.0) {
            return Err(BaError::Damping { value: damping });
        }
        self.eliminate(damping).map_err(|singular| self.explain(singular))?;
        self.factorize().map_err(|singular| self.explain(singular))?;
        let forward = self.solve();
        Ok(self.complete_step(forward))
    }

    /// Completes a step of which the rigs' part is known.
    pub(super) fn complete_step(&mut self, forward: f64) -> Step<D> {
        self.move_cameras();
        let (promised, cost) = self.back_substitute(forward);
        let change =
            |row: &Option<usize>| row.map_or(SVector::zeros(), |row| self.system.rhs[row].into());
        let cameras = self.layout.row_of.iter().map(change).collect();
        let mut points = vec![Vector3::zeros(); self.points.len()];
        for landmark in &self.layout.landmarks {
            let point = landmark.point;
            points[point] = self.trial_points[point] - self.points[point];
        }
        Step { cameras, points, promised, cost }
    }

    /// The cost where the solver stands.
    pub fn cost(&self) -> f64 {
        self.cost
    }

    /// The cameras where the solver stands.
    pub fn cameras(&self) -> &[C] {
        &self.cameras
    }

    /// The points where the solver stands, in metres.
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// The iterations so far.
    pub fn trace(&self) -> &[Iteration] {
        &self.trace
    }

    /// For each camera the row of D×D blocks that it has in the reduced system, `None` when
    /// it is held.
    pub fn rows(&self) -> &[Option<usize>] {
        &self.layout.row_of
    }

    /// The cameras and the points.
    pub fn into_state(self) -> (Vec<C>, Vec<Vector3<f64>>) {
        (self.cameras, self.points)
    }

    /// What happened so far.
    pub fn report(&self, stop: StopReason) -> BaReport {
        let sightings = &self.layout.sightings;
        let mut squares = 0.0;
        for landmark in &self.layout.landmarks {
            for sighting in &sightings[landmark.sightings.clone()] {
                let camera = &self.cameras[sighting.camera as usize];
                let pixel = camera.project(&self.points[landmark.point]);
                squares += pixel.map_or(f64::NAN, |pixel| (sighting.pixel - pixel).norm_squared());
            }
        }
        let reduced_dim = D * self.layout.rows;
        BaReport {
            cost: self.cost,
            rmse_px: (squares / sightings.len() as f64).sqrt(),
            stop,
            trace: self.trace.clone(),
            full_dim: reduced_dim + 3 * self.layout.landmarks.len(),
            reduced_dim,
            dropped: self.layout.dropped,
            block_products: self.layout.block_products(),
        }
    }
}

impl<const D: usize> System<D> {
    fn new(layout: &Layout) -> Self {
        let (sightings, _) = layout.longest();
        let zeros = vec![[0.0; D]; layout.rows];
        Self {
            reduced: Reduced::new(layout.first_columns()),
            rhs: zeros.clone(),
            damping: zeros.clone(),
            smallest: zeros.clone(),
            curvature: zeros.clone(),
            gradient: zeros,
            eliminated: vec![Eliminated::empty(); layout.landmarks.len()],
            couplings: vec![[[0.0; D]; 3]; layout.slots.len()],
            equations: Vec::with_capacity(sightings),
            point_gradient: 0.0,
        }
    }

    fn clear(&mut self) {
        self.reduced.clear();
        self.rhs.fill([0.0; D]);
        self.curvature.fill([0.0; D]);
        self.gradient.fill([0.0; D]);
        self.point_gradient = 0.0;
    }

    // ANCHOR: add_cameras
    /// Adds the equations of one landmark to the cameras' own blocks.
    fn add_cameras(&mut self, sightings: &[super::layout::Sighting], slots: &[usize]) {
        for (sighting, Equations { camera: rows, error, .. }) in
            sightings.iter().zip(&self.equations)
        {
            if sighting.slot == HELD {
                continue;
            }
            let row = slots[sighting.slot as usize];
            add_product(self.reduced.tile(row, row), 1.0, rows, rows);
            let [u, v] = rows;
            add_multiple(&mut self.gradient[row], error.x, u);
            add_multiple(&mut self.gradient[row], error.y, v);
            for (sum, (u, v)) in self.curvature[row].iter_mut().zip(u.iter().zip(v)) {
                *sum += u * u + v * v;
            }
        }
    }
    // ANCHOR_END: add_cameras

    // ANCHOR: eliminate_point
    /// Forms and factors the 3×3 block of one landmark; false when it is singular.
    fn eliminate_point(&mut self, index: usize, damping: f64) -> bool {
        let (mut block, gradient) = landmark::point_block(&self.equations);
        let added = block.diagonal().map(|h| damping * h.max(SMALLEST_CURVATURE));
        for axis in 0..3 {
            block[(axis, axis)] += added[axis];
        }
        self.point_gradient += gradient.norm_squared();
        let Some(inverse_factor) = landmark::inverse_factor(&block, ROUNDING) else {
            return false;
        };
        let forward = inverse_factor * gradient;
        self.eliminated[index] = Eliminated { inverse_factor, forward, damping: added };
        true
    }
    // ANCHOR_END: eliminate_point

    // ANCHOR: subtract_pairs
    /// Subtracts what an eliminated landmark costs each pair of rigs that see it.
    fn subtract_pairs(&mut self, index: usize, range: std::ops::Range<usize>, slots: &[usize]) {
        let couplings = &self.couplings[range];
        let forward = &self.eliminated[index].forward;
        for (i, (row, left)) in slots.iter().zip(couplings).enumerate() {
            for (column, right) in slots[..=i].iter().zip(couplings) {
                add_product(self.reduced.tile(*row, *column), -1.0, left, right);
            }
            for (column, forward) in left.iter().zip(forward.iter()) {
                add_multiple(&mut self.rhs[*row], -forward, column);
            }
        }
    }
    // ANCHOR_END: subtract_pairs

    /// Damps the rigs, and completes the right-hand side.
    fn damp(&mut self, damping: f64) {
        for row in 0..self.rhs.len() {
            for axis in 0..D {
                let added = damping * self.curvature[row][axis].max(SMALLEST_CURVATURE);
                self.damping[row][axis] = added;
                self.reduced.tile(row, row)[axis][axis] += added;
                self.rhs[row][axis] += self.gradient[row][axis];
            }
        }
    }

    /// The square of the rigs' step, each direction weighted with its damping.
    fn damped_square(&self) -> f64 {
        let rows = self.rhs.iter().zip(&self.damping);
        rows.flat_map(|(step, damping)| step.iter().zip(damping))
            .map(|(step, damping)| damping * step * step)
            .sum()
    }

    fn gradient_norm(&self) -> f64 {
        let cameras: f64 = self.gradient.iter().map(|g| dot(g, g)).sum();
        (cameras + self.point_gradient).sqrt()
    }
}
