//! Which source files a piece of a Rust program is computed from, item by item.
//!
//! An item uses the items that its names lead to, through `use`, renamings and what other modules hand on, and all
//! that those use. The names are taken from the tokens, so that what stands in macros counts as well. A value needs no
//! name of its own: whoever makes one names its type. An implementation does: `impl Trait for Type` counts as soon as
//! all types and traits of its head do, wherever it lies; a trait counts where it is in scope, because a method does
//! not name it. Tests and descriptions of the library do not count.
//!
//! It takes an item too many where a name could mean two things, and never one too few.

mod reading;
mod words;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;

use self::reading::{Reading, beside, module};
use self::words::Words;
use crate::files;
use crate::pages::slashed;

/// A path as it is written, a name each.
type Names = Vec<String>;

/// The sources of several crates.
pub struct Uses {
    root: PathBuf,
    files: Vec<File>,
    items: Vec<Piece>,
    /// The items of each module by name; the first name of a module is that of its crate.
    modules: HashMap<Names, HashMap<String, Vec<usize>>>,
    /// The file of each module.
    homes: HashMap<Names, usize>,
    macros: HashMap<String, Vec<usize>>,
    direct: Vec<OnceLock<HashSet<usize>>>,
}

#[derive(Clone)]
struct File {
    /// Below the root.
    path: PathBuf,
    /// Its module, and those that it has in itself.
    scopes: Vec<Names>,
    /// What `use` brings in, under which name.
    imports: HashMap<String, Vec<Names>>,
    /// What `use …::*` opens.
    globs: Vec<Names>,
    /// The item that stands for all its `use`.
    header: usize,
    /// What counts with each of its items.
    near: OnceLock<HashSet<usize>>,
    text: String,
    /// Whether its lines are counted, so that any change matters.
    lines: bool,
    /// Each entry of its table `CHAPTERS`.
    entries: BTreeMap<String, Words>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A struct, an enum or a union.
    Type,
    Trait,
    Impl,
    Macro,
    /// A call of a macro in place of an item: what it defines is not known.
    Call,
    Other,
}

/// An item.
#[derive(Clone)]
struct Piece {
    file: usize,
    kind: Kind,
    words: Words,
    /// The names in the head of an implementation, or of those that a macro writes.
    heads: Vec<Vec<Names>>,
}

/// A crate whose sources count.
#[derive(Clone, Copy)]
pub struct Crate<'a> {
    /// Its name in paths.
    pub name: &'a str,
    /// The folder of its sources, below the root.
    pub folder: &'a str,
    /// Whether what it makes tells lines of its sources.
    pub lines: bool,
}

