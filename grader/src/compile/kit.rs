//! What answers are linked with: the standard library, nalgebra, the book's library, and what the
//! exercises declare. It stands in a folder of its own, so that the compiler of an answer can be
//! shown this and nothing else of the repository.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde::Deserialize;
use tempfile::TempDir;

use super::stamp;
use crate::repository;
use toolchain::{TARGET, Toolchain};

/// The crates that an answer may name, and the names. Of the book's library it has what would be no
/// answer.
const NAMED: [(&str, &str); 3] =
    [("exercise_spec", "exercise_spec"), ("nalgebra", "nalgebra"), ("exercise_library", "vislam")];

/// The compiled libraries, and a place for the work of one run.
pub struct Kit {
    run: TempDir,
    kit: PathBuf,
    /// Held as long as the run lives: who finds it free may clear the run away.
    _lock: File,
    has_std: bool,
    linker: Option<PathBuf>,
    named: Vec<(&'static str, OsString)>,
    /// In an order of their own: cargo names what it compiled in any.
    stamps: BTreeSet<String>,
}

/// What cargo says of a crate that it compiled.
#[derive(Deserialize)]
struct Artifact {
    reason: String,
    #[serde(default)]
    manifest_path: PathBuf,
    #[serde(default)]
    filenames: Vec<PathBuf>,
    target: Option<Target>,
}

#[derive(Deserialize)]
struct Target {
    name: String,
}

impl Kit {
    /// Compiles the libraries, which is quick when they are fresh, and lays them out.
    pub fn build(toolchain: &Toolchain) -> Result<Self, String> {
        let artifacts = compiled(toolchain)?;
        let runs = repository().join("target/grader/runs");
        let io = |error: std::io::Error| format!("cannot work in {}: {error}", runs.display());
        fs::create_dir_all(&runs).map_err(io)?;
        // One after the other, so that nobody clears a run away between its making and its lock.
        let turn = File::create(runs.join("turn")).map_err(io)?;
        turn.lock().map_err(io)?;
        clear(&runs);
        let run = tempfile::Builder::new().prefix("run-").tempdir_in(&runs).map_err(io)?;
        let lock = File::create(run.path().join("lock")).map_err(io)?;
        lock.try_lock()
            .map_err(|error| format!("cannot lock {}: {error}", run.path().display()))?;
        drop(turn);
        let std = toolchain.root.join("lib/rustlib/src");
        let (mut named, mut stamps) = (Vec::new(), BTreeSet::new());
        for artifact in &artifacts {
            let is_std = artifact.manifest_path.starts_with(&std);
            for file in artifact.filenames.iter().filter(|file| is_library(file)) {
                let folder = run.path().join("kit").join(folder_of(file, is_std));
                fs::create_dir_all(&folder).map_err(io)?;
                let name = file.file_name().unwrap_or_default();
                let kept = folder.join(name);
                fs::hard_link(file, &kept)
                    .or_else(|_| fs::copy(file, &kept).map(drop))
                    .map_err(io)?;
                stamps.insert(format!("{} {}", name.display(), stamp(file)));
                let of = artifact.target.as_ref().map(|target| target.name.replace('-', "_"));
                let known = NAMED.iter().find(|(library, _)| of.as_deref() == Some(*library));
                if let Some((_, name)) = known {
                    named.push((*name, kept.into_os_string()));
                }
            }
        }
        if named.len() != NAMED.len() {
            return Err(format!("of the libraries {NAMED:?} some were not compiled"));
        }
        let has_std = toolchain.std_with_linker.is_some();
        let kit = run.path().join("kit");
        Ok(Self {
            run,
            kit,
            _lock: lock,
            has_std,
            linker: toolchain.std_with_linker.clone(),
            named,
            stamps,
        })
    }

    /// Where the libraries stand.
    pub fn path(&self) -> &Path {
        &self.kit
    }

    /// Tells these libraries from others.
    pub fn stamps(&self) -> &BTreeSet<String> {
        &self.stamps
    }

