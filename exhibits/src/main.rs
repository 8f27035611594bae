//! What the book shows and a program computes: checks of its equations, its numbers, figures and
//! records.
//!
//! ```text
//! exhibits list                    what there is, as JSON
//! exhibits chapter SLUG FOLDER     writes a chapter's checks, numbers and figures
//! exhibits record NAME             makes a record, as JSON; ends with 3 where its data is absent
//! ```

mod bearing;
mod bundle_adjustment;
mod chapter;
mod comparison;
mod data;
mod figure;
mod inertial;
mod least_squares;
mod manifold;
mod observability;
mod preintegration;
mod random;
mod real_flights;
mod record;
mod report;
mod reprojection;
mod scene;
mod two_views;

use std::path::Path;
use std::process::ExitCode;

use chapter::Chapter;
use data::NotMade;

/// Adds a chapter's exhibits to it.
type Register = fn(&mut Chapter);

/// Every chapter of the book by its slug. What it shows is computed when it is registered, so the records stand
/// apart.
const CHAPTERS: &[(&str, Register, Register)] = &[
    ("bearing", bearing::exhibits, bearing::records),
    ("manifold", manifold::exhibits, no_records),
    ("least_squares", least_squares::exhibits, least_squares::records),
    ("reprojection", reprojection::exhibits, no_records),
    ("two_views", two_views::exhibits, no_records),
    ("bundle_adjustment", bundle_adjustment::exhibits, bundle_adjustment::records),
    ("inertial", inertial::exhibits, inertial::records),
    ("preintegration", preintegration::exhibits, preintegration::records),
    ("real_flights", real_flights::exhibits, real_flights::records),
    ("observability", observability::exhibits, no_records),
];

fn no_records(_chapter: &mut Chapter) {}

/// What the program ends with when a record is made from data that is not here.
const DATA_ABSENT: u8 = 3;

const USAGE: &str = "exhibits list | exhibits chapter SLUG FOLDER | exhibits record NAME";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments[..] {
        ["list"] => list(),
        ["chapter", slug, folder] => write_chapter(slug, Path::new(folder)),
        ["record", name] => match make_record(name) {
            Err(NotMade::DataAbsent(sentence)) => {
                eprintln!("{sentence}");
                return ExitCode::from(DATA_ABSENT);
            }
            Err(NotMade::Failed(sentence)) => Err(sentence),
            Ok(()) => Ok(()),
        },
        _ => Err(format!("unknown arguments {arguments:?}; use {USAGE}")),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(sentence) => {
            eprintln!("exhibits: {sentence}");
            ExitCode::from(2)
        }
    }
}

/// The records of every chapter, in the order of the book.
fn records() -> Result<Vec<Chapter>, String> {
    CHAPTERS.iter().map(|(slug, _, records)| Chapter::registered(slug, records)).collect()
}

/// All that a chapter shows.
fn whole((slug, shown, records): &(&'static str, Register, Register)) -> Result<Chapter, String> {
    Chapter::registered(slug, |chapter| {
        shown(chapter);
        records(chapter);
    })
}

/// All that every chapter shows, computed once for all tests.
#[cfg(test)]
fn book() -> &'static [Chapter] {
    static BOOK: std::sync::LazyLock<Vec<Chapter>> = std::sync::LazyLock::new(|| {
        let chapters: Result<_, String> = CHAPTERS.iter().map(whole).collect();
        chapters.expect("names that are used once, and finite numbers")
    });
    &BOOK
}

fn list() -> Result<(), String> {
    println!("{}", report::list(&records()?));
    Ok(())
}

fn write_chapter(slug: &str, folder: &Path) -> Result<(), String> {
    let Some(chapter) = CHAPTERS.iter().find(|(known, ..)| *known == slug) else {
        let known: Vec<&str> = CHAPTERS.iter().map(|(slug, ..)| *slug).collect();
        return Err(format!("there is no chapter `{slug}`; there is {}", known.join(", ")));
    };
    report::write_chapter(&whole(chapter)?, folder)
        .map_err(|error| format!("cannot write to {}: {error}", folder.display()))?;
    record::missing()
}

fn make_record(name: &str) -> Result<(), NotMade> {
    for chapter in &records().map_err(NotMade::Failed)? {
        if let Some(record) = chapter.records.iter().find(|record| record.name == name) {
            let made = report::record(chapter, record)?;
            record::missing().map_err(NotMade::Failed)?;
            println!("{made}");
            return Ok(());
        }
    }
    let sentence = format!("there is no record `{name}`; `exhibits list` names them");
    Err(NotMade::Failed(sentence))
}
