//! The main road through the book stays so short that one can walk it in a term.

use std::sync::LazyLock;

use regex::Regex;

use crate::blocks::Block;
use crate::fault::Faults;
use crate::pages::Page;

/// What stands in prose and is read as no word: values, marks, formulas, code and targets of links.
static NO_WORDS: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new(r"(?s)\{\{.*?\}\}|\{.*?\}|\$[^$]*\$|`[^`]*`|\]\([^)]*\)|<[^>]*>")
        .expect("a valid pattern")
});

/// Adds a fault when the numbered chapters have more words on the main road than this.
pub fn check(pages: &[Page], longest: usize, faults: &mut Faults) {
    let chapters = pages.iter().filter(|page| page.is_chapter());
    let mut chapters: Vec<(usize, &Page)> =
        chapters.map(|page| (of_blocks(&page.blocks), page)).collect();
    let all: usize = chapters.iter().map(|(words, _)| words).sum();
    chapters.sort_by_key(|(words, _)| std::cmp::Reverse(*words));
    let Some((most, page)) = chapters.first().filter(|_| all > longest) else { return };
    faults.add(
        (&page.file, 0),
        "",
        format!("the main road through all chapters has {all} words, {most} of them here, and may have {longest}"),
        "say it shorter, or let a section lead into depth: `## Title {.depth establishes=\"…\"}`",
    );
}

/// Words outside of depth, in prose, captions and choices.
fn of_blocks(blocks: &[Block]) -> usize {
    blocks.iter().filter(|block| block.depth.is_none()).map(|block| words(block.said())).sum()
}

/// Words that have a letter. Rows of tables are looked up, not read.
fn words(text: &str) -> usize {
    let prose: Vec<&str> = text.lines().filter(|line| !line.starts_with('|')).collect();
    let prose = NO_WORDS.replace_all(&prose.join("\n"), " ").into_owned();
    prose.split_whitespace().filter(|word| word.chars().any(char::is_alphabetic)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blocks::blocks;

    #[test]
    fn words_are_counted_outside_of_formulas_marks_and_tables() {
        let page = "Four words stand here.\n\nA [term]{.symbol means=\"not read\"} $x + y$ of `code` and {{value a.b}} px.\n\n\
                    | a row | none |\n";
        let mut page = blocks(page);
        assert_eq!(of_blocks(&page), 4 + 5);
        page.iter_mut().for_each(|block| block.depth = Some(1));
        assert_eq!(of_blocks(&page), 0);
    }

    #[test]
    fn a_road_that_is_too_long_is_told() {
        let page = |slug: &str, text: &str| Page {
            file: format!("src/{slug}.md"),
            name: slug.to_owned(),
            path: format!("{slug}.md").into(),
            slug: slug.to_owned(),
            owner: slug.to_owned(),
            number: Some("1".to_owned()),
            blocks: blocks(text),
        };
        let pages = [page("short", "Two words.\n"), page("long", "And these are four.\n")];
        let told = |longest| {
            let mut faults = Faults::default();
            check(&pages, longest, &mut faults);
            faults.report()
        };
        assert!(told(6).is_empty());
        let said = told(5);
        assert!(
            said.contains("src/long.md") && said.contains("has 6 words, 4 of them here"),
            "{said}"
        );
    }
}
