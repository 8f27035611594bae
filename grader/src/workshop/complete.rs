//! What an exercise lacks.
//!
//! It is read off the files and not off the compiled program, because an exercise that lacks
//! something may not compile.

use std::fs;
use std::path::Path;

use crate::export::newest_skeleton;

use super::lists::{between, pages, sections};

/// Wrong answers that an exercise has at least.
const MISCONCEPTIONS: usize = 4;
/// Hints that it has at least.
const HINTS: usize = 3;

/// Names of all exercises: those of the list, and then those that have a file or an entry
/// somewhere.
///
/// # Errors
///
/// A sentence when the list cannot be read.
pub fn names(root: &Path) -> Result<Vec<String>, String> {
    let list = "exercises/spec/src/lib.rs";
    let text = fs::read_to_string(root.join(list))
        .map_err(|error| format!("cannot read {list}: {error}"))?;
    let listed = text.lines().filter_map(|line| between(line.trim(), "&", "::EXERCISE,"));
    let mut names: Vec<String> = listed.map(str::to_owned).collect();
    let mut more: Vec<String> = Vec::new();
    for folder in ["exercises/src", "solutions/src", "tests/src", "src/exercises", "tests/rubrics"]
    {
        more.extend(stems(&root.join(folder)));
    }
    let summary = fs::read_to_string(root.join("src/SUMMARY.md")).unwrap_or_default();
    more.extend(pages(&summary).into_iter().map(str::to_owned));
    more.sort();
    more.dedup();
    more.retain(|name| !names.contains(name) && name != "lib" && name != "main");
    // A chapter may ask something in words, and has a rubric too.
    more.retain(|name| !root.join("src").join(name).with_extension("md").is_file());
    names.extend(more);
    Ok(names)
}

/// Names of the files of a folder without their endings.
fn stems(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.map(|entry| entry.path()).filter(|path| path.is_file());
    files.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned())).collect()
}

/// What an exercise lacks, each as a sentence that says where; nothing when it is complete.
pub fn lacks(root: &Path, name: &str) -> Vec<String> {
    let mut look = Look { root, name, lacks: Vec::new() };
    look.declaration();
    look.hints();
    look.skeleton();
    look.target();
    look.picture();
    look.answers();
    look.hidden();
    look.words();
    look.page();
    look.points();
    look.placeholders();
    look.lacks
}

/// A look at an exercise.
struct Look<'a> {
    root: &'a Path,
    name: &'a str,
    lacks: Vec<String>,
}

