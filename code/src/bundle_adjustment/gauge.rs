//! What pixels leave free, and how to name it.

use std::fmt;

use nalgebra::{DMatrix, DVector, Vector3};

use super::{BaError, Camera, Solver, TrialStep};
use crate::least_squares::{LOST_PIVOT, NullSpace};

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
        if names.is_empty() {
            return f.write_str("nothing is free");
        }
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

impl<C: Camera<D>, const D: usize> Solver<C, D> {
    /// What pixels leave free where the solver stands, cameras and points together.
    fn free(&self) -> Result<NullSpace, BaError> {
        let free = self.problem().null_space(self.values())?;
        let columns = self.problem().columns();
        let on_one_ray = |point: &&usize| {
            let own = columns.select(self.coordinates(self.assembly.points[**point].index()));
            free.nullity() > 0 && free.within(own[0]..own[0] + 3) > 0
        };
        match self.assembly.landmarks.iter().find(on_one_ray) {
            Some(point) => Err(BaError::Ray { point: *point }),
            None => Ok(free),
        }
    }

    // ANCHOR: null_space
    /// The small vectors of the cameras, one column for each independent direction, along
    /// which no pixel changes once the points follow: D rows for each of [`Solver::rows`]. The
    /// columns have no particular length.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free, and [`BaError::Solve`] when it cannot be said what is.
    pub fn null_space(&self) -> Result<DMatrix<f64>, BaError> {
        let directions = self.free()?.directions();
        let (columns, rows) = (self.problem().columns(), self.rows());
        let count = rows.iter().flatten().max().map_or(0, |last| last + 1);
        let mut cameras = DMatrix::zeros(D * count, directions.ncols());
        for (camera, row) in self.assembly.cameras.iter().zip(rows) {
            let Some(row) = row else { continue };
            let own = columns.select(self.coordinates(camera.index()));
            cameras.rows_mut(D * row, D).copy_from(&directions.select_rows(&own));
        }
        Ok(cameras)
    }
    // ANCHOR_END: null_space

    /// Names the directions that pixels leave free where the solver stands.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free, and [`BaError::Solve`] when it cannot be said what is.
    pub fn gauge_freedom(&self) -> Result<GaugeFreedom, BaError> {
        Ok(self.named(&self.free()?))
    }

    // ANCHOR: name_free
    /// Compares each free direction with the seven ways in which a whole scene can move: do the
    /// points all move by a + ω × P + s P?
    fn named(&self, free: &NullSpace) -> GaugeFreedom {
        // The landmarks have the last columns, all of them, in order.
        let (directions, coordinates) = (free.directions(), 3 * self.assembly.landmarks.len());
        let moves = directions.rows(directions.nrows() - coordinates, coordinates).into_owned();
        let ways = self.whole_motions().qr().q();
        let within = |count: usize| {
            let span = ways.columns(0, count.min(ways.ncols()));
            let outside = &moves - span * span.tr_mul(&moves);
            NullSpace::sums_that_vanish(&outside, &moves).ncols()
        };
        let [nothing, shifts, turns, all] = [0, 3, 6, 7].map(within);
        GaugeFreedom {
            position: shifts.saturating_sub(nothing),
            orientation: turns.saturating_sub(shifts),
            scale: all.saturating_sub(turns),
            other: free.nullity() - all.saturating_sub(nothing),
        }
    }
    // ANCHOR_END: name_free

    /// The moves of all landmarks, stacked, in the seven ways: three shifts, three turns about the
    /// centre, growth.
    fn whole_motions(&self) -> DMatrix<f64> {
        let points: Vec<Vector3<f64>> =
            self.assembly.landmarks.iter().map(|point| self.points()[*point]).collect();
        let centre = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        DMatrix::from_fn(3 * points.len(), 7, |row, way| {
            let arm = points[row / 3] - centre;
            let motion = match way {
                0..3 => Vector3::ith(way, 1.0),
                3..6 => Vector3::ith(way - 3, 1.0).cross(&arm),
                _ => arm,
            };
            motion[row % 3]
        })
    }

    /// The pseudo-inverse of the Schur complement, and its right-hand side. A stiffness along the
    /// directions that no pixel sees makes it regular, and is taken out again.
    pub(super) fn pseudo_inverse(&self) -> Result<(DMatrix<f64>, DVector<f64>), BaError> {
        let free = self.null_space()?.qr().q();
        let (matrix, rhs) = self.schur_complement(0.0)?;
        let along = free.map(|entry| entry * entry).tr_mul(&matrix.diagonal());
        let stiffness = along.max().max(f64::MIN_POSITIVE);
        let whole = &free * free.transpose();
        let regular = matrix + stiffness * &whole;
        let diagonal = regular.diagonal();
        let factor = regular.cholesky().ok_or_else(|| self.explain_points())?;
        let roots = factor.l_dirty().diagonal();
        if roots.iter().zip(&diagonal).any(|(root, all)| root * root <= LOST_PIVOT * all) {
            return Err(self.explain_points());
        }
        Ok((factor.inverse() - whole / stiffness, rhs))
    }

    // ANCHOR: minimal_norm
    /// The undamped step that does not move at all along the directions that no pixel
    /// sees: among all the steps that solve the reduced system, the shortest. It is not
    /// taken.
    ///
    /// # Errors
    ///
    /// As those of [`Solver::minimal_norm_covariance`].
    pub fn minimal_norm_step(&self) -> Result<TrialStep<D>, BaError> {
        let (inverse, rhs) = self.pseudo_inverse()?;
        let change = inverse * &rhs;
        let mut system = self.system();
        let eliminated = system.eliminate_all(0.0);
        eliminated.map_err(|_| self.explain_points())?;
        let (step, predicted_decrease) = system.complete(self.problem(), &change, change.dot(&rhs));
        Ok(self.trial(&step, predicted_decrease))
    }
    // ANCHOR_END: minimal_norm

    /// The error that says why points cannot be eliminated, or what rounding has lost of the cameras, whatever is
    /// free beside them.
    pub(super) fn explain_points(&self) -> BaError {
        self.free().map_or_else(|error| error, |free| free.lost_to_rounding().into())
    }

    /// The error that says what is free.
    pub(super) fn explain(&self) -> BaError {
        match self.free() {
            Ok(free) if free.nullity() == 0 => free.undetermined().into(),
            Ok(free) => BaError::RankDeficient { free: self.named(&free) },
            Err(error) => error,
        }
    }
}
