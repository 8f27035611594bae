//! Before a flight has begun.

use super::OdometryOptions;
use crate::datasets::tracks::Picture;
use crate::inertial::StampedSample;
use crate::initialization::{Beginning, StartSearch};
use crate::msckf::Start;

/// What has come while no estimator follows.
#[derive(Debug)]
pub(super) struct Waiting {
    search: StartSearch,
    /// What was found when the search looked at pictures again.
    found: Option<Beginning>,
    /// The time of the first picture that it looked at, in nanoseconds.
    since: Option<i64>,
    pub readings: Vec<StampedSample>,
    pub pictures: Vec<Picture>,
}

impl Waiting {
    pub fn new(options: &OdometryOptions) -> Self {
        let search = StartSearch::new(options.sensors, options.begin.clone());
        Self { search, found: None, since: None, readings: Vec::new(), pictures: Vec::new() }
    }

    // ANCHOR: waiting
    /// Looks for a beginning with one picture more. Of one from before the first reading nothing can begin.
    pub fn look(&mut self, picture: &Picture, options: &OdometryOptions) -> Option<Beginning> {
        let time = options.sensors.rig.imu_nanoseconds(picture.nanoseconds);
        if self.readings.first().is_none_or(|first| time < first.nanoseconds) {
            return None;
        }
        self.pictures.push(picture.clone());
        let since = *self.since.get_or_insert(picture.nanoseconds);
        let found =
            self.found.take().or_else(|| self.search.look(&self.readings, &self.pictures))?;
        let forgotten = 1e-9 * self.pictures[0].nanoseconds.saturating_sub(since) as f64;
        Some(Beginning { seconds: found.seconds + forgotten, ..found })
    }

    /// What is known of the body while it stands.
    pub fn stand(&self) -> Option<&Start> {
        self.search.stand()
    }

    /// Takes a reading. Where no picture comes, it is not kept for ever either.
    pub fn reading(&mut self, reading: StampedSample, options: &OdometryOptions) {
        self.readings.push(reading);
        let (now, kept) = (reading.nanoseconds, Self::kept(options));
        if now.saturating_sub(self.readings[0].nanoseconds) >= kept.saturating_mul(4) {
            let from = options.sensors.rig.camera_nanoseconds(now).saturating_sub(kept);
            self.keep_from(from, options);
        }
    }

    /// Forgets what is too old for a beginning, and looks again at what is left. So it takes no more
    /// memory, however long a body stands or a flight has no beginning.
    pub fn forget(&mut self, options: &OdometryOptions) {
        let kept = Self::kept(options);
        let Some(last) = self.pictures.last().map(|picture| picture.nanoseconds) else { return };
        if last.saturating_sub(self.pictures[0].nanoseconds) >= kept.saturating_mul(3) {
            self.keep_from(last.saturating_sub(kept), options);
        }
    }

    /// For how long something is kept, in nanoseconds.
    fn kept(options: &OdometryOptions) -> i64 {
        (1e9 * (options.begin.longest() + 0.5)) as i64
    }

    /// Keeps what comes from a time of the camera's clock on.
    fn keep_from(&mut self, from: i64, options: &OdometryOptions) {
        self.pictures.retain(|picture| picture.nanoseconds >= from);
        let first = self.pictures.first().map_or(from, |picture| picture.nanoseconds);
        let first = options.sensors.rig.imu_nanoseconds(first);
        let before = self.readings.partition_point(|reading| reading.nanoseconds <= first);
        self.readings.drain(..before.saturating_sub(1));
        self.search = StartSearch::new(options.sensors, options.begin.clone());
        let (search, readings) = (&mut self.search, &self.readings);
        let mut looked_at = (1..=self.pictures.len()).map(|until| &self.pictures[..until]);
        self.found = looked_at.find_map(|pictures| search.look(readings, pictures));
    }
    // ANCHOR_END: waiting
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::initialization::{Sensors, begin};
    use crate::odometry::Estimator;
    use crate::simulation::{Flight, Trajectory};

    #[test]
    fn a_search_that_is_rebuilt_keeps_what_it_finds_with_the_last_picture_too() {
        let new = Flight::new(Trajectory::figure_eight());
        let flight = Flight { seconds: 4.0, tracks: 40, picture_rate: 5.0, ..new };
        let recording = flight.record(&flight.room(3.0, 400, 1).unwrap(), 1).unwrap();
        let (readings, pictures) = (&recording.readings, &recording.pictures);
        let options = OdometryOptions::new(Sensors::of_flight(&flight), Estimator::Msckf);
        let begun = begin(&options.sensors, readings, pictures, &options.begin).unwrap();
        let found = begun.known.first;
        assert!(found + 1 < pictures.len());
        let mut waiting = Waiting::new(&options);
        waiting.readings.clone_from(readings);
        waiting.pictures = pictures[..=found].to_vec();
        waiting.since = Some(pictures[0].nanoseconds - 3_000_000_000);
        waiting.keep_from(pictures[0].nanoseconds, &options);
        let kept = waiting.look(&pictures[found + 1], &options).unwrap();
        assert_eq!(kept.known.first, found);
        assert_eq!(kept.seconds, begun.seconds + 3.0, "what was forgotten counts");
    }
}
