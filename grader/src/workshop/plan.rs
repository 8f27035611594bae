//! What a new exercise makes and changes.

use std::fs;
use std::path::Path;

use crate::export::editions;

use super::change::Change;
use super::lists::{self, Beside};
use super::names;
use super::taken;

/// A new exercise.
struct New<'a> {
    name: &'a str,
    title: &'a str,
    chapter: &'a str,
    edition: u32,
}

/// Everything that a new exercise makes and changes in a repository, new files first.
///
/// # Errors
///
/// A sentence when the name, the title or the chapter cannot be, or a list is not as expected.
pub fn plan(root: &Path, name: &str, title: &str, chapter: &str) -> Result<Vec<Change>, String> {
    names::name(name)?;
    names::title(title)?;
    let summary = read(root, "src/SUMMARY.md")?;
    let chapters = lists::chapters(&summary);
    if !chapters.contains(&chapter) {
        let shown = crate::text::harmless_line(chapter, 60);
        let known = chapters.join(", ");
        return Err(format!("src/SUMMARY.md has no chapter `{shown}`; it has {known}"));
    }
    if let Some(by) = taken::by(root, name)? {
        return Err(format!("`{name}` is taken: {by} has it; choose another name"));
    }
    if read(root, "src/exercises.md")?.contains(&format!("[{title}](")) {
        return Err(format!("the title `{title}` is taken; choose another one"));
    }
    let editions = editions(root)?;
    let edition = *editions.last().ok_or("exercises/skeletons has no edition")?;
    let exercise = New { name, title, chapter, edition };
    let mut changes = exercise.files();
    changes.extend(exercise.entries(root, &summary)?);
    Ok(changes)
}

impl New<'_> {
    /// The files of its own.
    fn files(&self) -> Vec<Change> {
        let New { name, edition, .. } = self;
        let skeleton = include_str!("../../exercise/skeleton.rs");
        let files = [
            (format!("exercises/spec/src/{name}.rs"), include_str!("../../exercise/spec.rs")),
            (
                format!("exercises/spec/src/{name}/checks.rs"),
                include_str!("../../exercise/checks.rs"),
            ),
            (
                format!("exercises/spec/src/{name}/hints.md"),
                include_str!("../../exercise/hints.md"),
            ),
            (format!("exercises/src/{name}.rs"), skeleton),
            (format!("exercises/skeletons/{edition}/{name}.rs"), skeleton),
            (format!("exercises/tests/{name}.rs"), include_str!("../../exercise/target.rs")),
            (
                format!("exercises/pictures/modules/{name}.rs"),
                include_str!("../../exercise/picture.rs"),
            ),
            (format!("solutions/src/{name}.rs"), include_str!("../../exercise/reference.rs")),
            (
                format!("solutions/src/misconceptions/{name}.rs"),
                include_str!("../../exercise/misconceptions.rs"),
            ),
            (format!("tests/src/{name}.rs"), include_str!("../../exercise/hidden.rs")),
            (format!("tests/rubrics/{name}.md"), include_str!("../../exercise/rubric.md")),
            (format!("src/exercises/{name}.md"), include_str!("../../exercise/page.md")),
        ];
        let made =
            |(path, text): (String, &str)| Change { path, before: None, after: self.filled(text) };
        files.into_iter().map(made).collect()
    }

    fn filled(&self, text: &str) -> String {
        text.replace("{title}", self.title)
            .replace("{lower}", &names::lower(self.title))
            .replace("{chapter}", self.chapter)
            .replace("{edition}", &self.edition.to_string())
            .replace("{hyphens}", &self.name.replace('_', "-"))
            .replace("{name}", self.name)
    }

    /// The lists it enters.
    fn entries(&self, root: &Path, summary: &str) -> Result<Vec<Change>, String> {
        let New { name, title, chapter, .. } = self;
        let page = format!("    - [Exercise: {}](exercises/{name}.md)", names::lower(title));
        let entered = lists::page(summary, chapter, &page).unwrap_or_default();
        let beside = Beside::of(name, &entered).ok_or("src/SUMMARY.md has no other exercise")?;
        let other = beside.name.as_str();
        let module = |text: &str| lists::module(text, name);
        let listed = |like: fn(&str) -> String| {
            let beside = &beside;
            move |text: &str| {
                beside.line(&module(text)?, &|line| line == like(&beside.name), &like(name))
            }
        };
        let line = |has: String, new: &str| {
            let (beside, new) = (&beside, self.filled(new));
            move |text: &str| beside.line(text, &|line| line.contains(&has), &new)
        };
        let section = |begin: &'static str, has: String, new: &str| {
            let (beside, new) = (&beside, self.filled(new));
            move |text: &str| beside.section(text, begin, &has, &new)
        };
        let points = |text: &str| {
            let its = format!("{other} = ");
            beside.line(text, &|line| line.starts_with(&its), &format!("{name} = 10"))
        };
        let target = format!("name = \"{other}\"");
        let edits: [(&str, &Edit<'_>); 11] = [
            ("exercises/spec/src/lib.rs", &listed(|name| format!("    &{name}::EXERCISE,"))),
            ("exercises/Cargo.toml", &section("[[test]]", target.clone(), TARGET)),
            ("exercises/pictures/Cargo.toml", &section("[[example]]", target, MODULE)),
            ("exercises/answers.md", &section("## ", format!("## {other}"), QUESTION)),
            ("solutions/src/lib.rs", &listed(|name| format!("        {name},"))),
            ("solutions/src/misconceptions/mod.rs", &module),
            ("tests/src/lib.rs", &listed(arm)),
            ("grader/points.toml", &points),
            ("src/SUMMARY.md", &|_| Some(entered.clone())),
            ("src/exercises.md", &line(format!("](exercises/{other}.md) |"), ROW)),
            (
                "src/instructors/misconceptions.md",
                &section("## ", format!("The exercise is `{other}`."), TABLE),
            ),
        ];
        edits.into_iter().map(|(path, edit)| entry(root, path, other, edit)).collect()
    }
}

