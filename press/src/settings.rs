//! What `book.toml` says to the press, under `[preprocessor.press]`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Deserialize;

use crate::files;

/// The settings of the press. All have values that fit a book laid out like this one.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct Settings {
    /// mdBook's: how a plain `mdbook build` runs the press.
    pub command: String,
    /// mdBook's: which preprocessors come later.
    pub before: Vec<String>,
    /// mdBook's: which preprocessors come earlier.
    pub after: Vec<String>,
    /// The cargo package that computes what the chapters show; empty: what lies in `target/press/exhibits` is taken as it is.
    pub exhibits_package: String,
    /// The cargo package whose pages lie beside the chapters, with its sources in `code/src`; empty: none.
    pub library_package: String,
    /// A longer listing is not read by anybody.
    pub longest_listing: usize,
    /// As many words the main road through all chapters may have; a longer one is walked by nobody.
    pub longest_main_road: usize,
    /// At most this share of a chapter's numbered equations may be definitions.
    pub definition_share: f64,
    /// What may be done with the book, as its first page on paper says it, a line each.
    pub licences: Vec<String>,
    /// Numbers with a unit that may stand in prose as they are.
    pub allow: Vec<Allowed>,
}

/// A number with a unit that no program computes, and why.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Allowed {
    /// The slug of the chapter.
    pub chapter: String,
    /// The number and its unit as they stand in the prose.
    pub text: String,
    /// Why it is typed and not computed.
    pub reason: String,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            command: String::new(),
            before: Vec::new(),
            after: Vec::new(),
            exhibits_package: "exhibits".to_owned(),
            library_package: "vislam".to_owned(),
            longest_listing: 25,
            longest_main_road: 45_000,
            definition_share: 0.25,
            licences: Vec::new(),
            allow: Vec::new(),
        }
    }
}

#[derive(Default, Deserialize)]
struct BookToml {
    #[serde(default)]
    preprocessor: Preprocessors,
}

#[derive(Default, Deserialize)]
struct Preprocessors {
    #[serde(default)]
    press: Settings,
}

impl Settings {
    /// Reads `[preprocessor.press]` of the `book.toml` in `root`.
    pub fn read(root: &Path) -> Result<Settings> {
        let path = root.join("book.toml");
        let text = files::read(&path).context("run `cargo book` in the folder of the book")?;
        let book: BookToml = toml::from_str(&text)
            .with_context(|| format!("{} is not as the press expects it", path.display()))?;
        Ok(book.preprocessor.press)
    }
}

/// Where things lie in a book.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The folder of `book.toml`.
    pub root: PathBuf,
}

impl Layout {
    /// The chapters.
    pub fn src(&self) -> PathBuf {
        self.root.join("src")
    }

    /// What the press writes for mdBook to copy: data and source pages.
    pub fn generated(&self) -> PathBuf {
        self.src().join("generated")
    }

    /// The pages of the library, for mdBook to copy.
    pub fn api(&self) -> PathBuf {
        self.src().join("api")
    }

    /// The files the press keeps between two builds.
    pub fn work(&self) -> PathBuf {
        self.root.join("target/press")
    }

    /// What the program computed, a folder a chapter.
    pub fn exhibits(&self) -> PathBuf {
        self.work().join("exhibits")
    }

    /// The records that the book stands on.
    pub fn records(&self) -> PathBuf {
        self.root.join("exhibits/records")
    }

    /// Records made anew and not yet accepted.
    pub fn proposed_records(&self) -> PathBuf {
        self.work().join("records")
    }

    /// The TeX of each equation as it was when somebody last held it against its check, a file a chapter.
    pub fn accepted_equations(&self) -> PathBuf {
        self.root.join("exhibits/accepted")
    }

    /// Those of one chapter.
    pub fn accepted(&self, slug: &str) -> PathBuf {
        self.accepted_equations().join(format!("{slug}.toml"))
    }
}
