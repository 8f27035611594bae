//! What programs of the repository say, built as they are meant to run.

use std::process::Command;

use crate::data::NotMade;

/// What a program prints in a release build; `program` tells cargo which one.
pub fn said(program: &[&str], arguments: &[&str]) -> Result<String, NotMade> {
    let failed = |what: String| {
        NotMade::Failed(format!("{} {}: {what}", program.join(" "), arguments.join(" ")))
    };
    let mut cargo = Command::new("cargo");
    cargo.args(["run", "--quiet", "--locked", "--release"]).args(program).arg("--").args(arguments);
    let output = cargo.output().map_err(|error| failed(error.to_string()))?;
    if !output.status.success() {
        return Err(failed(String::from_utf8_lossy(&output.stderr).into_owned()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
