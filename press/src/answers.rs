//! A student's answers to exercises, compiled for the browser: `cargo book serve --mine`.
//!
//! Each is a module of its own, so that one that does not compile blocks only itself. What the page loads is a script that
//! hands over the module, or what the compiler says.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use flate2::Compression;
use maud::html;
use serde::Deserialize;
use serde_json::{Value, json};
use toolchain::{TARGET, Toolchain};

use crate::compiler;
use crate::files;
use crate::packing::packed;
use crate::pages::Page;
use crate::settings::Layout;
use crate::steps::Steps;
use crate::widgets::Widgets;

/// The profile of the modules.
const PROFILE: &str = "answer";
/// The package that has them, and its folder.
const PACKAGE: &str = "exercise-pictures";
const FOLDER: &str = "exercises/pictures";
/// Where answers lie.
const WRITTEN: &str = "exercises/src";
/// What an answer may take of memory, in bytes.
const MEMORY: usize = 64 << 20;
/// What pages load to show answers; mdBook puts it on every page.
pub const SCRIPT: &str = "exercises/pictures/script/mine.js";

/// The answers that lie beside a book.
pub struct Answers<'a> {
    layout: &'a Layout,
}

/// What cargo says while it compiles.
#[derive(Deserialize)]
struct Said {
    reason: String,
    #[serde(default)]
    target: Target,
    #[serde(default)]
    message: Message,
    #[serde(default)]
    filenames: Vec<PathBuf>,
}

#[derive(Default, Deserialize)]
struct Target {
    name: String,
    kind: Vec<String>,
}

#[derive(Default, Deserialize)]
struct Message {
    level: String,
    #[serde(default)]
    rendered: Option<String>,
}

impl<'a> Answers<'a> {
    /// Those of the book that lies there.
    pub fn new(layout: &'a Layout) -> Answers<'a> {
        Answers { layout }
    }

    /// The names of all exercises that have a picture.
    pub fn names(&self) -> Result<BTreeSet<String>> {
        let files = files::below(&self.layout.root.join(FOLDER).join("modules"))?;
        Ok(files.iter().filter_map(|file| Some(file.file_stem()?.to_str()?.to_owned())).collect())
    }

    /// Whether a file, seen from the book, is an answer.
    pub fn is_answer(&self, file: &Path) -> bool {
        let name = file.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
        file.parent() == Some(Path::new(WRITTEN))
            && file.extension().is_some_and(|end| end == "rs")
            && self.names().is_ok_and(|names| names.contains(name))
    }

    /// Compiles those that changed and gives the scripts that are others now.
    ///
    /// # Errors
    /// When cargo cannot be started or a file cannot be written. What an answer has of faults is in its script.
    pub fn refresh(&self, steps: &Steps) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
        let names = self.names()?;
        match compiler::find(self.layout, steps)? {
            Ok(toolchain) => {
                let compile = || self.compiled(&toolchain, &names);
                self.keep(steps.step("compiling your answers", compile)?)
            }
            Err(why) => {
                let sentence = format!("Your answer cannot be shown: {why}.");
                let changed = self.keep(all_told(&names, &sentence))?;
                if !changed.is_empty() {
                    steps.say(&sentence);
                }
                Ok(changed)
            }
        }
    }

    /// Keeps what became of answers, and gives the scripts that are others now.
    fn keep(&self, became: BTreeMap<String, Value>) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
        let mut changed = BTreeMap::new();
        for (name, script) in became {
            let script = format!("vislamAnswer({script});\n");
            let file = self.kept(&name);
            if files::read_if_there(&file)?.as_ref() != Some(&script) {
                files::write(&file, script.as_bytes())?;
                changed.insert(loaded(&name), script.into_bytes());
            }
        }
        Ok(changed)
    }

    /// What pages load: what draws, and for each answer its module or why there is none.
    pub fn scripts(&self) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
        let mut scripts = Widgets::new(self.layout).drawing()?;
        let sheet = self.layout.root.join(SCRIPT).with_extension("css");
        scripts.insert("mine/mine.css".into(), files::read(&sheet)?.into_bytes());
        for name in self.names()? {
            let waiting = "Your answer is being compiled. The first time takes some minutes; this page follows.";
            let kept = files::read_if_there(&self.kept(&name))?;
            let script = kept.unwrap_or_else(|| format!("vislamAnswer({});\n", told(waiting, "")));
            scripts.insert(loaded(&name), script.into_bytes());
        }
        Ok(scripts)
    }

    /// The part of an exercise's page that shows the answer.
    pub fn part(&self, page: &Page) -> String {
        let (name, way) =
            (page.slug.as_str(), |folder: &str| page.way_to(&Path::new("generated").join(folder)));
        let (scripts, answers) = (format!("{}/", way("widgets")), format!("{}/", way("mine")));
        let file = format!("{WRITTEN}/{name}.rs");
        let figure = html! {
            figure.exhibit.mine data-answer=(name) data-scripts=(scripts) data-answers=(answers) {
                div.plot {}
                p.widget-note role="status" { "Your answer is loaded where the browser runs scripts and WebAssembly." }
                figcaption {
                    "Your answer, " code { (file) } ". Save the file, and the picture follows."
                }
            }
        };
        format!("## Your answer\n\n{}\n", figure.into_string())
    }

    /// For each answer its module, or what the compiler says.
    fn compiled(
        &self,
        toolchain: &Toolchain,
        names: &BTreeSet<String>,
    ) -> Result<BTreeMap<String, Value>> {
        let mut cargo = toolchain.cargo();
        cargo.args([
            "build",
            "--quiet",
            "--locked",
            "--keep-going",
            "--package",
            PACKAGE,
            "--examples",
        ]);
        cargo.args([
            "--message-format",
            "json",
            "--target",
            TARGET,
            "--profile",
            PROFILE,
            "--config",
        ]);
        cargo.arg(format!("target.{TARGET}.rustflags=[\"-Clink-arg=--max-memory={MEMORY}\"]"));
        cargo.arg("--target-dir").arg(self.layout.root.join("target/answers"));
        let output = cargo
            .current_dir(&self.layout.root)
            .output()
            .with_context(|| format!("cannot start {}", toolchain.cargo.display()))?;
        let lines = String::from_utf8_lossy(&output.stdout);
        let said: Vec<Said> =
            lines.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
        let module = |name: &String| -> Result<Value> {
            let its = |said: &&Said| said.target.name == *name && said.target.kind == ["example"];
            let artifact = said.iter().filter(its).find(|said| said.reason == "compiler-artifact");
            let file = artifact
                .and_then(|artifact| artifact.filenames.iter().find(|file| is_module(file)));
            if let Some(file) = file {
                let module = std::fs::read(file)
                    .with_context(|| format!("there is no module {}", file.display()))?;
                return Ok(json!({ "module": packed(&module, Compression::fast())? }));
            }
            let of_answer = errors(said.iter().filter(its));
            if of_answer.is_empty() {
                let all = errors(said.iter()) + &String::from_utf8_lossy(&output.stderr);
                return Ok(told("What shows your answer does not compile.", &all));
            }
            let sentence = match of_answer.contains(&format!("--> {FOLDER}/modules/{name}.rs:")) {
                true => {
                    "Your answer does not compile together with what calls it: a function is missing, is not `pub`, or \
                         takes or returns something else. Take its first line from the skeleton."
                }
                false => "Your answer does not compile.",
            };
            Ok(told(sentence, &of_answer))
        };
        names.iter().map(|name| Ok((name.clone(), module(name)?))).collect()
    }

    fn kept(&self, name: &str) -> PathBuf {
        self.layout.work().join("answers").join(format!("{name}.js"))
    }
}

