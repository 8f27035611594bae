//! What students get and what they do not.

mod folders;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use folders::root;
use grader::export::{Tree, export_from, leaks, tree};
use tempfile::TempDir;

/// A copy of what an export reads, to be changed.
fn copy() -> TempDir {
    folders::copy(&[
        "code",
        "exercises",
        "solutions",
        "tests/src",
        "tests/rubrics",
        "Cargo.toml",
        "Cargo.lock",
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "rustfmt.toml",
    ])
}

/// Every file of a folder.
fn read(folder: &Path) -> Tree {
    fn add(folder: &Path, path: &str, tree: &mut Tree) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let entry = entry.expect("an entry");
            let name = entry.file_name().into_string().expect("UTF-8");
            let path = if path.is_empty() { name } else { format!("{path}/{name}") };
            match entry.path().is_dir() {
                true => add(&entry.path(), &path, tree),
                false => drop(tree.insert(path, fs::read(entry.path()).expect("a file"))),
            }
        }
    }
    let mut tree = Tree::new();
    add(folder, "", &mut tree);
    tree
}

fn exported(vendor: bool) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path().join("students");
    export_from(&root(), &dir, vendor).expect("exported");
    (folder, dir)
}

/// Letters and digits alone, so that a line is found however it is indented or broken.
fn telling(line: &str) -> String {
    line.chars().filter(|letter| letter.is_alphanumeric()).collect()
}

fn lines(folders: &[&str]) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for folder in folders {
        for (path, bytes) in read(&root().join(folder)) {
            for line in String::from_utf8_lossy(&bytes).lines() {
                found.entry(telling(line)).or_insert(format!("{folder}/{path}: {line}"));
            }
        }
    }
    found
}

#[test]
fn no_answer_hidden_check_wrong_answer_or_rubric_is_in_it() {
    let (_folder, dir) = exported(false);
    let exported = read(&dir);
    assert_eq!(leaks(&root(), &exported), Ok(Vec::new()));
    // The same question asked in another way: line by line, in every file.
    let known = lines(&["exercises/skeletons", "exercises/spec/src", "code/src"]);
    let mut secret = lines(&["solutions/src", "tests/src", "tests/rubrics"]);
    secret.retain(|line, place| {
        line.len() >= 12 && !known.contains_key(line) && !place.contains(": # ")
    });
    assert!(secret.len() > 1000, "only {} lines are secret", secret.len());
    for (path, bytes) in &exported {
        for line in String::from_utf8_lossy(bytes).lines() {
            let plain = line.trim_start().starts_with("use ") || line.starts_with('#');
            let place = secret.get(&telling(line)).filter(|_| !plain);
            assert_eq!(place, None, "{path}: {line}");
        }
    }
    let names = ["solutions", "book-tests", "misconceptions", "rubric", "hidden_checks", "grader"];
    for path in exported.keys() {
        assert!(names.iter().all(|name| !path.contains(name)), "{path}");
    }
}

#[test]
fn what_students_must_not_have_is_found_wherever_it_is_put() {
    let root = root();
    let clean = tree(&root, false).expect("a tree");
    assert_eq!(leaks(&root, &clean), Ok(Vec::new()));
    let solution = fs::read(root.join("solutions/src/fill_in.rs")).expect("an answer");
    let rubric = fs::read_to_string(root.join("tests/rubrics/fill_in.md")).expect("a rubric");
    let rubric = rubric.lines().find(|line| line.starts_with("**Full marks.**")).expect("marks");
    let hidden = b"let hidden = book_tests::hidden_checks(\"fill_in\", 1);".to_vec();
    let plants: [(&str, Vec<u8>); 6] = [
        ("exercises/src/fill_in.rs", solution.clone()),
        ("exercises/runner/src/old.rs", solution),
        ("exercises/answers.md", rubric.as_bytes().to_vec()),
        ("code/src/lib.rs", hidden),
        ("solutions/Cargo.toml", Vec::new()),
        ("tests/rubrics/fill_in.md", Vec::new()),
    ];
    for (path, bytes) in plants {
        let mut tree = clean.clone();
        tree.insert(path.to_owned(), bytes);
        let found = leaks(&root, &tree).expect("a search");
        assert!(!found.is_empty(), "{path} is not noticed");
        assert!(found.iter().all(|sentence| sentence.starts_with(path)), "{found:?}");
    }
}

#[test]
fn an_export_that_would_betray_an_answer_writes_nothing() {
    let copy = copy();
    let answer = fs::read(copy.path().join("solutions/src/fill_in.rs")).expect("an answer");
    fs::write(copy.path().join("exercises/answers.md"), answer).expect("written");
    let dir = copy.path().join("students");
    let error = export_from(copy.path(), &dir, false).expect_err("betrayed");
    assert!(
        error.contains("exercises/answers.md has a line of solutions/src/fill_in.rs"),
        "{error}"
    );
    assert!(!dir.exists());
}

