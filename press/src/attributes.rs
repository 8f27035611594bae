//! Attributes in the syntax of pandoc: `{#eq:label .class key="value"}`.

use std::collections::BTreeMap;

/// The identifier, classes and key-value pairs of an element.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    /// What stands after `#`, for example `eq:projection`; empty when there is none.
    pub id: String,
    /// What stands after each `.`.
    pub classes: Vec<String>,
    /// `key=value` or `key="a value"`.
    pub pairs: BTreeMap<String, String>,
}

impl Attributes {
    /// Whether the element has this class.
    pub fn has(&self, class: &str) -> bool {
        self.classes.iter().any(|known| known == class)
    }

    /// The value of a key, or the empty text.
    pub fn value(&self, key: &str) -> &str {
        self.pairs.get(key).map_or("", String::as_str)
    }

    /// The first key that is none of these.
    pub fn key_beyond(&self, known: &[&str]) -> Option<&str> {
        self.pairs.keys().map(String::as_str).find(|key| !known.contains(key))
    }

    /// Reads a text that is `{…}` and nothing else.
    pub fn whole(text: &str) -> Option<Attributes> {
        let (attributes, length) = Attributes::parse(text)?;
        (length == text.len()).then_some(attributes)
    }

    /// Reads `{…}` at the start of `text`; gives the attributes and how many bytes they took.
    ///
    /// `None` when `text` does not begin with attributes that are closed and well formed.
    pub fn parse(text: &str) -> Option<(Attributes, usize)> {
        let mut attributes = Attributes::default();
        let mut rest = text.strip_prefix('{')?;
        loop {
            rest = rest.trim_start();
            if let Some(after) = rest.strip_prefix('}') {
                return Some((attributes, text.len() - after.len()));
            }
            let end = rest.find(|c: char| ends_word(c) || c == '=')?;
            let (word, after) = rest.split_at(end);
            rest = after;
            if let Some(id) = word.strip_prefix('#').filter(|id| !id.is_empty()) {
                attributes.id = id.to_owned();
            } else if let Some(class) = word.strip_prefix('.').filter(|class| !class.is_empty()) {
                attributes.classes.push(class.to_owned());
            } else {
                let (value, after) = value(rest.strip_prefix('=')?)?;
                attributes.pairs.insert(word.to_owned(), value.to_owned());
                rest = after;
            }
        }
    }
}

/// Whether a letter can stand in no word of attributes. Brackets cannot: where one is never closed, the words behind it
/// would be read again from each of them.
fn ends_word(c: char) -> bool {
    c.is_whitespace() || matches!(c, '[' | ']' | '{' | '}')
}

/// The value of a pair and what follows it.
fn value(text: &str) -> Option<(&str, &str)> {
    if let Some(quoted) = text.strip_prefix('"') {
        return quoted.split_once('"');
    }
    let end = text.find(ends_word)?;
    (end > 0).then(|| text.split_at(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifier_classes_and_pairs_are_read() {
        let (attributes, length) =
            Attributes::parse(r#"{#fig:rays .wide alt="Two rays} meet" size=3} tail"#).unwrap();
        assert_eq!(attributes.id, "fig:rays");
        assert!(attributes.has("wide"));
        assert_eq!(attributes.value("alt"), "Two rays} meet");
        assert_eq!(attributes.value("size"), "3");
        assert_eq!(length, r#"{#fig:rays .wide alt="Two rays} meet" size=3}"#.len());
    }

    #[test]
    fn what_is_not_closed_is_not_attributes() {
        assert_eq!(Attributes::parse("{#eq:a"), None);
        assert_eq!(Attributes::parse("{{value a.b}}"), None);
        assert_eq!(Attributes::parse("{word}"), None);
        assert_eq!(Attributes::parse("{.a[b]{.c}"), None);
        assert_eq!(Attributes::parse("{a=b[c]{.d}"), None);
        assert_eq!(Attributes::whole("{.a} b"), None);
    }
}
