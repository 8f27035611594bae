//! The figures of the built book for slides: as SVG without fonts and as PNG, with a file of their captions.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use anyhow::{Context, Result, bail};
use regex::{Captures, Regex};
use scraper::{ElementRef, Html, Selector};

use crate::cargo;
use crate::files;
use crate::make::Maker;
use crate::pages::{Page, slashed};
use crate::reports::VERSION;

/// Where the colours of figures have their values.
const COLOURS: &str = "press/theme/css/variables.css";
/// Where the letters of figures have their outlines.
const FONTS: &str = "press/theme/fonts";
/// What slides may do with them.
const LICENCE: &str = "You may use and change these figures in slides of your own, if you name the book: \
    CC BY 4.0, <https://creativecommons.org/licenses/by/4.0/>.";

/// A figure as a page shows it.
#[derive(Debug)]
struct Figure {
    /// The name of its files, without an ending.
    name: String,
    /// `1.2`.
    number: String,
    /// The page and the anchor: `bearing.html#fig:rays`.
    address: String,
    /// What stands below it, without the number.
    caption: String,
    /// What a reader who cannot see it should know.
    alternative: String,
    /// What is drawn.
    drawing: Drawing,
}

/// What a figure shows.
#[derive(Debug)]
enum Drawing {
    /// A drawing, as SVG with the colours of the theme by name.
    Lines(String),
    /// A picture as PNG: its file in the built book.
    Picture(PathBuf),
}

/// Writes all figures of the book that was built last into a folder that is new or empty, and gives how many.
///
/// # Errors
/// A book that was not built, a folder that holds something, and what keeps letters from becoming outlines.
pub fn export(maker: &Maker, folder: &Path) -> Result<usize> {
    if fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        bail!("{} is not empty; name a new folder", folder.display());
    }
    let work = maker.layout.work().join("figures");
    files::remove(&work)?;
    let number = gather(maker, &work)?;
    maker.steps.step("letters as outlines, and pictures", || outline(&maker.layout.root, &work))?;
    for file in files::below(&work)? {
        let bytes = fs::read(work.join(&file)).context("a figure went away")?;
        files::write(&folder.join(&file), &bytes)?;
    }
    files::remove(&work)?;
    Ok(number)
}

/// Writes the figures, with letters that are letters still, their captions, and the pictures that there are.
///
/// # Errors
/// A book that was not built, and a figure that the press did not write.
pub fn gather(maker: &Maker, folder: &Path) -> Result<usize> {
    let site = maker.layout.root.join("book");
    let book = maker.load()?;
    let of = |page: Page| of_page(&site, &page).map(|figures| (page, figures));
    let pages = Page::all(&book.book).into_iter().map(of).collect::<Result<Vec<_>>>()?;
    let figures: Vec<&Figure> = pages.iter().flat_map(|(_, figures)| figures).collect();
    if figures.is_empty() {
        bail!("the book in {} has no figures", site.display());
    }
    let colours = Colours::of(&files::read(&maker.layout.root.join(COLOURS))?);
    for figure in &figures {
        write(figure, &site, &colours, folder)?;
    }
    let title = book.config.book.title.unwrap_or_default();
    files::write(&folder.join("captions.md"), captions(&title, &pages).as_bytes())?;
    Ok(figures.len())
}

/// Draws the letters of all figures in a folder, and makes their pictures.
fn outline(root: &Path, folder: &Path) -> Result<()> {
    let paths = [root.join(FONTS), folder.join("svg"), folder.join("png")];
    let paths = paths.iter().map(|path| path.to_str()).collect::<Option<Vec<_>>>();
    let paths = paths.context("the path of the book is not Unicode")?;
    let program = ["run", "--quiet", "--locked", "--package", "outlines", "--"];
    cargo::call(root, &[&program[..], &paths].concat(), "draw the letters of the figures")?;
    Ok(())
}

