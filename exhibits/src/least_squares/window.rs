//! The window of `examples/window.rs`: what it says of itself, what it costs, and a flight of a
//! minute as one problem.

use std::time::Instant;

use nalgebra::{DVector, Vector1};
use vislam::filtering::{chi_square_band, nees};
use vislam::inertial::{CameraImu, Gravity, ImuSample, NavState};
use vislam::least_squares::{
    Dense, Fronts, LinearSystem, Manifold, Options, Problem, Report, Search, Solution, Values,
};
use vislam::manifold::so3;
use vislam::simulation::FlightRecording;

use crate::bundle_adjustment::consistency::{OUTSIDE_MEAN, OUTSIDE_RUN};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::python::{Exported, Python, pose_numbers, state_numbers};
use crate::random::Random;
use crate::record::RecordValue;

#[allow(dead_code)]
#[path = "../../../code/examples/window.rs"]
mod example;

use example::{
    BIAS, EXTRINSICS, Known, STATE, Sensors, TIME_OFFSET, Window, compare, intervals, record,
    tracks, without_priors,
};

const SEEDS: usize = 50;
const SECONDS: f64 = 60.0;
/// Of a state: turns, velocity, position.
pub const DEGREES: usize = 9;
/// How far off the search begins, in standard deviations.
const OFF: f64 = 5.0;

/// Registers the records.
pub fn records(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        ("motion", format!("Trajectory::figure_eight() for {SECONDS} s, 4 pictures a second")),
        ("start", format!("{OFF} standard deviations off")),
    ];
    chapter.record("flight_consistency", inputs, consistency);
    let inputs =
        vec![("window", "that of examples/window.rs, calibration and gravity held".into())];
    chapter.record_of_data("window_speed", &[], inputs, speed);
}

/// The window of the example, with priors.
fn example_window() -> (FlightRecording, Window) {
    let (recording, known, mut window) = without_priors().expect("the flight fits the window");
    window.add_priors(&known).expect("they fit the variables");
    (recording, window)
}

/// How many directions are free without priors, all of which have a name.
fn free(change: impl FnOnce(&mut Window)) -> f64 {
    let (_, _, mut window) = without_priors().expect("the flight fits the window");
    change(&mut window);
    let (free, named) = window.free().expect("there is a gap");
    assert_eq!(free, named.len());
    free as f64
}

pub fn numbers(chapter: &mut Chapter) {
    let lever = EXTRINSICS[..3].iter().map(|sigma| sigma * sigma).sum::<f64>().sqrt();
    chapter.number("window_lever_known", 1e3 * lever, "mm", 0);
    chapter.number("window_clock_known", 1e3 * TIME_OFFSET[0], "ms", 0);
    chapter.number("window_free", free(|_| {}), "", 0);
    let held = |window: &mut Window| window.problem.hold(window.gravity).expect("a variable");
    chapter.number("window_free_held", free(held), "", 0);
    chapter.number("flight_off", OFF, "", 0);
    chapter.number("flight_states", minute(0).pictures.len() as f64, "", 0);
    let (recording, mut window) = example_window();
    let Solution { values, report } =
        example::solve(&window.problem).expect("the window is determined");
    let (rows, columns) = (window.problem.rows(), window.problem.columns().count);
    chapter.number("window_states", window.states.len() as f64, "", 0);
    chapter.number("window_landmarks", window.landmarks.len() as f64, "", 0);
    chapter.number("window_rows", rows as f64, "", 0);
    chapter.number("window_columns", columns as f64, "", 0);
    chapter.number("window_steps", report.iterations.len() as f64, "", 0);
    chapter.number("window_cost", 2.0 * report.cost, "", 0);
    chapter.number("window_freedom", (rows - columns) as f64, "", 0);

    let first = Fronts::new(&window.problem).expect("a problem");
    let order = Fronts::order_along(&window.problem, &window.tiles().concat()).expect("they exist");
    let along = Fronts::in_order(&window.problem, &order).expect("a problem");
    chapter.number("window_products", 1e-6 * first.products() as f64, "million", 1);
    chapter.number("window_products_along", 1e-6 * along.products() as f64, "million", 1);
    chapter.number("window_stored", 1e-3 * first.stored() as f64, "thousand", 0);
    chapter.number("window_stored_along", 1e-3 * along.stored() as f64, "thousand", 0);

    errors(chapter, &recording, &window, &values);
    let named = window.take_out_oldest(&values).expect("it can go");
    chapter.number("window_named", named.len() as f64, "", 0);
}

