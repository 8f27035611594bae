//! Keeps rendered formulas safe from the Markdown parser that reads them next.

use std::sync::LazyLock;

use anyhow::Result;
use mdbook_preprocessor::book::Book;
use mdbook_preprocessor::{Preprocessor, PreprocessorContext};
use regex::{Captures, Regex};

/// What KaTeX begins each part of a formula with; a line may end between two of them.
const PART: &str = "<span class=\"base\">";
/// The end of the only element that it writes.
const END: &str = "</span>";

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
        rest = &rest[end..];
        let (before, closed) = enclosing(&out, rest);
        let marks = punctuation(&rest[closed..]);
        if marks == 0 {
            out.push_str(&formula);
            continue;
        }
        let (tied, after) = rest.split_at(closed + marks);
        out.insert_str(before, "<span class=\"tied\">");
        out.push_str(&format!("{}{tied}</span>", in_parts(&formula)));
        rest = after;
    }
    out.push_str(rest);
    out
}

/// Where in `before` the span begins that encloses a formula alone, and the length of its end in `after`.
fn enclosing(before: &str, after: &str) -> (usize, usize) {
    let tag = before.rfind('<').filter(|tag| before[*tag..].starts_with("<span "));
    match tag.filter(|_| before.ends_with('>') && after.starts_with(END)) {
        Some(tag) => (tag, END.len()),
        None => (before.len(), 0),
    }
}

/// The formula with a place between any two of its parts where a line may end although it is tied to what follows.
fn in_parts(formula: &str) -> String {
    let next = format!("<wbr>{PART}");
    formula.replace(PART, &next).replacen(&next, PART, 1)
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
        } else if html[at..].starts_with(END) {
            depth -= 1;
            if depth == 0 {
                return at + END.len();
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
    fn a_formula_keeps_its_punctuation_on_its_line_and_may_be_broken_between_its_parts() {
        let part = r#"<span class="base">x</span>"#;
        let one = format!(r#"<span class="katex">{part}</span>"#);
        assert_eq!(
            guarded(&format!("{one}), so")),
            format!(r#"<span class="tied">{one}),</span> so"#)
        );
        let two = format!(r#"<span class="katex">{part}{part}</span>."#);
        assert_eq!(
            guarded(&two),
            format!(r#"<span class="tied"><span class="katex">{part}<wbr>{part}</span>.</span>"#)
        );
        for loose in [format!("{one} so"), format!("<i>{one}</i>, so"), format!("{one}</span>, so")]
        {
            assert_eq!(guarded(&loose), loose);
        }
    }

    #[test]
    fn a_formula_in_a_span_of_its_own_is_tied_to_what_stands_behind_the_span() {
        let letter =
            r#"<span id="symbol:x"><span class="katex"><span class="base">x</span></span></span>"#;
        assert_eq!(
            guarded(&format!("say {letter}. So")),
            format!(r#"say <span class="tied">{letter}.</span> So"#)
        );
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