impl Uses {
    /// Reads the sources.
    ///
    /// # Errors
    /// Files that cannot be read, and what cannot be followed: `include!`.
    pub fn read(root: &Path, crates: &[Crate<'_>]) -> Result<Uses> {
        let mut wanted = Vec::new();
        for member in crates {
            for path in files::below(&root.join(member.folder))? {
                if path.extension().is_some_and(|end| end == "rs") {
                    let path = Path::new(member.folder).join(&path);
                    wanted.push((module(member, &path), path, member.lines));
                }
            }
        }
        let mut read = Vec::new();
        while !wanted.is_empty() {
            let found: Vec<Reading> = wanted
                .par_iter()
                .map(|(module, path, lines)| {
                    let text = files::read(&root.join(path))?;
                    Reading::known_or_of(path, module, text, *lines).with_context(|| slashed(path))
                })
                .collect::<Result<_>>()?;
            wanted = found.iter().flat_map(Reading::elsewhere).collect();
            read.extend(found);
        }
        let mut uses = Uses {
            root: root.to_path_buf(),
            files: Vec::new(),
            items: Vec::new(),
            modules: HashMap::new(),
            homes: HashMap::new(),
            macros: HashMap::new(),
            direct: Vec::new(),
        };
        read.into_iter().for_each(|reading| uses.insert(reading));
        uses.direct = uses.items.iter().map(|_| OnceLock::new()).collect();
        Ok(uses)
    }

    fn insert(&mut self, reading: Reading) {
        let at = self.files.len();
        let mut file = reading.file;
        file.header = self.items.len();
        self.items.push(Piece {
            file: at,
            kind: Kind::Other,
            words: reading.header,
            heads: Vec::new(),
        });
        for scope in &file.scopes {
            self.homes.insert(scope.clone(), at);
            self.modules.entry(scope.clone()).or_default();
        }
        for (module, name, mut piece) in reading.items {
            piece.file = at;
            if piece.kind == Kind::Macro {
                self.macros.entry(name.clone()).or_default().push(self.items.len());
            }
            let items = self.modules.entry(module).or_default();
            items.entry(name).or_default().push(self.items.len());
            self.items.push(piece);
        }
        self.files.push(file);
    }

    /// All files that were read or are included, below the root.
    pub fn sources(&self) -> BTreeSet<PathBuf> {
        let included = self.items.iter().flat_map(|item| {
            let file = &self.files[item.file];
            item.words.included.iter().filter_map(|name| beside(&file.path, name).ok())
        });
        self.files.iter().map(|file| file.path.clone()).chain(included).collect()
    }

    /// The entries of the table `CHAPTERS` in a file, by the name that each begins with.
    pub fn entries(&self, file: &str) -> Vec<String> {
        let found = self.files.iter().find(|known| slashed(&known.path) == file);
        found.map(|file| file.entries.keys().cloned().collect()).unwrap_or_default()
    }

    /// Everything that an entry of the table in `file` is computed from, the rest of that file included: paths below
    /// the root, and what they say as far as it matters.
    pub fn of_entry(&self, file: &str, entry: &str) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
        let Some(table) = self.files.iter().position(|known| slashed(&known.path) == file) else {
            bail!("there is no {file}");
        };
        let Some(words) = self.files[table].entries.get(entry) else {
            bail!("{file} has no entry {entry}");
        };
        let mut open: HashSet<usize> =
            (0..self.items.len()).filter(|item| self.items[*item].file == table).collect();
        words.paths.iter().for_each(|path| self.resolve(table, path, &mut open));
        let used = self.closure(open);
        let mut inputs = BTreeMap::from([(PathBuf::from(entry), words.text.clone().into_bytes())]);
        for item in used {
            let Piece { file: at, words, .. } = &self.items[item];
            let File { path, text, lines, .. } = &self.files[*at];
            let told = inputs.entry(path.clone()).or_default();
            // The file of the table has other entries, whose lines tell nothing.
            match *lines && *at != table {
                true => *told = text.clone().into_bytes(),
                false => told.extend(format!("{}\n", words.text).bytes()),
            }
            for name in &words.included {
                let file = beside(path, name)?;
                let bytes = std::fs::read(self.root.join(&file)).unwrap_or_default();
                inputs.insert(file, bytes);
            }
        }
        Ok(inputs)
    }

    /// The items that some items use, themselves included.
    fn closure(&self, mut open: HashSet<usize>) -> BTreeSet<usize> {
        let impls: Vec<(usize, usize, &Vec<Names>)> = self.heads().collect();
        let mut used = BTreeSet::new();
        loop {
            while let Some(next) = open.iter().next().copied() {
                open.remove(&next);
                if used.insert(next) {
                    let direct = self.direct[next].get_or_init(|| self.direct(next));
                    open.extend(direct.iter().filter(|item| !used.contains(item)));
                }
            }
            let implements = |(item, file, head): &&(usize, usize, &Vec<Names>)| {
                !used.contains(item) && self.fits(*file, head, &used)
            };
            open = impls.iter().filter(implements).map(|(item, _, _)| *item).collect();
            if open.is_empty() {
                return used;
            }
        }
    }

    /// The items that implement something, each with the head, and the file where that is looked up.
    fn heads(&self) -> impl Iterator<Item = (usize, usize, &Vec<Names>)> {
        self.items.iter().enumerate().flat_map(|(item, piece)| {
            let by_macros = piece.words.calls.iter().filter(|_| piece.kind == Kind::Call);
            let by_macros = by_macros.filter_map(|name| self.macros.get(name)).flatten();
            let writers = by_macros.copied().chain([item]).map(|writer| &self.items[writer]);
            writers.flat_map(move |writer| {
                writer.heads.iter().map(move |head| (item, writer.file, head))
            })
        })
    }

