//! ZIP files in the place of submissions.

use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

use grader::submission::{Collected, LARGEST, Submission, collect, find, has_answers};
use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const FILL_IN: &str = "pub fn f() {}";

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// An archive of files.
fn zip(path: &Path, files: &[(&str, &str)]) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    let mut zip = ZipWriter::new(File::create(path).expect("a file"));
    for (name, text) in files {
        zip.start_file(*name, SimpleFileOptions::default()).expect("a file");
        zip.write_all(text.as_bytes()).expect("written");
    }
    zip.finish().expect("an archive");
}

fn collected(path: &Path) -> Result<Collected, String> {
    collect(&Submission { name: "ada".to_owned(), path: path.to_owned() })
}

#[test]
fn an_archive_is_taken_for_what_is_in_it_wherever_it_lies() {
    for inside in
        ["exercises/src/fill_in.rs", "src/fill_in.rs", "fill_in.rs", "ada/exercises/src/fill_in.rs"]
    {
        for outside in ["ada.zip", "ada_17_file/work.ZIP", "ada/exercises/work.zip"] {
            let temporary = folder();
            let batch = temporary.path().join("batch");
            zip(&batch.join(outside), &[(inside, FILL_IN), ("exercises/Cargo.toml", "")]);
            zip(&batch.join("brook.zip"), &[("null_space.rs", "")]);
            let found = find(&[batch], has_answers).expect("found");
            assert_eq!(found.len(), 2);
            let taken = collect(&found[0]).expect("collected");
            assert_eq!(taken.answers.get("fill_in").map(String::as_str), Some(FILL_IN));
            assert_eq!(taken.notices, Vec::<String>::new(), "{inside} {outside}");
        }
    }
}

#[test]
fn an_archive_can_be_named_itself() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    zip(&path, &[("fill_in.rs", FILL_IN)]);
    let found = find(&[path], has_answers).expect("found");
    assert!(collect(&found[0]).expect("collected").answers.contains_key("fill_in"));
}

#[test]
fn paths_that_lead_out_write_nothing_and_are_told() {
    let temporary = folder();
    let (inside, path) = (temporary.path().join("batch"), temporary.path().join("batch/ada.zip"));
    let evil = format!("{}/absolute.rs", temporary.path().display());
    zip(
        &path,
        &[
            ("../../evil.rs", "x"),
            (&evil, "x"),
            ("a/../../../evil2.rs", "x"),
            ("fill_in.rs", FILL_IN),
        ],
    );
    let taken = collected(&path).expect("collected");
    assert!(taken.answers.contains_key("fill_in"));
    assert!(
        taken.notices.iter().any(|it| it.contains("leads out of the folder")),
        "{:?}",
        taken.notices
    );
    let entries = |path: &Path| fs::read_dir(path).expect("a folder").count();
    assert_eq!((entries(temporary.path()), entries(&inside)), (1, 1));
    assert!(!Path::new("/tmp/evil.rs").exists() && !Path::new("/tmp/evil2.rs").exists());
}

#[test]
fn a_bomb_takes_no_more_than_is_read_of_any_file() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    let mut zip = ZipWriter::new(File::create(&path).expect("a file"));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let zeros = vec![0; 1 << 20];
    for name in ["fill_in.rs", "bomb.rs", "huge.bin"] {
        zip.start_file(name, options).expect("a file");
        (0..300).for_each(|_| zip.write_all(&zeros).expect("written"));
    }
    zip.finish().expect("an archive");
    let taken = collected(&path).expect("collected");
    let why = taken.refused.get("fill_in").expect("refused");
    assert!(why.contains(&format!("has {} bytes and may have {LARGEST}", LARGEST + 1)), "{why}");
}

#[test]
fn an_archive_of_too_many_files_is_not_opened() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    let mut bytes = Vec::new();
    (0..60_001).for_each(|_| bytes.extend(b"PK\x01\x02                       "));
    fs::write(&path, bytes).expect("written");
    assert_holds_too_many(&path, "60000 files");
}

#[test]
fn an_archive_whose_list_ends_too_often_is_not_opened() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    fs::write(&path, b"PK\x05\x06\0\0s".repeat(33)).expect("written");
    assert_holds_too_many(&path, "32 archives");
    zip(&path, &[("fill_in.rs", FILL_IN), ("inner.zip", &"PK\x05\x06".repeat(31))]);
    assert!(collected(&path).expect("collected").answers.contains_key("fill_in"));
}

