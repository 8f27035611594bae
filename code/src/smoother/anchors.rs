//! Landmarks whose anchor leaves.

use nalgebra::Vector3;

use super::window::{Frame, Seen};
use super::{Smoother, SmootherError};
use crate::factors::{AnchorChange, PixelAtAnchor, PixelByAnchor, carried};
use crate::least_squares::{Kernel, Key, ProblemError};

/// How far the landmark by the old anchor may be from that by the new one: without unit, and in 1/m. A
/// pixel is some thousand times as uncertain.
const SAME: f64 = 1e-6;

impl Smoother {
    // ANCHOR: carry_over
    /// Gives the landmarks whose anchor is about to leave to the newest picture that saw them, with their
    /// pixels in all pictures that stay. Of the old landmark there is left what the old anchor and the prior
    /// say of it, and that it is the same place. Returns the old landmarks, which are to be marginalized
    /// with the anchor.
    pub(super) fn carry_over(
        &mut self,
        first: &Frame,
    ) -> Result<Vec<Key<Vector3<f64>>>, SmootherError> {
        let is_of_first = |pixel: &PixelByAnchor| pixel.anchor == first.state;
        let pixels = self.problem.take_factors(self.options.kernel, is_of_first);
        let anchored = self.window.landmarks.iter().map(|(track, seen)| (*track, *seen));
        let anchored = anchored.filter(|(_, seen)| seen.anchor == Some(first.serial));
        let (anchored, mut old): (Vec<_>, _) = (anchored.collect(), Vec::new());
        for (track, seen) in anchored {
            let own = pixels.iter().filter(|pixel| pixel.landmark == seen.landmark);
            let Some((anchor, place)) = self.new_anchor(first, &seen, own.clone()) else {
                for pixel in own {
                    self.problem.add_factor(*pixel, self.options.kernel)?;
                }
                continue;
            };
            let begin = (track, Some(anchor.serial), seen.last);
            let Seen { landmark, .. } =
                self.window.add_landmark(&mut self.problem, begin, place)?;
            self.tie([first, &anchor], [seen.landmark, landmark])?;
            for pixel in own {
                self.add_by(&anchor, landmark, pixel)?;
            }
            old.push(seen.landmark);
        }
        Ok(old)
    }
    // ANCHOR_END: carry_over

    /// The newest picture that saw a landmark, by pixels in the order of their pictures, and the landmark
    /// there; `None` when there is none in front of which it lies.
    fn new_anchor<'a>(
        &self,
        first: &Frame,
        seen: &Seen,
        pixels: impl DoubleEndedIterator<Item = &'a PixelByAnchor>,
    ) -> Option<(Frame, Vector3<f64>)> {
        let values = self.problem.values();
        let known = (&values[self.window.extrinsics], &values[seen.landmark]);
        let from = self.body(first);
        pixels.rev().find_map(|pixel| {
            let frame = self.window.frames.iter().find(|frame| frame.state == pixel.state)?;
            let to = self.body(frame);
            Some((*frame, carried((&from, &to, known.0, known.1))?))
        })
    }

    /// Says that the landmarks of two anchors are one place.
    fn tie(
        &mut self,
        frames: [&Frame; 2],
        landmarks: [Key<Vector3<f64>>; 2],
    ) -> Result<(), ProblemError> {
        let change = AnchorChange {
            anchors: frames.map(|frame| frame.state),
            landmarks,
            extrinsics: self.window.extrinsics,
            time_offset: self.window.delay,
            angular_velocities: frames.map(|frame| frame.turning),
            inverse_sigma: 1.0 / SAME,
        };
        self.problem.add_factor(change, Kernel::Squared)?;
        Ok(())
    }

    /// Adds a pixel once more, of the landmark by its new anchor.
    fn add_by(
        &mut self,
        anchor: &Frame,
        landmark: Key<Vector3<f64>>,
        pixel: &PixelByAnchor,
    ) -> Result<(), ProblemError> {
        let kernel = self.options.kernel;
        if pixel.state == anchor.state {
            let PixelByAnchor { camera, pixel, inverse_sigma, .. } = *pixel;
            let pixel = PixelAtAnchor { landmark, camera, pixel, inverse_sigma };
            self.problem.add_factor(pixel, kernel)?;
        } else {
            let angular_velocities = [anchor.turning, pixel.angular_velocities[1]];
            let anchor = anchor.state;
            let pixel = PixelByAnchor { anchor, landmark, angular_velocities, ..*pixel };
            self.problem.add_factor(pixel, kernel)?;
        }
        Ok(())
    }
}
