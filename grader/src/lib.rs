//! Grades submissions that nobody has a reason to trust.
//!
//! What a student hands in is text until the moment it runs: [`submission`] takes answer files and
//! nothing else, [`screen`] refuses what could reach outside, [`compile`] puts them onto a clean
//! tree and makes a WebAssembly module that imports nothing, [`machine`] runs it within limits, and
//! [`judge`] asks it the questions of the checks, whose answers stay here. [`batch`] does that for
//! hundreds and [`report`] tells what came out.

pub mod archive;
pub mod batch;
pub mod budget;
pub mod changes;
pub mod compile;
pub mod export;
pub mod fly;
pub mod grade;
pub mod items;
pub mod judge;
pub mod machine;
pub mod marks;
pub mod memory;
pub mod mine;
pub mod points;
pub mod report;
pub mod roster;
pub mod screen;
pub mod seed;
pub mod similarity;
pub mod submission;
pub mod text;
pub mod words;
pub mod workshop;

use std::path::{Path, PathBuf};

/// The repository of the book, from which the grader was compiled.
pub fn repository() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.canonicalize().unwrap_or(root)
}
