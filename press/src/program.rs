//! Runs the program that computes what the chapters show, for those chapters whose inputs changed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::api::rustdoc;
use crate::cargo;
use crate::files;
use crate::pages::slashed;
use crate::records::{Made, hex};
use crate::settings::{Layout, Settings};
use crate::uses::{Crate, Uses};

/// The library that the exhibits show. No exhibit tells its lines.
const LIBRARY: Crate<'_> = Crate { name: "vislam", folder: "code/src", lines: false };
/// The exhibits, which tell where they are registered.
const EXHIBITS: Crate<'_> = Crate { name: "exhibits", folder: "exhibits/src", lines: true };
/// The file that names the chapters with exhibits, in its table `CHAPTERS`.
const TABLE: &str = "exhibits/src/lib.rs";

/// The chapters that have exhibits and those of them that must be computed again.
pub struct Program<'a> {
    layout: &'a Layout,
    package: String,
    /// Every chapter with exhibits, and the digest of what they are computed from.
    chapters: BTreeMap<String, String>,
}

/// How the program is compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Speed {
    /// As all of the book is, for what every build computes.
    Everyday,
    /// As benchmarks are, for records, which say how long something takes.
    Measured,
}

impl Speed {
    fn profile(self) -> &'static str {
        match self {
            Self::Everyday => "dev",
            Self::Measured => "bench",
        }
    }
}

