//! What is taken of a submission, and by which name.

use std::fs;
use std::path::{Path, PathBuf};

use grader::fly::handed::has_flights;
use grader::submission::{
    Collected, Holds, LARGEST, Submission, collect, find, has_answers, naturally, single,
};
use tempfile::TempDir;

/// A folder with files, each by its path and its content. A path that ends in `/` is a folder.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (path, content) in files {
        let path = folder.path().join(path);
        if path.to_string_lossy().ends_with('/') {
            fs::create_dir_all(&path).expect("a folder");
            continue;
        }
        fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        fs::write(&path, content).expect("a file");
    }
    folder
}

fn names(paths: &[PathBuf]) -> Vec<String> {
    find(paths, has_answers).expect("found").into_iter().map(|submission| submission.name).collect()
}

fn names_in(files: &[(&str, &str)]) -> Vec<String> {
    let folder = folder(files);
    let root = folder.path().join("batch");
    names(&[root])
}

fn collected(root: &Path) -> Collected {
    collect(&Submission { name: "alice".to_owned(), path: root.to_owned() }).expect("collected")
}

const FILL_IN: &str = "pub fn f() {}";

#[test]
fn a_repository_a_source_folder_and_loose_answers_are_one_submission() {
    for file in ["exercises/src/fill_in.rs", "src/fill_in.rs", "fill_in.rs"] {
        let folder = folder(&[(&format!("alice/{file}"), FILL_IN), ("alice/notes/a.txt", "")]);
        assert_eq!(names(&[folder.path().join("alice")]), ["alice"], "{file}");
        let taken = collected(&folder.path().join("alice"));
        assert_eq!(taken.answers.get("fill_in").map(String::as_str), Some(FILL_IN), "{file}");
        assert!(taken.refused.is_empty() && taken.notices.is_empty(), "{file}: {taken:?}");
    }
}

#[test]
fn a_folder_of_folders_is_a_folder_of_submissions_in_the_order_of_their_names() {
    let files = [
        ("batch/bob/src/fill_in.rs", ""),
        ("batch/alice/fill_in.rs", ""),
        ("batch/nothing/", ""),
        ("batch/.git/config", ""),
        ("batch/__MACOSX/x", ""),
        ("batch/.carol/fill_in.rs", ""),
        ("batch/roster.csv", "alice,Alice"),
    ];
    assert_eq!(names_in(&files), ["_.carol", "alice", "bob", "nothing"]);
}

#[test]
fn a_folder_of_one_submission_is_named_by_it_and_a_download_by_the_folder_around_it() {
    assert_eq!(names_in(&[("batch/alice/src/fill_in.rs", "")]), ["alice"]);
    assert_eq!(names_in(&[("batch/course-main/src/fill_in.rs", "")]), ["batch"]);
    assert_eq!(names_in(&[("batch/course-1a2b3c4d5e/src/fill_in.rs", "")]), ["batch"]);
    assert_eq!(names_in(&[("batch/batch/fill_in.rs", "")]), ["batch"]);
    let cloned = "course__exercises-1234567";
    assert_eq!(names_in(&[(&format!("batch/{cloned}/src/fill_in.rs"), "")]), [cloned]);
    let cloned = "course__hw-main";
    assert_eq!(names_in(&[(&format!("batch/{cloned}/src/fill_in.rs"), "")]), [cloned]);
}

#[test]
fn answers_of_a_download_are_found_in_its_only_folder() {
    let folder = folder(&[
        ("alice/course-main/exercises/src/fill_in.rs", FILL_IN),
        ("alice/.DS_Store", ""),
        ("alice/__MACOSX/x", ""),
    ]);
    assert!(collected(&folder.path().join("alice")).answers.contains_key("fill_in"));
}

fn error_in(files: &[(&str, &str)]) -> String {
    let folder = folder(files);
    find(&[folder.path().join("batch")], has_answers).expect_err("an error")
}

