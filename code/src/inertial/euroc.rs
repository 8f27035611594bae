//! The text formats of the EuRoC data sets [@burri2016].
//!
//! A file has a line of column names, which begins with `#`, and one line for each time, its
//! fields separated by commas. Nothing here opens files.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use thiserror::Error;

use super::{ImuBias, ImuSample, NavState, StampedSample};

// ANCHOR: ground_truth
/// What a EuRoC ground truth says about one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundTruth {
    /// Time, in nanoseconds on the clock of the inertial sensor.
    pub nanoseconds: i64,
    /// State of the body, whose frame is that of the inertial sensor.
    pub state: NavState,
    /// Biases of the inertial sensor.
    pub bias: ImuBias,
}
// ANCHOR_END: ground_truth

/// Names of the columns, without units, as the files of the data set have them.
const IMU: [&[&str]; 1] =
    [&["timestamp", "w_RS_S_x", "w_RS_S_y", "w_RS_S_z", "a_RS_S_x", "a_RS_S_y", "a_RS_S_z"]];

/// Two styles: that of the data set, and a shorter one of corrected files.
const GROUND_TRUTH: [&[&str]; 2] = [
    &[
        "timestamp",
        "p_RS_R_x",
        "p_RS_R_y",
        "p_RS_R_z",
        "q_RS_w",
        "q_RS_x",
        "q_RS_y",
        "q_RS_z",
        "v_RS_R_x",
        "v_RS_R_y",
        "v_RS_R_z",
        "b_w_RS_S_x",
        "b_w_RS_S_y",
        "b_w_RS_S_z",
        "b_a_RS_S_x",
        "b_a_RS_S_y",
        "b_a_RS_S_z",
    ],
    &[
        "time", "px", "py", "pz", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "bwx", "bwy", "bwz",
        "bax", "bay", "baz",
    ],
];

// ANCHOR: read_imu
/// The readings in the text of an `imu0/data.csv`.
///
/// # Errors
///
/// [`EurocError`] tells the first line that is not as it should be.
pub fn read_imu(text: &str) -> Result<Vec<StampedSample>, EurocError> {
    rows::<6>(text, &IMU)?
        .into_iter()
        .map(|Row { nanoseconds, values: [wx, wy, wz, ax, ay, az], .. }| {
            let (gyro, accelerometer) = (Vector3::new(wx, wy, wz), Vector3::new(ax, ay, az));
            Ok(StampedSample { nanoseconds, sample: ImuSample { gyro, accelerometer } })
        })
        .collect()
}
// ANCHOR_END: read_imu

// ANCHOR: read_ground_truth
/// The states in the text of a `state_groundtruth_estimate0/data.csv`, with either of the two
/// headers that occur. Quaternions with an error of rounding are made unit ones.
///
/// # Errors
///
/// [`EurocError`] tells the first line that is not as it should be.
pub fn read_ground_truth(text: &str) -> Result<Vec<GroundTruth>, EurocError> {
    rows::<16>(text, &GROUND_TRUTH)?.into_iter().map(ground_truth).collect()
}

fn ground_truth(row: Row<16>) -> Result<GroundTruth, EurocError> {
    let Row { line, nanoseconds, values } = row;
    let vector = |at: usize| Vector3::new(values[at], values[at + 1], values[at + 2]);
    let quaternion = Quaternion::new(values[3], values[4], values[5], values[6]);
    let norm = quaternion.norm();
    if (norm - 1.0).abs() > 1e-3 {
        return Err(EurocError { line, fault: EurocFault::Quaternion { norm } });
    }
    let world_from_body = UnitQuaternion::new_normalize(quaternion).to_rotation_matrix();
    let state = NavState { world_from_body, position: vector(0), velocity: vector(7) };
    let bias = ImuBias { gyro: vector(10), accelerometer: vector(13) };
    Ok(GroundTruth { nanoseconds, state, bias })
}
// ANCHOR_END: read_ground_truth

/// One line: a time and `N` numbers.
struct Row<const N: usize> {
    line: usize,
    nanoseconds: i64,
    values: [f64; N],
}

