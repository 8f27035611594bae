//! Figures with their data.

use std::path::{Path, PathBuf};

use maud::{Markup, PreEscaped, html};

use super::Emitter;
use crate::attributes::Attributes;
use crate::blocks::Block;
use crate::exhibits::{Drawing, Link};
use crate::files;
use crate::prose::{Lead, table};
use crate::recordings;

/// The rows of a figure's data that the page shows; the CSV file has all.
const ROWS_SHOWN: usize = 30;
/// A picture to take hold of whose script has more bytes is loaded when a reader asks for it, and not by coming near.
const LARGE: usize = 250_000;

impl Emitter<'_, '_> {
    pub(super) fn figure(
        &mut self,
        block: &Block,
        caption: &str,
        path: &str,
        attributes: &Attributes,
    ) {
        self.labelled(block.line, attributes, "fig:", "a figure");
        let id = &attributes.id;
        if attributes.value("alt").trim().is_empty() {
            self.fault(
                block.line,
                id,
                "the figure has no alternative text",
                "say in alt=\"…\" what a reader who cannot see it should know",
            );
        }
        if let Some(scene) = recordings::scene(path) {
            return self.recording(block, caption, scene, attributes);
        }
        let name = path.trim_end_matches(".svg");
        let drawing =
            name.split_once('/').and_then(|(slug, name)| self.known.exhibits.drawing(slug, name));
        let Some((drawing, folder)) = drawing else {
            let slug = name.split_once('/').map_or(self.page.owner.as_str(), |(slug, _)| slug);
            self.missing(id);
            return self.fault(
                block.line,
                path,
                "no program draws this figure",
                format!("register it in exhibits/src/{slug}.rs; the path is chapter/name.svg"),
            );
        };
        self.found.figures.insert(name.to_owned());
        let alt = self.plain(block.line, attributes.value("alt"));
        let caption = self.resolve(block.line, caption);
        let read = |end: &str| files::read(&folder.join(format!("{}.{end}", drawing.name)));
        let (svg, csv) = match (read("svg"), read("csv")) {
            (Ok(svg), Ok(csv)) => (svg, csv),
            (Err(error), _) | (_, Err(error)) => {
                return self.fault(
                    block.line,
                    id,
                    format!("{error:#}"),
                    "delete target/press and build again",
                );
            }
        };
        let links = self.links(block.line, &drawing.links);
        let data = self.data(block, name, drawing, csv, &links);
        let svg: String = svg
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty() && !line.starts_with("<?xml"))
            .collect::<Vec<_>>()
            .join(" ");
        let plot = plot(&alt, &svg, &links);
        let (marks, note) = self.widget(block, attributes);
        let html = format!(
            "<figure class=\"exhibit\" id=\"{id}\"{marks}>\n{}\n{note}<figcaption>\n\n**Figure {}.** {}\n\n</figcaption>\n{data}\n</figure>\n",
            plot.into_string(),
            block.number,
            caption.replace('\n', " "),
        );
        self.lines(&block.indent, &html);
    }

    /// The rectangles of a figure that lead somewhere, with where they lead.
    fn links<'d>(&mut self, line: usize, links: &'d [Link]) -> Vec<(&'d Link, Lead)> {
        let prose = self.prose(line, false);
        let lead = |link: &'d Link| Some((link, prose.lead(&link.to, self.known, self.found)?));
        links.iter().filter_map(lead).collect()
    }

    /// What marks a figure as one to take hold of, and what it says while it stands still.
    fn widget(&mut self, block: &Block, attributes: &Attributes) -> (String, String) {
        let name = attributes.value("widget");
        match self.known.widgets.get(name) {
            Some(Some(size)) => {
                let way = |file: &str| self.page.way_to(&Path::new("generated/widgets").join(file));
                let (script, module) = (way("widgets.js"), way(&format!("{name}.js")));
                let marks = format!(
                    " data-widget=\"{name}\" data-script=\"{script}\" data-module=\"{module}\""
                );
                let note = html! {
                    p.widget-note role="status" {
                        "Where the browser runs scripts and WebAssembly, this picture can be taken hold of. Here it stands still."
                    }
                    @if *size > LARGE {
                        p.widget-open hidden {
                            button type="button" { "Take hold of it" }
                            " loads " (size / 1000) " kB once."
                        }
                    }
                };
                return (marks, format!("{}\n", note.into_string()));
            }
            None if !name.is_empty() => {
                let problem = "there is no such picture to take hold of";
                let mend = format!("write widgets/src/{name}.rs and widgets/modules/{name}.rs");
                self.fault(block.line, name, problem, mend);
            }
            _ => {}
        }
        Default::default()
    }

    /// The data of a figure as a fold with a table, its CSV file and the program that drew it.
    fn data(
        &mut self,
        block: &Block,
        name: &str,
        drawing: &Drawing,
        csv: String,
        links: &[(&Link, Lead)],
    ) -> String {
        let path = PathBuf::from(format!("{name}.csv"));
        let file = self.page.way_to(&Path::new("generated").join(&path));
        self.found.generated.insert(path, csv.into_bytes());
        let program = self.source(&drawing.file, drawing.line);
        let led = |cell: &str| links.iter().find(|(link, _)| link.to == cell);
        let row = |cells: &Vec<String>| {
            html! { @for cell in cells { td {
                @match led(cell) {
                    Some((_, lead)) => a href=(lead.way) { (lead.in_full()) },
                    None => (cell),
                }
            } } }
        };
        let rows: Vec<Markup> = drawing.rows.iter().take(ROWS_SHOWN).map(row).collect();
        let more = drawing.rows.len() - rows.len();
        let data = html! {
            details.data {
                summary { "Data of Figure " (block.number) }
                (table(None, &drawing.columns, &rows))
                p {
                    @if more > 0 { (more) " more rows in the " }
                    a href=(file) download { "CSV file" } " · " a href=(program) { "program" }
                }
            }
        };
        data.into_string()
    }
}

/// The drawing itself. One that leads nowhere is a picture; of one that does, the links are read, and not the letters
/// that are drawn in it.
fn plot(alt: &str, svg: &str, links: &[(&Link, Lead)]) -> Markup {
    let inside = svg.split_once('>').zip(svg.rfind("</svg>"));
    let Some(((opening, _), end)) = inside.filter(|_| !links.is_empty()) else {
        return html! { div.plot role="img" aria-label=(alt) { (PreEscaped(svg)) } };
    };
    let drawn = &svg[opening.len() + 1..end];
    html! {
        div.plot.diagram role="group" aria-label=(alt) {
            (PreEscaped(opening)) (PreEscaped(">"))
            g aria-hidden="true" { (PreEscaped(drawn)) }
            @for (link, lead) in links { (linked(link, lead)) }
            (PreEscaped("</svg>"))
        }
    }
}

/// A rectangle that can be pressed, with the name of what it leads to at its lower edge.
fn linked(Link { name, before, corner, size, .. }: &Link, lead: &Lead) -> Markup {
    let label = format!("{name}: {before}{}", lead.in_full());
    html! {
        a href=(lead.way) aria-label=(label) {
            title { (lead.in_full()) }
            rect x=(corner.0) y=(corner.1) width=(size.0) height=(size.1) {}
            text x=(corner.0 + 24) y=(corner.1 + size.1 - 28) { (before) tspan { (lead.name) } }
        }
    }
}
