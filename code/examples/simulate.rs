//! Writes the recording of a simulated flight, and the truth about it, into a folder.
//!
//! ```text
//! cargo run --release -p vislam --example simulate -- \
//!     --seed N --out DIR [--flight NAME] [--seconds S] [--motion NAME]
//! ```
//!
//! | file | what |
//! | --- | --- |
//! | `imu.csv` | the readings, in the form of EuRoC's `imu0/data.csv` |
//! | `tracks.csv` | a line for each landmark in a picture: time on the camera's clock, track, pixel in the left and in the right image; the latter is empty where there is none |
//! | `ground_truth.csv` | states and biases at the pictures on the sensor's clock, in the form of EuRoC's `state_groundtruth_estimate0/data.csv` |
//! | `calibration.toml` | camera, rig, densities of the noise, size of gravity and rates |
//!
//! A flight is one of those of `FLIGHTS`: with two cameras and biases, or, with `--flight book --seed 0 --seconds 60`,
//! the one that runs through the book. A motion is one of those of `MOTIONS`; without one it is the figure-eight.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use vislam::inertial::ImuBias;
use vislam::simulation::{EulerAngles, Flight, FlightRecording, Trajectory};

const USAGE: &str =
    "usage: simulate --seed N --out DIR [--flight NAME] [--seconds S] [--motion NAME]";

type Kind = fn(Trajectory) -> Flight;

const FLIGHTS: [(&str, Kind); 2] = [("stereo", stereo), ("book", book)];

/// Twenty pictures a second from two cameras, and biases of the size of those of the EuRoC flights.
fn stereo(motion: Trajectory) -> Flight {
    let flight = Flight::new(motion).with_lever(LEVER);
    Flight { initial_bias: BIAS, baseline: Some(0.11), ..flight }
}

/// The flight of the book.
pub fn book(motion: Trajectory) -> Flight {
    Flight { picture_rate: 10.0, tracks: 40, ..Flight::new(motion).with_lever(LEVER) }
}

const LEVER: Vector3<f64> = Vector3::new(0.1, 0.05, -0.02);

type Motion = fn() -> Trajectory;

const MOTIONS: [(&str, Motion); 5] = [
    ("figure-eight", Trajectory::figure_eight),
    ("hover", Trajectory::hover),
    ("level-turn", || Trajectory::level_turn(1.0, 0.5)),
    ("straight", || Trajectory::constant_velocity(&Vector3::x(), EulerAngles::default())),
    ("turn-on-the-spot", || Trajectory::turn_on_the_spot(0.5)),
];

const BIAS: ImuBias = ImuBias {
    gyro: Vector3::new(-0.002, 0.021, 0.077),
    accelerometer: Vector3::new(-0.02, 0.13, 0.06),
};

const LANDMARKS: usize = 800;

fn main() -> Result<(), Box<dyn Error>> {
    simulate(std::env::args().skip(1))
}

/// Writes what is asked for.
pub fn simulate(arguments: impl Iterator<Item = String>) -> Result<(), Box<dyn Error>> {
    let Arguments { seed, out, flight } = Arguments::read(arguments)?;
    let landmarks = flight.room(3.0, LANDMARKS, seed);
    let recording = landmarks.and_then(|landmarks| flight.record(&landmarks, seed));
    let recording = recording.map_err(|error| error.to_string())?;
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    for (name, text) in [
        ("imu.csv", imu(&recording)),
        ("tracks.csv", tracks(&recording)),
        ("ground_truth.csv", ground_truth(&recording)),
        ("calibration.toml", calibration(&flight)),
    ] {
        write(&out.join(name), &text)?;
    }
    let tracks = recording.truth.landmark_of_track.len();
    let (readings, pictures) = (recording.readings.len(), recording.pictures.len());
    println!("{readings} readings, {pictures} pictures, {tracks} tracks in {}", out.display());
    Ok(())
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))
}

struct Arguments {
    seed: u64,
    out: PathBuf,
    flight: Flight,
}

impl Arguments {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let (mut seed, mut out, mut seconds) = (None, None, 30.0);
        let (mut kind, mut motion) = (FLIGHTS[0].1, MOTIONS[0].1);
        while let Some(option) = arguments.next() {
            let value =
                arguments.next().ok_or_else(|| format!("{option} has no value; {USAGE}"))?;
            let bad = |_| format!("{option}: `{value}` is not such a number; {USAGE}");
            match option.as_str() {
                "--seed" => seed = Some(value.parse().map_err(|_| bad(()))?),
                "--out" => out = Some(PathBuf::from(value)),
                "--seconds" => seconds = value.parse().map_err(|_| bad(()))?,
                "--flight" => kind = called(&FLIGHTS, &option, &value)?,
                "--motion" => motion = called(&MOTIONS, &option, &value)?,
                _ => return Err(format!("{option} is not an option; {USAGE}")),
            }
        }
        let (Some(seed), Some(out)) = (seed, out) else { return Err(USAGE.into()) };
        Ok(Self { seed, out, flight: Flight { seconds, ..kind(motion()) } })
    }
}

/// What an option names.
fn called<T: Copy>(all: &[(&str, T)], option: &str, name: &str) -> Result<T, String> {
    let found = all.iter().find(|(known, _)| *known == name);
    let names = || all.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", ");
    let unknown = || format!("{option}: there is no `{name}`, only {}", names());
    found.map(|(_, named)| *named).ok_or_else(unknown)
}

