//! Where the files of an answer lie in what was handed in: in the folder itself, in the only one in it, or in
//! a ZIP file.

use std::path::{Path, PathBuf};

use super::answer::{COVARIANCE, DECLARATION, LARGEST, TEXT, TRAJECTORY, folder, written};
use super::flights::FLIGHTS;
use crate::archive::Wanted;
use crate::submission::{Opened, is_there, nested};

/// What is taken out of a ZIP file.
const FILES: Wanted = Wanted {
    name: |name| [DECLARATION, TEXT, TRAJECTORY, COVARIANCE].contains(&name),
    answer: |_| true,
    text: |name| name == TEXT,
    largest: LARGEST,
    most: 4 * FLIGHTS,
};

/// What was handed in. What was unpacked for it goes with it.
#[derive(Debug)]
pub struct Handed {
    opened: Opened,
    /// The text for a person, and why there may be another one.
    text: (Option<String>, Vec<String>),
}

impl Handed {
    /// Opens a folder, a ZIP file, or one in a folder without an answer.
    ///
    /// # Errors
    ///
    /// As [`Opened::of`].
    pub fn find(path: &Path) -> Result<Self, String> {
        let opened = Opened::of(path, &FILES, has_flights)?;
        let text = text_of(&opened);
        Ok(Self { opened, text })
    }

    /// The folder of the answer, if there is one.
    pub fn folder(&self) -> Option<PathBuf> {
        answer_in(self.opened.root())
    }

    /// The text for a person: that beside the answer, or around the archive that this lay in. And why there may be
    /// another one, which nobody has read.
    pub fn text(&self) -> (Option<String>, Vec<String>) {
        self.text.clone()
    }

    /// Whether there may be a text that nobody has read, as a notice says.
    pub fn unread(&self) -> bool {
        self.opened.text_left || !self.text.1.is_empty()
    }

    /// What was left out and costs nothing.
    pub fn notices(&self) -> Vec<String> {
        self.opened.notices.iter().chain(&self.text.1).cloned().collect()
    }
}

fn text_of(opened: &Opened) -> (Option<String>, Vec<String>) {
    let (mut text, mut unread) = (None, Vec::new());
    for root in opened.roots() {
        match nested(root).find_map(|folder| written(&folder).transpose()).transpose() {
            Ok(found) if text.is_none() => text = found,
            Ok(found) if found.is_some() && found != text => unread.push(format!(
                "there is another `{TEXT}` beside the archive, which is not read: hand in one"
            )),
            Ok(_) => {}
            Err(why) => unread.push(why),
        }
    }
    (text, unread)
}

/// Whether something of an answer to flights lies in a folder.
pub fn has_flights(root: &Path) -> bool {
    answer_in(root).is_some()
}

/// The folder with an answer: this one, or the one in it as long as there is no other.
fn answer_in(root: &Path) -> Option<PathBuf> {
    nested(root).find(|folder| has_answer(folder))
}

/// Whether a folder has anything of an answer.
pub fn has_answer(root: &Path) -> bool {
    is_there(&root.join(DECLARATION))
        || (0..FLIGHTS).any(|flight| is_there(&root.join(folder(flight))))
}
