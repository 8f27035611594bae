//! The TeX of each equation as it was when somebody last held it against its check.
//!
//! A check cannot read TeX. So the press remembers the TeX that the check was written for, and fails
//! when the page says something else, until a person has looked and accepts it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::files;
use crate::records::hex;
use crate::settings::Layout;

/// The accepted TeX of a chapter's equations, by label without `eq:`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accepted {
    /// The TeX by label.
    #[serde(default)]
    pub equations: BTreeMap<String, String>,
}

impl Accepted {
    /// Reads the accepted equations of a chapter; none when nothing was accepted yet.
    pub fn read(path: &Path) -> Result<Accepted> {
        let text = files::read_if_there(path)?.unwrap_or_default();
        toml::from_str(&text).with_context(|| {
            format!("{} is damaged: restore it from the repository", path.display())
        })
    }

    /// Reads the accepted equations of all chapters, by slug.
    pub fn read_all(layout: &Layout) -> Result<BTreeMap<String, Accepted>> {
        let folder = layout.accepted_equations();
        let slug = |file: &PathBuf| Some(file.file_stem()?.to_str()?.to_owned());
        files::below(&folder)?
            .iter()
            .filter_map(|file| slug(file).map(|slug| (slug, folder.join(file))))
            .map(|(slug, path)| Ok((slug, Accepted::read(&path)?)))
            .collect()
    }

    /// Writes them, or removes the file when there are none.
    pub fn write(&self, path: &Path) -> Result<()> {
        if self.equations.is_empty() {
            return files::remove(path);
        }
        let head = "# The equations as they were last held against their checks; written by `cargo book accept`.\n\n";
        let text = toml::to_string(self).context("equations cannot be written as TOML")?;
        files::write(path, format!("{head}{text}").as_bytes())
    }
}

/// A text with its white space evened out, so that moving a line break changes nothing.
pub fn normal(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A short digest of an equation's TeX, for the ledger.
pub fn digest(tex: &str) -> String {
    hex(&Sha256::digest(normal(tex)))[..8].to_owned()
}
