//! Puts rustdoc's pages where mdBook finds them, dressed for the book.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use anyhow::{Context, Result};
use maud::html;
use mdbook_preprocessor::config::Config;
use regex::Regex;

use super::comments::BOOK;
use crate::files;
use crate::pages::slashed;
use crate::settings::Layout;

/// What rustdoc is given beside the sources.
#[derive(Debug)]
pub struct Theme {
    /// The style of formulas and of what the book adds.
    style: String,
    /// What stands above each page: the way back into the book.
    bar: String,
    /// The fonts of formulas.
    fonts: Vec<PathBuf>,
}

impl Theme {
    /// Reads it from the theme of the book.
    pub fn read(layout: &Layout, config: &Config) -> Result<Theme> {
        let folder = config.get::<String>("output.html.theme")?.unwrap_or("theme".to_owned());
        let folder = layout.root.join(folder);
        let read = |name: &str| {
            files::read_if_there(&folder.join(name)).map(|text| text.unwrap_or_default())
        };
        // mdBook fills in the names of fonts; here they keep their own.
        let formulas = read("fonts/katex.css")?.replace("{{ resource \"", "").replace("\" }}", "");
        let fonts = files::below(&folder.join("fonts"))?;
        let of_formulas = |font: &PathBuf| slashed(font).to_lowercase().starts_with("katex");
        let title = config.book.title.as_deref().unwrap_or("The book");
        let fonts = fonts
            .into_iter()
            .filter(|font| of_formulas(font) && font.extension().is_some_and(|end| end != "css"));
        let bar = html! {
            nav.book-bar aria-label="Book" {
                a href={ (BOOK) "index.html" } { (title) } span { "the library" }
            } "\n"
        };
        Ok(Theme {
            style: formulas + &read("css/api.css")?,
            bar: bar.into_string() + &read("api.html")?,
            fonts: fonts.map(|font| folder.join("fonts").join(font)).collect(),
        })
    }

    /// Writes for rustdoc what it asks for as files.
    pub fn write(&self, folder: &Path) -> Result<()> {
        files::write(&style_file(folder), self.style.as_bytes())?;
        files::write(&bar_file(folder), self.bar.as_bytes())
    }
}

/// The file of the style.
pub fn style_file(folder: &Path) -> PathBuf {
    folder.join("style.css")
}

/// The file of what stands above each page.
pub fn bar_file(folder: &Path) -> PathBuf {
    folder.join("bar.html")
}

/// Copies rustdoc's pages into the folder `api` with addresses that lead into the book from where they stand.
pub fn publish(pages: &Path, theme: &Theme, api: &Path, library: &str) -> Result<()> {
    let mut there = BTreeSet::new();
    let front = PathBuf::from("index.html");
    files::write(&api.join(&front), door(library).as_bytes())?;
    there.insert(front);
    for path in files::below(pages)? {
        let name = path.file_name().unwrap_or_default();
        if name == ".lock" {
            continue;
        }
        let from = pages.join(&path);
        // mdBook takes .md files for chapters, and these are licences.
        let to = if path.extension().is_some_and(|end| end == "md") {
            path.with_extension("txt")
        } else {
            path
        };
        let content = if to.extension().is_some_and(|end| end == "html") {
            let page = files::read(&from)?;
            // Where a private module would have shown what is public elsewhere; nothing leads there.
            if page.contains("<title>Redirection</title>") {
                continue;
            }
            addressed(&page, to.components().count()).into_bytes()
        } else {
            bytes(&from)?
        };
        files::write(&api.join(&to), &content)?;
        there.insert(to);
    }
    for path in there.clone().iter().filter(|path| path.starts_with(library)) {
        for script in scripts_of_traits(api, path)? {
            if there.insert(script.clone()) {
                files::write(&api.join(script), b"")?;
            }
        }
    }
    for font in &theme.fonts {
        let to = Path::new("fonts").join(font.file_name().unwrap_or_default());
        files::write(&api.join(&to), &bytes(font)?)?;
        there.insert(to);
    }
    remove_others(api, &there)
}

/// Brings the pages in `api` into a folder of a book that mdBook made before they were there.
pub fn copy(api: &Path, to: &Path) -> Result<()> {
    let there = files::below(api)?;
    for path in &there {
        files::write(&to.join(path), &bytes(&api.join(path))?)?;
    }
    remove_others(to, &there.into_iter().collect())
}

/// Removes the pages of a book that has no library any more.
pub fn remove(layout: &Layout) -> Result<()> {
    files::remove(&layout.api())
}

/// The lists of implementors that the page of a trait loads. rustdoc writes none for a trait that nothing implements.
fn scripts_of_traits(api: &Path, page: &Path) -> Result<Vec<PathBuf>> {
    static SCRIPT: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r#"src="[./]*(trait\.impl/[^"]+)""#).expect("a valid pattern"));
    let name = page.file_name().unwrap_or_default().to_string_lossy();
    if !name.starts_with("trait.") {
        return Ok(Vec::new());
    }
    let html = files::read(&api.join(page))?;
    Ok(SCRIPT.captures_iter(&html).map(|found| PathBuf::from(&found[1])).collect())
}

/// The page of the folder itself, which rustdoc links to and does not make: it leads on to the library.
fn door(library: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{library}</title>\n\
         <meta http-equiv=\"refresh\" content=\"0; url={library}/index.html\">\n</head>\n\
         <body><p><a href=\"{library}/index.html\">The library {library}</a></p></body>\n</html>\n"
    )
}

fn remove_others(folder: &Path, there: &BTreeSet<PathBuf>) -> Result<()> {
    let all = files::below(folder)?;
    all.iter()
        .filter(|path| !there.contains(*path))
        .try_for_each(|path| files::remove(&folder.join(path)))
}

fn bytes(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))
}

/// A page `depth` folders below the root of the book, whose addresses into the book lead there.
fn addressed(html: &str, depth: usize) -> String {
    html.replace(&format!("href=\"{BOOK}"), &format!("href=\"{}", "../".repeat(depth)))
}