#[test]
fn answers_beside_a_folder_with_answers_are_told_and_nothing_is_dropped() {
    let of = |here: &str, other: &str| {
        let error = error_in(&[(&format!("batch/{here}"), ""), (&format!("batch/{other}"), "")]);
        assert!(error.contains("give --single"), "{error}");
        error
    };
    let error = of("exercises/src/fill_in.rs", "alice/src/fill_in.rs");
    assert!(error.contains("answers lie in `exercises/src` and in `alice` beside"), "{error}");
    of("exercises/src/fill_in.rs", "exercises_backup/src/fill_in.rs");
    let error = of("null_space.rs", "old/null_space.rs");
    assert!(error.contains("answers lie in it and in `old` beside"), "{error}");
    of("src/fill_in.rs", "alice/course-main/exercises/src/fill_in.rs");
}

#[test]
fn answers_at_the_top_are_one_submission_whatever_lies_beside() {
    let files = [("batch/null_space.rs", ""), ("batch/images/a.png", ""), ("batch/b/c/d", "")];
    assert_eq!(names_in(&files), ["batch"]);
    let files = [("batch/null_space.rs", ""), ("batch/old.zip", ""), ("batch/images/a.png", "")];
    assert_eq!(names_in(&files), ["batch"]);
    let folder = folder(&files);
    let notices = collected(&folder.path().join("batch")).notices;
    assert!(notices[0].starts_with("not used: `old.zip`."), "{notices:?}");
}

#[test]
fn what_is_called_single_is_one_submission_whatever_it_holds() {
    let folder = folder(&[
        ("alice/null_space.rs", FILL_IN),
        ("alice/old/null_space.rs", ""),
        ("bob/one/null_space.rs", ""),
        ("bob/two/null_space.rs", ""),
        ("carol/", ""),
    ]);
    let paths = ["alice", "bob", "carol"].map(|name| folder.path().join(name));
    let found = single(&paths).expect("found");
    assert_eq!(found.iter().map(|it| &it.name).collect::<Vec<_>>(), ["alice", "bob", "carol"]);
    let taken = collect(&found[0]).expect("collected");
    assert_eq!(taken.answers["null_space"], FILL_IN);
    assert!(taken.notices[0].starts_with("not used: `old`."), "{:?}", taken.notices);
    assert!(single(&[folder.path().join("nobody")]).is_err());
}

#[test]
fn a_folder_that_holds_nothing_is_no_submission_and_one_in_a_batch_is() {
    for file in ["batch/", "batch/notes.txt", "batch/.git/config"] {
        let error = error_in(&[(file, "")]);
        assert!(error.contains("there is no submission in it"), "{error}");
    }
    assert_eq!(names_in(&[("batch/alice/", "")]), ["alice"]);
}

#[test]
fn somebody_who_is_called_src_is_one_of_a_batch() {
    let others = [("batch/ada/fill_in.rs", ""), ("batch/brook/src/fill_in.rs", "")];
    let files = [others[0], others[1], ("batch/src/fill_in.rs", "")];
    assert_eq!(names_in(&files), ["ada", "brook", "src"]);
}

#[test]
fn a_manifest_that_was_handed_out_is_no_reason_for_a_notice() {
    let folder =
        folder(&[("ada/exercises/src/fill_in.rs", FILL_IN), ("ada/exercises/Cargo.toml", "")]);
    assert_eq!(collected(&folder.path().join("ada")).notices, Vec::<String>::new());
}

#[test]
fn words_are_what_stands_below_a_question_and_is_not_the_question() {
    let questions =
        fs::read_to_string(grader::repository().join("exercises/answers.md")).expect("questions");
    let own =
        questions.replace("## fill_in\n", "## fill_in\n\nFour of them,\nbecause of the link.\n");
    for place in ["exercises/answers.md", "answers.md", "exercises/src/answers.md"] {
        let folder =
            folder(&[("ada/exercises/src/fill_in.rs", FILL_IN), (&format!("ada/{place}"), &own)]);
        let words = collected(&folder.path().join("ada")).words;
        let wanted = (place != "answers.md").then_some("Four of them,\nbecause of the link.");
        assert_eq!(words.get("fill_in").map(String::as_str), wanted, "{place}");
        assert!(words.len() <= 1, "{words:?}");
    }
}

