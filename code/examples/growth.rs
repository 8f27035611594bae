//! How the time and the memory of an iteration grow with the number of observations, with the
//! cameras fixed in number: eight on a ring that see everything.
//!
//! `cargo run --release -p vislam --example growth` prints a line for each size, and the
//! straight line a + b N through all of them with its relative residuals.

use std::error::Error;
use std::time::Instant;

use vislam::bundle_adjustment::Solver;
use vislam::least_squares::Options;
use vislam::simulation::Scene;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut observations, mut times, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
    for exponent in 0..=8 {
        let count = (1250.0 * 10_f64.powf(0.25 * f64::from(exponent))).round() as usize;
        let mut problem = Scene::ring(8, count, 1.0, 1).problem;
        problem.factors.shrink_to_fit();
        // No step is too small to be tried.
        let options = Options {
            gradient_tolerance: 0.0,
            step_tolerance: 0.0,
            decrease_tolerance: 0.0,
            ..Options::large_problem()
        };
        let mut solver = Solver::new(&problem, &options)?;
        let mut fastest = f64::INFINITY;
        for _ in 0..8 {
            let start = Instant::now();
            solver.iterate()?;
            fastest = fastest.min(1e3 * start.elapsed().as_secs_f64());
        }
        observations.push(8.0 * count as f64);
        times.push(fastest);
        bytes.push(solver.bytes() as f64);
    }
    for (what, values) in [("ms", &times), ("bytes", &bytes)] {
        let (a, b) = line(&observations, values);
        println!("{what} = {a:.4} + {b:.8} N");
        for (n, value) in observations.iter().zip(values) {
            let residual = value / (a + b * n) - 1.0;
            println!("{:9} observations  {value:14.4}  {:+.2} %", n, 100.0 * residual);
        }
    }
    Ok(())
}

/// The line through points whose errors are proportional to their values.
fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let mut sums = [0.0; 5];
    for (x, y) in x.iter().zip(y) {
        let w = 1.0 / (y * y);
        for (sum, term) in sums.iter_mut().zip([w, w * x, w * x * x, w * y, w * x * y]) {
            *sum += term;
        }
    }
    let [w, wx, wxx, wy, wxy] = sums;
    let b = (w * wxy - wx * wy) / (w * wxx - wx * wx);
    ((wy - b * wx) / w, b)
}