#[test]
fn an_archive_that_says_it_has_too_many_files_is_not_opened() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    zip(&path, &[("fill_in.rs", FILL_IN)]);
    let mut bytes = fs::read(&path).expect("an archive");
    let end = bytes.windows(4).rposition(|four| four == b"PK\x05\x06").expect("an end");
    let stated = [b"PK\x06\x06".as_slice(), &[0; 20], &60_001_u64.to_le_bytes(), &[0; 24]].concat();
    bytes.splice(end..end, stated);
    fs::write(&path, bytes).expect("written");
    assert_holds_too_many(&path, "60000 files");
}

fn assert_holds_too_many(path: &Path, what: &str) {
    let error = collected(path).expect_err("too many");
    let expected = format!("`ada.zip` holds more than {what}; ask for a ZIP file");
    assert!(error.starts_with(&expected), "{error}");
}

#[test]
fn a_link_in_an_archive_is_left_there() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    let mut zip = ZipWriter::new(File::create(&path).expect("a file"));
    zip.add_symlink("fill_in.rs", "/etc/passwd", SimpleFileOptions::default()).expect("a link");
    zip.add_symlink("exercises", "/", SimpleFileOptions::default()).expect("a link");
    zip.finish().expect("an archive");
    let taken = collected(&path).expect("collected");
    assert!(taken.answers.is_empty());
    assert!(
        taken.notices[0].ends_with("it is a link, and links are not followed"),
        "{:?}",
        taken.notices
    );
}

#[test]
fn words_beside_an_archive_are_read() {
    let words = |text: &str| format!("## fill_in\n\n{text}\n");
    for (inside, beside, read, unread) in [
        (None, Some("Four."), "Four.", false),
        (Some("Four."), None, "Four.", false),
        (Some("Four."), Some("Four."), "Four.", false),
        (Some("Four."), Some("Five."), "Four.", true),
    ] {
        for place in ["answers.md", "exercises/answers.md"] {
            let temporary = folder();
            let ada = temporary.path().join("ada");
            let inside = inside.map(words);
            let mut files = vec![("exercises/src/fill_in.rs", FILL_IN)];
            files.extend(inside.as_deref().map(|text| ("exercises/answers.md", text)));
            zip(&ada.join("exercises.zip"), &files);
            if let Some(text) = beside {
                fs::create_dir_all(ada.join("exercises")).expect("a folder");
                fs::write(ada.join(place), words(text)).expect("written");
            }
            let taken = collected(&ada).expect("collected");
            assert!(taken.answers.contains_key("fill_in"));
            assert_eq!((taken.words["fill_in"].as_str(), taken.unread), (read, unread), "{place}");
            assert_eq!(taken.notices.len(), usize::from(unread), "{:?}", taken.notices);
        }
    }
}

#[test]
fn words_in_an_archive_under_another_name_are_told_and_open() {
    for place in ["docs/answers.md", "exercises/answers (1).md", "exercises/Answers.md"] {
        let temporary = folder();
        let path = temporary.path().join("ada.zip");
        let files = [("exercises/src/fill_in.rs", FILL_IN), (place, "## fill_in\n\nFour.\n")];
        zip(&path, &files);
        assert!(collected(&path).expect("collected").unread, "{place}");
    }
}

#[test]
fn words_that_stay_in_an_archive_are_open() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    zip(&path, &[("fill_in.rs", FILL_IN), ("../answers.md", "## fill_in\n\nFour.\n")]);
    assert!(collected(&path).expect("collected").unread);
    zip(&path, &[("fill_in.rs", FILL_IN), ("../help.rs", "")]);
    assert!(!collected(&path).expect("collected").unread);
    let mut zip = ZipWriter::new(File::create(&path).expect("a file"));
    zip.add_symlink("answers.md", "/etc/passwd", SimpleFileOptions::default()).expect("a link");
    zip.finish().expect("an archive");
    assert!(collected(&path).expect("collected").unread);
}