    /// Whether all types and traits in the head of an implementation are used.
    fn fits(&self, file: usize, head: &[Names], used: &BTreeSet<usize>) -> bool {
        head.iter().all(|path| {
            let mut found = HashSet::new();
            self.resolve(file, path, &mut found);
            found.retain(|item| matches!(self.items[*item].kind, Kind::Type | Kind::Trait));
            found.is_empty() || found.iter().any(|item| used.contains(item))
        })
    }

    /// The items that an item names, and those that count with it.
    fn direct(&self, item: usize) -> HashSet<usize> {
        let Piece { file: at, words, .. } = &self.items[item];
        let file = &self.files[*at];
        let mut found = HashSet::new();
        words.paths.iter().for_each(|path| self.resolve(*at, path, &mut found));
        for called in words.calls.iter().filter_map(|name| self.macros.get(name)).flatten() {
            found.insert(*called);
            // Its names are looked up where it is called.
            let paths = &self.items[*called].words.paths;
            paths.iter().for_each(|path| self.resolve(*at, path, &mut found));
        }
        found.extend(file.near.get_or_init(|| self.near(*at)));
        found
    }

    /// What counts with every item of a file: its `use`, the traits in scope, what an enum hands out, and what macros
    /// define.
    fn near(&self, at: usize) -> HashSet<usize> {
        let file = &self.files[at];
        let mut near = HashSet::from([file.header]);
        file.globs.iter().for_each(|glob| self.resolve(at, glob, &mut near));
        for scope in &file.scopes {
            self.traits(scope, &mut near, &mut HashSet::new());
            near.extend(self.calls(scope));
        }
        near
    }

    /// The calls of macros in place of items of a module.
    fn calls(&self, module: &[String]) -> impl Iterator<Item = usize> {
        let items = self.modules[module].values().flatten().copied();
        items.filter(|item| self.items[*item].kind == Kind::Call)
    }

    /// The traits that a module has or brings in.
    fn traits(&self, module: &[String], found: &mut HashSet<usize>, seen: &mut HashSet<Names>) {
        let Some(&at) = self.homes.get(module) else { return };
        if !seen.insert(module.to_vec()) {
            return;
        }
        let is_trait = |item: &&usize| self.items[**item].kind == Kind::Trait;
        found.extend(self.modules[module].values().flatten().filter(is_trait));
        for import in self.files[at].imports.values().flatten() {
            let mut brought = HashSet::new();
            self.resolve(at, import, &mut brought);
            found.extend(brought.iter().filter(is_trait));
        }
        for glob in &self.files[at].globs {
            self.lead(at, glob, &mut HashSet::new(), &mut HashSet::new(), &mut |module| {
                self.traits(module, found, seen);
            });
        }
    }

    /// Adds the items that a path in a file leads to.
    fn resolve(&self, at: usize, path: &[String], found: &mut HashSet<usize>) {
        self.lead(at, path, found, &mut HashSet::new(), &mut |_| {});
    }

    /// Follows a path in a file: to items, and to modules.
    fn lead(
        &self,
        at: usize,
        path: &[String],
        found: &mut HashSet<usize>,
        seen: &mut HashSet<(Names, Names)>,
        modules: &mut dyn FnMut(&[String]),
    ) {
        let first = path.first().map(String::as_str);
        for scope in &self.files[at].scopes {
            match first {
                Some("crate") => self.walk(&scope[..1], &path[1..], found, seen, modules),
                Some("self" | "super") => {
                    let steps = path.iter().take_while(|name| *name == "self" || *name == "super");
                    let rest = &path[steps.clone().count()..];
                    let up = steps.filter(|name| *name == "super").count();
                    let scope = &scope[..scope.len().saturating_sub(up)];
                    self.walk(scope, rest, found, seen, modules);
                }
                _ => self.walk(scope, path, found, seen, modules),
            }
        }
        if path.len() > 1 && self.homes.contains_key(&path[..1]) {
            self.walk(&path[..1], &path[1..], found, seen, modules);
        }
    }

