//! The program itself, killed in the middle of a batch and started again.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

use grader::grade::Batch;
use grader::repository;

const COUNT: usize = 6;

fn grade(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grade"));
    command.arg("run").arg(folder.join("submissions")).arg("--out").arg(folder.join("grades"));
    command.args([
        "--seed",
        "00000000000000000000000000000007",
        "--exercise",
        "left_perturbation",
        "--jobs",
        "1",
    ]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Submissions that differ in a comment.
fn hand_in(folder: &Path) {
    let answer = repository().join("solutions/src/left_perturbation.rs");
    let answer = fs::read_to_string(answer).expect("an answer");
    for number in 0..COUNT {
        let place = folder.join(format!("submissions/s{number}"));
        fs::create_dir_all(&place).expect("a folder");
        let text = format!("{answer}// {number}\n");
        fs::write(place.join("left_perturbation.rs"), text).expect("an answer");
    }
}

/// The grades that are kept, with when they were written.
fn kept(folder: &Path) -> Vec<(PathBuf, SystemTime)> {
    let entries = fs::read_dir(folder.join("grades/submissions")).into_iter().flatten().flatten();
    let grades = entries.map(|entry| entry.path().join("grade.json"));
    let written = |path: PathBuf| {
        let time = fs::metadata(&path).ok()?.modified().ok()?;
        Some((path, time))
    };
    grades.filter_map(written).collect()
}

#[test]
fn a_batch_whose_process_is_killed_goes_on_where_it_was() {
    let temporary = tempfile::tempdir().expect("a folder");
    let folder = temporary.path();
    hand_in(folder);
    let mut process = grade(folder).spawn().expect("the program");
    let begun = Instant::now();
    while kept(folder).len() < 2 {
        assert!(begun.elapsed() < Duration::from_secs(600), "no grade after ten minutes");
        assert_eq!(process.try_wait().expect("a state"), None, "it ended without a grade");
        sleep(Duration::from_millis(5));
    }
    process.kill().expect("killed");
    process.wait().expect("ended");
    let before = kept(folder);
    assert!(before.len() < COUNT, "it was killed too late to see anything");
    assert!(!folder.join("grades/grade.json").exists(), "nothing is published before the end");

    // The one that was under way, if any was, is passed over once.
    assert_ne!(grade(folder).output().expect("the program").status.code(), Some(2));
    let again = grade(folder).output().expect("the program");
    let said = String::from_utf8_lossy(&again.stdout);
    assert_eq!(again.status.code(), Some(0), "{said}{}", String::from_utf8_lossy(&again.stderr));
    let after = kept(folder);
    assert_eq!(after.len(), COUNT);
    assert!(before.iter().all(|grade| after.contains(grade)), "a grade was made twice");
    let batch = fs::read_to_string(folder.join("grades/grade.json")).expect("the grades");
    let batch: Batch = serde_json::from_str(&batch).expect("a batch");
    let earned: Vec<Option<f64>> = batch.grades.iter().map(|grade| grade.earned()).collect();
    assert_eq!(earned, [Some(10.0); COUNT]);
    assert!(said.contains(&format!("{COUNT} submissions graded.")), "{said}");
}

#[test]
fn an_order_that_is_not_understood_ends_with_2_and_says_what_there_is() {
    let temporary = tempfile::tempdir().expect("a folder");
    hand_in(temporary.path());
    let output = grade(temporary.path()).args(["--exercise", "right"]).output().expect("an end");
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.starts_with("there is no exercise `right`; there is left_perturbation,"),
        "{said}"
    );
    assert!(!temporary.path().join("grades").exists());
}
