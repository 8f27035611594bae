//! Runs the program that computes what the chapters show, for those chapters whose inputs changed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, Result, bail};
use serde::Deserialize;
use sha2::{Digest, Sha256};

use crate::files;
use crate::records::{Made, hex};
use crate::settings::{Layout, Settings};

/// The folder of the library that the exhibits show, below the root.
const LIBRARY: &str = "code/src";
/// The folder of the exhibits.
const EXHIBITS: &str = "exhibits/src";

/// The chapters that have exhibits and those of them that must be computed again.
pub struct Program<'a> {
    layout: &'a Layout,
    package: String,
    /// Every chapter with exhibits, and the digest of what they are computed from.
    chapters: BTreeMap<String, String>,
}

impl<'a> Program<'a> {
    /// Looks at the sources of the exhibits.
    pub fn new(layout: &'a Layout, settings: &Settings) -> Result<Program<'a>> {
        let package = settings.exhibits_package.clone();
        let chapters = match package.is_empty() {
            true => BTreeMap::new(),
            false => inputs(&layout.root)?,
        };
        Ok(Program { layout, package, chapters })
    }

    /// The chapters whose exhibits are older than their inputs.
    pub fn stale(&self) -> Result<Vec<&str>> {
        let mut stale = Vec::new();
        for (slug, digest) in &self.chapters {
            let folder = self.layout.exhibits().join(slug);
            let made = files::read_if_there(&folder.join("inputs"))?;
            if made.as_ref() != Some(digest) || !folder.join("exhibits.json").is_file() {
                stale.push(slug.as_str());
            }
        }
        Ok(stale)
    }

    /// Removes what was computed for chapters that are no more.
    pub fn forget_others(&self) -> Result<()> {
        if self.package.is_empty() {
            return Ok(());
        }
        let folder = self.layout.exhibits();
        let slugs: BTreeSet<String> = files::below(&folder)?
            .iter()
            .filter_map(|path| Some(path.components().next()?.as_os_str().to_str()?.to_owned()))
            .filter(|slug| !self.chapters.contains_key(slug))
            .collect();
        slugs.iter().try_for_each(|slug| files::remove(&folder.join(slug)))
    }

    /// Compiles the program; gives where it lies. It is not asked for by its package, because its dependencies
    /// would then have fewer features than `cargo test` gives them, and be compiled once more.
    pub fn compile(&self) -> Result<PathBuf> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let output = Command::new(cargo)
            .args([
                "build",
                "--quiet",
                "--bin",
                &self.package,
                "--message-format",
                "json-render-diagnostics",
            ])
            .current_dir(&self.layout.root)
            .output()
            .context("cannot start cargo to compile the exhibits")?;
        if !output.status.success() {
            bail!("the exhibits do not compile:\n{}", String::from_utf8_lossy(&output.stderr));
        }
        let messages = String::from_utf8_lossy(&output.stdout).into_owned();
        let program = messages
            .lines()
            .rev()
            .find_map(|line| serde_json::from_str::<Artifact>(line).ok()?.executable);
        program.with_context(|| format!("the package {} has no program", self.package))
    }

    /// Computes the exhibits of one chapter.
    pub fn run(&self, program: &Path, slug: &str) -> Result<()> {
        let folder = self.layout.exhibits().join(slug);
        let fresh = self.layout.work().join(format!("new-{slug}"));
        files::remove(&fresh)?;
        files::write(&fresh.join("inputs"), self.chapters[slug].as_bytes())?;
        self.call(program, &["chapter".as_ref(), slug.as_ref(), fresh.as_os_str()])?;
        std::fs::create_dir_all(self.layout.exhibits())?;
        files::replace_folder(&fresh, &folder)
    }

    /// Makes a record.
    ///
    /// # Errors
    /// [`DataAbsent`] when it is made from data that is not on this machine; others when something is wrong.
    pub fn record(&self, program: &Path, name: &str) -> Result<Made> {
        let output = self.call(program, &["record".as_ref(), name.as_ref()])?;
        serde_json::from_slice(&output.stdout)
            .with_context(|| format!("the program printed no record of {name}"))
    }

