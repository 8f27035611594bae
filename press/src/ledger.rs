//! The pages that the build writes from what it knows: the ledger and the bibliography.

use std::path::Path;

use maud::{Markup, html};

use crate::accepted::digest;
use crate::attributes::Attributes;
use crate::bibliography::Work;
use crate::blocks::Kind;
use crate::exhibits::Exhibits;
use crate::pages::Page;
use crate::prose::{Found, Known, REFERENCES, Told, item_link, link, listed, source, table};
use crate::recordings;

/// A table of the ledger.
struct Table {
    id: &'static str,
    title: &'static str,
    columns: &'static [&'static str],
    rows: Vec<Markup>,
}

impl Table {
    fn html(&self) -> String {
        let table = table(None, self.columns, &self.rows).into_string();
        format!("## {} {{#ledger-{}}}\n\n{table}\n\n", self.title, self.id)
    }
}

/// The ledger: every equation, number, figure, record and algorithm with what stands behind it.
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
        algorithms(here, known, found),
    ];
    let lines = found.algorithms.iter().map(|told| told.lines).sum();
    let states: usize = known
        .exhibits
        .chapters
        .values()
        .flat_map(|shown| &shown.equations)
        .map(|check| check.states)
        .sum();
    let head = format!(
        "<p class=\"ledger-summary\">{} checked over {}, {}, {} with {}, each dropped in a counterexample, {}, {}, {}, {} with {} that lead to the code, {} of which {} could not be verified.</p>\n\n",
        counted(tables[0].rows.len(), "equation"),
        counted(states, "state"),
        counted(tables[1].rows.len(), "definition"),
        counted(known.theorems.count(), "theorem"),
        counted(tables[2].rows.len(), "condition"),
        counted(tables[3].rows.len(), "computed number"),
        counted(tables[4].rows.len(), "figure"),
        counted(tables[5].rows.len(), "record"),
        counted(tables[7].rows.len(), "algorithm"),
        counted(lines, "line"),
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
        let name = link(here, &page.path, id, format!("({number})"));
        if attributes.has("definition") {
            definitions.push(html! { td { (name) } td { code { (id) } } });
            continue;
        }
        let Some(check) = exhibits.check(&page.owner, label) else { continue };
        let Kind::Equation { tex, .. } = kind else { continue };
        let (file, line) = check.place();
        let href = source(here, &file, line, found);
        checked.push(html! {
            td { (name) }
            td { (code_link(&href, id)) }
            td { (check.against) }
            td { @if let Some(worst) = check.worst { (format!("{worst:.1e}")) } @else { "—" } }
            td { (format!("{:.0e}", check.tolerance)) }
            td { (check.states) }
            td { (check.mutants.join(", ")) }
            td { code { (digest(tex)) } }
        });
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
        rows.push(html! {
            td { (link(here, &target.path, &id, format!("Theorem {}", target.number))) }
            td { (code_link(&href, &case.condition)) }
            td { (case.against) }
            td { (format!("{:.1e}", case.kept)) }
            td { (format!("{:.1e}", case.dropped)) }
            td { (format!("{:.0e}", case.tolerance)) }
        });
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
            let users = found.values.get(&name).into_iter().flatten().map(|path| {
                html! { a href=(here.way_to(path)) { (path.with_extension("").display()) } }
            });
            rows.push(html! {
                td { (code_link(&href, &name)) }
                td { (number.text.replace('-', "−")) " " (number.unit) }
                td { @if let Some(value) = number.value { (in_full(value)) } @else { "—" } }
                td { (listed(users)) }
            });
        }
    }
    Table {
        id: "numbers",
        title: "Numbers",
        columns: &["Number", "As printed", "In full", "Used in"],
        rows,
    }
}

/// All digits of a number; of one that is nearly zero, without its zeros.
fn in_full(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-6 { format!("{value:e}") } else { value.to_string() }
}

fn figures(here: &Page, pages: &[Page], exhibits: &Exhibits, found: &mut Found<'_>) -> Table {
    let mut rows = Vec::new();
    for (page, number, attributes, kind) in labelled(pages, "fig:") {
        let Kind::Figure { path, .. } = kind else { continue };
        let place = link(here, &page.path, &attributes.id, format!("Figure {number}"));
        if let Some(scene) = recordings::scene(path).filter(|name| found.recordings.contains(*name))
        {
            let href = source(here, &recordings::program(scene), 1, found);
            rows.push(html! {
                td { (place) }
                td { (code_link(&href, &attributes.id)) }
                td colspan="2" { "a scene in three dimensions" }
            });
            continue;
        }
        let name = path.trim_end_matches(".svg");
        let Some((drawing, _)) =
            name.split_once('/').and_then(|(slug, name)| exhibits.drawing(slug, name))
        else {
            continue;
        };
        let href = source(here, &drawing.file, drawing.line, found);
        let data = here.way_to(format!("generated/{name}.csv").as_ref());
        rows.push(html! {
            td { (place) }
            td { (code_link(&href, &attributes.id)) }
            td { (drawing.rows.len()) }
            td { a href=(data) download { "CSV" } }
        });
    }
    Table {
        id: "figures",
        title: "Figures",
        columns: &["Figure", "Program", "Rows of data", "Data"],
        rows,
    }
}

