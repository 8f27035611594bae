//! New exercises, and what one lacks.

mod folders;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use exercise_spec::EXERCISES;
use folders::root;
use grader::workshop::{Change, apply, check_in, lacks, names, new_in, plan};
use tempfile::TempDir;

/// A copy of all that exercises are made of, to be changed.
fn copy() -> TempDir {
    folders::copy(&[
        "exercises",
        "solutions",
        "tests/src",
        "tests/rubrics",
        "src",
        "tests/Cargo.toml",
        "grader/points.toml",
    ])
}

/// Every file of a folder and its text.
fn read(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => files.extend(read(&path)),
            false => drop(files.insert(path.clone(), fs::read(path).expect("a file"))),
        }
    }
    files
}

fn text(copy: &TempDir, path: &str) -> String {
    fs::read_to_string(copy.path().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn change(copy: &TempDir, path: &str, from: &str, to: &str) {
    let before = text(copy, path);
    assert!(before.contains(from), "{path} has no {from}");
    fs::write(copy.path().join(path), before.replace(from, to)).expect("written");
}

#[test]
fn nothing_is_missing_from_the_exercises_of_the_book() {
    let (report, complete) = check_in(&root(), None).expect("a report");
    assert!(complete, "{report}");
    assert_eq!(names(&root()).expect("names").len(), exercise_spec::EXERCISES.len());
}

#[test]
fn an_exercise_that_is_not_there_is_told_with_those_that_are() {
    let error = check_in(&root(), Some("fill_out")).expect_err("no such exercise");
    assert!(error.contains("fill_out") && error.contains("fill_in"), "{error}");
}

#[test]
fn a_new_exercise_lacks_what_is_to_be_written_and_nothing_else() {
    let copy = copy();
    let before = read(copy.path());
    let made = new_in(copy.path(), "epipolar_line", "Where to look", "two_views").expect("made");
    assert_eq!(made.len(), 23, "{made:?}");
    let lacks = lacks(copy.path(), "epipolar_line");
    let written = |lack: &&String| {
        !lack.contains("is to be written")
            && !lack.contains("misconceptions that an exercise names")
    };
    assert_eq!(lacks.iter().filter(written).count(), 0, "{lacks:#?}");
    for part in ["spec/src/epipolar_line.rs", "hints.md", "solutions/src/misconceptions", "rubrics"]
    {
        assert!(lacks.iter().any(|lack| lack.contains(part)), "{part}");
    }
    let (report, complete) = check_in(copy.path(), None).expect("a report");
    assert!(!complete && report.contains("fill_in: complete"), "{report}");
    let after = read(copy.path());
    for (path, bytes) in before {
        let lost = |line: &&str| !String::from_utf8_lossy(&after[&path]).contains(*line);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        assert_eq!(text.lines().find(lost), None, "{} lost a line", path.display());
    }
    assert!(after.keys().all(|path| path.extension().is_none_or(|ending| ending != "new")));
}

#[test]
fn a_new_exercise_stands_in_the_order_of_the_book_in_every_list() {
    let copy = copy();
    new_in(copy.path(), "epipolar_line", "Where to look", "two_views").expect("made");
    let follows = |path: &str, lines: [&str; 3]| {
        let text = text(&copy, path);
        let places: Vec<Option<usize>> = lines.iter().map(|line| text.find(line)).collect();
        assert!(places.iter().all(Option::is_some), "{path}: {lines:?} are at {places:?}");
        assert!(places.is_sorted(), "{path}: {lines:?} are at {places:?}");
    };
    let names = ["along_or_across", "epipolar_line", "scale_null_space"];
    for (path, form) in [
        ("exercises/spec/src/lib.rs", "&NAME::EXERCISE,"),
        ("exercises/Cargo.toml", "name = \"NAME\""),
        ("exercises/pictures/Cargo.toml", "name = \"NAME\""),
        ("exercises/answers.md", "## NAME\n"),
        ("solutions/src/lib.rs", "        NAME,\n"),
        ("tests/src/lib.rs", "\"NAME\" => Some(NAME::checks(seed)),"),
        ("grader/points.toml", "\nNAME = 10\n"),
        ("src/SUMMARY.md", "(exercises/NAME.md)"),
        ("src/exercises.md", "(exercises/NAME.md) | `NAME`"),
        ("src/instructors/misconceptions.md", "The exercise is `NAME`."),
    ] {
        let lines = names.map(|name| form.replace("NAME", name));
        follows(path, [&lines[0], &lines[1], &lines[2]]);
    }
    for path in ["exercises/spec/src/lib.rs", "solutions/src/lib.rs", "tests/src/lib.rs"] {
        follows(path, ["pub mod along_or_across;", "pub mod epipolar_line;", "pub mod fill_in;"]);
    }
    let page = text(&copy, "src/exercises/epipolar_line.md");
    assert!(page.starts_with("# Exercise: where to look {#sec:epipolar_line}\n"), "{page}");
    assert!(!page.contains("{name}") && !page.contains("{title}"), "{page}");
}

#[test]
fn a_first_exercise_of_a_first_chapter_stands_before_the_others() {
    let copy = copy();
    new_in(copy.path(), "blind_spot", "What stays dark", "bearing").expect("made");
    let list = text(&copy, "exercises/spec/src/lib.rs");
    let first = "[\n    &blind_spot::EXERCISE,\n    &left_perturbation::EXERCISE,\n";
    assert!(list.contains(first), "{list}");
    let targets = text(&copy, "exercises/Cargo.toml");
    let (runner, first) =
        (targets.find("name = \"exercises\"\nharness"), targets.find("blind_spot"));
    assert!(runner < first && first < targets.find("left_perturbation"), "{targets}");
    let report = check_in(copy.path(), None).expect("a report").0;
    assert_eq!(report.matches("complete").count(), EXERCISES.len(), "all but the new one");
}

#[test]
fn names_that_cannot_be_are_refused_and_nothing_is_made() {
    let copy = copy();
    let before = read(copy.path());
    let long = "a".repeat(33);
    for name in [
        "",
        "ab",
        "Capital",
        "with-hyphen",
        "with space",
        "1st",
        "_x_",
        "tail_",
        "two__lines",
        "größe",
        "../escape",
        "a/b",
        "name\n",
        "\u{1b}[31mred",
        &long,
        "match",
        "async",
        "try",
        "crate",
        "self",
        "std",
        "test",
        "main",
        "lib",
        "con",
        "com1",
        "nul",
        "exercises",
        "misconceptions",
        "fill_in",
        "check",
        "camera",
        "navigation",
        "bearing",
        "preface",
        "nalgebra",
        "serde",
        "exercise_spec",
        "solutions",
        "checks",
    ] {
        let error = new_in(copy.path(), name, "A title", "bearing").expect_err(name);
        assert!(error.contains("name"), "{name}: {error}");
        assert!(!error.contains('\u{1b}'), "{error}");
    }
    for title in [
        "",
        "A [link](x)",
        "one\nline",
        "a \"quote\"",
        "cost | benefit",
        " edge",
        "`code`",
        "Fill\\in",
    ] {
        let error = new_in(copy.path(), "good_name", title, "bearing").expect_err(title);
        assert!(error.contains("title"), "{title}: {error}");
    }
    let error = new_in(copy.path(), "good_name", "Fill-in of marginalization", "bearing")
        .expect_err("taken");
    assert!(error.contains("title") && error.contains("taken"), "{error}");
    for chapter in ["", "nowhere", "preface", "../bearing", "exercises"] {
        let error = new_in(copy.path(), "good_name", "A title", chapter).expect_err(chapter);
        assert!(
            error.contains("src/SUMMARY.md has no chapter") && error.contains("bearing"),
            "{error}"
        );
    }
    assert!(read(copy.path()) == before, "something was made");
}

#[test]
fn one_exercise_is_not_made_twice() {
    let copy = copy();
    new_in(copy.path(), "epipolar_line", "Where to look", "two_views").expect("made");
    let before = read(copy.path());
    let error = new_in(copy.path(), "epipolar_line", "Another", "two_views").expect_err("taken");
    assert!(error.contains("taken"), "{error}");
    assert!(read(copy.path()) == before);
}

#[test]
fn what_cannot_be_written_leaves_everything_as_it_was() {
    // Where a folder should be there is a file, or where a list should be a folder.
    for path in ["tests/rubrics", "src/exercises", "exercises/skeletons/2"] {
        let copy = copy();
        fs::remove_dir_all(copy.path().join(path)).expect("removed");
        fs::write(copy.path().join(path), "no folder").expect("written");
        let before = read(copy.path());
        let error = new_in(copy.path(), "epipolar_line", "Where to look", "two_views");
        let error = error.expect_err(path);
        assert!(error.contains(path.split('/').next().expect("a part")), "{path}: {error}");
        assert!(read(copy.path()) == before, "{path}: something is left");
        assert!(!copy.path().join("exercises/spec/src/epipolar_line").exists(), "a folder is left");
    }
}

#[test]
fn changes_that_fail_late_are_undone() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("list"), "one\n").expect("written");
    fs::write(folder.path().join("file"), "").expect("written");
    let made = |path: &str| Change { path: path.to_owned(), before: None, after: "x".to_owned() };
    let listed = Change {
        path: "list".to_owned(),
        before: Some("one\n".to_owned()),
        after: "one\ntwo\n".to_owned(),
    };
    let before = read(folder.path());
    let changes = [made("deep/er/file"), listed.clone(), made("file/below")];
    let error = apply(folder.path(), &changes).expect_err("below a file");
    assert!(error.contains("file/below") && error.contains("nothing was changed"), "{error}");
    assert!(read(folder.path()) == before && !folder.path().join("deep").exists());
    fs::write(folder.path().join("list.new"), "mine").expect("written");
    let error = apply(folder.path(), &changes[..2]).expect_err("somebody's file is in the way");
    assert!(error.contains("nothing was changed"), "{error}");
    fs::remove_file(folder.path().join("list.new")).expect("it is still there");
    let stale = Change { before: Some("other".to_owned()), ..listed };
    let error = apply(folder.path(), &[made("new"), stale]).expect_err("changed meanwhile");
    assert!(error.contains("list was changed meanwhile"), "{error}");
    assert!(read(folder.path()) == before);
}

