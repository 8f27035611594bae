//! A PDF as Chromium writes it, read as far as the press asks: on which page a name is, and whether the document is what
//! was promised.
//!
//! Chromium writes a table of offsets and its dictionaries in plain text, and reading these takes less than a library for
//! every kind of PDF, some twenty crates that each reader of the book would compile. A document that is written in another
//! way is an error.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::LazyLock;

use anyhow::{Context, Result, bail};
use regex::bytes::Regex;

use super::syntax::{Object, Text};

/// What a document says it was made at.
const TIME: &[u8] = b"19800101000000";

/// A PDF whose objects can be asked for.
pub struct Document<'a> {
    bytes: &'a [u8],
    offsets: Vec<usize>,
    trailer: Object,
}

impl<'a> Document<'a> {
    /// Reads the table of a document.
    ///
    /// # Errors
    /// A document that is not written as Chromium writes it.
    pub fn read(bytes: &'a [u8]) -> Result<Document<'a>> {
        let table = || {
            let start = last(bytes, b"startxref")? + b"startxref".len();
            let mut text = Text { bytes, at: start };
            let table: usize = text.word()?.parse().ok()?;
            let mut text = Text { bytes, at: table };
            (text.word()? == "xref" && text.word()? == "0").then_some(())?;
            let count: usize = text.word()?.parse().ok()?;
            let mut offsets = Vec::new();
            for _ in 0..count {
                let offset: usize = text.word()?.parse().ok()?;
                offsets.push(if text.word().zip(text.word())?.1 == "n" { offset } else { 0 });
            }
            (text.word()? == "trailer").then_some(())?;
            Some((offsets, text.object()?))
        };
        let (offsets, trailer) = table().context(
            "the PDF has no table of objects in plain text: this Chromium writes another kind, use the one that the tests use",
        )?;
        Ok(Document { bytes, offsets, trailer })
    }

    /// The page of each name that a link leads to, counted from 1. A name is written as the fragment of an address.
    ///
    /// # Errors
    /// A document without names.
    pub fn names(&self) -> Result<BTreeMap<String, usize>> {
        let pages = self.pages();
        let number: BTreeMap<usize, usize> =
            pages.iter().enumerate().map(|(index, page)| (*page, index + 1)).collect();
        let names = self.catalog().get("Dests").map(|names| self.resolved(names));
        let Some(Object::Dictionary(names)) = names else {
            bail!(
                "the PDF has no names that its links lead to: this Chromium writes them in another way"
            );
        };
        let page = |place: &Object| match self.resolved(place) {
            Object::Array(place) => match place.first() {
                Some(Object::Reference(page)) => number.get(page).copied(),
                _ => None,
            },
            _ => None,
        };
        Ok(names.into_iter().filter_map(|(name, place)| Some((name, page(&place)?))).collect())
    }

    /// How many pages it has.
    pub fn page_count(&self) -> usize {
        self.pages().len()
    }

    /// What is not as it was promised: tags, an outline, fonts that are in the document, links that lead somewhere.
    pub fn problems(&self) -> Vec<String> {
        let catalog = self.catalog();
        let mut problems = Vec::new();
        let marked = catalog.get("MarkInfo").map(|info| self.resolved(info));
        let marked = marked.and_then(|info| info.get("Marked").cloned());
        if marked != Some(Object::Word("true".to_owned()))
            || !catalog.contains_key("StructTreeRoot")
        {
            problems
                .push("it has no tags, which say what is a heading and what a table".to_owned());
        }
        if !catalog.contains_key("Outlines") {
            problems.push("it has no outline".to_owned());
        }
        for number in 1..self.offsets.len() {
            let object = self.object(number);
            problems.extend(self.missing_font(&object));
            let address =
                object.get("A").and_then(|action| self.resolved(action).get("URI").cloned());
            if let Some(Object::Text(address)) = address.filter(|address| !leads_outside(address)) {
                problems.push(format!("a link leads to {address}, which others do not have"));
            }
        }
        problems.sort();
        problems.dedup();
        problems
    }

    /// What is wrong with an object that is a font whose letters are not in the document.
    fn missing_font(&self, font: &Object) -> Option<String> {
        let name = |key: &str| match font.get(key) {
            Some(Object::Name(name)) => name.clone(),
            _ => String::new(),
        };
        let of_letters = ["Type1", "TrueType", "CIDFontType0", "CIDFontType2"];
        if name("Type") != "Font" || !of_letters.contains(&name("Subtype").as_str()) {
            return None;
        }
        let descriptor = font.get("FontDescriptor").map(|descriptor| self.resolved(descriptor));
        let files = ["FontFile", "FontFile2", "FontFile3"];
        let there = descriptor.is_some_and(|it| files.iter().any(|file| it.get(file).is_some()));
        (!there).then(|| format!("the font {} is not in it", name("BaseFont")))
    }

    fn catalog(&self) -> BTreeMap<String, Object> {
        match self.trailer.get("Root").map(|root| self.resolved(root)) {
            Some(Object::Dictionary(catalog)) => catalog,
            _ => BTreeMap::new(),
        }
    }

    /// The objects of its pages, in order.
    fn pages(&self) -> Vec<usize> {
        let mut pages = Vec::new();
        let mut open: Vec<Object> = self.catalog().get("Pages").cloned().into_iter().collect();
        while let Some(next) = open.pop() {
            let Object::Reference(number) = next else { continue };
            match self.object(number).get("Kids") {
                Some(Object::Array(kids)) if pages.len() < self.offsets.len() => {
                    open.extend(kids.iter().rev().cloned());
                }
                _ => pages.push(number),
            }
        }
        pages
    }

    fn resolved(&self, object: &Object) -> Object {
        match object {
            Object::Reference(number) => self.object(*number),
            object => object.clone(),
        }
    }

    /// An object by its number; a word without letters when there is none.
    fn object(&self, number: usize) -> Object {
        let at = self.offsets.get(number).copied().unwrap_or_default();
        let mut text = Text { bytes: self.bytes, at };
        let object = || {
            text.word()?;
            text.word()?;
            (text.word()? == "obj").then_some(())?;
            text.object()
        };
        let object = { object }();
        object.unwrap_or(Object::Word(String::new()))
    }
}

fn leads_outside(address: &Object) -> bool {
    matches!(address, Object::Text(text) if text.starts_with("http://") || text.starts_with("https://") || text.starts_with("mailto:"))
}

/// The document without what another run would make otherwise: the time at which it was made, and the names that
/// Chromium gives to nodes of a page by counting all that it has met before.
///
/// # Errors
/// As [`Document::read`].
pub fn without_chance(mut bytes: Vec<u8>) -> Result<Vec<u8>> {
    number_nodes(&mut bytes);
    let document = Document::read(&bytes)?;
    let info = match document.trailer.get("Info") {
        Some(Object::Reference(info)) => document.offsets.get(*info).copied(),
        _ => None,
    };
    let start = info.unwrap_or(bytes.len()).min(bytes.len());
    let end = start + first(&bytes[start..], b"endobj").unwrap_or(0);
    for key in [&b"/CreationDate (D:"[..], b"/ModDate (D:"] {
        if let Some(found) = first(&bytes[start..end], key) {
            let from = start + found + key.len();
            let length = first(&bytes[from..end], b")").unwrap_or(0);
            set_time(&mut bytes[from..from + length]);
        }
    }
    Ok(bytes)
}

/// Names nodes by their order among themselves, which keeps the tree of names in order and every letter in its place.
fn number_nodes(bytes: &mut [u8]) {
    static NODE: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"\(node([0-9]{8})\)").expect("a valid pattern"));
    let places: Vec<Range<usize>> =
        NODE.captures_iter(bytes).filter_map(|node| Some(node.get(1)?.range())).collect();
    let names: BTreeSet<Vec<u8>> =
        places.iter().map(|place| bytes[place.clone()].to_vec()).collect();
    let numbers: BTreeMap<Vec<u8>, usize> = names.into_iter().zip(1..).collect();
    for place in places {
        let number = numbers[&bytes[place.clone()]];
        bytes[place].copy_from_slice(format!("{number:08}").as_bytes());
    }
}

