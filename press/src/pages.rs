//! The chapters of the book, and what their labels stand for.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mdbook_preprocessor::book::{Book, BookItem};

use crate::attributes::Attributes;
use crate::blocks::{Block, Kind, blocks};
use crate::fault::Faults;

/// A chapter of the book.
#[derive(Debug)]
pub struct Page {
    /// The file as faults name it: `src/bearing.md`.
    pub file: String,
    /// What the table of contents calls it.
    pub name: String,
    /// The file relative to `src`.
    pub path: PathBuf,
    /// The word that leads to everything of this chapter.
    pub slug: String,
    /// The chapter whose exhibits it shows: itself, or the one that its heading calls `part-of`.
    pub owner: String,
    /// `2`, or nothing for chapters outside the count.
    pub number: Option<String>,
    /// What it says.
    pub blocks: Vec<Block>,
}

/// The number of a chapter, and that of a page below it: `11` and `11.A`, since `11.1` is a section.
pub fn number_of(places: &[u32]) -> String {
    let letter = |place: &u32| char::from_u32('A' as u32 + place.saturating_sub(1));
    let [chapter, below @ ..] = places else { return String::new() };
    below
        .iter()
        .filter_map(letter)
        .fold(chapter.to_string(), |number, letter| format!("{number}.{letter}"))
}

impl Page {
    /// The chapters of a book that have a file, in reading order.
    pub fn all(book: &Book) -> Vec<Page> {
        let chapter = |item: &BookItem| match item {
            BookItem::Chapter(chapter) => {
                let path = chapter.source_path.clone()?;
                let slug = path.file_stem()?.to_str()?.to_owned();
                let mut page = Page {
                    file: format!("src/{}", slashed(&path)),
                    name: chapter.name.clone(),
                    owner: slug.clone(),
                    slug,
                    number: chapter.number.as_ref().map(|places| number_of(places)),
                    blocks: blocks(&chapter.content),
                    path,
                };
                if let Some((_, part)) = page.part_of() {
                    page.owner = part.to_owned();
                }
                page.number_blocks();
                page.mark_depth();
                Some(page)
            }
            _ => None,
        };
        book.iter().filter_map(chapter).collect()
    }

    /// Pages of one name, and pages that are part of something that is no chapter with exhibits of its own.
    pub fn parts(pages: &[Page], faults: &mut Faults) {
        let mut known = BTreeMap::new();
        for page in pages {
            if let Some(first) = known.insert(&page.slug, &page.file) {
                let problem =
                    format!("{first} has the same name, and a chapter is known by its name");
                faults.add((&page.file, 0), &page.slug, problem, "give the file another name");
            }
        }
        let whole = |slug: &str| pages.iter().any(|page| page.slug == slug && page.owner == slug);
        for page in pages.iter().filter(|page| !whole(&page.owner)) {
            let line = page.part_of().map_or(0, |(line, _)| line);
            let problem = "the page is part of something that is no chapter, or a part itself";
            let mend = "name the slug of the chapter whose exhibits it shows";
            faults.add((&page.file, line), format!("part-of={}", page.owner), problem, mend);
        }
    }

    /// What the heading of the page says that it is part of, and the line of the heading.
    fn part_of(&self) -> Option<(usize, &str)> {
        self.blocks.iter().find_map(|block| match &block.kind {
            Kind::Heading { level: 1, attributes, .. } => {
                Some((block.line, attributes.value("part-of"))).filter(|(_, part)| !part.is_empty())
            }
            _ => None,
        })
    }

    fn number_blocks(&mut self) {
        let chapter = self.number.as_ref().map(|number| format!("{number}."));
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for block in &mut self.blocks {
            let Some(kind) = counted(&block.kind) else { continue };
            // Outside the count of chapters, listings, figures, theorems and algorithms are counted by themselves.
            if chapter.is_none() && matches!(kind, "sec:" | "eq:") {
                continue;
            }
            let count = counts.entry(kind).or_default();
            *count += 1;
            block.number = format!("{}{count}", chapter.as_deref().unwrap_or_default());
        }
    }

    /// A heading of the class `depth` covers what is below it, until one of its level or above.
    fn mark_depth(&mut self) {
        let mut depth = None;
        for block in &mut self.blocks {
            if let Kind::Heading { level, attributes, .. } = &block.kind {
                depth = depth.filter(|(_, above)| level > above);
                depth = depth.or(attributes.has("depth").then_some((block.line, *level)));
            }
            block.depth = depth.map(|(line, _)| line);
        }
    }

    /// The title of the chapter, as it begins.
    pub fn title(&self) -> &str {
        let title = self.blocks.iter().find_map(|block| match &block.kind {
            Kind::Heading { level: 1, title, .. } => Some(title.as_str()),
            _ => None,
        });
        title.unwrap_or(&self.slug)
    }