/// How far off the estimates are, and how far they say that they are.
fn errors(chapter: &mut Chapter, recording: &FlightRecording, window: &Window, values: &Values) {
    let fronts = Fronts::new(&window.problem).expect("a problem");
    let covariance = window.problem.covariance_with(fronts, values).expect("nothing is free");
    let flight = &recording.flight;
    let late = Vector1::new(flight.rig.time_offset);
    let gravity = Gravity(flight.gravity);
    let mut error = |[off_name, sigma_name]: [_; 2], (off, sigma): (f64, f64), unit, decimals| {
        chapter.number(off_name, 1e3 * off, unit, decimals);
        chapter.number(sigma_name, 1e3 * sigma, unit, decimals);
    };
    let last = window.states.len() - 1;
    let state = (window.states[last], &states(recording)[last]);
    let position = compare(state, values, &covariance, 6..9);
    error(["window_position_off", "window_position_sigma"], position, "mm", 1);
    let mount = (window.extrinsics, &flight.rig.body_from_camera);
    let lever = compare(mount, values, &covariance, 0..3);
    error(["window_lever_off", "window_lever_sigma"], lever, "mm", 1);
    let clock = compare((window.time_offset, &late), values, &covariance, 0..1);
    error(["window_clock_off", "window_clock_sigma"], clock, "ms", 2);
    let down = compare((window.gravity, &gravity), values, &covariance, 0..2);
    error(["window_down_off", "window_down_sigma"], down, "mrad", 2);
}

/// The true states at the pictures.
fn states(recording: &FlightRecording) -> Vec<NavState> {
    let at = |nanoseconds| recording.flight.motion.at(1e-9 * nanoseconds as f64).state;
    recording.pictures.iter().map(|picture| at(picture.nanoseconds)).collect()
}

/// What the search of one flight did, and the normalized errors of the states in the middle and at
/// the end.
pub struct Flown {
    pub report: Report,
    pub errors: [f64; 2],
}

/// A minute of the motion of the example, with fewer tracks.
fn minute(seed: u64) -> FlightRecording {
    record(SECONDS, 40, 400, seed).expect("it can be flown")
}

/// A flight of a minute as one problem, from a start that is off.
pub fn fly(seed: u64) -> Flown {
    let recording = minute(seed);
    let (sensors, flight) = (Sensors::from(&recording), &recording.flight);
    let states = states(&recording);

    // What is known has the errors that its standard deviations say.
    let mut random = Random::new(seed);
    let mut drawn = |sigmas: &[f64]| sigmas.iter().map(|s| random.normal(*s)).collect::<Vec<_>>();
    let known = Known {
        state: states[0].retract(&drawn(&STATE)),
        bias: recording.truth.biases[1].retract(&drawn(&BIAS)),
        rig: CameraImu {
            body_from_camera: flight.rig.body_from_camera.retract(&drawn(&EXTRINSICS)),
            time_offset: flight.rig.time_offset + drawn(&TIME_OFFSET)[0],
        },
    };
    let mut window = Window::new(&sensors, &states, &known).expect("the sensors fit the window");
    window.add_priors(&known).expect("they fit");
    let fronts = Fronts::new(&window.problem).expect("a problem");
    let near = window.problem.values().clone();
    let covariance =
        window.problem.covariance_with(fronts.clone(), &near).expect("nothing is free");
    let parts = (0..near.len()).filter_map(|variable| covariance.of_number(variable));
    let variances = parts.flat_map(|part| part.diagonal().iter().copied().collect::<Vec<_>>());
    let mut off = |variance: f64| OFF * random.normal(1.0).signum() * variance.sqrt();
    let step: Vec<f64> = variances.map(&mut off).collect();
    window.problem.set_values(near.retract(&step)).expect("of the same variables");
    let solution = window.problem.solve_with(fronts.clone(), &Options::default());
    let Solution { values, report } = solution.expect("the start has a cost");
    let covariance = window.problem.covariance_with(fronts, &values).expect("nothing is free");
    let errors = [states.len() / 2, states.len() - 1].map(|at| {
        let mut step = [0.0; 9];
        values[window.states[at]].local(&states[at], &mut step);
        let (error, matrix) = (DVector::from_row_slice(&step), covariance.of(window.states[at]));
        let divided = nees(&error, &matrix.expect("of a variable")).expect("positive");
        DEGREES as f64 * divided
    });
    Flown { report, errors }
}

