//! The batch of a whole flight, grown from where it was begun.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::Vector3;
use thiserror::Error;

use super::batch::Sighting;
use super::{Batch, BatchError, Sensors};
use crate::datasets::tracks::Picture;
use crate::inertial::{ImuBias, NavState, StampedSample, between};
use crate::least_squares::{Covariance, Kernel, Options, Values};
use crate::preintegration::{LONGEST_STEP, Preintegrated, Rule, preintegrate_stamped};
use crate::two_views::{TriangulationError, View, triangulate, triangulate_nonlinear};

// ANCHOR: whole_options
/// How the batch of a flight is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WholeOptions {
    /// The kernel of the pixels.
    pub kernel: Kernel,
    /// The fewest pictures that must show a landmark.
    pub least_sightings: usize,
    /// The least angle at which two of its rays must meet, in radians.
    pub least_parallax: f64,
    /// How far any of its pixels may be off, in standard deviations.
    pub gate: f64,
    /// By how many seconds the batch grows at a time, or by a sixth of what is known, if that is more.
    pub growth: f64,
    /// The standard deviations of the biases of gyroscope and accelerometer before anything is
    /// known, in rad/s and m/s².
    pub biases: [f64; 2],
    /// The standard deviation of the velocity of a body that stands, in m/s on each axis.
    pub rest_velocity: f64,
}

impl Default for WholeOptions {
    fn default() -> Self {
        Self {
            kernel: Kernel::Huber(1.345),
            least_sightings: 3,
            least_parallax: 0.02,
            gate: 10.0,
            growth: 1.0,
            biases: [0.1, 0.1],
            rest_velocity: 0.01,
        }
    }
}
// ANCHOR_END: whole_options

/// States and biases that are known so far, by picture: a stretch without holes.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// The picture of the first of them.
    pub first: usize,
    /// The states and biases.
    pub states: Vec<(NavState, ImuBias)>,
    /// The pictures that show a body that stands.
    pub standing: Range<usize>,
}

impl Known {
    /// That there is a state, and a picture for each.
    fn fits(&self, pictures: &[Picture]) -> Result<(), BatchError> {
        let (first, states, pictures) = (self.first, self.states.len(), pictures.len());
        let is_within = first.checked_add(states).is_some_and(|end| end <= pictures);
        let fits = states > 0 && is_within;
        fits.then_some(()).ok_or(BatchError::Known { first, states, pictures })
    }
}

/// The batch of a flight at its minimum.
pub struct Whole {
    /// The batch.
    pub batch: Batch,
    /// The most likely values.
    pub values: Values,
    /// Their covariance.
    pub covariance: Covariance,
    /// The tracks that are no landmarks, and why.
    pub refused: BTreeMap<usize, LandmarkRefused>,
}

/// Why a track is no landmark.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LandmarkRefused {
    /// Too few pictures show it.
    #[error("{sightings} pictures show it, and {needed} are needed")]
    Sightings {
        /// How many do.
        sightings: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Its rays give no point.
    #[error(transparent)]
    Rays(#[from] TriangulationError),
    /// One of its pixels is too far off.
    #[error("a pixel is {off:.1} standard deviations off, and {allowed:.1} are allowed")]
    Gate {
        /// How far the worst is off.
        off: f64,
        /// What is allowed.
        allowed: f64,
    },
}

impl Whole {
    // ANCHOR: whole_of
    /// The batch of all pictures, grown from what is known of some: readings carry the states on, and
    /// back before the first; then landmarks are placed, everything is solved, and what does not fit
    /// is refused.
    ///
    /// # Errors
    ///
    /// A [`BatchError`].
    pub fn grown(
        sensors: &Sensors,
        readings: &[StampedSample],
        pictures: &[Picture],
        known: Known,
        options: &WholeOptions,
    ) -> Result<Self, BatchError> {
        Self::grown_with(sensors, readings, pictures, known, options, |_| ())
    }

    /// The same; told is, after each round, how many states are known.
    ///
    /// # Errors
    ///
    /// A [`BatchError`].
    pub fn grown_with(
        sensors: &Sensors,
        readings: &[StampedSample],
        pictures: &[Picture],
        known: Known,
        options: &WholeOptions,
        mut told: impl FnMut(usize),
    ) -> Result<Self, BatchError> {
        known.fits(pictures)?;
        let mut growing = Growing { sensors, readings, pictures, options, known };
        while !growing.extend()? {
            growing.settle(ROUGHLY)?;
            told(growing.known.states.len());
        }
        let (batch, values, refused) = growing.settle(TOLERANCE)?;
        let covariance = batch.covariance(&values)?;
        Ok(Self { batch, values, covariance, refused })
    }
    // ANCHOR_END: whole_of
}

/// A batch at its minimum, and what it refused.
type Settled = (Batch, Values, BTreeMap<usize, LandmarkRefused>);

struct Growing<'a> {
    sensors: &'a Sensors,
    readings: &'a [StampedSample],
    pictures: &'a [Picture],
    options: &'a WholeOptions,
    known: Known,
}

