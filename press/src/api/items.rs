//! The public items of the library, and the page and anchor that rustdoc gives to each.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Result;
use rayon::prelude::*;

use super::scan::{Entry, Scan};
use crate::files;
use crate::pages::{nearest, slashed};

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
    /// The line that its description begins on.
    first: usize,
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
    scan: Arc<Scan>,
}

/// The code of a function, or of anything else that has a name, whether public or not.
#[derive(Clone, Debug, PartialEq)]
pub struct Code<'a> {
    /// Its path below the crate, through the modules that its file lies in: `reprojection::pinhole::Pinhole::project`.
    pub path: String,
    /// The file it stands in, below the root.
    pub file: &'a str,
    /// The line of its name.
    pub first: usize,
    /// The line that it ends on.
    pub last: usize,
    /// Whether it is a function.
    is_function: bool,
    /// The lines of the file.
    text: &'a str,
}

impl Code<'_> {
    /// The lines that have a text, those of comments excepted.
    pub fn lines_with(&self, text: &str) -> Vec<usize> {
        let numbered = (1..).zip(self.text.lines());
        let own = numbered.skip(self.first - 1).take(self.last + 1 - self.first);
        let has = |line: &str| line.contains(text) && !line.trim_start().starts_with("//");
        own.filter(|(_, line)| has(line)).map(|(number, _)| number).collect()
    }
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
        let mut paths = files::below(&folder)?;
        paths.retain(|path| path.extension().is_some_and(|end| end == "rs"));
        let read = |path: &PathBuf| Ok(File::new(path, files::read(&folder.join(path))?));
        library.files = paths.par_iter().map(read).collect::<Result<_>>()?;
        library.items = items(&library.files, &library.name);
        Ok(library)
    }

    /// The public item of a path, which may begin with the name of the crate.
    pub fn item(&self, path: &str) -> Option<&Item> {
        let path = path.strip_prefix(&self.name).and_then(|p| p.strip_prefix("::")).unwrap_or(path);
        self.items.get(path)
    }

    /// All public items.
    pub fn items(&self) -> impl Iterator<Item = &Item> {
        self.items.values()
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

    /// The item whose description has a line of a file, when it is one of the things a reader looks up.
    pub fn described(&self, file: &str, line: usize) -> Option<&Item> {
        let has = |item: &&Item| item.file == file && (item.first..item.line).contains(&line);
        self.items.values().find(|item| item.whole && has(item))
    }

    /// The code that a path means: a public item's, or that of everything whose path ends in this one.
    pub fn code(&self, path: &str) -> Vec<Code<'_>> {
        let public = self.item(path);
        let means = |code: &Code<'_>| match public {
            Some(item) => (code.file, code.first) == (item.file.as_str(), item.line),
            None => code.path == path || code.path.ends_with(&format!("::{path}")),
        };
        self.all_code().filter(means).collect()
    }

    /// The functions that have a text.
    pub fn functions_with(&self, text: &str) -> Vec<Code<'_>> {
        self.all_code()
            .filter(|code| code.is_function && !code.lines_with(text).is_empty())
            .collect()
    }

    fn all_code(&self) -> impl Iterator<Item = Code<'_>> {
        self.files.iter().flat_map(|file| {
            let module = file.module.join("::");
            file.scan.entries.iter().map(move |entry| {
                let owner = entry.owner.as_deref().unwrap_or_default();
                let path = [module.as_str(), owner, &entry.name];
                let path = path.iter().filter(|part| !part.is_empty()).copied().collect::<Vec<_>>();
                let path = path.join("::");
                let (first, last) = (entry.line, entry.last);
                let is_function = ["fn", "method", "tymethod"].contains(&entry.word);
                Code { path, file: &file.name, first, last, is_function, text: &file.text }
            })
        })
    }

    /// The path that resembles one that is not there.
    pub fn like(&self, path: &str) -> Option<&str> {
        nearest(self.items.keys(), path)
    }
}

impl File {
    /// A file by its path below the sources.
    fn new(path: &Path, text: String) -> File {
        let name = format!("{SOURCES}/{}", slashed(path));
        let scan = Scan::of_file(&name, &text);
        File { name, module: module_of(path), scan, text }
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

/// All public items by path.
fn items(files: &[File], library: &str) -> BTreeMap<String, Item> {
    let survey = Survey::new(files, library);
    let mut items = survey.modules();
    survey.insert_whole(&mut items);
    survey.insert_members(&mut items);
    items
}

/// What is known of all files when the items are looked for.
struct Survey<'a> {
    library: &'a str,
    files: &'a [File],
    /// The modules that can be named from outside.
    public: BTreeSet<String>,
    /// Which module hands on what lies in a private one: by that one's path and the name, which may be `*`.
    handed_on: BTreeMap<(String, String), String>,
}

impl<'a> Survey<'a> {
    fn new(files: &'a [File], library: &'a str) -> Survey<'a> {
        let public = public_modules(files);
        let mut handed_on = BTreeMap::new();
        for file in files {
            let module = file.module.join("::");
            let seen = module.is_empty() || public.contains(&module);
            for path in file.scan.handed_on.iter().filter(|_| seen) {
                let Some((name, from)) = path.split_last() else { continue };
                let from = match from.first().map(String::as_str) {
                    Some("crate") => from[1..].to_vec(),
                    Some("self") => [&file.module, &from[1..]].concat(),
                    _ => [&file.module, from].concat(),
                };
                handed_on.insert((from.join("::"), name.clone()), module.clone());
            }
        }
        Survey { library, files, public, handed_on }
    }

