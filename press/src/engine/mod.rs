//! What turns TeX into HTML.
//!
//! mdbook-katex runs KaTeX itself in an interpreter. That needs a C compiler other than Microsoft's, and loses
//! capabilities on other processors than x86-64. There, a port of KaTeX to Rust does the same; a test of the feature
//! `port` holds the two against each other on the formulas of the book.

#[cfg(all(target_arch = "x86_64", not(target_env = "msvc")))]
mod interpreter;
#[cfg(any(
    all(test, feature = "port"),
    not(all(target_arch = "x86_64", not(target_env = "msvc")))
))]
mod port;

#[cfg(all(target_arch = "x86_64", not(target_env = "msvc")))]
pub use interpreter::Engine;
#[cfg(not(all(target_arch = "x86_64", not(target_env = "msvc"))))]
pub use port::Engine;

#[cfg(all(test, feature = "port", target_arch = "x86_64", not(target_env = "msvc")))]
mod tests {
    use std::collections::BTreeMap;
    use std::path::Path;
    use std::sync::LazyLock;

    use ego_tree::iter::Edge;
    use mdbook_katex::cfg::KatexConfig;
    use regex::{Captures, Regex};
    use scraper::{Html, Node};

    use super::{interpreter, port};
    use crate::blocks::{Kind, blocks};
    use crate::files;
    use crate::inline::{Mark, tokens};

    fn settings() -> KatexConfig {
        KatexConfig {
            no_css: true,
            output: "htmlAndMathml".to_owned(),
            trust: true,
            macros: Some("press/theme/macros.txt".to_owned()),
            ..KatexConfig::default()
        }
    }

    /// The formulas of the book: TeX and whether it is displayed.
    fn formulas(root: &Path) -> Vec<(String, bool)> {
        let mut formulas = Vec::new();
        let src = root.join("src");
        for file in files::below(&src).expect("the chapters") {
            if file.extension().is_none_or(|end| end != "md") {
                continue;
            }
            for block in blocks(&files::read(&src.join(file)).expect("a chapter")) {
                match block.kind {
                    Kind::Equation { tex, .. } => formulas.push((tex, true)),
                    Kind::Text(text) => {
                        formulas.extend(tokens(&text).iter().filter_map(|token| match token.mark {
                            Mark::Math(tex) => Some((tex.to_owned(), false)),
                            _ => None,
                        }))
                    }
                    _ => {}
                }
            }
        }
        formulas.retain(|(tex, _)| !tex.contains("{{value"));
        formulas
    }

    static LENGTH: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"(-?\d*\.?\d+)em").expect("a valid pattern"));

    /// What the port writes otherwise and nobody sees: the empty space in `\ne`, a style that is in force anyway around
    /// a `\tfrac`, whether all of a number or its last digit has the power, a zero with a sign, letters of one word in one
    /// element or in several, and so where elements end, and whether what is over a brace counts as a letter or as a bracket,
    /// which has the same space beside a plus.
    static UNSEEN: LazyLock<Regex> = LazyLock::new(|| {
        Regex::new(concat!(
            r#"<span \{"class": "mspace nobreak"\}>/"#,
            r#"|<mstyle \{"displaystyle": "false", "scriptlevel": "0"\}>"#,
            r"|<mn \{\}>|<msup \{\}>",
            r#"|(?:-)0\b"#,
            r#"|//<span \{"class": "mord mathnormal( mtight)?"(, "style": "margin-right:em;")?\}>"#,
            r#"|, "style": "margin-right:em;"|/"#,
            r"|(?:mord|minner) munder",
        ))
        .expect("a valid pattern")
    });

    /// HTML as text, element by element, with attributes in order and lengths left out; and the lengths, which the
    /// port rounds otherwise and, between two spaces, exchanges.
    fn taken_apart(html: &str) -> (String, Vec<f64>) {
        let mut text = String::new();
        for edge in Html::parse_fragment(html).root_element().traverse() {
            match edge {
                Edge::Open(node) => match node.value() {
                    Node::Element(element) => {
                        let attributes: BTreeMap<&str, &str> = element.attrs().collect();
                        text.push_str(&format!("<{} {attributes:?}>", element.name()));
                    }
                    Node::Text(words) => text.push_str(words),
                    _ => {}
                },
                Edge::Close(_) => text.push('/'),
            }
        }
        let lengths = LENGTH.captures_iter(&text).map(|found| found[1].parse().expect("a number"));
        let mut lengths: Vec<f64> = lengths.collect();
        lengths.sort_by(f64::total_cmp);
        (LENGTH.replace_all(&text, "em").into_owned(), lengths)
    }

    fn seen(text: &str) -> String {
        UNSEEN
            .replace_all(text, |found: &Captures<'_>| if &found[0] == "-0" { "0" } else { "" })
            .into_owned()
    }

    #[test]
    fn the_port_gives_the_same_elements_and_moves_none_by_a_third_of_a_letter() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
        let one = interpreter::Engine::new(root, &settings()).unwrap();
        let other = port::Engine::new(root, &settings()).unwrap();
        let formulas = formulas(root);
        assert!(formulas.len() > 50, "the book has lost its formulas");
        let mut otherwise = Vec::new();
        for (tex, display) in formulas {
            let markdown = if display { format!("a $${tex}$$ b") } else { format!("a ${tex}$ b") };
            let (one, lengths) = taken_apart(&one.chapter(&markdown));
            let (other, other_lengths) = taken_apart(&other.chapter(&markdown));
            let (one, other) = (seen(&one), seen(&other));
            if one != other {
                otherwise.push(format!("{tex}\n{one}\n{other}"));
                continue;
            }
            // Below the last of several rows KaTeX leaves 0.3 em and the port nothing. An accent over a bold letter
            // stands a sixth of an em aside.
            let accent = [r"\bar", r"\dot", r"\ddot"].iter().any(|accent| tex.contains(accent));
            let limit = match (tex.contains(r"\\"), accent) {
                (true, _) => 0.31,
                (_, true) => 0.17,
                _ => 0.1,
            };
            let alike = lengths.len() == other_lengths.len();
            for (one, other) in lengths.into_iter().zip(other_lengths).filter(|_| alike) {
                if (one - other).abs() >= limit {
                    otherwise.push(format!("{tex}: {one} em for {other} em"));
                }
            }
        }
        assert!(otherwise.is_empty(), "{}", otherwise.join("\n"));
    }

    #[test]
    fn the_port_rejects_what_the_interpreter_rejects() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
        let one = interpreter::Engine::new(root, &settings()).unwrap();
        let other = port::Engine::new(root, &settings()).unwrap();
        for tex in [r"\nothing", r"\frac{1}", r"\begin{matrix} 1", "x_"] {
            let (one, other) = (one.rejection(tex, true), other.rejection(tex, true));
            assert!(one.is_some() && other.is_some(), "{tex}: {one:?} {other:?}");
        }
    }
}
