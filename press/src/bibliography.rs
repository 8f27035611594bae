//! The works the book cites, from `src/references.bib`.

use std::collections::BTreeMap;

use biblatex::{Bibliography as Parsed, ChunksExt, Entry, RawBibliography, RawChunk};

use crate::fault::Faults;

/// The file, as faults name it.
pub const FILE: &str = "src/references.bib";

/// The works by key.
#[derive(Debug, Default)]
pub struct Bibliography {
    works: BTreeMap<String, Work>,
}

/// A work, ready to be printed.
#[derive(Debug, PartialEq)]
pub struct Work {
    /// `Forster et al. 2017`, as a citation shows it.
    pub short: String,
    /// `Forster et al. (2017)`, as a sentence uses it.
    pub narrative: String,
    /// All authors.
    pub authors: String,
    /// The year.
    pub year: String,
    /// The title.
    pub title: String,
    /// Journal or proceedings, volume, pages.
    pub place: String,
    /// Where it is found: a DOI or an address, and its link.
    pub link: Option<(String, String)>,
    /// Our sentence on what it is good for.
    pub annotation: String,
    /// What of the entry could not be compared with the work's own page or a catalogue; empty when all was.
    pub unverified: String,
}

impl Bibliography {
    /// Reads the works; what is wrong with them is noted as faults.
    pub fn parse(source: &str, faults: &mut Faults) -> Bibliography {
        let raw = RawBibliography::parse(source);
        if let Some((at, name)) = raw.as_ref().ok().and_then(reference) {
            let problem = "what refers to other entries may lead back to itself, and is not read";
            let mend = "write out what it stands for";
            faults.add((FILE, line_at(source, at)), name, problem, mend);
            return Bibliography::default();
        }
        let parsed = match raw.and_then(Parsed::from_raw) {
            Ok(parsed) => parsed,
            Err(error) => {
                let line = line_at(source, error.span.start);
                faults.add(
                    (FILE, line),
                    "",
                    format!("not BibTeX: {}", error.kind),
                    "mend the entry; see CONTRIBUTING.md for an example",
                );
                return Bibliography::default();
            }
        };
        let mut works = BTreeMap::new();
        for entry in parsed.iter() {
            let line =
                source.find(&format!("{{{},", entry.key)).map_or(0, |at| line_at(source, at));
            for (field, names) in [
                ("author", &["author"] as &[_]),
                ("title", &["title"]),
                ("year", &["year", "date"]),
                ("annotation", &["annotation"]),
            ] {
                if first(entry, names).is_empty() {
                    let mend = format!("add `{field} = {{…}}`");
                    faults.add((FILE, line), &entry.key, format!("the work has no {field}"), mend);
                }
            }
            if text(entry, "verified").is_empty() == text(entry, "unverified").is_empty() {
                let problem =
                    "nothing says whether the entry was compared with the work's own page";
                let mend = "compare it, and add `verified = {with what}`, or `unverified = {what could not be confirmed}`";
                faults.add((FILE, line), &entry.key, problem, mend);
            }
            works.insert(entry.key.clone(), Work::new(entry));
        }
        tell_apart(&mut works);
        Bibliography { works }
    }

    /// The work of a key.
    pub fn get(&self, key: &str) -> Option<&Work> {
        self.works.get(key)
    }

    /// What a citation, `key` or `key, page 3`, shows of a work: its key, and its name as it stands in brackets or as a
    /// sentence uses it. Where there is no such work, a fault.
    pub fn cited<'a>(
        &self,
        place: (&str, usize),
        cited: &'a str,
        narrative: bool,
        faults: &mut Faults,
    ) -> (&'a str, Option<String>) {
        let (key, locator) = cited.split_once(',').unwrap_or((cited, ""));
        let Some(work) = self.get(key) else {
            let mend = format!("add it to {FILE}, or write \\@ for the sign itself");
            faults.add(place, format!("@{key}"), "the bibliography has no such work", mend);
            return (key, None);
        };
        let name = if narrative { &work.narrative } else { &work.short };
        let name = match locator.trim() {
            "" => name.clone(),
            locator => format!("{name}, {locator}"),
        };
        (key, Some(name))
    }

    /// The works in the order of a bibliography: authors, then year.
    pub fn sorted(&self) -> Vec<(&str, &Work)> {
        let mut works: Vec<_> = self.works.iter().map(|(key, work)| (key.as_str(), work)).collect();
        works.sort_by_key(|(_, work)| (work.authors.to_lowercase(), work.year.clone()));
        works
    }
}

/// The first thing in a bibliography that is to be looked up elsewhere in it, and its byte: the parser follows
/// such references without end.
fn reference<'a>(raw: &RawBibliography<'a>) -> Option<(usize, &'a str)> {
    let is_abbreviation = |chunk: &RawChunk<'_>| matches!(chunk, RawChunk::Abbreviation(_));
    let entries = raw.entries.iter().flat_map(|entry| &entry.v.fields);
    let mut named = entries.filter(|field| {
        ["crossref", "xdata"].iter().any(|name| field.key.v.eq_ignore_ascii_case(name))
    });
    let mut nested = raw
        .abbreviations
        .iter()
        .filter(|field| field.value.v.iter().any(|chunk| is_abbreviation(&chunk.v)));
    named.next().or_else(|| nested.next()).map(|field| (field.key.span.start, field.key.v))
}

