//! A book of one chapter that keeps all its promises, to be broken one at a time.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const BOOK: &str = r##"
[book]
title = "Small"
language = "en"

[output.html.playground]
runnable = false

[preprocessor.press]
exhibits-package = ""
library-package = ""
before = ["links"]

[[preprocessor.press.allow]]
chapter = "one"
text = "60 s"
reason = "a minute is a definition"

[preprocessor.katex]
after = ["press", "links"]
no-css = true
output = "htmlAndMathml"
trust = true

[preprocessor.guard]
after = ["katex"]
"##;

const SUMMARY: &str =
    "# Summary\n\n- [One](one.md)\n\n---\n\n[References](references.md)\n[Ledger](ledger.md)\n";

const ONE: &str = r##"# One {#sec:one}

A sum, as in @eq:sum of @sec:one, see [@author2001]. A minute has 60 s.

$$
c = a + b
$$ {#eq:sum}

$$ d = a - b $$ {#eq:difference}

$$ e = a b $$ {#eq:product}

$$ s = 1 $$ {#eq:unit .definition}

The sum of the example is {{value one.sum}}, see @fig:sums and @lst:add.

![Sums.](one/sums.svg){#fig:sums alt="A rising line."}

```{.rust #lst:add caption="A sum."}
{{#include ../code/src/one.rs:add}}
```

## More {#sec:more}

An [inner link](#sec:more) and [another](ledger.md).

## Letters

Two numbers [$a$]{.symbol means="the first"} and [$b$]{.symbol means="the second" unit="m"} have the sum
[$c$]{.symbol means="a sum"}, the difference [$d$]{.symbol means="a difference"} and the product
[$e$]{.symbol means="a product"}; [$s$]{.symbol means="one"} is one.

::: {.theorem #thm:grows title="a sum grows"}
If [both are positive]{.condition name="positive"}, the sum is larger than either.
:::

::: {.counterexample of="thm:grows" without="positive"}
One less one is zero.
:::
"##;

const CODE: &str = "// ANCHOR: add\n/// Implements {eq:sum}.\npub fn add(a: f64, b: f64) -> f64 {\n    a + b\n}\n// ANCHOR_END: add\n";

const CHECKS: &str = "fn sum() {}\nfn difference() {}\nfn product() {}\n";

const WORKS: &str = "@article{author2001,\n  author = {Author, Ann},\n  title = {Sums},\n  year = {2001},\n  verified = {its page},\n  annotation = {Adds.}\n}\n";

const ACCEPTED: &str =
    "[equations]\nsum = 'c = a + b'\ndifference = 'd = a - b'\nproduct = 'e = a b'\n";

const EXHIBITS: &str = r##"{"slug":"one",
"equations":[
{"label":"sum","worst":1e-16,"tolerance":1e-12,"unit":"relative","states":9,"against":"counting","failure":null,"mutants":["sign"],"survivors":[],"file":"exhibits/src/one.rs","line":1},
{"label":"difference","worst":1e-16,"tolerance":1e-12,"unit":"relative","states":9,"against":"counting","failure":null,"mutants":["sign"],"survivors":[],"file":"exhibits/src/one.rs","line":2},
{"label":"product","worst":1e-16,"tolerance":1e-12,"unit":"relative","states":9,"against":"counting","failure":null,"mutants":["sign"],"survivors":[],"file":"exhibits/src/one.rs","line":3}],
"counterexamples":[{"theorem":"grows","condition":"positive","kept":0.0,"dropped":1.0,"tolerance":1e-12,"unit":"relative","against":"counting","failure":null,"file":"exhibits/src/one.rs","line":1}],
"numbers":[{"name":"sum","value":3.0,"text":"3","unit":"","file":"exhibits/src/one.rs","line":1}],
"figures":[{"name":"sums","columns":["a"],"rows":[["1"]],"file":"exhibits/src/one.rs","line":1}],
"records":[]}"##;

/// The folder of a small book.
pub struct SmallBook(tempfile::TempDir);

impl SmallBook {
    /// A sound book.
    pub fn sound() -> SmallBook {
        let book = SmallBook(tempfile::tempdir().expect("a temporary folder"));
        for (path, text) in [
            ("book.toml", BOOK),
            ("src/SUMMARY.md", SUMMARY),
            ("src/one.md", ONE),
            ("src/references.md", "# References\n\n{{bibliography}}\n"),
            ("src/references.bib", WORKS),
            ("src/ledger.md", "# Ledger\n\n{{ledger}}\n"),
            ("code/src/one.rs", CODE),
            ("exhibits/src/one.rs", CHECKS),
            ("exhibits/accepted/one.toml", ACCEPTED),
            ("target/press/exhibits/one/exhibits.json", EXHIBITS),
            ("target/press/exhibits/one/sums.svg", "<svg viewBox=\"0 0 1 1\"></svg>"),
            ("target/press/exhibits/one/sums.csv", "a\n1\n"),
        ] {
            book.write(path, text);
        }
        book
    }

    /// The folder of the book.
    pub fn root(&self) -> &Path {
        self.0.path()
    }

    /// A file of the book.
    pub fn path(&self, path: &str) -> PathBuf {
        self.root().join(path)
    }

    /// Writes a file.
    pub fn write(&self, path: &str, text: &str) {
        let path = self.path(path);
        fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        fs::write(path, text).expect("a written file");
    }

    /// Reads a file.
    pub fn read(&self, path: &str) -> String {
        fs::read_to_string(self.path(path)).expect("a file")
    }

    /// The same book with a text in a file replaced by another.
    pub fn with(self, path: &str, old: &str, new: &str) -> SmallBook {
        let text = self.read(path);
        assert!(text.contains(old), "{path} has no {old:?}");
        self.write(path, &text.replacen(old, new, 1));
        self
    }

    /// Runs `cargo book …` on the book.
    pub fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_press"))
            .args(arguments)
            .arg("--root")
            .arg(self.root())
            .output()
            .expect("the press starts")
    }

    /// What `cargo book check` says; the book must fail.
    pub fn faults(&self) -> String {
        let output = self.run(&["check"]);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success(), "the book passes:\n{text}");
        text
    }
}

/// Asserts that the report holds each of the texts and speaks of one broken promise.
#[track_caller]
pub fn says(report: &str, texts: &[&str]) {
    for text in texts {
        assert!(report.contains(text), "{text:?} is not in the report:\n{report}");
    }
    assert!(report.contains("breaks one promise"), "more than the planted fault:\n{report}");
}
