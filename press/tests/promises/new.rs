//! A new chapter: its files fit together, and what is taken is left alone.

use std::process::Command;

use crate::small::SmallBook;

/// As the program of the book is laid out, with as much behind it as an example needs.
const EXHIBITS: &str = "\
pub mod chapter;
pub mod comparison;
pub mod random;

use chapter::Chapter;

pub const CHAPTERS: &[(&str, fn(&mut Chapter), fn(&mut Chapter))] = &[
];

fn no_records(_chapter: &mut Chapter) {}
";

const PROGRAM: &str = "\
use exhibits::chapter::Chapter;

fn main() {
    for (_, exhibits, records) in exhibits::CHAPTERS {
        exhibits(&mut Chapter);
        records(&mut Chapter);
    }
}
";

const CHAPTER: &str = "\
use crate::comparison::Comparison;

pub struct Chapter;

impl Chapter {
    pub fn equation<F: Copy>(&mut self, label: &str, check: fn(F) -> Comparison, formula: F, mutants: &[(&str, F)]) {
        assert!(check(formula).0 < 1e-12, \"{label}\");
        assert!(mutants.iter().all(|(_, mutant)| check(*mutant).0 > 1e-3), \"{label}\");
    }
}
";

const COMPARISON: &str = "\
pub struct Comparison(pub f64);

impl Comparison {
    pub fn relative(_: &'static str, _: f64) -> Self {
        Self(0.0)
    }

    pub fn over(
        mut self,
        states: usize,
        seed: u64,
        mut both: impl FnMut(&mut crate::random::Random) -> (f64, f64),
    ) -> Self {
        let mut random = crate::random::Random::new(seed);
        for _ in 0..states {
            let (formula, oracle) = both(&mut random);
            self.0 = self.0.max((formula - oracle).abs());
        }
        self
    }
}
";

const RANDOM: &str = "\
pub struct Random(f64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed as f64)
    }

    pub fn uniform(&mut self, range: std::ops::Range<f64>) -> f64 {
        self.0 = (self.0 + 0.6180339887) % 1.0;
        range.start + (range.end - range.start) * self.0
    }
}
";

const PACKAGES: [(&str, &str); 3] = [
    ("Cargo.toml", "[workspace]\nresolver = \"3\"\nmembers = [\"code\", \"exhibits\"]\n"),
    ("code/Cargo.toml", "[package]\nname = \"vislam\"\nversion = \"0.1.0\"\nedition = \"2024\"\n"),
    (
        "exhibits/Cargo.toml",
        "[package]\nname = \"exhibits\"\nversion = \"0.1.0\"\nedition = \"2024\"\n[dependencies]\nvislam = { path = \"../code\" }\n",
    ),
];

fn book() -> SmallBook {
    let book = SmallBook::sound();
    for (path, text) in PACKAGES {
        book.write(path, text);
    }
    for (path, text) in [
        ("code/src/lib.rs", "//! A library.\n\npub mod one;\n"),
        ("exhibits/src/lib.rs", EXHIBITS),
        ("exhibits/src/bin/exhibits.rs", PROGRAM),
        ("exhibits/src/chapter.rs", CHAPTER),
        ("exhibits/src/comparison.rs", COMPARISON),
        ("exhibits/src/random.rs", RANDOM),
    ] {
        book.write(path, text);
    }
    book
}

#[test]
fn a_new_chapter_compiles_and_passes_its_own_check_and_test() {
    let book = book();
    let made = book.run(&["new", "loop_closure", "--title", "Loop closure"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    assert!(
        book.read("src/SUMMARY.md")
            .contains("- [One](one.md)\n- [Loop closure](loop_closure.md)\n")
    );
    assert!(book.read("code/src/lib.rs").contains("pub mod loop_closure;\npub mod one;\n"));
    let exhibits = book.read("exhibits/src/lib.rs");
    assert!(
        exhibits.contains("mod comparison;\npub mod loop_closure;\npub mod random;\n"),
        "{exhibits}"
    );
    assert!(
        exhibits.contains("    (\"loop_closure\", loop_closure::exhibits, no_records),\n];"),
        "{exhibits}"
    );
    for arguments in [["run", "--quiet", "--offline"], ["test", "--quiet", "--offline"]] {
        let output = Command::new(env!("CARGO"))
            .args(arguments)
            .current_dir(book.root())
            .env("CARGO_TARGET_DIR", book.path("target"))
            .output()
            .expect("cargo starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn the_book_takes_the_page_of_a_new_chapter() {
    let book = book();
    book.run(&["new", "loop_closure"]);
    let check = r#"{"slug":"loop_closure","equations":[{"label":"loop-closure-example","worst":0.0,"tolerance":1e-12,"unit":"relative","states":100,"against":"a product","failure":null,"mutants":["sign","a term dropped"],"survivors":[],"file":"exhibits/src/loop_closure.rs","line":14}],"counterexamples":[],"numbers":[],"figures":[],"records":[]}"#;
    book.write("target/press/exhibits/loop_closure/exhibits.json", check);
    let output = book.run(&["check"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_name_that_is_taken_or_no_module_is_refused_and_nothing_is_written() {
    let book = book();
    let before = book.read("exhibits/src/lib.rs");
    for (name, reason) in [
        ("one", "src/one.md is there already"),
        ("random", "exhibits/src/random.rs is there already"),
        ("loop-closure", "`loop-closure` cannot name a chapter"),
        ("2d", "`2d` cannot name a chapter"),
        ("match", "`match` cannot name a chapter"),
    ] {
        let output = book.run(&["new", name]);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && text.contains(reason), "{name}: {text}");
    }
    assert_eq!(book.read("exhibits/src/lib.rs"), before);
    assert!(!book.path("code/src/random.rs").exists());
}
