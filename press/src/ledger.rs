//! The pages that the build writes from what it knows: the ledger and the bibliography.

use std::path::Path;

use crate::accepted::digest;
use crate::attributes::Attributes;
use crate::bibliography::Work;
use crate::blocks::Kind;
use crate::exhibits::Exhibits;
use crate::pages::Page;
use crate::prose::{Found, Known, REFERENCES, escape, link, source};

/// A table of the ledger.
struct Table {
    id: &'static str,
    title: &'static str,
    columns: &'static [&'static str],
    rows: Vec<Vec<String>>,
}

impl Table {
    fn html(&self) -> String {
        let row = |cell: &str, cells: &[String]| {
            format!(
                "<tr>{}</tr>",
                cells.iter().map(|text| format!("<{cell}>{text}</{cell}>")).collect::<String>()
            )
        };
        let columns: Vec<String> = self.columns.iter().map(|&column| column.to_owned()).collect();
        let rows: String = self.rows.iter().map(|cells| row("td", cells)).collect();
        format!(
            "## {} {{#ledger-{}}}\n\n<div class=\"table-wrapper\"><table><thead>{}</thead><tbody>{rows}</tbody></table></div>\n\n",
            self.title,
            self.id,
            row("th", &columns),
        )
    }
}

/// The ledger: every equation, number, figure, listing and record with what stands behind it.
pub fn ledger(here: &Page, pages: &[Page], known: &Known<'_>, found: &mut Found<'_>) -> String {
    let (equations, definitions) = equations(here, pages, known.exhibits, found);
    let tables = [
        equations,
        definitions,
        conditions(here, known, found),
        numbers(here, known.exhibits, found),
        figures(here, pages, known.exhibits, found),
        records(here, known.exhibits, found),
        unverified(here, known),
    ];
    let states: usize = known
        .exhibits
        .chapters
        .values()
        .flat_map(|shown| &shown.equations)
        .map(|check| check.states)
        .sum();
    let head = format!(
        "<p class=\"ledger-summary\">{} checked over {}, {}, {} with {}, each dropped in a counterexample, {}, {}, {}, {} of which {} could not be verified.</p>\n\n",
        counted(tables[0].rows.len(), "equation"),
        counted(states, "state"),
        counted(tables[1].rows.len(), "definition"),
        counted(known.theorems.count(), "theorem"),
        counted(tables[2].rows.len(), "condition"),
        counted(tables[3].rows.len(), "computed number"),
        counted(tables[4].rows.len(), "figure"),
        counted(tables[5].rows.len(), "record"),
        counted(known.bibliography.sorted().len(), "cited work"),
        tables[6].rows.len(),
    );
    head + &tables
        .iter()
        .filter(|table| !table.rows.is_empty())
        .map(Table::html)
        .collect::<String>()
}

fn counted(count: usize, thing: &str) -> String {
    match count {
        1 => format!("1 {thing}"),
        n => format!("{n} {thing}s"),
    }
}

/// The title of the chapter in a file.
fn title<'a>(pages: &'a [Page], path: &Path) -> &'a str {
    pages.iter().find(|page| page.path == path).map_or("", Page::title)
}

/// The labelled blocks of all pages with a kind of label.
fn labelled<'a>(
    pages: &'a [Page],
    kind: &'static str,
) -> impl Iterator<Item = (&'a Page, &'a str, &'a Attributes, &'a Kind)> {
    pages.iter().flat_map(move |page| {
        page.blocks.iter().filter_map(move |block| {
            let attributes = match &block.kind {
                Kind::Equation { attributes, .. } | Kind::Figure { attributes, .. } => attributes,
                _ => return None,
            };
            attributes.id.starts_with(kind).then_some((
                page,
                block.number.as_str(),
                attributes,
                &block.kind,
            ))
        })
    })
}

fn equations(
    here: &Page,
    pages: &[Page],
    exhibits: &Exhibits,
    found: &mut Found<'_>,
) -> (Table, Table) {
    let mut checked = Vec::new();
    let mut definitions = Vec::new();
    for (page, number, attributes, kind) in labelled(pages, "eq:") {
        let (id, label) = (&attributes.id, &attributes.id[3..]);
        let name = link(here, &page.path, id, &format!("({number})"));
        if attributes.has("definition") {
            definitions.push(vec![name, format!("<code>{id}</code>")]);
            continue;
        }
        let Some(check) = exhibits.check(&page.owner, label) else { continue };
        let Kind::Equation { tex, .. } = kind else { continue };
        let (file, line) = check.place();
        let href = source(here, &file, line, found);
        checked.push(vec![
            name,
            format!("<a href=\"{href}\"><code>{id}</code></a>"),
            escape(&check.against),
            check.worst.map_or("—".to_owned(), |worst| format!("{worst:.1e}")),
            format!("{:.0e}", check.tolerance),
            check.states.to_string(),
            escape(&check.mutants.join(", ")),
            format!("<code>{}</code>", digest(tex)),
        ]);
    }
    let columns = &[
        "Equation",
        "Check",
        "Compared with",
        "Largest error",
        "Tolerance",
        "States",
        "Wrong formulas it rejects",
        "TeX",
    ];
    (
        Table { id: "equations", title: "Equations", columns, rows: checked },
        Table {
            id: "definitions",
            title: "Definitions",
            columns: &["Equation", "Label"],
            rows: definitions,
        },
    )
}

