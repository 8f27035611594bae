//! Which start it is to be.

use std::ops::Range;

use super::{Known, MotionOptions, NoStart, RestOptions, Sensors, Started, at_rest, in_motion};
use crate::datasets::tracks::Picture;
use crate::inertial::{NavState, StampedSample};
use crate::msckf::Start;
use crate::observability::Similarity;

// ANCHOR: begin_options
/// Looks for a start in motion, as [`in_motion`] does.
pub type InMotion =
    fn(&Sensors, &[StampedSample], &[Picture], &MotionOptions) -> Result<Started, NoStart>;

/// How a beginning is looked for.
#[derive(Debug, Clone)]
pub struct BeginOptions {
    /// How a stand is judged.
    pub rest: RestOptions,
    /// What looks for a start in motion; without it a flight begins when its body stands.
    pub in_motion: Option<InMotion>,
    /// How a start in motion is judged.
    pub motion: MotionOptions,
    /// How long a body must stand, in seconds.
    pub stand: f64,
    /// Spans of pictures to try for a start in motion, in seconds.
    pub spans: Vec<f64>,
    /// About how many pictures of a span are used in a second: up to a ninth more where they come a
    /// little early.
    pub rate: f64,
}

impl Default for BeginOptions {
    fn default() -> Self {
        Self { in_motion: Some(in_motion), spans: vec![1.5, 2.0, 3.0, 4.0], ..Self::at_rest() }
    }
}
// ANCHOR_END: begin_options

impl BeginOptions {
    /// So many seconds of pictures a beginning needs at most: two windows that stand, or the longest span.
    pub fn longest(&self) -> f64 {
        self.spans.iter().copied().fold(1.5 * self.stand, f64::max)
    }

    /// The shortest span to be tried, in seconds; infinite when there is none.
    fn shortest(&self) -> f64 {
        self.spans.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// After so many seconds spans are tried again.
    fn step(&self) -> f64 {
        self.shortest() / 3.0
    }

    /// A beginning at rest alone, for as long as it takes until the body stands. A program that uses no other
    /// is smaller by all that finds a motion in pictures.
    pub fn at_rest() -> Self {
        Self {
            rest: RestOptions::default(),
            in_motion: None,
            motion: MotionOptions::default(),
            stand: 1.0,
            spans: Vec::new(),
            rate: 5.0,
        }
    }
}

/// A beginning of a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Beginning {
    /// What is known of some of its pictures.
    pub known: Known,
    /// Seconds from the first picture to the last of which something is known; for a start in motion, to
    /// the last with which it was looked for.
    pub seconds: f64,
    /// The standard deviation of the scale, as a part of it. A body that stands has none.
    pub scale_sigma: Option<f64>,
    /// The last picture of which something is known, and what a filter begins with there.
    pub start: (usize, Start),
    /// The time on the sensor's clock, in nanoseconds, and the state by which the origin of the world and its
    /// heading were chosen: of this state's place and yaw nothing can be wrong.
    pub origin: (i64, NavState),
}

impl Beginning {
    /// What takes the world of this beginning to one in which the state of its origin was `truth`.
    pub fn to_world_of(&self, truth: &NavState) -> Similarity {
        Similarity::between(&self.origin.1, truth)
    }
}

// ANCHOR: begin
/// Begins a flight: at rest for as long as its body stands from the first picture on, otherwise in
/// motion as soon as some span of pictures is enough.
///
/// # Errors
///
/// The [`NoStart`] of the last span, when none is enough.
pub fn begin(
    sensors: &Sensors,
    readings: &[StampedSample],
    pictures: &[Picture],
    options: &BeginOptions,
) -> Result<Beginning, NoStart> {
    let mut search = StartSearch::new(*sensors, options.clone());
    for until in 1..=pictures.len() {
        if let Some(beginning) = search.look(readings, &pictures[..until]) {
            return Ok(beginning);
        }
    }
    search.at_the_end(pictures)
}
// ANCHOR_END: begin

// ANCHOR: start_search
/// Looks for the beginning of a flight while its pictures come.
#[derive(Debug, Clone)]
pub struct StartSearch {
    sensors: Sensors,
    options: BeginOptions,
    /// The first picture of the window in which a stand is looked for; `None` when the body has moved.
    window: Option<usize>,
    /// The pictures of a stand until the last window's end, and what is known there, if that stands.
    last: Option<(Range<usize>, Start)>,
    /// The same of the last window after which the next one stands too.
    stand: Option<(Range<usize>, Start)>,
    /// Seconds at which a start in motion was looked for last.
    tried: f64,
    last_error: Option<NoStart>,
}

impl StartSearch {
    /// A search that has seen nothing yet.
    pub fn new(sensors: Sensors, options: BeginOptions) -> Self {
        let window = Some(0);
        Self { sensors, options, window, last: None, stand: None, tried: 0.0, last_error: None }
    }

    /// Looks at all pictures so far, one more than the last time, with the readings that reach their
    /// last one.
    pub fn look(&mut self, readings: &[StampedSample], pictures: &[Picture]) -> Option<Beginning> {
        if self.stands(readings, pictures) {
            return None;
        }
        match self.stand {
            Some(_) => self.at_the_end(pictures).ok(),
            None => self.moves(readings, pictures),
        }
    }