#[test]
fn a_list_without_the_neighbour_is_mended_first() {
    let copy = copy();
    change(&copy, "grader/points.toml", "along_or_across = 10\n", "");
    let error =
        plan(copy.path(), "epipolar_line", "Where to look", "two_views").expect_err("no entry");
    assert!(error.contains("grader/points.toml has no entry of `along_or_across`"), "{error}");
}

/// Changes to a complete exercise: the file, what stands there, what comes in its place, and a
/// part of the sentence that tells.
const DAMAGE: [(&str, &str, &str, &str); 30] = [
    ("exercises/spec/src/lib.rs", "pub mod fill_in;\n", "", "`pub mod fill_in;` is missing"),
    (
        "exercises/spec/src/lib.rs",
        "    &fill_in::EXERCISE,\n",
        "",
        "`&fill_in::EXERCISE,` is missing",
    ),
    (
        "exercises/spec/src/fill_in/checks.rs",
        "slug: \"fill_in\"",
        "slug: \"other\"",
        "slug: \"fill_in\"",
    ),
    ("exercises/spec/src/fill_in.rs", "fn cheapest_link(", "fn best_link(", "best_link"),
    ("exercises/spec/src/fill_in/checks.rs", ", \"", ", concat!(\"", "misconceptions that"),
    (
        "exercises/spec/src/fill_in/checks.rs",
        "types: &[\"Layout\"]",
        "types: &[]",
        "has no `Layout`",
    ),
    ("exercises/spec/src/fill_in/hints.md", "<!-- ANCHOR: 3 -->", "", "of 3 hints"),
    ("exercises/spec/src/fill_in/hints.md", "?", ".", "the first hint asks nothing"),
    ("exercises/src/fill_in.rs", "todo!", "panic!", "`todo!` stands 0 times"),
    ("exercises/src/fill_in.rs", "Edition 1.", "Edition 0.", "does not end in `Edition 1.`"),
    (
        "exercises/src/fill_in.rs",
        "//! What",
        "//! Mine. What",
        "is not exercises/skeletons/1/fill_in.rs",
    ),
    ("exercises/tests/fill_in.rs", "answer::new_couplings", "todo!()", "so it is not tested"),
    (
        "exercises/Cargo.toml",
        "name = \"fill_in\"\nharness = false\n",
        "name = \"fill_in\"\n",
        "[[test]]",
    ),
    (
        "exercises/pictures/modules/fill_in.rs",
        "new_couplings",
        "couplings",
        "so the picture cannot ask it",
    ),
    ("exercises/pictures/Cargo.toml", "name = \"fill_in\"", "name = \"other\"", "is missing"),
    ("exercises/answers.md", "## fill_in\n", "## other\n", "no section `## fill_in`"),
    ("solutions/src/lib.rs", "        fill_in,\n", "", "`fill_in,` is missing"),
    (
        "solutions/src/fill_in.rs",
        "pub fn cheapest_link",
        "fn cheapest_link",
        "pub fn cheapest_link(",
    ),
    ("solutions/src/misconceptions/mod.rs", "pub mod fill_in;\n", "", "misconceptions/mod.rs"),
    (
        "solutions/src/misconceptions/fill_in.rs",
        "COUNTED_TWICE",
        "OLD_AS_NEW",
        "no wrong answer shows COUNTED_TWICE",
    ),
    ("tests/src/lib.rs", "\"fill_in\" => ", "\"fill_out\" => ", "Some(fill_in::checks(seed))"),
    ("tests/src/fill_in.rs", "Check::new(", "check(", "so nothing is hidden"),
    ("grader/points.toml", "fill_in = 10", "fill_in = 0", "is worth no points"),
    ("src/SUMMARY.md", "(exercises/fill_in.md)", "(exercises/other.md)", "not in the book"),
    ("src/exercises.md", "(exercises/fill_in.md)", "()", "the row of the list"),
    ("src/instructors/misconceptions.md", "The exercise is `fill_in`.", "", "ACCEPT=1"),
    ("src/exercises/fill_in.md", "{#sec:fill_in ", "{", "the label of its heading"),
    ("src/exercises/fill_in.md", "{{mine}}\n", "", "serve --mine"),
    ("src/exercises/fill_in.md", "hints.md:2\"", "hints.md:1\"", "so that hint is not shown"),
    (
        "src/exercises/fill_in.md",
        "A window is full.",
        "TODO: begin.",
        "src/exercises/fill_in.md:10 is to be written: TODO",
    ),
];

