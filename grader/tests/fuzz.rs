//! Whatever is handed in or written into a file of the course ends in a grade or a sentence.

use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use exercise_spec::exercise;
use fuzz::Trial;
use fuzz::bounds::Bounds;
use grader::fly::answer::folder as folder_of_flight;
use grader::fly::answer::{Answer, COVARIANCE, DECLARATION, NoAnswer, TEXT, TRAJECTORY, written};
use grader::fly::flights::Graded;
use grader::fly::handed::Handed;
use grader::fly::judge::Course;
use grader::fly::key::Key;
use grader::marks::Marks;
use grader::points::Points;
use grader::repository;
use grader::roster::Roster;
use grader::screen::screen;
use grader::similarity::Similarity;
use grader::submission::{Submission, collect, naturally, unpacked};
use grader::words::Written;
use nalgebra::Matrix6;
use tempfile::TempDir;
use vislam::datasets::written::{pose_covariances, tum};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const POINTS: &str = include_str!("../points.toml");

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn said<T>(read: &Result<T, String>) -> String {
    read.as_ref().err().cloned().unwrap_or_else(|| "read".to_owned())
}

#[test]
fn tables() {
    let seeds = [
        "folder,name,days_late,group\nada,Ada L.,0,1\nbrook,\"B, k\",\"1,5\",2\n",
        "\u{feff}Name;Folder;days_late\r\nAda;ada_17;2\r\n;brook;\r\n",
        "folder\tname\nada\t\"A\"\"da\"\n",
        "folder,exercise,part,points,comment\nada,fill_in,program,3.5,\"two\nlines\"\n\
            'brook,left_perturbation,words,,good\nada,graded_flight,words,\"0,5\",\n",
        "## left_perturbation\n\nThe point stays.\n\n## fill_in\ntext\n## nobody\n",
    ];
    let points = Points::parse(&format!("{POINTS}\n[words]\nleft_perturbation = 2\n"));
    let points = points.expect("points");
    let submissions = ["ada", "brook.zip", "ADA_17", "cy-2"]
        .map(|name| Submission { name: name.to_owned(), path: PathBuf::from("/batch").join(name) });
    Trial::of("tables", seeds)
        .words(&["folder", "name", "days_late", "\"", ",", ";", "\t", "\n", "ada", "words", "## "])
        .run(|bytes| {
            let text = text(bytes);
            let roster = Roster::parse(&text);
            let differences =
                roster.as_ref().map(|roster| roster.matched(&submissions).differences);
            let doubtful = differences.map_or(0, |differences| differences.doubtful.len().min(2));
            let Written { words, cut, astray } = Written::of(&text);
            let (one, other) = text.split_once('\n').unwrap_or_default();
            let order = naturally(one, other);
            assert_eq!(naturally(other, one), order.reverse());
            let stem = unpacked(Path::new(one)).len() < one.len();
            let marks = said(&Marks::parse(&text, &points));
            let words = format!("{} {} {}", words.len(), cut.len(), astray.is_some());
            format!("{} {marks} {doubtful} {words} {stem}", said(&roster))
        });
}

#[test]
fn points() {
    let more = format!("{POINTS}\n[words]\nfill_in = 2\n[late]\npercent_a_day = 10\nmost = 40\n");
    Trial::of("points", [POINTS, &more])
        .words(&["[", "]", "=", "{", "}", "\"", "'''", ".", "[words]\n", "[late]\n", "#", "\n"])
        .run(|bytes| said(&Points::parse(&text(bytes))));
}

#[test]
fn source() {
    let read = |path: &str| fs::read_to_string(repository().join(path)).expect("a file");
    let answer = read("solutions/src/fill_in.rs");
    let skeleton = read("exercises/src/fill_in.rs");
    let tricks = "#[cfg(test)]\npub(super) mod r#a { use super::super::{self as b, *}; }\n\
        macro_rules! m { ($($x:ident),*) => { $($x::y();)* } }\nfn f<'a>() { m!(std, x); }\n\
        use std::{fs::{self, File}, env as e};\n#![feature(x)]\n/* /* */ */ r##\"\"# \"##; b'\\''\n";
    Trial::of("source", [&*answer, &skeleton, tricks])
        .words(&[
            "#[cfg(test)]",
            "use ",
            "std::",
            "super::",
            "crate::",
            "exercise_spec::",
            "{",
            "}",
            "(",
            ")",
            "[",
            "]",
            "::",
            "macro_rules! ",
            "mod ",
            "fn ",
            "pub ",
            ";",
            "/*",
            "*/",
            "//",
            "\"",
            "r#\"",
            "'",
            "#!",
            "---\n",
            "unsafe",
            "r#",
            "$",
            "<",
            ">",
            "as ",
            ",",
        ])
        .bounds(Bounds { memory: 1_000, start: 2.0, ..Bounds::default() })
        .run(|bytes| {
            let text = text(bytes);
            let mut similarity =
                Similarity::new(&[exercise("fill_in").expect("it")], &repository());
            for name in ["ada", "brook"] {
                similarity.add(name, |_| Some(&text));
            }
            let alike =
                similarity.within("fill_in").len() + similarity.with_reference("fill_in").len();
            similarity.markdown();
            format!("{} {alike}", said(&screen("fill_in", &text)))
        });
}

