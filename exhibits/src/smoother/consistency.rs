//! Whether the smoother's errors are as large as it believes, over many flights, and whether an hour costs it more than a
//! minute.

use std::time::Instant;

use nalgebra::{SMatrix, SVector};
use vislam::filtering::{BlockNees, NeesBand, nees};
use vislam::least_squares::Manifold;
use vislam::odometry::{Estimate, Estimator};
use vislam::simulation::{FlightRecording, Recorder};
use vislam::smoother::Smoother;

use super::followed::{DELAY, Followed, options, rmse};
use crate::chapter::Chapter;
use crate::msckf::flights::example::{flight, start};
use crate::msckf::flights::flown;
use crate::record::{RecordValue, accepted};

const SEEDS: u64 = 100;
/// When it is asked, in seconds; said before the runs.
pub const TIMES: [usize; 3] = [10, 30, 60];
const PICTURES_A_SECOND: usize = 10;
/// The probability that a consistent estimator leaves any of all bands.
const OUTSIDE: f64 = 0.01;
/// The blocks and their dimensions.
pub const BLOCKS: [(&str, usize); 6] = [
    ("yaw", 1),
    ("tilt", 2),
    ("velocity", 3),
    ("position", 3),
    ("gyro bias", 3),
    ("accelerometer bias", 3),
];
/// Flights of the twin that runs with every build, and their length in seconds.
const FEW: u64 = 6;
const BRIEF: f64 = 12.0;

/// Registers the records.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        ("flight", "that of examples/filter.rs, 60 s".to_owned()),
        ("times", TIMES.map(|time| time.to_string()).join(" ")),
        ("outside", OUTSIDE.to_string()),
    ];
    chapter.record("smoother_flights", inputs, flights);
    let inputs = vec![("flight", "that of examples/filter.rs, 3600 s, seed 0".to_owned())];
    chapter.record("smoother_hour", inputs, hour);
}

pub fn numbers(chapter: &mut Chapter) {
    let mut sum = 0.0;
    let plain = options(&flown(&flight(1.0), 0), Estimator::Smoother).smoother;
    chapter.number("gate", plain.gate, "", 0);
    chapter.number("sightings", plain.least_sightings as f64, "", 0);
    chapter.number("parallax", 1e3 * plain.least_parallax, "mrad", 0);
    chapter.number("parallax_sigmas", plain.least_parallax_sigmas, "", 0);
    for seed in 0..FEW {
        let recording = flown(&flight(BRIEF), seed);
        let followed = followed(&recording, Estimator::Smoother, seed);
        let (number, estimate) = followed.causal.last().expect("there are pictures");
        sum += blocks(&recording, *number, estimate)[3];
    }
    chapter.number("few", FEW as f64, "", 0);
    chapter.number("few_seconds", BRIEF, "s", 0);
    chapter.number("few_position", sum / FEW as f64, "", 2);
    let few = NeesBand::new(FEW as usize, 3, OUTSIDE).expect("a probability");
    chapter.number("few_low", few.low, "", 2);
    chapter.number("few_high", few.high, "", 2);
    chapter.number("delay", DELAY, "s", 0);
    chapter.number("outside", 100.0 * OUTSIDE, "%", 0);
    chapter.number("tests", (TIMES.len() * BLOCKS.len()) as f64, "", 0);
    let all = BLOCKS.iter().zip(bands());
    let missed = all.map(|((block, _), band)| {
        recorded(block).into_iter().filter(|mean| !band.contains(*mean)).count()
    });
    chapter.number("missed", missed.sum::<usize>() as f64, "", 0);
    let bands = bands();
    let low = bands.iter().map(|band| band.low).fold(1.0, f64::min);
    let high = bands.iter().map(|band| band.high).fold(1.0, f64::max);
    chapter.number("band_low", low, "", 2);
    chapter.number("band_high", high, "", 2);
    for (name, time) in ["time_first", "time_second", "time_last"].into_iter().zip(TIMES) {
        chapter.number(name, time as f64, "s", 0);
    }
    let of = |name| accepted("smoother_flights", name);
    chapter.number("later_ratio", of("causal_rmse") / of("delayed_rmse"), "", 2);
    chapter.number("filter_ratio", of("filter_rmse") / of("causal_rmse"), "", 2);
}

/// What an estimator makes of a flight.
pub fn followed(recording: &FlightRecording, estimator: Estimator, seed: u64) -> Followed {
    Followed::simulated(recording, options(recording, estimator), &start(recording, seed))
        .expect("the flight is followed")
}

/// The normalized errors of an estimate after a picture, in the order of [`BLOCKS`].
pub fn blocks(recording: &FlightRecording, number: usize, estimate: &Estimate) -> [f64; 6] {
    let Estimate { state, bias, covariance, .. } = estimate;
    let truth = &recording.truth;
    let of_state = covariance.fixed_view::<9, 9>(0, 0).into_owned();
    let own = BlockNees::of(state, &truth.states[number], &of_state).expect("a covariance");
    let mut off = [0.0; 6];
    bias.local(&truth.biases[number], &mut off);
    let of_bias = |at: usize| {
        let error = SVector::<f64, 3>::from_column_slice(&off[at..at + 3]);
        let covariance: SMatrix<f64, 3, 3> =
            covariance.fixed_view::<3, 3>(9 + at, 9 + at).into_owned();
        nees(&error, &covariance).expect("a covariance")
    };
    [own.yaw, own.tilt, own.velocity, own.position, of_bias(0), of_bias(3)]
}