/// A record of more values is not listed.
const MOST_VALUES: usize = 60;

/// A name that may go on in the next line behind each of its underscores.
fn breakable(name: &str) -> Markup {
    html! {
        @for (at, part) in name.split('_').enumerate() {
            @if at > 0 { "_" wbr; }
            (part)
        }
    }
}

fn records(here: &Page, exhibits: &Exhibits, found: &mut Found<'_>) -> Table {
    let mut rows = Vec::new();
    for record in exhibits.records.values() {
        let href = source(here, &record.file(), 1, found);
        rows.push(html! {
            td { (code_link(&href, &record.name)) }
            td {
                @if record.values.len() > MOST_VALUES {
                    (record.values.len()) " values, in its file"
                } @else {
                    @for (at, (name, value)) in record.values.iter().enumerate() {
                        @if at > 0 { br; }
                        (breakable(name)) " = " (value.text) " " (value.unit)
                    }
                }
            }
            td { code { (record.command) } }
            td { (record.date) br; (record.machine) }
            td { code { (record.input_digest) } }
        });
    }
    Table {
        id: "records",
        title: "Records",
        columns: &["Record", "Values", "Made by", "When and on what", "Inputs"],
        rows,
    }
}

fn algorithms(here: &Page, known: &Known<'_>, found: &Found<'_>) -> Table {
    let row = |told: &Told| {
        let name = format!("Algorithm {}", told.number);
        let item = known.library.item(&told.item);
        html! {
            td { (link(here, &told.page, &told.id, name)) }
            td { @if let Some(item) = item { (item_link(here, known.library, item, html! { code { (item.path) } })) } }
            td { (told.lines) }
        }
    };
    let columns = &["Algorithm", "Item", "Lines that lead to the code"];
    let rows = found.algorithms.iter().map(row).collect();
    Table { id: "algorithms", title: "Algorithms", columns, rows }
}

fn unverified(here: &Page, known: &Known<'_>) -> Table {
    let works = known.bibliography.sorted();
    let rows = works.iter().filter(|(_, work)| !work.unverified.is_empty());
    let row = |(key, work): &(&str, &Work)| {
        let name = link(here, REFERENCES.as_ref(), &format!("ref:{key}"), &work.short);
        html! { td { (name) } td { (work.unverified) } }
    };
    Table {
        id: "unverified",
        title: "Works that could not be verified",
        columns: &["Work", "What could not be confirmed"],
        rows: rows.map(row).collect(),
    }
}

/// A name of the program as a link to where it stands there.
fn code_link(href: &str, name: &str) -> Markup {
    html! { a href=(href) { code { (breakable(name)) } } }
}

/// The bibliography, each work with the places that cite it.
pub fn bibliography(here: &Page, pages: &[Page], known: &Known<'_>, found: &Found<'_>) -> String {
    let list = html! {
        dl.bibliography {
            @for (key, work) in known.bibliography.sorted() {
                dt id={ "ref:" (key) } { (work.authors) " (" (work.year) ")" } "\n"
                dd {
                    cite { (work.title) } "."
                    @if !work.place.is_empty() { " " (work.place) "." }
                    @if let Some((text, href)) = &work.link { " " a href=(href) rel="external" { (text) } }
                    p { (work.annotation) }
                    @if let Some(citations) = found.citations.get(key) {
                        p.cited-in {
                            "Cited in: "
                            (listed(citations.iter().map(|(path, anchor)| {
                                link(here, path, anchor, title(pages, path))
                            })))
                        }
                    }
                } "\n"
            }
        }
    };
    list.into_string() + "\n"
}

#[cfg(test)]
mod tests {
    use super::breakable;

    #[test]
    fn a_long_name_may_break_behind_its_underscores() {
        assert_eq!(breakable("a_mean_2").into_string(), "a_<wbr>mean_<wbr>2");
        assert_eq!(breakable("mean").into_string(), "mean");
    }
}
