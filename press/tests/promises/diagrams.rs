//! Figures whose blocks lead to places of the book.

use crate::small::SmallBook;

const SHOWN: &str = "target/press/exhibits/one/exhibits.json";

/// A book whose figure has a block that leads to a label.
fn book(to: &str) -> SmallBook {
    let links = format!(
        r#""rows":[["1"],["{to}"]],"links":[{{"name":"A block","to":"{to}","before":"left out: ","corner":[4,5],"size":[60,70]}}],"#
    );
    SmallBook::sound().with(SHOWN, r#""rows":[["1"]],"#, &links)
}

#[test]
fn a_block_is_a_link_that_says_where_it_leads() {
    let book = book("sec:more");
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = book.read("book/one.html");
    for part in [
        "<a href=\"#sec:more\" aria-label=\"A block: left out: Section\u{a0}1.1, More\">",
        "<rect x=\"4\" y=\"5\" width=\"60\" height=\"70\">",
        "left out: <tspan>Section\u{a0}1.1</tspan>",
        "<td><a href=\"#sec:more\">Section\u{a0}1.1, More</a></td>",
        "role=\"group\" aria-label=\"A rising line.\"",
    ] {
        assert!(page.contains(part), "{part} is not in the page:\n{page}");
    }
}

#[test]
fn on_the_page_for_printers_a_block_leads_to_the_same_place_there() {
    let book = book("sec:more");
    assert!(book.run(&["build"]).status.success());
    let whole = book.read("book/print.html");
    let (_, after) = whole.split_once("<rect x=\"4\"").expect("the block");
    let (before, _) = whole.split_at(whole.len() - after.len());
    let (_, address) = before.rsplit_once("<a href=\"#").expect("its link");
    let (anchor, _) = address.split_once('"').expect("the end of the address");
    assert!(whole.contains(&format!("id=\"{anchor}\"")), "nothing has the anchor {anchor}");
}

#[test]
fn a_figure_without_blocks_is_a_picture() {
    let book = SmallBook::sound();
    assert!(book.run(&["build"]).status.success());
    assert!(book.read("book/one.html").contains("role=\"img\" aria-label=\"A rising line.\""));
}

#[test]
fn a_block_that_leads_nowhere_is_named() {
    let report = book("sec:mor").faults();
    assert!(report.contains("src/one.md:17: @sec:mor: nothing in the book has this"), "{report}");
    assert!(report.contains("did you mean @sec:more?"), "{report}");
}
