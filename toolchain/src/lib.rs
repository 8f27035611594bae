//! A compiler for WebAssembly: for the pictures that readers take hold of, and for answers that are graded.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The target that needs no host.
pub const TARGET: &str = "wasm32-unknown-unknown";

/// rustc and cargo that can make WebAssembly.
pub struct Toolchain {
    /// The compiler.
    pub rustc: PathBuf,
    /// What calls it.
    pub cargo: PathBuf,
    /// The folder that the compiler's own files are in.
    pub root: PathBuf,
    /// The linker, where the standard library has to be compiled too because it is not installed
    /// for this target.
    pub std_with_linker: Option<PathBuf>,
}

const NONE: &str = "there is no compiler for WebAssembly. Run `rustup target add wasm32-unknown-unknown`; where rustup \
    has no network, Debian has one: `apt-get install rustc-web cargo-web rust-web-src lld-19`";

impl Toolchain {
    /// That of rustup if it has the target; one from the system that has sources of the standard
    /// library otherwise.
    ///
    /// # Errors
    ///
    /// What to install, when there is neither.
    pub fn find() -> Result<Self, String> {
        let usual = root_of(Path::new("rustc"));
        if let Some(root) = &usual
            && root.join("lib/rustlib").join(TARGET).is_dir()
        {
            let tool = |name: &str| root.join("bin").join(name);
            let (rustc, cargo) = (tool("rustc"), "cargo".into());
            return Ok(Self { rustc, cargo, root: root.clone(), std_with_linker: None });
        }
        let (rustc, cargo) = (PathBuf::from("/usr/bin/rustc"), PathBuf::from("/usr/bin/cargo"));
        let root = root_of(&rustc).ok_or(NONE)?;
        if root.join("lib/rustlib").join(TARGET).is_dir() {
            return Ok(Self { rustc, cargo, root, std_with_linker: None });
        }
        if !root.join("lib/rustlib/src/rust/library").is_dir() {
            return Err(NONE.to_owned());
        }
        let std_with_linker =
            Some(linker().ok_or("there is no linker for WebAssembly: `apt-get install lld-19`")?);
        Ok(Self { rustc, cargo, root, std_with_linker })
    }

    /// As [`Toolchain::find`]; when there is none, rustup is asked to add the target, and `say` hears of it.
    ///
    /// # Errors
    ///
    /// What to install, when rustup cannot do it.
    pub fn find_or_add(say: impl FnOnce(&str)) -> Result<Self, String> {
        Self::find().or_else(|missing| {
            if !has_rustup() {
                return Err(missing);
            }
            say(&format!("adding the target {TARGET} with rustup, once"));
            let added = Command::new("rustup").args(["target", "add", TARGET]).output();
            match added {
                Ok(output) if output.status.success() => Self::find(),
                _ => Err(missing),
            }
        })
    }

    /// A call of cargo with this compiler and nothing of the environment that would change it.
    pub fn cargo(&self) -> Command {
        let mut cargo = Command::new(&self.cargo);
        for name in [
            "LD_LIBRARY_PATH",
            "RUSTFLAGS",
            "CARGO_ENCODED_RUSTFLAGS",
            "RUSTC_WRAPPER",
            "CARGO_BUILD_TARGET",
        ] {
            cargo.env_remove(name);
        }
        cargo.env("RUSTC", &self.rustc).envs(self.variables());
        if let Some(linker) = &self.std_with_linker {
            cargo.arg("-Zbuild-std=std,panic_abort").arg("--config");
            cargo.arg(format!("target.{TARGET}.linker={:?}", linker.display().to_string()));
        }
        cargo
    }

    /// What this compiler needs in its environment.
    pub fn variables(&self) -> Vec<(&'static str, OsString)> {
        match self.std_with_linker {
            Some(_) => vec![("RUSTC_BOOTSTRAP", "1".into())],
            None => Vec::new(),
        }
    }
}

/// The folder of a compiler's own files, if there is such a compiler.
fn root_of(rustc: &Path) -> Option<PathBuf> {
    let output = Command::new(rustc).args(["--print", "sysroot"]).output().ok()?;
    let root = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| PathBuf::from(root.trim()))
}

fn has_rustup() -> bool {
    Command::new("rustup").arg("--version").output().is_ok_and(|output| output.status.success())
}

/// wasm-ld, whichever version there is.
fn linker() -> Option<PathBuf> {
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let versions = (14..40).rev().map(|version| format!("wasm-ld-{version}"));
    let mut names = std::iter::once("wasm-ld".to_owned()).chain(versions);
    names.find_map(|name| {
        folders.iter().map(|folder| folder.join(&name)).find(|path| path.is_file())
    })
}