/// Writes the time over another one, in the zone of Greenwich.
fn set_time(text: &mut [u8]) {
    for (index, letter) in text.iter_mut().enumerate() {
        match TIME.get(index) {
            Some(digit) => *letter = *digit,
            None if letter.is_ascii_digit() => *letter = b'0',
            None if *letter == b'-' => *letter = b'+',
            None => {}
        }
    }
}

fn first(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes.windows(pattern.len()).position(|window| window == pattern)
}

fn last(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes.windows(pattern.len()).rposition(|window| window == pattern)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A document of the given objects, the first of them the catalog and the last the information.
    fn pdf(objects: &[&str]) -> Vec<u8> {
        let mut text = "%PDF-1.4\n".to_owned();
        let mut table = format!("xref\n0 {}\n0000000000 65535 f \n", objects.len() + 1);
        for (index, object) in objects.iter().enumerate() {
            table += &format!("{:010} 00000 n \n", text.len());
            text += &format!("{} 0 obj\n{object}\nendobj\n", index + 1);
        }
        let start = text.len();
        let count = objects.len();
        format!(
            "{text}{table}trailer\n<</Size {}\n/Root 1 0 R\n/Info {count} 0 R>>\nstartxref\n{start}\n%%EOF\n",
            count + 1
        )
        .into_bytes()
    }

    fn book(catalog: &str, font: &str, time: &str) -> Vec<u8> {
        pdf(&[
            &format!("<</Type /Catalog\n/Pages 2 0 R\n/Dests 5 0 R\n{catalog}>>"),
            "<</Type /Pages\n/Kids [3 0 R 6 0 R]\n/Count 3>>",
            "<</Type /Page\n/Parent 2 0 R>>",
            "<</Type /Page\n/Parent 6 0 R\n/Annots [<</A 9 0 R>>]>>",
            "<</eq#3aone [3 0 R /XYZ 1.5 -2 0]\n/fig:two [4 0 R /XYZ 0 0 0]\n/last [7 0 R /XYZ 0 0 0]>>",
            "<</Type /Pages\n/Kids [4 0 R 7 0 R]\n/Count 2>>",
            "<</Type /Page\n/Parent 6 0 R>>",
            font,
            "<</FontFile2 3 0 R>>",
            &format!("<</Title (a \\(b\\) c)\n/CreationDate (D:{time})\n/ModDate (D:{time})>>"),
        ])
    }

    const PROMISED: &str = "/MarkInfo <</Marked true>>\n/StructTreeRoot 9 0 R\n/Outlines 9 0 R";
    const FONT: &str =
        "<</Type /Font\n/Subtype /CIDFontType2\n/BaseFont /AAAAAA+Serif\n/FontDescriptor 9 0 R>>";

    #[test]
    fn a_name_is_on_the_page_that_its_place_names_whatever_tree_the_pages_form() {
        let bytes = book(PROMISED, FONT, "20260101000000Z");
        let document = Document::read(&bytes).unwrap();
        let names = document.names().unwrap();
        let expected = [("eq:one", 1), ("fig:two", 2), ("last", 3)];
        assert_eq!(names, expected.map(|(name, page)| (name.to_owned(), page)).into());
        assert_eq!(document.page_count(), 3);
        assert_eq!(document.problems(), Vec::<String>::new());
    }

    #[test]
    fn what_was_promised_and_is_not_there_is_said() {
        let problems = |catalog: &str, font: &str| {
            let bytes = book(catalog, font, "20260101000000Z");
            Document::read(&bytes).unwrap().problems().join("; ")
        };
        assert!(problems("", FONT).contains("no outline; it has no tags"));
        let bare = "<</Type /Font\n/Subtype /Type1\n/BaseFont /Times-Roman>>";
        assert_eq!(problems(PROMISED, bare), "the font Times-Roman is not in it");
        let link = "<</Type /Annot\n/A <</S /URI\n/URI (file:///tmp/a.html)>>>>";
        assert!(problems(PROMISED, link).contains("file:///tmp/a.html"));
    }

    #[test]
    fn two_documents_that_differ_by_their_time_become_the_same() {
        let one = without_chance(book(PROMISED, FONT, "20260101120000-05'30'")).unwrap();
        let other = without_chance(book(PROMISED, FONT, "20270203040506+00'00'")).unwrap();
        assert_eq!(one, other);
        let text = String::from_utf8(one).unwrap();
        assert!(
            text.contains("/CreationDate (D:19800101000000+00'00')\n/ModDate (D:19800101"),
            "{text}"
        );
    }

    #[test]
    fn two_documents_that_differ_by_what_was_counted_before_become_the_same() {
        let counted = |first: usize| {
            let [one, two] = [first, first + 7].map(|number| format!("(node{number:08})"));
            let font =
                format!("<</IDTree [{one} 9 0 R {two} 9 0 R]\n/Headers [{two} {one} {two}]>>");
            let bytes = without_chance(book(PROMISED, &font, "20260101000000Z")).unwrap();
            String::from_utf8(bytes).unwrap()
        };
        assert_eq!(counted(2392), counted(99_990));
        let expected = "[(node00000002) (node00000001) (node00000002)]";
        assert!(counted(2392).contains(expected), "{}", counted(2392));
    }

    #[test]
    fn what_is_no_document_of_chromium_is_refused() {
        for bytes in [&b""[..], b"%PDF-1.7\nstartxref\n9\n%%EOF", b"startxref\n99999\n%%EOF"] {
            assert!(Document::read(bytes).is_err());
        }
    }
}
