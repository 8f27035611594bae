//! What a file of Rust has: its items, and what it brings in.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

use anyhow::{Context, Result};
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::{Attribute, Expr, ExprLit, Item, Lit, Meta};

use super::words::{Words, name_of, sign};
use super::{Crate, File, Kind, Names, Piece};
use crate::files;
use crate::pages::slashed;

/// A file while it is read.
#[derive(Clone)]
pub(super) struct Reading {
    pub(super) file: File,
    pub(super) header: Words,
    /// The items, with module and name.
    pub(super) items: Vec<(Names, String, Piece)>,
    /// The modules that `#[path]` places elsewhere, with their files.
    pub(super) placed: Vec<(Names, PathBuf)>,
}

impl Reading {
    /// Whoever serves the book asks again and again for files that did not change.
    pub(super) fn known_or_of(
        path: &Path,
        module: &Names,
        text: String,
        lines: bool,
    ) -> Result<Reading> {
        static KNOWN: Mutex<BTreeMap<PathBuf, Reading>> = Mutex::new(BTreeMap::new());
        let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let same = known().get(path).filter(|known| known.file.text == text).cloned();
        if let Some(same) = same {
            return Ok(same);
        }
        let reading = Reading::of(path, module, text, lines)?;
        known().insert(path.to_path_buf(), reading.clone());
        Ok(reading)
    }

    fn of(path: &Path, module: &Names, text: String, lines: bool) -> Result<Reading> {
        let parsed = syn::parse_file(&text);
        let file = File {
            path: path.to_path_buf(),
            scopes: Vec::new(),
            imports: HashMap::new(),
            globs: Vec::new(),
            header: 0,
            near: OnceLock::new(),
            text,
            lines,
            entries: BTreeMap::new(),
        };
        let mut reading =
            Reading { file, header: Words::default(), items: Vec::new(), placed: Vec::new() };
        match parsed {
            Ok(parsed) => reading.take_module(module.clone(), parsed.items)?,
            // What is wrong with it the compiler says better; until then it may define anything.
            Err(_) => {
                reading.file.scopes.push(module.clone());
                let words = Words { text: reading.file.text.clone(), ..Words::default() };
                let piece = Piece { file: 0, kind: Kind::Call, words, heads: vec![Vec::new()] };
                reading.items.push((module.clone(), String::new(), piece));
            }
        }
        Ok(reading)
    }

    /// The modules that lie in other places than their names say.
    pub(super) fn elsewhere(&self) -> Vec<(Names, PathBuf, bool)> {
        let placed = self.placed.iter();
        placed.map(|(module, path)| (module.clone(), path.clone(), self.file.lines)).collect()
    }

    fn take_module(&mut self, module: Names, items: Vec<Item>) -> Result<()> {
        self.file.scopes.push(module.clone());
        for item in items {
            self.take(&module, item)?;
        }
        Ok(())
    }

    fn take(&mut self, module: &Names, item: Item) -> Result<()> {
        let tokens = item.to_token_stream();
        let (kind, name, attributes) = match item {
            Item::Mod(inner) if is_for_tests(&inner.attrs) => return Ok(()),
            Item::Mod(inner) => {
                let below = [&module[..], &[inner.ident.to_string()]].concat();
                match (inner.content, placed(&inner.attrs)) {
                    (Some((_, items)), _) => self.take_module(below, items)?,
                    (None, Some(file)) => {
                        self.placed.push((below, beside(&self.file.path, &file)?))
                    }
                    (None, None) => {}
                }
                return Ok(());
            }
            Item::Const(item) if item.ident == "CHAPTERS" => return self.take_table(&item.expr),
            Item::Use(item) => {
                if !is_for_tests(&item.attrs) {
                    self.header.text.push_str(&tokens.to_string());
                    self.take_uses(tokens);
                }
                return Ok(());
            }
            Item::Fn(item) => (Kind::Other, item.sig.ident.to_string(), item.attrs),
            Item::Struct(item) => (Kind::Type, item.ident.to_string(), item.attrs),
            Item::Enum(item) => (Kind::Type, item.ident.to_string(), item.attrs),
            Item::Union(item) => (Kind::Type, item.ident.to_string(), item.attrs),
            Item::Trait(item) => (Kind::Trait, item.ident.to_string(), item.attrs),
            Item::Const(item) => (Kind::Other, item.ident.to_string(), item.attrs),
            Item::Static(item) => (Kind::Other, item.ident.to_string(), item.attrs),
            Item::Type(item) => (Kind::Other, item.ident.to_string(), item.attrs),
            Item::Impl(item) => (Kind::Impl, String::new(), item.attrs),
            Item::Macro(item) => match item.ident {
                Some(name) => (Kind::Macro, name.to_string(), item.attrs),
                None => (Kind::Call, String::new(), item.attrs),
            },
            _ => (Kind::Call, String::new(), Vec::new()),
        };
        if is_for_tests(&attributes) {
            return Ok(());
        }
        let mut words = Words::default();
        let mut heads = Vec::new();
        words.take(tokens.clone(), true, &mut heads)?;
        self.take_uses(tokens);
        self.items.push((module.clone(), name, Piece { file: 0, kind, words, heads }));
        Ok(())
    }

