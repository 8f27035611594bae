//! What takes long: large runs whose results the book keeps beside a small live check of the same
//! thing.

use crate::chapter::Place;
use crate::data::{DataFile, NotMade};

/// One result of a record.
pub struct RecordValue {
    pub name: &'static str,
    pub value: f64,
    /// Digits after the decimal point in the book.
    pub decimals: usize,
    pub unit: &'static str,
    /// Relative difference that is accepted when the record is made again; 0 asks for the same
    /// bits.
    pub within: f64,
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

/// The values of a record that has been accepted, from the text of its file: for figures that show
/// what cannot be computed anew for each build, such as times.
pub fn accepted(file: &'static str) -> impl Fn(&str) -> Option<f64> {
    move |name| {
        let (_, values) = file.split_once(&format!("[values.{name}]\n"))?;
        values.lines().find_map(|line| line.strip_prefix("value = ")).and_then(|v| v.parse().ok())
    }
}
