//! A sheet of formulas to look up and to print.

use crate::small::SmallBook;

const DIFFERENCE: &str = "$$ d = a - b $$ {#eq:difference}\n";
const SHOWN: &str = "What is less\n{{again eq:difference}}\n";

/// A book whose equation of the difference stands in depth, and that shows it on a page at the end.
fn shown(page: &str) -> SmallBook {
    let depth = format!(
        "## Less {{.depth establishes=\"It can be less.\"}}\n\n{DIFFERENCE}\n## More again\n"
    );
    let book = SmallBook::sound()
        .with("src/SUMMARY.md", "[References]", "[Sheet](sheet.md)\n[References]")
        .with("src/one.md", DIFFERENCE, &depth);
    book.write("src/sheet.md", page);
    book
}

#[test]
fn a_sheet_shows_formulas_from_anywhere_with_the_way_to_where_they_are_derived() {
    let book = shown(&format!("::: sheet\n\n# Sheet {{#sec:sheet}}\n\n{SHOWN}\n:::\n"));
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = book.read("book/sheet.html");
    for part in [
        "<div class=\"sheet\">",
        "<p>What is less</p>",
        "<a class=\"equation-number\" href=\"one.html#eq:difference\" aria-label=\"Equation 1.2\">(1.2)</a>",
    ] {
        assert!(page.contains(part), "{part} is not in the page:\n{page}");
    }
}

#[test]
fn a_page_that_is_no_sheet_stays_on_the_main_road() {
    let report = shown(&format!("# Sheet {{#sec:sheet}}\n\n{SHOWN}")).faults();
    assert!(report.contains("the main road needs something that is in depth"), "{report}");
}

#[test]
fn a_sheet_that_is_not_closed_is_named() {
    let report = shown(&format!("# Sheet {{#sec:sheet}}\n\n::: sheet\n\n{SHOWN}")).faults();
    assert!(report.contains("a division (:::) is never closed"), "{report}");
}

#[test]
fn the_time_of_a_way_says_when_it_counts_depth() {
    let ways = "# Sheet {#sec:sheet}\n\n{{way one}}, {{way all one}}, {{way all one#sec:more}}\n";
    let book = shown(ways);
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = book.read("book/sheet.html");
    assert_eq!(page.matches(" with depth)").count(), 1, "{page}");
}
