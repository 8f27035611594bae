//! What a batch keeps on disk, so that one that was killed goes on where it stopped.
//!
//! Every file is written beside its place and then renamed, so that whoever looks sees a whole
//! one or none.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::Trouble;
use crate::grade::{Grade, VERSION};
use crate::seed::Seed;
use crate::submission::naturally;
use crate::text::harmless_line;

/// The folder of a batch.
#[derive(Debug)]
pub struct Kept {
    out: PathBuf,
    seed: Seed,
    state: State,
    /// Whether there was no batch, one that was not finished, or one that was.
    found: Found,
    /// Held as long as this process writes here.
    _lock: File,
}

/// `batch.toml`.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct State {
    version: u32,
    /// As text. It stands here and in no report.
    seed: String,
    /// Slugs, in the order of the book. Batches of former graders do not say.
    #[serde(default)]
    exercises: Vec<String>,
    finished: bool,
    /// The seed of the finished batch that this one grades again.
    former_seed: Option<String>,
}

/// What was in the folder before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Found {
    Nothing,
    Unfinished,
    Finished,
}

/// The folder that names the submissions at which a run is, or was when it was ended.
const BEGUN: &str = ".begun";
const STATE: &str = "batch.toml";
const LOCK: &str = ".lock";

/// How long the lock of a process that ended may stay with a program that it was starting.
const PATIENCE: Duration = Duration::from_secs(3);
const GRADE: &str = "grade.json";
const FORMER: &str = "former.json";

impl Kept {
    /// Opens the folder of a batch, and makes it if it is not there. The seed is the one given,
    /// or that of the batch in the folder, or a random one.
    ///
    /// # Errors
    ///
    /// A [`Trouble`] when something else is in the folder, another process writes there, its batch
    /// is of other exercises, or the seed is not that of a batch which is not finished.
    pub fn open(out: &Path, seed: Option<Seed>, exercises: &[&str]) -> Result<Self, Trouble> {
        fs::create_dir_all(out).map_err(|error| unusable(out, &error))?;
        let lock = locked(out)?;
        let former = former(out)?;
        if let Some(state) = &former {
            state.has_exercises(out, exercises)?;
        }
        let (found, state) = match former {
            None => {
                let seed = seed.map_or_else(Seed::draw, Ok).map_err(Trouble::CouldNotGrade)?;
                (Found::Nothing, State::new(seed, None, exercises))
            }
            Some(state) if state.finished => {
                let seed = seed.unwrap_or(state.number(out)?);
                (Found::Finished, State::new(seed, Some(state.seed), exercises))
            }
            Some(state) => {
                let begun = state.number(out)?;
                if seed.is_some_and(|seed| seed != begun) {
                    return Err(Trouble::Usage(format!(
                        "{} holds a batch that is not finished, with another seed; leave --seed out to \
                         go on with it, or choose another folder with --out",
                        out.display()
                    )));
                }
                (Found::Unfinished, state)
            }
        };
        let seed = state.number(out)?;
        Ok(Self { out: out.to_owned(), seed, state, found, _lock: lock })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.out
    }

    /// The seed of the hidden instances.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// The seed of the batch that is graded again, if one is.
    pub fn former_seed(&self) -> Option<Seed> {
        Seed::parse(self.state.former_seed.as_deref()?).ok()
    }

    /// Marks the batch as begun. The grades of a finished one are put aside first, to be compared
    /// with.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written to.
    pub fn begin(&self) -> Result<(), Trouble> {
        let submissions = self.out.join("submissions");
        fs::create_dir_all(&submissions).map_err(|error| cannot("make", &submissions, &error))?;
        if self.found == Found::Finished {
            let entries =
                fs::read_dir(&submissions).map_err(|error| cannot("read", &submissions, &error))?;
            for entry in entries.flatten() {
                let grade = entry.path().join(GRADE);
                if let Ok(text) = fs::read_to_string(&grade) {
                    write(&entry.path().join(FORMER), text.as_bytes())?;
                }
            }
        }
        self.save()
    }