impl Look<'_> {
    fn lack(&mut self, sentence: impl Into<String>) {
        self.lacks.push(sentence.into());
    }

    /// The text of a file; nothing, and a sentence, when there is none.
    fn file(&mut self, path: &str, what: &str) -> Option<String> {
        match fs::read_to_string(self.root.join(path)) {
            Ok(text) => Some(text),
            Err(error) => {
                self.lack(format!("{path}: {what} cannot be read: {error}"));
                None
            }
        }
    }

    /// The text of a file that is looked at elsewhere too.
    fn text(&self, path: &str) -> String {
        fs::read_to_string(self.root.join(path)).unwrap_or_default()
    }

    /// A sentence unless a list has a line.
    fn entry(&mut self, path: &str, line: &str) {
        if !self.text(path).lines().any(|found| found.trim() == line) {
            self.lack(format!("{path}: the line `{line}` is missing"));
        }
    }

    /// A sentence unless a text has all of the words.
    fn has(&mut self, path: &str, text: &str, words: &[(String, &str)]) {
        for (word, why) in words {
            if !text.contains(word.as_str()) {
                self.lack(format!("{path}: there is no `{word}`, {why}"));
            }
        }
    }

    /// The declaration.
    fn spec(&self) -> String {
        self.text(&format!("exercises/spec/src/{}.rs", self.name))
    }

    /// The path of its checks.
    fn checks(&self) -> String {
        format!("exercises/spec/src/{}/checks.rs", self.name)
    }

    fn declaration(&mut self) {
        let name = self.name;
        self.entry("exercises/spec/src/lib.rs", &format!("pub mod {name};"));
        self.entry("exercises/spec/src/lib.rs", &format!("&{name}::EXERCISE,"));
        let path = format!("exercises/spec/src/{name}.rs");
        let Some(spec) = self.file(&path, "the declaration") else { return };
        let gated = "#[cfg(feature = \"checks\")]\nmod checks;";
        self.has(&path, &spec, &[(gated.to_owned(), "so answers are compiled beside the checks")]);
        if functions(&spec).is_empty() {
            self.lack(format!("{path}: `signatures!` declares no function"));
        }
        let path = self.checks();
        let Some(checks) = self.file(&path, "the file of checks") else { return };
        self.has(
            &path,
            &checks,
            &[
                (format!("slug: \"{name}\""), "by which everything of it is found"),
                ("Check::new(".to_owned(), "and an exercise needs checks"),
            ],
        );
        let known = misconceptions(&checks).len();
        if known < MISCONCEPTIONS {
            self.lack(format!(
                "{path}: of {MISCONCEPTIONS} misconceptions that an exercise names at least there \
                 are {known}"
            ));
        }
    }

    fn hints(&mut self) {
        let path = format!("exercises/spec/src/{}/hints.md", self.name);
        let Some(text) = self.file(&path, "the file of hints") else { return };
        let count = hints(&text);
        if count < HINTS {
            self.lack(format!(
                "{path}: of {HINTS} hints that there are at least, {count} are here"
            ));
        }
        let first =
            between(&text, "<!-- ANCHOR: 1 -->", "<!-- ANCHOR_END: 1 -->").unwrap_or_default();
        if count > 0 && !first.contains('?') {
            self.lack(format!("{path}: the first hint asks nothing; it should be a question"));
        }
    }

    fn skeleton(&mut self) {
        let name = self.name;
        let path = format!("exercises/src/{name}.rs");
        let Some(skeleton) = self.file(&path, "the skeleton") else { return };
        match newest_skeleton(self.root, name) {
            Err(error) => self.lack(error),
            Ok((newest, copy)) => {
                let first = skeleton.lines().next().unwrap_or_default();
                if !first.ends_with(&format!("Edition {newest}.")) {
                    self.lack(format!(
                        "{path}: the first line does not end in `Edition {newest}.`"
                    ));
                }
                if self.text(&copy) != skeleton {
                    self.lack(format!(
                        "{path} is not {copy}; copy the skeleton, and keep answers elsewhere"
                    ));
                }
            }
        }
        let spec = self.spec();
        let checks = self.text(&self.checks());
        let types = quoted(&checks, "types: &[");
        for import in imports(&skeleton, name).iter().filter(|import| !types.contains(import)) {
            self.lack(format!(
                "{}: `types` has no `{import}`, which the skeleton imports",
                self.checks()
            ));
        }
        let functions = functions(&spec);
        for function in &functions {
            self.has(
                &path,
                &skeleton,
                &[(format!("pub fn {function}("), "which the declaration has")],
            );
        }
        let open = skeleton.matches("todo!(").count();
        if open < functions.len() {
            let count = functions.len();
            self.lack(format!(
                "{path}: `todo!` stands {open} times for {count} functions to write"
            ));
        }
    }

    fn target(&mut self) {
        let name = self.name;
        let path = format!("exercises/tests/{name}.rs");
        if let Some(target) = self.file(&path, "the test target") {
            for function in functions(&self.spec()) {
                self.has(&path, &target, &[(format!("answer::{function}"), "so it is not tested")]);
            }
        }
        let manifest: toml::Table = self.text("exercises/Cargo.toml").parse().unwrap_or_default();
        let targets = manifest.get("test").and_then(toml::Value::as_array);
        let ours = |target: &&toml::Value| {
            let is = |key: &str| target.get(key).and_then(toml::Value::as_bool) == Some(false);
            target.get("name").and_then(toml::Value::as_str) == Some(name)
                && is("harness")
                && is("test")
        };
        if !targets.is_some_and(|targets| targets.iter().any(|target| ours(&target))) {
            self.lack(format!(
                "exercises/Cargo.toml: there is no [[test]] of name `{name}` with harness = false and \
                 test = false"
            ));
        }
    }

    /// The picture that a page shows of an answer.
    fn picture(&mut self) {
        let name = self.name;
        let path = format!("exercises/pictures/modules/{name}.rs");
        if let Some(module) = self.file(&path, "the module of its picture") {
            for function in functions(&self.spec()) {
                self.has(&path, &module, &[(function.to_owned(), "so the picture cannot ask it")]);
            }
        }
        self.entry("exercises/pictures/Cargo.toml", &format!("name = \"{name}\""));
    }

    fn answers(&mut self) {
        let name = self.name;
        self.entry("solutions/src/lib.rs", &format!("pub mod {name};"));
        self.entry("solutions/src/lib.rs", &format!("{name},"));
        self.entry("solutions/src/misconceptions/mod.rs", &format!("pub mod {name};"));
        let path = format!("solutions/src/{name}.rs");
        if let Some(reference) = self.file(&path, "the reference answer") {
            for function in functions(&self.spec()) {
                self.has(
                    &path,
                    &reference,
                    &[(format!("pub fn {function}("), "which the declaration has")],
                );
            }
        }
        let path = format!("solutions/src/misconceptions/{name}.rs");
        let Some(wrong) = self.file(&path, "the file of wrong answers") else { return };
        let words: Vec<&str> = wrong.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
        let checks = self.text(&self.checks());
        for known in misconceptions(&checks).iter().filter(|known| !words.contains(known)) {
            self.lack(format!("{path}: no wrong answer shows {known}"));
        }
    }

    fn hidden(&mut self) {
        let name = self.name;
        self.entry("tests/src/lib.rs", &format!("pub mod {name};"));
        self.entry("tests/src/lib.rs", &format!("\"{name}\" => Some({name}::checks(seed)),"));
        let path = format!("tests/src/{name}.rs");
        if let Some(hidden) = self.file(&path, "the file of hidden checks") {
            self.has(&path, &hidden, &[("Check::new(".to_owned(), "so nothing is hidden")]);
        }
    }

    /// Questions that want words, and what their answers are worth.
    fn words(&mut self) {
        let name = self.name;
        let rubric = format!("tests/rubrics/{name}.md");
        match (self.question().is_some(), self.root.join(&rubric).is_file()) {
            (true, false) => self.lack(format!(
                "{rubric} is missing, and exercises/answers.md asks a question that it should weigh"
            )),
            (false, true) => self.lack(format!(
                "exercises/answers.md has no section `## {name}`, and {rubric} weighs an answer"
            )),
            _ => {}
        }
    }

    fn question(&self) -> Option<String> {
        let begin = format!("## {}\n", self.name);
        let all = sections(&self.text("exercises/answers.md"), "## ");
        all.into_iter().find(|section| section.starts_with(&begin))
    }

    fn page(&mut self) {
        let name = self.name;
        let link = format!("](exercises/{name}.md)");
        let summary = self.text("src/SUMMARY.md");
        self.has("src/SUMMARY.md", &summary, &[(link.clone(), "so the page is not in the book")]);
        let list = self.text("src/exercises.md");
        self.has("src/exercises.md", &list, &[(link, "the row of the list of exercises")]);
        let tables = self.text("src/instructors/misconceptions.md");
        self.has("src/instructors/misconceptions.md", &tables, &[(
            format!("The exercise is `{name}`."),
            "the table of its mistakes, which ACCEPT=1 cargo test -p book-tests --test exercises writes",
        )]);
        let path = format!("src/exercises/{name}.md");
        let Some(page) = self.file(&path, "the page") else { return };
        let mut words = vec![
            (format!("{{#sec:{name}"), "the label of its heading"),
            (
                format!("exercises/spec/src/{name}.rs:"),
                "so nothing is shown of what is to be written",
            ),
            ("{.predict ".to_owned(), "and every page asks for a prediction"),
            (format!("cargo test -p exercises {name}"), "so nobody knows how to run it"),
            ("{{mine}}".to_owned(), "where `cargo book serve --mine` shows the answer"),
        ];
        let count = hints(&self.text(&format!("exercises/spec/src/{name}/hints.md")));
        words.extend(
            (1..=count)
                .map(|hint| (format!("{name}/hints.md:{hint}\""), "so that hint is not shown")),
        );
        self.has(&path, &page, &words);
    }

    fn points(&mut self) {
        let points: toml::Table = self.text("grader/points.toml").parse().unwrap_or_default();
        let worth = points.get("points").and_then(|points| points.get(self.name));
        let number =
            worth.and_then(|worth| worth.as_float().or_else(|| Some(worth.as_integer()? as f64)));
        if !number.is_some_and(|number| number > 0.0) {
            self.lack(format!("grader/points.toml: `{}` is worth no points", self.name));
        }
    }

    /// Where something is still to be written.
    fn placeholders(&mut self) {
        let name = self.name;
        let files = [
            format!("exercises/spec/src/{name}.rs"),
            self.checks(),
            format!("exercises/spec/src/{name}/hints.md"),
            format!("exercises/src/{name}.rs"),
            format!("solutions/src/{name}.rs"),
            format!("solutions/src/misconceptions/{name}.rs"),
            format!("tests/src/{name}.rs"),
            format!("tests/rubrics/{name}.md"),
            format!("src/exercises/{name}.md"),
        ];
        for path in files {
            let text = self.text(&path);
            for (number, line) in
                text.lines().enumerate().filter(|(_, line)| line.contains(PLACEHOLDER))
            {
                self.lack(format!("{path}:{} is to be written: {}", number + 1, line.trim()));
            }
        }
        if self.question().is_some_and(|question| question.contains(PLACEHOLDER)) {
            self.lack(format!(
                "exercises/answers.md: the question below `## {name}` is to be written"
            ));
        }
    }
}