fn conditions(here: &Page, known: &Known<'_>, found: &mut Found<'_>) -> Table {
    let mut rows = Vec::new();
    for case in known.exhibits.counterexamples() {
        let id = format!("thm:{}", case.theorem);
        let Some(target) = known.labels.get(&id) else { continue };
        let href = source(here, &case.file, case.line, found);
        rows.push(vec![
            link(here, &target.path, &id, &format!("Theorem {}", target.number)),
            format!("<a href=\"{href}\"><code>{}</code></a>", case.condition),
            escape(&case.against),
            format!("{:.1e}", case.kept),
            format!("{:.1e}", case.dropped),
            format!("{:.0e}", case.tolerance),
        ]);
    }
    let columns =
        &["Theorem", "Condition", "Compared with", "Error with it", "Without it", "Tolerance"];
    Table { id: "conditions", title: "Conditions and counterexamples", columns, rows }
}

fn numbers(here: &Page, exhibits: &Exhibits, found: &mut Found<'_>) -> Table {
    let mut rows = Vec::new();
    for shown in exhibits.chapters.values() {
        for number in &shown.numbers {
            let name = format!("{}.{}", shown.slug, number.name);
            let href = source(here, &number.file, number.line, found);
            let pages = found.values.get(&name).into_iter().flatten();
            let users: Vec<String> = pages
                .map(|path| {
                    format!(
                        "<a href=\"{}\">{}</a>",
                        here.way_to(path),
                        path.with_extension("").display()
                    )
                })
                .collect();
            rows.push(vec![
                format!("<a href=\"{href}\"><code>{name}</code></a>"),
                format!("{} {}", number.text.replace('-', "−"), escape(&number.unit)),
                number.value.map_or("—".to_owned(), |value| value.to_string()),
                users.join(", "),
            ]);
        }
    }
    Table {
        id: "numbers",
        title: "Numbers",
        columns: &["Number", "As printed", "In full", "Used in"],
        rows,
    }
}

fn figures(here: &Page, pages: &[Page], exhibits: &Exhibits, found: &mut Found<'_>) -> Table {
    let mut rows = Vec::new();
    for (page, number, attributes, kind) in labelled(pages, "fig:") {
        let Kind::Figure { path, .. } = kind else { continue };
        let name = path.trim_end_matches(".svg");
        let Some((drawing, _)) =
            name.split_once('/').and_then(|(slug, name)| exhibits.drawing(slug, name))
        else {
            continue;
        };
        let href = source(here, &drawing.file, drawing.line, found);
        rows.push(vec![
            link(here, &page.path, &attributes.id, &format!("Figure {number}")),
            format!("<a href=\"{href}\"><code>{}</code></a>", attributes.id),
            drawing.rows.len().to_string(),
            format!(
                "<a href=\"{}\" download>CSV</a>",
                here.way_to(format!("generated/{name}.csv").as_ref())
            ),
        ]);
    }
    Table {
        id: "figures",
        title: "Figures",
        columns: &["Figure", "Program", "Rows of data", "Data"],
        rows,
    }
}

fn records(here: &Page, exhibits: &Exhibits, found: &mut Found<'_>) -> Table {
    let mut rows = Vec::new();
    for record in exhibits.records.values() {
        let href = source(here, &record.file(), 1, found);
        let values: Vec<String> = record
            .values
            .iter()
            .map(|(name, value)| format!("{name} = {} {}", value.text, escape(&value.unit)))
            .collect();
        rows.push(vec![
            format!("<a href=\"{href}\"><code>{}</code></a>", record.name),
            values.join("<br>"),
            format!("<code>{}</code>", record.command),
            format!("{}<br>{}", record.date, escape(&record.machine)),
            format!("<code>{}</code>", record.input_digest),
        ]);
    }
    Table {
        id: "records",
        title: "Records",
        columns: &["Record", "Values", "Made by", "When and on what", "Inputs"],
        rows,
    }
}

fn unverified(here: &Page, known: &Known<'_>) -> Table {
    let works = known.bibliography.sorted();
    let rows = works.iter().filter(|(_, work)| !work.unverified.is_empty());
    let row = |(key, work): &(&str, &Work)| {
        let name = link(here, REFERENCES.as_ref(), &format!("ref:{key}"), &escape(&work.short));
        vec![name, escape(&work.unverified)]
    };
    Table {
        id: "unverified",
        title: "Works that could not be verified",
        columns: &["Work", "What could not be confirmed"],
        rows: rows.map(row).collect(),
    }
}

/// The bibliography, each work with the places that cite it.
pub fn bibliography(here: &Page, pages: &[Page], known: &Known<'_>, found: &Found<'_>) -> String {
    let mut html = String::from("<dl class=\"bibliography\">\n");
    for (key, work) in known.bibliography.sorted() {
        let place = if work.place.is_empty() {
            String::new()
        } else {
            format!(" {}.", escape(&work.place))
        };
        let address = work
            .link
            .as_ref()
            .map(|(text, href)| {
                format!(" <a href=\"{}\" rel=\"external\">{}</a>", escape(href), escape(text))
            })
            .unwrap_or_default();
        html.push_str(&format!(
            "<dt id=\"ref:{key}\">{} ({})</dt>\n<dd><cite>{}</cite>.{place}{address}<p>{}</p>{}</dd>\n",
            escape(&work.authors),
            escape(&work.year),
            escape(&work.title),
            escape(&work.annotation),
            cited_in(here, pages, key, found),
        ));
    }
    html + "</dl>\n"
}

fn cited_in(here: &Page, pages: &[Page], key: &str, found: &Found<'_>) -> String {
    let Some(citations) = found.citations.get(key) else { return String::new() };
    let links: Vec<String> = citations
        .iter()
        .map(|(path, anchor)| link(here, path, anchor, title(pages, path)))
        .collect();
    format!("<p class=\"cited-in\">Cited in: {}</p>", links.join(", "))
}
