//! An answer as a flat list of tokens that know where they stand.
//!
//! Names are looked for in it and not in the text, so that raw identifiers and the insides of macros count, and comments
//! and strings do not.

mod places;

use proc_macro2::extra::invalidate_current_thread_spans;
use proc_macro2::token_stream::IntoIter;
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

pub use places::Place;

/// How deep brackets may be nested.
const NESTED: usize = 100;

/// One token. Brackets are marks of their own.
#[derive(Debug)]
struct Token {
    kind: Kind,
    line: usize,
    place: Place,
}

#[derive(Debug)]
enum Kind {
    /// An identifier or keyword, without the `r#` of raw ones.
    Word {
        text: String,
        raw: bool,
    },
    Mark(char),
    /// A number, a string or the name of a lifetime.
    Other,
}

/// All tokens of an answer.
#[derive(Debug)]
pub struct Tokens {
    list: Vec<Token>,
}

impl Tokens {
    /// Reads an answer.
    ///
    /// # Errors
    ///
    /// When the compiler may read the text otherwise, when it has no tokens, or too many brackets in
    /// one another.
    pub fn of(text: &str) -> Result<Self, String> {
        read_alike(text)?;
        let list = flat(text);
        // The parser keeps every text for its spans until it is told to let go.
        invalidate_current_thread_spans();
        let mut tokens = Self { list: list? };
        places::mark(&mut tokens);
        Ok(tokens)
    }

    /// How many there are.
    #[allow(clippy::len_without_is_empty, reason = "nobody asks whether there is none")]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// The word at a place, or nothing where there is none.
    pub fn word(&self, at: usize) -> &str {
        match self.list.get(at).map(|token| &token.kind) {
            Some(Kind::Word { text, .. }) => text,
            _ => "",
        }
    }

    /// The word at a place that can be a keyword, which a raw one cannot.
    pub fn keyword(&self, at: usize) -> &str {
        match self.list.get(at).map(|token| &token.kind) {
            Some(Kind::Word { text, raw: false }) => text,
            _ => "",
        }
    }

    /// Whether a mark stands at a place.
    pub fn is(&self, at: usize, mark: char) -> bool {
        self.list
            .get(at)
            .is_some_and(|token| matches!(token.kind, Kind::Mark(found) if found == mark))
    }

    /// Whether a mark stands before a place.
    pub fn follows(&self, at: usize, mark: char) -> bool {
        at > 0 && self.is(at - 1, mark)
    }

    /// Whether a bracket opens at a place.
    pub fn opens(&self, at: usize) -> bool {
        ['(', '[', '{'].iter().any(|mark| self.is(at, *mark))
    }

    /// Whether a bracket closes at a place.
    pub fn closes(&self, at: usize) -> bool {
        [')', ']', '}'].iter().any(|mark| self.is(at, *mark))
    }

    /// Whether `::` stands at a place.
    pub fn separates(&self, at: usize) -> bool {
        self.is(at, ':') && self.is(at + 1, ':')
    }

    /// Whether `::` stands before a place.
    pub fn follows_path(&self, at: usize) -> bool {
        at >= 2 && self.separates(at - 2)
    }

    /// The line of a token, from one.
    pub fn line(&self, at: usize) -> usize {
        self.list.get(at).map_or(0, |token| token.line)
    }

    /// What is around a token.
    pub fn place(&self, at: usize) -> Place {
        self.list.get(at).map(|token| token.place).unwrap_or_default()
    }
}

/// The compiler drops a first line `#!…`, and what is between lines `---` at the beginning. What
/// reads tokens here does not, so that such a line could open a comment for the one and not for
/// the other.
fn read_alike(text: &str) -> Result<(), String> {
    if without_shebang(text).is_some() {
        return Err("line 1: leave out the line that begins with `#!`.".to_owned());
    }
    let begin = text.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
    if begin.starts_with("---") {
        let line = 1 + text[..text.len() - begin.len()].matches('\n').count();
        return Err(format!("line {line}: leave out the lines of `---` and what is between them."));
    }
    Ok(())
}

/// The rest of a text whose first line begins with `#!` and is no attribute.
pub fn without_shebang(text: &str) -> Option<&str> {
    let rest = text.strip_prefix('\u{feff}').unwrap_or(text).strip_prefix("#!")?;
    if rest.starts_with('[') {
        return None;
    }
    Some(rest.find('\n').map_or("", |end| &rest[end..]))
}

/// The tokens one after the other. It keeps its own stack, because an answer may nest brackets as
/// deep as it likes.
fn flat(text: &str) -> Result<Vec<Token>, String> {
    let stream: TokenStream = text.parse().map_err(|error: proc_macro2::LexError| {
        format!(
            "line {}: from here on this cannot be read as Rust. A quote, a comment or a bracket \
                may have no end; the compiler says more.",
            error.span().start().line
        )
    })?;
    let token = |kind, line| Token { kind, line, place: Place::default() };
    let mut list: Vec<Token> = Vec::new();
    let mut stack: Vec<(IntoIter, char)> = vec![(stream.into_iter(), ' ')];
    while let Some((rest, close)) = stack.last_mut() {
        let close = *close;
        let Some(tree) = rest.next() else {
            stack.pop();
            let line = list.last().map_or(1, |token| token.line);
            list.push(token(Kind::Mark(close), line));
            continue;
        };
        let line = tree.span().start().line;
        let TokenTree::Group(group) = tree else {
            list.push(token(kind(&tree, list.last()), line));
            continue;
        };
        let (open, close) = brackets(&group);
        list.push(token(Kind::Mark(open), line));
        stack.push((group.stream().into_iter(), close));
        if stack.len() > NESTED {
            return Err(format!(
                "line {line}: more than {NESTED} brackets are open here, one in the other. Give \
                    parts of it names of their own."
            ));
        }
    }
    Ok(list)
}

fn kind(tree: &TokenTree, before: Option<&Token>) -> Kind {
    let is_lifetime = before.is_some_and(|token| matches!(token.kind, Kind::Mark('\'')));
    match tree {
        TokenTree::Ident(_) if is_lifetime => Kind::Other,
        TokenTree::Ident(ident) => {
            // The compiler takes the sign of the kelvin for the letter. It is the only one that
            // becomes a letter of ASCII by the normalization of names, NFC.
            let text = ident.to_string().replace('\u{212a}', "K");
            match text.strip_prefix("r#") {
                Some(text) => Kind::Word { text: text.to_owned(), raw: true },
                None => Kind::Word { text, raw: false },
            }
        }
        TokenTree::Punct(punct) => Kind::Mark(punct.as_char()),
        _ => Kind::Other,
    }
}

fn brackets(group: &Group) -> (char, char) {
    match group.delimiter() {
        Delimiter::Parenthesis => ('(', ')'),
        Delimiter::Brace => ('{', '}'),
        Delimiter::Bracket => ('[', ']'),
        Delimiter::None => (' ', ' '),
    }
}