fn of_page(site: &Path, page: &Page) -> Result<Vec<Figure>> {
    let path = page.path.with_extension("html");
    let html = files::read(&site.join(&path)).context("`cargo book build` makes it")?;
    let document = Html::parse_document(&html);
    let figures = document.select(&FIGURE).map(|figure| {
        let id = figure.attr("id").unwrap_or_default();
        read(figure, id, page, &path).with_context(|| {
            format!("{}#{id} is not as the press writes it; build the book again", slashed(&path))
        })
    });
    figures.collect()
}

static FIGURE: LazyLock<Selector> = LazyLock::new(|| selector("figure.exhibit"));
static CAPTION: LazyLock<Selector> = LazyLock::new(|| selector("figcaption"));
static PLOT: LazyLock<Selector> = LazyLock::new(|| selector(".plot"));
static SVG: LazyLock<Selector> = LazyLock::new(|| selector("svg"));
static PICTURE: LazyLock<Selector> = LazyLock::new(|| selector("img"));

fn selector(pattern: &str) -> Selector {
    Selector::parse(pattern).expect("a valid selector")
}

fn read(figure: ElementRef<'_>, id: &str, page: &Page, path: &Path) -> Option<Figure> {
    let label = id.strip_prefix("fig:")?;
    let caption = words(figure.select(&CAPTION).next()?);
    let (number, caption) = caption.strip_prefix("Figure ")?.split_once(". ")?;
    let plot = figure.select(&PLOT).next()?;
    let (alternative, drawing) = match plot.select(&SVG).next() {
        Some(svg) => (plot.attr("aria-label")?, Drawing::Lines(drawn(svg))),
        None => {
            let picture = plot.select(&PICTURE).next()?;
            let file = files::joined(path.parent()?, picture.attr("src")?)?;
            (picture.attr("alt")?, Drawing::Picture(file))
        }
    };
    // A page below a chapter has a letter, which needs no zero to stand in order.
    let padded =
        |part: &str| part.parse().map_or(part.to_owned(), |part: usize| format!("{part:02}"));
    let place: Vec<String> = number.split('.').map(padded).collect();
    let chapter = if page.number.is_none() { format!("{}-", page.slug) } else { String::new() };
    Some(Figure {
        name: format!("{chapter}{}-{label}", place.join("-")),
        number: number.to_owned(),
        address: format!("{}#{id}", slashed(path)),
        caption: caption.to_owned(),
        alternative: alternative.split_whitespace().collect::<Vec<_>>().join(" "),
        drawing,
    })
}

/// What is read aloud of an element: its text, and each formula once, without what only a page can do.
fn words(element: ElementRef<'_>) -> String {
    fn add(element: ElementRef<'_>, text: &mut String) {
        for child in element.children() {
            match (child.value().as_text(), ElementRef::wrap(child)) {
                (Some(part), _) => text.push_str(part),
                (_, Some(inner)) if is_said(inner) => add(inner, text),
                _ => {}
            }
        }
    }
    fn is_said(element: ElementRef<'_>) -> bool {
        element.attr("aria-hidden") != Some("true") && element.attr("class") != Some("screen")
    }
    let mut text = String::new();
    add(element, &mut text);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The drawing as a file of its own. What is only there to be pressed is not drawn.
fn drawn(svg: ElementRef<'_>) -> String {
    const STYLE: &str =
        "<style>a text { font-size: 46px; fill: currentColor } a rect { fill: none }</style>";
    let xml = svg.html().replace("&nbsp;", "\u{a0}");
    match xml.split_once('>') {
        Some((opening, inside)) => format!("{opening}>{STYLE}{inside}\n"),
        None => xml,
    }
}

/// Writes a figure; what is drawn waits for its outlines and its picture.
fn write(figure: &Figure, site: &Path, colours: &Colours, folder: &Path) -> Result<()> {
    match &figure.drawing {
        Drawing::Lines(svg) => {
            let svg = colours.filled(svg).with_context(|| figure.address.clone())?;
            files::write(&folder.join(format!("svg/{}.svg", figure.name)), svg.as_bytes())
        }
        Drawing::Picture(file) => {
            let file = site.join(file);
            let picture =
                fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
            files::write(&folder.join(format!("png/{}.png", figure.name)), &picture)
        }
    }
}

/// The colours of the light theme by their names.
struct Colours(BTreeMap<String, String>);

impl Colours {
    /// Those of a style sheet.
    fn of(css: &str) -> Colours {
        static COLOUR: LazyLock<Regex> = LazyLock::new(|| {
            let pattern = r"--([\w-]+):\s*(?:light-dark\(\s*)?(#[0-9a-fA-F]+|var\(--[\w-]+\))";
            Regex::new(pattern).expect("a valid pattern")
        });
        let colours = COLOUR.captures_iter(css).map(|found| (found[1].into(), found[2].into()));
        let mut colours: BTreeMap<String, String> = colours.collect();
        // Slides are white, whatever the page is.
        colours.insert("bg".to_owned(), "#ffffff".to_owned());
        Colours(colours)
    }

    /// A drawing with its colours for their names.
    fn filled(&self, svg: &str) -> Result<String> {
        static NAMED: LazyLock<Regex> = LazyLock::new(|| {
            Regex::new(r"var\(--([\w-]+)\)|currentColor").expect("a valid pattern")
        });
        let mut unknown = None;
        let filled = NAMED.replace_all(svg, |found: &Captures<'_>| {
            let name = found.get(1).map_or("fg", |name| name.as_str());
            self.value(name).unwrap_or_else(|| {
                unknown = Some(name.to_owned());
                String::new()
            })
        });
        match unknown {
            Some(name) => bail!("the figure has the colour --{name}, and {COLOURS} has not"),
            None => Ok(filled.into_owned()),
        }
    }

    fn value(&self, name: &str) -> Option<String> {
        let value = self.0.get(name)?;
        match value.strip_prefix("var(--").and_then(|other| other.strip_suffix(')')) {
            Some(other) => self.0.get(other).cloned(),
            None => Some(value.clone()),
        }
    }
}