    /// Whether it is a numbered chapter. Exercises lie in folders, and are not read but worked.
    pub fn is_chapter(&self) -> bool {
        self.number.is_some() && self.path.parent() == Some(Path::new(""))
    }

    /// The way from this page to a file in `src`.
    pub fn way_to(&self, path: &Path) -> String {
        let depth = self.path.components().count() - 1;
        format!("{}{}", "../".repeat(depth), slashed(path))
    }
}

/// What a block is counted as, if it is counted.
fn counted(kind: &Kind) -> Option<&'static str> {
    let (attributes, counted) = match kind {
        Kind::Heading { level: 2, .. } => return Some("sec:"),
        Kind::Equation { attributes, .. } => (attributes, "eq:"),
        Kind::Figure { attributes, .. } => (attributes, "fig:"),
        Kind::Fence { attributes, .. } => (attributes, "lst:"),
        Kind::Open(attributes) if attributes.has("algorithm") => (attributes, "alg:"),
        Kind::Open(attributes) => (attributes, "thm:"),
        _ => return None,
    };
    attributes.id.starts_with(counted).then_some(counted)
}

/// The label of a block and its title.
fn label(kind: &Kind) -> Option<(&str, &str)> {
    let (attributes, title) = match kind {
        Kind::Heading { title, attributes, .. } => (attributes, title.as_str()),
        Kind::Equation { attributes, .. }
        | Kind::Figure { attributes, .. }
        | Kind::Fence { attributes, .. } => (attributes, ""),
        Kind::Open(attributes) => (attributes, attributes.value("title")),
        _ => return None,
    };
    (!attributes.id.is_empty()).then_some((attributes.id.as_str(), title))
}

/// An anchor made from a title.
pub fn anchor(title: &str) -> String {
    let words = title.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join("-")
}

/// The anchor of a heading: its label, or one made from its title.
pub fn anchor_of(title: &str, attributes: &Attributes) -> String {
    if attributes.id.is_empty() { anchor(title) } else { attributes.id.clone() }
}

/// Nobody misspells a name of so many bytes; to compare two of them takes the product of their lengths.
const LONGEST_NAME: usize = 100;

/// Of the names that there are, the one that most resembles one that there is not.
pub fn nearest<'a>(known: impl Iterator<Item = &'a String>, name: &str) -> Option<&'a str> {
    let likeness = |known: &str| strsim::normalized_damerau_levenshtein(known, name);
    known
        .filter(|known| known.len().max(name.len()) <= LONGEST_NAME)
        .map(|known| (known, likeness(known)))
        .filter(|(_, ratio)| *ratio > 0.6)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(known, _)| known.as_str())
}

/// A path with the slashes of the web.
pub fn slashed(path: &Path) -> String {
    path.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// What a label stands for.
#[derive(Debug)]
pub struct Target {
    /// The page it stands on.
    pub path: PathBuf,
    /// The line it stands on.
    pub line: usize,
    /// `1.2`; empty for what has no number.
    pub number: String,
    /// The title, for sections and theorems.
    pub title: String,
    /// Whether it is the title of a whole chapter.
    pub chapter: bool,
    /// Whether it is in depth, off the main road.
    pub deep: bool,
    /// What an equation says; empty for everything else.
    pub tex: String,
}

/// All labels of the book.
#[derive(Debug, Default)]
pub struct Labels(BTreeMap<String, Target>);

impl Labels {
    /// Collects the labels of all pages; one that stands twice is a fault.
    pub fn collect(pages: &[Page], faults: &mut Faults) -> Labels {
        let mut labels = Labels::default();
        for page in pages {
            for block in &page.blocks {
                if let Some((label, title)) = label(&block.kind) {
                    let chapter = matches!(block.kind, Kind::Heading { level: 1, .. });
                    let number = if chapter {
                        page.number.clone().unwrap_or_default()
                    } else {
                        block.number.clone()
                    };
                    let target = Target {
                        path: page.path.clone(),
                        line: block.line,
                        number,
                        title: title.to_owned(),
                        chapter,
                        deep: block.depth.is_some(),
                        tex: match &block.kind {
                            Kind::Equation { tex, .. } => tex.clone(),
                            _ => String::new(),
                        },
                    };
                    labels.insert(page, label, target, faults);
                }
            }
        }
        labels
    }

    /// What a label stands for.
    pub fn get(&self, label: &str) -> Option<&Target> {
        self.0.get(label)
    }

    /// The labels that resemble one that is not there.
    pub fn like(&self, label: &str) -> Option<&str> {
        nearest(self.0.keys(), label)
    }

    fn insert(&mut self, page: &Page, label: &str, target: Target, faults: &mut Faults) {
        match self.0.get(label) {
            Some(first) => {
                let problem = format!(
                    "the label is taken: src/{}:{} has it",
                    slashed(&first.path),
                    first.line
                );
                faults.add((&page.file, target.line), label, problem, "choose another label");
            }
            None => drop(self.0.insert(label.to_owned(), target)),
        }
    }
}