/// The line of the hidden checks.
fn arm(name: &str) -> String {
    format!("        \"{name}\" => Some({name}::checks(seed)),")
}

/// What becomes of the text of a list; nothing where the neighbour has no entry.
type Edit<'a> = dyn Fn(&str) -> Option<String> + 'a;

/// The change of one list.
fn entry(root: &Path, path: &str, beside: &str, edit: &Edit<'_>) -> Result<Change, String> {
    let before = read(root, path)?;
    let after = edit(&before).ok_or_else(|| {
        format!("{path} has no entry of `{beside}` to stand beside; mend that first")
    })?;
    Ok(Change { path: path.to_owned(), before: Some(before), after })
}

const TARGET: &str = "[[test]]\nname = \"{name}\"\nharness = false\ntest = false";

const MODULE: &str =
    "[[example]]\nname = \"{name}\"\npath = \"modules/{name}.rs\"\ncrate-type = [\"cdylib\"]";

const QUESTION: &str = "## {name}\n\nTODO: a question that wants words, with its rubric in \
    `tests/rubrics/{name}.md`.";

const ROW: &str = "| [{title}](exercises/{name}.md) | `{name}` | @sec:{chapter} |";

/// As the tests of the exercises write it.
const TABLE: &str = "## {title}\n\nThe exercise is `{name}`.\n
| Mistake | What the student reads | Named by |
| --- | --- | --- |
| negated | TODO: what the output shows, and a question that leads on without the answer. | the number is doubled |";

/// The text of a file of the repository.
pub(super) fn read(root: &Path, path: &str) -> Result<String, String> {
    fs::read_to_string(root.join(path)).map_err(|error| format!("cannot read {path}: {error}"))
}
