//! Which files students get, and what is in them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::manifest;

/// Files by their path, with `/` between folders.
pub type Tree = BTreeMap<String, Vec<u8>>;

/// Everything that is exported, but for the lock file and the sources of dependencies. Answers are
/// the newest skeletons, whatever lies in `exercises/src`.
///
/// # Errors
///
/// A sentence when a file is missing or a skeleton is none.
pub fn tree(root: &Path, vendored: bool) -> Result<Tree, String> {
    let mut tree = Tree::new();
    for path in ["LICENSE-APACHE", "LICENSE-MIT", "rustfmt.toml"] {
        copy(root, path, &mut tree)?;
    }
    library(root, &mut tree)?;
    let exercises = exercises(root, &mut tree)?;
    let members = ["code", "exercises", "exercises/library", "exercises/runner", "exercises/spec"];
    let workspace = manifest::workspace(&text(root, "Cargo.toml")?, &members, &tree)?;
    let rust = workspace.rust_version;
    tree.insert("Cargo.toml".to_owned(), workspace.text.into_bytes());
    let first = exercises.first().ok_or("exercises/Cargo.toml has no test targets")?;
    for (path, text) in templates(vendored) {
        let text = text.replace("{rust}", &rust).replace("{exercise}", first);
        tree.insert(path.to_owned(), text.into_bytes());
    }
    Ok(tree)
}

/// What is written for students alone.
fn templates(vendored: bool) -> [(&'static str, String); 5] {
    let network = match vendored {
        true => "It needs no network: what else it is made of is in `vendor`.",
        false => "It fetches what else it is made of; after that no network is needed.",
    };
    [
        ("README.md", include_str!("../../student/README.md").replace("{network}", network)),
        (".gitignore", include_str!("../../student/gitignore").to_owned()),
        (".gitattributes", include_str!("../../student/gitattributes").to_owned()),
        (".github/workflows/exercises.yml", include_str!("../../student/github.yml").to_owned()),
        (".gitlab-ci.yml", include_str!("../../student/gitlab.yml").to_owned()),
    ]
}

fn library(root: &Path, tree: &mut Tree) -> Result<(), String> {
    folder(root, "code/src", tree)?;
    let manifest = manifest::library(&text(root, "code/Cargo.toml")?)?;
    tree.insert("code/Cargo.toml".to_owned(), manifest.into_bytes());
    Ok(())
}

/// The exercises, whose names come back in the order of their manifest.
fn exercises(root: &Path, tree: &mut Tree) -> Result<Vec<String>, String> {
    for path in ["Cargo.toml", "answers.md", "src/main.rs", "tests/exercises.rs"] {
        copy(root, &format!("exercises/{path}"), tree)?;
    }
    for package in ["library", "runner", "spec"] {
        copy(root, &format!("exercises/{package}/Cargo.toml"), tree)?;
        folder(root, &format!("exercises/{package}/src"), tree)?;
    }
    let names = manifest::exercises(&text(root, "exercises/Cargo.toml")?)?;
    for name in &names {
        copy(root, &format!("exercises/tests/{name}.rs"), tree)?;
        let skeleton = skeletons(root, name, tree)?;
        tree.insert(format!("exercises/src/{name}.rs"), skeleton);
    }
    Ok(names)
}

/// The skeletons of all editions, since an update of an answer asks for what it began with. The
/// newest comes back.
fn skeletons(root: &Path, name: &str, tree: &mut Tree) -> Result<Vec<u8>, String> {
    let (_, newest) = newest_skeleton(root, name)?;
    for edition in editions(root)? {
        let path = skeleton(edition, name);
        if root.join(&path).is_file() {
            copy(root, &path, tree)?;
        }
    }
    let newest_text = text(root, &newest)?;
    let (functions, open) = (count(&newest_text, "pub fn "), count(&newest_text, "todo!("));
    if functions == 0 || open < functions {
        return Err(format!(
            "{newest} has {functions} public functions and {open} times `todo!(`; a skeleton leaves \
             every function open, so mend it before students get it"
        ));
    }
    Ok(newest_text.into_bytes())
}

/// Where a skeleton lies.
fn skeleton(edition: u32, name: &str) -> String {
    format!("exercises/skeletons/{edition}/{name}.rs")
}

/// The editions of the skeletons, the newest last.
///
/// # Errors
///
/// A sentence when they cannot be read.
pub fn editions(root: &Path) -> Result<Vec<u32>, String> {
    let path = "exercises/skeletons";
    let entries =
        fs::read_dir(root.join(path)).map_err(|error| format!("cannot read {path}: {error}"))?;
    let mut editions: Vec<u32> =
        entries.flatten().filter_map(|entry| entry.file_name().to_str()?.parse().ok()).collect();
    editions.sort_unstable();
    Ok(editions)
}

/// The newest edition that has a skeleton of an exercise, and its path.
///
/// # Errors
///
/// A sentence when there is none.
pub fn newest_skeleton(root: &Path, name: &str) -> Result<(u32, String), String> {
    let there = editions(root)?.into_iter().rev().map(|edition| (edition, skeleton(edition, name)));
    let newest = { there }.find(|(_, path)| root.join(path).is_file());
    newest.ok_or_else(|| format!("exercises/skeletons has no skeleton of `{name}`"))
}

/// The texts of an exercise's skeletons of all editions.
///
/// # Errors
///
/// A sentence when they cannot be read.
pub fn every_skeleton(root: &Path, name: &str) -> Result<Vec<String>, String> {
    let paths = editions(root)?.into_iter().map(|edition| skeleton(edition, name));
    paths.filter(|path| root.join(path).is_file()).map(|path| text(root, &path)).collect()
}

fn count(text: &str, what: &str) -> usize {
    text.matches(what).count()
}

/// The text of a file of the repository.
pub(super) fn text(root: &Path, path: &str) -> Result<String, String> {
    let path = root.join(path);
    fs::read_to_string(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))
}

fn copy(root: &Path, path: &str, tree: &mut Tree) -> Result<(), String> {
    tree.insert(path.to_owned(), text(root, path)?.into_bytes());
    Ok(())
}

/// The Rust and Markdown files of a folder and those below it.
fn folder(root: &Path, path: &str, tree: &mut Tree) -> Result<(), String> {
    for (path, is_folder) in entries(root, path)? {
        let wanted = path.ends_with(".rs") || path.ends_with(".md");
        match is_folder {
            true => folder(root, &path, tree)?,
            false if wanted => copy(root, &path, tree)?,
            false => {}
        }
    }
    Ok(())
}

/// Files and folders in a folder, with whether they are folders. Links and hidden files are left
/// out.
pub(super) fn entries(root: &Path, path: &str) -> Result<Vec<(String, bool)>, String> {
    let cannot = |error| format!("cannot read {path}: {error}");
    let mut found = Vec::new();
    for entry in fs::read_dir(root.join(path)).map_err(cannot)? {
        let entry = entry.map_err(cannot)?;
        let kind = entry.file_type().map_err(cannot)?;
        let name = entry.file_name().into_string();
        let name = name.map_err(|name| format!("{path}: {} is no UTF-8", name.display()))?;
        if !name.starts_with('.') && (kind.is_dir() || kind.is_file()) {
            found.push((format!("{path}/{name}"), kind.is_dir()));
        }
    }
    found.sort_unstable();
    Ok(found)
}