#[test]
fn answers_are_skeletons_even_where_somebody_has_worked() {
    let copy = copy();
    let skeletons = copy.path().join("exercises/skeletons");
    fs::create_dir(skeletons.join("3")).expect("a folder");
    let first = fs::read_to_string(skeletons.join("1/fill_in.rs")).expect("a skeleton");
    let third = first.replace("Edition 1.", "Edition 3.");
    fs::write(skeletons.join("3/fill_in.rs"), &third).expect("written");
    for name in ["fill_in", "null_space"] {
        let answer = copy.path().join(format!("solutions/src/{name}.rs"));
        fs::copy(answer, copy.path().join(format!("exercises/src/{name}.rs"))).expect("copied");
    }
    fs::create_dir_all(copy.path().join("exercises/.progress/former")).expect("a folder");
    fs::write(copy.path().join("exercises/src/mine.rs"), "fn mine() {}").expect("written");
    let tree = tree(copy.path(), false).expect("a tree");
    let text = |path: &str| String::from_utf8_lossy(&tree[path]).into_owned();
    assert_eq!(text("exercises/src/fill_in.rs"), third);
    assert_eq!(text("exercises/skeletons/1/fill_in.rs"), first, "an update needs it");
    assert_eq!(text("exercises/skeletons/3/fill_in.rs"), third);
    assert_eq!(text("exercises/src/null_space.rs"), text("exercises/skeletons/2/null_space.rs"));
    assert!(tree.keys().all(|path| !path.contains("mine") && !path.contains(".progress")));
}

#[test]
fn a_skeleton_that_holds_an_answer_is_none() {
    let copy = copy();
    let answer = copy.path().join("solutions/src/null_space.rs");
    fs::copy(answer, copy.path().join("exercises/skeletons/2/null_space.rs")).expect("copied");
    let error = tree(copy.path(), false).expect_err("an answer");
    assert!(error.contains("skeletons/2/null_space.rs") && error.contains("todo!"), "{error}");
}

#[test]
fn a_folder_that_is_not_empty_is_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let mine = folder.path().join("mine.txt");
    fs::write(&mine, "mine").expect("written");
    let error = export_from(&root(), folder.path(), false).expect_err("not empty");
    assert!(error.contains("is not empty"), "{error}");
    assert_eq!(read(folder.path()).len(), 1);
    let error = export_from(&root(), &mine, false).expect_err("a file");
    assert!(error.contains("cannot export to"), "{error}");
    assert_eq!(fs::read_to_string(&mine).expect("a file"), "mine");
}

#[test]
fn two_exports_are_the_same_bytes_and_write_nowhere_else() {
    let (first, second) = (exported(false), exported(false));
    assert!(read(&first.1) == read(&second.1));
    let beside = fs::read_dir(first.0.path()).expect("a folder").count();
    assert_eq!(beside, 1, "there is something beside the export");
}

#[test]
fn an_export_that_fails_leaves_an_empty_folder_empty() {
    let copy = copy();
    let manifest = copy.path().join("code/Cargo.toml");
    let text = fs::read_to_string(&manifest).expect("a manifest");
    let broken = text.replace("[dependencies]", "[dependencies]\nnothing.workspace = true");
    fs::write(&manifest, broken).expect("written");
    let dir = copy.path().join("students");
    let error = export_from(copy.path(), &dir, false).expect_err("no such dependency");
    assert!(error.contains("lock file") && error.contains("nothing"), "{error}");
    assert!(!dir.exists(), "it was not there before");
    fs::create_dir(&dir).expect("a folder");
    export_from(copy.path(), &dir, false).expect_err("no such dependency");
    assert!(read(&dir).is_empty());
}

/// Packages of a lock file: name, version, digest.
fn packages(lock: &str) -> BTreeSet<[String; 3]> {
    let lock: toml::Table = lock.parse().expect("a lock file");
    let packages = lock["package"].as_array().expect("packages").iter();
    let word = |package: &toml::Value, key: &str| {
        package.get(key).and_then(toml::Value::as_str).unwrap_or_default().to_owned()
    };
    packages.map(|package| ["name", "version", "checksum"].map(|key| word(package, key))).collect()
}

