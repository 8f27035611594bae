//! What cargo compiles, and what it says of it.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use serde::Deserialize;

/// What was compiled for one package.
#[derive(Deserialize)]
pub struct Artifact {
    /// The package, as `cargo metadata` calls it.
    pub package_id: String,
    /// The features it was compiled with.
    pub features: Vec<String>,
    /// The program, when it is one.
    pub executable: Option<PathBuf>,
    filenames: Vec<PathBuf>,
}

impl Artifact {
    /// The compiled library: Rust's, or what a macro is loaded from.
    pub fn library(&self) -> Option<&Path> {
        let ends = |ends: &[&str]| {
            let fits = |path: &&PathBuf| {
                path.extension().is_some_and(|end| ends.iter().any(|known| end == *known))
            };
            self.filenames.iter().find(fits).map(PathBuf::as_path)
        };
        ends(&["rlib"]).or_else(|| ends(&["so", "dylib", "dll"]))
    }
}

/// Compiles in a folder what the options name; `what` is what an error calls it. A program is asked for by `--bin`
/// alone: with its package, its dependencies would have fewer features than `cargo test` gives them, and be compiled
/// once more.
pub fn compile(root: &Path, options: &[&str], what: &str) -> Result<Vec<Artifact>> {
    let build = ["build", "--quiet", "--message-format", "json-render-diagnostics"];
    let messages = call(root, &[&build[..], options].concat(), &format!("compile {what}"))?;
    Ok(messages.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

/// What cargo prints when it is called in a folder; `to` is what an error says that it was to do.
pub fn call(root: &Path, arguments: &[&str], to: &str) -> Result<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(arguments).current_dir(root);
    // What `cargo run` says of the press; build scripts that listen to it would compile their crates again.
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        if text.starts_with("CARGO_MANIFEST_") || text.starts_with("CARGO_PKG_") {
            command.env_remove(name);
        }
    }
    let output = command.output();
    let output = output.with_context(|| format!("cannot start cargo to {to}"))?;
    if !output.status.success() {
        bail!("cargo cannot {to}:\n{}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
