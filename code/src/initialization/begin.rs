//! Which start it is to be.

use super::{Known, MotionOptions, NoStart, RestOptions, Sensors, Started, at_rest, in_motion};
use crate::datasets::tracks::Picture;
use crate::inertial::StampedSample;

// ANCHOR: begin_options
/// How a beginning is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct BeginOptions {
    /// How a stand is judged.
    pub rest: RestOptions,
    /// How a start in motion is judged.
    pub motion: MotionOptions,
    /// How long a body must stand, in seconds.
    pub stand: f64,
    /// Spans of pictures to try for a start in motion, in seconds.
    pub spans: Vec<f64>,
    /// How many pictures of a span are used in a second, at most.
    pub rate: f64,
}

impl Default for BeginOptions {
    fn default() -> Self {
        Self {
            rest: RestOptions::default(),
            motion: MotionOptions::default(),
            stand: 1.0,
            spans: vec![1.5, 2.0, 3.0, 4.0],
            rate: 5.0,
        }
    }
}
// ANCHOR_END: begin_options

/// A beginning of a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Beginning {
    /// What is known of some of its pictures.
    pub known: Known,
    /// Seconds from the first picture until it was known.
    pub seconds: f64,
    /// The standard deviation of the scale, as a part of it. A body that stands has none.
    pub scale_sigma: Option<f64>,
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
    if let Some(beginning) = standing(sensors, readings, pictures, options) {
        return Ok(beginning);
    }
    let seconds = |picture: usize| seconds_to(pictures, picture);
    let mut last_error = NoStart::TooShort { pictures: pictures.len() };
    let step = options.spans.iter().copied().fold(f64::INFINITY, f64::min) / 3.0;
    let mut tried = 0.0;
    for until in 1..=pictures.len() {
        let end = seconds(until - 1);
        if end < tried + step {
            continue;
        }
        tried = end;
        for span in options.spans.iter().filter(|span| **span <= end + ROUNDING) {
            let from =
                (0..until).find(|picture| seconds(*picture) >= end - span - ROUNDING).unwrap_or(0);
            let chosen = thinned(pictures, from..until, options.rate);
            let some: Vec<Picture> = chosen.iter().map(|at| pictures[*at].clone()).collect();
            match in_motion(sensors, readings, &some, &options.motion) {
                Ok(found) => return Ok(moving(&found, &chosen, end)),
                Err(error) => last_error = error,
            }
        }
    }
    Err(last_error)
}
// ANCHOR_END: begin

/// Times that differ by less are the same, in seconds.
const ROUNDING: f64 = 1e-6;

/// Seconds from the first picture to another.
fn seconds_to(pictures: &[Picture], picture: usize) -> f64 {
    1e-9 * pictures[picture].nanoseconds.saturating_sub(pictures[0].nanoseconds) as f64
}

/// At most so many pictures of a range in a second, its last one among them.
fn thinned(pictures: &[Picture], range: std::ops::Range<usize>, rate: f64) -> Vec<usize> {
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
fn moving(found: &Started, chosen: &[usize], seconds: f64) -> Beginning {
    let last = found.pictures.len() - 1;
    let (state, bias) = (found.batch.states[last], found.batch.biases[last]);
    let states = vec![(found.values[state], found.values[bias])];
    let first = chosen[found.pictures[last]];
    let known = Known { first, states, standing: 0, start: None };
    Beginning { known, seconds, scale_sigma: Some(found.scale_sigma) }
}

// ANCHOR: standing
/// The stand with which a flight begins, if it does: windows of pictures, each as long as a body must
/// stand and beginning in the middle of the one before, as long as nothing moves in them.
fn standing(
    sensors: &Sensors,
    readings: &[StampedSample],
    pictures: &[Picture],
    options: &BeginOptions,
) -> Option<Beginning> {
    let after = |from: usize, seconds: f64| {
        let time = pictures.get(from)?.nanoseconds.saturating_add((1e9 * seconds) as i64);
        pictures.iter().position(|picture| picture.nanoseconds >= time)
    };
    let (mut found, mut from) = (None, 0);
    while let Some(until) = after(from, options.stand) {
        let Ok(start) = at_rest(sensors, readings, &pictures[from..=until], &options.rest) else {
            break;
        };
        found = Some((until, start));
        from = after(from, 0.5 * options.stand)?.max(from + 1);
    }
    let (last, start) = found?;
    let seconds = seconds_to(pictures, last);
    let states = vec![(start.state, start.bias)];
    let known = Known { first: last, states, standing: last + 1, start: Some((last, start)) };
    Some(Beginning { known, seconds, scale_sigma: None })
}
// ANCHOR_END: standing
