//! Whether something is called as a new exercise should be.

use std::path::Path;

use super::plan::read;

/// What is called so already, in words, if anything is: a file, a dependency, or a label of the
/// book.
///
/// # Errors
///
/// A sentence when the repository cannot be read.
pub fn by(root: &Path, name: &str) -> Result<Option<String>, String> {
    if let Some(file) = file(root, name) {
        return Ok(Some(file));
    }
    for package in ["exercises", "exercises/spec", "solutions", "tests"] {
        let path = format!("{package}/Cargo.toml");
        if packages(root, &path)?.iter().any(|package| package.replace('-', "_") == name) {
            return Ok(Some(path));
        }
    }
    label(root, name)
}

/// A module, a page or a folder of that name.
fn file(root: &Path, name: &str) -> Option<String> {
    let folders = [
        "exercises/spec/src",
        "exercises/spec/src/checking",
        "solutions/src",
        "tests/src",
        "exercises/src",
        "src",
    ];
    let files = folders
        .iter()
        .flat_map(|folder| [".rs", ".md", ""].map(|ending| format!("{folder}/{name}{ending}")));
    { files }.find(|file| root.join(file).symlink_metadata().is_ok())
}

/// The name of a package and those of what it depends on.
fn packages(root: &Path, path: &str) -> Result<Vec<String>, String> {
    let manifest: toml::Table =
        read(root, path)?.parse().map_err(|error| format!("{path} is no manifest: {error}"))?;
    let tables = ["dependencies", "dev-dependencies"];
    let tables = tables.iter().filter_map(|table| manifest.get(*table)?.as_table());
    let own = manifest.get("package").and_then(|package| package.get("name")?.as_str());
    let words = tables.flat_map(toml::Table::keys).map(String::as_str).chain(own);
    Ok(words.map(str::to_owned).collect())
}

/// A page with a section of that name.
fn label(root: &Path, name: &str) -> Result<Option<String>, String> {
    let labels = [format!("#sec:{name}}}"), format!("#sec:{name} ")];
    for folder in ["src", "src/exercises", "src/instructors"] {
        let entries = root.join(folder).read_dir();
        let entries = entries.map_err(|error| format!("cannot read {folder}: {error}"))?;
        let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
        for page in names.filter(|name| name.ends_with(".md")) {
            let path = format!("{folder}/{page}");
            let text = read(root, &path)?;
            if labels.iter().any(|label| text.contains(label)) {
                return Ok(Some(format!("a label in {path}")));
            }
        }
    }
    Ok(None)
}
