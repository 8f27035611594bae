//! What a track says of the poses that saw it, and of its landmark.

use nalgebra::{Isometry3, Matrix3, SMatrix, Vector2, Vector3};
use thiserror::Error;

use super::Rows;
use crate::factors::BodyPixel;
use crate::inertial::BodyPose;
use crate::reprojection::Pinhole;

// ANCHOR: sight
/// A pixel of a track, and from where it was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The body when the picture was taken, as the filter has it.
    pub pose: BodyPose,
    /// Where derivatives are taken: the same pose, or its first estimate.
    pub linearized_at: BodyPose,
    /// The measured pixel.
    pub pixel: Vector2<f64>,
}
// ANCHOR_END: sight

// ANCHOR: linearized_track
/// The whitened rows of a track, two for each sight: the three derivatives by its landmark, then
/// six (φ, p) for each pose in the order of the sights, then six by `body_from_camera`, and last of
/// all the residual.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LinearizedTrack {
    rows: Rows,
}
// ANCHOR_END: linearized_track

impl LinearizedTrack {
    // ANCHOR: linearize_track
    /// Linearizes all pixels of a track, in the memory that this value has.
    ///
    /// # Errors
    ///
    /// [`TrackError::Behind`] when the landmark is not in front of a camera that saw it.
    pub fn linearize(
        &mut self,
        sights: &[Sight],
        landmark: &Vector3<f64>,
        body_from_camera: &Isometry3<f64>,
        camera: (&Pinhole, f64),
    ) -> Result<(), TrackError> {
        self.linearize_at(sights, [landmark; 2], body_from_camera, camera)
    }

    /// The same for a landmark whose derivatives are taken at another place, the second one.
    ///
    /// # Errors
    ///
    /// As [`LinearizedTrack::linearize`].
    pub fn linearize_at(
        &mut self,
        sights: &[Sight],
        [landmark, at_landmark]: [&Vector3<f64>; 2],
        body_from_camera: &Isometry3<f64>,
        (camera, sigma): (&Pinhole, f64),
    ) -> Result<(), TrackError> {
        let width = 3 + 6 * sights.len() + 6 + 1;
        self.rows.clear(width);
        for (sight, &Sight { pose, linearized_at, pixel }) in sights.iter().enumerate() {
            let seen = BodyPixel { camera, pixel, inverse_sigma: 1.0 / sigma };
            let at = |pose: &BodyPose, landmark: &Vector3<f64>| {
                let linear = seen.linearize((pose, landmark, body_from_camera));
                linear.ok_or(TrackError::Behind { sight })
            };
            let (residual, jacobians) = at(&pose, landmark)?;
            let (by_pose, by_landmark, by_camera) =
                match pose == linearized_at && landmark == at_landmark {
                    true => jacobians,
                    false => at(&linearized_at, at_landmark)?.1,
                };
            for axis in 0..2 {
                let row = self.rows.add();
                let mut put = |from: usize, numbers: &[f64]| {
                    row[from..from + numbers.len()].copy_from_slice(numbers);
                };
                put(0, &entries(&by_landmark, axis));
                put(3 + 6 * sight, &entries(&by_pose, axis));
                put(width - 7, &entries(&by_camera, axis));
                put(width - 1, &[residual[axis]]);
            }
        }
        Ok(())
    }
    // ANCHOR_END: linearize_track

    // ANCHOR: project
    /// Turns the rows by rotations of Givens until only the first three name the landmark. The
    /// others are what the track says of the poses, whatever the landmark may be: their noise is
    /// still white, because only rotations were used, and no null space was written down.
    /// Implements {eq:track-projected}.
    ///
    /// # Errors
    ///
    /// [`TrackError::Rank`] when the landmark stays uncertain in some direction by more than
    /// `largest_sigma` metres even with all poses known, {eq:landmark-sigma}. The rows were then
    /// linearized at a landmark that may be anywhere.
    pub fn project(&mut self, largest_sigma: f64) -> Result<(), TrackError> {
        for column in 0..3 {
            for row in (column + 1..self.rows.len()).rev() {
                let first = (row - 1).saturating_sub(column) / 2;
                self.rows.rotate(row, column, 3 + 6 * first);
            }
        }
        let singular_values = self.landmark_root().singular_values();
        let sigma = 1.0 / singular_values.min();
        let is_seen = self.rows.len() >= 3 && sigma <= largest_sigma;
        is_seen.then_some(()).ok_or(TrackError::Rank { sigma, largest: largest_sigma })
    }
    // ANCHOR_END: project

    /// After [`LinearizedTrack::project`], the 3×3 triangle by which the first three rows name the
    /// landmark: the root of its information if the poses were known.
    pub fn landmark_root(&self) -> Matrix3<f64> {
        let known = self.rows.len().min(3);
        Matrix3::from_fn(|row, column| if row < known { self.rows.row(row)[column] } else { 0.0 })
    }

    /// All rows, whose columns are described at the type.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// After [`LinearizedTrack::project`], the rows that name no landmark, without its columns.
    pub fn constraints(&self) -> impl Iterator<Item = &[f64]> {
        self.rows.from(3.min(self.rows.len())).map(|row| &row[3..])
    }
}

pub(super) fn entries<const N: usize>(matrix: &SMatrix<f64, 2, N>, row: usize) -> [f64; N] {
    std::array::from_fn(|column| matrix[(row, column)])
}

/// Why a track says nothing of the poses.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TrackError {
    /// The landmark is not in front of a camera.
    #[error("the landmark is not in front of the camera of sight {sight}; leave the track out")]
    Behind {
        /// Which sight, counted from zero.
        sight: usize,
    },
    /// The pixels do not say where the landmark is.
    #[error(
        "the landmark is known to {sigma:.1} m at best, and {largest:.1} m are allowed; leave the \
         track out, or wait for more parallax"
    )]
    Rank {
        /// Its largest standard deviation if the poses were known, in metres.
        sigma: f64,
        /// The largest that is allowed.
        largest: f64,
    },
}
