//! Whether the filter's errors are as large as it believes, over many flights.

use vislam::filtering::{BlockNees, NeesBand};
use vislam::msckf::MsckfOptions;

use super::flights::example::{flight, fly, start};
use super::flights::flown;
use crate::chapter::Chapter;
use crate::record::{RecordValue, accepted};

const SEEDS: u64 = 100;
/// When it is asked, in seconds; said before the runs.
pub const TIMES: [usize; 3] = [10, 30, 60];
const PICTURES_A_SECOND: usize = 10;
/// The probability that a consistent filter leaves any of all bands.
const OUTSIDE: f64 = 0.01;
/// The blocks and their dimensions.
pub const BLOCKS: [(&str, usize); 4] = [("yaw", 1), ("tilt", 2), ("velocity", 3), ("position", 3)];

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        ("flight", "that of examples/filter.rs, 60 s".to_owned()),
        ("times", TIMES.map(|time| time.to_string()).join(" ")),
        ("outside", OUTSIDE.to_string()),
    ];
    chapter.record("msckf_consistency", inputs, consistency);
}

fn consistency() -> Vec<RecordValue> {
    let mut sums = [[0.0; BLOCKS.len()]; TIMES.len()];
    let (mut squares, mut pictures) = (0.0, 0);
    for seed in 0..SEEDS {
        let recording = flown(&flight(60.0), seed);
        let options = MsckfOptions::of_flight(&recording.flight);
        let states = &recording.truth.states;
        fly(&recording, options, &start(&recording, seed), |number, filter, _| {
            squares += (states[number].position - filter.state().position).norm_squared();
            pictures += 1;
            if let Some(at) = TIMES.iter().position(|time| time * PICTURES_A_SECOND == number) {
                let covariance = filter.covariance().fixed_view::<9, 9>(0, 0).into_owned();
                let nees = BlockNees::of(filter.state(), &states[number], &covariance);
                let nees = nees.expect("a covariance");
                let blocks = [nees.yaw, nees.tilt, nees.velocity, nees.position];
                sums[at].iter_mut().zip(blocks).for_each(|(sum, nees)| *sum += nees);
            }
        })
        .expect("the flight is followed");
    }
    let value = |name: String, value, decimals| RecordValue::new(name, value, "", decimals, 1e-3);
    let mut values = vec![
        RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0),
        RecordValue::new("rmse", 100.0 * (squares / f64::from(pictures)).sqrt(), "cm", 1, 1e-3),
    ];
    let bands = bands();
    let mut missed = 0;
    for (time, sums) in TIMES.iter().zip(&sums) {
        for ((block, _), (sum, band)) in BLOCKS.iter().zip(sums.iter().zip(&bands)) {
            let mean = sum / SEEDS as f64;
            missed += usize::from(!band.contains(mean));
            values.push(value(format!("{block}_{time}"), mean, 2));
        }
    }
    for ((block, _), band) in BLOCKS.iter().zip(&bands) {
        values.push(value(format!("{block}_low"), band.low, 2));
        values.push(value(format!("{block}_high"), band.high, 2));
    }
    values.push(RecordValue::new("tests", (TIMES.len() * BLOCKS.len()) as f64, "", 0, 0.0));
    values.push(RecordValue::new("missed", missed as f64, "", 0, 0.0));
    values.push(RecordValue::new("confidence", 100.0 * (1.0 - OUTSIDE), "%", 0, 0.0));
    values
}

/// The band of each block, the same at all times.
fn bands() -> Vec<NeesBand> {
    let dimensions: Vec<usize> =
        TIMES.iter().flat_map(|_| BLOCKS.map(|(_, dimension)| dimension)).collect();
    NeesBand::family(SEEDS as usize, &dimensions, OUTSIDE).expect("a probability")
}

/// What the accepted record says of a block: its means, and the ends of the band.
pub fn recorded(block: &str) -> ([f64; TIMES.len()], [f64; 2]) {
    let of = |name: String| accepted("msckf_consistency", &name);
    let means = TIMES.map(|time| of(format!("{block}_{time}")));
    (means, ["low", "high"].map(|end| of(format!("{block}_{end}"))))
}
