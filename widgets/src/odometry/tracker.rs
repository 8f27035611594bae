//! A tracker that does not hold on to a landmark for ever.

use std::collections::BTreeMap;

use vislam::datasets::tracks::{Feature, Picture};

use super::setting::Setting;

/// What the tracks of the simulation are to whoever sees them for some pictures only.
#[derive(Default)]
pub struct Tracker {
    /// Of each track, its name now and how many pictures have shown it by that.
    names: Vec<(usize, usize)>,
    named: usize,
}

impl Tracker {
    /// A picture as the estimator gets it, taken after so many seconds.
    pub fn shown(
        &mut self,
        picture: &Picture,
        (number, seconds): (usize, f64),
        setting: &Setting,
    ) -> Picture {
        let mut features = BTreeMap::new();
        for (place, feature) in picture.features.iter().enumerate() {
            let off = setting.off(seconds, number, place).unwrap_or_default();
            let track = self.name(feature.track, setting.track);
            features.insert(track, Feature { track, pixel: feature.pixel + off, ..*feature });
        }
        Picture { nanoseconds: picture.nanoseconds, features: features.into_values().collect() }
    }

    /// The name of a track in one picture more.
    fn name(&mut self, track: usize, longest: usize) -> usize {
        if self.names.len() <= track {
            self.names.resize(track + 1, (0, longest));
        }
        let (name, seen) = &mut self.names[track];
        if *seen >= longest {
            (*name, *seen) = (self.named, 0);
            self.named += 1;
        }
        *seen += 1;
        *name
    }
}
