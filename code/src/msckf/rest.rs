//! A body at rest: no track has parallax, and no picture is worth a pose.

use nalgebra::{DMatrix, DVector};

use super::filter::Turning;
use super::{Msckf, MsckfError, PictureReport, Rest};
use crate::datasets::tracks::Picture;

impl Msckf {
    // ANCHOR: is_at_rest
    /// Whether half of the tracks that go on have moved by less than a body's that moves.
    pub(super) fn is_at_rest(&self, picture: &Picture, rest: &Rest) -> bool {
        let mut moved: Vec<f64> = Vec::new();
        for feature in &picture.features {
            if let Ok(at) = self.last.binary_search_by_key(&feature.track, |f| f.track) {
                moved.push((feature.pixel - self.last[at].pixel).norm());
            }
        }
        let half = moved.len() / 2;
        half > 0 && *moved.select_nth_unstable_by(half, f64::total_cmp).1 < rest.motion
    }
    // ANCHOR_END: is_at_rest

    // ANCHOR: stand_still
    /// Tells the filter that the body neither moves nor turns; the noise of the reading that says how it
    /// turns counts too. The window keeps the poses from which it last moved, and so the parallax of its
    /// tracks.
    pub(super) fn stand_still(
        &mut self,
        rest: &Rest,
        turning: &Turning,
    ) -> Result<PictureReport, MsckfError> {
        let noise = self.options.noise.gyro / turning.seconds.sqrt();
        let sigmas = [rest.velocity_sigma, rest.turning_sigma.hypot(noise)];
        let mut jacobian = DMatrix::zeros(6, self.belief.dimension());
        jacobian.view_mut((0, 3), (3, 3)).fill_diagonal(1.0 / sigmas[0]);
        jacobian.view_mut((3, 9), (3, 3)).fill_diagonal(-1.0 / sigmas[1]);
        let [velocity, turning] = [self.state().velocity / sigmas[0], turning.velocity / sigmas[1]];
        let residual = DVector::from_iterator(6, velocity.iter().chain(&turning).copied());
        let claimed = self.apply(jacobian, &residual)?;
        Ok(PictureReport { at_rest: true, rows: 6, claimed, ..PictureReport::default() })
    }
    // ANCHOR_END: stand_still
}