fn consistency() -> Vec<RecordValue> {
    let flown: Vec<Flown> = (0..SEEDS as u64).map(fly).collect();
    let value = |name, value, unit, decimals| RecordValue::new(name, value, unit, decimals, 1e-4);
    let runs = SEEDS as f64;
    let mean = |at: usize| flown.iter().map(|flown| flown.errors[at]).sum::<f64>() / runs;
    let band = |outside, degrees| chi_square_band(outside, degrees).expect("a probability");
    let [low, high] = band(OUTSIDE_MEAN, SEEDS * DEGREES).map(|end| end / runs);
    let [run_low, run_high] = band(OUTSIDE_RUN, DEGREES);
    let inside = |at: usize| {
        let inside = |flown: &&Flown| (run_low..run_high).contains(&flown.errors[at]);
        100.0 * flown.iter().filter(inside).count() as f64 / runs
    };
    let converged = flown.iter().filter(|flown| flown.report.stop.is_convergence()).count();
    let most = flown.iter().map(|flown| flown.report.iterations.len()).max().unwrap_or(0);
    vec![
        value("seeds", runs, "", 0),
        value("converged", converged as f64, "", 0),
        value("most_steps", most as f64, "", 0),
        value("mean_middle", mean(0), "", 2),
        value("mean_last", mean(1), "", 2),
        value("low", low, "", 2),
        value("high", high, "", 2),
        value("expected_inside", 100.0 * (1.0 - OUTSIDE_RUN), "%", 0),
        value("inside_middle", inside(0), "%", 0),
        value("inside_last", inside(1), "%", 0),
    ]
}

/// The least time of an iteration in milliseconds, and twice the cost at the end.
fn least<S: LinearSystem>(problem: &Problem, new: impl Fn() -> S) -> [f64; 2] {
    let (mut least, mut cost) = (f64::INFINITY, 0.0);
    let options = Options { decrease_tolerance: 1e-12, ..Options::default() };
    for _ in 0..RUNS {
        let mut search = Search::new(problem, new(), &options).expect("it has a cost");
        let stop = loop {
            let start = Instant::now();
            match search.iterate(problem).expect("damped steps are determined") {
                Some(stop) => break stop,
                None => least = start.elapsed().as_secs_f64().min(least),
            }
        };
        cost = 2.0 * search.finish(stop).report.cost;
    }
    [1e3 * least, cost]
}

const RUNS: usize = 20;

