//! What the students' repository is built of: the lock file and the sources of dependencies.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Where cargo finds the sources of dependencies.
const CONFIG: &str = "\
# Dependencies are compiled from the folder vendor; nothing is fetched.
[source.crates-io]
replace-with = \"vendor\"

[source.vendor]
directory = \"vendor\"
";

/// Writes the lock file without what only the book needs. Versions stay as they are.
pub fn lock(root: &Path, dir: &Path) -> Result<(), String> {
    fs::copy(root.join("Cargo.lock"), dir.join("Cargo.lock"))
        .map_err(|error| format!("cannot copy Cargo.lock: {error}"))?;
    let offline = cargo(dir, &["update", "--workspace", "--offline"]);
    offline.or_else(|_| cargo(dir, &["update", "--workspace"])).map_err(|said| {
        format!("cargo cannot make the lock file of the students' repository:\n{said}")
    })
}

/// Puts the sources of all dependencies beside the workspace and tells cargo so.
pub fn vendor(dir: &Path) -> Result<(), String> {
    cargo(dir, &["vendor", "--locked", "--respect-source-config", "vendor"]).map_err(|said| {
        format!(
            "cargo cannot fetch the sources of all dependencies; connect to a network, or leave \
             them out with --no-vendor:\n{said}"
        )
    })?;
    let config = dir.join(".cargo/config.toml");
    fs::create_dir_all(dir.join(".cargo"))
        .and_then(|()| fs::write(&config, CONFIG))
        .map_err(|error| format!("cannot write {}: {error}", config.display()))
}

/// Runs cargo in a folder. What it says comes back when it fails.
fn cargo(dir: &Path, arguments: &[&str]) -> Result<(), String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(arguments)
        .current_dir(dir)
        .output()
        .map_err(|error| format!("cannot start cargo: {error}"))?;
    match output.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&output.stderr).trim_end().to_owned()),
    }
}