    /// Marks the batch as finished.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written to.
    pub fn finish(&mut self) -> Result<(), Trouble> {
        self.state.finished = true;
        self.save()
    }

    fn save(&self) -> Result<(), Trouble> {
        let text = toml::to_string(&self.state)
            .map_err(|error| Trouble::CouldNotGrade(format!("{STATE}: {error}")))?;
        let head = "# The batch in this folder. The same command with the same --out goes on \
                    with it, or grades it again.\n";
        write(&self.out.join(STATE), format!("{head}{text}").as_bytes())
    }

    /// The grade of a submission, if there is one that can be read.
    pub fn grade(&self, submission: &str) -> Option<Grade> {
        read(&self.place(submission, GRADE))
    }

    /// The grade that a submission had in the finished batch, if this is a regrade.
    pub fn former(&self, submission: &str) -> Option<Grade> {
        self.former_seed()?;
        read(&self.place(submission, FORMER))
    }

    /// Names of all submissions of the finished batch, if this is a regrade.
    pub fn all_former(&self) -> Vec<String> {
        if self.former_seed().is_none() {
            return Vec::new();
        }
        let entries = fs::read_dir(self.out.join("submissions")).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries
            .filter(|entry| entry.path().join(FORMER).is_file())
            .filter_map(|entry| entry.file_name().into_string().ok())
            .collect();
        names.sort_by(|one, other| naturally(one, other));
        names
    }

    /// Keeps a grade.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written to.
    pub fn keep(&self, grade: &Grade) -> Result<(), Trouble> {
        let json = serde_json::to_vec_pretty(grade)
            .map_err(|error| Trouble::CouldNotGrade(format!("{GRADE}: {error}")))?;
        self.report_on(&grade.submission, GRADE, &json)
    }

    /// Whether a run was ended while it graded these very answers of a submission.
    pub fn ended_at(&self, submission: &str, key: &str) -> bool {
        fs::read_to_string(self.begun(submission)).is_ok_and(|begun| begun == key)
    }

    /// Writes down that a submission is graded now.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written to.
    pub fn begin_at(&self, submission: &str, key: &str) -> Result<(), Trouble> {
        let folder = self.out.join(BEGUN);
        fs::create_dir_all(&folder).map_err(|error| cannot("make", &folder, &error))?;
        write(&self.begun(submission), key.as_bytes())
    }

    /// Writes down that it is graded no longer.
    pub fn done_with(&self, submission: &str) {
        let _ = fs::remove_file(self.begun(submission));
    }

    fn begun(&self, submission: &str) -> PathBuf {
        // With this ending no submission's file has the name of the temporary file of another one.
        self.out.join(BEGUN).join(format!("{submission}.begun"))
    }

    /// Writes a report on one submission.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written to.
    pub fn report_on(&self, submission: &str, name: &str, text: &[u8]) -> Result<(), Trouble> {
        let path = self.place(submission, name);
        let folder = path.parent().unwrap_or(&self.out);
        fs::create_dir_all(folder).map_err(|error| cannot("make", folder, &error))?;
        write(&path, text)
    }

    /// Writes a report on the batch.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written to.
    pub fn report(&self, name: &str, text: &[u8]) -> Result<(), Trouble> {
        write(&self.out.join(name), text)
    }

    /// Writes a report that is too long to be held, by a function that is given the file.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn report_by(
        &self,
        name: &str,
        written: impl FnOnce(&mut dyn std::io::Write) -> std::io::Result<()>,
    ) -> Result<(), Trouble> {
        let path = self.out.join(name);
        renamed(&path, |file| {
            let mut file = std::io::BufWriter::new(file);
            written(&mut file)?;
            std::io::Write::flush(&mut file)
        })
    }

    /// Takes away a report of a former batch that this one does not have.
    pub fn without(&self, name: &str) {
        let _ = fs::remove_file(self.out.join(name));
    }

    fn place(&self, submission: &str, name: &str) -> PathBuf {
        self.out.join("submissions").join(submission).join(name)
    }
}

