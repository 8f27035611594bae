//! `cargo book`: builds, checks and serves the book.

use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context, Result, bail};
use clap::{Parser, Subcommand};
use mdbook_preprocessor::{Preprocessor, parse_input};
use press::accept;
use press::fault::Faults;
use press::figures;
use press::guard::Guard;
use press::make::Maker;
use press::new;
use press::pack;
use press::preprocess::Press;
use press::program::DataAbsent;
use press::serve;
use press::settings::Layout;
use press::steps::Steps;
use press::warnings::Warnings;
use tracing_subscriber::prelude::*;

/// Builds, checks and serves the book.
#[derive(Parser)]
#[command(name = "cargo book", bin_name = "cargo book", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// The folder of the book; without it, the nearest one above that has a book.toml.
    #[arg(long, global = true)]
    root: Option<PathBuf>,
}

#[derive(Subcommand)]
enum Command {
    /// Build everything, serve it on this machine and follow every change.
    Serve {
        /// The port to serve on.
        #[arg(long, default_value_t = 3000)]
        port: u16,
        /// Open the book in a browser.
        #[arg(long)]
        open: bool,
        /// Show your answers to exercises on their pages, beside what is expected.
        #[arg(long)]
        mine: bool,
    },
    /// Build the book into book/.
    Build,
    /// Try everything that can fail, and leave book/ alone.
    Check,
    /// Show the equations and records that changed, and accept them.
    Accept {
        /// Only show them.
        #[arg(long)]
        show: bool,
        /// Only carry over equations that moved to another chapter unchanged.
        #[arg(long)]
        moved: bool,
    },
    /// Make a record again: a computation too long for every build.
    Record {
        /// The name of the record; with --compare, all of them when none is named.
        name: Option<String>,
        /// Only compare with the accepted record, and fail when it comes out otherwise.
        #[arg(long)]
        compare: bool,
    },
    /// Record the scenes in three dimensions, and put them and their viewer beside the book.
    Viewer,
    /// Write the figures of the book that was built last for slides: SVG, PNG and their captions.
    Figures {
        /// A new folder.
        folder: PathBuf,
    },
    /// Make what can be taken along: the pages as one file that opens from a disk, and the book on paper as a PDF.
    ///
    /// The PDF is printed by Chromium: the one on the path, or the one that the variable CHROMIUM names.
    Pack {
        /// The folder of pages that are built already; without it, the book is built first.
        #[arg(long)]
        site: Option<PathBuf>,
        /// The folder for both files; without it, pack/ in the folder of the book.
        #[arg(long)]
        into: Option<PathBuf>,
    },
    /// Make the files of a new chapter, all of them registered.
    New {
        /// The word that leads to everything of the chapter, as a Rust module: `loop_closure`.
        name: String,
        /// Its title; without it, the name.
        #[arg(long)]
        title: Option<String>,
    },
    /// Serve mdBook as a preprocessor, so that a plain `mdbook build` makes the same pages.
    #[command(hide = true)]
    Preprocess {
        /// `press` or `guard`.
        name: String,
        /// `supports RENDERER`, asked by mdBook.
        question: Vec<String>,
    },
}

