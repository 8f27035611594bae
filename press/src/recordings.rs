//! Scenes in three dimensions: the pictures that the chapters show, and what a page needs to open them.
//!
//! The pictures are part of the book. The viewer and the recordings are not: `cargo book viewer` makes them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use flate2::Compression;

use crate::cargo;
use crate::files;
use crate::packing::{digest, packed};
use crate::settings::Layout;
use crate::steps::Steps;

/// Where the pictures lie, as PNG.
const PICTURES: &str = "recordings/pictures";
/// What opens a scene.
const SCRIPT: &str = "recordings/script";
/// What the recordings are made from.
const SOURCES: [&str; 3] = ["code/src", "recordings/src", "widgets/src"];
/// The same, single files.
const FILES: [&str; 7] = [
    "Cargo.lock",
    "Cargo.toml",
    "code/Cargo.toml",
    "code/examples/filter.rs",
    "code/examples/odometry/euroc.toml",
    "recordings/Cargo.toml",
    "widgets/Cargo.toml",
];

/// The scenes of a book.
pub struct Recordings<'a> {
    layout: &'a Layout,
}

/// A scene, as a page shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recording {
    /// Width and height of its picture in pixels.
    pub size: [u32; 2],
    /// How large the viewer and the recording are that a page loads to open it, in bytes, if they are there.
    pub load: Option<[usize; 2]>,
}

/// What the pages show of scenes.
#[derive(Default)]
pub struct Shown {
    /// The scenes by their names.
    pub scenes: BTreeMap<String, Recording>,
    /// Files for mdBook to copy.
    pub files: BTreeMap<PathBuf, Vec<u8>>,
}

impl<'a> Recordings<'a> {
    /// Those of the book that lies there.
    pub fn new(layout: &'a Layout) -> Recordings<'a> {
        Recordings { layout }
    }

    /// What there is to show: the pictures, and what opens them if it was made from what there is now.
    pub fn shown(&self) -> Result<Shown> {
        let mut shown = Shown::default();
        let scripts = if self.are_fresh()? { self.scripts()? } else { BTreeMap::new() };
        let length = |name: &str| scripts.get(Path::new(name)).map(Vec::len);
        let folder = self.layout.root.join(PICTURES);
        for file in files::below(&folder)? {
            let Some(name) = file.file_stem().and_then(|name| name.to_str()) else { continue };
            let picture = std::fs::read(folder.join(&file))
                .with_context(|| format!("cannot read {}", folder.join(&file).display()))?;
            let size = size(&picture)
                .with_context(|| format!("{} is no PNG", folder.join(&file).display()))?;
            let load = length("viewer.js").zip(length(&format!("{name}.js")));
            let load = load.map(|(viewer, scene)| [viewer, scene]);
            shown.scenes.insert(name.to_owned(), Recording { size, load });
            shown.files.insert(Path::new("recordings").join(&file), picture);
        }
        let scripts = scripts.into_iter();
        shown
            .files
            .extend(scripts.map(|(name, script)| (Path::new("recordings").join(name), script)));
        Ok(shown)
    }

    /// Whether what opens the scenes was made, but not from what there is now.
    pub fn are_stale(&self) -> Result<bool> {
        Ok(files::read_if_there(&self.made())?.is_some() && !self.are_fresh()?)
    }

    fn are_fresh(&self) -> Result<bool> {
        let made = files::read_if_there(&self.made())?;
        Ok(made.is_some_and(|made| Some(made) == self.inputs().ok()))
    }

    /// Makes the recordings, and packs them and the viewer for the pages. Gives how many bytes the viewer has then.
    ///
    /// # Errors
    /// What cargo says.
    pub fn make(&self, steps: &Steps) -> Result<usize> {
        let inputs = self.inputs()?;
        files::remove(&self.folder())?;
        let fresh = self.layout.work().join("new-recordings");
        files::remove(&fresh)?;
        let name = fresh.to_str().context("the path of the book is not Unicode")?;
        let program = ["run", "--quiet", "--locked", "--release", "--package", "recordings", "--"];
        steps.step("compiling rerun, and recording the scenes", || {
            cargo::call(
                &self.layout.root,
                &[&program[..], &["--web", name]].concat(),
                "record the scenes",
            )
        })?;
        let length = steps.step("packing the viewer", || self.pack(&fresh))?;
        files::remove(&fresh)?;
        files::write(&self.made(), inputs.as_bytes())?;
        Ok(length)
    }

    fn pack(&self, fresh: &Path) -> Result<usize> {
        let read = |name: &Path| {
            std::fs::read(fresh.join(name))
                .with_context(|| format!("there is no {}", fresh.join(name).display()))
        };
        for file in files::below(fresh)? {
            let Some(name) = file.to_str().and_then(|file| file.strip_suffix(".rrd")) else {
                continue;
            };
            let text = packed(&read(&file)?, Compression::best())?;
            let script = format!("vislamRecordings.scene({name:?}, \"{text}\");\n");
            files::write(&self.folder().join(format!("{name}.js")), script.as_bytes())?;
        }
        let program = files::read(&fresh.join("re_viewer.js"))?;
        let text = packed(&read(Path::new("re_viewer_bg.wasm"))?, Compression::best())?;
        let script = format!("{program}\nvislamRecordings.viewer(wasm_bindgen, \"{text}\");\n");
        files::write(&self.folder().join("viewer.js"), script.as_bytes())?;
        Ok(script.len())
    }

    fn scripts(&self) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
        let mut scripts = BTreeMap::new();
        for file in
            files::below(&self.folder())?.into_iter().filter(|file| file.extension().is_some())
        {
            let script = files::read(&self.folder().join(&file))?;
            scripts.insert(file, script.into_bytes());
        }
        for name in ["recordings.js", "recordings.css"] {
            let script = files::read(&self.layout.root.join(SCRIPT).join(name))?;
            scripts.insert(name.into(), script.into_bytes());
        }
        Ok(scripts)
    }