    /// From a module along the names of a path.
    fn walk(
        &self,
        module: &[String],
        rest: &[String],
        found: &mut HashSet<usize>,
        seen: &mut HashSet<(Names, Names)>,
        modules: &mut dyn FnMut(&[String]),
    ) {
        let Some(&at) = self.homes.get(module) else { return };
        let Some(name) = rest.first() else { return modules(module) };
        // `use a::b as a` would go on for ever.
        if rest.len() > 20 || !seen.insert((module.to_vec(), rest.to_vec())) {
            return;
        }
        let file = &self.files[at];
        let below = [module, std::slice::from_ref(name)].concat();
        let items = self.modules[module].get(name);
        found.extend(items.into_iter().flatten());
        let known = items.is_some() || self.homes.contains_key(&below);
        self.walk(&below, &rest[1..], found, seen, modules);
        for import in file.imports.get(name).into_iter().flatten() {
            found.insert(file.header);
            self.lead(at, &[import, &rest[1..]].concat(), found, seen, modules);
        }
        for glob in file.globs.iter().filter(|_| !known) {
            found.insert(file.header);
            self.lead(at, &[&glob[..], rest].concat(), found, seen, modules);
        }
        if !known && !file.imports.contains_key(name) {
            found.extend(self.calls(module));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAIN: &str = "exhibits/src/lib.rs";

    const BOOK: &[(&str, &str)] = &[
        (
            MAIN,
            "mod bearing; mod chapter; mod noise; mod scene;
            const CHAPTERS: &[(&str, fn())] = &[(\"bearing\", bearing::exhibits), (\"noise\", noise::all)];
            fn main() { chapter::write(CHAPTERS) }",
        ),
        ("exhibits/src/chapter.rs", "pub fn write() {}"),
        (
            "exhibits/src/bearing.rs",
            "pub mod worked;
            use vislam::bearing::{self as book, Ray};
            pub fn exhibits() { worked::data(); book::depth(Ray) }",
        ),
        (
            "exhibits/src/bearing/worked.rs",
            "pub fn data() -> &'static str { include_str!(\"points.csv\") }",
        ),
        ("exhibits/src/bearing/points.csv", "1,2\n"),
        (
            "exhibits/src/noise.rs",
            "use crate::scene::*;
            #[path = \"../../code/examples/show.rs\"]
            mod show;
            pub fn all() { vislam::inertial::drift(); room(); show::show() }",
        ),
        ("code/examples/show.rs", "pub fn show() {}"),
        ("exhibits/src/scene.rs", "pub fn room() { crate::bearing::worked::data() }"),
        (
            "code/src/lib.rs",
            "pub mod bearing; mod factors; pub mod inertial; mod lonely; pub mod manifold; mod registers;",
        ),
        (
            "code/src/bearing.rs",
            "//! Rays.
            use crate::manifold::Exp;
            /// One.
            pub struct Ray;
            pub fn depth(ray: Ray) { ray.exp() }
            #[cfg(test)]
            mod tests { use crate::inertial; }",
        ),
        ("code/src/manifold/mod.rs", "mod so3; pub use so3::*;"),
        ("code/src/manifold/so3.rs", "pub trait Exp { fn exp(&self); }"),
        (
            "code/src/factors.rs",
            "use crate::{bearing, manifold as group};
            impl group::Exp for bearing::Ray { fn exp(&self) {} }",
        ),
        ("code/src/inertial.rs", "pub trait Sum {} pub fn drift() -> impl Fn() { times!(1) }"),
        (
            "code/src/registers.rs",
            "macro_rules! times { ($n:expr) => { { struct A; impl crate::inertial::Sum for A {} } } }",
        ),
        ("code/src/lonely.rs", "pub fn nobody() -> impl Iterator<Item = f64> { once(2) }"),
    ];

    fn read(folder: &Path) -> Result<Uses> {
        let library = Crate { name: "vislam", folder: "code/src", lines: false };
        let exhibits = Crate { name: "exhibits", folder: "exhibits/src", lines: true };
        Uses::read(folder, &[library, exhibits])
    }

    fn written() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (path, text) in BOOK {
            files::write(&folder.path().join(path), text.as_bytes()).unwrap();
        }
        folder
    }

    const NONE: [bool; 2] = [false, false];
    const BEARING: [bool; 2] = [true, false];
    const NOISE: [bool; 2] = [false, true];
    const BOTH: [bool; 2] = [true, true];

    /// Whether the chapters `bearing` and `noise` are to be computed again when a file changes.
    fn stale(path: &str, old: &str, new: &str) -> [bool; 2] {
        let folder = written();
        let inputs = |entry| read(folder.path()).unwrap().of_entry(MAIN, entry).unwrap();
        let before = ["bearing", "noise"].map(inputs);
        let path = folder.path().join(path);
        let text = files::read(&path).unwrap();
        assert!(text.contains(old), "{} has no {old}", path.display());
        files::write(&path, text.replacen(old, new, 1).as_bytes()).unwrap();
        let after = ["bearing", "noise"].map(inputs);
        [0, 1].map(|chapter| before[chapter] != after[chapter])
    }

    #[test]
    fn an_edited_module_of_the_library_counts_for_those_who_name_it() {
        assert_eq!(stale("code/src/bearing.rs", "ray.exp()", "ray.exp();"), BEARING);
        assert_eq!(stale("code/src/inertial.rs", "(1)", "(3)"), NOISE);
        assert_eq!(stale("code/src/lonely.rs", "(2)", "(3)"), NONE);
    }

    #[test]
    fn a_module_counts_that_is_used_through_another_one() {
        assert_eq!(stale("code/src/manifold/so3.rs", "&self", "&mut self"), BEARING);
        assert_eq!(stale("code/src/manifold/mod.rs", "pub use", "pub(crate) use"), BEARING);
    }

    #[test]
    fn an_implementation_counts_though_nobody_names_its_module() {
        assert_eq!(stale("code/src/factors.rs", "{}", "{ loop {} }"), BEARING);
        assert_eq!(stale("code/src/factors.rs", "manifold as group", "inertial as group"), BEARING);
    }

    #[test]
    fn a_macro_counts_where_it_is_called() {
        assert_eq!(stale("code/src/registers.rs", "struct A;", "struct A {}"), NOISE);
    }

    #[test]
    fn the_exhibits_of_another_chapter_count_as_far_as_they_are_used() {
        assert_eq!(stale("exhibits/src/bearing/worked.rs", "pub fn", "pub  fn"), BOTH);
        assert_eq!(stale("exhibits/src/bearing.rs", "pub fn", "\npub fn"), BEARING);
        assert_eq!(stale("exhibits/src/scene.rs", "room() {", "room() { ();"), NOISE);
    }

    #[test]
    fn a_module_that_lies_elsewhere_counts() {
        assert_eq!(stale("code/examples/show.rs", "{}", "{ }"), NOISE);
    }

    #[test]
    fn an_included_file_counts_for_those_who_use_its_module() {
        assert_eq!(stale("exhibits/src/bearing/points.csv", "2", "3"), BOTH);
    }

    #[test]
    fn what_all_share_counts_for_all_and_an_entry_for_its_chapter() {
        assert_eq!(stale("exhibits/src/chapter.rs", "{}", "{ }"), BOTH);
        assert_eq!(stale(MAIN, "write(CHAPTERS)", "write(&CHAPTERS)"), BOTH);
        assert_eq!(stale(MAIN, "noise::all", "noise::some"), NOISE);
        assert_eq!(stale(MAIN, "mod scene;", "mod scene; mod other;"), NONE);
        assert_eq!(stale(MAIN, "&[(\"bearing\"", "&[(\"other\", other::all), (\"bearing\""), NONE);
    }

    #[test]
    fn descriptions_and_tests_of_the_library_do_not_count() {
        assert_eq!(stale("code/src/bearing.rs", "/// One.", "/// One ray."), NONE);
        assert_eq!(stale("code/src/bearing.rs", "inertial;", "inertial as readings;"), NONE);
    }

    #[test]
    fn what_cannot_be_followed_is_refused() {
        let folder = written();
        let file = folder.path().join("code/src/lonely.rs");
        files::write(&file, b"include!(\"x.rs\");").unwrap();
        let error = format!("{:#}", read(folder.path()).err().unwrap());
        assert!(error.starts_with("code/src/lonely.rs: the press cannot follow"), "{error}");
    }

    #[test]
    fn the_table_names_the_chapters() {
        assert_eq!(read(written().path()).unwrap().entries(MAIN), ["bearing", "noise"]);
    }
}
