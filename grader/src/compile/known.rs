//! The module of answers that are the grader's own, kept from one run to the next.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use exercise_spec::EXERCISES;
use sha2::{Digest, Sha256};

use super::Answers;

/// Where one module lies, and of what it was made.
pub struct Known {
    path: PathBuf,
    digest: Vec<u8>,
}

impl Known {
    /// The place for answers in a folder. `maker` tells a compiler and its libraries from others.
    pub fn of(folder: &Path, maker: &str, answers: &Answers) -> Self {
        let taken = |exercise: &str| if answers.contains_key(exercise) { '1' } else { '0' };
        let name: String = EXERCISES.iter().map(|exercise| taken(exercise.slug)).collect();
        let digest = Sha256::new().chain_update(format!("{maker}{answers:?}")).finalize().to_vec();
        Self { path: folder.join(name), digest }
    }

    /// The module, if it was made of these very texts by this very compiler.
    pub fn module(&self) -> Option<Vec<u8>> {
        fs::read(&self.path).ok()?.strip_prefix(&*self.digest).map(<[u8]>::to_vec)
    }

    /// Keeps a module in the place of the one before. Where that is not possible, the next run
    /// compiles again.
    pub fn keep(&self, module: &[u8]) -> Option<()> {
        let folder = self.path.parent()?;
        fs::create_dir_all(folder).ok()?;
        let mut file = tempfile::NamedTempFile::new_in(folder).ok()?;
        file.write_all(&self.digest).and_then(|()| file.write_all(module)).ok()?;
        file.persist(&self.path).ok().map(drop)
    }
}