fn main() -> ExitCode {
    let warnings = Warnings::default();
    tracing_subscriber::registry().with(warnings.clone()).init();
    match run(Arguments::parse(), warnings) {
        Ok(faults) if faults.is_empty() => ExitCode::SUCCESS,
        Ok(faults) => {
            eprint!("\n{}", faults.report());
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: Arguments, warnings: Warnings) -> Result<Faults> {
    let maker = |steps| -> Result<Maker> {
        let root = root(arguments.root.as_deref())?;
        Ok(Maker { layout: Layout { root }, steps, warnings: warnings.clone(), mine: false })
    };
    match arguments.command {
        Command::Serve { port, open, mine } => {
            let maker = Maker { mine, ..maker(Steps::new())? };
            serve::serve(&maker, port, open).map(|()| Faults::default())
        }
        Command::Build => maker(Steps::new())?.build_book(),
        Command::Check => {
            let maker = maker(Steps::new())?;
            maker.build(&maker.layout.work().join("checked"))
        }
        Command::Accept { show, moved } => {
            accept::accept(&maker(Steps::new())?, show, moved).map(|()| Faults::default())
        }
        Command::Viewer => maker(Steps::new())?.make_viewer().map(|()| Faults::default()),
        Command::Record { name, compare } => record(&maker(Steps::new())?, name, compare),
        Command::Figures { folder } => {
            let number = figures::export(&maker(Steps::new())?, &folder)?;
            println!("{number} figures and captions.md are in {}", folder.display());
            Ok(Faults::default())
        }
        Command::Pack { site, into } => pack(&maker(Steps::new())?, site, into),
        Command::New { name, title } => {
            let layout = maker(Steps::new())?.layout;
            let written = new::chapter(&layout, &name, title.as_deref())?;
            written.iter().for_each(|file| println!("{file}"));
            println!("{}", new::next(&name));
            Ok(Faults::default())
        }
        Command::Preprocess { question, .. }
            if question.first().is_some_and(|word| word == "supports") =>
        {
            // Every renderer gets the same pages.
            Ok(Faults::default())
        }
        Command::Preprocess { name, .. } => preprocess(&maker(Steps::quiet())?, &name),
    }
}

fn root(given: Option<&Path>) -> Result<PathBuf> {
    let start = match given {
        Some(root) => root.to_path_buf(),
        None => std::env::current_dir().context("the current folder is gone")?,
    };
    // Events name files by their real paths; on Windows dunce leaves out the prefix that forbids slashes.
    let start = dunce::canonicalize(&start)
        .with_context(|| format!("{} is not a folder", start.display()))?;
    let mut folders = start.ancestors().take(if given.is_some() { 1 } else { usize::MAX });
    let found = folders.find(|folder| folder.join("book.toml").is_file());
    found.map(Path::to_path_buf).with_context(|| {
        format!(
            "there is no book.toml in {}: run `cargo book` in the book's folder",
            start.display()
        )
    })
}

/// Packs pages that are there, or those of the book as it is now.
fn pack(maker: &Maker, site: Option<PathBuf>, into: Option<PathBuf>) -> Result<Faults> {
    let root = &maker.layout.root;
    if site.is_none() {
        let faults = maker.build_book()?;
        if !faults.is_empty() {
            return Ok(faults);
        }
    }
    let site = site.unwrap_or_else(|| root.join("book"));
    let into = into.unwrap_or_else(|| root.join("pack"));
    pack::pack(&maker.layout, &maker.steps, &site, &into)
}

fn record(maker: &Maker, name: Option<String>, compare: bool) -> Result<Faults> {
    let all = name.is_none();
    let names = match (name, compare) {
        (Some(name), _) => vec![name],
        (None, true) => accept::record_names(maker)?,
        (None, false) => bail!(
            "which record? `cargo book record NAME`; the accepted ones are: {}",
            accept::record_names(maker)?.join(", ")
        ),
    };
    let mut faults = Faults::default();
    for name in names {
        let same = match accept::record(maker, &name, compare) {
            // Whoever asks for all of them gets those that can be made here.
            Err(error) if all && error.is::<DataAbsent>() => {
                println!("record {name}: not compared: {error}");
                continue;
            }
            same => same?,
        };
        if !same && compare {
            let file = format!("exhibits/records/{name}.toml");
            faults.add((&file, 0), &name, "the record does not come out as it was accepted", format!("find out why; if it is right, `cargo book record {name}` and `cargo book accept`"));
        }
    }
    Ok(faults)
}

/// One preprocessing step of a plain `mdbook build`: the book comes in, and goes out again.
fn preprocess(maker: &Maker, name: &str) -> Result<Faults> {
    let (context, book) = parse_input(io::stdin()).map_err(|error| anyhow::anyhow!("{error:#}"))?;
    let faults = Arc::new(Mutex::new(Faults::default()));
    let book = match name {
        "press" => {
            maker.refresh_exhibits()?;
            maker.refresh_widgets()?;
            Press::new(maker.layout.clone(), faults.clone(), None).run(&context, book)?
        }
        "guard" => Guard.run(&context, book)?,
        other => bail!("the press has no preprocessor `{other}`: it has `press` and `guard`"),
    };
    serde_json::to_writer(io::stdout(), &book).context("cannot hand the book back to mdBook")?;
    Ok(std::mem::take(&mut *faults.lock().unwrap_or_else(PoisonError::into_inner)))
}
