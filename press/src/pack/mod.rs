//! The book to take along: its pages as one file that opens from a disk, and all of it on paper.
//!
//! Both come out the same, byte for byte, from the same pages: nothing in them depends on time or chance.

mod archive;
mod browser;
mod document;
mod imprint;
mod paper;
mod syntax;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use self::imprint::Imprint;
use crate::fault::Faults;
use crate::files;
use crate::settings::Layout;
use crate::steps::Steps;

/// What both files are called, and the folder in the archive.
const NAME: &str = "visual-inertial-slam";

/// Packs the pages of a site into a folder. Gives the faults that only paper shows.
///
/// # Errors
/// A site without pages, no browser, a folder that cannot be written.
pub fn pack(layout: &Layout, steps: &Steps, site: &Path, into: &Path) -> Result<Faults> {
    if !site.join("index.html").is_file() {
        bail!(
            "there are no pages in {}: `cargo book build` makes them, and `cargo book pack` without --site does too",
            site.display()
        );
    }
    let archive = steps.step("pages in one file", || archive::of(site, NAME))?;
    let files = vec![(format!("{NAME}.zip"), archive)];
    write(steps, into, &files)?;
    let imprint = Imprint::read(&layout.root)?;
    let profile = layout.work().join("browser");
    let printed = paper::print(steps, site, &imprint, &profile);
    files::remove(&profile)?;
    let printed = printed.context("the PDF was not made")?;
    if printed.faults.is_empty() {
        steps.say(&format!(
            "{} pages, printed {} times until the page numbers stood still",
            printed.pages, printed.rounds
        ));
        write(steps, into, &[(format!("{NAME}.pdf"), printed.bytes)])?;
    }
    Ok(printed.faults)
}

fn write(steps: &Steps, into: &Path, made: &[(String, Vec<u8>)]) -> Result<()> {
    for (name, bytes) in made {
        let path: PathBuf = into.join(name);
        files::write(&path, bytes)?;
        steps.say(&format!("{}: {:.1} MB", path.display(), bytes.len() as f64 / 1e6));
    }
    Ok(())
}
