//! The oldest picture leaves.

use super::window::Seen;
use super::{Parametrization, Smoother, SmootherError};
use crate::least_squares::{Fronts, Key};

impl Smoother {
    // ANCHOR: forget
    /// Marginalizes the oldest picture, the landmarks that nothing in the window sees any more, and those
    /// that it is the anchor of.
    pub(super) fn forget_first(&mut self) -> Result<(), SmootherError> {
        let Some(first) = self.window.frames.front().copied() else { return Ok(()) };
        let carries = matches!(
            self.options.landmarks,
            Parametrization::InverseDepth { is_carried: true, .. }
        );
        let old = if carries { self.carry_over(&first)? } else { Vec::new() };
        let goes = |seen: &Seen| seen.last <= first.serial || seen.anchor == Some(first.serial);
        let ended = self.window.landmarks.iter().filter(|(_, seen)| goes(seen));
        let (tracks, landmarks): (Vec<usize>, Vec<usize>) =
            ended.map(|(track, seen)| (*track, seen.landmark.index())).unzip();
        let gone = old.iter().map(Key::index).chain(landmarks);
        let gone: Vec<usize> = gone.chain([first.state.index(), first.bias.index()]).collect();
        let values = self.problem.values().clone();
        self.problem.marginalize(&values, &gone)?;
        if self.options.frozen {
            self.problem.freeze_priors();
        }
        self.window.drop_first(&tracks, &old);
        Ok(())
    }
    // ANCHOR_END: forget

    /// States and biases from the oldest to the newest, and each landmark before the last state that
    /// sees it: the order in which the window is eliminated. Anchored landmarks come first, as each of them
    /// couples the states that see it with its anchor.
    pub(super) fn order(&self) -> Result<Vec<usize>, SmootherError> {
        let frames = self.window.frames.iter();
        let trunk: Vec<usize> =
            frames.flat_map(|frame| [frame.state.index(), frame.bias.index()]).collect();
        match self.options.landmarks {
            Parametrization::Point => Ok(Fronts::order_along(&self.problem, &trunk)?),
            Parametrization::InverseDepth { .. } => {
                let landmarks = self.window.landmarks.values().map(|seen| seen.landmark.index());
                Ok(landmarks.chain(trunk).collect())
            }
        }
    }
}
