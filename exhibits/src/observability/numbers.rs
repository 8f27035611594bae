//! The numbers that the chapter quotes.

use nalgebra::Vector3;
use vislam::inertial::GRAVITY;
use vislam::observability::{BiasAssumption, Similarity, UnknownCalibration};
use vislam::simulation::{Flight, Trajectory};

use super::near::{self, AMPLITUDES};
use super::readings::{inertial_residuals, other_scale};
use super::worked::{self, TURN, cases, free, row_of, window};
use crate::chapter::Chapter;

/// Names of the table's numbers by motion: unknown constant, walking, known.
const TABLE: [[&str; 3]; 12] = [
    ["eight_unknown", "eight_walking", "eight_known"],
    ["coast_unknown", "coast_walking", "coast_known"],
    ["straight_unknown", "straight_walking", "straight_known"],
    ["turn_unknown", "turn_walking", "turn_known"],
    ["body_unknown", "body_walking", "body_known"],
    ["sway_unknown", "sway_walking", "sway_known"],
    ["pitch_unknown", "pitch_walking", "pitch_known"],
    ["climb_unknown", "climb_walking", "climb_known"],
    ["level_unknown", "level_walking", "level_known"],
    ["leveled_unknown", "leveled_walking", "leveled_known"],
    ["hover_unknown", "hover_walking", "hover_known"],
    ["spot_unknown", "spot_walking", "spot_known"],
];

pub fn numbers(chapter: &mut Chapter) {
    size(chapter);
    table(chapter);
    calibration(chapter);
    pictures(chapter);
    worked_turn(chapter);
    tilted(chapter);
    climbing(chapter);
    nearly(chapter);
    inconsistent(chapter);
}

fn size(chapter: &mut Chapter) {
    let flight = Flight::brief(Trajectory::figure_eight());
    let window = window(flight.motion, BiasAssumption::CONSTANT);
    chapter.number("states", flight.pictures() as f64, "", 0);
    let jacobian = window.linearize().expect("the figure-eight has a window").0;
    chapter.number("rows", jacobian.nrows() as f64, "", 0);
    chapter.number("columns", jacobian.ncols() as f64, "", 0);
}

fn table(chapter: &mut Chapter) {
    for ((case, names), free) in cases().iter().zip(TABLE).zip(worked::table()) {
        for (name, free) in names.into_iter().zip(free) {
            assert!(name.starts_with(case.word), "the table is in the order of the cases");
            assert_eq!(free.unnamed(), 0, "what is free has a name");
            chapter.number(name, free.count() as f64, "", 0);
        }
    }
    let landmarks = |motion| window(motion, BiasAssumption::KNOWN).landmarks.len() as f64;
    chapter.number("hover_landmarks", landmarks(Trajectory::hover()), "", 0);
    chapter.number("spot_landmarks", landmarks(Trajectory::turn_on_the_spot(0.4)), "", 0);
    chapter.number("vision", worked::vision().count() as f64, "", 0);
    let hover = worked::free_of_pictures(Trajectory::hover());
    chapter.number("vision_hover", hover.count() as f64, "", 0);
    let gyro = BiasAssumption { accelerometer_known: true, ..BiasAssumption::CONSTANT };
    let turn = Trajectory::level_turn(TURN.0, TURN.1);
    chapter.number("turn_gyro", free(&window(turn, gyro)).count() as f64, "", 0);
    let mut weightless = Flight::brief(Trajectory::figure_eight());
    weightless.gravity = Vector3::zeros();
    let weightless = worked::of_flight(&weightless, BiasAssumption::KNOWN);
    chapter.number("weightless", free(&weightless).count() as f64, "", 0);
}

/// What is free when extrinsics or the time offset are unknown, with known biases.
fn calibration(chapter: &mut Chapter) {
    let lever = Vector3::new(0.1, 0.05, -0.03);
    let count = |motion, extrinsics| {
        let flight = Flight::brief(motion).with_lever(lever);
        let mut window = worked::of_flight(&flight, BiasAssumption::KNOWN);
        window.calibration = UnknownCalibration { extrinsics, time_offset: !extrinsics };
        free(&window).count() as f64
    };
    let names = [
        ("eight", ["eight_extrinsics", "eight_offset"]),
        ("pitch", ["pitch_extrinsics", "pitch_offset"]),
        ("sway", ["sway_extrinsics", "sway_offset"]),
        ("climb", ["climb_extrinsics", "climb_offset"]),
    ];
    for (word, [extrinsics, offset]) in names {
        for case in cases().iter().filter(|case| case.word == word) {
            chapter.number(extrinsics, count(case.motion, true), "", 0);
            chapter.number(offset, count(case.motion, false), "", 0);
        }
    }
}

fn pictures(chapter: &mut Chapter) {
    let count = |states, assumption| {
        let flight = Flight::brief(Trajectory::figure_eight());
        let flight = Flight { seconds: 0.25 * f64::from(states - 1), ..flight };
        free(&worked::of_flight(&flight, assumption)).count() as f64
    };
    let (known, unknown) = (BiasAssumption::KNOWN, BiasAssumption::CONSTANT);
    for (name, states, assumption) in [
        ("two_known", 2, known),
        ("three_known", 3, known),
        ("two_unknown", 2, unknown),
        ("three_unknown", 3, unknown),
        ("four_unknown", 4, unknown),
    ] {
        chapter.number(name, count(states, assumption), "", 0);
    }
}

