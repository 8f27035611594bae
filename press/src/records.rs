//! Records: what takes long is computed once, kept with how it was made, and compared when made again.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::files;

/// The outcome of a long computation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Record {
    /// Its name.
    pub name: String,
    /// The chapter that shows it.
    pub chapter: String,
    /// The command that makes it again.
    pub command: String,
    /// Digest of its inputs.
    pub input_digest: String,
    /// What it was made on.
    pub machine: String,
    /// The day it was made.
    pub date: String,
    /// The inputs by name.
    pub inputs: BTreeMap<String, String>,
    /// The values by name.
    pub values: BTreeMap<String, Value>,
}

/// One value of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Value {
    /// The number.
    pub value: f64,
    /// As it stands in prose.
    pub text: String,
    /// Its unit.
    pub unit: String,
    /// By what share of itself it may differ when it is made again.
    pub within: f64,
}

/// What the program prints of a record it made.
#[derive(Clone, Debug, Deserialize)]
pub struct Made {
    /// Its name.
    pub name: String,
    /// The chapter that shows it.
    pub chapter: String,
    /// The inputs by name.
    pub inputs: BTreeMap<String, String>,
    /// The values by name.
    pub values: BTreeMap<String, Value>,
}

impl Value {
    /// Whether the text says the number, rounded to the digits that it has.
    pub fn is_told(&self) -> bool {
        let plain = self.text.replace(',', "").replace('\u{2212}', "-");
        let half = 0.500_001 * 0.1_f64.powi(decimals(&self.text) as i32);
        plain.parse::<f64>().is_ok_and(|said| (said - self.value).abs() <= half)
    }

    /// What differs in the same value made again, but for its digits.
    fn difference(&self, again: &Value) -> Option<String> {
        let is_near = (again.value - self.value).abs() <= self.within * self.value.abs();
        if !is_near {
            return Some(format!(
                "was {} and is {} (may differ by {:e} of itself)",
                self.value, again.value, self.within
            ));
        }
        if self.unit != again.unit {
            return Some(format!("was in “{}” and is in “{}”", self.unit, again.unit));
        }
        if self.within != again.within {
            return Some(format!(
                "might differ by {:e} of itself and may by {:e}",
                self.within, again.within
            ));
        }
        let says_otherwise = self.value == again.value && self.text != again.text;
        (says_otherwise || decimals(&self.text) != decimals(&again.text))
            .then(|| format!("was said as {} and is as {}", self.text, again.text))
    }
}

/// How many digits stand behind the point.
fn decimals(text: &str) -> usize {
    text.split_once('.').map_or(0, |(_, fraction)| fraction.len())
}

impl Record {
    /// A record of what was made here and now.
    pub fn new(made: Made, date: String, machine: String) -> Record {
        Record {
            command: format!("cargo book record {}", made.name),
            input_digest: digest(&made.inputs),
            name: made.name,
            chapter: made.chapter,
            machine,
            date,
            inputs: made.inputs,
            values: made.values,
        }
    }

    /// All records in a folder, by name.
    ///
    /// # Errors
    /// A file that is no record, with the command that makes it again.
    pub fn read_all(folder: &Path) -> Result<BTreeMap<String, Record>> {
        let mut records = BTreeMap::new();
        for file in files::below(folder)? {
            let name = file.file_stem().unwrap_or_default().to_string_lossy();
            if file.extension().is_some_and(|end| end == "toml")
                && let Some(record) = Record::read(folder, &name)?
            {
                records.insert(record.name.clone(), record);
            }
        }
        Ok(records)
    }

    /// The record of a name in a folder, if it is there.
    ///
    /// # Errors
    /// As [`Record::read_all`].
    pub fn read(folder: &Path, name: &str) -> Result<Option<Record>> {
        let path = folder.join(format!("{name}.toml"));
        let Some(text) = files::read_if_there(&path)? else { return Ok(None) };
        let mend = || {
            format!(
                "{} is not the record `{name}`: run `cargo book record {name}`, then `cargo book accept`",
                path.display()
            )
        };
        let record: Record = toml::from_str(&text).with_context(mend)?;
        anyhow::ensure!(record.name == name, "{}", mend());
        Ok(Some(record))
    }

