//! What a student hands in for the flights: numbers in files, of which none is believed.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

use nalgebra::{Matrix6, Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;
use vislam::inertial::NavState;

use super::flights::{FLIGHTS, Graded, SECONDS, STAND};
use super::handed::has_answer;
use super::reference::Line;
use crate::submission::is_there;
use crate::text::{harmless, harmless_line};

/// The largest file that is read, in bytes.
pub const LARGEST: u64 = 4_000_000;
/// The most lines of a trajectory: one for each reading of a flight is fewer.
pub const MOST_LINES: usize = 6_000;
/// The longest line, in bytes.
pub const LONGEST_LINE: usize = 1_000;
/// The file of the text for a person.
pub const TEXT: &str = "text.md";
/// As much of it as anybody reads.
pub const LONGEST_TEXT: usize = 10_000;
/// Lines may be so many seconds apart.
pub const APART: f64 = 0.25;
/// An answer may begin so many seconds after it could, and end so many before the flight.
pub const LEAVES_OUT: [f64; 2] = [6.0, 0.15];
/// No position is farther off, in metres.
const FARTHEST: f64 = 1e6;
/// Norms of quaternions and times that should be equal may be off by rounding.
const ROUNDING: [f64; 2] = [1e-2, 1e-5];

/// Which readings and pictures an estimate was made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Those until its time.
    Causal,
    /// All of the flight.
    Smoothed,
}

/// `answer.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Declared {
    kind: Kind,
}

/// An answer that can be judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// What it declares to be.
    pub kind: Kind,
    /// The lines of each flight. A covariance need not be one.
    pub flights: Vec<Vec<Line>>,
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoAnswer {
    /// Nothing of it is there.
    Missing,
    /// Sentences on what is wrong.
    Refused(Vec<String>),
}

/// The folder of a flight, counted from zero.
pub fn folder(flight: usize) -> String {
    format!("flight-{}", flight + 1)
}

/// The file of the declaration, and those of a flight.
pub const DECLARATION: &str = "answer.toml";
/// The trajectory in the form of TUM.
pub const TRAJECTORY: &str = "trajectory.txt";
/// The covariances beside it.
pub const COVARIANCE: &str = "covariance.txt";

impl Answer {
    /// Reads what lies in a folder as an answer to these flights. No link is followed.
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] with a sentence for the declaration and for each flight that cannot be judged.
    pub fn read(root: &Path, flights: &[Graded]) -> Result<Self, NoAnswer> {
        if !has_answer(root) {
            return Err(NoAnswer::Missing);
        }
        let mut wrong = Vec::new();
        let kind = declared(root).map_err(|why| wrong.push(why)).ok();
        let mut read = Vec::new();
        for (number, flight) in flights.iter().enumerate() {
            match flight_of(root, number, flight) {
                Ok(lines) => read.push(lines),
                Err(why) => wrong.push(why),
            }
        }
        match kind.filter(|_| wrong.is_empty()) {
            Some(kind) => Ok(Self { kind, flights: read }),
            None => Err(NoAnswer::Refused(wrong)),
        }
    }
}

fn declared(root: &Path) -> Result<Kind, String> {
    let text = text_of(root, DECLARATION)?;
    let declared: Declared = toml::from_str(&text).map_err(|error| {
        format!(
            "{DECLARATION}: {}; it has one line, `kind = \"causal\"` or `kind = \"smoothed\"`",
            harmless_line(error.message(), 200)
        )
    })?;
    Ok(declared.kind)
}

/// The lines of one flight.
fn flight_of(root: &Path, number: usize, flight: &Graded) -> Result<Vec<Line>, String> {
    let folder = folder(number);
    let is_folder = fs::symlink_metadata(root.join(&folder)).map(|it| it.is_dir());
    match is_folder {
        Ok(true) => {}
        Ok(false) => return Err(format!("`{folder}` is no folder; hand in the folder itself")),
        Err(_) => return Err(format!("there is no folder `{folder}`; hand in all {FLIGHTS}")),
    }
    let [trajectory, covariance] = [TRAJECTORY, COVARIANCE].map(|name| format!("{folder}/{name}"));
    let poses =
        numbers(&text_of(root, &trajectory)?, 8).map_err(|why| format!("`{trajectory}`: {why}"))?;
    let spreads = numbers(&text_of(root, &covariance)?, 22)
        .map_err(|why| format!("`{covariance}`: {why}"))?;
    let mut lines = Vec::new();
    for (line, row) in &poses {
        let pose = pose(row).map_err(|why| format!("`{trajectory}`: line {line}: {why}"))?;
        lines.push(pose);
    }
    in_time(&lines, flight).map_err(|why| format!("`{trajectory}`: {why}"))?;
    if poses.len() != spreads.len() {
        return Err(format!(
            "`{covariance}` has {} lines and `{trajectory}` has {}; give one covariance for each pose",
            spreads.len(),
            poses.len()
        ));
    }
    for ((line, row), pose) in spreads.iter().zip(&mut lines) {
        let off = (row[0] - 1e-9 * pose.nanoseconds as f64).abs();
        if off > ROUNDING[1] {
            return Err(format!(
                "`{covariance}`: line {line}: its time is not that of the pose in the same place; \
                 give the same times in the same order"
            ));
        }
        pose.covariance = of_triangle(&row[1..]);
    }
    Ok(lines)
}

