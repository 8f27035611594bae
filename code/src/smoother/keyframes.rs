//! Which pictures stay in the window.

use super::options::Keyframes;
use super::window::Frame;
use super::{Smoother, SmootherError};
use crate::datasets::tracks::{Feature, Picture};

impl Smoother {
    // ANCHOR: is_keyframe
    /// Whether a picture at a time, on the sensor's clock, stays when the next one comes.
    pub(super) fn is_keyframe(&self, nanoseconds: i64, picture: &Picture) -> bool {
        let Keyframes::Moved { pixels, most_seconds } = self.options.keyframes else { return true };
        let since = self.last_keyframe().nanoseconds;
        let seconds = 1e-9 * nanoseconds.saturating_sub(since) as f64;
        seconds >= most_seconds || have_moved(&self.window.shown, &picture.features, pixels)
    }
    // ANCHOR_END: is_keyframe

    // ANCHOR: pass
    /// Lets the newest picture go without a trace when it is no keyframe: its state, the pixels that it
    /// saw, and the sums of the readings that led to it, which the next one counts anew from the last
    /// keyframe on. No prior names it, because only keyframes make older ones leave. Returns how many
    /// pixels went.
    pub(super) fn let_pass(&mut self) -> usize {
        let newest = self.newest();
        if newest.is_keyframe {
            return 0;
        }
        let before = self.problem.len();
        self.problem.forget(&[newest.state.index(), newest.bias.index()]);
        self.window.drop_last();
        // One of the factors was that of the readings.
        (before - self.problem.len()).saturating_sub(1)
    }
    // ANCHOR_END: pass

    // ANCHOR: keep
    /// Lets what is older than the lag go, now that a keyframe is there to stay, with the readings that
    /// led to it, and notes what it showed.
    pub(super) fn keep(&mut self, picture: &Picture) -> Result<(), SmootherError> {
        let nanoseconds = self.newest().nanoseconds;
        self.window.shown.clone_from(&picture.features);
        let before = self.readings.partition_point(|reading| reading.nanoseconds <= nanoseconds);
        self.readings.drain(..before.saturating_sub(1));
        let lag = (1e9 * self.options.lag).round() as i64;
        let is_old = |frame: &Frame| nanoseconds.saturating_sub(frame.nanoseconds) >= lag;
        while self.window.frames.len() > 2 && is_old(&self.window.frames[1]) {
            self.forget_first()?;
        }
        Ok(())
    }
    // ANCHOR_END: keep
}

/// Whether at least half of the tracks that both pictures show have moved by so many pixels, or there
/// are none.
fn have_moved(before: &[Feature], now: &[Feature], pixels: f64) -> bool {
    let (mut moved, mut common) = (0, 0);
    for feature in now {
        let Ok(place) = before.binary_search_by_key(&feature.track, |known| known.track) else {
            continue;
        };
        common += 1;
        moved += usize::from((feature.pixel - before[place].pixel).norm() >= pixels);
    }
    2 * moved >= common
}