#[test]
fn whatever_is_taken_from_a_complete_exercise_is_missed() {
    let copy = copy();
    for (path, from, to, told) in DAMAGE {
        let before = text(&copy, path);
        change(&copy, path, from, to);
        let lacks = lacks(copy.path(), "fill_in");
        assert!(lacks.iter().any(|lack| lack.contains(told)), "{path}: {from}: {lacks:#?}");
        fs::write(copy.path().join(path), before).expect("written");
    }
    for path in [
        "exercises/spec/src/fill_in.rs",
        "exercises/spec/src/fill_in/checks.rs",
        "exercises/spec/src/fill_in/hints.md",
        "exercises/src/fill_in.rs",
        "exercises/skeletons/1/fill_in.rs",
        "exercises/tests/fill_in.rs",
        "exercises/pictures/modules/fill_in.rs",
        "solutions/src/fill_in.rs",
        "solutions/src/misconceptions/fill_in.rs",
        "tests/src/fill_in.rs",
        "tests/rubrics/fill_in.md",
        "src/exercises/fill_in.md",
    ] {
        let before = text(&copy, path);
        fs::remove_file(copy.path().join(path)).expect("removed");
        assert!(!lacks(copy.path(), "fill_in").is_empty(), "{path}");
        fs::write(copy.path().join(path), before).expect("written");
    }
    assert_eq!(lacks(copy.path(), "fill_in"), Vec::<String>::new());
}

