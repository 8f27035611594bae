//! Data that a record is made from and that is no part of the book: files below the folder that
//! `VISLAM_DATA` names.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use sha2::{Digest, Sha256};

/// A file below the folder of the data, and the SHA-256 of its bytes.
pub struct DataFile {
    pub path: &'static str,
    pub sha256: &'static str,
}

/// Why a record was not made.
#[derive(Debug, PartialEq)]
pub enum NotMade {
    /// Its data is not on this machine.
    DataAbsent(String),
    /// It is there and something is wrong.
    Failed(String),
}

impl DataFile {
    /// The text of the file below the folder of the data, if it is there and the one that is meant.
    pub fn read(&self) -> Result<String, NotMade> {
        self.read_from("VISLAM_DATA")
    }

    /// The same below the folder that a variable of the environment names.
    pub fn read_from(&self, variable: &str) -> Result<String, NotMade> {
        self.read_below(variable, std::env::var_os(variable).map(PathBuf::from))
    }

    pub fn read_below(&self, variable: &str, folder: Option<PathBuf>) -> Result<String, NotMade> {
        let path = self.path;
        let folder = folder.ok_or_else(|| {
            NotMade::DataAbsent(format!(
                "{variable} is not set; let it name the folder that holds {path}"
            ))
        })?;
        let file = folder.join(path);
        if !file.is_file() {
            let folder = folder.display();
            return Err(NotMade::DataAbsent(format!(
                "there is no {path} in {folder}, which {variable} names; put the file there"
            )));
        }
        let bytes = std::fs::read(&file).map_err(|error| failed(path, &error.to_string()))?;
        let found = sha256(&bytes);
        note_read(file.display().to_string(), found.clone());
        if found != self.sha256 {
            let wanted = self.sha256;
            return Err(failed(
                path,
                &format!("its SHA-256 is {found} and not {wanted}; it is another file"),
            ));
        }
        String::from_utf8(bytes).map_err(|error| failed(path, &error.to_string()))
    }
}

/// The files that were read so far, with the SHA-256 of their bytes; none for one that is absent. What is made from
/// them is made again when they change.
static READ: Mutex<BTreeMap<String, String>> = Mutex::new(BTreeMap::new());

/// Notes that a file was read.
pub fn note_read(file: String, sha256: String) {
    READ.lock().unwrap_or_else(PoisonError::into_inner).insert(file, sha256);
}

/// What was noted.
pub fn files_read() -> BTreeMap<String, String> {
    READ.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// The SHA-256 of bytes, in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn failed(path: &str, reason: &str) -> NotMade {
    NotMade::Failed(format!("{path}: {reason}"))
}
