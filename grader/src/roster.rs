//! Who handed in what: a CSV file of folders, names, and whatever else the course writes there.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::submission::{Submission, unpacked};
use crate::text::harmless_line;

/// Rows by folders.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Roster {
    further: Vec<String>,
    rows: BTreeMap<String, Row>,
}

/// A row of the roster.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Row {
    name: String,
    further: Vec<String>,
}

/// Which row belongs to which submission.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Matches {
    /// Folders of rows by the names of submissions.
    rows: BTreeMap<String, String>,
    /// Where roster and submissions do not agree.
    pub differences: Differences,
}

/// Where the roster and the submissions do not agree.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Differences {
    /// Submissions without a row.
    pub unknown: Vec<String>,
    /// Rows, folder and name, without a submission.
    pub absent: Vec<(String, String)>,
    /// Sentences on rows that several submissions claim, or one with other capitals.
    pub doubtful: Vec<String>,
}

/// The column of the days that a submission came too late.
const DAYS_LATE: &str = "days_late";

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
        let bytes = std::fs::read(path)
            .map_err(|error| format!("cannot read the roster {}: {error}", path.display()))?;
        let parsed = text(&bytes).and_then(Self::parse);
        parsed.map_err(|error| format!("the roster {}: {error}", path.display()))
    }

    /// The same from text.
    ///
    /// # Errors
    ///
    /// As [`Roster::read`].
    pub fn parse(text: &str) -> Result<Self, String> {
        // Spreadsheets begin a file with a mark of its encoding.
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .delimiter(separator(text))
            .from_reader(text.as_bytes());
        let headers = reader.headers().map_err(|error| format!("{error}; {FORM}"))?.clone();
        let column = |name: &str| {
            let found = headers.iter().position(|header| header.eq_ignore_ascii_case(name));
            found.ok_or_else(|| format!("line 1: there is no column `{name}`; {FORM}"))
        };
        let (folder, name) = (column("folder")?, column("name")?);
        let others: Vec<usize> = (0..headers.len())
            .filter(|at| *at != folder && *at != name && !headers[*at].is_empty())
            .collect();
        let mut rows = BTreeMap::new();
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
            let further = others.iter().map(|at| cell(*at)).collect();
            if rows.insert(folder.clone(), Row { name, further }).is_some() {
                return Err(format!("line {line}: `{folder}` has a line already; delete one"));
            }
        }
        let further = others.iter().map(|at| harmless_line(&headers[*at], NAME)).collect();
        let roster = Self { further, rows };
        roster.rows.keys().try_for_each(|folder| roster.days_late(folder).map(drop))?;
        Ok(roster)
    }

    /// One of folders alone, in which nobody has a name.
    pub fn of_folders(folders: &[String]) -> Self {
        let rows = folders.iter().map(|folder| (folder.clone(), Row::default()));
        Self { further: Vec::new(), rows: rows.collect() }
    }

    /// The folders of its rows.
    pub fn folders(&self) -> impl Iterator<Item = &str> {
        self.rows.keys().map(String::as_str)
    }

    /// Names of the columns beside folder and name.
    pub fn further(&self) -> &[String] {
        &self.further
    }

    /// What stands in those columns for a folder.
    pub fn further_of(&self, folder: &str) -> &[String] {
        self.rows.get(folder).map_or(&[], |row| &row.further)
    }

    /// How many days late a folder was handed in, if the roster has a column for it.
    ///
    /// # Errors
    ///
    /// What stands there, when it is no number of days.
    pub fn days_late(&self, folder: &str) -> Result<Option<f64>, String> {
        let column = self.further.iter().position(|name| name.eq_ignore_ascii_case(DAYS_LATE));
        let Some(text) = column.and_then(|at| self.further_of(folder).get(at)) else {
            return Ok(None);
        };
        if text.is_empty() {
            return Ok(None);
        }
        let days = text.replace(',', ".").parse().ok();
        days.filter(|days: &f64| (0.0..=1e4).contains(days)).map(Some).ok_or_else(|| {
            format!("the roster has `{text}` in the column `{DAYS_LATE}` of `{folder}`; write a number of days")
        })
    }

    /// Finds the row of each submission. One that several submissions claim belongs to none.
    pub fn matched(&self, submissions: &[Submission]) -> Matches {
        let folders: BTreeSet<String> = submissions.iter().map(folder_of).collect();
        let mut claims: BTreeMap<&String, Vec<&Submission>> = BTreeMap::new();
        let mut matches = Matches::default();
        for submission in submissions {
            match self.row(submission, &folders) {
                Some(row) => claims.entry(row).or_default().push(submission),
                None => matches.differences.unknown.push(submission.name.clone()),
            }
        }
        let mut absent: Vec<&String> =
            self.rows.keys().filter(|row| !claims.contains_key(row)).collect();
        for submission in submissions.iter().filter(|it| self.row(it, &folders).is_none()) {
            let folder = folder_of(submission).to_lowercase();
            // Nobody can say of such a row that nothing was handed in.
            for row in absent.extract_if(.., |row| row.to_lowercase() == folder) {
                matches.differences.doubtful.push(other_capitals(row, submission));
            }
        }
        for (row, submissions) in claims {
            match submissions.as_slice() {
                [one] => drop(matches.rows.insert(one.name.clone(), row.clone())),
                several => matches.differences.doubtful.push(contested(row, several)),
            }
        }
        let named = |row: &&String| ((*row).clone(), self.rows[*row].name.clone());
        matches.differences.absent = absent.iter().map(named).collect();
        matches
    }

    /// The row that a submission claims: by its folder, by that of an archive without the ending,
    /// and by the name it was given. A row of another submission's folder is no other one's.
    fn row(&self, submission: &Submission, folders: &BTreeSet<String>) -> Option<&String> {
        let row = |name: &str| self.rows.get_key_value(name).map(|(folder, _)| folder);
        let folder = folder_of(submission);
        let others = [harmless_line(&unpacked(&submission.path), NAME), submission.name.clone()];
        let free = |name: &&String| !folders.contains(*name);
        row(&folder).or_else(|| others.iter().filter(free).find_map(|name| row(name)))
    }

    /// Who handed in a submission.
    pub fn student(&self, matches: &Matches, submission: &str) -> Option<&str> {
        let row = self.rows.get(matches.folder(submission)?)?;
        Some(row.name.as_str()).filter(|name| !name.is_empty())
    }
}

