//! What students get of their flights, and what stays with the instructor.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use vislam::simulation::FlightRecording;

use super::answer::folder;
use super::canary;
use super::flights::{Announced, BIASES, Graded, OUTLIERS};
use super::key::{Exported, Key};
use crate::roster::Roster;

/// So many keys are drawn before something else than chance is to blame.
const DRAWN: usize = 3;

/// Where the key of an export is unless somebody says otherwise: beside its folder, not in it.
pub fn key_beside(dir: &Path) -> PathBuf {
    let mut name = dir.file_name().unwrap_or_default().to_owned();
    name.push("-key.toml");
    dir.with_file_name(name)
}

/// Draws a key and writes the flights of everybody on a roster into a folder that is not there yet.
/// The key goes beside it.
///
/// # Errors
///
/// A sentence when the roster cannot be read, something is there already or cannot be written.
pub fn export(dir: &Path, roster: &Path) -> Result<(), String> {
    let roster = Roster::read(roster)?;
    let key = export_drawn(dir, &roster, Key::draw, canary::sing)?;
    println!(
        "{} has the flights of {} folders; hand each one out to whom it is for. The key is in {}: \
         keep it, and keep it to yourself. Then: cargo grade fly run SUBMISSIONS --key {}",
        dir.display(),
        roster.folders().count(),
        key.display(),
        key.display()
    );
    Ok(())
}

/// The same with a key that is drawn and tried in some way, when there is where to write and for whom. The file of the
/// key comes back.
///
/// # Errors
///
/// As [`export`].
pub fn export_drawn(
    dir: &Path,
    roster: &Roster,
    draw: impl Fn() -> Result<Key, String>,
    sing: impl Fn(&Key) -> Result<(), String>,
) -> Result<PathBuf, String> {
    let folders = folders(dir, roster)?;
    let key = sung(draw, sing)?;
    let beside = key_beside(dir);
    Exported::new(&key, folders.clone()).write(&beside)?;
    for name in &folders {
        student(&dir.join(name), &key, name)?;
    }
    Ok(beside)
}

/// A drawn key on whose flights the canaries come out as they must. By chance some do not, and grading would find
/// that out when everybody has flown.
///
/// # Errors
///
/// A sentence when none is drawn, or they come out wrong on several.
pub fn sung(
    draw: impl Fn() -> Result<Key, String>,
    sing: impl Fn(&Key) -> Result<(), String>,
) -> Result<Key, String> {
    let mut wrong = String::new();
    for _ in 0..DRAWN {
        let key = draw()?;
        match sing(&key) {
            Ok(()) => return Ok(key),
            Err(why) => wrong = why,
        }
    }
    Err(format!("nothing is exported: on the flights of {DRAWN} keys in turn {wrong}"))
}

/// Whom to fly for, into a folder that is not there yet.
fn folders(dir: &Path, roster: &Roster) -> Result<Vec<String>, String> {
    let folders: Vec<String> = roster.folders().map(str::to_owned).collect();
    if folders.is_empty() {
        return Err("the roster has no rows, so there is nobody to fly for".to_owned());
    }
    if let Some(unfit) = folders.iter().find(|name| !is_plain(name)) {
        return Err(format!(
            "the roster's folder `{unfit}` cannot be the name of a folder; leave / and \\ out of it"
        ));
    }
    if let Some(there) = [dir.to_owned(), key_beside(dir)].into_iter().find(|it| it.exists()) {
        return Err(format!(
            "{} is there already; name a folder that is not there yet, so that nobody's flights \
             are written over, and no key",
            there.display()
        ));
    }
    Ok(folders)
}

/// Whether a name stays in the folder it is put into.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    let one = matches!(parts.next(), Some(std::path::Component::Normal(_)));
    one && parts.next().is_none() && !name.contains('\\')
}

