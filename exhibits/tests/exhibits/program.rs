//! The program as the press runs it.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

fn exhibits(arguments: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_exhibits"));
    program.args(arguments).output().expect("the program starts")
}

/// A folder that does not exist yet.
fn new_folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).expect("the folder of an earlier test run can go");
    }
    folder
}

#[test]
fn list_names_the_chapters_and_their_records() {
    let output = exhibits(&["list"]);
    assert!(output.status.success());
    let list: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(list["chapters"][0]["slug"], "bearing");
    assert_eq!(list["chapters"][0]["records"][0], "disparity_noise");
}

#[test]
fn two_runs_write_the_same_bytes() {
    let folders = [new_folder("first_run"), new_folder("second_run")];
    for folder in &folders {
        let output = exhibits(&["chapter", "bearing", folder.to_str().unwrap()]);
        assert!(output.status.success());
        assert!(output.stderr.is_empty());
    }
    let mut compared = 0;
    for entry in std::fs::read_dir(&folders[0]).unwrap() {
        let first = entry.unwrap().path();
        let second = folders[1].join(first.file_name().unwrap());
        assert!(std::fs::read(&first).unwrap() == std::fs::read(second).unwrap(), "{first:?}");
        compared += 1;
    }
    assert!(compared >= 3, "exhibits.json, and at least one figure with its data");
}

#[test]
fn a_chapter_says_where_each_of_its_exhibits_comes_from() {
    let folder = new_folder("places");
    exhibits(&["chapter", "bearing", folder.to_str().unwrap()]);
    let text = std::fs::read_to_string(folder.join("exhibits.json")).unwrap();
    let chapter: Value = serde_json::from_str(&text).unwrap();
    for kind in ["equations", "numbers", "figures", "records"] {
        let exhibits = chapter[kind].as_array().unwrap();
        assert!(!exhibits.is_empty(), "{kind}");
        for exhibit in exhibits {
            let file = exhibit["file"].as_str().unwrap();
            let is_own = ["bearing", "one_flight"]
                .iter()
                .any(|module| file.starts_with(&format!("exhibits/src/{module}")));
            assert!(is_own, "{exhibit}");
            assert!(exhibit["line"].as_u64().unwrap() > 1, "{exhibit}");
        }
    }
}

#[test]
fn what_is_not_there_is_named_in_a_sentence() {
    let sentence = |arguments: &[&str]| {
        let output = exhibits(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(sentence(&["chapter", "baering", "."]).contains("there is no chapter `baering`"));
    assert!(sentence(&["record", "noise"]).contains("there is no record `noise`"));
    assert!(sentence(&["chapters"]).contains("use exhibits list"));
}

#[test]
fn a_folder_that_cannot_be_made_is_named_in_a_sentence() {
    let folder = new_folder("in_the_way");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("a_file");
    std::fs::write(&file, "in the way").unwrap();
    let output = exhibits(&["chapter", "bearing", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert!(sentence.contains("cannot write to") && sentence.contains("a_file"), "{sentence}");
}

/// What the program says when it runs in a folder without accepted records.
fn without_records(arguments: &[&str]) -> Output {
    let folder = new_folder(&format!("without_records_{}", arguments[0]));
    std::fs::create_dir_all(&folder).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_exhibits"));
    program.args(arguments).current_dir(folder).output().expect("the program starts")
}

#[test]
fn a_chapter_whose_record_is_missing_says_which_and_what_to_run() {
    let output = without_records(&["chapter", "real_flights", "shown"]);
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success());
    assert!(sentence.contains("the record `flights` was never accepted"), "{sentence}");
    assert!(sentence.contains("run `cargo book record flights`, then `cargo book accept`"));
}

#[test]
fn a_record_can_be_made_before_it_and_others_exist() {
    let output = without_records(&["record", "disparity_noise"]);
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(output.status.success());
    assert!(record["values"].as_object().is_some_and(|values| !values.is_empty()));
}

#[test]
fn a_chapter_names_the_records_that_it_reads() {
    let folder = new_folder("reads");
    let output = exhibits(&["chapter", "real_flights", folder.to_str().unwrap()]);
    assert!(output.status.success());
    let text = std::fs::read_to_string(folder.join("exhibits.json")).unwrap();
    let chapter: Value = serde_json::from_str(&text).unwrap();
    let read: Vec<&String> = chapter["read"].as_object().unwrap().keys().collect();
    assert_eq!(read, ["exhibits/records/flights.toml"]);
}