/// What is taken of files in the folder of `ada`.
fn taken(files: &[(&str, &str)]) -> Collected {
    let files: Vec<(String, &str)> =
        files.iter().map(|(path, text)| (format!("ada/{path}"), *text)).collect();
    let files: Vec<(&str, &str)> = files.iter().map(|(path, text)| (&**path, *text)).collect();
    collected(&folder(&files).path().join("ada"))
}

#[test]
fn words_that_are_not_read_are_told_and_open() {
    let program = ("exercises/src/fill_in.rs", FILL_IN);
    let words = "## fill_in\n\nFour of them.\n";
    let nothing = "## fill_in\n";
    for (files, unread) in [
        (vec![program, ("answers.md", words)], true),
        (vec![program, ("answers.md", words), ("exercises/answers.md", nothing)], true),
        (vec![program, ("answers.md", nothing)], false),
        (vec![program, ("answers.md", words), ("exercises/answers.md", words)], false),
        (
            vec![program, ("exercises/answers.md", nothing), ("exercises/src/answers.md", words)],
            false,
        ),
        (vec![program, ("exercises/answers.md/", "")], true),
        (vec![program, ("exercises/answers.md", &words.repeat(20_000))], true),
        (vec![program], false),
    ] {
        let taken = taken(&files);
        assert_eq!(taken.unread, unread, "{taken:?}");
        let told = taken.notices.iter().filter(|notice| notice.contains("`answers.md`")).count();
        assert_eq!(told, usize::from(unread), "{taken:?}");
    }
}

#[test]
fn an_answer_in_words_that_is_cut_is_told() {
    for (letters, cut) in [(5_900, false), (6_100, true)] {
        let text = format!("## fill_in\n\n{}\n", "a".repeat(letters));
        let taken =
            taken(&[("exercises/src/fill_in.rs", FILL_IN), ("exercises/answers.md", &text)]);
        assert_eq!(taken.unread, cut, "{letters}");
        let told = |notice: &String| {
            notice.starts_with(
                "the answer to `fill_in` in `exercises/answers.md` is longer than 6000",
            )
        };
        assert_eq!(taken.notices.iter().any(told), cut, "{:?}", taken.notices);
    }
}

#[test]
fn a_draft_beside_the_programs_does_not_stand_for_what_is_in_exercises() {
    let program = ("exercises/src/fill_in.rs", FILL_IN);
    let draft = ("exercises/src/answers.md", "## fill_in\n\nA draft.\n");
    let handed_in = ("exercises/answers.md", "## fill_in\n\nFour of them.\n");
    for files in [vec![program, draft, handed_in], vec![draft, handed_in]] {
        let taken = taken(&files);
        assert_eq!(taken.words["fill_in"], "Four of them.");
        assert!(taken.unread, "the draft is told");
        let told = "the answers in words of `exercises/src/answers.md` are not read: ";
        assert!(taken.notices.iter().any(|it| it.starts_with(told)), "{:?}", taken.notices);
    }
}

#[test]
fn words_in_a_file_of_another_name_or_place_are_told_and_open() {
    let program = ("exercises/src/fill_in.rs", FILL_IN);
    let words = "## fill_in\n\nFour of them.\n";
    for place in
        ["exercises/answers (1).md", "docs/answers.md", "docs/a/answers_final.md", "ANSWERS.md"]
    {
        for (text, unread) in [(words, true), ("## fill_in\n", false)] {
            let taken = taken(&[program, (place, text)]);
            assert_eq!(taken.unread, unread, "{place}");
            let told = taken.notices.iter().any(|it| it.contains(&format!("`{place}`")));
            assert_eq!(told, unread, "{:?}", taken.notices);
        }
    }
    for place in ["target/answers.md", "vendor/x/answers.md", ".git/answers.md", "notes/answer.md"]
    {
        assert!(!taken(&[program, (place, words)]).unread, "{place}");
    }
}

