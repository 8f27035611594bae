//! Lines of fields separated by commas, below a line that names the columns.
//!
//! None of these files quotes a field. The crate `csv` would split them as well, but counts the
//! line of a record too low where lines end in CR LF or empty ones came before, and the line is
//! what a reader with a broken file needs.

use std::fmt;
use std::str::FromStr;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use thiserror::Error;

use crate::reprojection::PinholeError;

/// Names of the columns of a table.
pub(super) type Header = &'static [&'static str];

/// One line below the header.
pub(super) struct Row<'a> {
    /// Counted from one.
    pub line: usize,
    /// The names of the columns in this file.
    pub header: Header,
    fields: Vec<&'a str>,
}

impl<'a> Row<'a> {
    /// The text in a column.
    pub fn text(&self, column: usize) -> &'a str {
        self.fields.get(column).copied().unwrap_or_default()
    }

    // ANCHOR: fields
    /// What a column says, or the fault that it is not `wanted`.
    pub fn parse<T: FromStr>(&self, column: usize, wanted: &'static str) -> Result<T, TableError> {
        self.text(column).parse().map_err(|_| self.not(column, wanted))
    }

    /// A finite number.
    pub fn number(&self, column: usize) -> Result<f64, TableError> {
        let wanted = "a finite number";
        let number: f64 = self.parse(column, wanted)?;
        if number.is_finite() { Ok(number) } else { Err(self.not(column, wanted)) }
    }

    /// The finite numbers in three columns, from the one given.
    pub fn vector(&self, column: usize) -> Result<Vector3<f64>, TableError> {
        let [x, y, z] = [column, column + 1, column + 2].map(|column| self.number(column));
        Ok(Vector3::new(x?, y?, z?))
    }
    // ANCHOR_END: fields

    /// A time in nanoseconds.
    pub fn nanoseconds(&self, column: usize) -> Result<i64, TableError> {
        self.parse(column, "a time in whole nanoseconds")
    }

    /// The fault that a column is not what is wanted there.
    pub fn not(&self, column: usize, wanted: &'static str) -> TableError {
        let name = self.header.get(column).copied().unwrap_or_default();
        let fault = TableFault::Value { text: shortened(self.text(column)), wanted };
        TableError { column: Some(Column { number: column + 1, name }), ..self.fault(fault) }
    }

    /// A fault of the line as a whole.
    pub fn fault(&self, fault: TableFault) -> TableError {
        TableError { line: self.line, column: None, fault }
    }
}

/// The lines below a header that must be one of `headers`. There is at least one. Empty lines
/// do not count, and neither do a `#`, a byte-order mark or units in the header.
pub(super) fn rows<'a>(text: &'a str, headers: &[Header]) -> Result<Vec<Row<'a>>, TableError> {
    let text = text.trim_start_matches('\u{feff}');
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let mut lines = lines.filter(|(_, text)| !text.is_empty());
    let (mut end, names) = lines.next().unwrap_or((1, ""));
    let header = header(end, names, headers)?;
    let mut rows = Vec::new();
    for (line, text) in lines {
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        let (wanted, found) = (header.len(), fields.len());
        let row = Row { line, header, fields };
        if found != wanted {
            return Err(row.fault(TableFault::Fields { wanted, found }));
        }
        rows.push(row);
        end = line;
    }
    if rows.is_empty() {
        return Err(missing(end, "line below the names of its columns"));
    }
    Ok(rows)
}

/// The header whose names stand in a line; a unit in brackets may follow each.
fn header(number: usize, line: &str, headers: &[Header]) -> Result<Header, TableError> {
    let bare = |name: &'_ str| name.split(['[', '(']).next().unwrap_or_default().trim().to_owned();
    let names: Vec<String> = line.trim_start_matches('#').split(',').map(bare).collect();
    headers.iter().copied().find(|header| names == *header).ok_or_else(|| {
        let wanted: Vec<String> = headers.iter().map(|header| header.join(",")).collect();
        let fault = TableFault::Header { found: shortened(line), wanted: wanted.join("` or `") };
        TableError { line: number, column: None, fault }
    })
}

/// The fault that a file has none of something, told with its last line.
pub(super) fn missing(line: usize, what: &str) -> TableError {
    TableError { line, column: None, fault: TableFault::Missing { what: what.into() } }
}

/// Times must increase.
pub(super) fn in_order(before: Option<i64>, nanoseconds: i64) -> Result<(), TableFault> {
    match before {
        Some(before) if before >= nanoseconds => Err(TableFault::Order { before, nanoseconds }),
        _ => Ok(()),
    }
}

/// The rotation of a quaternion with an error of rounding.
pub(super) fn rotation(quaternion: Quaternion<f64>) -> Result<UnitQuaternion<f64>, TableFault> {
    let norm = quaternion.norm();
    if (norm - 1.0).abs() > 1e-3 {
        return Err(TableFault::Quaternion { norm });
    }
    Ok(UnitQuaternion::new_normalize(quaternion))
}

/// The beginning of a text that may be a whole file.
pub(super) fn shortened(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}

/// What is wrong with a table, and where. Whoever opened the file adds its name in front.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}{}: {fault}", .column.map_or_else(String::new, |column| format!(", {column}")))]
pub struct TableError {
    /// Counted from one, the header's line included.
    pub line: usize,
    /// `None` where the line as a whole is at fault.
    pub column: Option<Column>,
    /// What.
    pub fault: TableFault,
}

/// A column of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Counted from one.
    pub number: usize,
    /// As the header has it, without its unit.
    pub name: &'static str,
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column {} ({})", self.number, self.name)
    }
}

/// What can be wrong with a line of a table.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TableFault {
    /// The first line does not name the columns that should be there.
    #[error(
        "`{found}` does not name the columns of such a file; the first line must be `{wanted}`"
    )]
    Header {
        /// The beginning of the line.
        found: String,
        /// Names of the columns, for each kind of file that would do.
        wanted: String,
    },
    /// A line has too few or too many fields.
    #[error("{found} fields; there must be {wanted}, separated by commas")]
    Fields {
        /// How many there must be.
        wanted: usize,
        /// How many there are.
        found: usize,
    },
    /// A field says something else than it should.
    #[error("`{text}` is not {wanted}; mend the field or remove the line")]
    Value {
        /// The beginning of the field.
        text: String,
        /// What it should be.
        wanted: &'static str,
    },
    /// A time is not later than that of the line before, or of the picture before.
    #[error(
        "{nanoseconds} ns is not later than {before} ns before it; sort the lines by time and \
         remove repetitions"
    )]
    Order {
        /// The time before, in nanoseconds.
        before: i64,
        /// The time, in nanoseconds.
        nanoseconds: i64,
    },
    /// Something that may be said once is said again.
    #[error("{what} stands here for the second time; remove one of the two")]
    Twice {
        /// What.
        what: String,
    },
    /// Something that must be said is not.
    #[error("the file ends without any {what}; it is not complete")]
    Missing {
        /// What.
        what: String,
    },
    /// The orientation is none.
    #[error("the quaternion has norm {norm}; a rotation has norm 1")]
    Quaternion {
        /// Its norm.
        norm: f64,
    },
    /// The numbers of the camera are none.
    #[error(transparent)]
    Camera(#[from] PinholeError),
}
