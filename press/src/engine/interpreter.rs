//! KaTeX in its interpreter, by mdbook-katex.

use std::path::Path;
use std::sync::LazyLock;

use anyhow::Result;
use katex::Opts;
use mdbook_katex::cfg::KatexConfig;
use mdbook_katex::preprocess::ExtraOpts;
use mdbook_katex::render::process_chapter_prerender;
use regex::Regex;

/// KaTeX with the book's settings.
pub struct Engine {
    inline: Opts,
    display: Opts,
    extra: ExtraOpts,
}

impl Engine {
    /// KaTeX with the settings of a book in `root`.
    pub fn new(root: &Path, settings: &KatexConfig) -> Result<Engine> {
        let (inline, display) = settings.build_opts(root);
        Ok(Engine { inline, display, extra: settings.build_extra_opts() })
    }

    /// Why KaTeX does not take a formula, if it does not.
    pub fn rejection(&self, tex: &str, display: bool) -> Option<String> {
        static REASON: LazyLock<Regex> = LazyLock::new(|| {
            Regex::new(r"(?s)KaTeX parse error: (.*? at (?:position \d+|end of input))")
                .expect("a valid pattern")
        });
        let options = if display { &self.display } else { &self.inline };
        let error = katex::render_with_opts(tex, options).err()?.to_string();
        let reason = REASON.captures(&error).and_then(|found| found.get(1));
        Some(reason.map_or(error.as_str(), |reason| reason.as_str()).replace(r"\\", r"\"))
    }

    /// A chapter with its formulas rendered.
    pub fn chapter(&self, markdown: &str) -> String {
        process_chapter_prerender(
            markdown,
            self.inline.clone(),
            self.display.clone(),
            "",
            &self.extra,
        )
    }
}
