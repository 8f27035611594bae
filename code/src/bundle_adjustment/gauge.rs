//! What pixels leave free, and how to name it.

use std::fmt;

use nalgebra::{DMatrix, DVector, Dyn, OMatrix, U7, Vector3};

use super::{BaError, Camera, Solver, TrialStep};
use crate::least_squares::{NullSpace, Singular};

// ANCHOR: gauge_freedom
/// How many independent directions of each kind are free: moved along one of them, cameras
/// and points together change no pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GaugeFreedom {
    /// The whole moves: at most three.
    pub position: usize,
    /// The whole turns: at most three.
    pub orientation: usize,
    /// The whole grows: at most one.
    pub scale: usize,
    /// Anything else, such as a camera that sees too little.
    pub other: usize,
}

impl GaugeFreedom {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.position + self.orientation + self.scale + self.other
    }
}
// ANCHOR_END: gauge_freedom

impl fmt::Display for GaugeFreedom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = [
            (self.position, "position"),
            (self.orientation, "orientation"),
            (self.scale, "scale"),
            (self.other, "something that is neither position, orientation nor scale"),
        ];
        let names: Vec<&str> =
            kinds.iter().filter(|(count, _)| *count > 0).map(|(_, name)| *name).collect();
        let verb = if names.len() == 1 { "is" } else { "are" };
        let rigid = self.position + self.orientation > 0;
        let advice = match (rigid, self.scale > 0) {
            (true, true) => "fix a camera, and pin one more thing, add stereo or an IMU",
            (true, false) => "fix a camera",
            (false, true) => "pin one more thing, add stereo or an IMU",
            (false, false) => "look for a camera with too few points, fix it or remove it",
        };
        write!(f, "{} {verb} free: {advice}", names.join(", "))
    }
}

/// Eigenvectors of the Schur complement along which pixels change, their eigenvalues, and its
/// right-hand side.
pub(super) struct SeenDirections {
    pub(super) vectors: DMatrix<f64>,
    pub(super) values: DVector<f64>,
    pub(super) rhs: DVector<f64>,
}

impl<C: Camera<D>, const D: usize> Solver<C, D> {
    /// What pixels leave free where the solver stands, cameras and points together.
    fn free(&self) -> Result<NullSpace, BaError> {
        Ok(self.assembly.problem.null_space(self.values())?)
    }

    // ANCHOR: null_space
    /// The small vectors of the cameras, one column for each independent direction, along
    /// which no pixel changes once the points follow: D rows for each of [`Solver::rows`]. The
    /// columns have no particular length.
    ///
    /// # Errors
    ///
    /// [`BaError::Solve`] when it cannot be said what is free.
    pub fn null_space(&self) -> Result<DMatrix<f64>, BaError> {
        let directions = self.free()?.directions();
        let rows = self.rows();
        let count = rows.iter().flatten().max().map_or(0, |last| last + 1);
        let mut cameras = DMatrix::zeros(D * count, directions.ncols());
        for (camera, row) in self.assembly.cameras.iter().zip(rows) {
            let Some(row) = row else { continue };
            let columns = self.columns_of(camera.index());
            cameras.rows_mut(D * row, D).copy_from(&directions.select_rows(&columns));
        }
        Ok(cameras)
    }
    // ANCHOR_END: null_space

    fn columns_of(&self, index: usize) -> Vec<usize> {
        let coordinates = self.values().coordinates_of(index).unwrap_or_default();
        self.assembly.problem.columns().select(coordinates)
    }

    // ANCHOR: name_free
    /// Names the directions that pixels leave free where the solver stands.
    ///
    /// Each is compared with the seven ways in which a whole scene can move: do the points
    /// all move by a + ω × P + s P?
    ///
    /// # Errors
    ///
    /// [`BaError::Solve`] when it cannot be said what is free.
    pub fn gauge_freedom(&self) -> Result<GaugeFreedom, BaError> {
        let free = self.free()?;
        let fits = self.similarities(&free);
        let rank = |from: usize| match fits.ncols() {
            0 => 0,
            _ => fits.rows(from, 7 - from).into_owned().rank(1e-5),
        };
        let (scale, turning, all) = (rank(6), rank(3), rank(0));
        Ok(GaugeFreedom {
            position: all - turning,
            orientation: turning - scale,
            scale,
            other: free.nullity() - all,
        })
    }
    // ANCHOR_END: name_free

