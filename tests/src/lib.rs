//! Tests of the book as its readers get it: `tests/rendered.rs` reads the pages, `browser/` opens them in a browser.
