//! What an author may type by mistake ends in a list of faults, and in nothing worse.

use std::collections::BTreeMap;

use fuzz::Trial;
use fuzz::bounds::Bounds;
use mdbook_preprocessor::book::{Book, BookItem, Chapter, SectionNumber};
use press::api::items::Library;
use press::attributes::Attributes;
use press::bibliography::Bibliography;
use press::emit::Emitter;
use press::exhibits::Exhibits;
use press::fault::Faults;
use press::guard::guarded;
use press::index;
use press::inline::tokens;
use press::ledger;
use press::lint::Lint;
use press::listing::cut;
use press::main_road;
use press::pages::{Labels, Page};
use press::prose::{Found, Known};
use press::reports::Reports;
use press::settings::{Layout, Settings};
use press::theorems::Theorems;
use press::ways::Ways;

/// One of each thing that a chapter may hold.
const CHAPTER: &str = r##"# One {#sec:one subtitle="The picture"}

::: {.opening difficulty="2" needs="@sec:one, eigenvalues"}
What the reader can do afterwards, in {{time one}}; {{way one#more}}.
:::

A sum, as in @eq:sum of @sec:one, see [@author2001, page 3]. A minute has 60 s and costs \$5, `code`.

$$
c = \frac{a}{b}
$$ {#eq:sum}

$$ s = 1 $$ {#eq:unit .definition}

The sum is {{value one.sum}}, see [-@fig:sums] and [`add`](api:one::add), me@example.org.

![Sums [of $a$]](one/sums.svg){#fig:sums alt="A rising line." widget="one"}

```{.rust #lst:add caption="A sum."}
{{#include ../code/src/one.rs:add}}
```

<!-- a comment
of two lines -->

::: {.predict #predict:name}
The question.

- [ ] A tempting answer
  of two lines.
- [x] The right one.

::: reveal
Why.
:::
:::

## More {#sec:more .depth establishes="A sentence."}

1. first
   - inner [link](#sec:more), [further]{.further}

     $$ d = a - b $$ {#eq:difference}

[disparity]{.defined term="disparities"} and [“A saying.”]{.saying #said}; {{again eq:sum}}

## Letters

[$a$]{.symbol means="the first" shape="3" frame="camera"}, [$b$]{.symbol means="the second" unit="m"} and
[$\vv{c}$]{.symbol means="a sum"} [x]{.measured}.

| a | b |
| --- | --- |
| 1 | $x$ |

::: {.theorem #thm:grows title="a sum grows"}
If [both are positive]{.condition name="positive"}, the sum is larger than either.
:::

::: proof
By counting.
:::

::: {.counterexample of="thm:grows" without="positive"}
One less one is zero.
:::

::: {.algorithm #alg:name title="its_name: what it finds" item="one::add"}
Given
: what goes in.

Result
: what comes out.

1. **for each** pixel {.step code="a + b"}
    2. $e$ is its residual [-@eq:sum]
       {.step code="let" of="add"}
3. return the sum {.step code="Ok(sum)"}
:::

::: {.hint title="a question" text="../code/src/one.rs:1"}
:::

{{ledger}} {{index}} {{bibliography}} {{mine}}
"##;

const WORDS: &[&str] = &[
    "$$",
    "$",
    "```",
    "~~~",
    ":::",
    "::: {.note}",
    "![",
    "](",
    "]{.defined}",
    "{{value ",
    "{{",
    "}}",
    "[@",
    "[-@eq:",
    "@sec:",
    "{#eq:x}",
    "{.step code=\"",
    "<!--",
    "-->",
    "- [ ] ",
    "- [x] ",
    "1. ",
    "99999999999999999999. ",
    "# ",
    "####### ",
    "    ",
    "\n\n",
    "\\",
    "`",
    "\"",
    "\u{2028}",
];

const CODE: &str = "// ANCHOR: add\n/// Implements {eq:sum}.\npub fn add(a: f64, b: f64) -> f64 {\n    \
    a + b\n}\n// ANCHOR_END: add\n";

const WORKS: &str = "@string{ral = {Letters}}\n@article{author2001,\n author = {Lupton, Todd and Sukkarieh, \
    Salah}, title = {{On} motion}, journal = ral # { B}, volume = 28, number = {1}, pages = {61--76}, year = \
    {2012}, month = jan, doi = {10.1/x}, annotation = {First.}, verified = {its page}\n}\n@book{two, author = {von \
    Mises, R.}, title = \"A \\\"{u} $x$\", date = {2015-02-30/..}, annotation = {B}}\n";

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Chapters are shorter than data.
const BOUNDS: Bounds =
    Bounds { largest: 32_000, memory: 2_000, room: 10_000_000, time: 3e-5, start: 2.0 };

/// The faults of a book of one chapter.
fn faults(content: String, layout: &Layout) -> Faults {
    let mut chapter = Chapter::new("One", content, "one.md", Vec::new());
    chapter.number = Some(SectionNumber::new([1]));
    let pages = Page::all(&Book::new_with_items(vec![BookItem::Chapter(chapter)]));
    let mut faults = Faults::default();
    Page::parts(&pages, &mut faults);
    let (labels, theorems) =
        (Labels::collect(&pages, &mut faults), Theorems::collect(&pages, &mut faults));
    let (ways, bibliography) = (Ways::collect(&pages), Bibliography::parse(WORKS, &mut faults));
    let (exhibits, library) = (Exhibits::default(), Library::default());
    theorems.check(&pages, &exhibits, &mut faults);
    main_road::check(&pages, 100, &mut faults);
    let known = Known {
        labels: &labels,
        theorems: &theorems,
        ways: &ways,
        exhibits: &exhibits,
        bibliography: &bibliography,
        library: &library,
        accepted: &BTreeMap::new(),
        widgets: &BTreeMap::new(),
        recordings: &BTreeMap::new(),
        reports: &Reports::default(),
    };
    let mut found = Found::new(faults, Lint::new(&[]));
    for page in &pages {
        let emitted = Emitter::new(page, &known, &Settings::default(), layout, &mut found).emit();
        guarded(&emitted);
        ledger::ledger(page, &pages, &known, &mut found);
        index::index(page, &pages, &known, &found);
        ledger::bibliography(page, &pages, &known, &found);
    }
    found.terms.check(&pages, &labels, &mut found.faults);
    found.symbols.check(&pages, &mut found.faults);
    found.faults
}

/// What the first faults say.
fn said(faults: &Faults) -> String {
    faults.sorted().into_iter().take(3).map(|fault| fault.problem).collect::<Vec<_>>().join("; ")
}

#[test]
fn chapter() {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = Layout { root: folder.path().to_owned() };
    std::fs::create_dir_all(folder.path().join("code/src")).expect("a folder");
    std::fs::write(folder.path().join("code/src/one.rs"), CODE).expect("written");
    Trial::of("chapter", [CHAPTER])
        .words(WORDS)
        .bounds(BOUNDS)
        .run(|bytes| said(&faults(text(bytes), &layout)));
}

#[test]
fn paragraph() {
    let seeds = [
        "By @eq:pose-block, see [@forster2017; @triggs2000] and {{value bearing.fx}}, [x]{.estimated}.",
        "the skew $[t]_\\times$ with ``@eq:a ` b`` and \\$5 of [`exp`](api:so3::exp) [x](a.md)",
        r#"{#fig:rays .wide alt="Two rays} meet" size=3} tail"#,
        CODE,
    ];
    Trial::of("paragraph", seeds).words(WORDS).bounds(BOUNDS).run(|bytes| {
        let text = text(bytes);
        let kinds = tokens(&text).into_iter().map(|token| std::mem::discriminant(&token.mark));
        let kinds: Vec<_> = kinds.take(5).collect();
        format!(
            "{:?} {} {:?}",
            Attributes::parse(&text).is_some(),
            cut(&text, "add").is_some(),
            kinds
        )
    });
}

#[test]
fn what_never_ends_in_a_long_paragraph() {
    let reader = |bytes: &[u8]| tokens(&text(bytes)).len().to_string();
    for word in ["$a$ ", "{{a ", "[a]{.", "[a]{b="] {
        let input = word.repeat(500_000 / word.len());
        let held = Bounds::default().hold(input.as_bytes(), &reader);
        assert!(held.is_ok(), "{word}: {held:?}");
    }
}

#[test]
fn bibliography() {
    Trial::of("bibliography", [WORKS])
        .words(&[
            "@book{",
            "@string{",
            "crossref = {",
            " # ",
            "{",
            "}",
            "\"",
            ",",
            " and ",
            "\\",
            "=",
        ])
        .bounds(BOUNDS)
        .run(|bytes| {
            let mut faults = Faults::default();
            Bibliography::parse(&text(bytes), &mut faults);
            said(&faults)
        });
}