fn flights() -> Vec<RecordValue> {
    let mut sums = [[0.0; BLOCKS.len()]; TIMES.len()];
    let mut squares = [0.0; 3];
    let mut losses = 0;
    for seed in 0..SEEDS {
        let recording = flown(&flight(60.0), seed);
        let truth = &recording.truth.states;
        let smoother = followed(&recording, Estimator::Smoother, seed);
        for (number, estimate) in &smoother.causal {
            if let Some(at) = TIMES.iter().position(|time| time * PICTURES_A_SECOND == *number) {
                let own = blocks(&recording, *number, estimate);
                sums[at].iter_mut().zip(own).for_each(|(sum, own)| *sum += own / SEEDS as f64);
            }
        }
        let filter = followed(&recording, Estimator::Msckf, seed);
        let causal = |followed: &Followed| {
            rmse(followed.causal.iter().map(|(at, estimate)| (*at, &estimate.state)), truth)
        };
        let delayed = rmse(smoother.delayed.iter().map(|(at, state)| (*at, state)), truth);
        let own = [causal(&smoother), delayed, causal(&filter)];
        squares.iter_mut().zip(own).for_each(|(sum, own)| *sum += own * own / SEEDS as f64);
        losses += smoother.losses + filter.losses;
    }
    let mut values = vec![
        RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0),
        RecordValue::new("losses", losses as f64, "", 0, 0.0),
    ];
    for (name, square) in ["causal_rmse", "delayed_rmse", "filter_rmse"].iter().zip(squares) {
        values.push(RecordValue::new(*name, 100.0 * square.sqrt(), "cm", 1, 0.01));
    }
    for (time, sums) in TIMES.iter().zip(&sums) {
        for ((block, _), mean) in BLOCKS.iter().zip(sums) {
            values.push(RecordValue::new(named(block, *time), *mean, "", 2, 0.01));
        }
    }
    values
}

fn named(block: &str, time: usize) -> String {
    format!("{}_{time}", block.replace(' ', "_"))
}

/// The band of each block, the same at all times.
pub fn bands() -> Vec<NeesBand> {
    let dimensions: Vec<usize> =
        TIMES.iter().flat_map(|_| BLOCKS.map(|(_, dimension)| dimension)).collect();
    let bands = NeesBand::family(SEEDS as usize, &dimensions, OUTSIDE).expect("a probability");
    bands.into_iter().take(BLOCKS.len()).collect()
}

/// The means of a block in the accepted record.
pub fn recorded(block: &str) -> [f64; TIMES.len()] {
    TIMES.map(|time| accepted("smoother_flights", &named(block, time)))
}

/// Seconds in which the time of a picture is taken, at both ends of the hour.
const SPAN: f64 = 300.0;
const HOUR: f64 = 3600.0;

fn hour() -> Vec<RecordValue> {
    let flight = flight(HOUR);
    let room = flight.room(3.0, 800, 0).expect("a room");
    let mut recorder = Recorder::new(&flight, &room, 0).expect("a flight");
    recorder.picture().expect("a picture");
    let begin = start(recorder.recording(), 0);
    let options = options(recorder.recording(), Estimator::Smoother).smoother;
    let mut smoother = Smoother::new(options, &begin).expect("a start");
    // All is recorded before: what is kept of a recording lies between what a smoother allocates, and costs it time.
    let mut known = Vec::new();
    while recorder.picture().expect("a picture") {
        known.push(recorder.recording().readings.len());
    }
    let FlightRecording { readings, pictures: taken, .. } = recorder.recording();
    let (mut given, mut spent, mut room_for) = (0, [0.0; 2], [0; 2]);
    let pictures = |seconds: f64| (seconds * flight.picture_rate) as usize;
    let spans = [pictures(60.0)..pictures(60.0 + SPAN), pictures(HOUR - SPAN)..pictures(HOUR)];
    for (number, (known, picture)) in known.iter().zip(&taken[1..]).enumerate() {
        let begin = Instant::now();
        for reading in &readings[given..*known] {
            smoother.reading(*reading).expect("a reading");
        }
        given = *known;
        smoother.picture(picture).expect("it is followed");
        let seconds = begin.elapsed().as_secs_f64();
        for ((span, spent), room) in spans.iter().zip(&mut spent).zip(&mut room_for) {
            if span.contains(&number) {
                *spent += seconds;
                *room = smoother.variables();
            }
        }
    }
    vec![
        RecordValue::new("time_ratio", spent[1] / spent[0], "", 2, 0.5),
        RecordValue::new("variables_first", room_for[0] as f64, "", 0, 0.1),
        RecordValue::new("variables_last", room_for[1] as f64, "", 0, 0.1),
        RecordValue::new("pictures", known.len() as f64, "", 0, 0.0),
    ]
}
