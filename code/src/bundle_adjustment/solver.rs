//! The solver: Levenberg-Marquardt with the points eliminated.

use std::fmt;

use nalgebra::{SMatrix, SVector, Vector2, Vector3};

use super::landmark::{self, Equations};
use super::layout::{HELD, Landmark, Layout, Sighting};
use super::reduced::dot;
use super::system::{Eliminated, Singular, System};
use super::{BaError, BaReport, Camera, TinyBa};

// ANCHOR: options
/// How to begin and when to stop.
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
// ANCHOR_END: options

// ANCHOR: stop
/// Why a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The last step lowered the cost by hardly anything.
    DecreaseSmall,
    /// The linearized problem promises hardly any decrease.
    PromiseSmall,
    /// All iterations are used up.
    IterationLimit,
    /// Not even the shortest steps lower the cost.
    Stalled,
}
// ANCHOR_END: stop

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DecreaseSmall => "the last step lowered the cost by hardly anything",
            Self::PromiseSmall => "the linearized problem promises hardly any decrease",
            Self::IterationLimit => "all iterations are used up",
            Self::Stalled => "not even the shortest steps lower the cost",
        })
    }
}

// ANCHOR: iteration
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
// ANCHOR_END: iteration

// ANCHOR: step
/// A step that was computed and not taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Step<const D: usize> {
    /// For each camera its small vector, zero when the camera is held.
    pub cameras: Vec<SVector<f64, D>>,
    /// For each point its move in metres, zero when the point was dropped.
    pub points: Vec<Vector3<f64>>,
    /// The decrease of the cost that the linearized problem promises, {eq:promise-in-parts}.
    pub promised: f64,
    /// The cost at the end of the step, infinite when a point loses its pixel there.
    pub cost: f64,
}
// ANCHOR_END: step

/// A rejected step is followed by one with at least this damping.
const SMALLEST_DAMPING: f64 = 1e-9;

/// Beyond this damping a step is too short to matter.
const LARGEST_DAMPING: f64 = 1e16;

// ANCHOR: solver
/// A problem taken apart and ready for steps, with all the memory that they need.
#[derive(Debug, Clone)]
pub struct Solver<C, const D: usize> {
    pub(super) layout: Layout,
    /// Threshold of Huber's kernel. Least squares has one that no residual reaches.
    huber: f64,
    options: Options,
    cameras: Vec<C>,
    points: Vec<Vector3<f64>>,
    cost: f64,
    trial_cameras: Vec<C>,
    trial_points: Vec<Vector3<f64>>,
    pub(super) system: System<D>,
    damping: f64,
    /// By how much the next rejection multiplies the damping.
    growth: f64,
    trace: Vec<Iteration>,
}
// ANCHOR_END: solver

impl<C: Camera<D>, const D: usize> Solver<C, D> {
    /// Checks a problem and prepares for it.
    ///
    /// # Errors
    ///
    /// [`BaError`] names the first thing that is wrong.
    pub fn new(problem: &TinyBa<C, D>, options: &Options) -> Result<Self, BaError> {
        let damping = checked(options.damping)?;
        let layout = Layout::new(problem)?;
        let mut solver = Self {
            system: System::new(&layout),
            layout,
            huber: problem.huber.unwrap_or(f64::INFINITY),
            options: *options,
            cameras: problem.cameras.clone(),
            points: problem.points.clone(),
            cost: 0.0,
            trial_cameras: problem.cameras.clone(),
            trial_points: problem.points.clone(),
            damping,
            growth: 2.0,
            trace: Vec::with_capacity(options.iterations.min(1000)),
        };
        solver.cost = solver.layout.landmarks.iter().map(|l| solver.trial_cost(l)).sum();
        Ok(solver)
    }

    // ANCHOR: iterate
    /// Tries one step and takes it if it lowers the cost. Says when to stop.
    pub fn iterate(&mut self) -> Option<Stop> {
        if self.trace.len() >= self.options.iterations {
            return Some(Stop::IterationLimit);
        }
        let (cost, damping) = (self.cost, self.damping);
        // A system that cannot be factored promises nothing, and is damped more.
        let (promised, trial_cost) = self.attempt(damping).unwrap_or((f64::NAN, f64::INFINITY));
        let gain = (cost - trial_cost) / promised;
        let (accepted, gradient) = (gain > 0.0, self.system.gradient_norm());
        self.trace.push(Iteration { cost, gradient, damping, trial_cost, gain, accepted });
        let negligible = self.options.relative_decrease * cost;
        if promised <= negligible {
            return Some(Stop::PromiseSmall);
        }
        self.judge(gain, trial_cost);
        if accepted && cost - trial_cost <= negligible {
            return Some(Stop::DecreaseSmall);
        }
        (self.damping > LARGEST_DAMPING).then_some(Stop::Stalled)
    }
    // ANCHOR_END: iterate

