//! Finds what a Rust file shows to others, and how rustdoc begins the name of the page or anchor of each item.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use proc_macro2::Ident;
use syn::spanned::Spanned;
use syn::{Attribute, Field, ImplItem, Item, ItemImpl, TraitItem, Type, UseTree, Visibility};

/// An item that has a page of its own, or a place on the page of its type or trait.
#[derive(Debug)]
pub struct Entry {
    /// How rustdoc begins the name of its page or anchor: `struct`, `tymethod`.
    pub word: &'static str,
    pub name: String,
    /// Whether whoever sees its module, or its type or trait, sees it too.
    pub public: bool,
    /// The line that its description begins on, or its attributes, counted from 1.
    pub first: usize,
    /// The line of its name.
    pub line: usize,
    /// The line that it ends on.
    pub last: usize,
    /// The name of its type or trait.
    pub owner: Option<String>,
}

/// What a file holds.
#[derive(Debug, Default)]
pub struct Scan {
    /// The items, in order.
    pub entries: Vec<Entry>,
    /// The names of its public modules.
    pub modules: Vec<String>,
    /// What `pub use` hands on, a path each, whose last name may be `*`.
    pub handed_on: Vec<Vec<String>>,
}

impl Scan {
    /// Finds nothing in a file that is not Rust: what is wrong with it the compiler says better.
    pub fn of(source: &str) -> Scan {
        let mut scan = Scan::default();
        let items = syn::parse_file(source).map(|file| file.items).unwrap_or_default();
        items.iter().for_each(|item| scan.take(item));
        scan
    }

    /// What is in a file. Whoever serves the book asks again and again for files that did not change.
    pub fn of_file(name: &str, source: &str) -> Arc<Scan> {
        static KNOWN: Mutex<BTreeMap<String, (String, Arc<Scan>)>> = Mutex::new(BTreeMap::new());
        let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, same)) = known().get(name).filter(|(known, _)| known == source) {
            return same.clone();
        }
        let scan = Arc::new(Scan::of(source));
        known().insert(name.to_owned(), (source.to_owned(), scan.clone()));
        scan
    }

    fn take(&mut self, item: &Item) {
        let (word, attributes, vis, name) = match item {
            Item::Fn(item) => ("fn", &item.attrs, &item.vis, &item.sig.ident),
            Item::Struct(item) => ("struct", &item.attrs, &item.vis, &item.ident),
            Item::Enum(item) => ("enum", &item.attrs, &item.vis, &item.ident),
            Item::Union(item) => ("union", &item.attrs, &item.vis, &item.ident),
            Item::Trait(item) => ("trait", &item.attrs, &item.vis, &item.ident),
            Item::Const(item) => ("constant", &item.attrs, &item.vis, &item.ident),
            Item::Static(item) => ("static", &item.attrs, &item.vis, &item.ident),
            Item::Type(item) => ("type", &item.attrs, &item.vis, &item.ident),
            Item::Impl(item) => return self.take_impl(item),
            Item::Mod(item) if is_public(&item.vis) => {
                return self.modules.push(item.ident.to_string());
            }
            Item::Use(item) if is_public(&item.vis) => return self.hand_on(&item.tree, &[]),
            _ => return,
        };
        self.add(word, attributes, is_public(vis), name, None, item);
        match item {
            Item::Struct(item) => self.take_fields(&item.fields, name),
            Item::Union(item) => self.take_fields(&item.fields.named, name),
            Item::Enum(item) => item.variants.iter().for_each(|variant| {
                self.add("variant", &variant.attrs, true, &variant.ident, Some(name), variant);
            }),
            Item::Trait(item) => item.items.iter().for_each(|member| {
                let (word, attributes, inner) = match member {
                    TraitItem::Fn(inner) => {
                        let word = if inner.default.is_some() { "method" } else { "tymethod" };
                        (word, &inner.attrs, &inner.sig.ident)
                    }
                    TraitItem::Const(inner) => ("associatedconstant", &inner.attrs, &inner.ident),
                    TraitItem::Type(inner) => ("associatedtype", &inner.attrs, &inner.ident),
                    _ => return,
                };
                self.add(word, attributes, true, inner, Some(name), member);
            }),
            _ => {}
        }
    }

    fn take_impl(&mut self, item: &ItemImpl) {
        let Type::Path(of) = &*item.self_ty else { return };
        let of = of.path.segments.last().map(|segment| &segment.ident);
        for inner in &item.items {
            let (word, attributes, vis, name) = match inner {
                ImplItem::Fn(inner) => ("method", &inner.attrs, &inner.vis, &inner.sig.ident),
                ImplItem::Const(inner) => {
                    ("associatedconstant", &inner.attrs, &inner.vis, &inner.ident)
                }
                ImplItem::Type(inner) => ("associatedtype", &inner.attrs, &inner.vis, &inner.ident),
                _ => continue,
            };
            let public = item.trait_.is_some() || is_public(vis);
            self.add(word, attributes, public, name, of, inner);
        }
    }

    fn take_fields<'a>(&mut self, fields: impl IntoIterator<Item = &'a Field>, of: &Ident) {
        for field in fields {
            if let Some(name) = &field.ident {
                let public = is_public(&field.vis);
                self.add("structfield", &field.attrs, public, name, Some(of), field);
            }
        }
    }

    fn hand_on(&mut self, tree: &UseTree, before: &[String]) {
        let below = |name: &Ident| [before, &[name.to_string()]].concat();
        match tree {
            UseTree::Path(path) => self.hand_on(&path.tree, &below(&path.ident)),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.hand_on(tree, before)),
            UseTree::Name(name) => self.handed_on.push(below(&name.ident)),
            UseTree::Glob(_) => self.handed_on.push([before, &["*".to_owned()]].concat()),
            // Its page would bear the other name.
            _ => {}
        }
    }

    fn add(
        &mut self,
        word: &'static str,
        attributes: &[Attribute],
        public: bool,
        name: &Ident,
        owner: Option<&Ident>,
        whole: &impl Spanned,
    ) {
        let line = name.span().start().line;
        let first = attributes.first().map_or(line, |first| first.span().start().line);
        let last = whole.span().end().line;
        let (name, owner) = (name.to_string(), owner.map(Ident::to_string));
        self.entries.push(Entry { word, name, public, first, line, last, owner });
    }
}

