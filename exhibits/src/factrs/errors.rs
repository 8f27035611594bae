//! How far off the estimates are over many seeds: the book's library here, factrs from its own program, and the bound.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use vislam::least_squares::Kernel;

use super::two_keyframes::{ASKED, Graph, HUBER, Scene, squared};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};
use crate::release;

pub const SEEDS: u64 = 200;
/// How often each search is timed.
const RUNS: u64 = 200;
/// What is asked, as numbers are called.
const NAMES: [&str; 4] = ["turn", "velocity", "gyro", "accelerometer"];
/// The graphs of the record.
const GRAPHS: [&str; 3] = ["identical", "named", "moved"];
/// The shares of the seeds at which the record keeps errors of the turn.
pub const QUANTILES: usize = 10;

/// What [`ASKED`] is off in one seed, squared, and the bound of it.
type Asked = [f64; ASKED.len()];

/// The squared errors of each seed, and the bounds.
pub struct Errors {
    pub squares: Vec<Asked>,
    pub huber: Vec<Asked>,
    pub bound: Vec<Asked>,
    /// The bound without any pixel.
    pub blind: Vec<Asked>,
}

/// The errors of the book's library, with least squares and with Huber's kernel.
pub fn ours() -> &'static Errors {
    static OURS: OnceLock<Errors> = OnceLock::new();
    OURS.get_or_init(|| {
        let (mut squares, mut huber) = (Vec::new(), Vec::new());
        let (mut bound, mut blind) = (Vec::new(), Vec::new());
        for scene in (0..SEEDS).map(Scene::drawn) {
            let off = |kernel| {
                let graph = Graph::new(&scene, kernel).expect("the sensors fit the graph");
                let off = scene.truth.step_to(&graph.solved().expect("priors leave nothing free"));
                ASKED.map(|(_, at, _)| squared(&off, at))
            };
            squares.push(off(Kernel::Squared));
            huber.push(off(Kernel::Huber(HUBER)));
            bound.push(asked_of_bound(&scene));
            blind.push(asked_of_bound(&without_pixels(scene)));
        }
        Errors { squares, huber, bound, blind }
    })
}

fn asked_of_bound(scene: &Scene) -> Asked {
    let variances = Graph::bound(scene).expect("priors leave nothing free");
    ASKED.map(|(_, at, _)| variances[at..at + 3].iter().sum())
}

fn without_pixels(mut scene: Scene) -> Scene {
    scene.pixels.clear();
    scene.guess.landmarks.clear();
    scene.truth.landmarks.clear();
    scene
}

/// The root of the mean of squares, in thousandths.
fn rms(squares: &[Asked]) -> Asked {
    let mean = |at: usize| squares.iter().map(|s| s[at]).sum::<f64>() / squares.len() as f64;
    std::array::from_fn(|at| 1e3 * mean(at).sqrt())
}

pub fn numbers(chapter: &mut Chapter) {
    let Errors { squares, huber, bound, blind } = ours();
    let tables = [
        (["turn_blind", "velocity_blind", "gyro_blind", "accelerometer_blind"], blind),
        (["turn_bound", "velocity_bound", "gyro_bound", "accelerometer_bound"], bound),
        (["turn_squares", "velocity_squares", "gyro_squares", "accelerometer_squares"], squares),
        (["turn_huber", "velocity_huber", "gyro_huber", "accelerometer_huber"], huber),
    ];
    for (names, errors) in tables {
        for ((name, value), (_, _, unit)) in names.into_iter().zip(rms(errors)).zip(ASKED) {
            chapter.number(name, value, unit, 2);
        }
    }
    let of = |value: &str| accepted("factrs_seeds", value);
    chapter.number("turn_lost", 100.0 * (of("named_turn") / of("identical_turn") - 1.0), "%", 0);
    chapter.number("slower", of("identical_solved") / of("ours_solved"), "", 1);
    chapter.number("slower_summing", of("moved_made") / of("ours_made"), "", 0);
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("graph", "that of examples/two_keyframes.rs".to_owned()),
        ("factrs", "0.3.0".to_owned()),
        ("seeds", format!("0 to {}", SEEDS - 1)),
    ];
    chapter.record_of_data("factrs_seeds", &[], inputs, of_factrs);
}

/// What the program of the folder `factrs` says.
fn said(arguments: [&str; 2]) -> Result<Vec<Vec<String>>, NotMade> {
    let text = release::said(&["--package", "factrs-graph"], &arguments)?;
    Ok(text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect())
}

fn numbers_in(fields: &[String]) -> Vec<f64> {
    fields.iter().map(|field| field.parse().unwrap_or(f64::NAN)).collect()
}

fn of_factrs() -> Result<Vec<RecordValue>, NotMade> {
    let mut errors: BTreeMap<String, Vec<Asked>> = BTreeMap::new();
    for line in said(["errors", &SEEDS.to_string()])? {
        let asked = numbers_in(&line[2..]).try_into().unwrap_or([f64::NAN; ASKED.len()]);
        errors.entry(line[1].clone()).or_default().push(asked);
    }
    let mut values = vec![RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0)];
    for graph in GRAPHS {
        let rms = rms(errors.get(graph).map_or(&[], Vec::as_slice));
        for ((name, value), (_, _, unit)) in NAMES.into_iter().zip(rms).zip(ASKED) {
            values.push(RecordValue::new(format!("{graph}_{name}"), value, unit, 2, 1e-4));
        }
    }
    let named = quantiles(errors.get("named").map_or(&[], Vec::as_slice));
    for (k, turn) in named.into_iter().enumerate() {
        values.push(RecordValue::new(format!("named_turn_{k}"), turn, "mrad", 2, 1e-4));
    }
    // Summing up takes as long whatever the fields say.
    let times = said(["times", &RUNS.to_string()])?;
    for line in times.iter().filter(|line| line[0] != "named") {
        let times = numbers_in(&line[1..]);
        for (what, time) in ["made", "solved"].into_iter().zip(times) {
            values.push(RecordValue::new(format!("{}_{what}", line[0]), time, "ms", 2, 3.0));
        }
    }
    Ok(values)
}

/// Errors of the turn in milliradians that so many shares of the seeds stay below, from the least share to the
/// greatest.
pub fn quantiles(squares: &[Asked]) -> Vec<f64> {
    let mut turns: Vec<f64> = squares.iter().map(|s| 1e3 * s[0].sqrt()).collect();
    turns.sort_by(f64::total_cmp);
    let share = |k: usize| turns.len() * (2 * k + 1) / (2 * QUANTILES);
    (0..QUANTILES).filter_map(|k| turns.get(share(k)).copied()).collect()
}
