//! Measured pixels in COLMAP's incremental mapper, with the matches that the book's library gets.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::pixels::{LADYBUG, WRONG};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::python::Python;
use crate::record::RecordValue;
use crate::release;

const VARIABLE: &str = "VISLAM_PYCOLMAP";
/// Each is timed so often; the least counts.
const RUNS: usize = 3;

/// What the last line of both says, and what is kept of it: name, unit, digits and what may differ.
const KEPT: [(&str, &str, usize, f64); 3] =
    [("registered", "", 0, 0.0), ("centres_percent", "%", 2, 20.0), ("seconds", "s", 1, 3.0)];

pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("wrong matches", format!("none, and {WRONG} of all")),
        ("COLMAP", "pycolmap 4.2.1, its own verification, intrinsics held".to_owned()),
    ];
    chapter.record_of_data("real_pixels_colmap", &[LADYBUG], inputs, beside_colmap);
}

fn beside_colmap() -> Result<Vec<RecordValue>, NotMade> {
    LADYBUG.read()?;
    let python = Python::with("pycolmap", VARIABLE)?;
    let absent = |_| NotMade::DataAbsent("VISLAM_DATA is not set".into());
    let problem = PathBuf::from(std::env::var("VISLAM_DATA").map_err(absent)?).join(LADYBUG.path);
    let folder = tempfile::tempdir().map_err(|error| NotMade::Failed(error.to_string()))?;
    let mut values = Vec::new();
    for (name, share) in [("clean", 0.0), ("wrong", WRONG)] {
        let [ours, colmap] = both(&python, &problem, share, folder.path())?;
        for (whose, line) in [("ours", ours), ("colmap", colmap)] {
            for (field, unit, decimals, within) in KEPT {
                let value = line.get(field).copied().unwrap_or(f64::NAN);
                let name = format!("{name}_{whose}_{}", field.trim_end_matches("_percent"));
                values.push(RecordValue::new(name, value, unit, decimals, within));
            }
        }
    }
    Ok(values)
}

type Line = BTreeMap<String, f64>;

/// The same matches here and in COLMAP, in turn.
fn both(python: &Python, problem: &Path, share: f64, folder: &Path) -> Result<[Line; 2], NotMade> {
    let [matches, centres] = ["matches.txt", "centres.txt"].map(|name| folder.join(name));
    let [problem, list, compared] =
        [problem, &matches, &centres].map(|path| path.display().to_string());
    let share = share.to_string();
    let arguments = [&*problem, "--wrong", &share, "--matches", &list, "--centres", &compared];
    let mut least: [Line; 2] = Default::default();
    for _ in 0..RUNS {
        let ours = release::said(&["--package", "vislam", "--example", "reconstruct"], &arguments)?;
        let colmap = python.run("reconstruct_pycolmap.py", &[&matches, &centres])?;
        for (least, said) in least.iter_mut().zip([ours, colmap]) {
            let now = last_line(&said);
            if least.is_empty() || now.get("seconds") < least.get("seconds") {
                *least = now;
            }
        }
    }
    Ok(least)
}

/// Names and numbers of the last line.
fn last_line(said: &str) -> Line {
    let words: Vec<&str> = said.lines().last().unwrap_or_default().split_whitespace().collect();
    let named = |pair: &[&str]| Some((pair[0].to_owned(), pair[1].parse().ok()?));
    words.windows(2).filter_map(named).collect()
}
