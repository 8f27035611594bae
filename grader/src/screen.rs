//! The source screen: what an answer may not say, with a reason and a way out.
//!
//! It reads tokens and not text, so that raw identifiers, attributes and the insides of macros
//! count, and comments and strings do not. It is a courtesy and no wall: what would get past it
//! meets the list of files that the compiler read, and a machine that has nothing to reach.

mod forbidden;
mod names;
mod paths;
mod words;

use exercise_runner::tokens::Tokens;
use exercise_spec::exercise;

use names::Names;

/// How many findings are told.
const TOLD: usize = 5;

/// Looks at an answer.
///
/// # Errors
///
/// What it may not say, one finding a line: the line of the file, what stands there, why it may
/// not, and what to do instead.
pub fn screen(slug: &str, text: &str) -> Result<(), String> {
    let tokens = Tokens::of(text)?;
    let names = Names::of(&tokens);
    let mut findings: Vec<(usize, String)> = words::findings(&tokens, &names);
    findings.extend(paths::findings(&tokens, slug));
    let items = exercise(slug).map_or(&[][..], |exercise| exercise.forbidden);
    findings.extend(forbidden::findings(&tokens, &names, items));
    findings.sort();
    findings.dedup();
    let others = findings.len().saturating_sub(TOLD);
    findings.truncate(TOLD);
    let mut lines: Vec<String> =
        findings.into_iter().map(|(line, sentence)| format!("line {line}: {sentence}")).collect();
    if others > 0 {
        lines.push(format!("and {others} more of the kind"));
    }
    if lines.is_empty() { Ok(()) } else { Err(lines.join("\n")) }
}
