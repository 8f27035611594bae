//! What pixels leave free, and how to name it.

use std::fmt;

use nalgebra::{DMatrix, DVector, Dyn, OMatrix, SVector, U7, Vector3};

use super::system::Singular;
use super::{BaError, Camera, Solver, Step};

// ANCHOR: free_directions
/// How many independent directions of each kind are free: moved along one of them, cameras
/// and points together change no pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FreeDirections {
    /// The whole moves: at most three.
    pub position: usize,
    /// The whole turns: at most three.
    pub orientation: usize,
    /// The whole grows: at most one.
    pub scale: usize,
    /// Anything else, such as a camera that sees too little.
    pub other: usize,
}

impl FreeDirections {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.position + self.orientation + self.scale + self.other
    }
}
// ANCHOR_END: free_directions

impl fmt::Display for FreeDirections {
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

/// Eigenvalues below this, in a system whose blocks have a unit diagonal before
/// elimination, are zero.
const NULL: f64 = 1e-10;

impl<C: Camera<D>, const D: usize> Solver<C, D> {
    /// The reduced system as a dense matrix with its right-hand side: D rows for each of
    /// [`Solver::rows`].
    ///
    /// Implements {eq:reduced-camera-system}, and {eq:damped-reduction} with a damping.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free, which needs a damping of zero.
    pub fn reduced_system(
        &mut self,
        damping: f64,
    ) -> Result<(DMatrix<f64>, DVector<f64>), BaError> {
        self.eliminate(damping).map_err(|singular| self.explain(singular))?;
        let rhs = DVector::from_column_slice(self.system.rhs.as_flattened());
        if !self.system.curvature.as_flattened().iter().all(|entry| entry.is_finite()) {
            return Err(BaError::Overflow);
        }
        Ok((self.system.reduced.to_matrix(), rhs))
    }

    /// The small vectors of the rigs, one column for each independent direction, along
    /// which no pixel changes once the points follow. The columns have no particular
    /// length.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free.
    // ANCHOR: null_space
    pub fn null_space(&mut self) -> Result<DMatrix<f64>, BaError> {
        let (mut matrix, _) = self.reduced_system(0.0)?;
        if matrix.is_empty() {
            return Ok(matrix);
        }
        // Metres, radians and pixels are not comparable; in the unit of each coordinate's
        // own curvature they are.
        let curvature = DVector::from_column_slice(self.system.curvature.as_flattened());
        let unit = curvature.map(|c| if c > 0.0 { 1.0 / c.sqrt() } else { 1.0 });
        for (row, column) in (0..unit.len()).flat_map(|r| (0..unit.len()).map(move |c| (r, c))) {
            matrix[(row, column)] *= unit[row] * unit[column];
        }
        let eigen = matrix.symmetric_eigen();
        let null = (0..unit.len()).filter(|i| eigen.eigenvalues[*i] < NULL);
        let columns: Vec<_> =
            null.map(|i| eigen.eigenvectors.column(i).component_mul(&unit)).collect();
        if columns.is_empty() {
            return Ok(DMatrix::zeros(unit.len(), 0));
        }
        Ok(DMatrix::from_columns(&columns))
    }
    // ANCHOR_END: null_space

    /// Names the directions that pixels leave free where the solver stands.
    ///
    /// Each is compared with the seven ways in which a whole scene can move: do the points
    /// all move by a + ω × P + s P?
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free.
    // ANCHOR: name_free
    pub fn free_directions(&mut self) -> Result<FreeDirections, BaError> {
        let null_space = self.null_space()?;
        let fits = self.similarities(&null_space);
        let rank = |from: usize| match fits.ncols() {
            0 => 0,
            _ => fits.rows(from, 7 - from).into_owned().rank(1e-5),
        };
        let (scale, turning, all) = (rank(6), rank(3), rank(0));
        Ok(FreeDirections {
            position: all - turning,
            orientation: turning - scale,
            scale,
            other: null_space.ncols() - all,
        })
    }
    // ANCHOR_END: name_free