/// The captions of all figures, page by page.
fn captions(title: &str, pages: &[(Page, Vec<Figure>)]) -> String {
    let mut text = format!("# Figures of “{title}”, version {VERSION}\n\n{LICENCE}\n");
    for (page, figures) in pages.iter().filter(|(_, figures)| !figures.is_empty()) {
        let number = page.number.iter().map(|number| format!("{number} ")).collect::<String>();
        text.push_str(&format!("\n## {number}{}\n", page.name));
        for Figure { name, number, address, caption, alternative, drawing } in figures {
            let kinds = match drawing {
                Drawing::Lines(_) => format!("`svg/{name}.svg`, `png/{name}.png`"),
                Drawing::Picture(_) => format!("`png/{name}.png`"),
            };
            text.push_str(&format!(
                "\n### Figure {number}\n\n{caption}\n\n- Files: {kinds}\n- In the book: `{address}`\n\
                 - For those who cannot see it: {alternative}\n"
            ));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_the_light_theme_and_the_ground_is_white() {
        let colours = Colours::of(
            ":root { --fg: light-dark(#1f1d1a, #dedbd3);\n--bg: light-dark(#fdfcf9, #16181c);\n--plot-ground: var(--bg); }",
        );
        let filled =
            colours.filled("<a fill=\"currentColor\" stroke=\"var(--plot-ground)\"/>").unwrap();
        assert_eq!(filled, "<a fill=\"#1f1d1a\" stroke=\"#ffffff\"/>");
        let error = colours.filled("<a fill=\"var(--grid)\"/>").unwrap_err();
        assert!(error.to_string().contains("the colour --grid"), "{error}");
    }

    #[test]
    fn a_formula_in_a_caption_is_read_once() {
        let html = Html::parse_fragment(
            "<figcaption><p>The <span><math><mi>S</mi></math><span aria-hidden=\"true\">S</span></span>,\nbright.</p></figcaption>",
        );
        assert_eq!(words(html.select(&CAPTION).next().unwrap()), "The S, bright.");
    }

    #[test]
    fn what_only_a_screen_can_do_is_no_part_of_a_caption() {
        let html = Html::parse_fragment(
            "<figcaption>A flight. <span class=\"screen\">Take hold of it.</span></figcaption>",
        );
        assert_eq!(words(html.select(&CAPTION).next().unwrap()), "A flight.");
    }
}
