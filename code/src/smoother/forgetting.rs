//! The oldest picture leaves.

use super::{Smoother, SmootherError};
use crate::least_squares::Fronts;

impl Smoother {
    // ANCHOR: forget
    /// Marginalizes the oldest picture, and the landmarks that nothing in the window sees any more.
    pub(super) fn forget_first(&mut self) -> Result<(), SmootherError> {
        let Some(first) = self.window.frames.front().copied() else { return Ok(()) };
        let ended = self.window.landmarks.iter().filter(|(_, seen)| seen.last <= first.serial);
        let (tracks, landmarks): (Vec<usize>, Vec<usize>) =
            ended.map(|(track, seen)| (*track, seen.landmark.index())).unzip();
        let gone: Vec<usize> =
            landmarks.into_iter().chain([first.state.index(), first.bias.index()]).collect();
        let values = self.problem.values().clone();
        self.problem.marginalize(&values, &gone)?;
        if self.options.frozen {
            self.problem.freeze_priors();
        }
        self.window.drop_first(&tracks);
        Ok(())
    }
    // ANCHOR_END: forget

    /// States and biases from the oldest to the newest, and each landmark before the last state that
    /// sees it: the order in which the window is eliminated.
    pub(super) fn order(&self) -> Result<Vec<usize>, SmootherError> {
        let frames = self.window.frames.iter();
        let trunk: Vec<usize> =
            frames.flat_map(|frame| [frame.state.index(), frame.bias.index()]).collect();
        Ok(Fronts::order_along(&self.problem, &trunk)?)
    }
}
