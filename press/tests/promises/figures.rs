//! The figures for slides.

use std::fs;
use std::path::Path;

use press::figures::gather;
use press::make::Maker;
use press::settings::Layout;
use press::steps::Steps;
use press::warnings::Warnings;

use crate::small::SmallBook;

const DRAWN: &str = "<svg viewBox=\"0 0 9 9\" xmlns=\"http://www.w3.org/2000/svg\"><text x=\"1\" y=\"2\" fill=\"currentColor\">a < b\u{a0}m</text></svg>";
const COLOURS: &str = ":root { --fg: light-dark(#1f1d1a, #dedbd3); }";

/// A book that was built, whose figure has letters.
fn built() -> SmallBook {
    let book = SmallBook::sound();
    book.write("target/press/exhibits/one/sums.svg", &DRAWN.replace("a < b", "a &lt; b"));
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    book.write("press/theme/css/variables.css", COLOURS);
    book
}

fn gathered(book: &SmallBook, folder: &Path) -> usize {
    let layout = Layout { root: book.root().to_path_buf() };
    let (steps, warnings) = (Steps::quiet(), Warnings::default());
    gather(&Maker { layout, steps, warnings, mine: false }, folder).expect("figures")
}

#[test]
fn a_figure_has_its_colours_and_its_caption_the_number_and_the_page() {
    let book = built();
    let folder = book.path("slides");
    assert_eq!(gathered(&book, &folder), 1);
    let svg = book.read("slides/svg/01-01-sums.svg");
    assert!(svg.starts_with("<svg viewBox=\"0 0 9 9\""), "{svg}");
    assert!(
        svg.contains("<text fill=\"#1f1d1a\" x=\"1\" y=\"2\">a &lt; b\u{a0}m</text></svg>"),
        "{svg}"
    );
    let captions = book.read("slides/captions.md");
    for part in [
        "# Figures of “Small”, version ",
        "CC BY 4.0",
        "## 1 One\n\n### Figure 1.1\n\nSums.\n",
        "- Files: `svg/01-01-sums.svg`, `png/01-01-sums.png`\n",
        "- In the book: `one.html#fig:sums`\n",
        "- For those who cannot see it: A rising line.\n",
    ] {
        assert!(captions.contains(part), "{part} is not in the captions:\n{captions}");
    }
}

#[test]
fn the_same_book_gives_the_same_files() {
    let book = built();
    let [one, other] = ["one", "other"].map(|name| {
        let folder = book.path(name);
        gathered(&book, &folder);
        ["captions.md", "svg/01-01-sums.svg"]
            .map(|file| fs::read(folder.join(file)).expect("a file"))
    });
    assert_eq!(one, other);
}

#[test]
fn a_folder_that_holds_something_and_a_book_that_was_not_built_are_refused() {
    let book = SmallBook::sound();
    book.write("mine/letter.txt", "Dear");
    for (folder, said) in
        [("mine", "is not empty; name a new folder"), ("slides", "`cargo book build` makes it")]
    {
        let folder = book.path(folder);
        let output = book.run(&["figures", folder.to_str().expect("Unicode")]);
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && text.contains(said), "{text}");
    }
    assert_eq!(book.read("mine/letter.txt"), "Dear");
    assert!(!book.path("slides").exists());
}
