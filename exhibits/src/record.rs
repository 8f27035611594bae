//! What takes long: large runs whose results the book keeps beside a small live check of the same
//! thing.

use crate::chapter::Place;

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
    pub run: fn() -> Vec<RecordValue>,
    pub place: Place,
}
