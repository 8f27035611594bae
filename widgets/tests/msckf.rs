//! What the picture of the filter shows is what the library flies, and its controls do what they say.

use nalgebra::{Matrix3, Vector3};
use vislam::consistency::Policy;
use vislam::inertial::{ImuNoise, NavState};
use vislam::msckf::{Msckf, MsckfOptions, PictureReport, Start};
use vislam::simulation::{Flight, FlightRecording, Trajectory};
use widgets::msckf::{Filter, SIGMAS};
use widgets::{Player, Session, Widget};

const ERROR: &str = "Position error";
const SIGMA: &str = "Reported σ of the position, three axes";
const YAW_ERROR: &str = "Yaw error";
const YAW_SIGMA: &str = "Reported σ of the yaw";
const YAW_RATIO: &str = "The same, over that at the start";
const NEES: &str = "NEES of the position, mean until now";
const YAW_NEES: &str = "NEES of the yaw, mean until now";
const USED: &str = "Tracks used";
const GATED: &str = "Tracks refused by the gate";
const OTHERS: &str = "Tracks too short, or without a landmark";

/// The whole flight.
const LANDED: (&str, f64) = ("time", 30.0);
const LATEST: (&str, f64) = ("landmarks", 1.0);
const FIRST: (&str, f64) = ("landmarks", 2.0);

