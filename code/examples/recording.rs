//! Reads a recording and tells what is in it: what to look at before any estimator runs.
//!
//! ```text
//! cargo run --release -p vislam --example recording -- IMU.csv TRACKS.csv
//! cargo run --release -p vislam --example recording -- IMU_AND_TRACKS.csv
//! ```
//!
//! The first form takes readings as EuRoC has them and tracks with the columns of
//! [`vislam::datasets::tracks`], the second one file as GTSAM's examples have it. Printed are
//! readings and pictures with the span of their times, the longest pause between two and how
//! long tracks are on average. Of the second form it also holds the gyroscope against the tracks, for
//! the stated pose of the camera and for its inverse: the smaller number has the right direction.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Display;

use vislam::datasets::euroc::read_imu;
use vislam::datasets::recording::{Recording, read_recording};
use vislam::datasets::tracks::{Picture, read_tracks};
use vislam::inertial::{ImuBias, StampedSample};

const USAGE: &str = "usage: recording IMU.csv TRACKS.csv, or recording IMU_AND_TRACKS.csv";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [imu, tracks] => describe(&read(imu, read_imu)?, &read(tracks, read_tracks)?),
        [both] => {
            let recording = read(both, read_recording)?;
            describe(&recording.samples, &recording.pictures);
            compare_directions(&recording);
        }
        _ => return Err(USAGE.into()),
    }
    Ok(())
}

// ANCHOR: read
/// What a reader makes of a file; an error begins with the file's name.
fn read<T, E: Display>(file: &str, reader: fn(&str) -> Result<T, E>) -> Result<T, String> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
    reader(&text).map_err(|error| format!("{file}: {error}"))
}
// ANCHOR_END: read

fn describe(samples: &[StampedSample], pictures: &[Picture]) {
    let times = |what, times: Vec<i64>| {
        let pause = times.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).max();
        println!(
            "{} {what} from {} ns to {} ns, the longest pause {:.1} ms",
            times.len(),
            times[0],
            times[times.len() - 1],
            1e-6 * pause.unwrap_or_default() as f64
        );
    };
    times("readings", samples.iter().map(|sample| sample.nanoseconds).collect());
    times("pictures", pictures.iter().map(|picture| picture.nanoseconds).collect());
    let mut lengths: BTreeMap<usize, usize> = BTreeMap::new();
    for feature in pictures.iter().flat_map(|picture| &picture.features) {
        *lengths.entry(feature.track).or_default() += 1;
    }
    let seen: usize = lengths.values().sum();
    let mean = seen as f64 / lengths.len() as f64;
    println!("{} tracks, seen in {mean:.1} pictures on average", lengths.len());
}

// ANCHOR: compare_directions
fn compare_directions(recording: &Recording) {
    let stated = recording.body_from_camera;
    for (name, pose) in [("as stated", stated), ("inverted", stated.inverse())] {
        match recording.motion_beyond_turning(&pose, &ImuBias::default()) {
            Some(beyond) => {
                let pixels = recording.camera.fx * beyond;
                println!("{name}: features move {pixels:.2} px beyond the turning");
            }
            None => println!("{name}: no readings between two pictures with common features"),
        }
    }
}
// ANCHOR_END: compare_directions
