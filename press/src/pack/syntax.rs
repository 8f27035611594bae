//! How a PDF is written: dictionaries, lists, names, and what refers to others.

use std::collections::BTreeMap;

/// What a PDF consists of.
#[derive(Clone, Debug, PartialEq)]
pub enum Object {
    Dictionary(BTreeMap<String, Object>),
    Array(Vec<Object>),
    Name(String),
    Text(String),
    Reference(usize),
    /// Numbers and the like.
    Word(String),
}

impl Object {
    /// An entry of a dictionary.
    pub fn get(&self, key: &str) -> Option<&Object> {
        match self {
            Object::Dictionary(entries) => entries.get(key),
            _ => None,
        }
    }
}

/// A place in a document, from which on it is read.
pub struct Text<'a> {
    /// The document.
    pub bytes: &'a [u8],
    /// The place.
    pub at: usize,
}

impl Text<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn take(&mut self) -> Option<u8> {
        let byte = self.peek()?;
        self.at += 1;
        Some(byte)
    }

    fn skip_space(&mut self) {
        while self.peek().is_some_and(|byte| byte.is_ascii_whitespace() || byte == 0) {
            self.at += 1;
        }
    }

    fn starts_with(&self, pattern: &[u8]) -> bool {
        self.bytes[self.at.min(self.bytes.len())..].starts_with(pattern)
    }

    /// Letters and digits up to the next delimiter.
    pub fn word(&mut self) -> Option<String> {
        self.skip_space();
        let start = self.at;
        while self
            .peek()
            .is_some_and(|byte| !byte.is_ascii_whitespace() && !b"/<>[]()\0".contains(&byte))
        {
            self.at += 1;
        }
        let word = self.bytes.get(start..self.at)?;
        (!word.is_empty()).then(|| String::from_utf8_lossy(word).into_owned())
    }

    /// The next object, if it is one.
    pub fn object(&mut self) -> Option<Object> {
        self.skip_space();
        match self.peek()? {
            b'/' => self.name().map(Object::Name),
            b'[' => {
                self.at += 1;
                self.array()
            }
            b'(' => {
                self.at += 1;
                self.text()
            }
            b'<' if self.starts_with(b"<<") => {
                self.at += 2;
                self.dictionary()
            }
            b'<' => {
                while self.take()? != b'>' {}
                Some(Object::Word(String::new()))
            }
            _ => self.word_or_reference(),
        }
    }

    fn name(&mut self) -> Option<String> {
        self.at += 1;
        let written = self.word().unwrap_or_default();
        let mut parts = written.split('#');
        let mut name = parts.next().unwrap_or_default().as_bytes().to_vec();
        for part in parts {
            let (code, rest) = part.split_at_checked(2)?;
            name.push(u8::from_str_radix(code, 16).ok()?);
            name.extend(rest.as_bytes());
        }
        Some(String::from_utf8_lossy(&name).into_owned())
    }

    fn array(&mut self) -> Option<Object> {
        let mut items = Vec::new();
        loop {
            self.skip_space();
            if self.peek()? == b']' {
                self.at += 1;
                return Some(Object::Array(items));
            }
            items.push(self.object()?);
        }
    }

    fn dictionary(&mut self) -> Option<Object> {
        let mut entries = BTreeMap::new();
        loop {
            self.skip_space();
            if self.starts_with(b">>") {
                self.at += 2;
                return Some(Object::Dictionary(entries));
            }
            if self.peek()? != b'/' {
                return None;
            }
            let name = self.name()?;
            entries.insert(name, self.object()?);
        }
    }

    /// Text in parentheses, which may hold others.
    fn text(&mut self) -> Option<Object> {
        let mut text = Vec::new();
        let mut open = 0;
        loop {
            match self.take()? {
                b'\\' => text.push(self.take()?),
                b')' if open == 0 => {
                    return Some(Object::Text(String::from_utf8_lossy(&text).into_owned()));
                }
                byte => {
                    open += i32::from(byte == b'(') - i32::from(byte == b')');
                    text.push(byte);
                }
            }
        }
    }

    /// `12 0 R` is a reference, and `12` alone a number.
    fn word_or_reference(&mut self) -> Option<Object> {
        let word = self.word()?;
        let after = self.at;
        if let Ok(number) = word.parse() {
            if self.word().is_some_and(|word| word == "0")
                && self.word().is_some_and(|word| word == "R")
            {
                return Some(Object::Reference(number));
            }
            self.at = after;
        }
        Some(Object::Word(word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(text: &str) -> Option<Object> {
        Text { bytes: text.as_bytes(), at: 0 }.object()
    }

    #[test]
    fn references_numbers_names_and_texts_are_told_apart() {
        let word = |text: &str| Object::Word(text.to_owned());
        let expected = vec![
            Object::Reference(12),
            word("12"),
            word("-0.5"),
            Object::Name("eq:a b".to_owned()),
            Object::Text("a (b) )".to_owned()),
            word("null"),
        ];
        let read = object("[12 0 R 12 -0.5/eq#3aa#20b (a (b) \\))\nnull]");
        assert_eq!(read, Some(Object::Array(expected)));
    }

    #[test]
    fn what_ends_too_early_is_no_object() {
        for text in ["", "[1 2", "<</A 1", "(a", "<0A", "<</A 1 2>>", "/a#"] {
            assert_eq!(object(text), None, "{text}");
        }
    }
}
