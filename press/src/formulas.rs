//! Mathematics: every formula is tried before the pages are made, and rendered once.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use anyhow::{Result, bail};
use mdbook_katex::cfg::{KatexConfig, get_config};
use mdbook_preprocessor::book::{Book, Chapter};
use mdbook_preprocessor::config::Config;
use mdbook_preprocessor::{Preprocessor, PreprocessorContext};
use regex::Regex;
use sha2::{Digest, Sha256};

use crate::engine::Engine;
use crate::fault::Faults;
use crate::files;
use crate::packing::digest;
use crate::records::hex;

/// What is said of a formula that KaTeX does not know.
pub const REJECTED: &str = "KaTeX rejects the formula";

/// A formula and where it stands.
#[derive(Clone, Debug)]
pub struct Formula {
    /// The file.
    pub file: String,
    /// The line its TeX begins on.
    pub line: usize,
    /// The label of its equation, or nothing.
    pub label: String,
    /// The TeX, with its numbers filled in.
    pub tex: String,
    /// Whether it is displayed or runs with the text.
    pub display: bool,
}

/// Finds the formulas that KaTeX rejects. Those known to be good from an earlier build are not tried again.
pub fn try_all(
    root: &Path,
    config: &Config,
    work: &Path,
    formulas: &[Formula],
    faults: &mut Faults,
) -> Result<()> {
    let settings = katex_settings(root, config, faults)?;
    let Some(settings) = settings else { return Ok(()) };
    let engine = Engine::new(root, &settings)?;
    let salt = salt(root, &settings)?;
    let known_path = work.join("formulas");
    let known_text = files::read_if_there(&known_path)?.unwrap_or_default();
    let known: HashSet<&str> = known_text.lines().collect();
    let tried: Vec<(String, Option<String>)> = formulas
        .iter()
        .map(|formula| {
            let key = hex(&Sha256::digest(format!("{salt}\n{}\n{}", formula.display, formula.tex)));
            if known.contains(key.as_str()) {
                return (key, None);
            }
            (key, engine.rejection(&formula.tex, formula.display))
        })
        .collect();
    let mut good: Vec<&str> = Vec::new();
    for (formula, (key, rejected)) in formulas.iter().zip(&tried) {
        match rejected {
            None => good.push(key),
            Some(reason) => {
                let line = formula.line + line_of(&formula.tex, reason);
                faults.add(
                    (&formula.file, line),
                    &formula.label,
                    format!("{REJECTED}: {reason}"),
                    "mend the TeX; katex.org/docs/supported lists what KaTeX knows",
                );
            }
        }
    }
    good.sort();
    good.dedup();
    files::write(&known_path, good.join("\n").as_bytes())
}

/// How many lines below its first one a formula fails, from the position in KaTeX's message.
fn line_of(tex: &str, reason: &str) -> usize {
    static POSITION: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"at position (\d+)").expect("a valid pattern"));
    let position =
        POSITION.captures(reason).and_then(|found| found[1].parse::<usize>().ok()).unwrap_or(1);
    tex.chars().take(position.saturating_sub(1)).filter(|&c| c == '\n').count()
}

/// The settings of mdbook-katex, which itself turns what it cannot read into its defaults, and those ask
/// another host for a stylesheet.
fn katex_settings(
    root: &Path,
    config: &Config,
    faults: &mut Faults,
) -> Result<Option<KatexConfig>> {
    let place = ("book.toml", 0);
    let table = config.get::<toml::Value>("preprocessor.katex")?;
    let Some(table) = table else {
        faults.add(
            place,
            "",
            "there is no table [preprocessor.katex]",
            "add it, with no-css = true",
        );
        return Ok(None);
    };
    if let Err(error) = table.try_into::<KatexConfig>() {
        faults.add(
            place,
            "",
            format!("[preprocessor.katex] cannot be read: {error}"),
            "mend that setting",
        );
        return Ok(None);
    }
    let settings = get_config(config)?;
    if !settings.no_css {
        faults.add(
            place,
            "",
            "[preprocessor.katex] would ask another host for a stylesheet",
            "set no-css = true; the theme brings KaTeX's style and fonts",
        );
    }
    let lines = macros(root, &settings)?;
    let file = settings.macros.clone().unwrap_or_default();
    // mdbook-katex panics at a macro without a colon, so this cannot wait for the end of the list.
    let broken = |line: &String| line.starts_with('\\') && !line.contains(':');
    if let Some((at, line)) = lines.iter().enumerate().find(|(_, line)| broken(line)) {
        bail!("{file}:{}: {line}: a macro without a colon: write it as \\name:{{body}}", at + 1);
    }
    Ok(Some(settings))
}