type Settings<'a> = &'a [(&'a str, f64)];

fn session(settings: Settings) -> Session<Filter> {
    Session::with(settings).unwrap_or_else(|| panic!("{settings:?}"))
}

fn shown(settings: Settings) -> impl Fn(&str) -> f64 + use<> {
    let readings = session(settings).readings();
    move |label| {
        let found = readings.iter().find(|(known, _)| *known == label);
        found.unwrap_or_else(|| panic!("no reading {label}")).1
    }
}

/// The mean of a reading over a few flights.
fn mean(label: &str, settings: Settings) -> f64 {
    let seeds = [2.0, 5.0, 9.0, 14.0];
    let of = |seed| shown(&[settings, &[("seed", seed)]].concat())(label);
    seeds.into_iter().map(of).sum::<f64>() / seeds.len() as f64
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{found} {expected}");
}

/// A flight of 12 seconds, as the controls stand at the start but for what a test changes.
fn recorded(change: impl Fn(&mut Flight), seed: u64) -> FlightRecording {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let mut flight = Flight {
        picture_rate: 10.0,
        tracks: 20,
        outliers: 0.01,
        ..Flight::new(Trajectory::figure_eight()).with_lever(lever)
    };
    change(&mut flight);
    flight.record(&flight.room(3.0, 240, seed).unwrap(), seed).unwrap()
}

/// What the readings have to be, from readings and pictures that are given to the filter one by one.
fn flown(recording: &FlightRecording, options: MsckfOptions, seed: u64, seconds: f64) -> [f64; 10] {
    let start = Start::drawn(recording, &SIGMAS, seed).unwrap();
    let mut filter = Msckf::new(options, &start).unwrap();
    let mut readings = recording.readings.iter();
    let (mut reports, mut nees, mut yaw_nees) = (Vec::new(), Vec::new(), Vec::new());
    let mut yaw_sigmas = Vec::new();
    let mut last = [0.0; 4];
    for (picture, truth) in recording.pictures.iter().zip(&recording.truth.states) {
        if picture.nanoseconds as f64 > 1e9 * seconds + 1.0 {
            break;
        }
        for reading in readings.by_ref() {
            filter.reading(*reading).unwrap();
            if reading.nanoseconds >= picture.nanoseconds {
                break;
            }
        }
        reports.push(filter.picture(picture).unwrap());
        let (error, sigma) = position(&filter, truth);
        let (yaw_error, yaw_sigma) = yaw(&filter, truth);
        last = [100.0 * error.norm(), 100.0 * sigma.trace().sqrt(), yaw_error, yaw_sigma];
        nees.push(error.dot(&(sigma.try_inverse().unwrap() * error)) / 3.0);
        yaw_nees.push((yaw_error / yaw_sigma).powi(2));
        yaw_sigmas.push(yaw_sigma);
    }
    let sum = |of: fn(&PictureReport) -> usize| reports.iter().map(of).sum::<usize>() as f64;
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    let [error, sigma, yaw_error, yaw_sigma] = last;
    [
        error,
        sigma,
        yaw_error.to_degrees(),
        yaw_sigma.to_degrees(),
        yaw_sigma / yaw_sigmas[0],
        mean(&nees),
        mean(&yaw_nees),
        sum(|report| report.used),
        sum(|report| report.refused.gated),
        sum(|report| report.refused.without_landmark()),
    ]
}

fn position(filter: &Msckf, truth: &NavState) -> (Vector3<f64>, Matrix3<f64>) {
    let covariance = filter.covariance().fixed_view::<3, 3>(6, 6).into_owned();
    (truth.position - filter.state().position, covariance)
}

/// The turn that leads from the estimate to the truth, about the vertical, and its standard deviation.
fn yaw(filter: &Msckf, truth: &NavState) -> (f64, f64) {
    let estimate = filter.state().world_from_body;
    let turn = (truth.world_from_body * estimate.inverse()).scaled_axis();
    let vertical = estimate.inverse() * Vector3::z();
    let covariance = filter.covariance().fixed_view::<3, 3>(0, 0).into_owned();
    (turn.z, vertical.dot(&(covariance * vertical)).sqrt())
}

fn shows(settings: Settings, expected: [f64; 10]) {
    let shown = shown(settings);
    let labels =
        [ERROR, SIGMA, YAW_ERROR, YAW_SIGMA, YAW_RATIO, NEES, YAW_NEES, USED, GATED, OTHERS];
    labels.into_iter().zip(expected).for_each(|(label, expected)| close(shown(label), expected));
}

#[test]
fn at_the_start_it_shows_what_the_library_flies() {
    let recording = recorded(|_| (), 1);
    let options = MsckfOptions::of_flight(&recording.flight);
    shows(&[], flown(&recording, options, 1, 12.0));
}

#[test]
fn with_all_controls_moved_it_shows_what_the_library_flies() {
    let euroc = ImuNoise::euroc();
    let noisy = |flight: &mut Flight| {
        flight.tracks = 26;
        flight.pixel_sigma = 2.0;
        flight.outliers = 0.05;
        flight.noise = ImuNoise {
            gyro: 3.0 * euroc.gyro,
            accelerometer: 3.0 * euroc.accelerometer,
            gyro_walk: 3.0 * euroc.gyro_walk,
            accelerometer_walk: 3.0 * euroc.accelerometer_walk,
        };
    };
    let recording = recorded(noisy, 4);
    let options = MsckfOptions {
        clones: 7,
        gate: 0.99,
        landmarks: 10,
        linearization: Policy::FirstEstimates.into(),
        ..MsckfOptions::of_flight(&recording.flight)
    };
    let settings = [
        ("time", 17.0),
        ("window", 7.0),
        ("features", 26.0),
        ("pixel", 2.0),
        ("imu", 3.0),
        ("outliers", 5.0),
        FIRST,
        ("seed", 4.0),
    ];
    shows(&settings, flown(&recording, options, 4, 17.0));
    let open = MsckfOptions { gate: 1.0, linearization: Policy::Standard.into(), ..options };
    let settings = [&settings[..], &[LATEST, ("gate", 0.0)]].concat();
    shows(&settings, flown(&recording, open, 4, 17.0));
}

#[test]
fn at_the_first_picture_it_believes_what_it_was_told() {
    let first = shown(&[("time", 0.0)]);
    close(first(YAW_RATIO), 1.0);
    close(first(SIGMA), 100.0 * SIGMAS[6..9].iter().map(|sigma| sigma * sigma).sum::<f64>().sqrt());
    assert!((first(YAW_SIGMA).to_radians() / SIGMAS[2] - 1.0).abs() < 0.05);
    assert_eq!([first(USED), first(GATED), first(OTHERS)], [0.0; 3]);
}

#[test]
fn more_noise_is_reported_and_more_pictures_and_features_help() {
    let sigma = |setting| shown(&[setting])(SIGMA);
    let grows = |name, values: [f64; 3]| {
        let [a, b, c] = values.map(|value| sigma((name, value)));
        assert!(a < b && b < c, "{name}: {a} {b} {c}");
    };
    grows("pixel", [0.5, 1.0, 3.0]);
    grows("imu", [0.3, 2.0, 10.0]);
    grows("window", [16.0, 9.0, 5.0]);
    grows("features", [30.0, 15.0, 5.0]);
}

#[test]
fn errors_are_about_as_large_as_reported_whatever_the_noise() {
    for setting in [("pixel", 0.3), ("pixel", 3.0), ("imu", 0.2), ("imu", 10.0), ("window", 6.0)] {
        for label in [NEES, YAW_NEES] {
            let nees = mean(label, &[setting, LANDED]);
            assert!((0.2..3.0).contains(&nees), "{setting:?} {label} {nees}");
        }
    }
}

#[test]
fn the_gate_refuses_more_the_more_pixels_are_wrong() {
    let [none, few, many] = [0.0, 2.0, 5.0].map(|share| shown(&[("outliers", share)])(GATED));
    assert!(none < 5.0 && none < few && few < many, "{none} {few} {many}");
}

#[test]
fn without_the_gate_wrong_pixels_ruin_the_filter_and_it_does_not_report_that() {
    let wrong = [("outliers", 4.0), LANDED];
    let open = [&wrong[..], &[("gate", 0.0)]].concat();
    assert_eq!(mean(GATED, &open), 0.0);
    assert!(mean(ERROR, &open) > 5.0 * mean(ERROR, &wrong));
    let in_sigmas = |settings| mean(ERROR, settings) / mean(SIGMA, settings);
    assert!(in_sigmas(&open) > 5.0 && in_sigmas(&wrong) < 2.0, "{}", in_sigmas(&open));
    assert!(mean(NEES, &open) > 10.0 && mean(NEES, &wrong) < 3.0);
}

#[test]
fn without_wrong_pixels_the_gate_hardly_matters() {
    let right = [("outliers", 0.0), LANDED];
    let open = [&right[..], &[("gate", 0.0)]].concat();
    let [with, without] = [mean(NEES, &right), mean(NEES, &open)];
    assert!((0.5..2.0).contains(&(with / without)), "{with} {without}");
}

/// The answer to the question.
#[test]
fn landmarks_that_stay_make_the_yaw_too_sure_unless_derivatives_are_taken_at_first_estimates() {
    let of = |label, landmarks: &[(&str, f64)]| mean(label, &[&[LANDED], landmarks].concat());
    let ratios = [&[][..], &[LATEST], &[FIRST]].map(|landmarks| of(YAW_RATIO, landmarks));
    let [none, latest, first] = ratios;
    assert!(none > 0.95 && first > 0.95, "{ratios:?}");
    assert!((0.35..0.65).contains(&latest), "{ratios:?}");
    let errors = [&[LATEST][..], &[FIRST]].map(|landmarks| of(YAW_NEES, landmarks));
    assert!(errors[0] > 2.0 * errors[1] && errors[1] < 2.0, "{errors:?}");
}

#[test]
fn what_is_told_of_the_steps_adds_up_to_what_is_shown() {
    let mut session = session(&[("outliers", 5.0), ("time", 8.3)]);
    let (told, steps) = Player::steps(&mut session);
    assert_eq!(steps.len(), 84);
    assert!(steps.iter().all(|step| step.len() == told.decisions.len() + told.numbers.len()));
    let column = |name| {
        let at = told.decisions.iter().chain(told.numbers).position(|told| *told == name).unwrap();
        steps.iter().map(move |step| step[at])
    };
    let readings = session.readings();
    let shown = |label| readings.iter().find(|(known, _)| *known == label).unwrap().1;
    assert_eq!(column("used").sum::<f64>(), shown(USED));
    assert_eq!(column("gated").sum::<f64>(), shown(GATED));
    let others = ["too short", "no landmark", "rank"].map(|name| column(name).sum::<f64>());
    assert_eq!(others.iter().sum::<f64>(), shown(OTHERS));
    close(100.0 * column("σ of the position").next_back().unwrap(), shown(SIGMA));
    assert_eq!(column("lost").sum::<f64>(), 0.0);
    close(column("yaw error").next_back().unwrap().to_degrees(), shown(YAW_ERROR));
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn the_same_controls_show_the_same_whatever_came_before() {
    let mut wandering = session(&[]);
    for (update, time) in [12.0, 3.0, 20.0, 19.9, 0.0].into_iter().enumerate() {
        for landmarks in [0.0, 1.0] {
            let settings =
                [("time", time), ("landmarks", landmarks), ("seed", 1.0 + update as f64)];
            settings.iter().for_each(|(name, value)| assert!(wandering.set(name, *value)));
            // A reader does not wait until all is computed.
            for _ in 0..7 {
                wandering.advance();
            }
            wandering.show();
            let mut whole = session(&settings);
            assert_eq!(bits(wandering.numbers()), bits(whole.numbers()));
            assert_eq!(bits(wandering.steps()), bits(whole.steps()));
        }
    }
}

#[test]
fn what_has_been_flown_is_shown_before_the_rest_and_time_goes_back_for_nothing() {
    let mut session = session(&[]);
    session.set("time", 2.0);
    let width = Filter::STEPS.decisions.len() + Filter::STEPS.numbers.len();
    let mut pictures = 0;
    let mut more = true;
    while more {
        more = session.advance();
        pictures += 1;
        assert_eq!(session.steps().len(), pictures * width);
        assert!(session.show().len() > 500);
    }
    assert_eq!(pictures, 21);
    session.set("time", 1.0);
    assert!(!session.advance());
    session.set("pixel", 2.0);
    assert!(session.advance());
}

/// The readings are numbers, and the picture has not too many places.
fn holds(session: &mut Session<Filter>) {
    let controls = session.controls().to_vec();
    for (label, value) in session.readings() {
        assert!(value.is_finite(), "{label}: {value} {controls:?}");
    }
    let count = session.numbers().len();
    assert!(count < 4600, "{count} {controls:?}");
}

#[test]
fn at_all_ends_of_all_controls_there_are_numbers() {
    let ends = |name: &str| {
        let control = Filter::FACE.controls.iter().find(|control| control.name == name).unwrap();
        [control.least, control.start, control.most]
    };
    let mut session = session(&[("time", 1.5)]);
    let names = ["window", "features", "pixel", "imu", "outliers", "gate", "landmarks"];
    for combination in 0..3_usize.pow(names.len() as u32) {
        for (at, name) in names.iter().enumerate() {
            session.set(name, ends(name)[combination / 3_usize.pow(at as u32) % 3]);
        }
        holds(&mut session);
    }
}

#[test]
fn the_hardest_flights_are_flown_to_their_end() {
    let mut session = session(&[LANDED]);
    for combination in 0..64 {
        let ends = [
            ("window", [5.0, 16.0]),
            ("features", [5.0, 30.0]),
            ("pixel", [0.3, 3.0]),
            ("imu", [0.1, 10.0]),
            ("outliers", [0.0, 5.0]),
            ("gate", [0.0, 1.0]),
        ];
        for (at, (name, ends)) in ends.into_iter().enumerate() {
            session.set(name, ends[combination >> at & 1]);
        }
        session.set("landmarks", (combination % 3) as f64);
        holds(&mut session);
    }
}

#[test]
fn what_is_no_number_is_none_of_the_controls() {
    let mut session = session(&[("time", 1.0)]);
    for control in Filter::FACE.controls {
        for value in [f64::NAN, f64::INFINITY, -1e9, control.least + 0.37 * control.step] {
            session.set(control.name, if control.name == "time" { value.min(2.0) } else { value });
            holds(&mut session);
        }
        session.set(control.name, if control.name == "time" { 1.0 } else { control.start });
    }
}
