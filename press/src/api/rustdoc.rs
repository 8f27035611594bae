//! Runs rustdoc on the copies, with the dependencies that cargo has compiled already.
//!
//! `cargo doc` would check all dependencies once more, and it documents only what lies in the package. So cargo is
//! asked for the compiled libraries, which the exhibits need anyway, and rustdoc is called as cargo calls it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use anyhow::{Context, Result, bail};
use semver::{Version, VersionReq};
use serde::Deserialize;

use super::comments::Line;
use super::items::SOURCES;
use super::publish::{bar_file, style_file};
use crate::cargo::{self, Artifact};
use crate::fault::Faults;
use crate::pages::slashed;
use crate::settings::{Layout, Settings};

/// What rustdoc is to do.
pub struct Order<'a> {
    /// Where things lie.
    pub layout: &'a Layout,
    /// The book's settings.
    pub settings: &'a Settings,
    /// The folder of the copies.
    pub sources: &'a Path,
    /// The copies, which know where their lines come from.
    pub copies: &'a BTreeMap<PathBuf, Vec<Line>>,
    /// The folder of style and bar.
    pub theme: &'a Path,
    /// Where the pages go.
    pub pages: &'a Path,
}

/// The version of rustdoc, which is the compiler's; empty when it does not say.
pub fn version() -> &'static str {
    static VERSION: LazyLock<String> = LazyLock::new(|| {
        let output = Command::new(program()).arg("--version").output();
        output
            .map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
            .unwrap_or_default()
    });
    &VERSION
}

/// The rustdoc that belongs to the cargo that runs this.
fn program() -> PathBuf {
    let beside = std::env::var_os("CARGO").map(|cargo| {
        PathBuf::from(cargo)
            .with_file_name("rustdoc")
            .with_extension(std::env::consts::EXE_EXTENSION)
    });
    beside.filter(|path| path.is_file()).unwrap_or_else(|| "rustdoc".into())
}

/// Makes the pages and gives what rustdoc has against the descriptions.
pub fn run(order: &Order<'_>) -> Result<Faults> {
    let package = &order.settings.library_package;
    let metadata = Metadata::ask(order)?;
    let library = metadata.packages.iter().find(|known| known.name == *package);
    let library = library.with_context(|| {
        format!("the workspace has no package {package}, which book.toml names as the library: mend `library-package`")
    })?;
    let artifacts = compiled(order)?;
    let mut command = Command::new(program());
    command
        .current_dir(&order.layout.root)
        .env("CARGO_PKG_NAME", package)
        .env("CARGO_PKG_VERSION", &library.version)
        .args(["--crate-type", "lib", "--error-format", "json"])
        .args(["--crate-name", &package.replace('-', "_")])
        .args(["--crate-version", &library.version, "--edition", &library.edition])
        .arg(order.sources.join("lib.rs"))
        .arg("--out-dir")
        .arg(order.pages)
        .arg("--extend-css")
        .arg(style_file(order.theme))
        .arg("--html-before-content")
        .arg(bar_file(order.theme));
    for feature in artifacts.get(&library.id).into_iter().flat_map(|artifact| &artifact.features) {
        command.arg("--cfg").arg(format!("feature=\"{feature}\""));
    }
    for (name, artifact) in library.dependencies(&artifacts) {
        let file =
            artifact.library().with_context(|| format!("cargo compiled {name} into no library"))?;
        command.arg("--extern").arg(format!("{name}={}", file.display()));
    }
    let folders: BTreeSet<&Path> =
        artifacts.values().filter_map(|artifact| artifact.library()?.parent()).collect();
    for folder in folders {
        command.arg("-L").arg(format!("dependency={}", folder.display()));
    }
    let output = command.output().context("cannot start rustdoc, which comes with cargo")?;
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    let faults = faults(order, &messages);
    if !output.status.success() && faults.is_empty() {
        bail!("rustdoc stopped:\n{messages}");
    }
    Ok(faults)
}