    /// The entries of the table.
    fn take_table(&mut self, table: &Expr) -> Result<()> {
        let table = match table {
            Expr::Reference(reference) => &*reference.expr,
            other => other,
        };
        let Expr::Array(table) = table else { return Ok(()) };
        for entry in &table.elems {
            if let Expr::Tuple(entry) = entry
                && let Some(Expr::Lit(ExprLit { lit: Lit::Str(name), .. })) = entry.elems.first()
            {
                let mut words = Words::default();
                words.take(entry.to_token_stream(), false, &mut Vec::new())?;
                self.file.entries.insert(name.value(), words);
            }
        }
        Ok(())
    }

    /// Every `use` in some tokens, in functions as well.
    fn take_uses(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        for (at, token) in tokens.iter().enumerate() {
            match token {
                TokenTree::Ident(word)
                    if word == "use" && sign(tokens.get(at + 1)) != Some('<') =>
                {
                    let end = tokens[at..].iter().position(|token| sign(Some(token)) == Some(';'));
                    let end = end.map_or(tokens.len(), |end| at + end);
                    self.take_use(&[], &tokens[at + 1..end]);
                }
                TokenTree::Group(group) => self.take_uses(group.stream()),
                _ => {}
            }
        }
    }

    /// What `use` says below `before`.
    fn take_use(&mut self, before: &[String], tree: &[TokenTree]) {
        for one in tree.split(|token| sign(Some(token)) == Some(',')).filter(|one| !one.is_empty())
        {
            let mut names = before.to_vec();
            let mut alias = None;
            for (at, token) in one.iter().enumerate() {
                match token {
                    TokenTree::Ident(name) if name == "as" => {
                        alias = name_of(one.get(at + 1));
                        break;
                    }
                    TokenTree::Ident(name) => names.push(name.to_string()),
                    TokenTree::Group(group) => {
                        let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                        self.take_use(&names, &inner);
                        names.clear();
                    }
                    TokenTree::Punct(sign) if sign.as_char() == '*' => {
                        self.file.globs.push(std::mem::take(&mut names));
                    }
                    _ => {}
                }
            }
            if names.len() > 1 && names.last().is_some_and(|last| last == "self") {
                names.pop();
            }
            if let Some(name) = alias.or_else(|| names.last().cloned()) {
                self.file.imports.entry(name).or_default().push(names);
            }
        }
    }
}

/// A file named relative to the folder of another one.
pub(super) fn beside(path: &Path, name: &str) -> Result<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = files::joined(folder, name);
    file.with_context(|| format!("{} takes in {name}, which is not in the book", slashed(path)))
}

/// The path of the module that a file holds.
pub(super) fn module(member: &Crate<'_>, path: &Path) -> Names {
    let below = path.strip_prefix(member.folder).unwrap_or(path).with_extension("");
    let mut module = vec![member.name.to_owned()];
    module.extend(below.components().map(|part| part.as_os_str().to_string_lossy().into_owned()));
    let last = module.last().map(String::as_str);
    if last == Some("mod") || module.len() == 2 && matches!(last, Some("lib" | "main")) {
        module.pop();
    }
    module
}

fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && matches!(&attribute.meta, Meta::List(list) if list.tokens.to_string() == "test")
    })
}

/// The file that `#[path = "…"]` names.
fn placed(attributes: &[Attribute]) -> Option<String> {
    let attribute = attributes.iter().find(|attribute| attribute.path().is_ident("path"))?;
    match &attribute.meta.require_name_value().ok()?.value {
        Expr::Lit(ExprLit { lit: Lit::Str(file), .. }) => Some(file.value()),
        _ => None,
    }
}