#[test]
fn what_cannot_be_unpacked_is_left_to_a_person() {
    let temporary = folder();
    let (path, inner) = (temporary.path().join("ada.zip"), temporary.path().join("brook.zip"));
    for bytes in [&b"PK"[..], b"", b"PK\x03\x04 and no more", &[0; 10_000]] {
        fs::write(&path, bytes).expect("written");
        let error = collected(&path).expect_err("no archive");
        assert!(error.starts_with("`ada.zip` is an archive that cannot be unpacked ("), "{error}");
    }
    zip(&inner, &[("work.tar.gz", ""), ("readme.md", "")]);
    let error = collected(&inner).expect_err("an archive in an archive");
    assert!(error.starts_with("`brook.zip` holds another archive, `work.tar.gz`"), "{error}");
    zip(&temporary.path().join("cem/one.zip"), &[("fill_in.rs", FILL_IN)]);
    zip(&temporary.path().join("cem/two.zip"), &[("fill_in.rs", FILL_IN)]);
    let error = collected(&temporary.path().join("cem")).expect_err("two archives");
    assert!(error.starts_with("there are several archives, `one.zip` and `two.zip`"), "{error}");
}

#[test]
fn two_files_of_one_name_are_not_mixed() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    zip(&path, &[("fill_in.rs", FILL_IN), ("./fill_in.rs", "another")]);
    assert_keeps_back(&path, "./fill_in.rs", "another file has its name");
    zip(&path, &[("fill_in.rs", FILL_IN), ("help.rs", ""), ("./help.rs", "another")]);
    let taken = collected(&path).expect("collected");
    assert!(taken.answers.contains_key("fill_in"));
    assert!(taken.notices[0].ends_with("another file has its name"), "{:?}", taken.notices);
}

/// That nothing is graded because an answer cannot be taken out.
fn assert_keeps_back(path: &Path, name: &str, why: &str) {
    let error = collected(path).expect_err("an answer is kept back");
    let expected = format!("`ada.zip` holds `{name}`, which cannot be taken out ({why}");
    assert!(error.starts_with(&expected), "{error}");
}

#[test]
fn answers_are_taken_before_the_sources_of_dependencies() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    let vendored: Vec<String> = (0..600).map(|file| format!("vendor/{file}/lib.rs")).collect();
    let mut files: Vec<(&str, &str)> = vendored.iter().map(|path| (path.as_str(), "")).collect();
    files.extend([("exercises/src/fill_in.rs", FILL_IN), ("Cargo.toml", "")]);
    zip(&path, &files);
    assert_eq!(collected(&path).expect("collected").answers["fill_in"], FILL_IN);
    let copies: Vec<String> = (0..600).map(|copy| format!("{copy}/fill_in.rs")).collect();
    zip(&path, &copies.iter().map(|path| (path.as_str(), FILL_IN)).collect::<Vec<_>>());
    assert_keeps_back(&path, "500/fill_in.rs", "there are too many files of its kind");
}

#[test]
fn an_answer_under_a_password_or_packed_in_an_unknown_way_is_no_zero() {
    let temporary = folder();
    let path = temporary.path().join("ada.zip");
    // Where flags and method of compression stand behind the beginning of each of the two entries of a file.
    for (behind, value, why) in
        [(0, 1, "Password required"), (2, 14, "Compression method not supported")]
    {
        zip(&path, &[("fill_in.rs", FILL_IN)]);
        let mut bytes = fs::read(&path).expect("an archive");
        for (begin, flags) in [(b"PK\x03\x04", 6), (b"PK\x01\x02", 8)] {
            let at = bytes.windows(4).position(|four| four == begin).expect("an entry");
            bytes[at + flags + behind] |= value;
            bytes[at + flags + behind] &= 0xf7 | value;
        }
        fs::write(&path, bytes).expect("written");
        let error = collected(&path).expect_err(why);
        assert!(error.contains("`fill_in.rs`, which cannot be taken out"), "{error}");
        assert!(error.to_lowercase().contains(&why.to_lowercase()), "{error}");
    }
}

#[cfg(unix)]
#[test]
fn a_link_to_an_archive_is_not_followed() {
    let temporary = folder();
    let (secret, batch) = (temporary.path().join("secret.zip"), temporary.path().join("batch"));
    zip(&secret, &[("fill_in.rs", FILL_IN)]);
    fs::create_dir_all(batch.join("ada")).expect("a folder");
    std::os::unix::fs::symlink(&secret, batch.join("ada/work.zip")).expect("a link");
    assert!(collected(&batch.join("ada")).expect("collected").answers.is_empty());
}
