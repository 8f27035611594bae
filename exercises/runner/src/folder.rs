//! Where the answers lie, and what is kept beside them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A folder of exercises.
#[derive(Debug, Clone)]
pub struct Folder(PathBuf);

impl Folder {
    /// The folder of the exercises: where cargo runs them, so that a copy of the repository with
    /// its compiled programs is not taken for the original.
    pub fn here() -> Self {
        if let Some(package) = std::env::var_os("CARGO_MANIFEST_DIR") {
            return Self(package.into());
        }
        let runner = Path::new(env!("CARGO_MANIFEST_DIR"));
        Self(runner.parent().unwrap_or(runner).to_owned())
    }

    /// Another folder of the same shape.
    pub fn at(path: impl Into<PathBuf>) -> Self {
        Self(path.into())
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Where the answers lie.
    pub fn answers(&self) -> PathBuf {
        self.0.join("src")
    }

    /// The file of an answer.
    pub fn answer(&self, slug: &str) -> PathBuf {
        self.answers().join(format!("{slug}.rs"))
    }

    /// The skeletons of an edition.
    pub fn skeletons(&self, edition: u32) -> PathBuf {
        self.0.join("skeletons").join(edition.to_string())
    }

    /// A file that the runner keeps, and that is no part of the work.
    pub fn kept(&self, name: &str) -> PathBuf {
        self.0.join(".progress").join(name)
    }

    /// The picture of a check that failed.
    pub fn picture(&self, slug: &str, check: &str) -> PathBuf {
        self.kept(&format!("{slug}-{check}.svg"))
    }

    /// Takes away all pictures of an answer. One that cannot be taken away is written over later.
    pub fn without_pictures(&self, slug: &str) {
        for entry in fs::read_dir(self.kept("")).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let check = name.strip_prefix(slug).and_then(|rest| rest.strip_prefix('-'));
            if check.is_some_and(|check| check.ends_with(".svg")) {
                let _ = fs::remove_file(entry.path());
            }
        }
    }

    /// Writes a kept file.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written to.
    pub fn keep(&self, name: &str, text: &str) -> io::Result<PathBuf> {
        let path = self.kept(name);
        fs::create_dir_all(path.parent().unwrap_or(&self.0))?;
        fs::write(&path, text)?;
        Ok(path)
    }
}

/// Reads a text file, with an error that names it.
///
/// # Errors
///
/// When it is not there, or no text.
pub fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))
}

/// Writes a text file, with an error that names it.
///
/// # Errors
///
/// When it cannot be written.
pub fn write(path: &Path, text: &str) -> Result<(), String> {
    path.parent()
        .map_or(Ok(()), fs::create_dir_all)
        .and_then(|()| fs::write(path, text))
        .map_err(|error| format!("cannot write {}: {error}", path.display()))
}