    /// Which sums of the seven ways are free, one a column: three shifts, three turns about the
    /// centre, growth.
    fn similarities(&self, free: &NullSpace) -> DMatrix<f64> {
        let first = self.assembly.landmarks.first().map(|point| self.assembly.points[*point]);
        let first = first.and_then(|point| self.columns_of(point.index()).first().copied());
        let Some(first) = first.filter(|_| free.nullity() > 0) else { return DMatrix::zeros(7, 0) };
        // The landmarks have the last columns, all of them, in order.
        let directions = free.directions();
        let moves = directions.rows(first, directions.nrows() - first).into_owned();
        let ways = self.whole_motions();
        let span = ways.clone().qr().q();
        let outside = &moves - &span * span.tr_mul(&moves);
        let sums = NullSpace::sums_that_vanish(&outside, &moves);
        let fits = ways.svd(true, true).solve(&(moves * sums), 1e-9);
        fits.map_or(DMatrix::zeros(7, 0), |fits| {
            DMatrix::from_fn(7, fits.ncols(), |r, c| fits[(r, c)])
        })
    }

    /// The moves of all landmarks, stacked, in the seven ways, all of about length one.
    fn whole_motions(&self) -> OMatrix<f64, Dyn, U7> {
        let points: Vec<Vector3<f64>> =
            self.assembly.landmarks.iter().map(|point| self.points()[*point]).collect();
        let count = points.len() as f64;
        let centre = points.iter().sum::<Vector3<f64>>() / count;
        let spread = points.iter().map(|p| (p - centre).norm_squared()).sum::<f64>();
        let radius = (spread / count).sqrt().max(f64::MIN_POSITIVE);
        OMatrix::<f64, Dyn, U7>::from_fn(3 * points.len(), |row, way| {
            let arm = (points[row / 3] - centre) / radius;
            let motion = match way {
                0..3 => Vector3::ith(way, 1.0),
                3..6 => Vector3::ith(way - 3, 1.0).cross(&arm),
                _ => arm,
            };
            motion[row % 3] / count.sqrt()
        })
    }

    /// The directions of the Schur complement along which pixels change.
    pub(super) fn seen_directions(&self) -> Result<SeenDirections, BaError> {
        let nullity = self.free()?.nullity();
        let (matrix, rhs) = self.schur_complement(0.0)?;
        if matrix.is_empty() {
            return Ok(SeenDirections { vectors: matrix, values: DVector::zeros(0), rhs });
        }
        let eigen = matrix.symmetric_eigen();
        let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let seen = &order[nullity.min(order.len())..];
        let values = DVector::from_fn(seen.len(), |i, _| eigen.eigenvalues[seen[i]]);
        let vectors =
            DMatrix::from_fn(order.len(), seen.len(), |row, i| eigen.eigenvectors[(row, seen[i])]);
        Ok(SeenDirections { vectors, values, rhs })
    }

    // ANCHOR: minimal_norm
    /// The undamped step that does not move at all along the directions that no pixel
    /// sees: among all the steps that solve the reduced system, the shortest. It is not
    /// taken.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free.
    pub fn minimal_norm_step(&self) -> Result<TrialStep<D>, BaError> {
        let SeenDirections { vectors, values, rhs } = self.seen_directions()?;
        let along = vectors.tr_mul(&rhs);
        let change = &vectors * along.component_div(&values);
        let mut system = self.system();
        let problem = &self.assembly.problem;
        system.schur_complement(0.0).map_err(|s| self.explain(s))?;
        let (step, predicted_decrease) = system.complete(problem, &change, change.dot(&rhs));
        Ok(self.trial(&step, predicted_decrease))
    }
    // ANCHOR_END: minimal_norm

    /// The error that says what is free.
    pub(super) fn explain(&self, singular: Singular) -> BaError {
        if let Singular::Landmark(index) = singular {
            return BaError::Ray { point: self.assembly.landmarks[index] };
        }
        match self.gauge_freedom() {
            // Too weak for the factorization, and yet not exactly free.
            Ok(free) if free.count() == 0 => {
                BaError::RankDeficient { free: GaugeFreedom { other: 1, ..free } }
            }
            Ok(free) => BaError::RankDeficient { free },
            Err(error) => error,
        }
    }
}
