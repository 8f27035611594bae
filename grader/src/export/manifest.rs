//! Manifests for students: less than those of the book.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use toml::{Table, Value};

use super::Tree;

/// The manifest of the students' workspace.
pub struct Workspace {
    /// The manifest.
    pub text: String,
    /// The oldest Rust that compiles it.
    pub rust_version: String,
}

/// The manifest of a workspace of `members`, whose own manifests are in the tree, from that of the
/// book: what only the book needs is gone.
pub fn workspace(text: &str, members: &[&str], tree: &Tree) -> Result<Workspace, String> {
    let manifests = members.iter().map(|path| member(path, tree));
    let manifests: Vec<Table> = manifests.collect::<Result<_, _>>()?;
    let book = parsed("Cargo.toml", text)?;
    let of_book = |path: &[&str]| at(&book, path).cloned().unwrap_or_default();
    let mut workspace = Table::new();
    workspace.extend(
        at(&book, &["workspace"]).and_then(|from| from.get_key_value("resolver")).map(owned),
    );
    workspace.insert("members".to_owned(), list(members));
    workspace.insert("default-members".to_owned(), list(&["exercises"]));
    let package = of_book(&["workspace", "package"]);
    let rust_version =
        package.get("rust-version").and_then(Value::as_str).unwrap_or("1").to_owned();
    let used: BTreeSet<String> = manifests.iter().flat_map(inherited).collect();
    let mut dependencies = of_book(&["workspace", "dependencies"]);
    dependencies.retain(|name, _| used.contains(name));
    let mut sections = vec![
        ("workspace".to_owned(), workspace),
        ("workspace.package".to_owned(), package),
        ("workspace.dependencies".to_owned(), dependencies),
    ];
    let lints = of_book(&["workspace", "lints"]);
    sections.extend(tables("workspace.lints", &lints));
    let mut profile = of_book(&["profile", "dev"]);
    let packages = profile.remove("package").and_then(|packages| packages.as_table().cloned());
    sections.push(("profile.dev".to_owned(), profile));
    let mut packages = packages.unwrap_or_default();
    let names: BTreeSet<&str> = manifests.iter().filter_map(name).collect();
    packages.retain(|name, _| names.contains(name));
    sections.extend(tables("profile.dev.package", &packages));
    Ok(Workspace { text: written(&sections), rust_version })
}

/// The manifest of the library without its tests, examples and benchmarks and what only those
/// need.
pub fn library(text: &str) -> Result<String, String> {
    let mut manifest = parsed("code/Cargo.toml", text)?;
    for key in ["dev-dependencies", "example", "bench", "test"] {
        manifest.remove(key);
    }
    let section = |name: &str| Some((name.to_owned(), manifest.remove(name)?.as_table()?.clone()));
    let sections: Vec<_> = ["package", "lib", "features", "dependencies", "lints"]
        .into_iter()
        .filter_map(section)
        .collect();
    match manifest.keys().next() {
        Some(key) => Err(format!(
            "code/Cargo.toml has `{key}`, and the export does not know whether students need it; say so in \
             grader/src/export/manifest.rs"
        )),
        None => Ok(written(&sections)),
    }
}

/// Names of the exercises: the test targets, but for the one that runs the others.
pub fn exercises(text: &str) -> Result<Vec<String>, String> {
    let manifest = parsed("exercises/Cargo.toml", text)?;
    let targets = manifest.get("test").and_then(Value::as_array).cloned().unwrap_or_default();
    let names = targets.iter().filter_map(|target| target.get("name")?.as_str());
    Ok(names.filter(|name| *name != "exercises").map(str::to_owned).collect())
}

fn member(path: &str, tree: &Tree) -> Result<Table, String> {
    let path = format!("{path}/Cargo.toml");
    let bytes = tree.get(&path).map(Vec::as_slice).unwrap_or_default();
    parsed(&path, &String::from_utf8_lossy(bytes))
}

fn name(manifest: &Table) -> Option<&str> {
    manifest.get("package")?.get("name")?.as_str()
}

/// Dependencies that a manifest takes from its workspace.
fn inherited(manifest: &Table) -> Vec<String> {
    let of_workspace =
        |value: &Value| value.get("workspace").and_then(Value::as_bool) == Some(true);
    let dependencies = at(manifest, &["dependencies"]).into_iter().flatten();
    dependencies.filter(|(_, value)| of_workspace(value)).map(|(name, _)| name.clone()).collect()
}

fn parsed(path: &str, text: &str) -> Result<Table, String> {
    text.parse().map_err(|error| format!("{path} is no manifest: {error}"))
}

/// The table at a path of keys.
fn at<'a>(table: &'a Table, path: &[&str]) -> Option<&'a Table> {
    path.iter().try_fold(table, |table, key| table.get(*key)?.as_table())
}

/// The tables of a table as sections.
fn tables(path: &str, table: &Table) -> Vec<(String, Table)> {
    let section = |(key, value): (&String, &Value)| {
        Some((format!("{path}.{key}"), value.as_table()?.clone()))
    };
    table.iter().filter_map(section).collect()
}

/// Sections with an entry on each line, as people write manifests.
fn written(sections: &[(String, Table)]) -> String {
    let mut text = String::new();
    for (path, table) in sections.iter().filter(|(_, table)| !table.is_empty()) {
        let gap = if text.is_empty() { "" } else { "\n" };
        let _ = writeln!(text, "{gap}[{path}]");
        for (key, value) in table {
            let _ = writeln!(text, "{key} = {value}");
        }
    }
    text
}

fn owned((key, value): (&String, &Value)) -> (String, Value) {
    (key.clone(), value.clone())
}

fn list(words: &[&str]) -> Value {
    words.iter().map(|word| Value::from(*word)).collect::<Vec<_>>().into()
}