    /// An empty folder for one compilation; it goes when it is dropped.
    pub fn folder(&self) -> Result<TempDir, String> {
        let answers = self.run.path().join("answers");
        fs::create_dir_all(&answers)
            .and_then(|()| tempfile::Builder::new().prefix("of-").tempdir_in(&answers))
            .map_err(|error| format!("cannot make a folder in {}: {error}", answers.display()))
    }

    /// What rustc has to be told about the libraries.
    pub fn options(&self) -> Vec<OsString> {
        let at = |name: &str| self.kit.join(name).into_os_string();
        let joined = |before: &str, path: OsString| {
            let mut option = OsString::from(before);
            option.push(path);
            option
        };
        let mut options = vec![
            "-L".into(),
            joined("dependency=", at("libraries")),
            "-L".into(),
            joined("dependency=", at("macros")),
        ];
        for (name, path) in &self.named {
            options.extend(["--extern".into(), joined(&format!("{name}="), path.clone())]);
        }
        if self.has_std {
            options.extend(["--sysroot".into(), at("std")]);
        }
        if let Some(linker) = &self.linker {
            options.extend(["-C".into(), joined("linker=", linker.clone().into_os_string())]);
        }
        options
    }
}

fn is_library(file: &Path) -> bool {
    let ending = file.extension().and_then(|ending| ending.to_str());
    matches!(ending, Some("rlib" | "so" | "dylib" | "dll"))
}

/// Where a library goes: macros run in the compiler, and the standard library has a shape that
/// rustc expects.
fn folder_of(file: &Path, is_std: bool) -> PathBuf {
    match (is_std, file.extension().is_some_and(|ending| ending == "rlib")) {
        (true, _) => Path::new("std/lib/rustlib").join(TARGET).join("lib"),
        (false, true) => "libraries".into(),
        (false, false) => "macros".into(),
    }
}

/// Compiles what the exercises declare, and all that it needs, for WebAssembly.
fn compiled(toolchain: &Toolchain) -> Result<Vec<Artifact>, String> {
    let root = repository();
    if !root.join("target/grader").join(TARGET).is_dir() {
        eprintln!("Compiling what answers are linked with. The first time takes some minutes.");
    }
    let mut cargo = toolchain.cargo();
    cargo.args(["build", "--quiet", "--locked", "--target", TARGET]);
    // Without the checks, which know what they expect.
    cargo.args(["--package", "exercise-spec", "--package", "exercise-library"]);
    cargo.arg("--no-default-features");
    cargo.args([
        "--message-format",
        "json-render-diagnostics",
        "--config",
        "profile.dev.debug=0",
        // Then answers can use what the library has compiled of nalgebra.
        "--config",
        "profile.dev.package.vislam.opt-level=1",
        // Names of what is compiled once for a library and an answer say all their types.
        "--config",
        "target.wasm32-unknown-unknown.rustflags=['-C', 'symbol-mangling-version=v0']",
        "--target-dir",
    ]);
    cargo.arg(root.join("target/grader")).current_dir(&root);
    let output = cargo
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("{} does not run: {error}", toolchain.cargo.display()))?;
    if !output.status.success() {
        return Err(
            "the libraries of the exercises do not compile for WebAssembly; cargo says why above"
                .to_owned(),
        );
    }
    let lines = String::from_utf8_lossy(&output.stdout);
    let artifacts = lines.lines().filter_map(|line| serde_json::from_str::<Artifact>(line).ok());
    let host = root.join("target/grader/debug");
    Ok(artifacts
        .filter(|artifact| artifact.reason == "compiler-artifact")
        // Of what was compiled for this machine, answers need the macros alone.
        .filter(|artifact| {
            !artifact.filenames.iter().any(|file| {
                file.starts_with(&host) && file.extension().is_some_and(|e| e == "rlib")
            })
        })
        .collect())
}

/// Removes what runs that were killed have left.
fn clear(runs: &Path) {
    let entries = fs::read_dir(runs).into_iter().flatten().flatten();
    for run in entries.filter(|entry| entry.path().is_dir()) {
        let free = match File::open(run.path().join("lock")) {
            Ok(lock) => lock.try_lock().is_ok(),
            Err(_) => true,
        };
        if free {
            let _ = fs::remove_dir_all(run.path());
        }
    }
}
