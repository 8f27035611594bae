//! What the first page says below the title: who wrote the book, when it was released, what may be done with it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use anyhow::{Context, Result};
use mdbook_driver::config::Config;
use regex::Regex;
use serde::Serialize;

use crate::files;
use crate::settings::Settings;

/// Where the releases stand.
const CHANGELOG: &str = "CHANGELOG.md";

/// What the pages do not know of their book.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct Imprint {
    authors: Vec<String>,
    licences: Vec<String>,
    /// The day of each release, by its version.
    releases: BTreeMap<String, String>,
}

impl Imprint {
    /// What `book.toml` and the changelog of a book say.
    ///
    /// # Errors
    /// A `book.toml` that is not as expected.
    pub fn read(root: &Path) -> Result<Imprint> {
        let config = Config::from_disk(root.join("book.toml")).context("book.toml is damaged")?;
        let changelog = files::read_if_there(&root.join(CHANGELOG))?.unwrap_or_default();
        Ok(Imprint {
            authors: config.book.authors,
            licences: Settings::read(root)?.licences,
            releases: releases(&changelog),
        })
    }
}

/// The headings of a changelog that have a version and a day.
fn releases(changelog: &str) -> BTreeMap<String, String> {
    static RELEASE: LazyLock<Regex> = LazyLock::new(|| {
        Regex::new(r"(?m)^## \[(\S+)\] - (\d{4}-\d{2}-\d{2})\s*$").expect("a valid pattern")
    });
    RELEASE.captures_iter(changelog).map(|found| (found[1].into(), found[2].into())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_released_has_no_day() {
        let changelog = "# Changelog\n\n## [Unreleased]\n\n## [0.2.0] - 2027-01-02\n\n### Added\n\n## [0.1.0] - 2026-11-26\n";
        let days = [("0.1.0", "2026-11-26"), ("0.2.0", "2027-01-02")];
        assert_eq!(releases(changelog), days.map(|(of, day)| (of.into(), day.into())).into());
    }

    #[test]
    fn a_book_without_changelog_and_licences_has_its_authors() {
        let root = tempfile::tempdir().unwrap();
        files::write(&root.path().join("book.toml"), b"[book]\nauthors = [\"Ann\"]\n").unwrap();
        let imprint = Imprint::read(root.path()).unwrap();
        let expected = Imprint {
            authors: vec!["Ann".to_owned()],
            licences: Vec::new(),
            releases: BTreeMap::new(),
        };
        assert_eq!(imprint, expected);
    }
}