    // ANCHOR: judge
    /// Takes the step or not, and damps the next one less or more.
    fn judge(&mut self, gain: f64, trial_cost: f64) {
        if gain > 0.0 {
            std::mem::swap(&mut self.cameras, &mut self.trial_cameras);
            std::mem::swap(&mut self.points, &mut self.trial_points);
            self.cost = trial_cost;
            self.damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            self.growth = 2.0;
        } else {
            self.damping = (self.damping * self.growth).max(SMALLEST_DAMPING);
            self.growth *= 2.0;
        }
    }
    // ANCHOR_END: judge

    // ANCHOR: attempt
    /// Computes a step and where it leads: the decrease that the linearized problem
    /// promises, and the cost at its end.
    fn attempt(&mut self, damping: f64) -> Result<(f64, f64), Singular> {
        self.eliminate(damping)?;
        self.system.factorize()?;
        let forward = self.system.solve();
        self.move_cameras();
        Ok(self.back_substitute(forward))
    }
    // ANCHOR_END: attempt

    // ANCHOR: eliminate_all
    /// Linearizes and eliminates landmark by landmark, straight into the reduced system.
    ///
    /// Implements {eq:damped-reduction}.
    pub(super) fn eliminate(&mut self, damping: f64) -> Result<(), Singular> {
        let Self { layout, system, cameras, points, huber, .. } = self;
        system.clear();
        for (index, landmark) in layout.landmarks.iter().enumerate() {
            let (sightings, rows) = layout.seen(landmark);
            system.linearize(cameras, &points[landmark.point], sightings, *huber);
            system.add_rigs(sightings, rows);
            system.eliminate(index, damping)?;
            system.couple(index, sightings, rows);
            system.subtract_pairs(index, rows);
        }
        system.finish(damping);
        Ok(())
    }
    // ANCHOR_END: eliminate_all

    /// Moves the cameras along their rigs' step.
    fn move_cameras(&mut self) {
        for (camera, row) in self.layout.row_of.iter().enumerate() {
            if let Some(row) = row {
                let change = SVector::from(self.system.rhs[*row]);
                self.trial_cameras[camera] = self.cameras[camera].retract(&change);
            }
        }
    }

    // ANCHOR: back_substitute
    /// Moves the points along and sums the cost where they arrive. Returns the promised
    /// decrease and that cost; `forward` is what [`System::solve`] returned.
    ///
    /// Implements {eq:promise-in-parts}.
    fn back_substitute(&mut self, forward: f64) -> (f64, f64) {
        // Twice the promise: the square of the right-hand side in the coordinates of the
        // factor, and what the damping holds back.
        let mut twice_promised = forward + self.system.damped_square();
        let mut cost = 0.0;
        for index in 0..self.layout.landmarks.len() {
            let landmark = &self.layout.landmarks[index];
            let change = self.landmark_step(index);
            self.trial_points[landmark.point] = self.points[landmark.point] + change;
            let eliminated = &self.system.eliminated[index];
            let damped = eliminated.damping.component_mul(&change).dot(&change);
            twice_promised += eliminated.forward.norm_squared() + damped;
            cost += self.trial_cost(landmark);
        }
        (0.5 * twice_promised, cost)
    }
    // ANCHOR_END: back_substitute