/// What cargo compiled, by package. Where there are exhibits, the library is compiled for their program as
/// everywhere else; asked for alone, it could have its dependencies with fewer features.
fn compiled(order: &Order<'_>) -> Result<BTreeMap<String, Artifact>> {
    let settings = order.settings;
    let options = match settings.exhibits_package.as_str() {
        "" => ["--package", &settings.library_package],
        program => ["--bin", program],
    };
    let artifacts = cargo::compile(&order.layout.root, &options, "the library")?.into_iter();
    let libraries = artifacts.filter(|artifact| artifact.library().is_some());
    Ok(libraries.map(|artifact| (artifact.package_id.clone(), artifact)).collect())
}

/// What cargo knows of the workspace.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    id: String,
    name: String,
    version: String,
    edition: String,
    dependencies: Vec<Dependency>,
}

/// A dependency as a manifest declares it.
#[derive(Deserialize)]
struct Dependency {
    name: String,
    rename: Option<String>,
    req: VersionReq,
    kind: Option<String>,
}

impl Metadata {
    /// Asks for the members alone: for what they depend on, cargo would fetch all that any of them could need.
    fn ask(order: &Order<'_>) -> Result<Metadata> {
        let ask = ["metadata", "--quiet", "--no-deps", "--format-version", "1"];
        let text = cargo::call(&order.layout.root, &ask, "tell what the workspace has")?;
        serde_json::from_str(&text).context("cargo metadata says something unexpected")
    }
}

impl Package {
    /// What it needs to be compiled, by the names it uses.
    fn dependencies<'a>(
        &'a self,
        artifacts: &'a BTreeMap<String, Artifact>,
    ) -> impl Iterator<Item = (String, &'a Artifact)> {
        let needed = self.dependencies.iter().filter(|dependency| dependency.kind.is_none());
        needed.filter_map(|dependency| {
            let artifact = artifacts.iter().find(|(id, _)| dependency.is(id));
            let name = dependency.rename.as_ref().unwrap_or(&dependency.name);
            Some((name.replace('-', "_"), artifact?.1))
        })
    }
}

impl Dependency {
    /// Whether a package is the one that is meant, by its identifier: `source#name@version`, or `path/name#version`.
    fn is(&self, id: &str) -> bool {
        let Some((source, package)) = id.rsplit_once('#') else { return false };
        let folder = source.rsplit('/').next().unwrap_or(source);
        let (name, version) = package.rsplit_once('@').unwrap_or((folder, package));
        name == self.name && Version::parse(version).is_ok_and(|version| self.req.matches(&version))
    }
}

/// A message of rustdoc.
#[derive(Deserialize)]
struct Message {
    message: String,
    level: String,
    #[serde(default)]
    code: Option<Code>,
    #[serde(default)]
    spans: Vec<Span>,
    #[serde(default)]
    children: Vec<Message>,
}

#[derive(Deserialize)]
struct Code {
    code: String,
}

#[derive(Deserialize)]
struct Span {
    file_name: PathBuf,
    line_start: usize,
    is_primary: bool,
    label: Option<String>,
}

/// What rustdoc says, at the lines of the files that the copies were made from.
fn faults(order: &Order<'_>, messages: &str) -> Faults {
    let mut faults = Faults::default();
    for line in messages.lines() {
        let Ok(message) = serde_json::from_str::<Message>(line) else { continue };
        let Some(span) = message.spans.iter().find(|span| span.is_primary) else { continue };
        if !["warning", "error"].contains(&message.level.as_str()) {
            continue;
        }
        let (file, line) = origin(order, span);
        let code = message.code.as_ref().map_or("rustdoc", |code| code.code.as_str());
        let detail = span.label.as_ref().map_or(String::new(), |label| format!(" ({label})"));
        let help = message.children.iter().find(|child| child.level == "help");
        let mend = help.map_or("mend the description", |help| help.message.as_str());
        faults.add((&file, line), code, format!("{}{detail}", message.message), mend);
    }
    faults
}

/// The file and line that a place in a copy comes from.
fn origin(order: &Order<'_>, span: &Span) -> (String, usize) {
    let Ok(path) =
        order.layout.root.join(&span.file_name).strip_prefix(order.sources).map(Path::to_path_buf)
    else {
        return (slashed(&span.file_name), span.line_start);
    };
    let line = order.copies.get(&path).and_then(|lines| lines.get(span.line_start - 1));
    (format!("{SOURCES}/{}", slashed(&path)), line.map_or(0, |line| line.origin))
}