/// The window with what GTSAM's factors take as known held, here and there in turn.
fn speed() -> Result<Vec<RecordValue>, NotMade> {
    let python = Python::with_gtsam()?;
    let (recording, mut window) = example_window();
    window.problem.hold(window.extrinsics).expect("a variable");
    window.problem.hold(window.time_offset).expect("a variable");
    window.problem.hold(window.gravity).expect("a variable");
    let graph = exported(&window, &recording);

    let problem = &window.problem;
    let order = Fronts::order_along(problem, &window.tiles().concat()).expect("they exist");
    let mut best = [[f64::INFINITY; 2]; 5];
    for _ in 0..TURNS {
        let turn = [
            least(problem, || Dense::new(problem).expect("a problem")),
            least(problem, || Fronts::new(problem).expect("a problem")),
            least(problem, || Fronts::in_order(problem, &order).expect("they exist")),
            least(problem, || window.landmarks_first().expect("pixels see one state each")),
            theirs(&python, &graph)?,
        ];
        for (best, [time, cost]) in best.iter_mut().zip(turn) {
            *best = [best[0].min(time), cost];
        }
    }
    let [dense, fronts, along, landmarks_first, theirs] = best;
    let value =
        |name, value, unit, decimals, within| RecordValue::new(name, value, unit, decimals, within);
    Ok(vec![
        value("dense", dense[0], "ms", 1, 3.0),
        value("fronts", fronts[0], "ms", 2, 3.0),
        value("along", along[0], "ms", 1, 3.0),
        value("landmarks_first", landmarks_first[0], "ms", 2, 3.0),
        value("gtsam", theirs[0], "ms", 1, 3.0),
        value("ratio", fronts[0] / theirs[0], "", 2, 1.0),
        value("ratio_landmarks_first", landmarks_first[0] / theirs[0], "", 2, 1.0),
        value("cost", fronts[1], "", 2, 1e-6),
        value("gtsam_cost", theirs[1], "", 2, 1e-6),
    ])
}

const TURNS: usize = 3;

/// The least time of an iteration, and twice the cost at the end.
fn theirs(python: &Python, graph: &Exported) -> Result<[f64; 2], NotMade> {
    let said = python.says("window_gtsam.py", graph)?.concat();
    let shape =
        |said| NotMade::Failed(format!("window_gtsam.py prints {said:?}; two numbers are due"));
    said.try_into().map_err(shape)
}

/// The window as `window_gtsam.py` reads it.
fn exported(window: &Window, recording: &FlightRecording) -> Exported {
    let (sensors, values) = (Sensors::from(recording), window.problem.values());
    let mut lines = Exported::default();
    for state in window.states.iter().map(|key| &values[*key]) {
        lines.line("state", &state_numbers(state));
    }
    let bias = values[window.biases[0]];
    lines.line("bias", bias.vector().as_slice());
    lines.line("extrinsics", &pose_numbers(&values[window.extrinsics]));
    let noise = &sensors.noise;
    let densities = [noise.gyro, noise.accelerometer, noise.gyro_walk, noise.accelerometer_walk];
    lines.line("noise", &densities);
    let camera = sensors.camera;
    lines.line("camera", &[camera.fx, camera.fy, camera.cx, camera.cy, sensors.pixel_sigma]);
    lines.line("sigmas", &[STATE.as_slice(), &BIAS].concat());
    let seen = tracks(&sensors);
    for (number, (track, landmark)) in window.landmarks.iter().enumerate() {
        lines.line("landmark", values[*landmark].as_slice());
        for (state, pixel) in &seen[track] {
            lines.line("pixel", &[*state as f64, number as f64, pixel.x, pixel.y]);
        }
    }
    for (interval, readings) in intervals(&sensors).expect("covered").iter().enumerate() {
        for pair in readings.windows(2) {
            // Their force acts as the body stands at the beginning of a step, ours as it does halfway.
            let mean = ImuSample::mean(&pair[0].sample, &pair[1].sample);
            let dt = pair[0].seconds_to(&pair[1]);
            let turn = so3::exp(&(0.5 * dt * mean.corrected(&bias).gyro));
            let force = turn * mean.accelerometer;
            let [gyro, force] = [mean.gyro.as_slice(), force.as_slice()];
            lines.line("reading", &[&[interval as f64, dt], gyro, force].concat());
        }
    }
    lines
}
