//! Readings and feature tracks of one flight in one file, as GTSAM's examples of visual-inertial
//! odometry have them.
//!
//! The first of its columns, `row_type`, says what a line is. A line `meta` has a key and a value,
//! among them the camera and its place on the body; a line `imu` is a reading, a line
//! `vision_feature` a feature in a picture. The columns of a kind are empty in the others. Not
//! read are the keys `eqf.*`, settings of the filter that the file was written for, the
//! derivatives of the biases, which are zero, and all that repeats something: `t_rel`, `seq`
//! and `frame_idx`.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Quaternion, Rotation3};

use super::euroc;
use super::table::{self, Header, Row, TableError, TableFault};
use super::tracks::{self, Feature, Picture};
use crate::inertial::{ImuBias, ImuSample, StampedSample, between};
use crate::manifold::so3;
use crate::reprojection::Pinhole;

// ANCHOR: recording
/// What a camera and an inertial sensor on one body recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The readings of the inertial sensor.
    pub samples: Vec<StampedSample>,
    /// What the camera saw, in normalized coordinates: its lens has been taken out.
    pub pictures: Vec<Picture>,
    /// Takes camera coordinates to body coordinates, as EuRoC's `T_BS`.
    pub body_from_camera: Isometry3<f64>,
    /// The camera, which says how many pixels a normalized coordinate is.
    pub camera: Pinhole,
}
// ANCHOR_END: recording

const HEADER: Header = &[
    "row_type",
    "t_abs",
    "t_rel",
    "seq",
    "frame_idx",
    "landmark_id",
    "gx",
    "gy",
    "gz",
    "ax",
    "ay",
    "az",
    "bgx",
    "bgy",
    "bgz",
    "bax",
    "bay",
    "baz",
    "u_norm",
    "v_norm",
    "key",
    "value",
];

/// Where the columns that are read begin, counted from zero.
mod at {
    pub const TIME: usize = 1;
    pub const TRACK: usize = 5;
    pub const READING: usize = 6;
    pub const PIXEL: usize = 18;
    pub const KEY: usize = 20;
    pub const VALUE: usize = 21;
}

/// The recording in the text of a file. Times are rounded as the file has them, to a quarter of a
/// microsecond: those of the data set had more digits than a float.
///
/// There must be the keys `measurement_space`, whose value is `normalized`; `T_ci_tx`, `T_ci_ty`,
/// `T_ci_tz` in metres; `T_ci_qw`, `T_ci_qx`, `T_ci_qy`, `T_ci_qz`; and `camera_fx`, `camera_fy`,
/// `camera_cx`, `camera_cy` in pixels.
///
/// The keys `T_ci_*` are the camera's pose on the body, [`Recording::body_from_camera`], and not
/// the inverse that the letters suggest: for EuRoC's flights they are the `T_BS` of its left
/// camera.
///
/// # Errors
///
/// [`TableError`] tells a line that is not as it should be, or what is missing.
pub fn read_recording(text: &str) -> Result<Recording, TableError> {
    let (mut samples, mut pictures, mut meta) = (Vec::new(), Vec::new(), Meta::default());
    for row in table::rows(text, &[HEADER])? {
        meta.last_line = row.line;
        match row.text(0) {
            "meta" => meta.add(row)?,
            "imu" => {
                let reading =
                    euroc::reading(&row, nanoseconds(&row)?, at::READING, samples.last())?;
                samples.push(reading);
            }
            "vision_feature" => {
                let pixel = tracks::pixel(&row, at::PIXEL)?;
                let feature =
                    Feature { track: tracks::track(&row, at::TRACK)?, pixel, right: None };
                let added = tracks::add(&mut pictures, nanoseconds(&row)?, feature);
                added.map_err(|fault| row.fault(fault))?;
            }
            _ => return Err(row.not(0, "a kind of line: meta, imu or vision_feature")),
        }
    }
    for (is_empty, what) in
        [(samples.is_empty(), "line `imu`"), (pictures.is_empty(), "line `vision_feature`")]
    {
        if is_empty {
            return Err(table::missing(meta.last_line, what));
        }
    }
    meta.is_normalized()?;
    let (body_from_camera, camera) = (meta.body_from_camera()?, meta.camera()?);
    Ok(Recording { samples, pictures, body_from_camera, camera })
}

/// A time in seconds, to the nanosecond and not by way of a float.
fn nanoseconds(row: &Row<'_>) -> Result<i64, TableError> {
    let (seconds, fraction) =
        row.text(at::TIME).split_once('.').unwrap_or((row.text(at::TIME), "0"));
    let are_digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let nanoseconds = || {
        let padded = format!("{fraction:0<9}");
        let fraction: i64 = padded[..9].parse().ok()?;
        seconds.parse::<i64>().ok()?.checked_mul(1_000_000_000)?.checked_add(fraction)
    };
    (are_digits(seconds) && are_digits(fraction))
        .then(nanoseconds)
        .flatten()
        .ok_or_else(|| row.not(at::TIME, "a time in seconds, written with digits and a point"))
}