    fn call(&self, program: &Path, arguments: &[&std::ffi::OsStr]) -> Result<Output> {
        let output = Command::new(program)
            .args(arguments)
            .current_dir(&self.layout.root)
            .output()
            .with_context(|| format!("cannot start {}", program.display()))?;
        if output.status.success() {
            return Ok(output);
        }
        let reason = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        if output.status.code() == Some(DATA_ABSENT) {
            return Err(DataAbsent(reason).into());
        }
        bail!("the exhibits stopped:\n{reason}")
    }
}

/// What the program of the exhibits ends with when the data of a record is not there.
const DATA_ABSENT: i32 = 3;

/// A record is made from data that is not on this machine.
#[derive(Debug)]
pub struct DataAbsent(String);

impl std::fmt::Display for DataAbsent {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for DataAbsent {}

#[derive(Deserialize)]
struct Artifact {
    executable: Option<PathBuf>,
}

/// For each chapter with exhibits, a digest of all that they are computed from.
///
/// A chapter depends on its own file, on the harness that all share, on the locked dependencies, and on the
/// library modules that its text names, directly or through another module. A name in a comment counts as
/// well; that costs a run too many and never one too few.
fn inputs(root: &Path) -> Result<BTreeMap<String, String>> {
    let library = modules(&root.join(LIBRARY))?;
    let exhibits = modules(&root.join(EXHIBITS))?;
    let chapters: Vec<&String> =
        exhibits.keys().filter(|slug| root.join(format!("src/{slug}.md")).is_file()).collect();
    let mut common = String::new();
    for file in ["Cargo.lock", "Cargo.toml", "code/Cargo.toml", "exhibits/Cargo.toml"] {
        common.push_str(&files::read_if_there(&root.join(file))?.unwrap_or_default());
    }
    for (name, text) in exhibits.iter().filter(|(name, _)| !chapters.contains(name)) {
        let others: String = text
            .lines()
            .filter(|line| {
                !chapters.iter().any(|slug| words(line).any(|word| word == slug.as_str()))
            })
            .collect();
        common.push_str(name);
        common.push_str(&others);
    }
    let digest = |slug: &String| {
        let mut hasher = Sha256::new();
        hasher.update(&common);
        hasher.update(&exhibits[slug]);
        for name in reachable(&exhibits[slug], &library) {
            hasher.update(&library[&name]);
        }
        hex(&hasher.finalize())
    };
    Ok(chapters.into_iter().map(|slug| (slug.clone(), digest(slug))).collect())
}

/// The modules of a crate by name, with the text of all their files.
fn modules(folder: &Path) -> Result<BTreeMap<String, String>> {
    let mut modules: BTreeMap<String, String> = BTreeMap::new();
    for path in
        files::below(folder)?.iter().filter(|path| path.extension().is_some_and(|end| end == "rs"))
    {
        let first =
            path.components().next().map(|part| Path::new(part.as_os_str()).with_extension(""));
        let name = first.unwrap_or_default().to_string_lossy().into_owned();
        modules.entry(name).or_default().push_str(&files::read(&folder.join(path))?);
    }
    Ok(modules)
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_'))
}

/// The modules that a text names, and those that they name.
fn reachable(text: &str, library: &BTreeMap<String, String>) -> BTreeSet<String> {
    let mut reached = BTreeSet::new();
    let mut open = vec![text];
    while let Some(text) = open.pop() {
        for name in words(text).filter(|word| library.contains_key(*word)) {
            if reached.insert(name.to_owned()) {
                open.push(&library[name]);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chapter_depends_on_what_it_names_and_on_what_that_names() {
        let library = BTreeMap::from([
            ("manifold".to_owned(), "pub fn exp() {}".to_owned()),
            ("reprojection".to_owned(), "use crate::manifold;".to_owned()),
            ("inertial".to_owned(), "use crate::manifold;".to_owned()),
        ]);
        let reached = reachable("use vislam::{reprojection::Pinhole};", &library);
        assert_eq!(reached.into_iter().collect::<Vec<_>>(), ["manifold", "reprojection"]);
    }
}