    /// What is known when no picture comes any more.
    ///
    /// # Errors
    ///
    /// The [`NoStart`] of the last span, when the body did not stand.
    pub fn at_the_end(&self, pictures: &[Picture]) -> Result<Beginning, NoStart> {
        let too_short = || match self.options.in_motion {
            Some(_) if !self.options.spans.is_empty() => {
                let seconds = self.options.stand.max(self.options.shortest() + self.options.step());
                NoStart::TooShort { pictures: pictures.len(), seconds }
            }
            _ => NoStart::NoStand { seconds: self.options.stand },
        };
        match self.stand.as_ref().or(self.last.as_ref()) {
            Some((stand, start)) => Ok(standing(stand, start, pictures)),
            None => Err(self.last_error.clone().unwrap_or_else(too_short)),
        }
    }

    /// What is known while the body stands.
    pub fn stand(&self) -> Option<&Start> {
        self.stand.as_ref().map(|(_, start)| start)
    }
    // ANCHOR_END: start_search

    // ANCHOR: standing
    /// Whether nothing has moved so far: in windows of pictures, each as long as a body must stand and
    /// beginning in the middle of the one before. A window may end with a body that has just set out, too little
    /// to be seen; so what it says counts when the next one stands as well. Where no start in motion is looked for,
    /// nothing has moved until it has stood.
    fn stands(&mut self, readings: &[StampedSample], pictures: &[Picture]) -> bool {
        let after = |from: usize, seconds: f64| {
            let begin = pictures.get(from)?.nanoseconds;
            let time = begin.saturating_add((1e9 * seconds) as i64);
            (from..pictures.len()).find(|picture| pictures[*picture].nanoseconds >= time)
        };
        while let Some(from) = self.window {
            let Some(until) = after(from, self.options.stand) else { return true };
            let window = &pictures[from..=until];
            let start = at_rest(&self.sensors, readings, window, &self.options.rest).ok();
            let looks_on = self.options.in_motion.is_none() && self.stand.is_none();
            let middle = after(from, 0.5 * self.options.stand);
            let next = middle.map(|middle| middle.max(from + 1));
            self.window = next.filter(|_| start.is_some() || looks_on);
            let begun = self.last.as_ref().map_or(from, |(stand, _)| stand.start);
            let now = start.map(|start| (begun..until + 1, start));
            let before = std::mem::replace(&mut self.last, now);
            self.stand = before.filter(|_| self.last.is_some()).or(self.stand.take());
        }
        false
    }
    // ANCHOR_END: standing

    // ANCHOR: moves
    /// A start in motion with the last of these pictures, if some span of them is enough.
    fn moves(&mut self, readings: &[StampedSample], pictures: &[Picture]) -> Option<Beginning> {
        let seconds = |picture: usize| seconds_to(pictures, picture);
        let BeginOptions { ref spans, ref motion, rate, in_motion, .. } = self.options;
        let in_motion = in_motion?;
        let end = seconds(pictures.len().checked_sub(1)?);
        if end < self.tried + self.options.step() {
            return None;
        }
        self.tried = end;
        for span in spans.iter().filter(|span| **span <= end + ROUNDING) {
            let is_in_span = |picture: &usize| seconds(*picture) >= end - span - ROUNDING;
            let from = (0..pictures.len()).find(is_in_span).unwrap_or(0);
            let chosen = thinned(pictures, from..pictures.len(), rate);
            let some: Vec<Picture> = chosen.iter().map(|at| pictures[*at].clone()).collect();
            match in_motion(&self.sensors, readings, &some, motion) {
                Ok(found) => {
                    let last = chosen[found.pictures[found.pictures.len() - 1]];
                    let start = found.start(&self.sensors, pictures[last].nanoseconds);
                    let first = some[found.pictures[0]].nanoseconds;
                    let origin = (self.sensors.rig.imu_nanoseconds(first), found.first());
                    return Some(moving(&found, (last, start), origin, end));
                }
                Err(error) => self.last_error = Some(error.of_pictures(&chosen)),
            }
        }
        None
    }
    // ANCHOR_END: moves
}

/// Times that differ by less are the same, in seconds.
const ROUNDING: f64 = 1e-6;

/// Seconds from the first picture to another.
fn seconds_to(pictures: &[Picture], picture: usize) -> f64 {
    1e-9 * pictures[picture].nanoseconds.saturating_sub(pictures[0].nanoseconds) as f64
}

/// About so many pictures of a range in a second, its last one among them.
fn thinned(pictures: &[Picture], range: Range<usize>, rate: f64) -> Vec<usize> {
    let gap = (1e9 / rate) as i64;
    let mut chosen: Vec<usize> = Vec::new();
    for at in range.rev() {
        let later = chosen.last().map(|later| pictures[*later].nanoseconds);
        // A picture that comes a little early counts as in time.
        if later
            .is_none_or(|later| later.saturating_sub(pictures[at].nanoseconds) >= gap - gap / 10)
        {
            chosen.push(at);
        }
    }
    chosen.reverse();
    chosen
}

/// What a start in motion knows at its last picture. The rest follows from there.
fn moving(
    found: &Started,
    start: (usize, Start),
    origin: (i64, NavState),
    seconds: f64,
) -> Beginning {
    let states = vec![(start.1.state, start.1.bias)];
    let known = Known { first: start.0, states, standing: 0..0 };
    Beginning { known, seconds, scale_sigma: Some(found.scale_sigma), start, origin }
}

/// What a stand knows at its last picture.
fn standing(stand: &Range<usize>, start: &Start, pictures: &[Picture]) -> Beginning {
    let (last, start) = (stand.end - 1, *start);
    let states = vec![(start.state, start.bias)];
    let known = Known { first: last, states, standing: stand.clone() };
    Beginning {
        known,
        seconds: seconds_to(pictures, last),
        scale_sigma: None,
        start: (last, start),
        origin: (start.nanoseconds, start.state),
    }
}