impl Growing<'_> {
    fn nanoseconds(&self, picture: usize) -> i64 {
        self.sensors.rig.imu_nanoseconds(self.pictures[picture].nanoseconds)
    }

    fn sums(&self, from: usize, bias: &ImuBias) -> Result<Preintegrated, BatchError> {
        let [start, end] = [from, from + 1].map(|picture| self.nanoseconds(picture));
        let readings = between(self.readings, start, end)?;
        let noise = &self.sensors.noise;
        Ok(preintegrate_stamped(&readings, Rule::Midpoint, LONGEST_STEP, bias, noise)?)
    }

    // ANCHOR: extend
    /// Carries the known states on and back by the readings, as far as the batch grows at a time.
    /// True when all pictures have a state.
    fn extend(&mut self) -> Result<bool, BatchError> {
        let gravity = self.sensors.gravity();
        let first = self.nanoseconds(self.known.first);
        let known = self.nanoseconds(self.last()).saturating_sub(first);
        let span = ((1e9 * self.options.growth) as i64).max(known / GROWTH_PARTS);
        // At least to the next picture, however late it comes.
        let next = (self.last() + 1).min(self.pictures.len() - 1);
        let until = self.nanoseconds(self.last()).saturating_add(span).max(self.nanoseconds(next));
        while self.last() + 1 < self.pictures.len() && self.nanoseconds(self.last() + 1) <= until {
            let (state, bias) = self.known.states[self.known.states.len() - 1];
            let next = self.sums(self.last(), &bias)?.predict(&state, &gravity, &bias);
            self.known.states.push((next, bias));
        }
        let before = self.known.first.saturating_sub(1);
        let from = self.nanoseconds(self.known.first).saturating_sub(span);
        let from = from.min(self.nanoseconds(before));
        while self.known.first > 0 && self.nanoseconds(self.known.first - 1) >= from {
            let (state, bias) = self.known.states[0];
            let before = self.sums(self.known.first - 1, &bias)?.before(&state, &gravity);
            self.known.states.insert(0, (before, bias));
            self.known.first -= 1;
        }
        Ok(self.known.first == 0 && self.last() + 1 == self.pictures.len())
    }
    // ANCHOR_END: extend

    /// The last picture whose state is known.
    fn last(&self) -> usize {
        self.known.first + self.known.states.len() - 1
    }

    // ANCHOR: whole_solve
    /// Solves for the states that are known so far and the landmarks that follow, and again without
    /// the landmarks that do not fit, until all fit.
    fn settle(&mut self, tolerance: f64) -> Result<Settled, BatchError> {
        let tracks = self.tracks();
        let mut refused = BTreeMap::new();
        let options = Options { decrease_tolerance: tolerance, ..Options::default() };
        loop {
            let batch = self.batch(&tracks, &mut refused)?;
            let values = batch.solve(&options)?.values;
            let pairs = batch.states.iter().zip(&batch.biases);
            self.known.states =
                pairs.map(|(state, bias)| (values[*state], values[*bias])).collect();
            let before = refused.len();
            self.refuse(&batch, &values, &tracks, &mut refused);
            if refused.len() == before {
                return Ok((batch, values, refused));
            }
        }
    }
    // ANCHOR_END: whole_solve

    /// By track, the states that saw it.
    fn tracks(&self) -> BTreeMap<usize, Vec<Sighting>> {
        let mut tracks: BTreeMap<usize, Vec<Sighting>> = BTreeMap::new();
        let pictures = &self.pictures[self.known.first..=self.last()];
        for (state, picture) in pictures.iter().enumerate() {
            for feature in &picture.features {
                tracks.entry(feature.track).or_default().push((state, feature.pixel));
            }
        }
        tracks
    }

    // ANCHOR: whole_batch
    /// The batch of the known states, with every track that gives a landmark.
    fn batch(
        &self,
        tracks: &BTreeMap<usize, Vec<Sighting>>,
        refused: &mut BTreeMap<usize, LandmarkRefused>,
    ) -> Result<Batch, BatchError> {
        let (options, known) = (self.options, &self.known);
        let times: Vec<i64> =
            (known.first..=self.last()).map(|picture| self.nanoseconds(picture)).collect();
        let mut batch = Batch::new(self.sensors, self.readings, &times, &known.states)?;
        batch.fix_gauge()?;
        let ([g, a], free) = (options.biases, [f64::INFINITY; 9]);
        batch.know((known.states[0].0, ImuBias::default()), free, [g, g, g, a, a, a])?;
        for state in (0..times.len()).filter(|at| known.standing.contains(&(known.first + at))) {
            batch.stand_still(state, options.rest_velocity)?;
        }
        for (track, sightings) in tracks {
            if refused.contains_key(track) {
                continue;
            }
            match self.place(sightings) {
                Ok(place) => batch.add_landmark(*track, place, sightings, options.kernel)?,
                Err(why) => {
                    refused.insert(*track, why);
                }
            }
        }
        Ok(batch)
    }
    // ANCHOR_END: whole_batch

    /// Where the landmark of a track is most likely, if the states are right.
    fn place(&self, sightings: &[Sighting]) -> Result<Vector3<f64>, LandmarkRefused> {
        let needed = self.options.least_sightings;
        if sightings.len() < needed {
            return Err(LandmarkRefused::Sightings { sightings: sightings.len(), needed });
        }
        let views: Vec<View> = sightings.iter().map(|seen| self.view(seen)).collect();
        let start = triangulate(&views, self.options.least_parallax)?;
        Ok(triangulate_nonlinear(&views, &start).map_or(start, |found| found.point))
    }

    fn view(&self, &(state, pixel): &Sighting) -> View {
        let Sensors { camera, pixel_sigma, rig, .. } = *self.sensors;
        let camera_from_world = rig.camera_from_world(&self.known.states[state].0);
        View { camera, camera_from_world, pixel, sigma: pixel_sigma }
    }

    // ANCHOR: refuse
    /// Refuses the landmarks of which a pixel is too far off.
    fn refuse(
        &self,
        batch: &Batch,
        values: &Values,
        tracks: &BTreeMap<usize, Vec<Sighting>>,
        refused: &mut BTreeMap<usize, LandmarkRefused>,
    ) {
        let allowed = self.options.gate;
        for (track, landmark) in &batch.landmarks {
            let off = |&(state, pixel): &Sighting| batch.off(values, (state, *landmark), pixel);
            let worst = tracks[track].iter().map(off).fold(0.0, f64::max);
            if worst > allowed {
                refused.insert(*track, LandmarkRefused::Gate { off: worst, allowed });
            }
        }
    }
    // ANCHOR_END: refuse
}

/// A step that lowers the cost by less than this part of it is the last.
const TOLERANCE: f64 = 1e-6;
/// The same while states are still missing.
const ROUGHLY: f64 = 1e-3;
/// A batch grows by one part of so many at a time, if that is more than is asked for.
const GROWTH_PARTS: i64 = 6;