    /// The directions that are nothing but a motion of the whole scene, one a column: three
    /// shifts, three turns about the centre, growth.
    fn similarities(&mut self, null_space: &DMatrix<f64>) -> DMatrix<f64> {
        if null_space.is_empty() {
            return DMatrix::zeros(7, 0);
        }
        let ways = self.whole_motions();
        let decomposition = ways.clone().svd(true, true);
        let mut fits = Vec::new();
        for direction in null_space.column_iter() {
            let moves = self.point_moves(&direction.into_owned());
            let unit = moves.unscale(moves.norm().max(f64::MIN_POSITIVE));
            let fit = decomposition.solve(&unit, 1e-9).unwrap_or_else(|_| SVector::zeros());
            if (&ways * fit - &unit).norm() < 1e-4 * unit.norm() {
                fits.push(fit);
            }
        }
        DMatrix::from_fn(7, fits.len(), |row, column| fits[column][row])
    }

    /// The moves of all landmarks, stacked, in the seven ways, all of about length one.
    fn whole_motions(&self) -> OMatrix<f64, Dyn, U7> {
        let points: Vec<Vector3<f64>> =
            self.layout.landmarks.iter().map(|landmark| self.points()[landmark.point]).collect();
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

    /// How the landmarks move, stacked, when the rigs move by this and nothing else pulls.
    fn point_moves(&mut self, rigs: &DVector<f64>) -> DVector<f64> {
        self.system.rhs.as_flattened_mut().copy_from_slice(rigs.as_slice());
        let mut moves = DVector::zeros(3 * self.layout.landmarks.len());
        for index in 0..self.layout.landmarks.len() {
            self.system.eliminated[index].forward = Vector3::zeros();
            let change = self.landmark_step(index);
            moves.fixed_rows_mut::<3>(3 * index).copy_from(&change);
        }
        moves
    }

    /// Eigenvectors of the reduced system with an eigenvalue that is not zero, and these.
    pub(super) fn seen_directions(&mut self) -> Result<(DMatrix<f64>, DVector<f64>), BaError> {
        let nullity = self.null_space()?.ncols();
        let matrix = self.system.reduced.to_matrix();
        if matrix.is_empty() {
            return Ok((matrix, DVector::zeros(0)));
        }
        let eigen = matrix.symmetric_eigen();
        let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let seen = &order[nullity..];
        let values = DVector::from_fn(seen.len(), |i, _| eigen.eigenvalues[seen[i]]);
        let vectors =
            DMatrix::from_fn(order.len(), seen.len(), |row, i| eigen.eigenvectors[(row, seen[i])]);
        Ok((vectors, values))
    }

    // ANCHOR: minimal_norm
    /// The undamped step that does not move at all along the directions that no pixel
    /// sees: among all the steps that solve the reduced system, the shortest. It is not
    /// taken.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free.
    pub fn minimal_norm_step(&mut self) -> Result<Step<D>, BaError> {
        let (seen, values) = self.seen_directions()?;
        let rhs = DVector::from_column_slice(self.system.rhs.as_flattened());
        let along = seen.tr_mul(&rhs);
        let change = &seen * along.component_div(&values);
        let forward = change.dot(&rhs);
        self.system.rhs.as_flattened_mut().copy_from_slice(change.as_slice());
        Ok(self.complete_step(forward))
    }
    // ANCHOR_END: minimal_norm

    /// The error that says what is free.
    pub(super) fn explain(&mut self, singular: Singular) -> BaError {
        if let Singular::Landmark(index) = singular {
            return BaError::Ray { point: self.layout.landmarks[index].point };
        }
        match self.free_directions() {
            // Too weak for the factorization, and yet not exactly free.
            Ok(free) if free.count() == 0 => {
                BaError::RankDeficient { free: FreeDirections { other: 1, ..free } }
            }
            Ok(free) => BaError::RankDeficient { free },
            Err(error) => error,
        }
    }
}
