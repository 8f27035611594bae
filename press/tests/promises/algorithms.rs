//! Algorithms: each line leads to the code that does it, and the book fails when that is no longer true.

use crate::library::book;
use crate::small::{SmallBook, says};

const ALGORITHM: &str = r#"
::: {.algorithm #alg:add title="add: a sum" item="one::Sum::add"}
Given
: two numbers $a$ and $b$.

Result
: their sum, as in @eq:sum,
  which is one more.

Cost
: an addition.

Refused
: nothing.

Derived
: @sec:one.

1. for each number {.step code="pub fn add"}
    2. add $b$
       to it {.step code="a + b" of="Sum::add"}
3. give the sum {.step code="first(b)" of="hidden::twice"}
:::

The sum is @alg:add.
"#;

const TWICE: &str = "
fn twice(a: f64, b: f64) -> f64 {
    // first(b) is not called here
    let sum = first(a);
    sum + first(b)
}

fn first(a: f64) -> f64 {
    let first = a;
    first
}
";

/// A book with a library and an algorithm that keeps its promise.
fn sound() -> SmallBook {
    let hidden = book().read("code/src/one/hidden.rs");
    let book = book().with(
        "src/one.md",
        "## More {#sec:more}",
        &format!("{ALGORITHM}\n## More {{#sec:more}}"),
    );
    book.write("code/src/one/hidden.rs", &format!("{hidden}{TWICE}"));
    book
}

/// The faults of the sound book in which a text of the algorithm is another.
fn faults(old: &str, new: &str) -> String {
    sound().with("src/one.md", old, new).faults()
}

#[test]
fn the_number_of_a_line_leads_to_the_line_of_code() {
    let book = sound();
    let output = book.run(&["check"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = book.read("target/press/checked/one.html");
    for part in [
        "Algorithm 1.1.",
        "href=\"generated/source/code/src/one.rs.html#L19\"",
        "href=\"generated/source/code/src/one.rs.html#L20\"",
        "href=\"generated/source/code/src/one/hidden.rs.html#L14\"",
        "aria-label=\"Line 2: code/src/one.rs, line 20\"",
        "<li value=\"2\">",
        "href=\"#alg:add\">Algorithm\u{a0}1.1</a>",
        "api/small_sums/one/struct.Sum.html#method.add",
    ] {
        assert!(page.contains(part), "{part} is not in\n{page}");
    }
    assert!(
        book.path("target/press/checked/generated/source/code/src/one/hidden.rs.html").is_file()
    );
}

#[test]
fn a_text_that_is_gone_is_named_with_the_place_where_it_should_be() {
    says(
        &faults("code=\"a + b\"", "code=\"a - b\""),
        &[
            "`a - b` stands nowhere in one::Sum::add (code/src/one.rs, lines 19 to 21)",
            "as the line is now",
        ],
    );
}

#[test]
fn a_text_of_another_function_is_named_with_that_function() {
    says(
        &faults("code=\"a + b\"", "code=\"first(a);\""),
        &["`first(a);` stands nowhere in one::Sum::add (", "one::hidden::twice: say so by of="],
    );
}

#[test]
fn a_comment_is_not_what_a_line_does() {
    says(
        &faults("code=\"first(b)\"", "code=\"is not called\""),
        &["`is not called` stands nowhere in one::hidden::twice (", "as the line is now"],
    );
}

#[test]
fn a_text_that_stands_more_than_once_is_named_with_its_lines() {
    says(
        &faults("code=\"first(b)\"", "code=\"first(\""),
        &["`first(` stands more than once in one::hidden::twice (", ": 13, 14", "more of the line"],
    );
}

#[test]
fn lines_in_another_order_than_that_of_the_code_are_named() {
    let report = sound()
        .with("src/one.md", "code=\"pub fn add\"", "code=\"a + b\"")
        .with("src/one.md", "code=\"a + b\" of=\"Sum::add\"", "code=\"pub fn add\"")
        .faults();
    says(
        &report,
        &[
            "2.: the library does this before what stands above: code/src/one.rs, line 19 and not after 20",
        ],
    );
}

#[test]
fn code_that_the_library_does_not_have_is_named() {
    says(
        &faults("of=\"hidden::twice\"", "of=\"hidden::thrice\""),
        &["3.: the library has nothing that is called hidden::thrice", "of=\"Type::function\""],
    );
}

#[test]
fn a_name_that_means_two_things_is_named_with_both() {
    let book = sound().with("code/src/one/hidden.rs", "fn first(", "mod other;\nfn first(");
    book.write("code/src/one/hidden/other.rs", "fn twice() {}\n");
    let report = book.with("src/one.md", "of=\"hidden::twice\"", "of=\"twice\"").faults();
    says(
        &report,
        &["the library has 2 of the name twice", "one::hidden::other::twice, one::hidden::twice"],
    );
}

#[test]
fn an_item_that_is_not_public_is_named() {
    let report = faults("item=\"one::Sum::add\"", "item=\"one::Sum::ad\"");
    assert!(report.contains("api:one::Sum::ad: the library has no such public item"), "{report}");
    assert!(report.contains("did you mean api:one::Sum::add?"), "{report}");
}

#[test]
fn a_part_that_is_missing_or_out_of_order_is_named() {
    says(&faults("Derived\n: @sec:one.\n", ""), &["does not say what is “Derived”", "`: …`"]);
    let report = faults("Cost\n: an addition.\n", "");
    assert!(report.contains("alg:add: the algorithm does not say what is “Cost”"), "{report}");
    assert!(report.contains("Given, Result, Cost, Refused, Derived"), "{report}");
}

#[test]
fn a_comment_may_stand_inside_of_a_part() {
    let book = sound().with("src/one.md", "Given\n:", "Given\n<!-- what\nelse -->\n:").with(
        "src/one.md",
        "@eq:sum,\n",
        "@eq:sum,\n<!-- why -->\n",
    );
    let output = book.run(&["check"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let before = sound().with("src/one.md", ": @sec:one", ": @sec:on").faults();
    let line = before.split(':').nth(1).and_then(|line| line.parse::<usize>().ok()).unwrap();
    let fault = format!("src/one.md:{}: @sec:on", line + 3);
    says(&book.with("src/one.md", ": @sec:one", ": @sec:on").faults(), &[&fault]);
}

#[test]
fn lines_are_counted_through() {
    says(
        &faults("3. give the sum", "2. give the sum"),
        &["2.: this is line 3 of its algorithm", "count the lines through"],
    );
}

#[test]
fn a_line_without_code_is_named() {
    says(
        &faults(
            "3. give the sum {.step code=\"first(b)\" of=\"hidden::twice\"}",
            "3. give the sum",
        ),
        &["3. give the sum: this is no part of an algorithm", "{.step code="],
    );
}

#[test]
fn a_line_outside_of_an_algorithm_is_named() {
    says(
        &faults("The sum is @alg:add.", "1. The sum is @alg:add. {.step code=\"a + b\"}"),
        &["1.: a line that names its code stands outside of an algorithm", ".algorithm #alg:name"],
    );
}

#[test]
fn whatever_else_stands_in_an_algorithm_is_named() {
    says(
        &faults("1. for each", "$$ x $$\n\n1. for each"),
        &["an algorithm has parts and numbered lines, and nothing else", "before or behind"],
    );
}
