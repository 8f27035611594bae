//! What the picture of the assembled system shows is what the library flies, and its controls do what they say.

use nalgebra::Vector3;
use vislam::inertial::{Calibrated, CameraImu};
use vislam::initialization::{BeginOptions, Sensors};
use vislam::odometry::{Estimate, Estimator, Odometry, OdometryOptions, Progress};
use vislam::simulation::{Flight, FlightRecording, Trajectory};
use widgets::odometry::{Assembled, Phase, STAND, STANDS};
use widgets::{Player, Session, Widget};

const ERROR: &str = "Position error";
const SIGMA: &str = "Reported σ of the position, three axes";
const NEES: &str = "NEES of the position";
const DELAY: &str = "Camera's clock, believed late by";
const WORLDS: &str = "Worlds begun";

/// The whole flight.
const LANDED: (&str, f64) = ("time", 30.0);
const MSCKF: (&str, f64) = ("estimator", 1.0);
const ESTIMATED: (&str, f64) = ("clock", 1.0);
const PICTURES_MISSING: (&str, f64) = ("pictures", 12.0);
const TRACKS_WRONG: (&str, f64) = ("tracks", 12.0);
const READINGS_MISSING: (&str, f64) = ("readings", 12.0);

type Settings<'a> = &'a [(&'a str, f64)];

fn session(settings: Settings) -> Session<Assembled> {
    Session::with(settings).unwrap_or_else(|| panic!("{settings:?}"))
}

fn shown(settings: Settings) -> impl Fn(&str) -> f64 + use<> {
    let readings = session(settings).readings();
    move |label| {
        let found = readings.iter().find(|(known, _)| *known == label);
        found.unwrap_or_else(|| panic!("no reading {label}")).1
    }
}

/// The numbers of each picture by name.
fn told(settings: Settings) -> impl Fn(&str) -> Vec<f64> + use<> {
    let (told, steps) = Player::steps(&mut session(settings));
    move |name| {
        let names = told.decisions.iter().chain(told.numbers);
        let at = names.clone().position(|told| *told == name).unwrap();
        steps.iter().map(|step| step[at]).collect()
    }
}

fn phases(settings: Settings) -> Vec<f64> {
    told(settings)("phase")
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{found} {expected}");
}

/// A flight as the controls stand at the start but for the noise of a pixel, how late the clock is, and the seed.
fn recorded(pixel_sigma: f64, time_offset: f64, seed: u64) -> FlightRecording {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let flight = Flight::new(Trajectory::figure_eight().with_stands(&STANDS));
    let flight = flight.with_lever(lever);
    let rig = CameraImu { time_offset, ..flight.rig };
    let flight =
        Flight { seconds: 30.5, picture_rate: 5.0, tracks: 20, pixel_sigma, rig, ..flight };
    flight.record(&flight.room(3.0, 240, seed).unwrap(), seed).unwrap()
}

/// The newest estimate after the picture of a time in seconds, from the library alone. Tracks are as long as they are.
fn flown(
    recording: &FlightRecording,
    estimator: Estimator,
    clock: Option<f64>,
    seconds: f64,
) -> (Estimate, Odometry) {
    let known = Sensors::of_flight(&recording.flight);
    let sensors = Sensors {
        rig: CameraImu { time_offset: 0.0, ..known.rig },
        calibrated: Calibrated { time_offset: clock, ..known.calibrated },
        ..known
    };
    let begin = BeginOptions { stand: STAND, ..BeginOptions::at_rest() };
    let mut odometry = Odometry::new(OdometryOptions::beginning(sensors, estimator, begin));
    let until = (seconds * 5.0) as usize + 1;
    let mut readings = recording.readings.iter();
    for (number, picture) in recording.pictures[..until].iter().enumerate() {
        // A picture is handed over with all readings until the next one.
        for reading in readings.by_ref() {
            assert_eq!(odometry.reading(*reading).unwrap(), None);
            if reading.nanoseconds as f64 >= 0.2e9 * (number + 1) as f64 {
                break;
            }
        }
        let progress = odometry.picture(picture).unwrap();
        assert!(!matches!(progress, Progress::Lost(_)), "{progress:?}");
    }
    (odometry.newest().unwrap(), odometry)
}

#[test]
fn it_shows_what_the_library_flies() {
    for (estimator, number) in [(Estimator::Smoother, 0.0), (Estimator::Msckf, 1.0)] {
        for (milliseconds, clock) in [(0.0, 0.0), (20.0, 1.0)] {
            let recording = recorded(0.5, 1e-3 * milliseconds, 4);
            let sigma = (clock > 0.0).then_some(0.03);
            // No track is longer than what the tracker holds on to.
            let (estimate, odometry) = flown(&recording, estimator, sigma, 3.8);
            let settings = [
                ("estimator", number),
                ("pixel", 0.5),
                ("delay", milliseconds),
                ("clock", clock),
                ("track", 20.0),
                ("seed", 4.0),
                ("time", 3.8),
            ];
            let shown = shown(&settings);
            let covariance = estimate.covariance.fixed_view::<3, 3>(6, 6);
            close(shown(SIGMA), 100.0 * covariance.trace().sqrt());
            close(shown(DELAY), 1e3 * odometry.rig().unwrap().time_offset);
            assert!(shown(ERROR) < 30.0, "{}", shown(ERROR));
        }
    }
}

#[test]
fn errors_are_about_as_large_as_reported() {
    for estimator in [0.0, 1.0] {
        let seeds = [1.0, 3.0, 4.0, 5.0];
        let of = |seed| {
            let nees = told(&[("estimator", estimator), ("seed", seed), LANDED])("NEES");
            let known: Vec<f64> = nees.into_iter().filter(|nees| nees.is_finite()).collect();
            assert!(known.len() > 100, "{}", known.len());
            known.iter().sum::<f64>() / known.len() as f64
        };
        let mean = seeds.map(of).iter().sum::<f64>() / seeds.len() as f64;
        assert!((0.3..2.5).contains(&mean), "estimator {estimator}: {mean}");
    }
}

#[test]
fn it_waits_and_stands_and_then_follows() {
    for estimator in [0.0, 1.0] {
        let mut phases = phases(&[("estimator", estimator), LANDED]);
        assert_eq!(phases.len(), 151);
        // The body stands for two seconds and is known to before one.
        let followed = phases.iter().filter(|phase| **phase == Phase::Following as u8 as f64);
        assert!((130..145).contains(&followed.count()));
        phases.dedup();
        let order = [Phase::Waiting, Phase::Standing, Phase::Following];
        assert_eq!(phases, order.map(|phase| phase as u8 as f64));
    }
}

#[test]
fn missing_pictures_are_flown_through_and_make_it_less_sure() {
    for estimator in [("estimator", 0.0), MSCKF] {
        let sigma = told(&[estimator, PICTURES_MISSING, LANDED])("σ of the position");
        let with = told(&[estimator, LANDED])("σ of the position");
        assert!(sigma[67] > 1.02 * with[67], "{} {}", sigma[67], with[67]);
        assert_eq!(shown(&[estimator, PICTURES_MISSING, LANDED])(WORLDS), 1.0);
        let phases = phases(&[estimator, PICTURES_MISSING, LANDED]);
        let missing = phases.iter().filter(|phase| **phase == Phase::Missing as u8 as f64);
        assert_eq!(missing.count(), 5);
    }
}

#[test]
fn wrong_tracks_are_refused() {
    for estimator in [("estimator", 0.0), MSCKF] {
        let refused = |fault: Settings| {
            told(&[&[estimator, LANDED], fault].concat())("refused").iter().sum::<f64>()
        };
        assert!(refused(&[TRACKS_WRONG]) > 5.0 + 2.0 * refused(&[]));
    }
}

#[test]
fn missing_readings_are_said_and_it_begins_again() {
    for estimator in [("estimator", 0.0), MSCKF] {
        let settings = [estimator, READINGS_MISSING];
        let mut meanwhile = session(&[&settings[..], &[("time", 13.0)]].concat());
        assert!(meanwhile.readings()[0].1.is_nan(), "nothing is known");
        assert!(meanwhile.said().starts_with("No readings"), "{}", meanwhile.said());
        let mut waiting = session(&[&settings[..], &[("time", 14.0)]].concat());
        assert!(waiting.readings()[0].1.is_nan(), "nothing is known");
        assert!(waiting.said().starts_with("Lost: readings are missing"), "{}", waiting.said());
        let after = shown(&[&settings[..], &[LANDED]].concat());
        assert_eq!(after(WORLDS), 2.0);
        assert!(after(NEES) < 5.0, "{}", after(NEES));
        // Its first try at a second beginning ends in a minimum that is none of the flight.
        let after = shown(&[&settings[..], &[LANDED, ("seed", 2.0)]].concat());
        assert!(after(NEES) < 5.0, "{}", after(NEES));
    }
}

#[test]
fn a_clock_that_is_late_misleads_who_takes_it_to_be_right_and_is_found_by_who_does_not() {
    for estimator in [("estimator", 0.0), MSCKF] {
        let late = [estimator, ("delay", 10.0), LANDED];
        let found = shown(&[&late[..], &[ESTIMATED]].concat());
        assert!((found(DELAY) - 10.0).abs() < 1.0, "{}", found(DELAY));
        assert!(found(NEES) < 4.0, "{}", found(NEES));
        let mean = |settings: Settings| {
            let errors = told(settings)("error");
            let known: Vec<f64> = errors.into_iter().filter(|error| error.is_finite()).collect();
            known.iter().sum::<f64>() / known.len() as f64
        };
        let (misled, found) = (mean(&late), mean(&[&late[..], &[ESTIMATED]].concat()));
        assert!(misled > 2.0 * found, "{misled} {found}");
    }
}

#[test]
fn more_noise_and_shorter_tracks_make_it_less_sure() {
    for estimator in [("estimator", 0.0), MSCKF] {
        let sigma = |setting| shown(&[estimator, setting, LANDED])(SIGMA);
        assert!(sigma(("pixel", 0.5)) < sigma(("pixel", 2.0)));
        let (long, short) = (sigma(("track", 20.0)), sigma(("track", 7.0)));
        assert!(long < short, "{long} {short}");
    }
}

#[test]
fn what_is_told_of_the_steps_is_what_is_shown() {
    let settings = [("time", 8.0)];
    let (told, shown) = (told(&settings), shown(&settings));
    let last = |name| *told(name).last().unwrap();
    close(100.0 * last("error"), shown(ERROR));
    close(100.0 * last("σ of the position"), shown(SIGMA));
    close(last("NEES"), shown(NEES));
    close(1e3 * last("delay"), shown(DELAY));
    assert_eq!(last("worlds"), shown(WORLDS));
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn the_same_controls_show_the_same_whatever_came_before() {
    let mut wandering = session(&[]);
    for (update, time) in [6.0, 2.0, 8.0, 7.8, 0.0].into_iter().enumerate() {
        for estimator in [0.0, 1.0] {
            let settings =
                [("time", time), ("estimator", estimator), ("seed", 1.0 + update as f64)];
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
    let mut session = session(&[("time", 4.0)]);
    let width = Assembled::STEPS.decisions.len() + Assembled::STEPS.numbers.len();
    let mut before = 0;
    while session.advance() {
        let flown = session.steps().len() / width;
        assert!((before..=before + 2).contains(&flown), "{before} {flown}");
        before = flown;
        assert!(session.show().len() > 500);
    }
    assert_eq!(session.steps().len(), 21 * width);
    session.set("time", 1.0);
    assert!(!session.advance());
    session.set("pixel", 2.0);
    assert!(session.advance());
}

#[test]
fn what_goes_wrong_from_now_on_changes_nothing_that_was_flown() {
    for (fault, time) in [("pictures", 6.0), ("tracks", 6.2), ("readings", 6.4)] {
        let mut pressed = session(&[("time", time)]);
        while pressed.advance() {}
        pressed.set(fault, time);
        assert!(!pressed.advance(), "{fault}: what was flown stays");
        pressed.set("time", 8.0);
        while pressed.advance() {}
        let mut whole = session(&[("time", 8.0), (fault, time)]);
        while whole.advance() {}
        assert_eq!(bits(pressed.steps()), bits(whole.steps()), "{fault}");
        let mut without = session(&[("time", 8.0)]);
        while without.advance() {}
        assert_ne!(bits(pressed.steps()), bits(without.steps()), "{fault}");
        pressed.set(fault, time - 2.0);
        assert!(pressed.advance(), "{fault}: it is flown again");
    }
}

#[test]
fn at_the_ends_of_all_controls_it_says_something_and_draws_not_too_much() {
    let mut session = session(&[("time", 16.0)]);
    for combination in 0..16 {
        for (at, control) in Assembled::FACE.controls.iter().enumerate().skip(1) {
            let part = combination >> (at % 4) & 1;
            session.set(control.name, if part == 0 { control.least } else { control.most });
        }
        let controls = session.controls().to_vec();
        let count = session.numbers().len();
        assert!(count < 6000, "{count} {controls:?}");
        assert!(!session.said().is_empty());
        for (label, value) in session.readings() {
            assert!(value.is_nan() || value.abs() < 1e6, "{label}: {value} {controls:?}");
        }
    }
}
