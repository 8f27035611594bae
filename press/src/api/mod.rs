//! The pages of the library: rustdoc's, with the book's equations in them.
//!
//! [`Plan::new`] says what they are made from, [`Plan::make`] makes them when that has changed.

pub mod comments;
pub mod items;
pub mod publish;
pub mod rustdoc;
pub mod scan;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Result;
use mdbook_katex::cfg::KatexConfig;
use mdbook_preprocessor::config::Config;
use sha2::{Digest, Sha256};

use crate::engine::Engine;
use crate::fault::Faults;
use crate::files;
use crate::formulas;
use crate::guard::guarded;
use crate::pages::Page;
use crate::prose::{Found, Known};
use crate::records::hex;
use crate::settings::{Layout, Settings};

use comments::{Book, Line, Noted, Piece};
use publish::Theme;

/// Everything that the pages of the library are made from.
pub struct Plan {
    layout: Layout,
    settings: Settings,
    crate_name: String,
    katex: KatexConfig,
    theme: Theme,
    /// The copy of each file, by its path below `code/src`.
    copies: BTreeMap<PathBuf, Vec<Line>>,
    digest: String,
}

impl Plan {
    /// Reads the descriptions and notes what is wrong with them; nothing when the book has no library.
    ///
    /// The chapters have been written by now, so that the TeX of their equations is known.
    pub fn new(
        layout: &Layout,
        settings: &Settings,
        config: &Config,
        pages: &[Page],
        known: &Known<'_>,
        found: &mut Found<'_>,
    ) -> Result<Option<Plan>> {
        let library = known.library;
        if library.name.is_empty() {
            publish::remove(layout)?;
            return Ok(None);
        }
        let equations = found.formulas.iter().filter(|formula| !formula.label.is_empty());
        let book = Book {
            library,
            pages,
            labels: known.labels,
            bibliography: known.bibliography,
            equations: equations.map(|known| (known.label.as_str(), known.tex.as_str())).collect(),
        };
        let mut noted = Noted::default();
        let mut copies = BTreeMap::new();
        for file in &library.files {
            let path = Path::new(&file.name).strip_prefix(items::SOURCES)?.to_path_buf();
            copies.insert(path, comments::copy(file, &book, &mut noted));
            found.sources.insert(file.name.clone());
        }
        drop(book);
        found.faults.extend(noted.faults);
        found.formulas.extend(noted.formulas);
        let theme = Theme::read(layout, config)?;
        let katex = mdbook_katex::cfg::get_config(config)?;
        let salt = formulas::salt(&layout.root, &katex)?;
        let lock = files::read_if_there(&layout.root.join("Cargo.lock"))?;
        let inputs = format!("{MAKING}{salt}{}{lock:?}{theme:?}{copies:?}", rustdoc::version());
        Ok(Some(Plan {
            layout: layout.clone(),
            settings: settings.clone(),
            crate_name: library.name.clone(),
            katex,
            theme,
            copies,
            digest: hex(&Sha256::digest(inputs)),
        }))
    }

    /// Whether the pages are as they should be.
    pub fn is_made(&self) -> Result<bool> {
        let front = self.layout.api().join(&self.crate_name).join("index.html");
        let made = files::read_if_there(&self.stamp())?;
        Ok(made.as_ref() == Some(&self.digest) && front.is_file())
    }

    /// Makes the pages into `src/api` and gives what rustdoc has against the descriptions.
    ///
    /// # Errors
    /// What keeps them from being made: a library that does not compile, a folder that cannot be written.
    pub fn make(&self) -> Result<Faults> {
        files::remove(&self.stamp())?;
        let work = self.work();
        let sources = self.write_copies(&work.join("code"))?;
        let pages = work.join("pages");
        files::remove(&pages)?;
        self.theme.write(&work)?;
        let faults = rustdoc::run(&rustdoc::Order {
            layout: &self.layout,
            settings: &self.settings,
            sources: &sources,
            copies: &self.copies,
            theme: &work,
            pages: &pages,
        })?;
        if pages.join(&self.crate_name).is_dir() {
            publish::publish(&pages, &self.theme, &self.layout.api(), &self.crate_name)?;
        }
        if faults.is_empty() {
            files::write(&self.stamp(), self.digest.as_bytes())?;
        }
        Ok(faults)
    }

    fn work(&self) -> PathBuf {
        self.layout.work().join("api")
    }

    fn stamp(&self) -> PathBuf {
        self.work().join("made-from")
    }

    /// Writes the copies with their formulas rendered; gives their folder.
    fn write_copies(&self, folder: &Path) -> Result<PathBuf> {
        let engine = Engine::new(&self.layout.root, &self.katex)?;
        files::remove(folder)?;
        for (path, lines) in &self.copies {
            let mut text = String::new();
            for line in lines {
                line.pieces.iter().for_each(|piece| text.push_str(&rendered(piece, &engine)));
                text.push('\n');
            }
            files::write(&folder.join(path), text.as_bytes())?;
        }
        Ok(folder.to_path_buf())
    }
}

/// How the pages are made from the copies: who changes that wants to see other pages.
const MAKING: &str = concat!(
    include_str!("mod.rs"),
    include_str!("publish.rs"),
    include_str!("rustdoc.rs"),
    include_str!("../guard.rs")
);

fn rendered(piece: &Piece, engine: &Engine) -> String {
    match piece {
        Piece::Text(text) => text.clone(),
        Piece::Math { tex, display } => {
            let mark = if *display { "$$" } else { "$" };
            guarded(&engine.chapter(&format!("{mark}{tex}{mark}"))).replace('\n', " ")
        }
    }
}
