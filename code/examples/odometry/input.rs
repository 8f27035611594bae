//! What was recorded, and by which sensors.

use vislam::datasets::calibration::{read_calibration, read_right_camera};
use vislam::datasets::euroc::read_imu;
use vislam::datasets::recording::read_recording;
use vislam::datasets::tracks::{Picture, read_tracks};
use vislam::inertial::StampedSample;
use vislam::initialization::Sensors;
use vislam::reprojection::{Pinhole, RigCamera};

use super::arguments::Arguments;
use super::read;

/// The calibration that is taken where no other is named.
const EUROC: &str = include_str!("euroc.toml");

/// A picture this many seconds outside the span counts as in it: files have rounded times.
const ROUNDING: f64 = 1e-6;

/// What was recorded, and by which sensors. There are readings, and pictures among them.
#[derive(Debug, Clone)]
pub struct Input {
    pub sensors: Sensors,
    /// The second camera of a pair.
    pub right: Option<RigCamera>,
    pub readings: Vec<StampedSample>,
    pub pictures: Vec<Picture>,
}

impl Input {
    /// What the files say. Pictures before the first reading or after the last one are left out.
    pub fn read(arguments: &Arguments) -> Result<Self, String> {
        let file = arguments.calibration.as_ref();
        let calibration = file.map(|file| read(file, read_calibration)).transpose()?;
        let right = file.map(|file| read(file, read_right_camera)).transpose()?.flatten();
        let euroc = || read_calibration(EUROC).map_err(|error| format!("euroc.toml: {error}"));
        let input = match arguments.files.as_slice() {
            [both] => {
                let recording = read(both, read_recording)?;
                let mut sensors = calibration.map_or_else(euroc, Ok)?;
                if arguments.calibration.is_none() {
                    sensors.camera = recording.camera;
                    sensors.rig.body_from_camera = recording.body_from_camera;
                }
                let sensors = normalized(sensors);
                Self {
                    sensors,
                    right: None,
                    readings: recording.samples,
                    pictures: recording.pictures,
                }
            }
            [imu, tracks] => {
                if calibration.is_none() {
                    eprintln!("no --calibration: camera and noise are those of EuRoC");
                }
                let sensors = calibration.map_or_else(euroc, Ok)?;
                Self {
                    sensors,
                    right,
                    readings: read(imu, read_imu)?,
                    pictures: read(tracks, read_tracks)?,
                }
            }
            _ => return Err("give one file or two".into()),
        };
        input.covered()
    }

    /// The pictures that were taken between two readings.
    fn covered(mut self) -> Result<Self, String> {
        let rig = self.sensors.rig;
        let time = |picture: &Picture| rig.imu_nanoseconds(picture.nanoseconds);
        let (first, last) = (self.readings[0], self.readings[self.readings.len() - 1]);
        let span = first.nanoseconds..=last.nanoseconds;
        let all = [&self.pictures[0], &self.pictures[self.pictures.len() - 1]].map(time);
        self.pictures.retain(|picture| span.contains(&time(picture)));
        if self.pictures.is_empty() {
            return Err(format!(
                "pictures from {} ns to {} ns on the sensor's clock do not meet readings from {} ns \
                 to {} ns; the two have different clocks, or time_offset is wrong",
                all[0],
                all[1],
                span.start(),
                span.end()
            ));
        }
        Ok(self)
    }

    /// The pictures that are asked for.
    pub fn chosen(mut self, arguments: &Arguments) -> Result<Self, String> {
        let Arguments { from, to, every, .. } = *arguments;
        let (rig, first) = (self.sensors.rig, self.readings[0].nanoseconds);
        let is_in_span = |picture: &Picture| {
            let time = rig.imu_nanoseconds(picture.nanoseconds);
            (from - ROUNDING..=to + ROUNDING).contains(&(1e-9 * time.saturating_sub(first) as f64))
        };
        self.pictures.retain(is_in_span);
        self.pictures = self.pictures.into_iter().step_by(every).collect();
        let found = self.pictures.len();
        if found < 2 {
            return Err(format!(
                "{found} pictures lie from {from} s to {to} s after the first reading, taking one of \
                 {every}; give a longer span"
            ));
        }
        Ok(self)
    }
}

/// The same sensors with pixels in normalized coordinates.
fn normalized(sensors: Sensors) -> Sensors {
    let pixel_sigma = sensors.pixel_sigma / sensors.camera.fx;
    let camera = Pinhole { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 };
    Sensors { camera, pixel_sigma, ..sensors }
}
