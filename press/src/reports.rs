//! Where readers report an error, with the place and the version filled in.

use mdbook_preprocessor::config::Config;
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};

/// The version of the book, which is that of all its parts; between releases whoever publishes pages says which they are.
pub const VERSION: &str = match option_env!("BOOK_VERSION") {
    Some(version) => version,
    None => env!("CARGO_PKG_VERSION"),
};

/// The repository to which errors are reported, if `output.html.git-repository-url` names one.
#[derive(Clone, Debug, Default)]
pub struct Reports {
    repository: Option<String>,
}

impl Reports {
    /// What the configuration of a book says.
    pub fn new(config: &Config) -> Reports {
        Reports { repository: config.html_config().and_then(|html| html.git_repository_url) }
    }

    /// The address of a new report on a place in a page, such as `eq:projection` in `src/bearing.md`.
    pub fn on(&self, place: &str, file: &str) -> Option<String> {
        let repository = self.repository.as_deref()?.trim_end_matches('/');
        let encoded = |text: &str| utf8_percent_encode(text, NON_ALPHANUMERIC).to_string();
        let title = encoded(&format!("{place}: "));
        let body = encoded(&format!(
            "Version {VERSION}, {file}, {place}\n\nWhat is wrong, and what it should be:\n"
        ));
        Some(format!("{repository}/issues/new?title={title}&body={body}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_has_place_and_version_and_there_is_none_without_a_repository() {
        assert_eq!(Reports::default().on("eq:one", "src/one.md"), None);
        let reports = Reports { repository: Some("https://example.org/book/".to_owned()) };
        let address = reports.on("eq:one", "src/one.md").unwrap();
        let begin = "https://example.org/book/issues/new?title=eq%3Aone%3A%20&body=Version%20";
        assert!(address.starts_with(begin), "{address}");
        assert!(address.contains("src%2Fone%2Emd%2C%20eq%3Aone%0A"), "{address}");
    }
}
