//! The book's exhibits as a program.
//!
//! ```text
//! exhibits list                    what there is, as JSON
//! exhibits chapter SLUG FOLDER     writes a chapter's checks, numbers and figures
//! exhibits record NAME             makes a record, as JSON; ends with 3 where its data is absent
//! ```

use std::path::Path;
use std::process::ExitCode;

use exhibits::data::NotMade;
use exhibits::{list, make_record, write_chapter};

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
