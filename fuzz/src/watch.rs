//! Keeps the input of a reader that does not return: one that never ends, or that ends the program.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Whoever takes so long never ends.
const NEVER: Duration = Duration::from_secs(120);

/// An eye on a reader. The last input lies in a file, and stays there when the trial fails.
pub struct Watch {
    path: PathBuf,
    since: Arc<Mutex<Option<Instant>>>,
}

impl Watch {
    /// One for a trial.
    pub fn of(name: &'static str) -> Self {
        let folder = std::env::temp_dir().join("vislam-fuzz");
        fs::create_dir_all(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        let path = folder.join(format!("{name}-{}", std::process::id()));
        let since = Arc::new(Mutex::new(None::<Instant>));
        let (file, watched) = (path.clone(), Arc::downgrade(&since));
        thread::spawn(move || {
            while let Some(since) = watched.upgrade() {
                let begun = *since.lock().unwrap_or_else(PoisonError::into_inner);
                if begun.is_some_and(|begun| begun.elapsed() > NEVER) {
                    eprintln!("{name}: it comes to no end; the input is {}", file.display());
                    std::process::exit(1);
                }
                drop(since);
                thread::sleep(Duration::from_secs(1));
            }
        });
        Self { path, since }
    }

    /// Where the last input lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A reader is given an input.
    pub fn begins(&self, input: &[u8]) {
        fs::write(&self.path, input)
            .unwrap_or_else(|error| panic!("{}: {error}", self.path.display()));
        self.set(Some(Instant::now()));
    }

    /// It has returned.
    pub fn ends(&self) {
        self.set(None);
    }

    fn set(&self, to: Option<Instant>) {
        *self.since.lock().unwrap_or_else(PoisonError::into_inner) = to;
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        if !thread::panicking() {
            let _ = fs::remove_file(&self.path);
        }
    }
}
