//! Hints, one more at each request.

use exercise_spec::Exercise;

use crate::folder::{Folder, read};
use crate::selection::wrapped;

/// The next hint of an exercise, after those that were given already.
///
/// # Errors
///
/// When what was given cannot be kept.
pub fn next(folder: &Folder, exercise: &Exercise) -> Result<String, String> {
    let name = format!("{}.hints", exercise.slug);
    let given: usize =
        read(&folder.kept(&name)).ok().and_then(|text| text.trim().parse().ok()).unwrap_or(0);
    let ladder = exercise.hint_ladder();
    let number = (given + 1).min(ladder.len());
    folder
        .keep(&name, &number.to_string())
        .map_err(|error| format!("cannot keep which hints were given: {error}"))?;
    let last = if number == ladder.len() { ", the last" } else { "" };
    let hint = ladder.get(number.saturating_sub(1)).map_or("", String::as_str);
    Ok(format!("Hint {number} of {}{last}\n\n{}\n", ladder.len(), wrapped(hint, 96)))
}