fn is_public(vis: &Visibility) -> bool {
    matches!(vis, Visibility::Public(_))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_found_with_their_lines() {
        let source = "\
//! About.

/// A matrix
/// of a vector.
#[inline]
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
        let scan = Scan::of(source);
        let found: Vec<_> = scan
            .entries
            .iter()
            .map(|entry| {
                let lines = [entry.first, entry.line, entry.last];
                (entry.word, entry.name.as_str(), lines, entry.public)
            })
            .collect();
        assert_eq!(
            found,
            [
                ("fn", "hat", [3, 6, 13], true),
                ("constant", "TABLE", [15, 15, 18], true),
                ("fn", "hidden", [19, 19, 19], false),
            ]
        );
        assert_eq!(scan.modules, ["so3"]);
    }

    #[test]
    fn members_know_what_they_belong_to() {
        let source = "\
pub struct Pinhole<const D: usize> { pub fx: f64 }

impl<const D: usize> Camera<D> for inner::Pinhole<D> {
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
    One, deeper::*,
};
";
        let scan = Scan::of(source);
        let member = |entry: &Entry| {
            let owner = entry.owner.clone()?;
            Some(format!("{owner} {} {} {}", entry.word, entry.name, entry.public))
        };
        assert_eq!(
            scan.entries.iter().filter_map(member).collect::<Vec<_>>(),
            [
                "Pinhole structfield fx true",
                "Pinhole method project true",
                "Error variant Bad true",
                "Error variant Worse true",
            ]
        );
        let handed_on: Vec<String> = scan.handed_on.iter().map(|path| path.join("::")).collect();
        assert_eq!(handed_on, ["inner::One", "inner::deeper::*"]);
    }
}
