//! A chapter whose prose stands on two pages, and a chapter that is made two.

use crate::small::SmallBook;

const SUMMARY: &str = "- [One](one.md)\n";
const BOTH: &str = "- [One](one.md)\n- [Two](two.md)\n";
const DIFFERENCE: &str = "$$ d = a - b $$ {#eq:difference}\n";
const LETTERS: &str = "Here are [$d$]{.symbol means=\"a difference\"}, [$a$]{.symbol means=\"the first\"} and \
    [$b$]{.symbol means=\"the second\" unit=\"m\"}.\n";

/// A book whose equation of the difference has gone to a second page with this heading.
fn split(heading: &str) -> SmallBook {
    let book = SmallBook::sound()
        .with("src/SUMMARY.md", SUMMARY, BOTH)
        .with("src/one.md", " {#eq:unit .definition}", "")
        .with("src/one.md", DIFFERENCE, "See @eq:difference, and a product that is\n");
    book.write(
        "src/two.md",
        &format!("{heading}\n\nLike @eq:sum, {{{{value one.sum}}}}:\n\n{DIFFERENCE}\n{LETTERS}"),
    );
    book
}

/// The same with the check of the difference in a module of its own.
fn with_a_module() -> SmallBook {
    let book = split("# Two {#sec:two}");
    let all = book.read("target/press/exhibits/one/exhibits.json");
    let check = all.lines().find(|line| line.contains("\"difference\"")).expect("a check");
    book.write("target/press/exhibits/one/exhibits.json", &all.replace(&format!("{check}\n"), ""));
    let moved =
        check.trim_end_matches(',').replace("one.rs", "two.rs").replace("\"line\":2", "\"line\":1");
    book.write(
        "target/press/exhibits/two/exhibits.json",
        &format!("{{\"slug\":\"two\",\"equations\":[{moved}],\"counterexamples\":[],\"numbers\":[],\"figures\":[],\"records\":[]}}"),
    );
    book.write("exhibits/src/two.rs", "fn difference() {}\n");
    book
}

fn passes(book: &SmallBook) {
    let output = book.run(&["check"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn says(text: &str, part: &str) {
    assert!(text.contains(part), "{text}\nhas no {part:?}");
}

#[test]
fn a_page_that_is_part_of_a_chapter_shows_its_exhibits_and_keeps_what_was_accepted() {
    let book = split("# Two {#sec:two part-of=\"one\"}");
    passes(&book);
    let page = book.read("target/press/checked/two.html");
    says(&page, "Equation 2.1");
    says(&page, "checked: ");
    says(&book.read("target/press/checked/one.html"), "two.html#eq:difference");
    says(&book.read("target/press/checked/ledger.html"), "two.html#eq:difference");
    let before = book.read("exhibits/accepted/one.toml");
    assert!(book.run(&["accept"]).status.success());
    let accepted = book.read("exhibits/accepted/one.toml");
    assert_eq!(accepted.matches(" = ").count(), before.matches(" = ").count());
    assert!(!book.path("exhibits/accepted/two.toml").exists());
}

#[test]
fn a_page_that_is_part_of_no_chapter_is_named() {
    let report = split("# Two {#sec:two part-of=\"three\"}").faults();
    says(&report, "src/two.md:1");
    says(&report, "part-of=three");
}

#[test]
fn an_equation_that_moved_to_another_module_is_carried_over_and_nothing_else_is() {
    let book = with_a_module().with("src/one.md", "$$ e = a b $$", "$$ e = b a $$");
    let report = book.faults();
    says(&report, "this equation was held against its check in one, and has moved");
    says(&report, "cargo book accept --moved");
    let output = book.run(&["accept", "--moved"]);
    says(&String::from_utf8_lossy(&output.stdout), "eq:difference moved from one to two");
    says(&book.read("exhibits/accepted/two.toml"), "difference = \"d = a - b\"");
    let one = book.read("exhibits/accepted/one.toml");
    assert!(!one.contains("difference"), "{one}");
    says(&one, "product = \"e = a b\"");
    passes(&book.with("src/one.md", "$$ e = b a $$", "$$ e = a b $$"));
}

#[test]
fn an_equation_that_changed_when_it_moved_is_not_carried_over() {
    let book = with_a_module().with("src/two.md", "d = a - b", "d = b - a");
    let output = book.run(&["accept", "--moved"]);
    says(&String::from_utf8_lossy(&output.stdout), "Nothing moved.");
    says(&book.faults(), "this equation was never held against its check");
}
