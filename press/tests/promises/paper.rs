//! What the pages say on paper.

use crate::small::SmallBook;

#[test]
fn what_only_a_screen_can_do_is_marked_and_has_its_marks_resolved() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "A sum, as",
        "[Press the mark of @eq:sum.]{.screen} A sum, as",
    );
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = book.read("book/one.html");
    let said = "<span class=\"screen\">Press the mark of <a class=\"xref\" href=\"#eq:sum\">Equation\u{a0}(1.1)</a>.</span>";
    assert!(page.contains(said), "{page}");
}