/// Gives a letter to the year of each of several works that would be cited alike, in the order of the bibliography.
fn tell_apart(works: &mut BTreeMap<String, Work>) {
    let mut alike: BTreeMap<String, Vec<&mut Work>> = BTreeMap::new();
    works.values_mut().for_each(|work| alike.entry(work.short.clone()).or_default().push(work));
    for mut works in alike.into_values().filter(|works| works.len() > 1) {
        works.sort_by_key(|work| (work.authors.to_lowercase(), work.title.clone()));
        for (letter, work) in ('a'..='z').zip(works) {
            let lettered = format!("{}{letter}", work.year);
            work.short = work.short.replace(&work.year, &lettered);
            work.narrative = work.narrative.replace(&work.year, &lettered);
            work.year = lettered;
        }
    }
}

impl Work {
    fn new(entry: &Entry) -> Work {
        let people = entry.author().unwrap_or_default();
        let family: Vec<String> = people
            .iter()
            .map(|person| format!("{} {}", person.prefix, person.name).trim().to_owned())
            .collect();
        let names = match &family[..] {
            [] => text(entry, "title"),
            [one] => one.clone(),
            [one, two] => format!("{one} and {two}"),
            [first, ..] => format!("{first} et al."),
        };
        let year = first(entry, &["year", "date"]).chars().take(4).collect::<String>();
        let authors = people.iter().zip(&family).map(|(person, family)| {
            let given = initials(&person.given_name);
            if given.is_empty() { family.clone() } else { format!("{family}, {given}") }
        });
        Work {
            short: format!("{names} {year}"),
            narrative: format!("{names} ({year})"),
            authors: authors.collect::<Vec<_>>().join("; "),
            title: text(entry, "title"),
            place: place(entry),
            link: link(entry),
            annotation: text(entry, "annotation"),
            unverified: text(entry, "unverified"),
            year,
        }
    }
}

fn text(entry: &Entry, field: &str) -> String {
    entry.get(field).map(|chunks| chunks.format_verbatim()).unwrap_or_default()
}

fn first(entry: &Entry, fields: &[&str]) -> String {
    fields.iter().map(|field| text(entry, field)).find(|text| !text.is_empty()).unwrap_or_default()
}

fn initials(given: &str) -> String {
    let initial = |name: &str| name.chars().next().map(|letter| format!("{letter}."));
    given.split([' ', '-', '~']).filter_map(initial).collect::<Vec<_>>().join(" ")
}

fn place(entry: &Entry) -> String {
    let mut place = first(
        entry,
        &["journaltitle", "journal", "booktitle", "publisher", "institution", "school"],
    );
    for (field, before, after) in [
        ("volume", " ", ""),
        ("number", " (", ")"),
        ("pages", ", ", ""),
        ("edition", ", edition ", ""),
    ] {
        let value = text(entry, field).replace("--", "–");
        if !value.is_empty() {
            place.push_str(&format!("{before}{value}{after}"));
        }
    }
    place
}

fn link(entry: &Entry) -> Option<(String, String)> {
    let link = |field: &str, name: &str, host: &str| {
        let value = text(entry, field);
        (!value.is_empty()).then(|| (format!("{name}{value}"), format!("{host}{value}")))
    };
    link("doi", "doi:", "https://doi.org/")
        .or_else(|| link("eprint", "arXiv:", "https://arxiv.org/abs/"))
        .or_else(|| link("url", "", ""))
}

fn line_at(text: &str, at: usize) -> usize {
    text[..at.min(text.len())].matches('\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_work_is_ready_to_be_printed() {
        let source = "@article{lupton2012,\n author = {Lupton, Todd and Sukkarieh, Salah},\n title = {Motion},\n journal = {T-RO}, volume = {28}, number = {1}, pages = {61--76}, year = {2012}, doi = {10.1/x}, annotation = {First.}, verified = {its page}\n}";
        let mut faults = Faults::default();
        let works = Bibliography::parse(source, &mut faults);
        assert!(faults.is_empty(), "{}", faults.report());
        let work = works.get("lupton2012").unwrap();
        assert_eq!(work.short, "Lupton and Sukkarieh 2012");
        assert_eq!(work.authors, "Lupton, T.; Sukkarieh, S.");
        assert_eq!(work.place, "T-RO 28 (1), 61–76");
    }

    #[test]
    fn a_firm_has_no_given_name() {
        let source = "@misc{adis, author = {{Analog Devices}}, title = {Data Sheet}, year = {2012}, annotation = {A.}, verified = {it}}";
        let works = Bibliography::parse(source, &mut Faults::default());
        assert_eq!(works.get("adis").map(|work| work.authors.as_str()), Some("Analog Devices"));
    }

    #[test]
    fn works_that_would_be_cited_alike_get_letters() {
        let entry = |key: &str, author: &str, title: &str| {
            format!(
                "@book{{{key}, author = {{{author}}}, title = {{{title}}}, year = {{2015}}, annotation = {{A.}}, verified = {{its page}}}}\n"
            )
        };
        let source = entry("later", "Carlone, Luca and Tron, Roberto and Kaess, M.", "Starts")
            + &entry("sooner", "Carlone, Luca and Rosen, David and Kaess, M.", "Duality")
            + &entry("other", "Rosen, David", "Sync");
        let mut faults = Faults::default();
        let works = Bibliography::parse(&source, &mut faults);
        assert!(faults.is_empty(), "{}", faults.report());
        let cited = ["sooner", "later", "other"].map(|key| works.get(key).unwrap());
        assert_eq!(
            cited.map(|work| work.narrative.as_str()),
            ["Carlone et al. (2015a)", "Carlone et al. (2015b)", "Rosen (2015)"]
        );
        assert_eq!(cited.map(|work| work.year.as_str()), ["2015a", "2015b", "2015"]);
    }
}
