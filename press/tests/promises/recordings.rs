//! Figures that are pictures of scenes in three dimensions.

use std::fs;

use crate::small::SmallBook;

/// The first bytes of a PNG of 1100 by 674 pixels, which is all that the press reads of it.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x04\x4c\0\0\x02\xa2";

/// A book with the picture of a scene, and with a text before its second section.
fn book(figure: &str) -> SmallBook {
    let book = SmallBook::sound().with("src/one.md", "## More", &format!("{figure}\n\n## More"));
    let pictures = book.path("recordings/pictures");
    fs::create_dir_all(&pictures).expect("a folder");
    fs::write(pictures.join("one.png"), PNG).expect("a picture");
    book.write("recordings/src/one.rs", "pub fn play() {}\n");
    book
}

const FIGURE: &str = "![A scene.](recordings/one.png){#fig:scene alt=\"Eight pyramids.\"}";

#[test]
fn a_scene_has_its_picture_and_its_command_and_without_the_viewer_no_button() {
    let book = book(FIGURE);
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = book.read("book/one.html");
    for part in [
        "src=\"generated/recordings/one.png\"",
        "width=\"1100\" height=\"674\"",
        "alt=\"Eight pyramids.\"",
        "cargo run -p recordings --release -- one",
        "generated/source/recordings/src/one.rs.html",
    ] {
        assert!(page.contains(part), "{part} is not in the page");
    }
    assert!(!page.contains("three dimensions</button>") && !page.contains("data-recording"));
    assert_eq!(fs::read(book.path("book/generated/recordings/one.png")).expect("a picture"), PNG);
}

#[test]
fn a_scene_that_has_no_picture_is_named() {
    let report =
        book(&format!("{FIGURE}\n\n![Two.](recordings/two.png){{#fig:two alt=\"Two.\"}}")).faults();
    assert!(report.contains("two: there is no picture of this scene"), "{report}");
    assert!(report.contains("recordings/src/two.rs"), "{report}");
}

#[test]
fn a_scene_that_no_chapter_shows_is_named() {
    let report = book("").faults();
    assert!(report.contains("recordings/pictures/one.png: one: no chapter shows"), "{report}");
}

#[test]
fn a_scene_without_alternative_text_is_named() {
    let report = book("![A scene.](recordings/one.png){#fig:scene}").faults();
    assert!(report.contains("fig:scene: the figure has no alternative text"), "{report}");
}
