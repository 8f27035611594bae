//! An answer as a flat list of tokens that know where they stand.

use std::collections::BTreeSet;

use proc_macro2::extra::invalidate_current_thread_spans;
use proc_macro2::token_stream::IntoIter;
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

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
    Word(String),
    Mark(char),
    /// A number, a string or the name of a lifetime.
    Other,
}

/// What is around a token.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    attribute: bool,
    import: bool,
    call_of_macro: bool,
    modules: usize,
}

/// All tokens of an answer.
#[derive(Debug)]
pub struct Tokens {
    list: Vec<Token>,
    defined: BTreeSet<String>,
    has_foreign_glob: bool,
}

impl Tokens {
    /// # Errors
    ///
    /// When the text has no tokens, or too many brackets in one another.
    pub fn of(text: &str) -> Result<Self, String> {
        let list = flat(text);
        // The parser keeps every text for its spans until it is told to let go.
        invalidate_current_thread_spans();
        let mut tokens = Self { list: list?, defined: BTreeSet::new(), has_foreign_glob: false };
        tokens.mark_imports();
        tokens.defined = tokens.definitions();
        Ok(tokens)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// The word at a place, or nothing where there is none.
    pub fn word(&self, at: usize) -> &str {
        match self.list.get(at).map(|token| &token.kind) {
            Some(Kind::Word(word)) => word,
            _ => "",
        }
    }

    /// Whether a mark stands at a place.
    pub fn is(&self, at: usize, mark: char) -> bool {
        self.list
            .get(at)
            .is_some_and(|token| matches!(token.kind, Kind::Mark(found) if found == mark))
    }

    /// Whether a bracket opens at a place.
    pub fn opens(&self, at: usize) -> bool {
        ['(', '[', '{'].iter().any(|mark| self.is(at, *mark))
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

    /// Whether it is part of an attribute.
    pub fn in_attribute(&self, at: usize) -> bool {
        self.place(at).attribute
    }

    /// Whether it is part of a `use`.
    pub fn in_import(&self, at: usize) -> bool {
        self.place(at).import
    }

    /// Whether it is given to a macro, or part of one.
    pub fn in_macro(&self, at: usize) -> bool {
        self.place(at).call_of_macro
    }

    /// In how many modules of the file it is.
    pub fn modules(&self, at: usize) -> usize {
        self.place(at).modules
    }

    /// Whether the file gives this name to something of its own.
    pub fn defines(&self, name: &str) -> bool {
        self.defined.contains(name)
    }

    /// Whether the file defines macros.
    pub fn has_macros(&self) -> bool {
        (0..self.len()).any(|at| self.word(at) == "macro_rules")
    }

    /// Whether the file imports whatever another crate has.
    pub fn has_foreign_glob(&self) -> bool {
        self.has_foreign_glob
    }

    fn place(&self, at: usize) -> Place {
        self.list.get(at).map(|token| token.place).unwrap_or_default()
    }

    fn mark_imports(&mut self) {
        let mut at = 0;
        while at < self.len() {
            // `use<…>` among the bounds of a type is no import.
            if self.word(at) == "use" && !self.is(at + 1, '<') {
                let root = if self.separates(at + 1) { at + 3 } else { at + 1 };
                let own = ["self", "super", "crate"].contains(&self.word(root));
                while at < self.len() && !self.is(at, ';') {
                    self.has_foreign_glob |= !own && self.is(at, '*');
                    self.list[at].place.import = true;
                    at += 1;
                }
            }
            at += 1;
        }
    }

    fn definitions(&self) -> BTreeSet<String> {
        const INTRODUCE: [&str; 11] = [
            "fn", "struct", "enum", "type", "trait", "const", "static", "mod", "union", "let",
            "mut",
        ];
        let is_definition = |at: &usize| {
            let introduced = *at > 0 && INTRODUCE.contains(&self.word(at - 1));
            introduced || self.is(at + 1, ':') && !self.separates(at + 1)
        };
        let words = (0..self.len()).filter(|at| !self.word(*at).is_empty());
        words.filter(is_definition).map(|at| self.word(at).to_owned()).collect()
    }
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
    let mut list: Vec<Token> = Vec::new();
    let mut stack: Vec<(IntoIter, char, Place)> = vec![(stream.into_iter(), ' ', Place::default())];
    while let Some((rest, close, place)) = stack.last_mut() {
        let (close, place) = (*close, *place);
        let Some(tree) = rest.next() else {
            stack.pop();
            let line = list.last().map_or(1, |token| token.line);
            list.push(Token { kind: Kind::Mark(close), line, place });
            continue;
        };
        let line = tree.span().start().line;
        match tree {
            TokenTree::Group(group) => {
                let (open, close) = brackets(&group);
                let inside = inside(&list, open, place);
                list.push(Token { kind: Kind::Mark(open), line, place });
                stack.push((group.stream().into_iter(), close, inside));
                if stack.len() > NESTED {
                    return Err(format!(
                        "line {line}: more than {NESTED} brackets are open here, one in the \
                            other. Give parts of it names of their own."
                    ));
                }
            }
            tree => {
                let kind = kind(&tree, list.last());
                list.push(Token { kind, line, place });
            }
        }
    }
    Ok(list)
}

fn kind(tree: &TokenTree, before: Option<&Token>) -> Kind {
    let is_lifetime = before.is_some_and(|token| matches!(token.kind, Kind::Mark('\'')));
    match tree {
        TokenTree::Ident(_) if is_lifetime => Kind::Other,
        TokenTree::Ident(ident) => {
            let word = ident.to_string();
            Kind::Word(word.strip_prefix("r#").map_or(word.clone(), str::to_owned))
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

/// The place inside a bracket that opens after these tokens.
fn inside(before: &[Token], open: char, around: Place) -> Place {
    let mark = |back: usize| match before.iter().nth_back(back).map(|token| &token.kind) {
        Some(Kind::Mark(mark)) => *mark,
        _ => ' ',
    };
    let word = |back: usize| match before.iter().nth_back(back).map(|token| &token.kind) {
        Some(Kind::Word(word)) => word.as_str(),
        _ => "",
    };
    let attribute = open == '[' && (mark(0) == '#' || mark(0) == '!' && mark(1) == '#');
    let macro_call = mark(0) == '!' && !word(1).is_empty();
    let macro_rules = !word(0).is_empty() && mark(1) == '!' && word(2) == "macro_rules";
    let module = open == '{' && !word(0).is_empty() && word(1) == "mod";
    Place {
        attribute: around.attribute || attribute,
        call_of_macro: around.call_of_macro || macro_call || macro_rules,
        modules: around.modules + usize::from(module),
        ..around
    }
}