/// The lines `meta` by their keys.
#[derive(Default)]
struct Meta<'a> {
    rows: BTreeMap<&'a str, Row<'a>>,
    last_line: usize,
}

impl<'a> Meta<'a> {
    fn add(&mut self, row: Row<'a>) -> Result<(), TableError> {
        let key = row.text(at::KEY);
        if self.rows.contains_key(key) {
            return Err(row.fault(TableFault::Twice { what: format!("the key `{key}`") }));
        }
        self.rows.insert(key, row);
        Ok(())
    }

    fn row(&self, key: &str) -> Result<&Row<'a>, TableError> {
        let missing =
            || table::missing(self.last_line, &format!("line `meta` with the key `{key}`"));
        self.rows.get(key).ok_or_else(missing)
    }

    fn number(&self, key: &str) -> Result<f64, TableError> {
        self.row(key)?.number(at::VALUE)
    }

    fn is_normalized(&self) -> Result<(), TableError> {
        let row = self.row("measurement_space")?;
        match row.text(at::VALUE) {
            "normalized" => Ok(()),
            _ => Err(row.not(at::VALUE, "`normalized`, the only coordinates that are read")),
        }
    }

    fn body_from_camera(&self) -> Result<Isometry3<f64>, TableError> {
        let [x, y, z] = ["T_ci_tx", "T_ci_ty", "T_ci_tz"].map(|key| self.number(key));
        let [w, i, j, k] = ["T_ci_qw", "T_ci_qx", "T_ci_qy", "T_ci_qz"].map(|key| self.number(key));
        let rotation = table::rotation(Quaternion::new(w?, i?, j?, k?));
        let rotation = match rotation {
            Ok(rotation) => rotation,
            Err(fault) => return Err(self.row("T_ci_qw")?.fault(fault)),
        };
        Ok(Isometry3::from_parts([x?, y?, z?].into(), rotation))
    }

    fn camera(&self) -> Result<Pinhole, TableError> {
        let [fx, fy, cx, cy] =
            ["camera_fx", "camera_fy", "camera_cx", "camera_cy"].map(|key| self.number(key));
        match Pinhole::new(fx?, fy?, cx?, cy?) {
            Ok(camera) => Ok(camera),
            Err(error) => Err(self.row(&format!("camera_{}", error.name()))?.fault(error.into())),
        }
    }
}

impl Recording {
    // ANCHOR: motion_beyond_turning
    /// How far features move from a picture to the next one beyond what they move because the
    /// camera turns, as the gyroscope has it: the median length, in normalized coordinates. `None`
    /// when no feature stands in two pictures with readings between them.
    ///
    /// The body's rotation R between the pictures turns a direction in the camera by
    /// R_bcᵀ Rᵀ R_bc. What remains is parallax, the bias and noise. So the `body_from_camera`
    /// that is the right way round leaves less than its inverse, wherever the body turns quickly.
    pub fn motion_beyond_turning(
        &self,
        body_from_camera: &Isometry3<f64>,
        bias: &ImuBias,
    ) -> Option<f64> {
        let mounting = body_from_camera.rotation.to_rotation_matrix();
        let mut lengths = Vec::new();
        for pair in self.pictures.windows(2) {
            let Some(turned) = self.turned(pair[0].nanoseconds, pair[1].nanoseconds, bias) else {
                continue;
            };
            let second_from_first = mounting.inverse() * turned.inverse() * mounting;
            for (first, second) in both(&pair[0], &pair[1]) {
                let ray = second_from_first * first.pixel.push(1.0);
                lengths.push((second.pixel - ray.xy() / ray.z).norm());
            }
        }
        lengths.sort_by(f64::total_cmp);
        lengths.get(lengths.len() / 2).copied()
    }
    // ANCHOR_END: motion_beyond_turning

    /// The body's rotation from one time to another: takes coordinates of the later body frame to
    /// the earlier one. `None` without readings.
    fn turned(&self, start: i64, end: i64, bias: &ImuBias) -> Option<Rotation3<f64>> {
        let window = between(&self.samples, start, end).ok()?;
        let steps = window.windows(2).map(|pair| {
            let rate = ImuSample::mean(&pair[0].sample, &pair[1].sample).corrected(bias).gyro;
            so3::exp(&(pair[0].seconds_to(&pair[1]) * rate))
        });
        Some(steps.fold(Rotation3::identity(), |turned, step| turned * step))
    }
}

/// The features that stand in both pictures.
fn both<'a>(
    first: &'a Picture,
    second: &'a Picture,
) -> impl Iterator<Item = (&'a Feature, &'a Feature)> {
    first.features.iter().filter_map(|feature| {
        let found = second.features.binary_search_by_key(&feature.track, |other| other.track);
        Some((feature, &second.features[found.ok()?]))
    })
}
