//! What is known of a camera and an inertial sensor on one body, as names and values.
//!
//! A text is one of TOML with sections, of which this much is read: a line `[section]`, a line
//! `name = number`, and `body_from_camera`, which is a matrix in brackets, over one line or several.
//! What follows a `#` is a comment.
//!
//! | section | names |
//! | --- | --- |
//! | `camera` | `fx`, `fy`, `cx`, `cy` in pixels; `pixel_sigma`, the standard deviation of each coordinate of a pixel, if it is not one; `time_offset`, what to add to a time of the camera's clock, in seconds, if it is not zero; `time_offset_sigma`, its standard deviation, if it is to be estimated |
//! | `imu` | `gyro` in rad/s/√Hz, `accelerometer` in m/s²/√Hz, `gyro_walk` in rad/s²/√Hz, `accelerometer_walk` in m/s³/√Hz; `gravity`, its size, if it is not 9.81 m/s² |
//! | `stereo` | `baseline`, how far to the right of it there is a second camera of the same make that looks the same way, in metres, if there is one |
//! | `extrinsics` | `body_from_camera`, the 4×4 matrix that takes camera coordinates to body coordinates, row by row; `translation_sigma` in metres and `rotation_sigma` in radians, its standard deviations, if it is to be estimated |
//!
//! The size of the image and rates may be said too; nothing is made of them.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Matrix3, Matrix4, Rotation3, UnitQuaternion};
use thiserror::Error;

use crate::inertial::{Calibrated, CameraImu, GRAVITY, ImuNoise, NoiseError};
use crate::initialization::Sensors;
use crate::reprojection::{Pinhole, PinholeError, RigCamera};
use crate::two_views::StereoPinhole;

/// Every name that may be said, with its section.
const NAMES: [&str; 20] = [
    "camera.fx",
    "camera.fy",
    "camera.cx",
    "camera.cy",
    "camera.width",
    "camera.height",
    "camera.rate",
    "camera.pixel_sigma",
    "camera.time_offset",
    CLOCK_SIGMA,
    BASELINE,
    "imu.rate",
    "imu.gyro",
    "imu.accelerometer",
    "imu.gyro_walk",
    "imu.accelerometer_walk",
    "imu.gravity",
    MOUNTING,
    MOUNTING_SIGMAS[0],
    MOUNTING_SIGMAS[1],
];

/// What makes a pair of the camera.
const BASELINE: &str = "stereo.baseline";

/// What lets something be estimated.
const CLOCK_SIGMA: &str = "camera.time_offset_sigma";
const MOUNTING_SIGMAS: [&str; 2] = ["extrinsics.translation_sigma", "extrinsics.rotation_sigma"];

/// The one name whose value is no number.
const MOUNTING: &str = "extrinsics.body_from_camera";

/// By how much a product of columns of a rotation may differ from that of the identity.
const ROUNDING: f64 = 1e-3;

// ANCHOR: read_calibration
/// What a text says of the sensors. The clock and the place of the camera are estimated when it says how
/// uncertain they are.
///
/// # Errors
///
/// [`CalibrationError`] tells a line that is not as it should be, or what is missing.
pub fn read_calibration(text: &str) -> Result<Sensors, CalibrationError> {
    let said = Said::read(text)?;
    let [fx, fy, cx, cy] =
        ["camera.fx", "camera.fy", "camera.cx", "camera.cy"].map(|name| said.number(name));
    let camera = Pinhole::new(fx?, fy?, cx?, cy?);
    let of_camera =
        |error: PinholeError| said.fault(&format!("camera.{}", error.name()), error.into());
    let noise = ImuNoise {
        gyro: said.number("imu.gyro")?,
        accelerometer: said.number("imu.accelerometer")?,
        gyro_walk: said.number("imu.gyro_walk")?,
        accelerometer_walk: said.number("imu.accelerometer_walk")?,
    };
    let of_noise = |error: NoiseError| said.fault(&format!("imu.{}", error.name), error.into());
    noise.check().map_err(of_noise)?;
    let time_offset = said.number_or("camera.time_offset", 0.0)?;
    Ok(Sensors {
        camera: camera.map_err(of_camera)?,
        pixel_sigma: said.positive("camera.pixel_sigma", 1.0)?,
        noise,
        rig: CameraImu { body_from_camera: said.body_from_camera()?, time_offset },
        calibrated: said.calibrated()?,
        gravity: said.positive("imu.gravity", GRAVITY.norm())?,
    })
}
// ANCHOR_END: read_calibration