/// The file of the questions, each with a sentence below its heading, which is written in another way.
fn answered(heading: impl Fn(&str) -> String) -> String {
    let questions =
        fs::read_to_string(grader::repository().join("exercises/answers.md")).expect("questions");
    let line = |line: &str| match line.strip_prefix("## ") {
        Some(slug) => format!("{}\n\nIt stays.\n", heading(slug)),
        None => format!("{line}\n"),
    };
    questions.lines().map(line).collect()
}

#[test]
fn words_below_headings_that_name_no_question_are_no_zero() {
    let of = |text: &str| taken(&[("exercises/answers.md", text)]);
    let headings: [fn(&str) -> String; 5] = [
        |slug| format!("## 1. {slug}"),
        |slug| format!("## Question {slug}"),
        |slug| format!("### {slug}"),
        |slug| format!("{slug}\n-------"),
        |_| String::new(),
    ];
    for heading in headings {
        let text = answered(heading);
        let taken = of(&text);
        assert!(taken.words.is_empty() && taken.unread, "{text}");
        let told = taken.notices.iter().filter(|it| it.contains("below no heading of a question"));
        assert_eq!(told.count(), 1, "{:?}", taken.notices);
        let unread = of(&text.replace("It stays.", "")).unread;
        assert_eq!(unread, text.contains("-------"), "without a word below: {text}");
    }
    let one = answered(|slug| match slug {
        "manifold" => "## 2. manifold".to_owned(),
        _ => format!("## {slug}"),
    });
    let taken = of(&one);
    assert!(taken.unread && taken.notices.iter().any(|it| it.contains("`## 2. manifold`")));
}

#[test]
fn what_was_handed_out_is_nobodys_answer() {
    let kept = answered(|slug| format!("## {slug}"));
    let former = kept[kept.find("## ").expect("a heading")..].to_owned();
    let former =
        format!("Write below each question. Nobody but a person reads this file.\n\n{former}");
    for text in [kept.clone(), format!("\u{feff}{kept}"), former, format!("# Ada\n\n---\n{kept}")] {
        let taken = taken(&[("exercises/answers.md", &text)]);
        assert_eq!((taken.words["bearing"].as_str(), taken.unread), ("It stays.", false), "{text}");
    }
    let bare = taken(&[("answers.md", "\u{feff}## bearing\n\nOf sixty.\n")]);
    assert_eq!(bare.words["bearing"], "Of sixty.");
}

#[test]
fn words_without_a_program_are_found_in_nested_folders() {
    let text = "## fill_in\n\nFour of them.\n";
    for place in
        ["answers.md", "exercises/answers.md", "course-main/exercises/answers.md", "a/b/answers.md"]
    {
        assert_eq!(taken(&[(place, text)]).words["fill_in"], "Four of them.", "{place}");
    }
}

#[test]
fn words_that_are_no_utf_8_are_told() {
    let folder = folder(&[("ada/exercises/src/fill_in.rs", FILL_IN)]);
    fs::write(folder.path().join("ada/exercises/answers.md"), b"\xff\xfe#\0#\0").expect("a file");
    let taken = collected(&folder.path().join("ada"));
    assert!(taken.unread);
    assert!(taken.notices[0].starts_with("`answers.md` is no UTF-8: "), "{:?}", taken.notices);
}

#[test]
fn words_end_where_the_next_question_begins_and_nowhere_else() {
    let own = "First.\n\n## Second part\n\n```python\n## a comment\nx = 1\n```\n\n## bearing of it\nLast.";
    let text = format!("## bearing\n\nOf sixty.\n\n## fill_in\n\n{own}\n\n## manifold\n");
    let words = taken(&[("answers.md", &text)]).words;
    assert_eq!(words["fill_in"], own);
    assert_eq!((words["bearing"].as_str(), words.len()), ("Of sixty.", 2));
    for heading in ["## fill_in (Ada)", "## Fill_in", "## `fill_in`:", "##  FILL_IN"] {
        let words = taken(&[("answers.md", &format!("{heading}\n\nFour.\n"))]).words;
        assert_eq!(words.get("fill_in").map(String::as_str), Some("Four."), "{heading}");
    }
}

