//! The public items of the library, and the page and anchor that rustdoc gives to each.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::Result;

use super::scan::{Entry, Kind, entries};
use crate::files;
use crate::pages::slashed;

/// The folder of the library's sources, below the root.
pub const SOURCES: &str = "code/src";

/// A public item.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Its path below the crate: `reprojection::Pinhole::project`.
    pub path: String,
    /// Its page and anchor, below `src`.
    pub page: String,
    /// The file it stands in, below the root.
    pub file: String,
    /// The line of its name.
    pub line: usize,
    /// Whether it is one of the things a reader looks up, and not a field or a variant.
    pub whole: bool,
}

/// A source file of the library.
#[derive(Debug)]
pub struct File {
    /// Below the root: `code/src/manifold/so3.rs`.
    pub name: String,
    /// The path of its module: `manifold`, `so3`.
    pub module: Vec<String>,
    /// What it says.
    pub text: String,
    entries: Vec<Entry>,
}

/// The library as the book sees it.
#[derive(Debug, Default)]
pub struct Library {
    /// The name of the crate; empty for a book without a library.
    pub name: String,
    /// Its files, in order.
    pub files: Vec<File>,
    items: BTreeMap<String, Item>,
}

impl Library {
    /// Reads the library of the cargo package; nothing when the package is nameless.
    pub fn read(root: &Path, package: &str) -> Result<Library> {
        let mut library = Library { name: package.replace('-', "_"), ..Library::default() };
        if package.is_empty() {
            return Ok(library);
        }
        let folder = root.join(SOURCES);
        for path in files::below(&folder)? {
            if path.extension().is_some_and(|end| end == "rs") {
                let text = files::read(&folder.join(&path))?;
                library.files.push(File {
                    name: format!("{SOURCES}/{}", slashed(&path)),
                    module: module_of(&path),
                    entries: entries(&text),
                    text,
                });
            }
        }
        library.items = items(&library.files, &library.name);
        Ok(library)
    }

    /// The public item of a path, which may begin with the name of the crate.
    pub fn item(&self, path: &str) -> Option<&Item> {
        let path = path.strip_prefix(&self.name).and_then(|p| p.strip_prefix("::")).unwrap_or(path);
        self.items.get(path)
    }

    /// The page of the whole library, below `src`.
    pub fn front(&self) -> String {
        format!("api/{}/index.html", self.name)
    }

    /// The items whose names stand on the lines of a file from `first` to `last`.
    pub fn shown(&self, file: &str, first: usize, last: usize) -> Vec<&Item> {
        let mut shown: Vec<&Item> = self
            .items
            .values()
            .filter(|item| item.whole && item.file == file && (first..=last).contains(&item.line))
            .collect();
        shown.sort_by_key(|item| (item.line, item.path.len()));
        shown.dedup_by_key(|item| item.line);
        shown
    }

    /// The path that resembles one that is not there.
    pub fn like(&self, path: &str) -> Option<&str> {
        let likeness = |known: &str| strsim::normalized_damerau_levenshtein(known, path);
        let known = self.items.keys().map(|known| (known, likeness(known)));
        known
            .filter(|(_, ratio)| *ratio > 0.6)
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(known, _)| known.as_str())
    }
}

/// The path of the module that a file holds.
fn module_of(path: &Path) -> Vec<String> {
    let name = slashed(&path.with_extension(""));
    let mut module: Vec<String> = name.split('/').map(str::to_owned).collect();
    if module.last().is_some_and(|last| ["mod", "lib"].contains(&last.as_str())) {
        module.pop();
    }
    module
}

/// A module's own or borrowed items while it is not known yet who can see them.
struct Named<'a> {
    file: &'a File,
    entry: &'a Entry,
    parent: Option<&'a Entry>,
}

