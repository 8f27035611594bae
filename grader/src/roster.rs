//! Who handed in what: a CSV file of folders and names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::submission::Submission;
use crate::text::harmless_line;

/// Names by folders.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Roster(BTreeMap<String, String>);

/// Where the roster and the submissions do not agree.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Differences {
    /// Submissions without a row.
    pub unknown: Vec<String>,
    /// Rows, folder and name, without a submission.
    pub absent: Vec<(String, String)>,
}

/// As long as a name may be.
const NAME: usize = 200;

const FORM: &str =
    "the first line is `folder,name`, and each other one a folder and who handed it in";

impl Roster {
    /// Reads a roster.
    ///
    /// # Errors
    ///
    /// A sentence with the line when the file cannot be read, is of another form, or has a folder
    /// twice.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| format!("cannot read the roster {}: {error}", path.display()))?;
        Self::parse(&text).map_err(|error| format!("the roster {}: {error}", path.display()))
    }

    /// The same from text.
    ///
    /// # Errors
    ///
    /// As [`Roster::read`].
    pub fn parse(text: &str) -> Result<Self, String> {
        // Spreadsheets begin a file with a mark of its encoding.
        let text = text.trim_start_matches('\u{feff}');
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let headers = reader.headers().map_err(|error| format!("{error}; {FORM}"))?.clone();
        let column = |name: &str| {
            let found = headers.iter().position(|header| header.eq_ignore_ascii_case(name));
            found.ok_or_else(|| format!("line 1: there is no column `{name}`; {FORM}"))
        };
        let (folder, name) = (column("folder")?, column("name")?);
        let mut names = BTreeMap::new();
        for row in reader.records() {
            let row = row.map_err(|error| format!("{error}; {FORM}"))?;
            let line = row.position().map_or(0, csv::Position::line);
            let cell = |column: usize| harmless_line(row.get(column).unwrap_or_default(), NAME);
            let (folder, name) = (cell(folder), cell(name));
            if folder.is_empty() {
                return Err(format!(
                    "line {line}: the folder is empty; name it or delete the line"
                ));
            }
            if names.insert(folder.clone(), name).is_some() {
                return Err(format!("line {line}: `{folder}` has a line already; delete one"));
            }
        }
        Ok(Self(names))
    }

    /// Who handed in a submission.
    pub fn student(&self, submission: &Submission) -> Option<&str> {
        let name = self.0.get(self.row(submission)?)?;
        Some(name.as_str()).filter(|name| !name.is_empty())
    }

    /// Where it does not agree with the submissions.
    pub fn differences(&self, submissions: &[Submission]) -> Differences {
        let mut differences = Differences::default();
        let mut present = BTreeSet::new();
        for submission in submissions {
            match self.row(submission) {
                Some(row) => drop(present.insert(row)),
                None => differences.unknown.push(submission.name.clone()),
            }
        }
        let absent = self.0.iter().filter(|(folder, _)| !present.contains(*folder));
        differences.absent = absent.map(|(folder, name)| (folder.clone(), name.clone())).collect();
        differences
    }

    /// The folder of a row: by the name of the submission, or by that of its folder where a name
    /// had to be made harmless.
    fn row(&self, submission: &Submission) -> Option<&String> {
        let folder = submission.path.file_name().unwrap_or_default().to_string_lossy();
        let row = |name: &str| self.0.get_key_value(name).map(|(folder, _)| folder);
        row(&submission.name).or_else(|| row(&harmless_line(&folder, NAME)))
    }
}
