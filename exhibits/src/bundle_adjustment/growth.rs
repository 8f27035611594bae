//! How the time and the memory of an iteration grow.

use std::time::Instant;

use vislam::bundle_adjustment::Solver;
use vislam::least_squares::Options;
use vislam::simulation::Scene;

use super::progress::unsolved;
use crate::chapter::Chapter;
use crate::record::{RecordValue, accepted};

/// Points that eight cameras on a ring all see.
const POINTS: [usize; 5] = [1250, 3953, 12_500, 39_528, 125_000];
const CAMERAS: usize = 8;
/// The fastest iteration counts, of so many in each of so many turns. A turn is more than one, since
/// the first finds the caches full of another size.
const ITERATIONS: usize = 4;
const TURNS: usize = 10;

/// The straight line through places whose errors are proportional to their values: where it
/// begins and how steep it is.
pub fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let mut sums = [0.0; 5];
    for (x, y) in x.iter().zip(y) {
        let w = 1.0 / (y * y);
        for (sum, term) in sums.iter_mut().zip([w, w * x, w * x * x, w * y, w * x * y]) {
            *sum += term;
        }
    }
    let [w, wx, wxx, wy, wxy] = sums;
    let slope = (w * wxy - wx * wy) / (w * wxx - wx * wx);
    ((wy - slope * wx) / w, slope)
}

/// Numbers of observations.
pub fn observations() -> [f64; POINTS.len()] {
    POINTS.map(|points| (CAMERAS * points) as f64)
}

/// Milliseconds of an iteration and bytes of the solver, for each size. The sizes take turns, so
/// that whatever else the machine does meets all of them.
fn measured() -> [(f64, f64); POINTS.len()] {
    // No step is too small to be tried.
    let options = Options {
        gradient_tolerance: 0.0,
        step_tolerance: 0.0,
        decrease_tolerance: 0.0,
        ..Options::large_problem()
    };
    let problems = POINTS.map(|points| Scene::ring(CAMERAS, points, 1.0, 1).problem);
    let mut measured = [(f64::INFINITY, 0.0); POINTS.len()];
    for _ in 0..TURNS {
        for (problem, (fastest, bytes)) in problems.iter().zip(&mut measured) {
            let mut solver = Solver::new(problem, &options).expect("the ring is a problem");
            for _ in 0..ITERATIONS {
                let start = Instant::now();
                solver.iterate().expect("damping makes every system regular");
                *fastest = fastest.min(1e3 * start.elapsed().as_secs_f64());
            }
            *bytes = solver.bytes() as f64;
        }
    }
    measured
}

const TIMES: [&str; POINTS.len()] = ["ms_0", "ms_1", "ms_2", "ms_3", "ms_4"];
const BYTES: [&str; POINTS.len()] = ["mb_0", "mb_1", "mb_2", "mb_3", "mb_4"];

/// Registers the numbers.
pub fn numbers(chapter: &mut Chapter) {
    let names = ["growth_n_0", "growth_n_1", "growth_n_2", "growth_n_3", "growth_n_4"];
    for (name, observations) in names.into_iter().zip(observations()) {
        chapter.number(name, observations, "", 0);
    }
    // Checked against the covisibility by the equation of the chapter.
    let ring = Scene::ring(CAMERAS, POINTS[0], 1.0, 1).problem;
    chapter.number("growth_products", unsolved(&ring).block_products as f64, "", 0);
    chapter.number("growth_points", POINTS[0] as f64, "", 0);
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("scene", "Scene::ring(8, points, 1.0, 1)".to_owned()),
        ("points", POINTS.map(|points| points.to_string()).join(" ")),
        ("iterations", ITERATIONS.to_string()),
        ("turns", TURNS.to_string()),
    ];
    chapter.record("ba_growth", inputs, growth);
}

fn growth() -> Vec<RecordValue> {
    let measured = measured();
    let (times, bytes) = (measured.map(|of| of.0), measured.map(|of| of.1));
    let value =
        |name, value, unit, decimals, within| RecordValue::new(name, value, unit, decimals, within);
    // Times are those of a machine and an hour; memory is exact.
    let (of_time, exact) = (3.0, 1e-9);
    let mut values = Vec::new();
    for index in 0..POINTS.len() {
        let decimals = if times[index] < 10.0 { 2 } else { 1 };
        values.push(value(TIMES[index], times[index], "ms", decimals, of_time));
        values.push(value(BYTES[index], 1e-6 * bytes[index], "MB", 1, exact));
    }
    let slope = |values| line(&observations(), values).1;
    values.push(value("slope_ns", 1e6 * slope(&times), "ns", 0, of_time));
    // What is left of times is noise and may be anything.
    let off = above_line(&times).iter().fold(0.0_f64, |most, off| most.max(off.abs()));
    values.push(value("most_off", off, "%", 1, 1e3));
    values.push(value("slope_bytes", slope(&bytes), "bytes", 0, exact));
    values
}

/// What the accepted record says of time (ms) and memory (MB).
pub fn recorded() -> [[f64; POINTS.len()]; 2] {
    [TIMES, BYTES].map(|names| names.map(|name| accepted("ba_growth", name)))
}

/// By how many percent values lie above their line.
pub fn above_line(values: &[f64; POINTS.len()]) -> [f64; POINTS.len()] {
    let n = observations();
    let (start, slope) = line(&n, values);
    std::array::from_fn(|index| 100.0 * (values[index] / (start + slope * n[index]) - 1.0))
}
