//! The pages of the book, built once and read as files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use press::api::items::Library;
use press::files;
use press::inline::NAMED_LABEL;
use press::make::Maker;
use press::pages::slashed;
use press::settings::Layout;
use press::steps::Steps;
use press::warnings::Warnings;
use scraper::{ElementRef, Html, Selector};

/// The book and what the press found wrong with it.
struct Built {
    folder: tempfile::TempDir,
    report: String,
}

static BUILT: LazyLock<Built> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let maker = Maker {
        layout: Layout { root: root() },
        steps: Steps::quiet(),
        warnings: Warnings::default(),
        mine: false,
    };
    let faults = maker.build(&folder.path().join("site")).expect("a book");
    Built { folder, report: faults.report() }
});

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace").to_path_buf()
}

fn site() -> PathBuf {
    BUILT.folder.path().join("site")
}

/// The chapters' pages: name and document.
fn pages() -> Vec<(String, Html)> {
    let pages = html(|name| {
        !name.starts_with("generated")
            && !name.starts_with("api/")
            && !["toc.html", "print.html"].contains(&name)
    });
    assert!(pages.len() >= 6, "the book has lost its pages");
    pages
}

/// The library's pages: name and document.
fn library() -> Vec<(String, Html)> {
    let pages = html(|name| name.starts_with("api/vislam/"));
    assert!(pages.len() >= 20, "the library has lost its pages");
    pages
}

/// The pages whose names are wanted.
fn html(wanted: impl Fn(&str) -> bool) -> Vec<(String, Html)> {
    let names = files::below(&site()).expect("the site");
    let names = names.iter().map(|path| slashed(path));
    let read = |name: String| {
        let text = files::read(&site().join(&name)).expect("a page");
        (name, Html::parse_document(&text))
    };
    names.filter(|name| name.ends_with(".html") && wanted(name)).map(read).collect()
}

fn all<'a>(page: &'a Html, pattern: &str) -> Vec<ElementRef<'a>> {
    page.select(&Selector::parse(pattern).expect("a selector")).collect()
}

#[test]
fn the_book_keeps_its_promises() {
    assert!(BUILT.report.is_empty(), "{}", BUILT.report);
}

#[test]
fn every_page_has_a_language_a_title_and_one_heading_of_the_first_rank() {
    for (name, page) in pages() {
        assert_eq!(all(&page, "html[lang=en]").len(), 1, "{name}");
        assert!(all(&page, "title")[0].text().any(|text| !text.trim().is_empty()), "{name}");
        assert_eq!(all(&page, "main h1").len(), 1, "{name}");
    }
}

#[test]
fn every_chapter_has_its_picture_under_its_term() {
    let chapters = pages().into_iter().filter(|(_, page)| !all(page, ".opening").is_empty());
    let without = chapters.filter(|(_, page)| all(page, "main h1 + .subtitle").is_empty());
    assert_eq!(without.map(|(name, _)| name).collect::<Vec<_>>(), Vec::<String>::new());
}

#[test]
fn every_numbered_equation_shows_its_check_or_that_it_is_a_definition() {
    let mut numbered = 0;
    for (name, page) in pages() {
        for equation in all(&page, ".equation[id]") {
            let marks = Selector::parse("details.check, .definition-mark").expect("a selector");
            assert_eq!(equation.select(&marks).count(), 1, "{name}: {:?}", equation.attr("id"));
            numbered += 1;
        }
    }
    assert!(numbered > 0, "the book has lost its equations");
}

#[test]
fn no_formula_is_left_as_tex() {
    for (name, page) in pages() {
        assert!(all(&page, ".katex-error").is_empty(), "{name}");
        for paragraph in all(&page, "main p, main li, main figcaption, main td") {
            let text: String = paragraph.text().collect();
            assert!(!text.contains('$') && !text.contains("\\vv"), "{name}: {text}");
        }
    }
}