// ANCHOR: rows
/// The lines below the header, with times that increase.
fn rows<const N: usize>(text: &str, headers: &[&[&str]]) -> Result<Vec<Row<N>>, EurocError> {
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let (line, header) = lines.next().unwrap_or((1, ""));
    check_header(header, headers).map_err(|fault| EurocError { line, fault })?;
    let mut rows: Vec<Row<N>> = Vec::new();
    let mut end = line;
    for (line, fields) in lines.filter(|(_, fields)| !fields.is_empty()) {
        let row = row(line, fields).map_err(|fault| EurocError { line, fault })?;
        if let Some(before) = rows.last().filter(|before| before.nanoseconds >= row.nanoseconds) {
            let (before, nanoseconds) = (before.nanoseconds, row.nanoseconds);
            return Err(EurocError { line, fault: EurocFault::Order { before, nanoseconds } });
        }
        rows.push(row);
        end = line;
    }
    if rows.is_empty() {
        return Err(EurocError { line: end, fault: EurocFault::Empty });
    }
    Ok(rows)
}
// ANCHOR_END: rows

/// The names must be those of one of the headers; a unit in brackets may follow each.
fn check_header(line: &str, headers: &[&[&str]]) -> Result<(), EurocFault> {
    let names = line.trim_start_matches('\u{feff}').strip_prefix('#').unwrap_or_default();
    let bare = |name: &str| name.split(['[', '(']).next().unwrap_or_default().trim().to_string();
    let found: Vec<String> = names.split(',').map(bare).collect();
    if headers.iter().any(|header| found == *header) {
        return Ok(());
    }
    Err(EurocFault::Header { found: line.into(), wanted: headers[0].join(", ") })
}

// ANCHOR: row
fn row<const N: usize>(line: usize, text: &str) -> Result<Row<N>, EurocFault> {
    let mut fields = text.split(',').map(str::trim);
    let found = fields.clone().count();
    if found != N + 1 {
        return Err(EurocFault::Fields { wanted: N + 1, found });
    }
    let time = fields.next().unwrap_or_default();
    let nanoseconds = time.parse().map_err(|_| EurocFault::Time { text: time.into() })?;
    let mut values = [0.0; N];
    for (value, field) in values.iter_mut().zip(fields) {
        let number = field.parse().ok().filter(|number: &f64| number.is_finite());
        *value = number.ok_or_else(|| EurocFault::Number { text: field.into() })?;
    }
    Ok(Row { line, nanoseconds, values })
}
// ANCHOR_END: row

/// What is wrong with a EuRoC file, and in which line, counted from one.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}: {fault}")]
pub struct EurocError {
    /// Where.
    pub line: usize,
    /// What.
    pub fault: EurocFault,
}

/// What can be wrong with a line of a EuRoC file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EurocFault {
    /// The first line does not name the columns, or not those that should be there.
    #[error("`{found}` is not a header of such a file; its columns must be #{wanted}")]
    Header {
        /// The line.
        found: String,
        /// Names of the columns.
        wanted: String,
    },
    /// There are only names.
    #[error("the file ends without any line of numbers; it is not complete")]
    Empty,
    /// A line has too few or too many fields.
    #[error("{found} fields; there must be {wanted}, separated by commas")]
    Fields {
        /// How many there must be.
        wanted: usize,
        /// How many there are.
        found: usize,
    },
    /// The first field is no time.
    #[error("`{text}` is not a time in whole nanoseconds")]
    Time {
        /// The field.
        text: String,
    },
    /// Another field is no number.
    #[error("`{text}` is not a finite number")]
    Number {
        /// The field.
        text: String,
    },
    /// The time is not later than that of the line before.
    #[error("{nanoseconds} ns is not later than {before} ns before it; sort the lines")]
    Order {
        /// The time before, in nanoseconds.
        before: i64,
        /// The time, in nanoseconds.
        nanoseconds: i64,
    },
    /// The orientation is none.
    #[error("the quaternion has norm {norm}; a rotation has norm 1")]
    Quaternion {
        /// Its norm.
        norm: f64,
    },
}