/// Where the script of an answer lies among what is generated.
fn loaded(name: &str) -> PathBuf {
    Path::new("mine").join(format!("{name}.js"))
}

fn is_module(file: &Path) -> bool {
    file.extension().is_some_and(|end| end == "wasm")
}

/// Why there is no module.
fn told(sentence: &str, text: &str) -> Value {
    json!({ "sentence": sentence, "text": text })
}

/// The same for all.
fn all_told(names: &BTreeSet<String>, sentence: &str) -> BTreeMap<String, Value> {
    names.iter().map(|name| (name.clone(), told(sentence, ""))).collect()
}

/// What the compiler says of errors, with answers called as the student calls them.
fn errors<'a>(said: impl Iterator<Item = &'a Said>) -> String {
    let errors =
        said.filter(|said| said.reason == "compiler-message" && said.message.level == "error");
    let rendered = errors.filter_map(|said| said.message.rendered.clone());
    rendered
        .collect::<String>()
        .replace(&format!("{FOLDER}/modules/../../src/"), &format!("{WRITTEN}/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_file_that_the_student_edits() {
        let line = r#"{"reason": "compiler-message", "target": {"name": "ring", "kind": ["example"]},
            "message": {"level": "error", "rendered": "error\n --> exercises/pictures/modules/../../src/ring.rs:7:1\n"}}"#;
        let said: Said = serde_json::from_str(line).unwrap();
        assert_eq!(errors([said].iter()), "error\n --> exercises/src/ring.rs:7:1\n");
    }

    #[test]
    fn a_page_waits_for_its_answer_and_hears_where_there_is_no_compiler() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str| files::write(&root.path().join(path), b"").unwrap();
        write("exercises/pictures/modules/ring.rs");
        ["widgets/script/widgets.js", "widgets/script/widgets.css"].into_iter().for_each(write);
        write("exercises/pictures/script/mine.css");
        let layout = Layout { root: root.path().to_path_buf() };
        let answers = Answers::new(&layout);
        let script = |scripts: &BTreeMap<PathBuf, Vec<u8>>| {
            scripts.get(&loaded("ring")).map(|script| String::from_utf8_lossy(script).into_owned())
        };
        let waiting = script(&answers.scripts().unwrap()).unwrap();
        assert!(waiting.contains("is being compiled"), "{waiting}");
        let told = || all_told(&answers.names().unwrap(), "there is no compiler");
        let changed = script(&answers.keep(told()).unwrap()).unwrap();
        assert!(changed.contains("there is no compiler"), "{changed}");
        assert_eq!(script(&answers.scripts().unwrap()), Some(changed));
        assert!(answers.keep(told()).unwrap().is_empty(), "nothing is another one");
    }

    #[test]
    fn an_answer_is_a_file_of_an_exercise_that_has_a_picture() {
        let root = tempfile::tempdir().unwrap();
        let layout = Layout { root: root.path().to_path_buf() };
        files::write(&root.path().join("exercises/pictures/modules/ring.rs"), b"").unwrap();
        let answers = Answers::new(&layout);
        assert!(answers.is_answer(Path::new("exercises/src/ring.rs")));
        assert!(!answers.is_answer(Path::new("exercises/src/main.rs")));
        assert!(!answers.is_answer(Path::new("exercises/spec/src/ring.rs")));
    }
}
