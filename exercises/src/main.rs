//! `cargo run -p exercises`: progress, hints, fresh skeletons and a watch over the files.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use exercise_runner::edition::{self, Update};
use exercise_runner::folder::Folder;
use exercise_runner::say::say;
use exercise_runner::{hints, progress, selection, watch};
use exercise_spec::{EXERCISES, Exercise};

/// The exercises of the book. Without a command it shows how far they are.
#[derive(Parser)]
#[command(name = "exercises", bin_name = "cargo run -p exercises --")]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Gives the next hint
    Hint {
        /// Name of the exercise
        name: String,
    },
    /// Puts the skeleton back and keeps the answer aside
    Reset {
        /// Name of the exercise
        name: String,
    },
    /// Brings answers to the newest edition of their skeletons and loses no work
    Update,
    /// Runs tests at once and whenever an answer is saved, and goes on when it is right
    Watch {
        /// Name of the exercise to begin with; without it, the first that is not solved
        name: Option<String>,
    },
}

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(sentence) => {
            eprintln!("{sentence}");
            ExitCode::from(2)
        }
    }
}

fn run(command: Option<Command>) -> Result<(), String> {
    let folder = Folder::here();
    match command {
        None => {
            for exercise in progress::to_judge(&folder) {
                say(format!("{} has changed; its tests run", exercise.slug));
                selection::run(folder.path(), exercise.slug, &[])?;
            }
            say(progress::list(&folder).trim_end());
        }
        Some(Command::Hint { name }) => {
            say(hints::next(&folder, selection::named(&name)?)?.trim_end());
        }
        Some(Command::Reset { name }) => {
            match edition::reset(&folder, selection::named(&name)?.slug)? {
                None => say(format!("{name} is the skeleton")),
                Some(former) => say(format!(
                    "{name} is a skeleton again; the former answer is {}",
                    former.display()
                )),
            }
        }
        Some(Command::Update) => update_all(&folder)?,
        Some(Command::Watch { name }) => watch::watch(&folder, name.as_deref())?,
    }
    Ok(())
}

/// Updates every answer. One that cannot be updated is told in the end and holds up no other.
fn update_all(folder: &Folder) -> Result<(), String> {
    let failed = EXERCISES.iter().filter_map(|exercise| update(folder, exercise).err());
    match failed.collect::<Vec<_>>() {
        failed if failed.is_empty() => Ok(()),
        failed => Err(failed.join("\n")),
    }
}

fn update(folder: &Folder, exercise: &Exercise) -> Result<(), String> {
    let slug = exercise.slug;
    match edition::update(folder, slug)? {
        Update::Current(edition) => say(format!("{slug}: edition {edition}, the newest")),
        Update::Merged { edition, former } => {
            say(format!("{slug}: now edition {edition}; the former file is {}", former.display()));
        }
        Update::Conflict { edition, merged } => say(format!(
            "{slug}: edition {edition} changes lines that you changed too, so your file stays as \
             it is; both together are {}",
            merged.display()
        )),
    }
    Ok(())
}
