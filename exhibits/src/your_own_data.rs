//! What page `your_own_data` shows: how many broken files the readers of recorded data were given.

use std::process::Command;

use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};

const RECORD: &str = "broken_files";

/// The environment variable that says for how many seconds each reader is tried.
const SECONDS: &str = "VISLAM_FUZZ_SECONDS";

pub fn exhibits(chapter: &mut Chapter) {
    let of = |value| accepted(RECORD, value);
    chapter.number("readers", of("readers"), "", 0);
    chapter.number("minutes", of("seconds") / 60.0, "min", 0);
    chapter.number("broken", of("files") / 1e6, "", 1);
}

/// Registers the record.
pub fn records(chapter: &mut Chapter) {
    let inputs = vec![("readers", "those of fuzz/tests/datasets.rs, all at once".to_owned())];
    chapter.record_of_data(RECORD, &[], inputs, tried);
}

/// All readers with other changes each time, so a run again differs by much.
fn tried() -> Result<Vec<RecordValue>, NotMade> {
    let absent = |_| {
        let sentence = format!("{SECONDS} is not set; let it say for how long to try each reader");
        NotMade::DataAbsent(sentence)
    };
    let seconds: f64 = std::env::var(SECONDS).map_err(absent)?.parse().unwrap_or(f64::NAN);
    let files = files(&said()?);
    Ok(vec![
        RecordValue::new("readers", files.len() as f64, "", 0, 0.0),
        RecordValue::new("seconds", seconds, "s", 0, 1e3),
        RecordValue::new("files", files.iter().sum(), "", 0, 1e3),
    ])
}

/// What the trials print when every reader holds.
fn said() -> Result<String, NotMade> {
    let failed = |what: &str| NotMade::Failed(format!("the trials of the readers: {what}"));
    let mut cargo = Command::new("cargo");
    cargo.args(["test", "--quiet", "--locked", "--package", "fuzz", "--test", "datasets"]);
    let output = cargo.args(["--", "--nocapture", "--test-threads", "16"]).output();
    let output = output.map_err(|error| failed(&error.to_string()))?;
    if !output.status.success() {
        return Err(failed(&String::from_utf8_lossy(&output.stderr)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// How many files each reader was given, from lines such as `bal: 812 inputs in 2s from seed 0`.
fn files(said: &str) -> Vec<f64> {
    let before = said.lines().filter_map(|line| Some(line.split_once(" inputs in ")?.0));
    before.filter_map(|words| words.split_whitespace().next_back()?.parse().ok()).collect()
}