/// The second camera of a pair, beside the one of [`read_calibration`]. `None` when a text says nothing of
/// it.
///
/// # Errors
///
/// As [`read_calibration`], and when the baseline is not positive.
pub fn read_right_camera(text: &str) -> Result<Option<RigCamera>, CalibrationError> {
    let camera = read_calibration(text)?.camera;
    let said = Said::read(text)?;
    if !said.says(BASELINE) {
        return Ok(None);
    }
    let pair = StereoPinhole { camera, baseline: said.positive(BASELINE, 1.0)? };
    Ok(Some(RigCamera { camera, camera_from_first: pair.right_from_left() }))
}

/// What a text says, by name: the line and the value.
struct Said<'a> {
    values: BTreeMap<&'static str, (usize, String)>,
    last_line: usize,
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
}

impl<'a> Said<'a> {
    fn read(text: &'a str) -> Result<Self, CalibrationError> {
        let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
        let mut said = Self { values: BTreeMap::new(), last_line: 1, lines };
        let mut section = String::new();
        while let Some(content) = said.next_line() {
            let line = said.last_line;
            let at = |fault| CalibrationError { line, fault };
            let name = content.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
            if content.is_empty() {
                continue;
            } else if let Some(name) = name {
                section = name.trim().to_owned();
            } else if let Some((name, value)) = content.split_once('=') {
                let name = format!("{section}.{}", name.trim());
                let value = said.whole(value.trim());
                let known = NAMES.iter().find(|known| **known == name);
                let name = known.ok_or_else(|| at(CalibrationFault::Unknown { name }))?;
                if said.values.insert(name, (line, value)).is_some() {
                    return Err(at(CalibrationFault::Twice { name }));
                }
            } else {
                return Err(at(CalibrationFault::Line { text: content.into() }));
            }
        }
        Ok(said)
    }

    /// The next line without its comment.
    fn next_line(&mut self) -> Option<&'a str> {
        let (index, line) = self.lines.next()?;
        self.last_line = index + 1;
        Some(line.split('#').next().unwrap_or_default().trim())
    }

    /// A value with the lines that it goes on in, until its brackets are closed.
    fn whole(&mut self, first: &str) -> String {
        let (mut value, mut open) = (first.to_owned(), open_brackets(first));
        while open > 0 {
            let Some(line) = self.next_line() else { break };
            value.push(' ');
            value += line;
            open += open_brackets(line);
        }
        value
    }

    /// A fault of what a name says, or of the whole text when nothing says it.
    fn fault(&self, name: &str, fault: CalibrationFault) -> CalibrationError {
        let line = self.values.get(name).map_or(self.last_line, |(line, _)| *line);
        CalibrationError { line, fault }
    }

    fn text(&self, name: &'static str) -> Result<&str, CalibrationError> {
        let missing = || self.fault(name, CalibrationFault::Missing { name });
        self.values.get(name).map(|(_, value)| value.as_str()).ok_or_else(missing)
    }

    fn number(&self, name: &'static str) -> Result<f64, CalibrationError> {
        let text = self.text(name)?;
        let number = finite(text);
        number.ok_or_else(|| self.fault(name, CalibrationFault::Number { text: text.into() }))
    }

    fn number_or(&self, name: &'static str, otherwise: f64) -> Result<f64, CalibrationError> {
        if self.says(name) { self.number(name) } else { Ok(otherwise) }
    }

    fn positive(&self, name: &'static str, otherwise: f64) -> Result<f64, CalibrationError> {
        let value = self.number_or(name, otherwise)?;
        let fault = || self.fault(name, CalibrationFault::Positive { name, value });
        (value > 0.0).then_some(value).ok_or_else(fault)
    }

    fn says(&self, name: &'static str) -> bool {
        self.values.contains_key(name)
    }

    /// A number above zero that has to be there.
    fn sigma(&self, name: &'static str) -> Result<f64, CalibrationError> {
        self.text(name)?;
        self.positive(name, 1.0)
    }

    fn calibrated(&self) -> Result<Calibrated, CalibrationError> {
        let clock = self.says(CLOCK_SIGMA).then(|| self.sigma(CLOCK_SIGMA));
        let [shift, turn] = MOUNTING_SIGMAS;
        let mounting = (self.says(shift) || self.says(turn))
            .then(|| Ok([self.sigma(shift)?, self.sigma(turn)?]));
        Ok(Calibrated { extrinsics: mounting.transpose()?, time_offset: clock.transpose()? })
    }

    fn body_from_camera(&self) -> Result<Isometry3<f64>, CalibrationError> {
        let text = self.text(MOUNTING)?.replace(['[', ']', ','], " ");
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(finite).collect();
        let transform = numbers.and_then(|numbers| transform(&numbers));
        transform.ok_or_else(|| self.fault(MOUNTING, CalibrationFault::Transform))
    }
}