/// All public items by path.
fn items(files: &[File], name: &str) -> BTreeMap<String, Item> {
    let public = public_modules(files);
    let mut items = BTreeMap::new();
    let root = BTreeSet::from([String::new()]);
    for path in public.iter().chain(&root) {
        let front = page(name, path, "index.html");
        let file = files.iter().find(|file| file.module.join("::") == *path);
        if let Some(file) = file.filter(|_| !path.is_empty()) {
            let item = Item {
                path: path.clone(),
                page: front,
                file: file.name.clone(),
                line: 0,
                whole: true,
            };
            items.insert(path.clone(), item);
        }
    }
    let named: Vec<Named<'_>> = files
        .iter()
        .flat_map(|file| {
            file.entries.iter().map(move |entry| Named {
                file,
                entry,
                parent: entry.parent.map(|parent| &file.entries[parent]),
            })
        })
        .collect();
    let visible = |module: &str| module.is_empty() || public.contains(module);
    // Where an item of a private module is shown: in the module that hands it on.
    let mut shown_in: BTreeMap<(String, String), String> = BTreeMap::new();
    for Named { file, entry, .. } in named.iter().filter(|named| named.entry.kind == Kind::Use) {
        let module = file.module.join("::");
        for (from, what) in used(&entry.name, &module) {
            if visible(&module) && !visible(&from) {
                shown_in.insert((from, what), module.clone());
            }
        }
    }
    let home = |file: &File, name: &str| {
        let module = file.module.join("::");
        if visible(&module) {
            return Some(module);
        }
        let everything = || shown_in.get(&(module.clone(), "*".to_owned()));
        shown_in.get(&(module.clone(), name.to_owned())).or_else(everything).cloned()
    };
    let place = |file: &File, entry: &Entry, path: String, page: String| Item {
        path,
        page,
        file: file.name.clone(),
        line: entry.line,
        whole: !matches!(entry.kind, Kind::Field | Kind::Variant),
    };
    // The types first: their members stand on their pages.
    let mut types: BTreeMap<(String, String), String> = BTreeMap::new();
    for Named { file, entry, parent } in &named {
        let (Some(word), None, true) = (word(entry.kind), parent, entry.public) else { continue };
        let Some(module) = home(file, &entry.name) else { continue };
        let path = joined(&module, &entry.name);
        let page = page(name, &module, &format!("{word}.{}.html", entry.name));
        types.insert((file.module.join("::"), entry.name.clone()), path.clone());
        items.insert(path.clone(), place(file, entry, path, page));
    }
    for Named { file, entry, parent } in &named {
        let Some(parent) = parent else { continue };
        let module = file.module.join("::");
        let owner = types.get(&(module, parent.name.clone())).or_else(|| {
            types.iter().find(|((_, name), _)| *name == parent.name).map(|(_, path)| path)
        });
        let (Some(owner), Some(anchor)) = (owner, anchor(entry, parent)) else { continue };
        let path = joined(owner, &entry.name);
        let page = format!("{}#{anchor}", items[owner].page);
        items.entry(path.clone()).or_insert_with(|| place(file, entry, path, page));
    }
    items
}

/// The paths of the modules that can be named from outside.
fn public_modules(files: &[File]) -> BTreeSet<String> {
    let mut public = BTreeSet::from([String::new()]);
    let mut order: Vec<&File> = files.iter().collect();
    order.sort_by_key(|file| file.module.len());
    for file in order {
        let module = file.module.join("::");
        if public.contains(&module) {
            let inner = file.entries.iter().filter(|entry| {
                entry.kind == Kind::Module && entry.public && entry.parent.is_none()
            });
            public.extend(inner.map(|entry| joined(&module, &entry.name)));
        }
    }
    public.remove("");
    public
}

fn joined(module: &str, name: &str) -> String {
    if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") }
}

/// A page of a module, below `src`.
fn page(library: &str, module: &str, file: &str) -> String {
    let folder = module.replace("::", "/");
    let slash = if folder.is_empty() { "" } else { "/" };
    format!("api/{library}/{folder}{slash}{file}")
}

/// How rustdoc begins the name of a page.
fn word(kind: Kind) -> Option<&'static str> {
    Some(match kind {
        Kind::Function => "fn",
        Kind::Struct => "struct",
        Kind::Enum => "enum",
        Kind::Union => "union",
        Kind::Trait => "trait",
        Kind::Constant => "constant",
        Kind::Static => "static",
        Kind::Type => "type",
        _ => return None,
    })
}

