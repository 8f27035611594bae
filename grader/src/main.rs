//! `cargo grade`: exports the students' repository, grades submissions, and helps to write exercises.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand, ValueEnum};
use grader::batch::{self, Order};
use grader::report::Detail;
use grader::seed::Seed;
use grader::{export, fly, mine, workshop};

/// Grades the exercises of the book.
#[derive(Parser)]
#[command(name = "grade", bin_name = "cargo grade")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Writes the repository that students get
    Export {
        /// A folder that is not there yet, or an empty one
        dir: PathBuf,
        /// Leave the sources of the dependencies out: students then need a network once
        #[arg(long)]
        no_vendor: bool,
    },
    /// Grades submissions
    Run(Run),
    /// Grades your own answers, those in exercises/src, in the machine in which submissions run
    Mine {
        /// Names of exercises; without one, all
        names: Vec<String>,
        /// Another folder of answers: exercises/src of the repository that students work in
        #[arg(long, value_name = "FOLDER")]
        answers: Option<PathBuf>,
    },
    /// Flights for whole estimators: hands them out and grades what was made of them
    #[command(subcommand)]
    Fly(Fly),
    /// Makes the files of a new exercise
    New {
        /// Its name: small letters and underscores
        name: String,
        /// What its page is called
        #[arg(long)]
        title: String,
        /// The chapter it belongs to
        #[arg(long)]
        chapter: String,
    },
    /// Lists what an exercise lacks
    Check {
        /// Name of the exercise; without it, all
        name: Option<String>,
    },
}

/// What every batch is told.
#[derive(clap::Args)]
struct Batch {
    /// Submissions, or folders of submissions
    #[arg(required = true)]
    submissions: Vec<PathBuf>,
    /// Take each path for one submission, whatever it holds
    #[arg(long)]
    single: bool,
    /// What students are told about hidden checks
    #[arg(long, value_enum, default_value_t = DetailName::Hint)]
    detail: DetailName,
    /// A CSV file with the columns folder and name
    #[arg(long)]
    roster: Option<PathBuf>,
    /// Points, weights and what lateness costs, as in grader/points.toml
    #[arg(long)]
    points: Option<PathBuf>,
    /// A CSV file of what a person decides: points for answers in words, other points, comments
    #[arg(long)]
    marks: Option<PathBuf>,
    /// How many submissions at a time; without it, one for each core
    #[arg(long)]
    jobs: Option<usize>,
}

#[derive(clap::Args)]
struct Run {
    #[command(flatten)]
    batch: Batch,
    /// Grade this exercise alone; may be given more than once
    #[arg(long = "exercise", value_name = "NAME")]
    exercises: Vec<String>,
    /// Secret of 32 hexadecimal digits, from which hidden instances are drawn; a new one when not given, or that of
    /// the batch in --out
    #[arg(long, allow_hyphen_values = true, value_parser = Seed::parse)]
    seed: Option<Seed>,
    /// Where reports go, and from where a batch that was stopped goes on
    #[arg(long, default_value = "grades")]
    out: PathBuf,
    /// Memory that grading may use, in megabytes; without it, what the container allows
    #[arg(long, value_name = "MB")]
    memory: Option<u64>,
}

#[derive(Subcommand)]
enum Fly {
    /// Writes flights for everybody on a roster
    Export {
        /// A folder that is not there yet; the key of the flights goes beside it
        dir: PathBuf,
        /// A CSV file with the columns folder and name
        #[arg(long)]
        roster: PathBuf,
    },
    /// Grades what was handed in
    Run(FlyRun),
}

#[derive(clap::Args)]
struct FlyRun {
    #[command(flatten)]
    batch: Batch,
    /// The key that the export wrote beside its folder
    #[arg(long)]
    key: PathBuf,
    /// Where reports go, and from where a batch that was stopped goes on
    #[arg(long, default_value = "flight-grades")]
    out: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum DetailName {
    /// Sentences and numbers
    Full,
    /// Sentences alone
    Hint,
    /// Whether it passed
    None,
}

/// Everything was graded, or done.
const DONE: u8 = 0;
/// Something could not be graded, or done.
const COULD_NOT: u8 = 1;
/// The command was not understood.
const USAGE: u8 = 2;

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Export { dir, no_vendor } => export::export(&dir, !no_vendor).map(|()| true),
        Command::Run(run) => return grade(run),
        Command::Mine { names, answers } => mine::grade(names, answers),
        Command::Fly(Fly::Export { dir, roster }) => {
            fly::export::export(&dir, &roster).map(|()| true)
        }
        Command::Fly(Fly::Run(fly)) => {
            return told(fly::run::run(&fly.batch.order(fly.out), &fly.key));
        }
        Command::New { name, title, chapter } => {
            workshop::new(&name, &title, &chapter).map(|()| true)
        }
        Command::Check { name } => workshop::check(name.as_deref()),
    };
    match done {
        Ok(true) => ExitCode::from(DONE),
        Ok(false) => ExitCode::from(COULD_NOT),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(COULD_NOT)
        }
    }
}

impl Batch {
    /// The order of all exercises with a seed of its own.
    fn order(self, out: PathBuf) -> Order {
        Order {
            submissions: self.submissions,
            single: self.single,
            exercises: Vec::new(),
            seed: None,
            detail: self.detail.into(),
            out,
            roster: self.roster,
            points: self.points,
            marks: self.marks,
            jobs: self.jobs,
            memory: None,
        }
    }
}

fn grade(run: Run) -> ExitCode {
    let Run { batch, exercises, seed, out, memory } = run;
    told(batch::carry_out(&Order { exercises, seed, memory, ..batch.order(out) }))
}

impl From<DetailName> for Detail {
    fn from(name: DetailName) -> Self {
        match name {
            DetailName::Full => Self::Full,
            DetailName::Hint => Self::Hint,
            DetailName::None => Self::None,
        }
    }
}

/// How a batch ended.
fn told(finished: Result<batch::Finished, batch::Trouble>) -> ExitCode {
    match finished {
        Ok(finished) if finished.ungraded == 0 => ExitCode::from(DONE),
        Ok(_) => ExitCode::from(COULD_NOT),
        Err(batch::Trouble::Usage(sentence)) => {
            eprintln!("{sentence}");
            ExitCode::from(USAGE)
        }
        Err(batch::Trouble::CouldNotGrade(sentence)) => {
            eprintln!("{sentence}");
            ExitCode::from(COULD_NOT)
        }
    }
}
