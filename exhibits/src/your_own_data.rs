//! What page `your_own_data` shows: how many broken files the readers were given.

use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};
use crate::release;

const RECORD: &str = "broken_files";

/// The environment variable that says for how many seconds each reader is tried.
const SECONDS: &str = "VISLAM_FUZZ_SECONDS";

/// The packages whose readers are tried, each with the name of its test.
const TRIALS: [[&str; 2]; 3] = [["fuzz", "datasets"], ["press", "fuzz"], ["grader", "fuzz"]];

pub fn exhibits(chapter: &mut Chapter) {
    let of = |value| accepted(RECORD, value);
    chapter.number("readers", of("readers"), "", 0);
    chapter.number("minutes", of("seconds") / 60.0, "min", 0);
    chapter.number("broken", of("files") / 1e6, "", 1);
}

/// Registers the record.
pub fn records(chapter: &mut Chapter) {
    let tests = TRIALS.map(|[package, test]| format!("{package}/tests/{test}.rs")).join(", ");
    let inputs = vec![("readers", format!("those of {tests}; those of one file at once"))];
    chapter.record_of_data(RECORD, &[], inputs, tried);
}

/// All readers with other changes each time, so a run again differs by much.
fn tried() -> Result<Vec<RecordValue>, NotMade> {
    let said = std::env::var(SECONDS).ok().and_then(|said| said.parse::<f64>().ok());
    let absent = || {
        let sentence = format!("{SECONDS} does not say for how many seconds to try each reader");
        NotMade::DataAbsent(sentence)
    };
    let seconds = said.ok_or_else(absent)?;
    let said = TRIALS
        .iter()
        .map(|[package, test]| release::tested(&["--package", package, "--test", test]))
        .collect::<Result<Vec<_>, _>>()?;
    let files: Vec<f64> = said.iter().flat_map(|said| files(said)).collect();
    Ok(vec![
        RecordValue::new("readers", files.len() as f64, "", 0, 0.0),
        RecordValue::new("seconds", seconds, "s", 0, 1e3),
        RecordValue::new("files", files.iter().sum(), "", 0, 1e3),
    ])
}

/// How many files each reader was given, from lines such as `bal: 812 inputs in 2s from seed 0`.
fn files(said: &str) -> Vec<f64> {
    let before = said.lines().filter_map(|line| Some(line.split_once(" inputs in ")?.0));
    before.filter_map(|words| words.split_whitespace().next_back()?.parse().ok()).collect()
}
