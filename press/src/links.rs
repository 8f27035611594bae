//! Looks at the rendered pages: every link leads somewhere, and nothing is asked of another host.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::Result;
use rayon::prelude::*;
use scraper::{Html, Selector};

use crate::fault::Faults;
use crate::files;
use crate::pages::slashed;

/// What a rendered page offers and asks for.
struct Rendered {
    path: PathBuf,
    anchors: BTreeSet<String>,
    /// Attribute, address, and whether a browser loads it without being asked.
    links: Vec<(String, bool)>,
}

/// Finds dead links and foreign requests in the book rendered into `site`, whose chapters lie in `src`.
pub fn faults(site: &Path, src: &Path) -> Result<Faults> {
    let all = files::below(site)?;
    let there: BTreeSet<&PathBuf> = all.iter().collect();
    let html: Vec<&PathBuf> =
        all.iter().filter(|path| path.extension().is_some_and(|end| end == "html")).collect();
    let pages =
        html.par_iter().map(|path| Rendered::read(site, path)).collect::<Result<Vec<_>>>()?;
    let anchors: BTreeMap<&PathBuf, &BTreeSet<String>> =
        pages.iter().map(|page| (&page.path, &page.anchors)).collect();
    let mut faults = Faults::default();
    let mut known = BTreeSet::new();
    let (chapters, copies): (Vec<_>, Vec<_>) =
        pages.iter().partition(|page| page.chapter(src).is_some());
    // What a chapter has wrong, its copies on the first page and on the page for printers have wrong as well.
    for page in chapters.into_iter().chain(copies) {
        for (address, loaded) in &page.links {
            if let Some((problem, mend)) = page.fault(address, *loaded, &there, &anchors) {
                let (file, line) = page.origin(src, address);
                if known.insert(address) || line > 0 {
                    faults.add((&file, line), address, problem, mend);
                }
            }
        }
    }
    Ok(faults)
}

impl Rendered {
    fn read(site: &Path, path: &Path) -> Result<Rendered> {
        let document = Html::parse_document(&files::read(&site.join(path))?);
        let select = |pattern: &str| Selector::parse(pattern).expect("a valid selector");
        let anchors = document
            .select(&select("[id]"))
            .filter_map(|element| element.attr("id"))
            .map(str::to_owned)
            .collect();
        let mut links = Vec::new();
        for (pattern, attribute, loaded) in [
            ("a[href]", "href", false),
            ("link[href]", "href", true),
            ("[src]", "src", true),
            ("object[data]", "data", true),
        ] {
            let selector = select(pattern);
            let found = document.select(&selector).filter_map(|element| element.attr(attribute));
            links.extend(found.map(|address| (address.to_owned(), loaded)));
        }
        Ok(Rendered { path: path.to_path_buf(), anchors, links })
    }

    fn fault(
        &self,
        address: &str,
        loaded: bool,
        there: &BTreeSet<&PathBuf>,
        anchors: &BTreeMap<&PathBuf, &BTreeSet<String>>,
    ) -> Option<(String, &'static str)> {
        // rustdoc's pages go back by a script.
        if address.starts_with("data:") || address.starts_with("javascript:") {
            return None;
        }
        if address.contains("://") || address.starts_with("//") || address.starts_with("mailto:") {
            return loaded.then(|| {
                ("the page asks another host".to_owned(), "bring the file into the book")
            });
        }
        let (way, anchor) = address.split_once('#').unwrap_or((address, ""));
        let path = match way {
            "" => Some(self.path.clone()),
            way => {
                let way = way.split('?').next().unwrap_or(way);
                self.path.parent().and_then(|folder| files::joined(folder, way))
            }
        };
        let place =
            |path: PathBuf| if there.contains(&path) { path } else { path.join("index.html") };
        let Some(path) = path.map(place).filter(|path| there.contains(path)) else {
            return Some((
                "the link leads nowhere: there is no such file".to_owned(),
                "mend the address, or make the file a chapter",
            ));
        };
        let known =
            anchor.is_empty() || anchors.get(&path).is_none_or(|anchors| anchors.contains(anchor));
        (!known).then(|| {
            (
                format!("the link leads nowhere: {} has no `#{anchor}`", slashed(&path)),
                "mend the fragment; a label and @-reference would have been found earlier",
            )
        })
    }

    /// The chapter that this page was made from.
    fn chapter(&self, src: &Path) -> Option<PathBuf> {
        let chapter = self.path.with_extension("md");
        src.join(&chapter).is_file().then_some(chapter)
    }

    /// The chapter and line that an address was written in, as near as the text tells.
    fn origin(&self, src: &Path, address: &str) -> (String, usize) {
        let chapter = self.chapter(src);
        let text = chapter.as_ref().and_then(|chapter| files::read(&src.join(chapter)).ok());
        let (Some(chapter), Some(text)) = (chapter, text) else { return (slashed(&self.path), 0) };
        let file = format!("src/{}", slashed(&chapter));
        let written = [address.to_owned(), address.replacen(".html", ".md", 1)];
        let line = text
            .lines()
            .position(|line| written.iter().any(|address| line.contains(address.as_str())));
        (file, line.map_or(0, |line| line + 1))
    }
}