#[test]
fn every_figure_has_a_text_a_caption_data_and_a_program() {
    let mut figures = 0;
    for (name, page) in pages() {
        for figure in all(&page, "figure.exhibit") {
            let drawn =
                [".plot[role][aria-label] svg", "figcaption", "details table", "a[download]"];
            // A scene in three dimensions has a command in the place of data.
            let scene =
                [".plot img[alt]", "figcaption", ".recording-note code", ".recording-note a[href]"];
            let image = Selector::parse(".plot img").expect("a selector");
            for part in if figure.select(&image).next().is_some() { scene } else { drawn } {
                let part = Selector::parse(part).expect("a selector");
                assert!(figure.select(&part).next().is_some(), "{name}: {:?}", figure.attr("id"));
            }
            figures += 1;
        }
    }
    assert!(figures > 0, "the book has lost its figures");
}

#[test]
fn every_block_of_a_diagram_is_a_link_with_a_name() {
    let mut blocks = 0;
    for (name, page) in pages() {
        for block in all(&page, ".plot.diagram svg a") {
            assert!(block.attr("href").is_some_and(|address| address.contains('#')), "{name}");
            assert!(block.attr("aria-label").is_some_and(|text| text.contains(": ")), "{name}");
            blocks += 1;
        }
    }
    assert!(blocks > 0, "the book has lost its diagrams");
}

#[test]
fn the_search_finds_words_and_holds_no_tex() {
    let names = files::below(&site()).expect("the site");
    let index = names
        .iter()
        .find(|path| path.to_string_lossy().starts_with("searchindex"))
        .expect("a search index");
    let index = files::read(&site().join(index)).expect("the index");
    assert!(index.contains("disparity"));
    for tex in ["\\\\\\\\frac", "\\\\\\\\mat", "\\\\\\\\vv", "htmlClass"] {
        assert!(!index.contains(tex), "the search index holds {tex}");
    }
}

#[test]
fn links_work_below_any_address() {
    for (name, page) in pages().iter().chain(&library()).filter(|(name, _)| name != "404.html") {
        for (pattern, attribute) in [("[href]", "href"), ("[src]", "src")] {
            for element in all(page, pattern) {
                let address = element.attr(attribute).unwrap_or_default();
                assert!(
                    !address.starts_with('/'),
                    "{name}: {address} works only at the root of a host"
                );
            }
        }
    }
}

#[test]
fn every_page_of_the_library_leads_back_and_shows_no_tex() {
    let mut equations = 0;
    for (name, page) in library() {
        let up = "../".repeat(name.matches('/').count());
        let bar = all(&page, "nav.book-bar a");
        assert_eq!(bar[0].attr("href"), Some(format!("{up}index.html").as_str()), "{name}");
        for paragraph in all(&page, ".docblock p, .docblock li, dd") {
            let text: String = paragraph.text().collect();
            assert!(!text.contains('$') && !text.contains("{eq:d"), "{name}: {text}");
        }
        equations += all(&page, ".book-equation .katex-mathml math").len();
    }
    assert!(equations >= 9, "the library has lost its equations");
}

#[test]
fn the_press_knows_the_page_of_every_item() {
    let pages: BTreeMap<String, Html> = library().into_iter().collect();
    let library = Library::read(&root(), "vislam").expect("the library");
    assert!(library.items().count() > 50, "the library has lost its items");
    for item in library.items() {
        let (page, anchor) = item.page.split_once('#').unwrap_or((&item.page, ""));
        let page = pages.get(page).unwrap_or_else(|| panic!("{}: no {page}", item.path));
        let place = format!("[id='{anchor}']");
        assert!(anchor.is_empty() || !all(page, &place).is_empty(), "{}: {}", item.path, item.page);
    }
}

#[test]
fn a_listing_of_the_library_leads_to_its_items_and_an_item_to_its_equation() {
    let link = "figure.listing a.api[href^='api/vislam/bearing/fn.depth_sigma.html']";
    assert!(pages().iter().any(|(_, page)| !all(page, link).is_empty()), "no listing has {link}");
    let library = library();
    let page = |wanted: &str| &library.iter().find(|(name, _)| name == wanted).expect(wanted).1;
    let item = page("api/vislam/bearing/fn.depth_sigma.html");
    assert_eq!(all(item, "a[href='../../../bearing.html#eq:depth-sigma']").len(), 1);
    assert_eq!(all(item, ".book-source a[href*='generated/source/code/src/bearing.rs']").len(), 1);
    let module = page("api/vislam/bearing/index.html");
    assert_eq!(all(module, ".book-source a[href='../../../bearing.html']").len(), 1);
}

