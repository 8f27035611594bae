//! Grades the answers of this repository, as those of somebody who hands them in.

use std::fs;
use std::path::{Path, PathBuf};

use crate::batch::{self, Order, Trouble};
use crate::judge::Judge;
use crate::memory::Memory;
use crate::report::Detail;
use crate::repository;

/// Grades answers of a folder, or of `exercises/src`, all of them or those that are named, and shows
/// what would be told. Says whether all of them could be graded.
///
/// # Errors
///
/// A sentence when a name is none, or nothing can be graded here.
pub fn grade(names: Vec<String>, answers: Option<PathBuf>) -> Result<bool, String> {
    let out = repository().join("target/grader/mine");
    // What was said of former answers goes.
    let _ = fs::remove_dir_all(&out);
    let order = Order {
        submissions: vec![answers.unwrap_or_else(|| repository().join("exercises/src"))],
        single: true,
        exercises: names,
        seed: None,
        detail: Detail::Hint,
        out: out.clone(),
        roster: None,
        points: None,
        marks: None,
        jobs: None,
        memory: None,
    };
    let memory = Memory::of(order.memory)?;
    let finished = batch::carry_out_with(&order, |points, seed, exercises| {
        Judge::prepare(points, seed, exercises, memory)
    });
    let finished = finished.map_err(|trouble| match trouble {
        Trouble::Usage(sentence) | Trouble::CouldNotGrade(sentence) => sentence,
    })?;
    println!("{}\n\nDrawings and reports are in {}", feedback(&out).trim_end(), out.display());
    Ok(finished.ungraded == 0)
}

/// The feedback on the one submission of a batch.
fn feedback(out: &Path) -> String {
    let folders = fs::read_dir(out.join("submissions")).into_iter().flatten().flatten();
    let texts = folders.flat_map(|folder| fs::read_to_string(folder.path().join("feedback.md")));
    texts.collect()
}
