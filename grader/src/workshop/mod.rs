//! Writing exercises: the files of a new one, and what one lacks.

mod change;
mod complete;
mod lists;
mod names;
mod plan;
mod taken;

use std::path::Path;

pub use change::{Change, apply};
pub use complete::{lacks, names};
pub use plan::plan;

/// Makes the files of a new exercise and enters it in every list. The workspace compiles at once;
/// what is to be written says `TODO`.
///
/// # Errors
///
/// A sentence when the name, the title or the chapter cannot be, or a file cannot be written. Then
/// the repository is as it was.
pub fn new(name: &str, title: &str, chapter: &str) -> Result<(), String> {
    let root = crate::repository();
    for path in new_in(&root, name, title, chapter)? {
        println!("{path}");
    }
    println!("\nEach of them says TODO where something is to be written. What is left of that:");
    println!("cargo grade check {name}");
    Ok(())
}

/// [`new`] in another repository. The paths of what was made and changed come back.
///
/// # Errors
///
/// As [`new`].
pub fn new_in(root: &Path, name: &str, title: &str, chapter: &str) -> Result<Vec<String>, String> {
    let changes = plan(root, name, title, chapter)?;
    apply(root, &changes)?;
    Ok(changes.into_iter().map(|change| change.path).collect())
}

/// Prints what an exercise lacks, or every one, and says whether nothing is missing.
///
/// # Errors
///
/// A sentence when there is no such exercise.
pub fn check(name: Option<&str>) -> Result<bool, String> {
    let (report, complete) = check_in(&crate::repository(), name)?;
    print!("{report}");
    Ok(complete)
}

/// [`check`] of another repository: what it prints, and whether nothing is missing.
///
/// # Errors
///
/// As [`check`].
pub fn check_in(root: &Path, name: Option<&str>) -> Result<(String, bool), String> {
    let all = names(root)?;
    let chosen = match name {
        None => all,
        Some(name) if all.iter().any(|known| known == name) => vec![name.to_owned()],
        Some(name) => {
            let known = all.join(", ");
            return Err(format!("there is no exercise `{name}`; there is {known}"));
        }
    };
    let (mut report, mut complete) = (String::new(), true);
    for name in chosen {
        let lacks = lacks(root, &name);
        complete &= lacks.is_empty();
        report += &match lacks.len() {
            0 => format!("{name}: complete\n"),
            1 => format!("{name}: one thing is missing\n"),
            count => format!("{name}: {count} things are missing\n"),
        };
        report.extend(lacks.iter().map(|lack| format!("  {lack}\n")));
    }
    if complete {
        report += "Whether the checks are right, cargo test -p book-tests --test exercises says.\n";
    }
    Ok((report, complete))
}
