//! Finds the items of a Rust file, by the lines they begin and end on.
//!
//! It reads what rustfmt wrote, where indentation says what lies in what. Whatever it takes wrongly, a dead link
//! into the pages of the library shows.

/// The kinds of items that rustdoc writes about, and what else can have a description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Module,
    Function,
    Struct,
    Enum,
    Union,
    Trait,
    Constant,
    Static,
    Type,
    Field,
    Variant,
    /// `impl Type` or `impl Trait for Type`; has the name of the type.
    Impl {
        of_trait: bool,
    },
    /// `pub use path`, with the path in place of a name.
    Use,
}

/// An item as its file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub kind: Kind,
    pub name: String,
    /// Whether it says `pub`.
    pub public: bool,
    /// Whether a function of a trait has a body.
    pub body: bool,
    /// The line of its name, counted from 1.
    pub line: usize,
    /// The last line.
    pub last: usize,
    /// The entry that it stands in.
    pub parent: Option<usize>,
}

/// The entries of a file, in order.
pub fn entries(source: &str) -> Vec<Entry> {
    let lines: Vec<&str> = source.lines().collect();
    let mut entries: Vec<Entry> = Vec::new();
    // The entries that the line is in, each with the indentation of what it holds.
    let mut open: Vec<(usize, usize)> = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let indent = indent(line);
        while open.last().is_some_and(|(entry, _)| at + 1 > entries[*entry].last) {
            open.pop();
        }
        let within = open.last().copied();
        if indent != within.map_or(0, |(_, indent)| indent) {
            continue;
        }
        let parent = within.map(|(entry, _)| entry);
        let Some((kind, name, public)) =
            head(line.trim(), parent.map(|entry| entries[entry].kind), &lines[at..])
        else {
            continue;
        };
        let last = at + length(&lines[at..], indent);
        let body = lines[last - 1].trim_end().ends_with('}');
        entries.push(Entry { kind, name, public, body, line: at + 1, last, parent });
        let holds = !matches!(
            kind,
            Kind::Function | Kind::Constant | Kind::Static | Kind::Type | Kind::Use | Kind::Field
        );
        if holds && last > at + 1 {
            open.push((entries.len() - 1, indent + 4));
        }
    }
    entries
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// How many lines an item takes: up to a line with the indentation of its first one that closes it.
fn length(lines: &[&str], indent_of_first: usize) -> usize {
    let closes = |line: &str| line.ends_with(';') || line.ends_with('}') || line.ends_with(',');
    if closes(lines[0].trim_end()) {
        return 1;
    }
    let end = lines[1..].iter().position(|line| {
        indent(line) == indent_of_first
            && !line.trim().is_empty()
            && closes(line.trim_end())
            && !line.trim_start().starts_with("where")
    });
    end.map_or(lines.len(), |end| end + 2)
}

/// The kind and name of the item that begins on a line, and whether it is public.
fn head(line: &str, parent: Option<Kind>, rest: &[&str]) -> Option<(Kind, String, bool)> {
    let (public, text) = match line.strip_prefix("pub ") {
        Some(text) => (true, text),
        None => (false, without_restriction(line)),
    };
    match parent {
        Some(Kind::Struct | Kind::Union | Kind::Variant) => {
            let (name, _) = text.split_once(": ")?;
            return is_name(name).then(|| (Kind::Field, name.to_owned(), public));
        }
        Some(Kind::Enum) => {
            let name = word(text);
            let capital = name.starts_with(|c: char| c.is_uppercase());
            return capital.then(|| (Kind::Variant, name.to_owned(), true));
        }
        _ => {}
    }
    if text.starts_with("impl ") || text.starts_with("impl<") {
        let (of_trait, name) = implemented(rest);
        return Some((Kind::Impl { of_trait }, name, false));
    }
    if let Some(path) = text.strip_prefix("use ").filter(|_| public) {
        let rest: String = rest[1..].iter().map(|line| line.trim()).collect();
        let whole = if path.ends_with(';') { path.to_owned() } else { format!("{path}{rest}") };
        return Some((Kind::Use, whole.split(';').next()?.to_owned(), public));
    }
    let mut text = text;
    for modifier in ["default ", "const ", "async ", "unsafe "] {
        let after = text.strip_prefix(modifier);
        let stays = |after: &&str| {
            modifier != "const "
                || ["fn ", "async ", "unsafe "].iter().any(|next| after.starts_with(next))
        };
        text = after.filter(stays).unwrap_or(text);
    }
    let (keyword, after) = text.split_once(' ')?;
    let kind = match keyword {
        "mod" => Kind::Module,
        "fn" => Kind::Function,
        "struct" => Kind::Struct,
        "enum" => Kind::Enum,
        "union" => Kind::Union,
        "trait" => Kind::Trait,
        "const" => Kind::Constant,
        "static" => Kind::Static,
        "type" => Kind::Type,
        _ => return None,
    };
    let name = word(after);
    (!name.is_empty()).then(|| (kind, name.to_owned(), public))
}

