//! KaTeX ported to Rust.

use std::path::Path;
use std::sync::LazyLock;

use anyhow::{Result, bail};
use katex_port::macros::MacroDefinition;
use katex_port::types::{OutputFormat, StrictMode, StrictSetting, TrustSetting};
use katex_port::{KatexContext, Settings, render_to_string};
use mdbook_katex::cfg::KatexConfig;
use mdbook_katex::preprocess::{ExtraOpts, Render, get_render_tasks};
use regex::{Captures, Regex};

use crate::files;

/// KaTeX with the book's settings.
pub struct Engine {
    inline: Settings,
    display: Settings,
    extra: ExtraOpts,
    context: KatexContext,
}

impl Engine {
    /// KaTeX with the settings of a book in `root`.
    pub fn new(root: &Path, settings: &KatexConfig) -> Result<Engine> {
        if settings.output != "htmlAndMathml" {
            bail!(
                "book.toml: [preprocessor.katex]: set output = \"htmlAndMathml\"; the press knows no other on this machine"
            );
        }
        let options = |display: bool| -> Result<Settings> {
            let built = Settings::builder()
                .display_mode(display)
                .output(OutputFormat::HtmlAndMathml)
                .strict(StrictSetting::Mode(StrictMode::Ignore))
                .trust(TrustSetting::Bool(settings.trust))
                .build();
            if let Some(path) = &settings.macros {
                let text = files::read(&root.join(path))?;
                for (name, body) in text
                    .lines()
                    .filter(|line| line.starts_with('\\'))
                    .filter_map(|line| line.split_once(':'))
                {
                    built
                        .macros
                        .borrow_mut()
                        .insert(name.to_owned(), MacroDefinition::String(body.to_owned()));
                }
            }
            Ok(built)
        };
        let extra = settings.build_extra_opts();
        Ok(Engine {
            inline: options(false)?,
            display: options(true)?,
            extra,
            context: KatexContext::default(),
        })
    }

    /// Why KaTeX does not take a formula, if it does not.
    pub fn rejection(&self, tex: &str, display: bool) -> Option<String> {
        self.render(tex, display).err()
    }

    /// A chapter with its formulas rendered.
    pub fn chapter(&self, markdown: &str) -> String {
        let shown = |tex: &str, display: bool, mark: &str| match self.render(tex, display) {
            Ok(html) => html.replace('\n', " "),
            Err(reason) => {
                tracing::warn!("Rendering failed, keeping the original content: {reason}");
                format!("{mark}{tex}{mark}")
            }
        };
        get_render_tasks(markdown, "", &self.extra)
            .into_iter()
            .map(|task| match task {
                Render::Text(text) => text.to_owned(),
                Render::InlineTask(tex) => shown(tex, false, "$"),
                Render::DisplayTask(tex) => shown(tex, true, "$$"),
            })
            .collect()
    }

    fn render(&self, tex: &str, display: bool) -> Result<String, String> {
        let settings = if display { &self.display } else { &self.inline };
        // A formula may define macros of its own, which must not reach the next one.
        let html = render_to_string(&self.context, tex, &settings.clone());
        html.map(|html| with_known_classes(&html)).map_err(|error| error.to_string())
    }
}

/// The port names its classes as the newest KaTeX does, `katex-base`; the style of the book has KaTeX 0.16's
/// names, `base`.
fn with_known_classes(html: &str) -> String {
    static RENAMED: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"\bkatex-([a-z]+)").expect("a valid pattern"));
    let name = |found: &Captures<'_>| match &found[1] {
        "display" | "error" | "html" | "mathml" => found[0].to_owned(),
        old => old.to_owned(),
    };
    static CLASSES: LazyLock<Regex> =
        LazyLock::new(|| Regex::new("class=\"[^\"]*\"").expect("a valid pattern"));
    CLASSES
        .replace_all(html, |found: &Captures<'_>| RENAMED.replace_all(&found[0], name).into_owned())
        .into_owned()
}