#[test]
fn numbers_in_names_count_as_numbers() {
    let mut names = ["s10", "s2", "s02", "s1", "t", "s", "s2b", "S3", "s2a10", "s2a9"];
    names.sort_by(|one, other| naturally(one, other));
    assert_eq!(names, ["S3", "s", "s1", "s02", "s2", "s2a9", "s2a10", "s2b", "s10", "t"]);
}

#[test]
fn a_repository_with_a_copy_of_its_answers_stays_one_submission() {
    let files = [
        ("batch/Cargo.toml", ""),
        ("batch/exercises/src/fill_in.rs", FILL_IN),
        ("batch/copy/fill_in.rs", ""),
        ("batch/src/fill_in.rs", ""),
    ];
    assert_eq!(names_in(&files), ["batch"]);
    let folder = folder(&files);
    let taken = collected(&folder.path().join("batch"));
    assert_eq!(taken.answers.get("fill_in").map(String::as_str), Some(FILL_IN));
    assert_eq!(
        taken.notices,
        [
            "not used: `Cargo.toml`, `copy`, `src/fill_in.rs`. Answers alone are graded, and everything \
                else is the grader's own."
        ]
    );
}

#[test]
fn no_submission_is_found_twice() {
    let folder = folder(&[("batch/alice/src/fill_in.rs", ""), ("batch/bob/src/fill_in.rs", "")]);
    let (batch, alice) = (folder.path().join("batch"), folder.path().join("batch/alice"));
    assert_eq!(names(&[alice.clone(), batch.clone(), alice.join("../alice")]), ["alice", "bob"]);
}

#[test]
fn names_that_clash_are_numbered_and_capitals_do_not_tell_them_apart() {
    let folder = folder(&[
        ("a/alice/src/fill_in.rs", ""),
        ("b/alice/src/fill_in.rs", ""),
        ("b/Bob/src/fill_in.rs", ""),
        ("b/bob/src/fill_in.rs", ""),
    ]);
    // Where the disk itself takes the last two for the same there is one of them.
    let found = names(&[folder.path().join("a"), folder.path().join("b")]);
    assert!(found.contains(&"alice".to_owned()) && found.contains(&"alice-2".to_owned()));
    let lower: Vec<String> = found.iter().map(|name| name.to_lowercase()).collect();
    let mut distinct = lower.clone();
    distinct.dedup();
    assert_eq!(distinct.len(), lower.len(), "{found:?}");
}

#[test]
fn a_number_behind_a_name_makes_no_name_that_another_folder_has() {
    let folder = folder(&[
        ("a/ada/fill_in.rs", ""),
        ("b/ada/fill_in.rs", ""),
        ("c/ada-2/fill_in.rs", ""),
        ("c/bob/fill_in.rs", ""),
    ]);
    let found =
        find(&["a", "b", "c"].map(|name| folder.path().join(name)), has_answers).expect("found");
    let of = |path: &str| found.iter().find(|it| it.path.ends_with(path)).expect("it").name.clone();
    assert_eq!([of("a/ada"), of("b/ada"), of("c/ada-2")], ["ada", "ada-3", "ada-2"]);
}