#[test]
fn the_lock_file_has_what_is_needed_in_the_versions_of_the_book() {
    let (_folder, dir) = exported(false);
    let lock = |path: PathBuf| packages(&fs::read_to_string(path).expect("a lock file"));
    let (students, book) = (lock(dir.join("Cargo.lock")), lock(root().join("Cargo.lock")));
    assert!(students.is_subset(&book));
    let names: BTreeSet<&str> = students.iter().map(|[name, ..]| name.as_str()).collect();
    for name in ["vislam", "exercises", "exercise-spec", "exercise-runner", "nalgebra", "notify"] {
        assert!(names.contains(name), "{name} is missing");
    }
    for name in ["press", "wasmtime", "criterion", "book-tests", "solutions", "dashu-float"] {
        assert!(!names.contains(name), "{name} is not needed");
    }
}

#[test]
fn manifests_name_only_what_is_there() {
    let tree = tree(&root(), false).expect("a tree");
    let table = |path: &str| -> toml::Table {
        String::from_utf8_lossy(&tree[path]).parse().expect("a manifest")
    };
    let workspace = &table("Cargo.toml")["workspace"];
    for member in workspace["members"].as_array().expect("members") {
        let manifest = format!("{}/Cargo.toml", member.as_str().expect("a path"));
        assert!(tree.contains_key(&manifest), "{manifest}");
    }
    let library = table("code/Cargo.toml");
    for key in ["dev-dependencies", "example", "bench"] {
        assert!(!library.contains_key(key), "{key}");
    }
    assert!(!workspace["dependencies"].as_table().expect("a table").contains_key("approx"));
    let ours = |path: &&String| path.starts_with("code/") && !path.starts_with("code/src/");
    assert_eq!(tree.keys().filter(ours).collect::<Vec<_>>(), ["code/Cargo.toml"]);
}

#[test]
fn students_are_told_what_to_run_and_the_files_for_services_hold_no_secret() {
    let tree = tree(&root(), true).expect("a tree");
    let text = |path: &str| String::from_utf8_lossy(&tree[path]).into_owned();
    let readme = text("README.md");
    for word in ["cargo test -p exercises ", "-- hint ", "-- watch", "-- update", "answers.md"] {
        assert!(readme.contains(word), "{word}");
    }
    assert!(tree.values().all(|bytes| !String::from_utf8_lossy(bytes).contains("{exercise}")));
    assert!(!readme.contains('{'), "a placeholder is left");
    let github = text(".github/workflows/exercises.yml");
    for system in ["ubuntu-latest", "macos-latest", "windows-latest"] {
        assert!(github.contains(system), "{system}");
    }
    for service in [github, text(".gitlab-ci.yml")] {
        assert!(!service.contains("secrets.") && service.contains("-- --list"), "{service}");
    }
    assert!(text(".gitattributes").contains("/vendor/** -text"), "digests would not fit");
}

/// Runs cargo in a folder as a student who has no network and has never fetched anything.
fn cargo(dir: &Path, home: &Path, arguments: &[&str]) -> Output {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    for (name, _) in std::env::vars_os() {
        if name.to_string_lossy().starts_with("CARGO") {
            cargo.env_remove(name);
        }
    }
    cargo.env("CARGO_HOME", home).args(arguments).current_dir(dir).output().expect("cargo runs")
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said).into_owned()).concat()
}

#[test]
#[ignore = "compiles what students get, with all it depends on"]
fn what_is_exported_builds_offline_and_knows_an_answer_from_a_skeleton() {
    let (folder, dir) = exported(true);
    let (_second, again) = exported(true);
    assert!(read(&dir) == read(&again), "two exports differ");
    let home = folder.path().join("home");
    fs::create_dir(&home).expect("a folder");
    let cargo = |arguments: &[&str]| cargo(&dir, &home, arguments);
    let test = ["test", "--offline", "--locked", "--package", "exercises", "fill_in"];
    let skeleton = cargo(&test);
    assert!(
        !skeleton.status.success() && said(&skeleton).contains("not written yet: "),
        "{}",
        said(&skeleton)
    );
    assert!(!said(&skeleton).contains("warning"), "{}", said(&skeleton));
    let answer = dir.join("exercises/src/fill_in.rs");
    fs::copy(root().join("solutions/src/fill_in.rs"), &answer).expect("copied");
    let solved = cargo(&test);
    assert!(solved.status.success(), "{}", said(&solved));
    let run = ["run", "--quiet", "--offline", "--package", "exercises", "--"];
    let listed = cargo(&run);
    let one = format!("1 of {} solved", exercise_spec::EXERCISES.len());
    assert!(said(&listed).contains(&one), "{}", said(&listed));
    let hint = cargo(&[&run[..], &["hint", "fill_in"]].concat());
    assert!(said(&hint).contains("Hint 1 of "), "{}", said(&hint));
    let listed = cargo(&["test", "--offline", "--package", "exercises", "--", "--list"]);
    assert!(said(&listed).contains("null_space::"), "{}", said(&listed));
}