#[test]
fn files_of_an_exercise_that_no_list_names_are_noticed() {
    let copy = copy();
    fs::write(copy.path().join("solutions/src/forgotten.rs"), "").expect("written");
    let (report, complete) = check_in(copy.path(), None).expect("a report");
    assert!(!complete && report.contains("forgotten: "), "{report}");
}

/// A repository with an exercise more, beside the compiled programs, which it shares.
fn with_a_new_exercise() -> PathBuf {
    let copy = root().join("target/new-exercise");
    if copy.exists() {
        fs::remove_dir_all(&copy).expect("removed");
    }
    for path in [
        "code",
        "exercises",
        "exhibits",
        "factrs",
        "fuzz",
        "grader",
        "outlines",
        "press",
        "recordings",
        "solutions",
        "src",
        "tests/mutants",
        "tests/rubrics",
        "tests/src",
        "tests/tests",
        "toolchain",
        "widgets",
        "Cargo.toml",
        "Cargo.lock",
        "rustfmt.toml",
        "tests/Cargo.toml",
    ] {
        folders::copy_to(&root().join(path), &copy.join(path));
    }
    new_in(&copy, "epipolar_line", "Where to look", "two_views").expect("made");
    copy
}

#[test]
#[ignore = "compiles the workspace with an exercise more, and its tests"]
fn a_new_exercise_compiles_at_once_and_fails_only_where_something_is_to_be_written() {
    let copy = with_a_new_exercise();
    let cargo = |arguments: &[&str]| {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let output = Command::new(cargo)
            .args(arguments)
            .env("CARGO_TARGET_DIR", root().join("target"))
            .env_remove("CARGO_MANIFEST_DIR")
            .current_dir(&copy)
            .output()
            .expect("cargo runs");
        let said = [output.stdout, output.stderr].concat();
        (output.status.success(), String::from_utf8_lossy(&said).into_owned())
    };
    let (formatted, said) = cargo(&["fmt", "--all", "--check"]);
    assert!(formatted, "{said}");
    let (_, said) = cargo(&["test", "--offline", "-p", "exercises", "epipolar_line"]);
    assert!(said.contains("not written yet: TODO") && said.contains("1 failed"), "{said}");
    assert!(!said.contains("warning:"), "{said}");
    let picture = ["check", "--offline", "-p", "exercise-pictures", "--example", "epipolar_line"];
    let (compiled, said) = cargo(&picture);
    assert!(compiled && !said.contains("warning:"), "{said}");
    let (_, said) = cargo(&["test", "--offline", "-p", "book-tests", "--test", "exercises"]);
    let failed = "there_are_at_least_four ... FAILED";
    assert!(said.contains(failed) && said.contains("; 1 failed;"), "{said}");
    assert!(!said.contains("warning:"), "{said}");
    fs::remove_dir_all(&copy).expect("removed");
}
