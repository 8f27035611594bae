//! The names in some tokens.

use std::collections::BTreeSet;

use anyhow::{Context, Result, bail};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::LitStr;

use super::Names;

/// What some tokens say.
#[derive(Clone, Default)]
pub(super) struct Words {
    pub(super) text: String,
    pub(super) paths: BTreeSet<Names>,
    /// Macros it calls.
    pub(super) calls: BTreeSet<String>,
    /// Files it includes, relative to the folder of its file.
    pub(super) included: BTreeSet<String>,
}

impl Words {
    /// Takes in some tokens. An implementation may begin where `items` says so; its head goes to `heads`.
    pub(super) fn take(
        &mut self,
        tokens: TokenStream,
        items: bool,
        heads: &mut Vec<Vec<Names>>,
    ) -> Result<()> {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            let before = &tokens[..at];
            if let (Some('#'), Some(TokenTree::Group(attribute))) =
                (sign(Some(token)), tokens.get(at + 1))
                && name_of(attribute.stream().into_iter().next().as_ref()).as_deref() == Some("doc")
            {
                at += 2;
                continue;
            }
            match token {
                TokenTree::Group(group) => {
                    let items =
                        group.delimiter() == Delimiter::Brace || sign(before.last()) == Some('$');
                    self.text.push_str(&format!("{:?} ", group.delimiter()));
                    self.take(group.stream(), items, heads)?;
                    self.text.push_str("end ");
                }
                TokenTree::Ident(word) => {
                    let (names, length) = path(&tokens[at..]);
                    if word == "impl" && begins_item(before, items) {
                        let head = tokens[at..].iter().position(is_braces);
                        let head = &tokens[at + 1..head.map_or(tokens.len(), |head| at + head)];
                        heads.push(head_paths(head));
                    }
                    for token in &tokens[at..at + length] {
                        self.text.push_str(&format!("{token} "));
                    }
                    at += length - 1;
                    if sign(tokens.get(at + 1)) == Some('!')
                        && let (Some(name), Some(TokenTree::Group(given))) =
                            (names.last(), tokens.get(at + 2))
                    {
                        self.call(name, given.stream())?;
                    }
                    let is_method = sign(before.last()) == Some('.')
                        && sign(before.len().checked_sub(2).and_then(|at| before.get(at)))
                            != Some('.');
                    if !is_method {
                        self.paths.insert(names);
                    }
                }
                other => self.text.push_str(&format!("{other} ")),
            }
            at += 1;
        }
        Ok(())
    }

    fn call(&mut self, name: &str, given: TokenStream) -> Result<()> {
        match name {
            "include" => bail!("the press cannot follow include!: make the file a module"),
            "include_str" | "include_bytes" => {
                let file = syn::parse2::<LitStr>(given.into_iter().take(1).collect()).ok();
                let file = file
                    .context("the press cannot follow an included file whose path is computed")?;
                self.included.insert(file.value());
            }
            name => drop(self.calls.insert(name.to_owned())),
        }
        Ok(())
    }
}

/// Whether `impl` after these tokens begins an implementation, and not a type.
pub(super) fn begins_item(before: &[TokenTree], items: bool) -> bool {
    match before {
        [] => items,
        [.., TokenTree::Punct(sign), TokenTree::Group(attribute)]
            if attribute.delimiter() == Delimiter::Bracket =>
        {
            sign.as_char() == '#'
        }
        // A repetition of a macro ends with one of the signs.
        [.., last] => {
            is_braces(last)
                || sign(Some(last)).is_some_and(|sign| ";*+?".contains(sign))
                || name_of(Some(last)).is_some_and(|word| word == "unsafe")
        }
    }
}

/// The paths in the head of an implementation.
pub(super) fn head_paths(tokens: &[TokenTree]) -> Vec<Names> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        match token {
            // `$name` stands for something that is not known here.
            TokenTree::Ident(_) if at > 0 && sign(tokens.get(at - 1)) == Some('$') => at += 1,
            TokenTree::Ident(_) => {
                let (names, length) = path(&tokens[at..]);
                found.push(names);
                at += length;
            }
            TokenTree::Group(group) => {
                let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                found.extend(head_paths(&inner));
                at += 1;
            }
            _ => at += 1,
        }
    }
    found
}

/// The path that begins with the name at the start of some tokens, and its length.
pub(super) fn path(tokens: &[TokenTree]) -> (Names, usize) {
    let mut names: Names = name_of(tokens.first()).into_iter().collect();
    let mut length = 1;
    while sign(tokens.get(length)) == Some(':') && sign(tokens.get(length + 1)) == Some(':') {
        let Some(name) = name_of(tokens.get(length + 2)) else { break };
        names.push(name);
        length += 3;
    }
    (names, length)
}

pub(super) fn name_of(token: Option<&TokenTree>) -> Option<String> {
    match token {
        Some(TokenTree::Ident(name)) => Some(name.to_string()),
        _ => None,
    }
}

pub(super) fn sign(token: Option<&TokenTree>) -> Option<char> {
    match token {
        Some(TokenTree::Punct(sign)) => Some(sign.as_char()),
        _ => None,
    }
}

pub(super) fn is_braces(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace)
}
