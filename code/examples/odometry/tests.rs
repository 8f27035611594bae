//! What is asked for, read, estimated and written.

use std::path::PathBuf;

use nalgebra::{Matrix6, Vector3};
use vislam::simulation::{Flight, Trajectory};

use super::*;

#[path = "../filter.rs"]
#[allow(dead_code)]
mod filter;
#[path = "../simulate.rs"]
#[allow(dead_code)]
mod simulate;

/// A folder of a test of its own.
fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("vislam-odometry-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A folder with the files of a simulated flight.
fn simulated(name: &str, flight: &str) -> PathBuf {
    let folder = folder(name);
    let line = format!("{flight} --out {}", folder.display());
    simulate::simulate(line.split(' ').map(String::from)).unwrap();
    folder
}

fn asked(line: &str) -> Result<Arguments, String> {
    Arguments::read(line.split_whitespace().map(String::from))
}

/// What a last line says of a name.
fn said(line: &str, name: &str) -> f64 {
    let mut words = line.split_whitespace().skip_while(|word| *word != name);
    words.nth(1).unwrap().parse().unwrap()
}

#[test]
fn the_flight_of_the_book_is_the_one_that_the_filter_flies() {
    let written = Flight { seconds: 60.0, ..simulate::book(Trajectory::figure_eight()) };
    assert_eq!(format!("{written:?}"), format!("{:?}", filter::flight(60.0)));
}

#[test]
fn a_simulated_flight_goes_through_files_and_comes_out_near_its_truth() {
    let folder = simulated("simulated", "--seed 3 --seconds 6");
    let at = |file: &str| folder.join(file).display().to_string();
    let files =
        format!("{} {} --calibration {}", at("imu.csv"), at("tracks.csv"), at("calibration.toml"));
    let written =
        format!("--tum {} --covariance {} --ply {}", at("tum"), at("covariance"), at("ply"));
    let line = format!("{files} --truth {} --every 2 {written}", at("ground_truth.csv"));
    let told = flown(&asked(&line).unwrap()).unwrap();
    assert!(said(&told, "ate4_cm") < 3.0, "{told}");
    assert!(said(&told, "ate6_cm") <= said(&told, "ate4_cm"), "{told}");
    assert!(said(&told, "rpe1s_cm") < 3.0 && said(&told, "rpe5s_cm") < 6.0, "{told}");
    assert!(said(&told, "rpe10s_cm").is_nan(), "no ten seconds were flown: {told}");
    assert!(said(&told, "initialized_after_s") < 3.0, "{told}");
    assert!(said(&told, "scale_sigma_percent") < 10.0, "{told}");
    assert_eq!(said(&told, "states"), 61.0, "{told}");

    let written = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    let numbers = |file: &str, count: usize| {
        let text = written(file);
        let lines = text.lines().filter(|line| !line.starts_with('#'));
        let parsed = lines.map(|line| {
            let numbers = line.split(' ').map(|word| word.parse::<f64>().unwrap());
            let numbers: Vec<f64> = numbers.collect();
            assert_eq!(numbers.len(), count);
            numbers
        });
        parsed.collect::<Vec<_>>()
    };
    let (trajectory, covariances) = (numbers("tum", 8), numbers("covariance", 22));
    assert_eq!((trajectory.len(), covariances.len()), (61, 61));
    for (pose, covariance) in trajectory.iter().zip(&covariances) {
        assert_eq!(pose[0], covariance[0]);
        let mut matrix = Matrix6::zeros();
        let mut next = covariance[1..].iter();
        for row in 0..6 {
            for column in row..6 {
                matrix[(row, column)] = *next.next().unwrap();
                matrix[(column, row)] = matrix[(row, column)];
            }
        }
        assert!(matrix.cholesky().is_some(), "at {}", pose[0]);
    }
    let ply = written("ply");
    let of_colour = |colour: &str| ply.lines().filter(|line| line.ends_with(colour)).count();
    assert_eq!(of_colour(" 255 0 0"), 61);
    assert!(of_colour(" 160 160 160") > 100);

    // Without a truth, from somewhere to somewhere.
    let told = flown(&asked(&format!("{files} --from 0.5 --to 4 --every 4")).unwrap()).unwrap();
    assert!(
        told.starts_with("causal_ate4_cm nan  delayed_ate4_cm nan  ate4_cm nan  ate6_cm nan  rpe1s_cm nan  rpe5s_cm nan  rpe10s_cm nan")
    );
    assert_eq!(said(&told, "states"), 18.0, "{told}");

    // What is wrong with a file is said with its name and line.
    let broken = |file: &str, from: &str, to: &str| {
        let text = written(file).replacen(from, to, 1);
        std::fs::write(folder.join("broken"), text).unwrap();
        flown(&asked(&line.replace(&at(file), &at("broken"))).unwrap()).unwrap_err()
    };
    let third_number = |file: &str| {
        let text = written(file);
        let row = text.lines().nth(5).unwrap();
        let mut fields: Vec<&str> = row.split(',').collect();
        fields[2] = "NaN";
        (row.to_owned(), fields.join(","))
    };
    for (file, column) in
        [("imu.csv", "w_RS_S_y"), ("tracks.csv", "u"), ("ground_truth.csv", "p_RS_R_y")]
    {
        let (row, with_nan) = third_number(file);
        let error = broken(file, &row, &with_nan);
        let wanted =
            format!("{}: line 6, column 3 ({column}): `NaN` is not a finite number", at("broken"));
        assert!(error.starts_with(&wanted), "{error}");
    }
    let error = broken("calibration.toml", "fx = ", "f = ");
    assert!(error.contains("line 2: `camera.f` is no name of a calibration"), "{error}");
    std::fs::write(folder.join("broken"), "").unwrap();
    for file in ["imu.csv", "tracks.csv", "ground_truth.csv"] {
        let error = flown(&asked(&line.replace(&at(file), &at("broken"))).unwrap()).unwrap_err();
        assert!(error.contains("broken: line 1: `` does not name the columns"), "{error}");
    }
    // A clock of its own: an hour late.
    let late = |line: &str| {
        let (time, rest) = line.split_once(',').unwrap();
        match time.parse::<i64>() {
            Ok(time) => format!("{},{rest}", time + 3_600_000_000_000),
            Err(_) => line.to_owned(),
        }
    };
    let tracks: Vec<String> = written("tracks.csv").lines().map(late).collect();
    std::fs::write(folder.join("broken"), tracks.join("\n")).unwrap();
    let error =
        flown(&asked(&line.replace(&at("tracks.csv"), &at("broken"))).unwrap()).unwrap_err();
    assert!(error.contains("do not meet readings"), "{error}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_smoother_takes_the_second_camera_that_a_calibration_names() {
    let folder = simulated("pair", "--seed 5 --seconds 8");
    let at = |file: &str| folder.join(file).display().to_string();
    let text = std::fs::read_to_string(folder.join("calibration.toml")).unwrap();
    let without = text.lines().filter(|line| !line.starts_with("baseline"));
    std::fs::write(folder.join("one.toml"), without.collect::<Vec<_>>().join("\n")).unwrap();
    let [pair, one] = ["calibration.toml", "one.toml"].map(|calibration| {
        let (imu, tracks) = (at("imu.csv"), at("tracks.csv"));
        let files = format!("{imu} {tracks} --calibration {}", at(calibration));
        let line = format!("{files} --truth {} --estimator smoother", at("ground_truth.csv"));
        said(&flown(&asked(&line).unwrap()).unwrap(), "causal_ate4_cm")
    });
    assert!(pair < one && one < 10.0, "{pair} cm with a pair, {one} cm with one camera");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_was_followed_before_a_late_loss_is_written() {
    let folder = simulated("lost", "--seed 3 --seconds 6");
    let at = |file: &str| folder.join(file).display().to_string();
    let lines = std::fs::read_to_string(at("imu.csv")).unwrap();
    let lines: Vec<&str> = lines.lines().collect();
    let (before, after) = lines.split_at(lines.len() - 120);
    let gapped = [before, &after[60..]].concat().join("\n");
    std::fs::write(at("imu.csv"), gapped).unwrap();
    let files =
        format!("{} {} --calibration {}", at("imu.csv"), at("tracks.csv"), at("calibration.toml"));
    for estimator in ["smoother", "msckf"] {
        let told = flown(&asked(&format!("{files} --estimator {estimator}")).unwrap()).unwrap();
        assert!(said(&told, "states") > 30.0, "{estimator}: {told}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_cannot_be_asked_for_is_named() {
    let refused = |line: &str, said: &str| {
        let error = asked(line).unwrap_err();
        assert!(error.starts_with(said), "{line}: {error}");
    };
    refused("", arguments::USAGE);
    refused("a b c", arguments::USAGE);
    refused("a --from", "--from has no value");
    refused("a --from soon", "--from: `soon` is not a number of seconds");
    refused("a --from 5 --to 5", "there is nothing from 5 s to 5 s");
    refused("a --from NaN", "there is nothing from NaN s");
    refused("a --every 0", "--every: `0` is not a whole number above zero");
    refused(
        "a --estimator soon",
        "--estimator: there is no estimator “soon”; give one of batch, smoother",
    );
    refused("a --every 2 --start b", "--start brings its own states");
    refused("a --speed 3", "--speed is not an option");
    let error = flown(&asked("no/such/file").unwrap()).unwrap_err();
    assert!(error.starts_with("no/such/file: "), "{error}");
    let asked = asked("a --estimator msckf").unwrap();
    assert_eq!(asked.estimator, vislam::odometry::Estimator::Msckf);
}

#[test]
fn the_calibration_that_is_taken_without_another_one_can_be_read() {
    assert!(HELP.contains("body_from_camera"));
    let text = include_str!("euroc.toml");
    let sensors = vislam::datasets::calibration::read_calibration(text).unwrap();
    assert_eq!(sensors.noise, vislam::inertial::ImuNoise::euroc());
}

#[test]
fn an_export_that_does_not_fit_is_refused() {
    let error = Export::read("{\n  \"times\": [0, NaN]\n}").unwrap_err();
    assert!(error.contains("line 2"), "{error}");
    assert!(Export::read("").unwrap_err().contains("line 1"));
    assert!(Export::read("{}").unwrap_err().contains("missing field"));
}

/// States on a circle of two metres, ten in a second.
fn circle(seconds: f64) -> Estimate {
    let count = (10.0 * seconds) as usize + 1;
    let state = |k: usize| {
        let angle = 0.05 * k as f64;
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        vislam::inertial::NavState {
            world_from_body: turn,
            position: turn * Vector3::new(2.0, 0.0, 1.0),
            velocity: Vector3::zeros(),
        }
    };
    Estimate {
        nanoseconds: (0..count as i64).map(|k| 1_000_000_000 + 100_000_000 * k).collect(),
        states: (0..count).map(state).collect(),
        pose_covariances: vec![Matrix6::identity(); count],
        ..Estimate::nothing()
    }
}

#[test]
fn an_estimate_is_judged_by_what_no_choice_of_the_world_hides() {
    use vislam::datasets::euroc::GroundTruth;
    use vislam::inertial::{ImuBias, NavState};
    let estimate = circle(12.0);
    let turn = nalgebra::Rotation3::from_euler_angles(0.02, 0.0, 1.0);
    let both = estimate.nanoseconds.iter().zip(&estimate.states);
    let truth = both.map(|(time, state)| GroundTruth {
        nanoseconds: *time,
        state: NavState {
            world_from_body: turn * state.world_from_body,
            velocity: turn * state.velocity,
            position: turn * state.position + Vector3::new(5.0, 0.0, 0.0),
        },
        bias: ImuBias::default(),
    });
    let mut truth: Vec<GroundTruth> = truth.collect();
    let judged = Judged::of(&estimate, &truth);
    let [four, six] = judged.absolute;
    assert!(six < 1e-9 && (0.01..0.05).contains(&four), "{four} m and {six} m");
    assert!(judged.relative.iter().all(|error| *error < 1e-9), "{:?}", judged.relative);
    // A step in the middle: pairs across it are off by it, absolute errors by half.
    truth[61..].iter_mut().for_each(|truth| truth.state.position.z += 0.1);
    let judged = Judged::of(&estimate, &truth);
    let [second, five, ten] = judged.relative;
    // Of the pairs (0, 10), (5, 15), … (110, 120) two have the step between them; of those over ten
    // seconds all have.
    let expected = 0.1 * (2f64 / 23.0).sqrt();
    assert!((second - expected).abs() < 1e-9, "{second} m, {expected} m");
    assert!(second < five && five < ten && (ten - 0.1).abs() < 1e-9, "{:?}", judged.relative);
    // A truth of another time.
    truth.iter_mut().for_each(|truth| truth.nanoseconds += 3_600_000_000_000);
    let judged = Judged::of(&estimate, &truth);
    assert!(judged.absolute.iter().chain(&judged.relative).all(|error| error.is_nan()));
}
