//! The text formats of the EuRoC data sets [@burri2016].
//!
//! A file has a line of column names, which begins with `#`, and one line for each time, its
//! fields separated by commas.

use nalgebra::Quaternion;

use super::table::{self, Header, Row, TableError};
use crate::inertial::{ImuBias, ImuSample, NavState, StampedSample};
use crate::least_squares::Manifold;

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
const IMU: [Header; 1] =
    [&["timestamp", "w_RS_S_x", "w_RS_S_y", "w_RS_S_z", "a_RS_S_x", "a_RS_S_y", "a_RS_S_z"]];

/// Two styles: that of the data set, and a shorter one of corrected files.
const GROUND_TRUTH: [Header; 2] = [
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
/// [`TableError`] tells a line that is not as it should be.
pub fn read_imu(text: &str) -> Result<Vec<StampedSample>, TableError> {
    let mut samples = Vec::new();
    for row in table::rows(text, &IMU)? {
        let reading = reading(&row, row.nanoseconds(0)?, 1, samples.last())?;
        samples.push(reading);
    }
    Ok(samples)
}

/// A reading, of the gyroscope in the three columns from the one given, then of the accelerometer.
pub(super) fn reading(
    row: &Row<'_>,
    nanoseconds: i64,
    column: usize,
    before: Option<&StampedSample>,
) -> Result<StampedSample, TableError> {
    let (gyro, accelerometer) = (row.vector(column)?, row.vector(column + 3)?);
    let before = before.map(|before| before.nanoseconds);
    table::in_order(before, nanoseconds).map_err(|fault| row.fault(fault))?;
    Ok(StampedSample { nanoseconds, sample: ImuSample { gyro, accelerometer } })
}
// ANCHOR_END: read_imu

// ANCHOR: read_ground_truth
/// The states in the text of a `state_groundtruth_estimate0/data.csv`, with either of the two
/// headers that occur. Quaternions with an error of rounding are made unit ones.
///
/// # Errors
///
/// [`TableError`] tells a line that is not as it should be.
pub fn read_ground_truth(text: &str) -> Result<Vec<GroundTruth>, TableError> {
    let mut states: Vec<GroundTruth> = Vec::new();
    for row in table::rows(text, &GROUND_TRUTH)? {
        let state = ground_truth(&row)?;
        let before = states.last().map(|before| before.nanoseconds);
        table::in_order(before, state.nanoseconds).map_err(|fault| row.fault(fault))?;
        states.push(state);
    }
    Ok(states)
}

fn ground_truth(row: &Row<'_>) -> Result<GroundTruth, TableError> {
    let nanoseconds = row.nanoseconds(0)?;
    let (w, imaginary) = (row.number(4)?, row.vector(5)?);
    let rotation = table::rotation(Quaternion::from_parts(w, imaginary));
    let world_from_body = rotation.map_err(|fault| row.fault(fault))?.to_rotation_matrix();
    let (position, velocity) = (row.vector(1)?, row.vector(8)?);
    let state = NavState { world_from_body, position, velocity };
    let bias = ImuBias { gyro: row.vector(11)?, accelerometer: row.vector(14)? };
    Ok(GroundTruth { nanoseconds, state, bias })
}
// ANCHOR_END: read_ground_truth

// ANCHOR: truth_at
/// What a ground truth says about a time, in nanoseconds on the sensor's clock: a state that stands
/// within a millisecond of it, otherwise what lies on the straight line between the two states around
/// it. `None` where these are more than a tenth of a second apart, and before the first and after the
/// last.
pub fn truth_at(truth: &[GroundTruth], nanoseconds: i64) -> Option<GroundTruth> {
    let next = truth.partition_point(|state| state.nanoseconds < nanoseconds);
    let [before, after] = [next.checked_sub(1), Some(next)].map(|at| truth.get(at?));
    let off = |state: &&GroundTruth| state.nanoseconds.abs_diff(nanoseconds);
    let nearest = before.into_iter().chain(after).min_by_key(off)?;
    if off(&nearest) < SAME_TIME {
        return Some(*nearest);
    }
    let (before, after) = before.zip(after)?;
    let apart = before.nanoseconds.abs_diff(after.nanoseconds);
    let part = before.nanoseconds.abs_diff(nanoseconds) as f64 / apart as f64;
    (apart <= LONGEST_LINE).then(|| GroundTruth {
        nanoseconds,
        state: on_line(&before.state, &after.state, part),
        bias: on_line(&before.bias, &after.bias, part),
    })
}
// ANCHOR_END: truth_at

/// Times that differ by less are the same, in nanoseconds.
const SAME_TIME: u64 = 1_000_000;
/// Between states that are farther apart nothing is said, in nanoseconds.
const LONGEST_LINE: u64 = 100_000_000;

/// The value that a part of the step from one to another reaches.
fn on_line<V: Manifold>(from: &V, to: &V, part: f64) -> V {
    let mut step = vec![0.0; from.dimension()];
    from.local(to, &mut step);
    step.iter_mut().for_each(|number| *number *= part);
    from.retract(&step)
}