/// The numbers as fields, each behind a comma, in as many digits as it takes to read them back.
fn fields<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> String {
    numbers.into_iter().fold(String::new(), |text, number| format!("{text},{number}"))
}

fn imu(recording: &FlightRecording) -> String {
    let mut text = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
                    a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
        .to_string();
    for reading in &recording.readings {
        let sample = reading.sample;
        text += &reading.nanoseconds.to_string();
        text += &fields(sample.gyro.iter().chain(&sample.accelerometer));
        text.push('\n');
    }
    text
}

fn tracks(recording: &FlightRecording) -> String {
    let stereo = recording.flight.baseline.is_some();
    let right = if stereo { ",u_right [px],v_right [px]" } else { "" };
    let mut text = format!("#timestamp [ns],track,u [px],v [px]{right}\n");
    for picture in &recording.pictures {
        for observation in &picture.features {
            text += &format!("{},{}", picture.nanoseconds, observation.track);
            text += &fields(&observation.pixel);
            if stereo {
                text += &observation.right.map_or(",,".into(), |right| fields(&right));
            }
            text.push('\n');
        }
    }
    text
}

fn ground_truth(recording: &FlightRecording) -> String {
    let mut text = "#timestamp,p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],\
                    q_RS_y [],q_RS_z [],v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1],\
                    b_w_RS_S_x [rad s^-1],b_w_RS_S_y [rad s^-1],b_w_RS_S_z [rad s^-1],\
                    b_a_RS_S_x [m s^-2],b_a_RS_S_y [m s^-2],b_a_RS_S_z [m s^-2]\n"
        .to_string();
    let truth = &recording.truth;
    for (picture, (state, bias)) in
        recording.pictures.iter().zip(truth.states.iter().zip(&truth.biases))
    {
        let rotation = state.pose().rotation;
        let quaternion = [rotation.w, rotation.i, rotation.j, rotation.k];
        let numbers = state.position.iter().chain(&quaternion).chain(&state.velocity);
        text += &recording.flight.rig.imu_nanoseconds(picture.nanoseconds).to_string();
        text += &fields(numbers.chain(&bias.gyro).chain(&bias.accelerometer));
        text.push('\n');
    }
    text
}

fn calibration(flight: &Flight) -> String {
    let (camera, rig, noise) = (flight.camera, flight.rig, flight.noise);
    let mut text = String::new();
    let mut section = |name: &str, values: &[(&str, f64)]| {
        text += &format!("[{name}]\n");
        // Debug writes a point or an exponent, without which TOML has no float.
        values.iter().for_each(|(key, value)| text += &format!("{key} = {value:?}\n"));
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
    if let Some(baseline) = flight.baseline {
        section("stereo", &[("baseline", baseline)]);
    }
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
    let matrix = rig.body_from_camera.to_homogeneous();
    text += "[extrinsics]\nbody_from_camera = [\n";
    for row in matrix.row_iter() {
        let _ = writeln!(text, "    {:?},", row.iter().collect::<Vec<_>>());
    }
    text + "]\n"
}

#[cfg(test)]
mod tests {
    use vislam::datasets::euroc::{read_ground_truth, read_imu};
    use vislam::datasets::tracks::read_tracks;

    use super::*;

    fn recording() -> FlightRecording {
        let mut flight = Flight { seconds: 1.0, initial_bias: BIAS, ..Flight::new(MOTIONS[0].1()) };
        flight.rig.time_offset = 0.02;
        flight.record(&flight.room(3.0, 300, 1).unwrap(), 1).unwrap()
    }

    #[test]
    fn a_written_flight_reads_back() {
        let recording = recording();
        assert_eq!(read_imu(&imu(&recording)).unwrap(), recording.readings);
        let truth = read_ground_truth(&ground_truth(&recording)).unwrap();
        assert_eq!(truth.len(), 21);
        for (k, read) in truth.iter().enumerate() {
            let state = recording.truth.states[k];
            assert_eq!(read.nanoseconds, 50_000_000 * k as i64);
            assert_eq!(read.state.position, state.position);
            assert_eq!(read.state.velocity, state.velocity);
            let error = read.state.world_from_body.matrix() - state.world_from_body.matrix();
            assert!(error.amax() < 1e-14);
            assert_eq!(read.bias, recording.truth.biases[k]);
        }
    }

    #[test]
    fn the_tracks_file_has_every_observation_on_the_cameras_clock() {
        let mut recording = recording();
        let text = tracks(&recording);
        assert_eq!(read_tracks(&text).unwrap(), recording.pictures);
        recording.flight.baseline = Some(0.1);
        assert!(tracks(&recording).lines().all(|line| line.split(',').count() == 6));
    }

    #[test]
    fn arguments_that_cannot_be_read_are_named() {
        let read = |line: &str| Arguments::read(line.split(' ').map(String::from)).err().unwrap();
        assert_eq!(read("--seed 1"), USAGE);
        assert!(read("--seed x --out a").starts_with("--seed: `x` is not such a number"));
        assert!(read("--out").starts_with("--out has no value"));
        assert!(read("--seed 1 --motion fall").starts_with("--motion: there is no `fall`, only"));
        let flights = "--flight: there is no `film`, only stereo, book";
        assert_eq!(read("--seed 1 --flight film"), flights);
        assert!(write(Path::new("no/such/file"), "").unwrap_err().starts_with("no/such/file: "));
    }
}
