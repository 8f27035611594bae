//! What the book shows and a program computes: checks of its equations, its numbers, figures and
//! records.

pub mod algorithms;
pub mod bearing;
pub mod bundle_adjustment;
pub mod chapter;
pub mod comparison;
pub mod consistency;
pub mod counter;
pub mod data;
pub mod diagram;
pub mod factrs;
pub mod figure;
pub mod filtering;
pub mod inertial;
pub mod initialization;
pub mod least_squares;
pub mod loop_closure;
pub mod manifold;
pub mod marginalization;
pub mod msckf;
pub mod observability;
pub mod odometry;
pub mod one_flight;
pub mod preintegration;
pub mod python;
pub mod random;
pub mod real_flights;
pub mod record;
pub mod release;
pub mod report;
pub mod reprojection;
pub mod robust_two_view;
pub mod scene;
pub mod smoother;
pub mod statistics;
pub mod structure_from_motion;
pub mod systems;
pub mod two_views;
pub mod your_own_data;

use std::path::Path;

use chapter::Chapter;
use data::NotMade;

/// Adds a chapter's exhibits to it.
pub type Register = fn(&mut Chapter);

/// Every chapter of the book by its slug. What it shows is computed when it is registered, so the records stand
/// apart.
pub const CHAPTERS: &[(&str, Register, Register)] = &[
    ("bearing", bearing::exhibits, bearing::records),
    ("manifold", manifold::exhibits, no_records),
    ("least_squares", least_squares::exhibits, least_squares::records),
    ("reprojection", reprojection::exhibits, no_records),
    ("two_views", two_views::exhibits, no_records),
    ("robust_two_view", robust_two_view::exhibits, robust_two_view::records),
    ("bundle_adjustment", bundle_adjustment::exhibits, bundle_adjustment::records),
    ("structure_from_motion", structure_from_motion::exhibits, structure_from_motion::records),
    ("inertial", inertial::exhibits, inertial::records),
    ("preintegration", preintegration::exhibits, preintegration::records),
    ("real_flights", real_flights::exhibits, real_flights::records),
    ("observability", observability::exhibits, no_records),
    ("initialization", initialization::exhibits, initialization::records),
    ("filtering", filtering::exhibits, filtering::records),
    ("msckf", msckf::exhibits, msckf::records),
    ("marginalization", marginalization::exhibits, no_records),
    ("consistency", consistency::exhibits, consistency::records),
    ("smoother", smoother::exhibits, smoother::records),
    ("odometry", odometry::exhibits, odometry::records),
    ("algorithms", algorithms::exhibits, no_records),
    ("factrs", factrs::exhibits, factrs::records),
    ("loop_closure", loop_closure::exhibits, loop_closure::records),
    ("systems", systems::exhibits, no_records),
    ("your_own_data", your_own_data::exhibits, your_own_data::records),
];

fn no_records(_chapter: &mut Chapter) {}

/// The records of every chapter, in the order of the book.
fn records() -> Result<Vec<Chapter>, String> {
    CHAPTERS.iter().map(|(slug, _, records)| Chapter::registered(slug, records)).collect()
}

/// All that a chapter shows.
pub fn whole(
    (slug, shown, records): &(&'static str, Register, Register),
) -> Result<Chapter, String> {
    Chapter::registered(slug, |chapter| {
        shown(chapter);
        records(chapter);
    })
}

/// Prints what there is, as JSON.
pub fn list() -> Result<(), String> {
    println!("{}", report::list(&records()?));
    Ok(())
}

/// Writes what a chapter shows into a folder.
pub fn write_chapter(slug: &str, folder: &Path) -> Result<(), String> {
    let Some(chapter) = CHAPTERS.iter().find(|(known, ..)| *known == slug) else {
        let known: Vec<&str> = CHAPTERS.iter().map(|(slug, ..)| *slug).collect();
        return Err(format!("there is no chapter `{slug}`; there is {}", known.join(", ")));
    };
    report::write_chapter(&whole(chapter)?, folder)
        .map_err(|error| format!("cannot write to {}: {error}", folder.display()))?;
    record::missing()
}

/// Makes a record and prints it, as JSON.
pub fn make_record(name: &str) -> Result<(), NotMade> {
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
