//! Whether an odometry that began by itself, in flight and once again after a gap, is as wrong as it says.

use nalgebra::Vector3;
use vislam::filtering::{BlockNees, NeesBand};
use vislam::odometry::{Estimator, Odometry, OdometryOptions};
use vislam::simulation::{Flight, FlightRecording, Trajectory};

use crate::chapter::Chapter;
use crate::msckf::flights::flown;
use crate::record::{RecordValue, accepted};
use crate::smoother::followed::options;

const SEEDS: u64 = 100;
const SECONDS: f64 = 30.0;
/// No reading comes between these times, in seconds, and the flight begins again.
const GAP: [f64; 2] = [12.0, 13.0];
/// When it is asked, in seconds: in the first world and in the second one.
const TIMES: [f64; 2] = [11.0, 29.0];
const PICTURES_A_SECOND: f64 = 5.0;
const TRACKS: usize = 20;
/// The probability that a consistent estimator leaves any of all bands.
const OUTSIDE: f64 = 0.01;
/// Beyond this NEES of its position an estimate is called wrong.
const WRONG: f64 = 10.0;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        (
            "flight",
            format!("figure eight, {SECONDS} s, no readings from {} to {} s", GAP[0], GAP[1]),
        ),
        ("pictures", format!("{PICTURES_A_SECOND} in a second, {TRACKS} tracks")),
        ("times", TIMES.map(|time| time.to_string()).join(" ")),
        ("wrong", format!("NEES beyond {WRONG}")),
    ];
    chapter.record("odometry_begun", inputs, begun);
}

pub fn numbers(chapter: &mut Chapter) {
    let names = ["position_first", "position_second", "velocity_first", "velocity_second"];
    let tests: Vec<String> = ["smoother", "msckf"]
        .iter()
        .flat_map(|estimator| names.map(|name| format!("{estimator}_{name}")))
        .collect();
    let band = NeesBand::family(SEEDS as usize, &vec![3; tests.len()], OUTSIDE);
    let band = band.expect("a probability")[0];
    let is_outside = |name: &&String| !band.contains(accepted("odometry_begun", name));
    let plain = options(&flown(&flight(1.0), 0), Estimator::Smoother);
    chapter.number("misfit", plain.begin.motion.misfit, "", 1);
    chapter.number("begun_gap", GAP[0], "s", 0);
    chapter.number("begun_seconds", SECONDS, "s", 0);
    chapter.number("begun_again", GAP[1], "s", 0);
    chapter.number("begun_both", 2.0 * SEEDS as f64, "", 0);
    chapter.number("begun_first", TIMES[0], "s", 0);
    chapter.number("begun_second", TIMES[1], "s", 0);
    chapter.number("begun_low", band.low, "", 2);
    chapter.number("begun_high", band.high, "", 2);
    chapter.number("begun_tests", tests.len() as f64, "", 0);
    chapter.number("begun_outside", tests.iter().filter(is_outside).count() as f64, "", 0);
    chapter.number("begun_wrong", WRONG, "", 0);
}

fn flight(seconds: f64) -> Flight {
    let new = Flight::new(Trajectory::figure_eight()).with_lever(Vector3::new(0.1, 0.05, -0.02));
    let tracks = TRACKS;
    Flight { seconds, picture_rate: PICTURES_A_SECOND, tracks, gap: Some(GAP), ..new }
}

/// What is known at the two times, in the true world: the NEES of position and velocity.
fn nees_of(recording: &FlightRecording, options: OdometryOptions) -> [Option<[f64; 2]>; 2] {
    let truth = |nanoseconds: i64| recording.flight.motion.at(1e-9 * nanoseconds as f64).state;
    let mut known = [None; 2];
    let mut odometry = Odometry::new(options);
    let told = |odometry: &Odometry, _| {
        let Some((beginning, newest)) = odometry.beginning().zip(odometry.newest()) else { return };
        let is_asked = |time: &f64| (1e-9 * newest.nanoseconds as f64 - time).abs() < 0.01;
        let Some(at) = TIMES.iter().position(is_asked) else { return };
        let newest = newest.in_world(&beginning.to_world_of(&truth(beginning.origin.0)));
        let covariance = newest.covariance.fixed_view::<9, 9>(0, 0).into_owned();
        let nees = BlockNees::of(&newest.state, &truth(newest.nanoseconds), &covariance);
        known[at] = nees.ok().map(|nees| [nees.position, nees.velocity]);
    };
    odometry.fly(&recording.readings, &recording.pictures, told).expect("it is flown");
    known
}

fn begun() -> Vec<RecordValue> {
    let mut values = vec![RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0)];
    for (name, estimator) in [("smoother", Estimator::Smoother), ("msckf", Estimator::Msckf)] {
        let flights: Vec<[Option<[f64; 2]>; 2]> = (0..SEEDS)
            .map(|seed| {
                let recording = flown(&flight(SECONDS), seed);
                nees_of(&recording, options(&recording, estimator))
            })
            .collect();
        let known = |at: usize| flights.iter().filter_map(move |flight| flight[at]);
        let wrong = |at: usize| known(at).filter(|[position, _]| *position > WRONG).count();
        let mut push = |what: &str, value: f64, decimals| {
            let tolerance = if decimals == 0 { 0.0 } else { 0.02 };
            values.push(RecordValue::new(format!("{name}_{what}"), value, "", decimals, tolerance));
        };
        push("wrong", (wrong(0) + wrong(1)) as f64, 0);
        push("unknown", (2 * flights.len() - known(0).count() - known(1).count()) as f64, 0);
        for (time, at) in [("first", 0), ("second", 1)] {
            let count = known(at).count() as f64;
            let mean = |of: usize| known(at).map(|nees| nees[of]).sum::<f64>() / count;
            push(&format!("position_{time}"), mean(0), 2);
            push(&format!("velocity_{time}"), mean(1), 2);
        }
    }
    values
}
