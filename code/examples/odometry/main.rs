//! Estimates how a body moved from the readings of its inertial sensor and the tracks of its camera.
//!
//! ```text
//! cargo run --release -p vislam --example odometry -- \
//!     (COMBINED.csv | IMU.csv TRACKS.csv) [--calibration FILE] [--from S] [--to S] [--every N] \
//!     [--estimator batch|smoother|msckf] [--truth FILE] [--start EXPORT.json] \
//!     [--tum FILE] [--covariance FILE] [--ply FILE]
//! ```
//!
//! `COMBINED.csv` is a flight in one file, as GTSAM's examples have it ([`vislam::datasets::recording`]).
//! `IMU.csv` has readings as EuRoC has them and `TRACKS.csv` the columns of
//! [`vislam::datasets::tracks`], which the example `recording` looks at and the example `simulate` writes.
//!
//! | option | what |
//! | --- | --- |
//! | `--calibration FILE` | camera, its place on the body, noise: names and values as in `odometry/euroc.toml`, which is taken without it; [`vislam::datasets::calibration`] has the list. The example `simulate` writes one. A `COMBINED.csv` has a camera of its own, and only the noise is EuRoC's without the option |
//! | `--from S`, `--to S` | the pictures between these seconds after the first reading; otherwise all |
//! | `--every N` | every so manieth picture of them, the first one among them; otherwise each |
//! | `--estimator batch` | all states, biases and landmarks at once |
//! | `--estimator smoother` | the states of the last two seconds, and what is known from before |
//! | `--estimator msckf` | a filter that keeps the poses of the last pictures |
//! | `--truth FILE` | a ground truth as EuRoC has it; nothing of it is used before the comparison |
//! | `--start EXPORT.json` | what GTSAM was given, its start among it: the batch of exactly that is solved from there, by GTSAM's rule of integration, and compared with GTSAM's |
//! | `--tum FILE` | the trajectory, a line `timestamp tx ty tz qx qy qz qw` each |
//! | `--covariance FILE` | the covariance of each pose: time and 21 numbers, see [`vislam::datasets::written::pose_covariances`] |
//! | `--ply FILE` | the trajectory in red, and the landmarks of a batch in grey, for a viewer |
//!
//! The last line says how far the estimate is from the truth, as roots of mean squares in centimetres.
//! After alignment in yaw and position: `causal_ate4_cm` of each state when it was the newest,
//! `delayed_ate4_cm` of each when it was two seconds old, by what was known then, and `ate4_cm` of what
//! is written, the states of the batch or the newest ones of the others. These are three trajectories;
//! comparisons are of one kind. Then `ate6_cm` in any rotation and position, and `rpe1s_cm`,
//! `rpe5s_cm` and `rpe10s_cm` of the distance between two poses so many seconds apart, the first of them
//! every fifth. Then how many seconds of pictures it took to begin, the standard deviation of the scale
//! at that time in percent, how many states there are, and the seconds of computing, without those of
//! reading files. What is unknown is `nan`: errors without a truth, the scale of a start at rest, old
//! states of the filter, which has none.

mod arguments;
mod estimate;
mod export;
mod input;
mod judged;

use std::fmt::Display;
use std::io::IsTerminal;
use std::process::ExitCode;
use std::time::Instant;

use nalgebra::Vector3;
use vislam::datasets::euroc::read_ground_truth;
use vislam::datasets::written;

use arguments::{Arguments, HELP};
use estimate::Estimate;
use export::Export;
use input::Input;
use judged::Judged;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|argument| ["--help", "-h"].contains(&argument.as_str())) {
        println!("{HELP}");
        return ExitCode::SUCCESS;
    }
    match Arguments::read(arguments).and_then(|arguments| flown(&arguments)) {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Does what is asked, and returns the last line.
fn flown(arguments: &Arguments) -> Result<String, String> {
    let truth = arguments.truth.as_ref().map(|file| read(file, read_ground_truth)).transpose()?;
    let input = Input::read(arguments)?;
    let (estimate, seconds) = match &arguments.start {
        Some(file) => {
            let beside = read(file, Export::read)?.solve(&input)?;
            println!("{beside}");
            (beside.estimate, beside.seconds)
        }
        None => {
            let input = input.chosen(arguments)?;
            let start = Instant::now();
            let estimate = estimate::run(arguments.estimator, &input, &mut progress)?;
            (estimate, start.elapsed().as_secs_f64())
        }
    };
    write(arguments, &estimate)?;
    let judged = match &truth {
        Some(truth) => Judged::of(&estimate, truth),
        None => Judged::unknown(),
    };
    Ok(last_line(&estimate, &judged, seconds))
}

/// What a reader makes of a file; an error begins with the file's name.
fn read<T, E: Display>(file: &str, reader: impl Fn(&str) -> Result<T, E>) -> Result<T, String> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
    reader(&text).map_err(|error| format!("{file}: {error}"))
}

/// Says what is being done, in one line, on a terminal.
fn progress(what: &str) {
    if std::io::stderr().is_terminal() {
        eprint!("\r\x1b[K{what}");
    }
}

/// Writes the files that are asked for.
fn write(arguments: &Arguments, estimate: &Estimate) -> Result<(), String> {
    progress("");
    let times = || estimate.nanoseconds.iter().copied();
    let save = |file: &Option<String>, text: &dyn Fn() -> String| match file {
        Some(file) => std::fs::write(file, text()).map_err(|error| format!("{file}: {error}")),
        None => Ok(()),
    };
    save(&arguments.tum, &|| written::tum(times().zip(&estimate.states)))?;
    save(&arguments.covariance, &|| {
        written::pose_covariances(times().zip(&estimate.pose_covariances))
    })?;
    save(&arguments.ply, &|| map(estimate))
}

/// Landmarks in grey, the trajectory in red.
fn map(estimate: &Estimate) -> String {
    let grey = |place: &Vector3<f64>| (*place, [160, 160, 160]);
    let landmarks = estimate.landmarks.iter().map(grey);
    let trajectory = estimate.states.iter().map(|state| (state.position, [255, 0, 0]));
    written::ply(&landmarks.chain(trajectory).collect::<Vec<_>>())
}

fn last_line(estimate: &Estimate, judged: &Judged, seconds: f64) -> String {
    let centimetres = |metres: f64| format!("{:.2}", 100.0 * metres);
    let [causal, delayed] = judged.online.map(centimetres);
    let ([ate4, ate6], [rpe1, rpe5, rpe10]) =
        (judged.absolute.map(centimetres), judged.relative.map(centimetres));
    let line = format!(
        "causal_ate4_cm {causal}  delayed_ate4_cm {delayed}  ate4_cm {ate4}  ate6_cm {ate6}  rpe1s_cm {rpe1}  rpe5s_cm {rpe5}  rpe10s_cm {rpe10}  \
         initialized_after_s {:.2}  scale_sigma_percent {:.2}  states {}  seconds {seconds:.3}",
        estimate.initialized_after,
        100.0 * estimate.scale_sigma,
        estimate.states.len()
    );
    line.replace("NaN", "nan")
}

#[cfg(test)]
mod tests;