/// The anchor of a member on the page of its type or trait, when it can be seen.
fn anchor(entry: &Entry, parent: &Entry) -> Option<String> {
    let of_trait = matches!(parent.kind, Kind::Trait | Kind::Impl { of_trait: true });
    let word = match (entry.kind, parent.kind) {
        (Kind::Variant, Kind::Enum) => "variant",
        _ if !(entry.public || of_trait) => return None,
        (Kind::Field, Kind::Struct | Kind::Union) => "structfield",
        (Kind::Function, Kind::Trait) if !entry.body => "tymethod",
        (Kind::Function, Kind::Trait | Kind::Impl { .. }) => "method",
        (Kind::Constant, Kind::Trait | Kind::Impl { .. }) => "associatedconstant",
        (Kind::Type, Kind::Trait | Kind::Impl { .. }) => "associatedtype",
        _ => return None,
    };
    Some(format!("{word}.{}", entry.name))
}

/// What a `pub use` names: the module it lies in, and its name, which may be `*`.
fn used(path: &str, module: &str) -> Vec<(String, String)> {
    let (from, names) = match path.split_once('{') {
        Some((from, names)) => (from.trim_end_matches("::"), names.trim_end_matches('}')),
        None => path.rsplit_once("::").unwrap_or(("", path)),
    };
    let from = match from.strip_prefix("crate::") {
        Some(from) => from.to_owned(),
        None => joined(module, from.strip_prefix("self::").unwrap_or(from)),
    };
    names
        .split(',')
        .map(|name| (from.clone(), name.trim().to_owned()))
        .filter(|(_, name)| !name.is_empty())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(files: &[(&str, &str)]) -> BTreeMap<String, Item> {
        let file = |(name, text): &(&str, &str)| File {
            name: format!("{SOURCES}/{name}"),
            module: module_of(Path::new(name)),
            entries: entries(text),
            text: (*text).to_owned(),
        };
        items(&files.iter().map(file).collect::<Vec<_>>(), "lib")
    }

    #[test]
    fn items_have_the_pages_that_rustdoc_gives_them() {
        let items = library(&[
            ("lib.rs", "pub mod a;\nmod hidden;\npub fn top() {}\n"),
            (
                "a/mod.rs",
                "mod inner;\npub mod open;\npub use inner::{Given, give};\npub trait Camera {\n    fn must(&self);\n    fn may(&self) {\n    }\n}\n",
            ),
            (
                "a/inner.rs",
                "pub struct Given {\n    pub x: f64,\n}\nimpl Given {\n    pub const N: f64 = 1.0;\n    pub fn new() -> Self {\n    }\n    fn own() {}\n}\npub fn give() {}\npub fn kept() {}\n",
            ),
            ("a/open.rs", "pub const X: f64 = 0.0;\n"),
            ("hidden.rs", "pub fn unseen() {}\n"),
        ]);
        let page = |path: &str| items.get(path).map(|item| item.page.as_str());
        assert_eq!(page("top"), Some("api/lib/fn.top.html"));
        assert_eq!(page("a"), Some("api/lib/a/index.html"));
        assert_eq!(page("a::open::X"), Some("api/lib/a/open/constant.X.html"));
        assert_eq!(page("a::Camera::must"), Some("api/lib/a/trait.Camera.html#tymethod.must"));
        assert_eq!(page("a::Camera::may"), Some("api/lib/a/trait.Camera.html#method.may"));
        assert_eq!(page("a::Given::new"), Some("api/lib/a/struct.Given.html#method.new"));
        assert_eq!(page("a::Given::x"), Some("api/lib/a/struct.Given.html#structfield.x"));
        assert_eq!(page("a::Given::N"), Some("api/lib/a/struct.Given.html#associatedconstant.N"));
        assert_eq!(page("a::give"), Some("api/lib/a/fn.give.html"));
        for unseen in ["a::Given::own", "hidden::unseen", "a::inner::kept", "hidden", "a::inner"] {
            assert_eq!(page(unseen), None, "{unseen}");
        }
    }
}