impl Matches {
    /// The folder of the row that belongs to a submission.
    pub fn folder(&self, submission: &str) -> Option<&str> {
        self.rows.get(submission).map(String::as_str)
    }
}

fn folder_of(submission: &Submission) -> String {
    harmless_line(&submission.folder(), NAME)
}

fn contested(row: &str, submissions: &[&Submission]) -> String {
    let names: Vec<&str> = submissions.iter().map(|submission| submission.name.as_str()).collect();
    format!(
        "`{row}` fits {}: it is given to none of them; rename the folders or the row",
        names.join(", ")
    )
}

/// That a folder without a row would have one if capitals did not count.
fn other_capitals(row: &str, submission: &Submission) -> String {
    format!(
        "`{row}` differs in capitals from the folder {}: write the one as the other",
        submission.name
    )
}

/// The text of a file that a spreadsheet may have written in another encoding.
pub(crate) fn text(bytes: &[u8]) -> Result<&str, String> {
    const SAVE: &str = "save it as UTF-8 (\"CSV UTF-8\" in a spreadsheet)";
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b'\n').count();
        format!("line {line} is no UTF-8; {SAVE}")
    })?;
    if text.contains('\0') { Err(format!("it is no UTF-8; {SAVE}")) } else { Ok(text) }
}

/// What stands between the cells of a heading.
pub(crate) fn separator(text: &str) -> u8 {
    let heading = text.lines().next().unwrap_or_default();
    *b"\t;".iter().find(|separator| heading.as_bytes().contains(separator)).unwrap_or(&b',')
}
