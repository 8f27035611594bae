//! What takes long: large runs whose results the book keeps beside a small live check of the same
//! thing.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::sync::{Mutex, PoisonError};

use serde::Deserialize;

use crate::chapter::Place;
use crate::data::{DataFile, NotMade, note_read, sha256};

/// One result of a record.
pub struct RecordValue {
    pub name: Cow<'static, str>,
    pub value: f64,
    /// Digits after the decimal point in the book.
    pub decimals: usize,
    pub unit: &'static str,
    /// Relative difference that is accepted when the record is made again; 0 asks for the same
    /// bits.
    pub within: f64,
}

impl RecordValue {
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        value: f64,
        unit: &'static str,
        decimals: usize,
        within: f64,
    ) -> Self {
        Self { name: name.into(), value, decimals, unit, within }
    }
}

/// A run, what goes into it and what comes out.
pub struct Record {
    pub name: &'static str,
    pub inputs: Vec<(&'static str, String)>,
    pub run: Run,
    pub place: Place,
}

/// How a record is made.
pub enum Run {
    /// From nothing but the program.
    Program(fn() -> Vec<RecordValue>),
    /// From data as well.
    Data(fn() -> Result<Vec<RecordValue>, NotMade>),
}

impl Run {
    pub fn values(&self) -> Result<Vec<RecordValue>, NotMade> {
        match self {
            Self::Program(run) => Ok(run()),
            Self::Data(run) => run(),
        }
    }
}

/// Files as inputs of a record: their digests under their paths.
pub fn inputs_of(files: &[DataFile]) -> impl Iterator<Item = (&'static str, String)> {
    files.iter().map(|file| (file.path, file.sha256.to_owned()))
}

/// A value of a record that has been accepted: for figures and numbers that show what cannot be
/// computed anew for each build, such as times.
///
/// What is not there is 1 until [`missing`] is asked, because a record has to be made before it
/// can be accepted.
pub fn accepted(record: &str, value: &str) -> f64 {
    let mut asked = ASKED.lock().unwrap_or_else(PoisonError::into_inner);
    let kept = asked.entry(record.to_owned()).or_insert_with(|| Kept::read(record));
    kept.asked.insert(value.to_owned());
    kept.value(value).unwrap_or_else(|sentence| {
        kept.missing.insert(sentence);
        1.0
    })
}

/// What was asked of accepted records and they do not say, a sentence each.
pub fn missing() -> Result<(), String> {
    let asked = ASKED.lock().unwrap_or_else(PoisonError::into_inner);
    let sentences: Vec<&str> =
        asked.values().flat_map(|kept| &kept.missing).map(String::as_str).collect();
    if sentences.is_empty() { Ok(()) } else { Err(sentences.join("\n")) }
}

/// The values that were asked of accepted records, each as `record.value`: figures show them, or numbers do.
pub fn asked() -> Vec<String> {
    let asked = ASKED.lock().unwrap_or_else(PoisonError::into_inner);
    let of = |(record, kept): (&String, &Kept)| {
        kept.asked.iter().map(|value| format!("{record}.{value}")).collect::<Vec<_>>()
    };
    asked.iter().flat_map(of).collect()
}

/// The records that values were asked of.
static ASKED: Mutex<BTreeMap<String, Kept>> = Mutex::new(BTreeMap::new());

/// What the file of a record says.
pub struct Kept {
    record: String,
    values: Result<BTreeMap<String, KeptValue>, String>,
    asked: BTreeSet<String>,
    missing: BTreeSet<String>,
}

#[derive(Deserialize)]
struct KeptRecord {
    values: BTreeMap<String, KeptValue>,
}

#[derive(Deserialize)]
struct KeptValue {
    value: f64,
}

impl Kept {
    fn read(record: &str) -> Self {
        // The press starts the program in the folder of the book, cargo the tests in that of the package.
        let file = file(record);
        let near = file.trim_start_matches("exhibits/");
        let text = std::fs::read_to_string(&file).or_else(|_| std::fs::read_to_string(near));
        let digest = text.as_deref().map(|text| sha256(text.as_bytes()));
        note_read(file, digest.unwrap_or_default());
        Self::of(record, text)
    }

    /// What the text of a record's file says.
    pub fn of(record: &str, text: std::io::Result<String>) -> Self {
        let make = format!("run `cargo book record {record}`, then `cargo book accept`");
        let values = match text {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                Err(format!("the record `{record}` was never accepted; {make}"))
            }
            Err(error) => Err(format!("{}: {error}; {make}", file(record))),
            Ok(text) => match toml::from_str::<KeptRecord>(&text) {
                Ok(kept) => Ok(kept.values),
                Err(error) => Err(format!("{} is damaged: {error}; {make}", file(record))),
            },
        };
        Self { record: record.to_owned(), values, asked: BTreeSet::new(), missing: BTreeSet::new() }
    }

    pub fn value(&self, name: &str) -> Result<f64, String> {
        let record = &self.record;
        match self.values.as_ref().map_err(String::clone)?.get(name) {
            Some(kept) => Ok(kept.value),
            None => Err(format!(
                "the accepted record `{record}` has no value `{name}`; run `cargo book record {record}`, \
                 then `cargo book accept`"
            )),
        }
    }
}

/// The file of an accepted record, below the folder of the book.
fn file(record: &str) -> String {
    format!("exhibits/records/{record}.toml")
}