/// The level turn, and a copy of it that is larger.
fn worked_turn(chapter: &mut Chapter) {
    let scale = 1.1;
    let larger = Similarity { scale, ..Similarity::identity() };
    let motion = Trajectory::level_turn(TURN.0, TURN.1);
    chapter.number("turn_speed", TURN.0, "m/s", 0);
    chapter.number("turn_rate", TURN.1, "rad/s", 1);
    chapter.number("turn_radius", TURN.0 / TURN.1, "m", 0);
    chapter.number("turn_force", TURN.0 * TURN.1, "m/s²", 1);
    chapter.number("larger_percent", 100.0 * (scale - 1.0), "%", 0);
    chapter.number("larger_force", scale * TURN.0 * TURN.1, "m/s²", 2);
    let window = |assumption| window(motion, assumption).transformed(&larger);
    let copy = window(BiasAssumption::CONSTANT);
    chapter.number("larger_bias", copy.biases[0].accelerometer.y, "m/s²", 2);
    let copy = window(BiasAssumption::KNOWN);
    let gained = inertial_residuals(&copy)[3..6].iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    chapter.number("larger_residual_mm_s", 1e3 * gained, "mm/s", 1);
    let whitened = copy.residual().expect("a similar window is in front of its cameras");
    chapter.number("larger_sigmas", whitened.norm(), "", 0);
}

fn tilted(chapter: &mut Chapter) {
    let lean: f64 = 1e-3;
    chapter.number("lean_mrad", 1e3 * lean, "mrad", 0);
    chapter.number("lean_bias_mm", 1e3 * GRAVITY.norm() * lean.sin(), "mm/s²", 1);
    let bias = 0.1;
    chapter.number("tilt_bias", bias, "m/s²", 1);
    chapter.number("tilt_deg", (bias / GRAVITY.norm()).asin().to_degrees(), "°", 1);
}

/// A car on a ramp.
pub const RAMP: Vector3<f64> = Vector3::new(2.0, 0.0, 0.2);

fn climbing(chapter: &mut Chapter) {
    let scale = other_scale(&RAMP, &GRAVITY);
    chapter.number("ramp_ahead", RAMP.x, "m/s²", 0);
    chapter.number("ramp_up", RAMP.z, "m/s²", 1);
    chapter.number("false_scale", scale, "", 2);
    let wanted = GRAVITY + (scale - 1.0) * RAMP;
    chapter.number("false_tilt_deg", wanted.angle(&GRAVITY).to_degrees(), "°", 1);
    let gravity = GRAVITY.norm();
    let second = Vector3::new(RAMP.x, 0.0, 0.0);
    let off = |growth: f64| (GRAVITY + growth * second).norm() - gravity;
    chapter.number("level_ten_mm", 1e3 * off(0.1), "mm/s²", 1);
    chapter.number("level_one_mm", 1e3 * off(0.01), "mm/s²", 2);
}

fn nearly(chapter: &mut Chapter) {
    let (known, unknown) = (BiasAssumption::KNOWN, BiasAssumption::CONSTANT);
    let swayed = near::swayed();
    let exponent = |of: [f64; 9]| near::exponent(AMPLITUDES.into_iter().zip(of));
    chapter.number("exponent_known", exponent(swayed.known), "", 2);
    chapter.number("exponent_unknown", exponent(swayed.unknown), "", 2);
    chapter.number("sway_rate", near::SWAY_RATE, "rad/s", 0);
    chapter.number("excite_low", AMPLITUDES[2], "m/s²", 2);
    chapter.number("excite_low_known", swayed.known[2], "%", 0);
    chapter.number("excite_low_unknown", swayed.unknown[2], "%", 0);
    chapter.number("excite_high", AMPLITUDES[6], "m/s²", 0);
    chapter.number("excite_high_known", swayed.known[6], "%", 1);
    chapter.number("excite_high_unknown", swayed.unknown[6], "%", 1);
    chapter.number("above_least", swayed.known[2] / swayed.least[2], "", 0);
    let lever = 0.05;
    chapter.number("lever_cm", 100.0 * lever, "cm", 0);
    chapter.number("lever_known_percent", near::lever_percent(lever, known), "%", 0);
    chapter.number("lever_unknown_percent", near::lever_percent(lever, unknown), "%", 0);
    let eight = window(Trajectory::figure_eight(), unknown);
    let eight = near::percent(&row_of("eight")[0].spectrum, &eight);
    chapter.number("eight_percent", eight, "%", 1);
}

fn inconsistent(chapter: &mut Chapter) {
    let mixed = near::all_mixed();
    let points = near::DISAGREEMENTS.into_iter().zip(mixed.iter().map(|m| m.yaw_degrees));
    chapter.number("yaw_exponent", near::exponent(points), "", 2);
    let typical = &mixed[4];
    chapter.number("mixed_free", typical.free as f64, "", 0);
    chapter.number("mixed_size_cm", 100.0 * near::DISAGREEMENTS[4], "cm", 0);
    chapter.number("mixed_yaw_deg", typical.yaw_degrees, "°", 2);
    let moved = typical.leaves.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(*b));
    chapter.number("mixed_shift_exponent", moved.log10().ceil(), "", 0);
    let consistent = window(Trajectory::figure_eight(), BiasAssumption::CONSTANT);
    let bounded = row_of("eight")[0].spectrum.sigma(&near::first_yaw(&consistent));
    assert_eq!(bounded, None, "a consistent window says nothing about yaw");
}