/// The flights of one student.
fn student(dir: &Path, key: &Key, name: &str) -> Result<(), String> {
    let flights = Graded::all(key, name);
    for (number, flight) in flights.iter().enumerate() {
        let recording = flight.flown()?;
        let to = dir.join(folder(number));
        write(&to.join("imu.csv"), &imu(&recording))?;
        write(&to.join("tracks.csv"), &tracks(&recording))?;
        write(&to.join("calibration.toml"), &calibration(&recording))?;
    }
    write(&dir.join("README.md"), &readme(&flights))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::create_dir_all(path.parent().unwrap_or(path))
        .and_then(|()| fs::write(path, text))
        .map_err(|error| format!("cannot write {}: {error}", path.display()))
}

/// What a student is told of the flights.
fn readme(flights: &[Graded]) -> String {
    let mut table = String::from("| Flight | Announced |\n| --- | --- |\n");
    for (number, flight) in flights.iter().enumerate() {
        let announced = match flight.announced {
            Announced::Nothing => "nothing".to_owned(),
            Announced::Outliers => {
                format!("{} % of the pixels are anywhere in the image", 100.0 * OUTLIERS)
            }
            Announced::LateClock => format!(
                "the clock of the camera is late: `time_offset` of its calibration, {} s, is to be \
                 added to times of `tracks.csv`",
                flight.rig().time_offset
            ),
            Announced::Gap([from, to]) => {
                format!("no readings from {from} s to {to} s after the first one")
            }
        };
        let _ = writeln!(table, "| `{}` | {announced} |", folder(number));
    }
    let [gyro, accelerometer] = BIASES;
    include_str!("../../student/flights.md")
        .replace("{table}", table.trim_end())
        .replace("{gyro}", &gyro.to_string())
        .replace("{accelerometer}", &accelerometer.to_string())
}

/// The numbers as fields, each behind a comma, in as many digits as it takes to read them back.
fn fields<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> String {
    numbers.into_iter().fold(String::new(), |text, number| format!("{text},{number}"))
}

/// The readings as [`vislam::datasets::euroc::read_imu`] reads them.
fn imu(recording: &FlightRecording) -> String {
    let mut text = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
                    a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
        .to_owned();
    for reading in &recording.readings {
        let sample = &reading.sample;
        let numbers = fields(sample.gyro.iter().chain(&sample.accelerometer));
        let _ = writeln!(text, "{}{numbers}", reading.nanoseconds);
    }
    text
}

/// The tracks as [`vislam::datasets::tracks::read_tracks`] reads them.
fn tracks(recording: &FlightRecording) -> String {
    let mut text = "#timestamp [ns],track,u [px],v [px]\n".to_owned();
    for picture in &recording.pictures {
        for feature in &picture.features {
            let pixel = fields(&feature.pixel);
            let _ = writeln!(text, "{},{}{pixel}", picture.nanoseconds, feature.track);
        }
    }
    text
}

/// What is known of the sensors, as [`vislam::datasets::calibration::read_calibration`] reads it.
fn calibration(recording: &FlightRecording) -> String {
    let flight = &recording.flight;
    let (camera, rig, noise) = (flight.camera, flight.rig, flight.noise);
    let mut text = String::new();
    let mut section = |name: &str, values: &[(&str, f64)]| {
        let _ = writeln!(text, "[{name}]");
        // Debug writes a point or an exponent, without which TOML has no float.
        for (name, value) in values {
            let _ = writeln!(text, "{name} = {value:?}");
        }
        text.push('\n');
    };
    section(
        "camera",
        &[
            ("fx", camera.fx),
            ("fy", camera.fy),
            ("cx", camera.cx),
            ("cy", camera.cy),
            ("width", flight.image.x),
            ("height", flight.image.y),
            ("rate", flight.picture_rate),
            ("pixel_sigma", flight.pixel_sigma),
            ("time_offset", rig.time_offset),
        ],
    );
    section(
        "imu",
        &[
            ("rate", flight.imu_rate),
            ("gyro", noise.gyro),
            ("accelerometer", noise.accelerometer),
            ("gyro_walk", noise.gyro_walk),
            ("accelerometer_walk", noise.accelerometer_walk),
            ("gravity", flight.gravity.norm()),
        ],
    );
    text += "[extrinsics]\nbody_from_camera = [\n";
    for row in rig.body_from_camera.to_homogeneous().row_iter() {
        let _ = writeln!(text, "    {:?},", row.iter().collect::<Vec<_>>());
    }
    text + "]\n"
}
