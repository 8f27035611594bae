//! The equations of one step: what is summed over the landmarks, and what is kept of each.

use nalgebra::{Matrix3, Vector3};

use super::Camera;
use super::landmark::{self, Equations};
use super::layout::{HELD, Layout, Sighting};
use super::reduced::{Reduced, add_multiple, add_product, dot};

/// Pivots below this fraction of the curvature before elimination are rounding errors.
const ROUNDING: f64 = 1e-12;

/// No curvature counts as smaller than this when it is damped, so that an unknown that no
/// pixel depends on stays where it is.
const SMALLEST_CURVATURE: f64 = 1e-6;

/// What has no inverse.
#[derive(Debug, Clone, Copy)]
pub enum Singular {
    /// The 3×3 block of this landmark.
    Landmark(usize),
    /// The reduced system.
    Rigs,
}

// ANCHOR: system
/// The damped normal equations of one step with the landmarks eliminated. A row is a block
/// of D numbers and belongs to a rig.
#[derive(Debug, Clone)]
pub struct System<const D: usize> {
    /// The reduced system S, and then its Cholesky factor.
    pub reduced: Reduced<D>,
    /// Its right-hand side, and then the step of the rigs.
    pub rhs: Vec<[f64; D]>,
    /// The diagonal before damping and elimination.
    pub curvature: Vec<[f64; D]>,
    /// By landmark.
    pub eliminated: Vec<Eliminated>,
    /// The gradient of the cost before elimination.
    gradient: Vec<[f64; D]>,
    /// The same for all landmarks together: its squared length.
    landmark_gradient: f64,
    /// What damping added to the diagonal.
    damping: Vec<[f64; D]>,
    /// Pivots must be above this.
    smallest: Vec<[f64; D]>,
    /// The sightings of the landmark at hand.
    equations: Vec<Equations<D>>,
    /// The D×3 matrices that couple it to its rigs: see [`landmark::couple`].
    pub couplings: Vec<[[f64; D]; 3]>,
}
// ANCHOR_END: system

// ANCHOR: eliminated
/// What is kept of a landmark, enough to find its move once the rigs' are known.
#[derive(Debug, Clone, Copy)]
pub struct Eliminated {
    /// The lower triangular M with M H Mᵀ = I for the landmark's damped 3×3 block H.
    pub inverse_factor: Matrix3<f64>,
    /// M times the landmark's right-hand side, the negative gradient.
    pub forward: Vector3<f64>,
    /// What damping added to the diagonal of H.
    pub damping: Vector3<f64>,
}
// ANCHOR_END: eliminated

impl<const D: usize> System<D> {
    /// Room for all that a problem's steps will need.
    pub fn new(layout: &Layout) -> Self {
        let zeros = vec![[0.0; D]; layout.rows];
        let zero = Vector3::zeros();
        let nothing = Eliminated { inverse_factor: Matrix3::zeros(), forward: zero, damping: zero };
        let longest = layout.landmarks.iter().map(|landmark| landmark.sightings.len()).max();
        Self {
            reduced: Reduced::new(layout.first_columns()),
            rhs: zeros.clone(),
            curvature: zeros.clone(),
            eliminated: vec![nothing; layout.landmarks.len()],
            gradient: zeros.clone(),
            landmark_gradient: 0.0,
            damping: zeros.clone(),
            smallest: zeros,
            equations: Vec::with_capacity(longest.unwrap_or(0)),
            couplings: Vec::with_capacity(longest.unwrap_or(0)),
        }
    }

    /// Forgets the last step.
    pub fn clear(&mut self) {
        self.reduced.clear();
        self.rhs.fill([0.0; D]);
        self.curvature.fill([0.0; D]);
        self.gradient.fill([0.0; D]);
        self.landmark_gradient = 0.0;
    }

    /// Linearizes the sightings of one landmark.
    pub fn linearize<C: Camera<D>>(
        &mut self,
        cameras: &[C],
        point: &Vector3<f64>,
        sightings: &[Sighting],
        huber: f64,
    ) {
        self.equations.clear();
        for sighting in sightings {
            let camera = &cameras[sighting.camera as usize];
            self.equations.push(Equations::new(camera, point, sighting, huber));
        }
    }

    // ANCHOR: add_rigs
    /// Adds the sightings of the landmark to the blocks of its rigs, `rows`, as if it could
    /// not move.
    pub fn add_rigs(&mut self, sightings: &[Sighting], rows: &[usize]) {
        for (sighting, equations) in sightings.iter().zip(&self.equations) {
            if sighting.slot == HELD {
                continue;
            }
            let row = rows[sighting.slot as usize];
            let Equations { camera, residual, .. } = equations;
            add_product(self.reduced.tile(row, row), 1.0, camera, camera);
            let [u, v] = camera;
            add_multiple(&mut self.gradient[row], residual.x, u);
            add_multiple(&mut self.gradient[row], residual.y, v);
            for (sum, (u, v)) in self.curvature[row].iter_mut().zip(u.iter().zip(v)) {
                *sum += u * u + v * v;
            }
        }
    }
    // ANCHOR_END: add_rigs