#[test]
fn every_line_of_an_algorithm_leads_to_a_line_of_code() {
    let mut lines = 0;
    for (name, page) in pages() {
        for line in all(&page, ".algorithm .steps > li") {
            let link = Selector::parse("a.step-number").expect("a selector");
            let href = line.select(&link).next().and_then(|link| link.attr("href"));
            let (file, number) = href
                .and_then(|href| href.split_once("generated/source/")?.1.split_once(".html#L"))
                .unwrap_or_else(|| panic!("{name}: line {:?} leads nowhere", line.attr("value")));
            let number: usize = number.parse().expect("a number");
            let source = files::read(&root().join(file)).expect("a source");
            let code = source.lines().nth(number - 1).unwrap_or_default().trim();
            assert!(!code.is_empty() && !code.starts_with("//"), "{name}: {file}, line {number}");
            lines += 1;
        }
    }
    assert!(lines > 50, "the book has lost its algorithms");
}

#[test]
fn citations_lead_to_the_bibliography_and_back() {
    let pages = pages();
    let references =
        &pages.iter().find(|(name, _)| name == "references.html").expect("references").1;
    let works: BTreeSet<&str> = all(references, "dl.bibliography dt[id]")
        .iter()
        .filter_map(|work| work.attr("id"))
        .collect();
    assert!(works.len() >= 9, "{works:?}");
    let back: BTreeSet<&str> =
        all(references, ".cited-in a").iter().filter_map(|link| link.attr("href")).collect();
    let mut citations = 0;
    for (name, page) in pages.iter().filter(|(name, _)| name != "index.html") {
        for citation in all(page, "a.citation") {
            let id = citation.attr("id").expect("an anchor");
            assert!(
                back.contains(format!("{name}#{id}").as_str()),
                "{name}#{id} is not linked back"
            );
            citations += 1;
        }
    }
    assert!(citations > 0, "the book cites nothing");
}

#[test]
fn every_label_that_the_library_names_stands_in_the_book() {
    let anchors: BTreeSet<String> = pages()
        .iter()
        .flat_map(|(_, page)| {
            all(page, "[id]")
                .iter()
                .filter_map(|element| element.attr("id"))
                .map(str::to_owned)
                .collect::<Vec<_>>()
        })
        .collect();
    let folder = root().join("code/src");
    let mut named = 0;
    for file in files::below(&folder).expect("the library") {
        let source = files::read(&folder.join(&file)).expect("a source");
        for found in NAMED_LABEL.captures_iter(&source).filter(|found| &found[1] != "eq:label") {
            assert!(anchors.contains(&found[1]), "{} names {}", file.display(), &found[1]);
            named += 1;
        }
    }
    assert!(named > 0, "the library names no equation");
}

/// Minutes of reading that a week of the course asks for at most.
const WEEK: usize = 75;

#[test]
fn no_week_of_the_course_asks_for_too_much_reading_or_for_no_exercise() {
    let pages = pages();
    let (_, course) = pages.iter().find(|(name, _)| name == "instructors.html").expect("a course");
    let text = |cell: &ElementRef<'_>| cell.text().collect::<String>();
    let mut weeks = 0;
    for row in all(course, "tr") {
        let cells: Vec<String> = row
            .child_elements()
            .filter(|cell| cell.value().name() == "td")
            .map(|cell| text(&cell))
            .collect();
        let [week, chapters, reading, _, exercise, _] = &cells[..] else { continue };
        weeks += 1;
        assert_eq!(*week, weeks.to_string());
        assert!(chapters.contains("Chapter"), "week {week} has no chapter");
        let minutes = reading.split_once('\u{a0}').filter(|(_, unit)| *unit == "minutes");
        let minutes = minutes.and_then(|(minutes, _)| minutes.parse::<usize>().ok());
        assert!(minutes.is_some_and(|minutes| minutes <= WEEK), "week {week}: {reading}");
        assert!(!exercise.starts_with("none"), "week {week} has no exercise");
    }
    assert_eq!(weeks, 10);
}
