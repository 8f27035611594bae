//! Keeps rendered formulas safe from the Markdown parser that reads them next.

use std::sync::LazyLock;

use anyhow::Result;
use mdbook_preprocessor::book::Book;
use mdbook_preprocessor::{Preprocessor, PreprocessorContext};
use regex::{Captures, Regex};

/// Runs after KaTeX and keeps the Markdown parser away from what it made.
pub struct Guard;

impl Preprocessor for Guard {
    fn name(&self) -> &str {
        "guard"
    }

    fn run(&self, _: &PreprocessorContext, mut book: Book) -> Result<Book> {
        book.for_each_chapter_mut(|chapter| chapter.content = guarded(&chapter.content));
        Ok(book)
    }
}

/// Escapes, in the text of each formula, what Markdown would take for its own marks, and drops the TeX
/// that KaTeX encloses, which would otherwise turn up in the search.
pub fn guarded(content: &str) -> String {
    static ANNOTATION: LazyLock<Regex> = LazyLock::new(|| {
        Regex::new(r"(?s)<annotation[^>]*>.*?</annotation>").expect("a valid pattern")
    });
    static TEXT: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r">[^<]+<").expect("a valid pattern"));
    let escape = |found: &Captures<'_>| {
        found[0].chars().fold(String::new(), |mut out, c| {
            match c {
                '\\' | '`' | '*' | '_' | '[' | ']' | '~' | '|' | '!' | '$' | '{' | '}' | '^'
                | '\'' | '"' => {
                    out.push_str(&format!("&#{};", u32::from(c)));
                }
                c => out.push(c),
            }
            out
        })
    };
    let mut out = String::with_capacity(content.len());
    let mut rest = content;
    while let Some(start) = rest.find("<span class=\"katex") {
        let end = start + span_length(&rest[start..]);
        out.push_str(&rest[..start]);
        let formula = ANNOTATION.replace_all(&rest[start..end], "");
        let formula = TEXT.replace_all(&formula, escape);
        let (tied, after) = rest[end..].split_at(punctuation(&rest[end..]));
        // A formula of several parts may be broken between them; one of one part takes its full stop along.
        if !tied.is_empty() && formula.matches("class=\"base\"").count() == 1 {
            out.push_str(&format!("<span class=\"tied\">{formula}{tied}</span>"));
        } else {
            out.push_str(&formula);
            out.push_str(tied);
        }
        rest = after;
    }
    out.push_str(rest);
    out
}

/// The length of what must not begin a line.
fn punctuation(text: &str) -> usize {
    text.find(|c: char| !matches!(c, ',' | '.' | ';' | ':' | ')' | '?')).unwrap_or(text.len())
}

/// The length of the element `span` at the start of `html`.
fn span_length(html: &str) -> usize {
    let mut depth = 0_usize;
    let mut at = 0;
    while let Some(found) = html[at..].find('<') {
        at += found;
        if html[at..].starts_with("<span") {
            depth += 1;
        } else if html[at..].starts_with("</span>") {
            depth -= 1;
            if depth == 0 {
                return at + "</span>".len();
            }
        }
        at += 1;
    }
    html.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_of_one_part_keeps_its_punctuation_on_its_line() {
        let part = r#"<span class="base">x</span>"#;
        let one = format!(r#"<span class="katex">{part}</span>"#);
        assert_eq!(
            guarded(&format!("{one}), so")),
            format!(r#"<span class="tied">{one}),</span> so"#)
        );
        let two = format!(r#"<span class="katex">{part}{part}</span>."#);
        assert_eq!(guarded(&two), two);
        assert_eq!(guarded(&format!("{one} so")), format!("{one} so"));
    }

    #[test]
    fn the_text_of_a_formula_is_escaped_and_its_tex_is_dropped() {
        let formula = r#"a* <span class="katex"><span class="m">~x_1|</span><annotation encoding="application/x-tex">\tilde</annotation></span> b*"#;
        assert_eq!(
            guarded(formula),
            r#"a* <span class="katex"><span class="m">&#126;x&#95;1&#124;</span></span> b*"#
        );
    }
}
