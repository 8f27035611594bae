//! Where readers report an error in an equation.

use crate::small::SmallBook;

#[test]
fn every_numbered_equation_leads_to_a_report_with_its_label_and_the_version() {
    let repository = "[output.html]\ngit-repository-url = \"https://example.org/book\"\n\n";
    let table = "[output.html.playground]";
    let book = SmallBook::sound().with("book.toml", table, &format!("{repository}{table}"));
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = book.read("book/one.html");
    let version = env!("CARGO_PKG_VERSION").replace('.', "%2E");
    for label in ["sum", "difference", "product", "unit"] {
        let address =
            format!("/book/issues/new?title=eq%3A{label}%3A%20&amp;body=Version%20{version}");
        assert!(page.contains(&address), "{address} is not in the page:\n{page}");
    }
}

#[test]
fn without_a_repository_no_equation_leads_to_a_report() {
    let book = SmallBook::sound();
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!book.read("book/one.html").contains("Report an error"));
}