/// A line without `pub(crate)` and the like.
fn without_restriction(line: &str) -> &str {
    line.strip_prefix("pub(").and_then(|rest| rest.split_once(") ")).map_or(line, |(_, rest)| rest)
}

fn word(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    &text[..end]
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && word(text) == text
}

/// Whether an `impl` is that of a trait, and the name of its type.
fn implemented(lines: &[&str]) -> (bool, String) {
    let head: String = lines.iter().map(|line| format!("{} ", line.trim())).collect();
    let head = head.split(" {").next().unwrap_or_default().trim_start_matches("impl");
    let (of_trait, subject) = match head.split_once(" for ") {
        Some((_, subject)) => (true, subject),
        None => (false, without_generics(head)),
    };
    let path = subject.trim().split(['<', ' ']).next().unwrap_or_default();
    (of_trait, path.rsplit("::").next().unwrap_or_default().to_owned())
}

/// `<T: X<Y>> Type` without what stands between the first brackets.
fn without_generics(text: &str) -> &str {
    if !text.starts_with('<') {
        return text;
    }
    let mut depth = 0_usize;
    for (at, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if !text[..at].ends_with('-') => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return &text[at + 1..];
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(source: &str) -> Vec<(String, Kind, usize, usize, bool)> {
        let shown =
            |entry: &Entry| (entry.name.clone(), entry.kind, entry.line, entry.last, entry.public);
        entries(source).iter().map(shown).collect()
    }

    #[test]
    fn items_are_found_with_their_lines() {
        let source = "\
//! About.

pub const fn hat(
    phi: f64,
) -> f64
where
    f64: Copy,
{
    let fn_like = 1;
}

pub const TABLE: [f64; 2] = [
    1.0,
    2.0,
];
pub(crate) fn hidden() {}
pub mod so3;
";
        assert_eq!(
            found(source),
            [
                ("hat".to_owned(), Kind::Function, 3, 10, true),
                ("TABLE".to_owned(), Kind::Constant, 12, 15, true),
                ("hidden".to_owned(), Kind::Function, 16, 16, false),
                ("so3".to_owned(), Kind::Module, 17, 17, true),
            ]
        );
    }

    #[test]
    fn members_know_what_they_stand_in() {
        let source = "\
pub struct Pinhole<const D: usize> {
    /// Focal length.
    pub fx: f64,
}

impl<const D: usize> Camera<D> for Pinhole<D> {
    fn project(&self) -> f64 {
        0.0
    }
}

pub enum Error {
    Bad,
    Worse {
        value: f64,
    },
}

pub use inner::{
    One, Two,
};
";
        let all = entries(source);
        let parent = |at: usize| all[at].parent.map(|parent| all[parent].name.as_str());
        let names: Vec<_> = all.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "Pinhole",
                "fx",
                "Pinhole",
                "project",
                "Error",
                "Bad",
                "Worse",
                "value",
                "inner::{One, Two,}"
            ]
        );
        assert_eq!(all[2].kind, Kind::Impl { of_trait: true });
        assert_eq!((parent(1), parent(3)), (Some("Pinhole"), Some("Pinhole")));
        assert_eq!(
            (parent(5), parent(6), parent(7)),
            (Some("Error"), Some("Error"), Some("Worse"))
        );
        assert_eq!(all[7].kind, Kind::Field);
    }
}
