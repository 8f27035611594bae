//! What programs of the repository say, built as they are meant to run.

use std::process::Command;

use crate::data::NotMade;

/// What a program prints in a release build; `program` tells cargo which one.
pub fn said(program: &[&str], arguments: &[&str]) -> Result<String, NotMade> {
    cargo(&[&["run", "--release"], program].concat(), arguments)
}

/// What a test of the workspace prints when it passes.
pub fn tested(test: &[&str]) -> Result<String, NotMade> {
    cargo(&[&["test"], test].concat(), &["--nocapture", "--test-threads", "16"])
}

fn cargo(what: &[&str], arguments: &[&str]) -> Result<String, NotMade> {
    let failed = |why: &str| {
        NotMade::Failed(format!("cargo {} -- {}: {why}", what.join(" "), arguments.join(" ")))
    };
    let mut cargo = Command::new("cargo");
    cargo.args(what).args(["--quiet", "--locked", "--"]).args(arguments);
    let output = cargo.output().map_err(|error| failed(&error.to_string()))?;
    let said = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(failed(&format!("{said}{}", String::from_utf8_lossy(&output.stderr))));
    }
    Ok(said.into_owned())
}