/// The symmetric matrix of an upper triangle that was written row by row.
pub fn of_triangle(upper: &[f64]) -> Matrix6<f64> {
    let mut numbers = upper.iter();
    let mut matrix = Matrix6::zeros();
    for (row, column) in (0..6).flat_map(|row| (row..6).map(move |column| (row, column))) {
        let number = numbers.next().copied().unwrap_or(f64::NAN);
        matrix[(row, column)] = number;
        matrix[(column, row)] = number;
    }
    matrix
}

/// A time, a place and a quaternion as a line without a covariance.
fn pose(row: &[f64]) -> Result<Line, String> {
    let position = Vector3::new(row[1], row[2], row[3]);
    if position.amax() > FARTHEST {
        return Err("the position is farther off than anything flies; is it in metres?".to_owned());
    }
    let quaternion = Quaternion::new(row[7], row[4], row[5], row[6]);
    let norm = quaternion.norm();
    if (norm - 1.0).abs() > ROUNDING[0] {
        return Err(format!("the quaternion has norm {norm:.3}; a rotation has norm 1"));
    }
    let rotation = UnitQuaternion::new_normalize(quaternion).to_rotation_matrix();
    let nanoseconds = (1e9 * row[0]).round() as i64;
    let state = NavState { world_from_body: rotation, velocity: Vector3::zeros(), position };
    Ok(Line { nanoseconds, state, covariance: Matrix6::zeros() })
}

/// That times go on, belong to the flight and leave nothing out.
fn in_time(lines: &[Line], flight: &Graded) -> Result<(), String> {
    let seconds: Vec<f64> = lines.iter().map(|line| flight.seconds(line.nanoseconds)).collect();
    let (Some(first), Some(last)) = (seconds.first(), seconds.last()) else {
        return Err("there is no line with numbers in it".to_owned());
    };
    let outside = |time: &f64| !(-0.1..=SECONDS + 0.1).contains(time);
    if seconds.iter().any(outside) {
        return Err(
            "there are times that are not those of this flight: is it the answer to another \
                    flight, or to that of another student? Times are those of `imu.csv`, in seconds"
                .to_owned(),
        );
    }
    // Nothing is missed while the body stands, and in a gap nothing can be asked for.
    let since = flight.from().max(STAND + 0.5);
    let from = flight.from() + LEAVES_OUT[0];
    let begins = seconds.iter().find(|time| **time >= since).unwrap_or(first);
    if *begins > from || *last < SECONDS - LEAVES_OUT[1] {
        return Err(format!(
            "it goes from {begins:.1} s to {last:.1} s of the flight; it must begin by {from:.1} s and \
             go on to the end"
        ));
    }
    let order = seconds.windows(2).position(|pair| pair[1] <= pair[0]);
    if let Some(at) = order {
        return Err(format!("pose {} is not later than the one before; sort them", at + 2));
    }
    match seconds.windows(2).find(|pair| pair[0] >= since && pair[1] - pair[0] > APART) {
        Some(pair) => Err(format!(
            "there is nothing between {:.1} s and {:.1} s of the flight; give a pose for each picture",
            pair[0], pair[1]
        )),
        None => Ok(()),
    }
}

/// The rows of numbers of a text, with their lines. What begins with `#` and what is empty does not
/// count.
fn numbers(text: &str, columns: usize) -> Result<Vec<(usize, Vec<f64>)>, String> {
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        if line.len() > LONGEST_LINE {
            return Err(format!("line {number} has more than {LONGEST_LINE} bytes"));
        }
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if rows.len() == MOST_LINES {
            return Err(format!(
                "there are more than {MOST_LINES} lines; give one for each picture"
            ));
        }
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        if words.len() != columns {
            return Err(format!(
                "line {number} has {} numbers and not {columns}, separated by spaces{}",
                words.len(),
                if words.len() == 37 { "; give the upper triangle alone" } else { "" }
            ));
        }
        let parsed = words.iter().map(|word| {
            let number = word.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| harmless_line(word, 40))
        });
        let parsed: Result<Vec<f64>, String> = parsed.collect();
        rows.push((
            number,
            parsed.map_err(|word| format!("line {number}: `{word}` is not a finite number"))?,
        ));
    }
    Ok(rows)
}

/// What was written beside the numbers, if anything was.
///
/// # Errors
///
/// Why nobody can read it.
pub fn written(root: &Path) -> Result<Option<String>, String> {
    if !is_there(&root.join(TEXT)) {
        return Ok(None);
    }
    let text = text_of(root, TEXT)?;
    Ok(Some(harmless(text.trim(), LONGEST_TEXT)).filter(|text| !text.is_empty()))
}

/// The text of a file in a submission. A link, a device or a file that is too large is none.
fn text_of(root: &Path, name: &str) -> Result<String, String> {
    let path = root.join(name);
    let metadata = fs::symlink_metadata(&path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => format!("there is no file `{name}`"),
        _ => format!("`{name}` cannot be read: {error}"),
    })?;
    if !metadata.is_file() {
        return Err(format!(
            "`{name}` is no file; links are not followed: hand in the file itself"
        ));
    }
    let too_large = || format!("`{name}` has more than {LARGEST} bytes");
    if metadata.len() > LARGEST {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    let read = File::open(&path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes));
    read.map_err(|error| format!("`{name}` cannot be read: {error}"))?;
    if bytes.len() as u64 > LARGEST {
        return Err(too_large());
    }
    String::from_utf8(bytes).map_err(|_| format!("`{name}` is no text; save it as UTF-8"))
}
