//! How the time and the memory of an iteration grow.

use std::time::Instant;

use vislam::bundle_adjustment::Solver;
use vislam::least_squares::{Options, Stop};
use vislam::simulation::Scene;

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

/// Registers the numbers and the record.
pub fn numbers(chapter: &mut Chapter) {
    let [n0, n1, n2, n3, n4] = observations();
    chapter.number("growth_n_0", n0, "", 0);
    chapter.number("growth_n_1", n1, "", 0);
    chapter.number("growth_n_2", n2, "", 0);
    chapter.number("growth_n_3", n3, "", 0);
    chapter.number("growth_n_4", n4, "", 0);
    // Checked against the covisibility by the equation of the chapter.
    let ring = Scene::ring(CAMERAS, POINTS[0], 1.0, 1).problem;
    let report = Solver::new(&ring, &Options::large_problem())
        .map(|solver| solver.report(Stop::IterationLimit));
    let products = report.map_or(f64::NAN, |report| report.block_products as f64);
    chapter.number("growth_products", products, "", 0);
    chapter.number("growth_points", POINTS[0] as f64, "", 0);
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
    // Times are those of a machine and an hour; memory is exact.
    let time =
        |name, value, unit, decimals| RecordValue { name, value, unit, decimals, within: 3.0 };
    let exact =
        |name, value, unit, decimals| RecordValue { name, value, unit, decimals, within: 1e-9 };
    let mut values = Vec::new();
    for index in 0..POINTS.len() {
        let decimals = if times[index] < 10.0 { 2 } else { 1 };
        values.push(time(TIMES[index], times[index], "ms", decimals));
        values.push(exact(BYTES[index], 1e-6 * bytes[index], "MB", 1));
    }
    let (_, slope) = line(&observations(), &times);
    values.push(time("slope_ns", 1e6 * slope, "ns", 0));
    // What is left of times is noise and may be anything.
    let off = above_line(&times).iter().fold(0.0_f64, |most, off| most.max(off.abs()));
    let within = 1e3;
    values.push(RecordValue { name: "most_off", value: off, unit: "%", decimals: 1, within });
    values.push(exact("slope_bytes", line(&observations(), &bytes).1, "bytes", 0));
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
