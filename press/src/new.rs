//! `cargo book new`: the files of a chapter, and what registers them.

use anyhow::{Context, Result, bail};

use crate::files;
use crate::settings::Layout;

const LIBRARY: &str = "code/src/lib.rs";
const TABLE: &str = "exhibits/src/lib.rs";
const SUMMARY: &str = "src/SUMMARY.md";

/// Makes a chapter that the book takes as it is, and gives the files that were written.
///
/// # Errors
/// A name that a module cannot have or something has already, and a book that is laid out otherwise.
pub fn chapter(layout: &Layout, name: &str, title: Option<&str>) -> Result<Vec<String>> {
    let is_module = syn::parse_str::<syn::Ident>(name).is_ok()
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if !is_module {
        bail!(
            "`{name}` cannot name a chapter, because a Rust module bears the same name: take lowercase letters, digits \
             and underscores, as in `loop_closure`"
        );
    }
    let words = name.replace('_', " ");
    let title = title.map_or_else(|| words[..1].to_uppercase() + &words[1..], str::to_owned);
    let filled = |text: &str| {
        let label = name.replace('_', "-");
        text.replace("NAME", name).replace("LABEL", &label).replace("TITLE", &title)
    };
    let new = [
        (format!("src/{name}.md"), filled(PAGE)),
        (format!("code/src/{name}.rs"), filled(MODULE)),
        (format!("code/tests/{name}.rs"), filled(TESTS)),
        (format!("exhibits/src/{name}.rs"), filled(EXHIBITS)),
        (format!("exhibits/accepted/{name}.toml"), filled(ACCEPTED)),
    ];
    let taken = new.iter().map(|(file, _)| file.clone());
    let folders =
        ["code/src", "code/tests", "exhibits/src"].map(|folder| format!("{folder}/{name}"));
    if let Some(taken) = taken.chain(folders).find(|path| layout.root.join(path).exists()) {
        bail!("{taken} is there already: choose another name");
    }
    let registered = [
        (SUMMARY, with_entry(&read(layout, SUMMARY)?, &format!("- [{title}]({name}.md)"))?),
        (LIBRARY, with_module(&read(layout, LIBRARY)?, "pub mod ", name)?),
        (TABLE, with_row(&with_module(&read(layout, TABLE)?, "pub mod ", name)?, name)?),
    ];
    let registered = registered.map(|(file, text)| (file.to_owned(), text));
    let written = new.into_iter().chain(registered);
    written
        .map(|(file, text)| {
            files::write(&layout.root.join(&file), text.as_bytes())?;
            Ok(file)
        })
        .collect()
}

fn read(layout: &Layout, file: &str) -> Result<String> {
    files::read(&layout.root.join(file)).context("a chapter is registered there")
}

/// The table of contents with a chapter after the last one that has a number.
fn with_entry(text: &str, entry: &str) -> Result<String> {
    let numbered = |line: &str| line.trim_start().starts_with("- [");
    let last = text.lines().collect::<Vec<_>>().iter().rposition(|line| numbered(line));
    let last =
        last.with_context(|| format!("{SUMMARY} has no chapter: begin it with `{entry}`"))?;
    Ok(with_line(text, last + 1, entry))
}

/// A list of modules with one more, in its place.
fn with_module(text: &str, keyword: &str, name: &str) -> Result<String> {
    let line = format!("{keyword}{name};");
    let is_module = |line: &str| {
        line.ends_with(';') && (line.starts_with("mod ") || line.starts_with("pub mod "))
    };
    let bare = |line: &str| line.trim_start_matches("pub ").to_owned();
    let lines: Vec<&str> = text.lines().collect();
    let after = lines.iter().rposition(|other| is_module(other) && bare(other) < bare(&line));
    let first = lines.iter().position(|other| is_module(other));
    let at = after.map(|at| at + 1).or(first);
    let at = at.with_context(|| {
        format!("found no place among the modules: write `{line}` into the file")
    })?;
    Ok(with_line(text, at, &line))
}

/// The program of the exhibits with one more row of its table.
fn with_row(text: &str, name: &str) -> Result<String> {
    let row = format!("    (\"{name}\", {name}::exhibits, no_records),");
    let lines: Vec<&str> = text.lines().collect();
    let table = lines.iter().position(|line| line.starts_with("pub const CHAPTERS"));
    let end =
        table.and_then(|table| Some(table + lines[table..].iter().position(|line| *line == "];")?));
    let end =
        end.with_context(|| format!("{TABLE} has no table CHAPTERS: write it with `{row}`"))?;
    Ok(with_line(text, end, &row))
}

fn with_line(text: &str, at: usize, line: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(at, line);
    lines.join("\n") + "\n"
}

/// What is left to do, for somebody who has made a chapter.
pub fn next(name: &str) -> String {
    format!(
        "\nEverything is registered and `cargo book check` takes it. Now write: begin with the opening and the question in \
         src/{name}.md, replace the example equation with your own, and give each equation its check in \
         exhibits/src/{name}.rs. In {SUMMARY}, move the line to where the chapter belongs. `cargo book serve` tells the rest.\n"
    )
}

const PAGE: &str = r#"# TITLE {#sec:NAME subtitle="What it looks like"}

::: {.opening difficulty="1" needs="what the reader must know; and which chapters"}
After this chapter you can say what the reader can do afterwards.
:::

Begin with what can be seen or held. Say why before how.

::: {.predict #predict:LABEL}
A question whose answer the reader commits to before reading on?

- [ ] A tempting answer.
- [x] The right one.

::: reveal
Why.
:::
:::

## The derivation {subtitle="Where it comes from"}

Derive with a reason for every step, and say what every letter means: twice
[$x$]{.symbol means="a number, as an example"} is [$y$]{.symbol means="twice the number"}. The check of this equation is
in the exhibits:

$$
y = x + x
$$ {#eq:LABEL-example}

```{.rust #lst:LABEL-example caption="What it does."}
{{#include ../code/src/NAME.rs:example}}
```

## Limits {subtitle="Where it breaks"}

Show where it fails.

## Summary

{{again eq:LABEL-example}}
"#;

const MODULE: &str = r#"//! TITLE: see {sec:NAME}.

// ANCHOR: example
/// Twice a number. Implements {eq:LABEL-example}.
pub fn example(x: f64) -> f64 {
    x + x
}
// ANCHOR_END: example
"#;

const TESTS: &str = r#"//! Worked examples of chapter `NAME`.

use vislam::NAME::example;

#[test]
fn the_example_doubles() {
    assert_eq!(example(1.5), 3.0);
}
"#;

const EXHIBITS: &str = r#"//! What chapter `NAME` shows.

use vislam::NAME as theory;

use crate::chapter::Chapter;
use crate::comparison::Comparison;

type Example = fn(f64) -> f64;

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Example); 2] = [("sign", |x| -theory::example(x)), ("a term dropped", |x| x)];
    chapter.equation("LABEL-example", NAME_example, theory::example, &mutants);
}

/// Compares with a product, which does not share the sum.
fn NAME_example(formula: Example) -> Comparison {
    Comparison::relative("a product", 1e-12).over(100, 1, |random| {
        let x = random.uniform(-10.0..10.0);
        (formula(x), 2.0 * x)
    })
}
"#;

const ACCEPTED: &str = "\
# The equations as they were last held against their checks; written by `cargo book accept`.

[equations]
LABEL-example = 'y = x + x'
";