    // ANCHOR: eliminate
    /// Forms, damps and factors the 3×3 block of the landmark.
    pub fn eliminate(&mut self, index: usize, damping: f64) -> Result<(), Singular> {
        let (mut block, gradient) = landmark::point_block(&self.equations);
        let damping = block.diagonal().map(|h| damping * h.max(SMALLEST_CURVATURE));
        for axis in 0..3 {
            block[(axis, axis)] += damping[axis];
        }
        let inverse_factor =
            landmark::inverse_factor(&block, ROUNDING).ok_or(Singular::Landmark(index))?;
        let forward = -(inverse_factor * gradient);
        self.landmark_gradient += gradient.norm_squared();
        self.eliminated[index] = Eliminated { inverse_factor, forward, damping };
        Ok(())
    }
    // ANCHOR_END: eliminate

    /// Couples the landmark to its rigs: see [`landmark::couple`].
    pub fn couple(&mut self, index: usize, sightings: &[Sighting], rows: &[usize]) {
        self.couplings.clear();
        self.couplings.resize(rows.len(), [[0.0; D]; 3]);
        let inverse_factor = &self.eliminated[index].inverse_factor;
        landmark::couple(&mut self.couplings, sightings, &self.equations, inverse_factor);
    }

    // ANCHOR: subtract_pairs
    /// Subtracts what the landmark's freedom takes from each pair of rigs that see it, and
    /// from their right-hand sides.
    ///
    /// Implements {eq:covisible-pairs}.
    pub fn subtract_pairs(&mut self, index: usize, rows: &[usize]) {
        let forward = &self.eliminated[index].forward;
        for (i, (row, left)) in rows.iter().zip(&self.couplings).enumerate() {
            let (tiles, first) = self.reduced.row(*row);
            for (column, right) in rows[..=i].iter().zip(&self.couplings) {
                add_product(&mut tiles[column - first], -1.0, left, right);
            }
            for (column, forward) in left.iter().zip(forward.iter()) {
                add_multiple(&mut self.rhs[*row], -forward, column);
            }
        }
    }
    // ANCHOR_END: subtract_pairs

    /// Damps the rigs and completes their right-hand side, when all landmarks are in.
    pub fn finish(&mut self, damping: f64) {
        for row in 0..self.rhs.len() {
            for axis in 0..D {
                let curvature = self.curvature[row][axis];
                let added = damping * curvature.max(SMALLEST_CURVATURE);
                self.damping[row][axis] = added;
                self.smallest[row][axis] = ROUNDING * (curvature + added);
                self.reduced.tile(row, row)[axis][axis] += added;
                self.rhs[row][axis] -= self.gradient[row][axis];
            }
        }
    }

    // ANCHOR: solve_reduced
    /// Factors the reduced system in place.
    pub fn factorize(&mut self) -> Result<(), Singular> {
        self.reduced.factorize(&self.smallest).map_err(|_| Singular::Rigs)
    }

    /// Turns the right-hand side into the step of the rigs. Returns its squared length in
    /// the coordinates of the factor: twice the decrease that the damped, linearized
    /// problem expects of the rigs.
    pub fn solve(&mut self) -> f64 {
        self.reduced.solve_lower(&mut self.rhs);
        let forward = self.rhs.iter().map(|z| dot(z, z)).sum();
        self.reduced.solve_upper(&mut self.rhs);
        forward
    }
    // ANCHOR_END: solve_reduced

    /// The square of the rigs' step, each direction weighted with its damping.
    pub fn damped_square(&self) -> f64 {
        let pairs = self.rhs.as_flattened().iter().zip(self.damping.as_flattened());
        pairs.map(|(step, damping)| damping * step * step).sum()
    }

    /// The length of the cost's gradient over all unknowns.
    pub fn gradient_norm(&self) -> f64 {
        let rigs: f64 = self.gradient.iter().map(|g| dot(g, g)).sum();
        (rigs + self.landmark_gradient).sqrt()
    }

    /// The memory that it holds, in bytes.
    pub fn bytes(&self) -> usize {
        let rows = [&self.rhs, &self.curvature, &self.gradient, &self.damping, &self.smallest];
        rows.iter().map(|rows| size_of_val(rows.as_slice())).sum::<usize>()
            + D * D * size_of::<f64>() * self.reduced.stored()
            + size_of_val(self.eliminated.as_slice())
            + self.equations.capacity() * size_of::<Equations<D>>()
            + self.couplings.capacity() * size_of::<[[f64; D]; 3]>()
    }
}