    fn folder(&self) -> PathBuf {
        self.layout.work().join("recordings")
    }

    /// A digest of what they were made from.
    fn made(&self) -> PathBuf {
        self.folder().join("inputs")
    }

    fn inputs(&self) -> Result<String> {
        digest(&self.layout.root, &SOURCES, &FILES)
    }
}

/// The scene whose picture has this path in a chapter, if it is one.
pub fn scene(path: &str) -> Option<&str> {
    path.strip_prefix("recordings/")?.strip_suffix(".png")
}

/// The file that records a scene.
pub fn program(scene: &str) -> String {
    format!("recordings/src/{scene}.rs")
}

/// Width and height of a PNG in pixels.
fn size(picture: &[u8]) -> Option<[u32; 2]> {
    picture.strip_prefix(b"\x89PNG\r\n\x1a\n")?;
    let number =
        |from: usize| Some(u32::from_be_bytes(picture.get(from..from + 4)?.try_into().ok()?));
    Some([number(16)?, number(20)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first bytes of a PNG of 1100 by 674 pixels.
    const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x04\x4c\0\0\x02\xa2";

    fn book() -> (tempfile::TempDir, Layout) {
        let root = tempfile::tempdir().unwrap();
        let layout = Layout { root: root.path().to_path_buf() };
        let write = |path: &str, content: &[u8]| {
            files::write(&root.path().join(path), content).unwrap();
        };
        write("recordings/pictures/ring.png", PNG);
        write("recordings/src/ring.rs", b"one");
        for name in ["recordings.js", "recordings.css"] {
            write(&format!("recordings/script/{name}"), b"/**/");
        }
        (root, layout)
    }

    #[test]
    fn without_the_viewer_there_is_the_picture_and_nothing_to_open() {
        let (_root, layout) = book();
        let shown = Recordings::new(&layout).shown().unwrap();
        assert_eq!(shown.scenes["ring"], Recording { size: [1100, 674], load: None });
        assert_eq!(shown.files.len(), 1);
        assert!(!Recordings::new(&layout).are_stale().unwrap());
    }

    #[test]
    fn with_the_viewer_its_size_is_known_until_a_source_changes() {
        let (root, layout) = book();
        let recordings = Recordings::new(&layout);
        let fresh = root.path().join("fresh");
        for (name, content) in
            [("ring.rrd", "scene"), ("re_viewer.js", "let"), ("re_viewer_bg.wasm", "\0asm")]
        {
            files::write(&fresh.join(name), content.as_bytes()).unwrap();
        }
        let length = recordings.pack(&fresh).unwrap();
        files::write(&recordings.made(), recordings.inputs().unwrap().as_bytes()).unwrap();
        let shown = recordings.shown().unwrap();
        let [viewer, scene] = shown.scenes["ring"].load.unwrap();
        assert_eq!(viewer, length);
        assert_eq!(scene, shown.files[Path::new("recordings/ring.js")].len());
        assert_eq!(shown.files.len(), 5);
        files::write(&root.path().join("recordings/src/ring.rs"), b"two").unwrap();
        assert_eq!(recordings.shown().unwrap().scenes["ring"].load, None);
        assert!(recordings.are_stale().unwrap());
    }
}