    // ANCHOR: landmark_step
    /// The move of a landmark, when the rigs' are known. Its sightings are linearized again:
    /// that is hardly more work than to keep their couplings, and needs no memory.
    ///
    /// Implements {eq:point-follows}.
    pub(super) fn landmark_step(&self, index: usize) -> Vector3<f64> {
        let landmark = &self.layout.landmarks[index];
        let (sightings, rows) = self.layout.seen(landmark);
        let mut pull = Vector3::zeros();
        for sighting in sightings.iter().filter(|sighting| sighting.slot != HELD) {
            let camera = &self.cameras[sighting.camera as usize];
            let equations =
                Equations::new(camera, &self.points[landmark.point], sighting, self.huber);
            let step = &self.system.rhs[rows[sighting.slot as usize]];
            let moved = equations.camera.map(|row| dot(&row, step));
            pull += equations.point.tr_mul(&Vector2::from(moved));
        }
        let Eliminated { inverse_factor, forward, .. } = &self.system.eliminated[index];
        inverse_factor.tr_mul(&(forward - inverse_factor * pull))
    }
    // ANCHOR_END: landmark_step

    /// What couples a landmark to its rigs, after elimination: the rows of the rigs in the
    /// reduced system, and the D×3 matrices.
    pub(super) fn couplings(&mut self, index: usize) -> Vec<(usize, SMatrix<f64, D, 3>)> {
        let Self { layout, system, cameras, points, huber, .. } = self;
        let landmark = &layout.landmarks[index];
        let (sightings, rows) = layout.seen(landmark);
        system.linearize(cameras, &points[landmark.point], sightings, *huber);
        system.couple(index, sightings, rows);
        let matrix = |columns: &[[f64; D]; 3]| SMatrix::from_fn(|row, column| columns[column][row]);
        rows.iter().copied().zip(system.couplings.iter().map(matrix)).collect()
    }

    /// The cost of one landmark in the trial state.
    #[inline]
    fn trial_cost(&self, landmark: &Landmark) -> f64 {
        let point = &self.trial_points[landmark.point];
        let (sightings, _) = self.layout.seen(landmark);
        let cost = |sighting: &Sighting| {
            let camera = &self.trial_cameras[sighting.camera as usize];
            landmark::cost(camera, point, sighting, self.huber)
        };
        sightings.iter().map(cost).sum()
    }

    /// The step with a given damping from where the solver stands. It is not taken.
    ///
    /// # Errors
    ///
    /// With a damping of zero, [`BaError::RankDeficient`] or [`BaError::Ray`] when pixels
    /// leave something free.
    pub fn step(&mut self, damping: f64) -> Result<Step<D>, BaError> {
        let damping = checked(damping)?;
        self.eliminate(damping).map_err(|singular| self.explain(singular))?;
        self.system.factorize().map_err(|singular| self.explain(singular))?;
        let forward = self.system.solve();
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

    /// The memory that the solver holds, in bytes. It takes all of it when it is made.
    pub fn bytes(&self) -> usize {
        self.system.bytes()
            + self.layout.bytes()
            + size_of::<C>() * (self.cameras.capacity() + self.trial_cameras.capacity())
            + size_of::<Vector3<f64>>() * (self.points.capacity() + self.trial_points.capacity())
            + size_of::<Iteration>() * self.trace.capacity()
    }

    /// The cameras and the points.
    pub fn into_state(self) -> (Vec<C>, Vec<Vector3<f64>>) {
        (self.cameras, self.points)
    }

    /// What happened so far.
    pub fn report(&self, stop: Stop) -> BaReport {
        let reduced_dim = D * self.layout.rows;
        BaReport {
            cost: self.cost,
            rmse_px: self.rmse_px(),
            stop,
            trace: self.trace.clone(),
            full_dim: reduced_dim + 3 * self.layout.landmarks.len(),
            reduced_dim,
            dropped: self.layout.dropped,
            block_products: self.layout.block_products(),
            reduced_blocks: self.system.reduced.stored(),
        }
    }

    /// See [`BaReport::rmse_px`].
    fn rmse_px(&self) -> f64 {
        let mut squares = 0.0;
        for landmark in &self.layout.landmarks {
            let point = &self.points[landmark.point];
            for sighting in self.layout.seen(landmark).0 {
                let pixel = self.cameras[sighting.camera as usize].project(point);
                squares += pixel.map_or(f64::NAN, |pixel| (pixel - sighting.pixel).norm_squared());
            }
        }
        (squares / self.layout.sightings.len() as f64).sqrt()
    }
}

/// The damping, if it is one.
fn checked(damping: f64) -> Result<f64, BaError> {
    let valid = damping.is_finite() && damping >= 0.0;
    valid.then_some(damping).ok_or(BaError::Damping { value: damping })
}
