//! Runs the tests of an answer whenever its file is saved.

use std::path::Path;
use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

use notify::{Config, Event, PollWatcher, RecommendedWatcher, RecursiveMode, Watcher};

use exercise_spec::EXERCISES;

use crate::folder::{Folder, read};
use crate::selection;

type Events = Receiver<notify::Result<Event>>;

/// Waits for saved answers and runs their tests, of one exercise or of all, until interrupted.
///
/// # Errors
///
/// When the folder cannot be watched or cargo cannot be started.
pub fn watch(folder: &Folder, only: Option<&str>) -> Result<(), String> {
    let (_watcher, events) = watcher(folder)?;
    let watched: Vec<&str> = match only {
        Some(slug) => vec![selection::named(slug)?.slug],
        None => EXERCISES.iter().map(|exercise| exercise.slug).collect(),
    };
    let text = |slug: &&str| read(&folder.answer(slug)).unwrap_or_default();
    let mut texts: Vec<String> = watched.iter().map(text).collect();
    println!("watching {} for {}", folder.answers().display(), watched.join(", "));
    loop {
        for (slug, former) in watched.iter().zip(&mut texts) {
            let now = text(slug);
            if now != *former {
                *former = now;
                println!("\n{slug} was saved");
                selection::run(folder.path(), slug, &[])?;
            }
        }
        // One save makes several events; they are one.
        let ended = |_| "the files are watched no longer".to_owned();
        events.recv().map_err(ended)?.map_err(|error| error.to_string())?;
        while events.recv_timeout(Duration::from_millis(50)).is_ok() {}
    }
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
    println!(
        "this file system does not tell of changes, so the files are looked at twice a second"
    );
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