#[cfg(unix)]
#[test]
fn names_are_harmless_and_safe_for_files() {
    let long = "x".repeat(250);
    let cases = [
        ("\u{1b}[2Jalice", "_[2Jalice".replace('[', "_")),
        ("a\nb", "a_b".to_owned()),
        ("\u{202e}ecila", "_ecila".to_owned()),
        ("a\u{200b}b", "a_b".to_owned()),
        ("a\\..\\b", "a_.._b".to_owned()),
        ("a:b*?<>|\"", "a_b______".to_owned()),
        ("...", "_".to_owned()),
        ("dot. ", "dot".to_owned()),
        ("-rf", "_-rf".to_owned()),
        ("@import", "_@import".to_owned()),
        ("=1+1", "_1+1".to_owned()),
        ("CON", "_CON".to_owned()),
        ("nul.txt", "_nul.txt".to_owned()),
        ("com1", "_com1".to_owned()),
        ("LPT¹", "_LPT¹".to_owned()),
        ("Conrad", "Conrad".to_owned()),
        ("Ana María O'Brien (2)", "Ana María O'Brien (2)".to_owned()),
        ("Zoe\u{308}", "Zoe\u{308}".to_owned()),
        ("小明", "小明".to_owned()),
        (long.as_str(), "x".repeat(100)),
    ];
    for (raw, wanted) in cases {
        let folder =
            folder(&[(&format!("batch/{raw}/fill_in.rs"), ""), ("batch/~/fill_in.rs", "")]);
        let found = names(&[folder.path().join("batch")]);
        assert!(found.contains(&wanted), "{raw:?}: {found:?}");
        assert!(found.contains(&"_~".to_owned()), "{raw:?}: {found:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_name_that_had_to_be_changed_takes_none_away() {
    let folder = folder(&[("batch/a\nb/fill_in.rs", ""), ("batch/a_b/fill_in.rs", "honest")]);
    let found = find(&[folder.path().join("batch")], has_answers).expect("found");
    let paths: Vec<(&str, bool)> =
        found.iter().map(|it| (it.name.as_str(), it.path.ends_with("a_b"))).collect();
    assert_eq!(paths, [("a_b", true), ("a_b-2", false)]);
}

#[test]
fn a_path_that_is_none_or_a_file_is_an_error_that_says_what_to_name() {
    let folder = folder(&[("fill_in.rs", "")]);
    let error = find(&[folder.path().join("nobody")], has_answers).expect_err("nothing there");
    assert!(error.ends_with("; name a submission, or a folder of submissions"), "{error}");
    let error = find(&[folder.path().join("fill_in.rs")], has_answers).expect_err("a file");
    assert!(error.ends_with("is a file; name the folder it lies in"), "{error}");
}

#[test]
fn an_archive_in_the_place_of_a_submission_cannot_be_collected() {
    for name in ["bob.rar", "bob.tar.gz", "bob.7z", "bob.TGZ", "bob.tar"] {
        let folder = folder(&[("batch/alice/fill_in.rs", ""), (&format!("batch/{name}"), "PK")]);
        let found = find(&[folder.path().join("batch")], has_answers).expect("found");
        assert_eq!(found[1].name, name);
        let error = collect(&found[1]).expect_err("an archive");
        assert!(error.starts_with(&format!("`{name}` is an archive")), "{error}");
        assert!(error.ends_with("unpack it and grade again"), "{error}");
        let error =
            find(&[folder.path().join("batch").join(name)], has_answers).expect_err("a file");
        assert!(error.ends_with("is an archive; unpack it and name the folder"), "{error}");
    }
}

#[test]
fn an_archive_beside_what_was_unpacked_from_it_is_no_submission() {
    let files = [("batch/bob.tar.gz", "PK"), ("batch/bob/exercises/src/fill_in.rs", "")];
    assert_eq!(names_in(&files), ["bob"]);
    assert_eq!(names_in(&[("batch/bob.zip", "PK"), ("batch/bob/", "")]), ["bob", "bob.zip"]);
    for (file, of_programs, of_flights) in [
        ("fill_in.rs", &["bob"][..], &["bob", "bob.zip"][..]),
        ("x/answer.toml", &["bob", "bob.zip"], &["bob"]),
    ] {
        let folder = folder(&[("batch/bob.zip", "PK"), (&format!("batch/bob/{file}"), "")]);
        for (holds, expected) in [(has_answers as Holds, of_programs), (has_flights, of_flights)] {
            let found = find(&[folder.path().join("batch")], holds).expect("found");
            let found: Vec<&str> = found.iter().map(|it| it.name.as_str()).collect();
            assert_eq!(found, expected, "{file}");
        }
    }
}

#[test]
fn a_submission_with_an_archive_and_no_answer_cannot_be_collected() {
    for place in ["work.zip", "deep/work.zip", "exercises/work.zip", "exercises/src/work.zip"] {
        let folder = folder(&[(&format!("alice/{place}"), "PK"), ("alice/readme.md", "")]);
        let alice = Submission { name: "alice".to_owned(), path: folder.path().join("alice") };
        let error = collect(&alice).expect_err("an archive");
        assert!(error.starts_with("`work.zip` is an archive"), "{error}");
    }
    let folder = folder(&[("alice/work.zip", "PK"), ("alice/work/fill_in.rs", "")]);
    assert!(collected(&folder.path().join("alice")).answers.contains_key("fill_in"));
}

#[test]
fn nothing_at_all_says_where_answers_lie() {
    let folder = folder(&[("alice/work.txt", "")]);
    let taken = collected(&folder.path().join("alice"));
    assert!(taken.answers.is_empty() && taken.refused.is_empty());
    assert_eq!(
        taken.notices,
        ["there is no answer in the submission: answers lie in `exercises/src` and are called \
          `left_perturbation.rs` and so on"]
    );
}

#[test]
fn a_submission_that_is_gone_cannot_be_collected() {
    let gone = Submission { name: "gone".to_owned(), path: "/nowhere/at/all".into() };
    let error = collect(&gone).expect_err("gone");
    assert!(error.starts_with("the submission cannot be read: "), "{error}");
}

#[test]
fn an_answer_that_is_too_large_is_refused_without_being_read() {
    let folder = folder(&[("alice/fill_in.rs", ""), ("alice/null_space.rs", "")]);
    let sized = |name: &str, size: u64| {
        let file = fs::File::create(folder.path().join("alice").join(name)).expect("a file");
        // It takes no room on the disk, and reading it would take a second and a gigabyte.
        file.set_len(size).expect("a size");
    };
    sized("fill_in.rs", 1 << 30);
    sized("null_space.rs", LARGEST);
    let taken = collected(&folder.path().join("alice"));
    assert_eq!(
        taken.refused["fill_in"],
        "`fill_in.rs` has 1073741824 bytes and may have 256000. An answer needs no such amount of \
         text: what is in it that could be computed?"
    );
    assert!(taken.answers.contains_key("null_space"));
}

#[test]
fn an_answer_that_is_no_text_is_refused_with_its_line() {
    let folder = folder(&[("alice/null_space.rs", "")]);
    fs::write(folder.path().join("alice/fill_in.rs"), b"// one\n// \xff\xfe\n").expect("a file");
    let taken = collected(&folder.path().join("alice"));
    assert_eq!(
        taken.refused["fill_in"],
        "`fill_in.rs` is no UTF-8: there is a byte 0xff in line 2. Save the file as UTF-8."
    );
    assert!(!taken.refused.contains_key("null_space"), "the others stay");
}

#[test]
fn an_answer_that_is_a_folder_is_refused() {
    let folder = folder(&[("alice/fill_in.rs/", "")]);
    let taken = collected(&folder.path().join("alice"));
    assert_eq!(taken.refused["fill_in"], "`fill_in.rs` is a folder. Hand in a file of that name.");
}

#[test]
fn what_is_not_used_is_named_and_not_at_any_length() {
    let mut files: Vec<(String, &str)> =
        (0..50).map(|n| (format!("alice/src/helper{n}.rs"), "")).collect();
    let settings = ["build.rs", ".cargo/config.toml", "rust-toolchain.toml", "target/debug/x"];
    files.extend(settings.map(|name| (format!("alice/{name}"), "")));
    files.push(("alice/src/fill_in.rs".to_owned(), ""));
    files.push(("alice/src/main.rs".to_owned(), ""));
    let files: Vec<(&str, &str)> =
        files.iter().map(|(path, text)| (path.as_str(), *text)).collect();
    let folder = folder(&files);
    assert_eq!(
        collected(&folder.path().join("alice")).notices,
        ["not used: `build.rs`, `.cargo/config.toml`, `rust-toolchain.toml`, `target` and 50 \
                more. Answers alone are graded, and everything else is the grader's own."]
    );
}

#[test]
fn an_answer_with_other_capitals_is_named_as_not_used() {
    let folder = folder(&[("alice/src/fill_in.rs", ""), ("alice/src/Null_Space.rs", "")]);
    let notices = collected(&folder.path().join("alice")).notices;
    assert!(notices[0].starts_with("not used: `src/Null_Space.rs`."), "{notices:?}");
}

#[cfg(unix)]
mod links {
    use std::os::unix::fs::symlink;
    use std::process::Command;

    use super::*;

    #[test]
    fn an_answer_that_is_a_link_is_refused_wherever_it_leads() {
        let folder = folder(&[("secret.rs", "hidden"), ("alice/null_space.rs", "")]);
        let alice = folder.path().join("alice");
        symlink("../secret.rs", alice.join("fill_in.rs")).expect("a link");
        symlink("nowhere", alice.join("stereo_gauge.rs")).expect("a dangling link");
        symlink("noise_growth.rs", alice.join("noise_growth.rs")).expect("a loop");
        symlink("/dev/zero", alice.join("outlier_rescue.rs")).expect("a device");
        let taken = collected(&alice);
        assert_eq!(taken.answers.keys().collect::<Vec<_>>(), [&"null_space"]);
        for slug in ["fill_in", "stereo_gauge", "noise_growth", "outlier_rescue"] {
            assert_eq!(
                taken.refused[slug],
                format!(
                    "`{slug}.rs` is a link, and links are not followed. Hand in the file itself."
                )
            );
        }
    }

    #[test]
    fn no_folder_on_the_way_may_be_a_link() {
        for (link, kept) in [("exercises", ""), ("exercises/src", "exercises/"), ("src", "")] {
            let folder = folder(&[
                ("solutions/src/fill_in.rs", "hidden"),
                ("solutions/fill_in.rs", "hidden"),
                (&format!("alice/{kept}"), ""),
            ]);
            let alice = folder.path().join("alice");
            let target =
                folder.path().join("solutions").join(if link == "exercises" { "" } else { "src" });
            symlink(target, alice.join(link)).expect("a link");
            let taken = collected(&alice);
            assert!(taken.answers.is_empty(), "{link}");
            let said = format!(
                "`{link}` is a link, and links are not followed: hand in the folder itself"
            );
            assert!(taken.notices.contains(&said), "{link}: {:?}", taken.notices);
        }
    }

    #[test]
    fn a_link_among_submissions_is_one_without_answers() {
        let folder = folder(&[("solutions/fill_in.rs", "hidden"), ("batch/bob/fill_in.rs", "")]);
        symlink(folder.path().join("solutions"), folder.path().join("batch/alice"))
            .expect("a link");
        symlink("loop", folder.path().join("batch/loop")).expect("a loop");
        let found = find(&[folder.path().join("batch")], has_answers).expect("found");
        let found: Vec<(&str, usize)> = found
            .iter()
            .map(|it| (it.name.as_str(), collect(it).expect("collected").answers.len()))
            .collect();
        assert_eq!(found, [("alice", 0), ("bob", 1), ("loop", 0)]);
    }

    #[test]
    fn a_folder_that_leads_to_itself_ends() {
        let folder = folder(&[("alice/", "")]);
        symlink(".", folder.path().join("alice/again")).expect("a loop");
        assert!(collected(&folder.path().join("alice")).answers.is_empty());
    }

    #[test]
    fn a_pipe_is_refused_and_nobody_waits_for_it() {
        let folder = folder(&[("alice/null_space.rs", "")]);
        let pipe = folder.path().join("alice/fill_in.rs");
        let made = Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
        assert!(made.success());
        assert_eq!(
            collected(&folder.path().join("alice")).refused["fill_in"],
            "`fill_in.rs` is a pipe or a device. Hand in an ordinary file."
        );
    }
}