    fn sees(&self, module: &str) -> bool {
        module.is_empty() || self.public.contains(module)
    }

    /// The module in which rustdoc shows an item.
    fn home(&self, file: &File, name: &str) -> Option<String> {
        let module = file.module.join("::");
        if self.sees(&module) {
            return Some(module);
        }
        let handed = |name: &str| self.handed_on.get(&(module.clone(), name.to_owned()));
        handed(name).or_else(|| handed("*")).cloned()
    }

    fn modules(&self) -> BTreeMap<String, Item> {
        let module = |file: &File| {
            let path = file.module.join("::");
            let page = page(self.library, &path, "index.html");
            let (name, first, line) = (file.name.clone(), 0, 0);
            let item = Item { path: path.clone(), page, file: name, first, line, whole: true };
            self.public.contains(&path).then_some((path, item))
        };
        self.files.iter().filter_map(module).collect()
    }

    /// Functions, types, traits and constants: what has a page of its own.
    fn insert_whole(&self, items: &mut BTreeMap<String, Item>) {
        for file in self.files {
            let whole = |entry: &&Entry| entry.public && entry.owner.is_none();
            for entry in file.scan.entries.iter().filter(whole) {
                let Some(module) = self.home(file, &entry.name) else { continue };
                let name = format!("{}.{}.html", entry.word, entry.name);
                let page = page(self.library, &module, &name);
                let path = joined(&module, &entry.name);
                items.insert(path.clone(), item(file, entry, path, page));
            }
        }
    }

    /// Methods and whatever else stands on the page of its type or trait.
    fn insert_members(&self, items: &mut BTreeMap<String, Item>) {
        for file in self.files {
            for entry in file.scan.entries.iter().filter(|entry| entry.public) {
                let owner = entry.owner.as_ref().and_then(|name| self.owner(file, name, items));
                let Some(owner) = owner else { continue };
                let path = joined(&owner, &entry.name);
                let page = format!("{}#{}.{}", items[&owner].page, entry.word, entry.name);
                items.entry(path.clone()).or_insert_with(|| item(file, entry, path, page));
            }
        }
    }

    /// The path of the type or trait of a name: that of the file, or else the first one.
    fn owner(&self, file: &File, name: &str, items: &BTreeMap<String, Item>) -> Option<String> {
        let near = self.home(file, name).map(|module| joined(&module, name));
        let near = near.filter(|path| items.contains_key(path));
        let defined = |entry: &Entry| entry.owner.is_none() && entry.name == name;
        if near.is_some() || file.scan.entries.iter().any(defined) {
            return near;
        }
        let end = format!("::{name}");
        // A variant may bear the name of a type, and has no members.
        let is_it =
            |(path, item): &(&String, &Item)| item.whole && (*path == name || path.ends_with(&end));
        items.iter().find(is_it).map(|(path, _)| path.clone())
    }
}

fn item(file: &File, entry: &Entry, path: String, page: String) -> Item {
    let whole = !matches!(entry.word, "structfield" | "variant");
    let (first, line) = (entry.first, entry.line);
    Item { path, page, file: file.name.clone(), first, line, whole }
}

/// The paths of the modules that can be named from outside.
fn public_modules(files: &[File]) -> BTreeSet<String> {
    let mut public = BTreeSet::from([String::new()]);
    let mut order: Vec<&File> = files.iter().collect();
    order.sort_by_key(|file| file.module.len());
    for file in order {
        let module = file.module.join("::");
        if public.contains(&module) {
            public.extend(file.scan.modules.iter().map(|inner| joined(&module, inner)));
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

#[cfg(test)]
mod tests {
    use super::*;

    fn library(files: &[(&str, &str)]) -> BTreeMap<String, Item> {
        let file = |(name, text): &(&str, &str)| File::new(Path::new(name), (*text).to_owned());
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

    #[test]
    fn a_variant_with_the_name_of_a_type_has_none_of_its_methods() {
        let items = library(&[
            ("lib.rs", "pub mod a;\npub mod b;\n"),
            ("a.rs", "pub enum Fault {\n    Given,\n}\n"),
            ("b/mod.rs", "mod more;\npub struct Given;\n"),
            ("b/more.rs", "impl Given {\n    pub fn hold() {}\n}\n"),
        ]);
        assert!(items.contains_key("b::Given::hold"), "{:?}", items.keys());
        assert!(items.contains_key("a::Fault::Given"), "{:?}", items.keys());
    }
}