impl Drop for Kept {
    fn drop(&mut self) {
        // It stays where a submission is still named in it.
        let _ = fs::remove_dir(self.out.join(BEGUN));
    }
}

impl State {
    fn new(seed: Seed, former_seed: Option<String>, exercises: &[&str]) -> Self {
        let exercises = exercises.iter().map(|slug| (*slug).to_owned()).collect();
        Self { version: VERSION, seed: seed.text(), exercises, finished: false, former_seed }
    }

    /// Makes sure that a batch of other exercises loses none of its grades.
    fn has_exercises(&self, out: &Path, exercises: &[&str]) -> Result<(), Trouble> {
        if self.exercises.is_empty() || self.exercises == exercises {
            return Ok(());
        }
        Err(Trouble::Usage(format!(
            "{} holds grades of {}; grade the same exercises, or choose another --out",
            out.display(),
            harmless_line(&self.exercises.join(", "), 1_000)
        )))
    }

    fn number(&self, out: &Path) -> Result<Seed, Trouble> {
        Seed::parse(&self.seed).map_err(|_| unreadable(out, "its seed is none"))
    }
}

/// The folder's lock, which ends with the process, however that ends. A program that this process
/// was just starting holds it, too, until it runs, and so may outlive a process that was killed:
/// the lock is asked for until [`PATIENCE`] has passed.
fn locked(out: &Path) -> Result<File, Trouble> {
    let path = out.join(LOCK);
    let lock = File::create(&path).map_err(|error| unusable(out, &error))?;
    let begun = Instant::now();
    while let Err(TryLockError::WouldBlock) = lock.try_lock() {
        if begun.elapsed() > PATIENCE {
            return Err(Trouble::Usage(format!(
                "another batch writes to {}; wait for it, or choose another folder \
                 with --out",
                out.display()
            )));
        }
        sleep(Duration::from_millis(20));
    }
    // Some file systems know no locks; they are no reason not to grade.
    Ok(lock)
}

/// The state of the batch in a folder, if there is one.
fn former(out: &Path) -> Result<Option<State>, Trouble> {
    let path = out.join(STATE);
    if path.exists() {
        let text = fs::read_to_string(&path).map_err(|error| cannot("read", &path, &error))?;
        let state: State =
            toml::from_str(&text).map_err(|error| unreadable(out, error.message()))?;
        if state.version != VERSION {
            let what = format!("it is of version {} and not {VERSION}", state.version);
            return Err(unreadable(out, &what));
        }
        return Ok(Some(state));
    }
    let entries = fs::read_dir(out).map_err(|error| cannot("read", out, &error))?;
    if entries.flatten().any(|entry| entry.file_name() != LOCK && entry.file_name() != BEGUN) {
        return Err(Trouble::Usage(format!(
            "{} is not empty and holds no batch; name another folder with --out, one that is not \
             there yet",
            out.display()
        )));
    }
    Ok(None)
}

fn unusable(out: &Path, error: &std::io::Error) -> Trouble {
    Trouble::Usage(format!(
        "no grades can be written to {}: {error}; name a folder with --out",
        out.display()
    ))
}

fn unreadable(out: &Path, why: &str) -> Trouble {
    Trouble::Usage(format!(
        "{}: {why}; choose another folder with --out",
        out.join(STATE).display()
    ))
}

fn read(path: &Path) -> Option<Grade> {
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}

fn write(path: &Path, text: &[u8]) -> Result<(), Trouble> {
    renamed(path, |mut file| std::io::Write::write_all(&mut file, text))
}

/// Writes a file beside its place and renames it.
fn renamed(path: &Path, written: impl FnOnce(&File) -> std::io::Result<()>) -> Result<(), Trouble> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let beside = PathBuf::from(beside);
    File::create(&beside)
        .and_then(|file| written(&file))
        .and_then(|()| fs::rename(&beside, path))
        .map_err(|error| cannot("write", path, &error))
}

fn cannot(what: &str, path: &Path, error: &std::io::Error) -> Trouble {
    Trouble::CouldNotGrade(format!("cannot {what} {}: {error}", path.display()))
}