impl<'a> Program<'a> {
    /// Looks at the sources of the exhibits.
    pub fn new(layout: &'a Layout, settings: &Settings) -> Result<Program<'a>> {
        let package = settings.exhibits_package.clone();
        let chapters = match package.is_empty() {
            true => BTreeMap::new(),
            false => inputs(layout)?,
        };
        Ok(Program { layout, package, chapters })
    }

    /// The chapters whose exhibits are older than their inputs.
    pub fn stale(&self) -> Result<Vec<&str>> {
        let mut stale = Vec::new();
        for (slug, digest) in &self.chapters {
            let folder = self.layout.exhibits().join(slug);
            let made = files::read_if_there(&folder.join("inputs"))?;
            let computed = files::read_if_there(&folder.join("exhibits.json"))?;
            let computed = computed.and_then(|text| serde_json::from_str::<Computed>(&text).ok());
            let fresh = computed.is_some_and(|computed| computed.is_fresh(&self.layout.root));
            if made.as_ref() != Some(digest) || !fresh {
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

    /// Compiles the program; gives where it lies.
    pub fn compile(&self, speed: Speed) -> Result<PathBuf> {
        let options = ["--bin", &self.package, "--profile", speed.profile()];
        let artifacts = cargo::compile(&self.layout.root, &options, "the exhibits")?;
        let program = artifacts.into_iter().rev().find_map(|artifact| artifact.executable);
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

/// For each chapter with exhibits, a digest of the sources that they are computed from; see [`crate::uses`].
fn inputs(layout: &Layout) -> Result<BTreeMap<String, String>> {
    let path = layout.work().join("uses");
    let known = files::read_if_there(&path)?;
    let known = known.and_then(|text| serde_json::from_str::<Known>(&text).ok());
    let known = match known {
        Some(known) if known.is_fresh(&layout.root)? => known,
        _ => {
            let known = Known::of(&layout.root)?;
            files::write(&path, serde_json::to_string(&known)?.as_bytes())?;
            known
        }
    };
    let mut common = Sha256::new();
    common.update(rustdoc::version());
    for file in
        ["Cargo.lock", "Cargo.toml", ".cargo/config.toml", "code/Cargo.toml", "exhibits/Cargo.toml"]
    {
        common.update(files::read_if_there(&layout.root.join(file))?.unwrap_or_default());
    }
    let there = |slug: &String| layout.root.join(format!("src/{slug}.md")).is_file();
    let digest = |digest: String| hex(&common.clone().chain_update(digest).finalize());
    let digests = known.digests.into_iter().filter(|(slug, _)| there(slug));
    Ok(digests.map(|(slug, sources)| (slug, digest(sources))).collect())
}

/// What was found in the sources the last time, which takes a second to find again.
#[derive(Deserialize, Serialize)]
struct Known {
    /// The digest of each file.
    sources: BTreeMap<PathBuf, String>,
    /// For each chapter, the digest of what it uses of them.
    digests: BTreeMap<String, String>,
}

impl Known {
    fn of(root: &Path) -> Result<Known> {
        let uses = Uses::read(root, &[LIBRARY, EXHIBITS])?;
        let sources = uses.sources().into_iter();
        let sources = sources.map(|file| (file.clone(), digest_of(&root.join(file)))).collect();
        let mut digests = BTreeMap::new();
        for slug in uses.entries(TABLE) {
            let mut hasher = Sha256::new();
            for (file, bytes) in uses.of_entry(TABLE, &slug)? {
                hasher.update(format!("\n{} {}\n", slashed(&file), bytes.len()));
                hasher.update(bytes);
            }
            digests.insert(slug, hex(&hasher.finalize()));
        }
        Ok(Known { sources, digests })
    }

    fn is_fresh(&self, root: &Path) -> Result<bool> {
        for member in [LIBRARY, EXHIBITS] {
            let there = files::below(&root.join(member.folder))?.into_iter();
            let mut rust = there.filter(|file| file.extension().is_some_and(|end| end == "rs"));
            if rust.any(|file| !self.sources.contains_key(&Path::new(member.folder).join(file))) {
                return Ok(false);
            }
        }
        Ok(self.sources.iter().all(|(file, digest)| digest_of(&root.join(file)) == *digest))
    }
}

/// The digest of a file; empty when it cannot be read.
fn digest_of(path: &Path) -> String {
    std::fs::read(path).map(|bytes| hex(&Sha256::digest(bytes))).unwrap_or_default()
}

/// What the exhibits of a chapter name as read while they were computed.
#[derive(Deserialize)]
struct Computed {
    #[serde(default)]
    read: BTreeMap<PathBuf, String>,
}

impl Computed {
    /// Whether each file says what it said then.
    fn is_fresh(&self, root: &Path) -> bool {
        self.read.iter().all(|(file, digest)| digest_of(&root.join(file)) == *digest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chapter_is_computed_again_when_a_file_that_it_read_changes() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            files::write(&root.path().join(path), text.as_bytes()).unwrap();
        };
        for (path, text) in [
            (
                "exhibits/src/lib.rs",
                "mod one; const CHAPTERS: &[()] = &[(\"one\", one::exhibits)];",
            ),
            ("exhibits/src/one.rs", "pub fn exhibits() {}"),
            ("src/one.md", "# One"),
            ("exhibits/records/long.toml", "accepted"),
        ] {
            write(path, text);
        }
        let layout = Layout { root: root.path().to_path_buf() };
        let stale = || {
            let program = Program::new(&layout, &Settings::default()).unwrap();
            program.stale().unwrap().len()
        };
        assert_eq!(stale(), 1, "nothing was computed yet");
        let digest = &inputs(&layout).unwrap()["one"];
        write("target/press/exhibits/one/inputs", digest);
        let read = hex(&Sha256::digest("accepted"));
        let read = format!("{{\"read\": {{\"exhibits/records/long.toml\": \"{read}\"}}}}");
        write("target/press/exhibits/one/exhibits.json", &read);
        assert_eq!(stale(), 0);
        write("exhibits/records/long.toml", "accepted anew");
        assert_eq!(stale(), 1, "a record that was accepted");
        write("exhibits/records/long.toml", "accepted");
        assert_eq!(stale(), 0);
        write("exhibits/src/one.rs", "pub fn exhibits() { }");
        assert_eq!(stale(), 1, "an edited source");
        write("exhibits/src/one.rs", "pub fn exhibits() {}");
        assert_eq!(stale(), 0);
        write("exhibits/src/one/more.rs", "");
        assert_eq!(stale(), 0, "a file that nobody uses");
        write("Cargo.lock", "# other dependencies");
        assert_eq!(stale(), 1, "other dependencies");
    }
}