    /// Writes the record into a folder.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let text = toml::to_string(self).context("a record cannot be written as TOML")?;
        files::write(&folder.join(format!("{}.toml", self.name)), text.as_bytes())
    }

    /// The file it is kept in, relative to the root of the book.
    pub fn file(&self) -> String {
        format!("exhibits/records/{}.toml", self.name)
    }

    /// What differs between this record and the same one made again, a sentence each.
    pub fn differences(&self, again: &Record) -> Vec<String> {
        let mut found = Vec::new();
        if self.inputs != again.inputs {
            found.push(format!("the inputs were {:?} and are {:?}", self.inputs, again.inputs));
        }
        for (name, old) in &self.values {
            let difference = match again.values.get(name) {
                None => Some("is gone".to_owned()),
                Some(new) => old.difference(new),
            };
            found.extend(difference.map(|difference| format!("{name} {difference}")));
        }
        let added = again.values.keys().filter(|name| !self.values.contains_key(*name));
        found.extend(added.map(|name| format!("{name} is new")));
        found
    }
}

/// Digest of the inputs of a record.
pub fn digest(inputs: &BTreeMap<String, String>) -> String {
    let mut hasher = Sha256::new();
    for (name, value) in inputs {
        hasher.update(format!("{name}={value}\n"));
    }
    hex(&hasher.finalize())[..16].to_owned()
}

/// Bytes as hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(ratio: f64, within: f64) -> Record {
        let value = Value { value: ratio, text: String::new(), unit: String::new(), within };
        let made = Made {
            name: "noise".to_owned(),
            chapter: "bearing".to_owned(),
            inputs: BTreeMap::from([("draws".to_owned(), "10".to_owned())]),
            values: BTreeMap::from([("ratio".to_owned(), value)]),
        };
        Record::new(made, "2026-01-01".to_owned(), "here".to_owned())
    }

    #[test]
    fn a_value_may_differ_within_its_margin_and_no_further() {
        assert!(record(1.0, 0.01).differences(&record(1.005, 0.01)).is_empty());
        assert_eq!(record(1.0, 0.01).differences(&record(1.02, 0.01)).len(), 1);
        assert_eq!(record(1.0, 0.01).differences(&record(f64::NAN, 0.01)).len(), 1);
    }

    #[test]
    fn the_unit_the_margin_and_the_digits_of_a_value_are_compared_too() {
        let first = Value { value: 1234.5, text: "1234.5".into(), unit: "m".into(), within: 0.0 };
        assert_eq!(first.difference(&first), None);
        let others = [
            Value { unit: "px".into(), ..first.clone() },
            Value { within: 0.5, ..first.clone() },
            Value { text: "1,234.5".into(), ..first.clone() },
        ];
        assert!(others.iter().all(|other| first.difference(other).is_some()));
        let first = Value { within: 0.5, ..first };
        let again = |text: &str| Value { value: 1230.0, text: text.into(), ..first.clone() };
        assert_eq!(first.difference(&again("1230.0")), None);
        assert!(first.difference(&again("1230")).is_some());
    }

    #[test]
    fn a_text_says_its_number_or_another() {
        let told = |value, text: &str| {
            Value { value, text: text.to_owned(), unit: String::new(), within: 0.0 }.is_told()
        };
        assert!(told(12_345.678, "12,345.7") && told(-0.25, "\u{2212}0.3") && told(2.0, "2"));
        assert!(!told(3.1, "2.1") && !told(0.25, "\u{2212}0.3") && !told(1.0, "one"));
    }

    #[test]
    fn a_file_that_is_no_record_is_named_with_the_command_that_makes_it() {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [("noise", "values = 1"), ("other", "")] {
            std::fs::write(folder.path().join(format!("{name}.toml")), text).unwrap();
            let error = Record::read(folder.path(), name).unwrap_err().to_string();
            assert!(error.contains(&format!("{name}.toml is not the record `{name}`")), "{error}");
            assert!(error.contains(&format!("cargo book record {name}")), "{error}");
            assert!(Record::read_all(folder.path()).is_err());
        }
        assert!(Record::read(folder.path(), "absent").unwrap().is_none());
    }

    #[test]
    fn a_record_survives_being_written_and_read() {
        let folder = tempfile::tempdir().unwrap();
        record(1.5, 0.0).write(folder.path()).unwrap();
        assert_eq!(Record::read_all(folder.path()).unwrap()["noise"], record(1.5, 0.0));
    }
}
