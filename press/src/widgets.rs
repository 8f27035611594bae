//! Pictures to take hold of: the library compiled for the reader's browser, a module a picture.
//!
//! A module is packed into a script, so that it also loads where a page is opened from a disk and may not fetch.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use toolchain::{TARGET, Toolchain};

use crate::compiler;
use crate::files;
use crate::packing::{digest, packed_tightly};
use crate::settings::Layout;
use crate::steps::Steps;

/// The profile of the modules.
const PROFILE: &str = "widget";
/// What the modules are made from.
const SOURCES: [&str; 3] = ["code/src", "widgets/src", "widgets/modules"];
/// The same, single files.
const FILES: [&str; 4] = ["Cargo.lock", "Cargo.toml", "code/Cargo.toml", "widgets/Cargo.toml"];
/// What draws them.
const SCRIPT: &str = "widgets/script";

/// The modules of a book.
pub struct Widgets<'a> {
    layout: &'a Layout,
}

impl<'a> Widgets<'a> {
    /// Those of the book that lies there.
    pub fn new(layout: &'a Layout) -> Widgets<'a> {
        Widgets { layout }
    }

    /// The names of all, whether they are compiled or not.
    pub fn names(&self) -> Result<Vec<String>> {
        let files = files::below(&self.layout.root.join("widgets/modules"))?;
        let names = files.iter().filter_map(|file| file.file_stem()?.to_str());
        Ok(names.map(str::to_owned).collect())
    }

    /// Whether they were compiled from what there is now.
    pub fn are_fresh(&self) -> Result<bool> {
        let made = files::read_if_there(&self.folder().join("inputs"))?;
        Ok(made.is_some_and(|made| Some(made) == self.inputs().ok()))
    }

    /// Compiles them if that is not done.
    ///
    /// # Errors
    /// What the compiler says.
    pub fn refresh(&self, steps: &Steps) -> Result<Refreshed> {
        if self.names()?.is_empty() || self.are_fresh()? {
            return Ok(Refreshed::Fresh);
        }
        let toolchain = match compiler::find(self.layout, steps)? {
            Ok(toolchain) => toolchain,
            Err(why) => {
                files::remove(&self.folder())?;
                return Ok(Refreshed::Impossible(why));
            }
        };
        let inputs = self.inputs()?;
        steps.step("compiling the pictures to take hold of", || self.compile(&toolchain))?;
        for name in self.names()? {
            let module = self.target().join(format!("{name}.wasm"));
            let module = std::fs::read(&module)
                .with_context(|| format!("there is no module {}", module.display()))?;
            files::write(&self.script(&name), &pack(&name, &module)?)?;
        }
        files::write(&self.folder().join("inputs"), inputs.as_bytes())?;
        Ok(Refreshed::Compiled)
    }

    /// What a page loads: the script that draws, and the modules, by their names.
    pub fn scripts(&self) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
        let mut scripts = BTreeMap::new();
        for name in self.names()? {
            if let Some(packed) = files::read_if_there(&self.script(&name))? {
                scripts.insert(format!("widgets/{name}.js").into(), packed.into_bytes());
            }
        }
        if !scripts.is_empty() {
            scripts.extend(self.drawing()?);
        }
        Ok(scripts)
    }

    /// What draws, without any module.
    pub fn drawing(&self) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
        let read = |name: &str| {
            let script = files::read(&self.layout.root.join(SCRIPT).join(name))?;
            Ok((Path::new("widgets").join(name), script.into_bytes()))
        };
        ["widgets.js", "widgets.css"].into_iter().map(read).collect()
    }

    fn compile(&self, toolchain: &Toolchain) -> Result<()> {
        let mut cargo = toolchain.cargo();
        cargo.args(["build", "--quiet", "--locked", "--package", "widgets", "--examples"]);
        cargo.args(["--target", TARGET, "--profile", PROFILE, "--target-dir"]);
        cargo.arg(self.layout.root.join("target/widgets")).current_dir(&self.layout.root);
        let output = cargo
            .output()
            .with_context(|| format!("cannot start {}", toolchain.cargo.display()))?;
        if !output.status.success() {
            bail!("cargo cannot compile widgets:\n{}", String::from_utf8_lossy(&output.stderr));
        }
        Ok(())
    }

    fn folder(&self) -> PathBuf {
        self.layout.work().join("widgets")
    }

    fn script(&self, name: &str) -> PathBuf {
        self.folder().join(format!("{name}.js"))
    }

    fn target(&self) -> PathBuf {
        self.layout.root.join(format!("target/widgets/{TARGET}/{PROFILE}/examples"))
    }

    /// A digest of what they are made from.
    fn inputs(&self) -> Result<String> {
        digest(&self.layout.root, &SOURCES, &FILES)
    }
}

/// What became of modules that were to be fresh.
#[derive(Debug, PartialEq, Eq)]
pub enum Refreshed {
    /// They were.
    Fresh,
    /// They were compiled.
    Compiled,
    /// There is no compiler, and why.
    Impossible(String),
}

/// A module as a script that hands it over.
fn pack(name: &str, module: &[u8]) -> Result<Vec<u8>> {
    let text = packed_tightly(module)?;
    Ok(format!("vislamWidgets.module({name:?}, \"{text}\");\n").into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_book_without_widgets_needs_no_compiler() {
        let root = tempfile::tempdir().unwrap();
        let layout = Layout { root: root.path().to_path_buf() };
        let widgets = Widgets::new(&layout);
        assert_eq!(widgets.refresh(&Steps::quiet()).unwrap(), Refreshed::Fresh);
        assert!(widgets.scripts().unwrap().is_empty());
    }

    #[test]
    fn modules_are_stale_when_a_source_changes() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            files::write(&root.path().join(path), text.as_bytes()).unwrap();
        };
        write("widgets/modules/ring.rs", "widgets::module!(Ring);");
        write("code/src/lib.rs", "one");
        let layout = Layout { root: root.path().to_path_buf() };
        let widgets = Widgets::new(&layout);
        assert!(!widgets.are_fresh().unwrap());
        write("target/press/widgets/inputs", &widgets.inputs().unwrap());
        assert!(widgets.are_fresh().unwrap());
        write("code/src/lib.rs", "two");
        assert!(!widgets.are_fresh().unwrap());
    }
}
