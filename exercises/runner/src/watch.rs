//! Runs the tests of an answer at once and whenever its file is saved, and goes on to the next
//! exercise when it is right.

use std::path::Path;
use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

use notify::{Config, Event, PollWatcher, RecommendedWatcher, RecursiveMode, Watcher};

use exercise_spec::{EXERCISES, Exercise};

use crate::folder::{Folder, read};
use crate::progress::{self, State};
use crate::say::say;
use crate::selection;

type Events = Receiver<notify::Result<Event>>;

/// Runs the tests of an exercise, or of the first that is not solved, and then those of each answer
/// that is saved, until interrupted.
///
/// # Errors
///
/// When the folder cannot be watched or cargo cannot be started.
pub fn watch(folder: &Folder, first: Option<&str>) -> Result<(), String> {
    let first = match first {
        Some(slug) => Some(selection::named(slug)?),
        None => progress::next(folder, None),
    };
    let (_watcher, events) = watcher(folder)?;
    say(format!("watching {}", folder.answers().display()));
    let mut watch =
        Watch::new(folder, |exercise| selection::run(folder.path(), exercise.slug, &[]).map(drop));
    if let Some(first) = first {
        watch.begin(first)?;
    }
    loop {
        // One save makes several events; they are one.
        let ended = |_| "the files are watched no longer".to_owned();
        events.recv().map_err(ended)?.map_err(|error| error.to_string())?;
        while events.recv_timeout(Duration::from_millis(50)).is_ok() {}
        watch.look()?;
    }
}

/// What the answers were when somebody looked last, and what runs the tests of one.
pub struct Watch<'a, Run> {
    folder: &'a Folder,
    run: Run,
    texts: Vec<String>,
}

impl<'a, Run: FnMut(&'static Exercise) -> Result<(), String>> Watch<'a, Run> {
    /// Looks at the answers as they are.
    pub fn new(folder: &'a Folder, run: Run) -> Self {
        let texts = EXERCISES.iter().map(|exercise| text(folder, exercise)).collect();
        Self { folder, run, texts }
    }

    /// Runs the tests of an exercise, unless nothing is written yet, and goes on from one that is
    /// solved.
    ///
    /// # Errors
    ///
    /// When its tests cannot be run.
    pub fn begin(&mut self, exercise: &'static Exercise) -> Result<(), String> {
        let slug = exercise.slug;
        if progress::state(self.folder, exercise) == State::Untouched {
            say(format!("\n{slug} is not begun: {}", self.folder.answer(slug).display()));
            return Ok(());
        }
        (self.run)(exercise)?;
        if !progress::is_solved(self.folder, exercise) {
            return Ok(());
        }
        let Some(next) = progress::next(self.folder, Some(slug)) else {
            say("\nall exercises are solved");
            return Ok(());
        };
        say(format!("\n{slug} is solved; the next one is {}", next.slug));
        self.begin(next)
    }

    /// Runs the tests of all answers that were saved since.
    ///
    /// # Errors
    ///
    /// When they cannot be run.
    pub fn look(&mut self) -> Result<(), String> {
        for (place, exercise) in EXERCISES.iter().enumerate() {
            let now = text(self.folder, exercise);
            if now != self.texts[place] {
                self.texts[place] = now;
                say(format!("\n{} was saved", exercise.slug));
                self.begin(exercise)?;
            }
        }
        Ok(())
    }
}

fn text(folder: &Folder, exercise: &Exercise) -> String {
    read(&folder.answer(exercise.slug)).unwrap_or_default()
}

/// A watcher of the answers that is known to notice changes: where the file system tells of none,
/// it looks by itself twice a second.
fn watcher(folder: &Folder) -> Result<(Box<dyn Watcher>, Events), String> {
    let (sender, events) = mpsc::channel();
    let native = RecommendedWatcher::new(sender, Config::default())
        .and_then(|mut watcher| {
            watcher.watch(&folder.answers(), RecursiveMode::NonRecursive)?;
            Ok(watcher)
        })
        .ok()
        .filter(|_| notices(&folder.answers(), &events));
    if let Some(watcher) = native {
        return Ok((Box::new(watcher), events));
    }
    say("this file system does not tell of changes, so the files are looked at twice a second");
    let (sender, events) = mpsc::channel();
    let config = Config::default()
        .with_poll_interval(Duration::from_millis(500))
        .with_compare_contents(true);
    let failed =
        |error: notify::Error| format!("cannot watch {}: {error}", folder.answers().display());
    let mut watcher = PollWatcher::new(sender, config).map_err(failed)?;
    watcher.watch(&folder.answers(), RecursiveMode::NonRecursive).map_err(failed)?;
    Ok((Box::new(watcher), events))
}

/// Whether a change of a file in the folder comes as an event.
fn notices(folder: &Path, events: &Events) -> bool {
    let probe = folder.join(".watched");
    if std::fs::write(&probe, "").is_err() {
        return false;
    }
    let noticed = events.recv_timeout(Duration::from_secs(1)).is_ok();
    let _ = std::fs::remove_file(&probe);
    noticed
}