/// What stands where something is to be written.
const PLACEHOLDER: &str = "TODO";

/// What a macro encloses.
fn enclosed<'a>(text: &'a str, name: &str) -> &'a str {
    between(text, &format!("{name}! {{\n"), "\n}\n").unwrap_or_default()
}

/// Names of the functions that a declaration declares.
fn functions(spec: &str) -> Vec<&str> {
    let lines = enclosed(spec, "signatures").lines();
    lines.filter_map(|line| Some(line.trim().strip_prefix("fn ")?.split_once('(')?.0)).collect()
}

/// Constants of the misconceptions that checks name.
fn misconceptions(checks: &str) -> Vec<&str> {
    let lines = enclosed(checks, "misconceptions").lines();
    let constant = |name: &&str| {
        name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
    };
    lines.filter_map(|line| Some(line.trim().split_once(", \"")?.0)).filter(constant).collect()
}

/// The words in quotation marks of a list that begins so.
fn quoted<'a>(text: &'a str, begin: &str) -> Vec<&'a str> {
    between(text, begin, "]").unwrap_or_default().split('"').skip(1).step_by(2).collect()
}

/// What a skeleton imports of its declaration.
fn imports<'a>(skeleton: &'a str, name: &str) -> Vec<&'a str> {
    let listed =
        between(skeleton, &format!("use exercise_spec::{name}::"), ";").unwrap_or_default();
    let words = listed.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.filter(|word| !word.is_empty()).collect()
}

fn hints(text: &str) -> usize {
    text.matches("<!-- ANCHOR: ").count()
}