/// What a rendered formula depends on besides its TeX: the settings, the macros, and who renders.
pub fn salt(root: &Path, settings: &KatexConfig) -> Result<String> {
    let renderers = digest(root, &["press/src/engine"], &["Cargo.lock"])?;
    let version = env!("CARGO_PKG_VERSION");
    Ok(format!("{version} {renderers} {settings:?} {:?}", macros(root, settings)?))
}

fn macros(root: &Path, settings: &KatexConfig) -> Result<Vec<String>> {
    let Some(path) = &settings.macros else { return Ok(Vec::new()) };
    Ok(files::read(&root.join(path))?.lines().map(str::to_owned).collect())
}

/// mdbook-katex, which remembers the chapters it has rendered.
///
/// A formula takes a few milliseconds and a book has thousands: a saved chapter must not wait for all others.
pub struct RememberingKatex {
    folder: PathBuf,
}

impl RememberingKatex {
    /// Remembers in this folder.
    pub fn new(work: &Path) -> RememberingKatex {
        RememberingKatex { folder: work.join("katex") }
    }

    fn render(&self, engine: &Engine, salt: &str, chapter: &mut Chapter) -> Result<PathBuf> {
        let key = hex(&Sha256::digest(format!("{salt}\n{}", chapter.content)));
        let path = self.folder.join(key);
        chapter.content = match files::read_if_there(&path)? {
            Some(content) => content,
            None => {
                let content = engine.chapter(&chapter.content);
                files::write(&path, content.as_bytes())?;
                content
            }
        };
        Ok(path)
    }
}

impl Preprocessor for RememberingKatex {
    fn name(&self) -> &str {
        "katex"
    }

    fn run(&self, context: &PreprocessorContext, mut book: Book) -> Result<Book> {
        let settings = get_config(&context.config)?;
        let engine = Engine::new(&context.root, &settings)?;
        let salt = salt(&context.root, &settings)?;
        let mut result = Ok(());
        let mut fresh = HashSet::new();
        book.for_each_chapter_mut(|chapter| {
            if result.is_ok() && chapter.content.contains('$') {
                match self.render(&engine, &salt, chapter) {
                    Ok(path) => drop(fresh.insert(path)),
                    Err(error) => result = Err(error),
                }
            }
        });
        result?;
        for stale in files::below(&self.folder)?
            .iter()
            .map(|file| self.folder.join(file))
            .filter(|path| !fresh.contains(path))
        {
            files::remove(&stale)?;
        }
        Ok(book)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_an_error_is_counted_in_the_formula() {
        assert_eq!(line_of("a\n\\b\nc", "Undefined control sequence: \\b at position 3: …"), 1);
        assert_eq!(line_of("a", "no position"), 0);
    }

    #[test]
    fn a_formula_is_rendered_again_when_what_renders_it_changed() {
        let folder = tempfile::tempdir().unwrap();
        let salt = || salt(folder.path(), &KatexConfig::default()).unwrap();
        let first = salt();
        assert_eq!(first, salt());
        files::write(&folder.path().join("press/src/engine/port.rs"), b"// other").unwrap();
        assert_ne!(first, salt());
    }
}