/// How many brackets a text opens beyond those that it closes.
fn open_brackets(text: &str) -> isize {
    let count = |bracket: char| text.matches(bracket).count() as isize;
    count('[') - count(']')
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The transform of sixteen numbers, row by row, if it is one but for its rounding.
fn transform(numbers: &[f64]) -> Option<Isometry3<f64>> {
    let matrix = (numbers.len() == 16).then(|| Matrix4::from_row_slice(numbers))?;
    let turn: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into();
    let is_rotation = (turn.transpose() * turn - Matrix3::identity()).amax() < ROUNDING;
    let ends = matrix.row(3) == Matrix4::identity().row(3);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
    let place = matrix.fixed_view::<3, 1>(0, 3).into_owned();
    (is_rotation && ends && turn.determinant() > 0.0)
        .then(|| Isometry3::from_parts(place.into(), UnitQuaternion::new_normalize(*rotation)))
}

/// What is wrong with a calibration, and in which line, counted from one. Whoever opened the file adds
/// its name in front.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}: {fault}")]
pub struct CalibrationError {
    /// Where.
    pub line: usize,
    /// What.
    pub fault: CalibrationFault,
}

/// What can be wrong with a calibration.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibrationFault {
    /// A line is none of those that are read.
    #[error("`{text}` is neither a `[section]` nor a `name = value`")]
    Line {
        /// The line.
        text: String,
    },
    /// A name is none that a calibration has.
    #[error("`{name}` is no name of a calibration; mend it or remove the line")]
    Unknown {
        /// The name, with its section.
        name: String,
    },
    /// A name is said again.
    #[error("`{name}` stands here for the second time; remove one of the two")]
    Twice {
        /// The name, with its section.
        name: &'static str,
    },
    /// A name is not said.
    #[error("the file ends without `{name}`, which is a section and a name; it is not complete")]
    Missing {
        /// The name, with its section.
        name: &'static str,
    },
    /// A value is no number.
    #[error("`{text}` is not a finite number")]
    Number {
        /// The value.
        text: String,
    },
    /// A number is not above zero.
    #[error("`{name}` is {value}; it must be above zero")]
    Positive {
        /// The name, with its section.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// The matrix is no transform.
    #[error(
        "`body_from_camera` is no transform; give sixteen finite numbers row by row, a rotation with \
         a translation beside it, and 0, 0, 0, 1 at the end"
    )]
    Transform,
    /// The numbers of the camera are none.
    #[error(transparent)]
    Camera(#[from] PinholeError),
    /// The noise is none.
    #[error(transparent)]
    Noise(#[from] NoiseError),
}