/// An archive of files.
fn zipped(files: &[(&str, &str)], method: CompressionMethod) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in files {
        let options = SimpleFileOptions::default().compression_method(method);
        zip.start_file(*name, options).expect("a file");
        zip.write_all(text.as_bytes()).expect("written");
    }
    zip.add_symlink("src/null_space.rs", "fill_in.rs", SimpleFileOptions::default())
        .expect("a link");
    zip.finish().expect("an archive").into_inner()
}

#[test]
fn archive() {
    let files = [
        ("exercises/src/fill_in.rs", "pub fn f() {}\n"),
        ("exercises/answers.md", "## left_perturbation\nIt stays.\n"),
        ("../../evil.rs", "x"),
        ("inner.zip", "PK"),
        ("answer.toml", "kind = \"causal\"\n"),
        ("flight-1/trajectory.txt", "0 0 0 0 0 0 0 1\n"),
    ];
    let seeds = [CompressionMethod::Stored, CompressionMethod::Deflated]
        .map(|method| zipped(&files, method));
    let folder = folder();
    let path = folder.path().join("ada.zip");
    Trial::of("archive", seeds)
        .words(&[
            "PK\x01\x02",
            "PK\x03\x04",
            "PK\x05\x06",
            "PK\x06\x06",
            "PK\x06\x07",
            "../",
            "/",
            ".rs",
        ])
        .bounds(Bounds { room: 20_000_000, start: 2.0, ..Bounds::default() })
        .run(|bytes| {
            fs::write(&path, bytes).expect("written");
            let submission = Submission { name: "ada".to_owned(), path: path.clone() };
            let collected = collect(&submission);
            let notices = collected.as_ref().map_or(0, |collected| collected.notices.len());
            let handed = Handed::find(&path);
            format!("{} {notices} {}", said(&collected), said(&handed))
        });
}

/// Between the files of an answer to a flight.
const NEXT: &str = "\n=== next file\n";

/// An answer to a flight from whoever knows the truth: its files in a row.
fn answer_to(flight: &Graded) -> String {
    let times: Vec<i64> = (0..=200).map(|tenth| flight.begins + 100_000_000 * tenth).collect();
    let states: Vec<_> = times.iter().map(|time| (*time, flight.truth(*time))).collect();
    let spread = 1e-4 * Matrix6::identity();
    [
        tum(states.iter().map(|(time, state)| (*time, state))),
        pose_covariances(times.iter().map(|time| (*time, &spread))),
        "kind = \"causal\"\n".to_owned(),
        "A text with a picture of the errors.\n".to_owned(),
    ]
    .join(NEXT)
}

#[test]
fn flight() {
    let flights = vec![Graded::of(&Key::of(7), "ada", 0)];
    let course = Course::of(flights.clone()).expect("a course");
    let folder = folder();
    let inside = folder.path().join(folder_of_flight(0));
    fs::create_dir_all(&inside).expect("a folder");
    let places = [
        inside.join(TRAJECTORY),
        inside.join(COVARIANCE),
        folder.path().join(DECLARATION),
        folder.path().join(TEXT),
    ];
    Trial::of("flight", [answer_to(&flights[0])])
        .words(&[" ", "\n", "#", NEXT, "0 0 0 0 0 0 0 1\n", "-1e300", "smoothed", "kind = "])
        .bounds(Bounds { start: 3.0, ..Bounds::default() })
        .run(|bytes| {
            let text = text(bytes);
            let files = text.split(NEXT).chain(std::iter::repeat(""));
            for (place, file) in places.iter().zip(files) {
                fs::write(place, file).expect("written");
            }
            let told = match Answer::read(folder.path(), &flights) {
                Ok(answer) => {
                    let judged = course.judged(&answer).expect("measured");
                    let checks = judged.checks().into_iter().map(|check| check.sentence);
                    format!("{} {}", checks.collect::<Vec<_>>().join("; "), judged.table())
                }
                Err(NoAnswer::Missing) => "missing".to_owned(),
                Err(NoAnswer::Refused(why)) => why.join("; "),
            };
            format!("{told} {:?}", written(folder.path()).map(|text| text.is_some()))
        });
}
