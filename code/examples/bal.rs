//! Solves a problem of the "Bundle Adjustment in the Large" data sets.
//!
//! ```text
//! cargo run --release -p vislam --example bal -- \
//!     FILE [--fix-intrinsics] [--huber D] [--iterations N]
//! ```
//!
//! prints the iterations and, in its last line, how many there were, the cost at the end
//! (half the sum of squares, or of what Huber's kernel makes of them, over all observations
//! that were kept) and the time of an iteration. A solve is repeated from the same start
//! until a second has passed, and the median counts.
//! With `--fix-intrinsics` only the poses move, and the first one is held.

use std::error::Error;
use std::time::{Duration, Instant};

use vislam::bundle_adjustment::{Camera, Solver, TinyBa};
use vislam::datasets::bal::{BalError, read_bal};
use vislam::least_squares::Options;

const USAGE: &str = "usage: bal FILE [--fix-intrinsics] [--huber D] [--iterations N]";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or(USAGE)?;
    let (mut fix_intrinsics, mut huber) = (false, None);
    let mut options = Options::large_problem();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--fix-intrinsics" => fix_intrinsics = true,
            "--huber" => huber = Some(arguments.next().ok_or(USAGE)?.parse()?),
            "--iterations" => options.max_iterations = arguments.next().ok_or(USAGE)?.parse()?,
            unknown => return Err(format!("{unknown} is not an option; {USAGE}").into()),
        }
    }
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{file}: {error}"))?;
    let in_file = |error: BalError| format!("{file}: {error}");
    if fix_intrinsics {
        let mut problem = read_bal::<6>(&text).map_err(in_file)?;
        problem.fixed.iter_mut().take(1).for_each(|fixed| *fixed = true);
        solve(TinyBa { huber, ..problem }, &options)
    } else {
        solve(TinyBa { huber, ..read_bal::<9>(&text).map_err(in_file)? }, &options)
    }
}

fn solve<C: Camera<D>, const D: usize>(
    problem: TinyBa<C, D>,
    options: &Options,
) -> Result<(), Box<dyn Error>> {
    let mut times = Vec::new();
    let began = Instant::now();
    let report = loop {
        let mut solver = Solver::new(&problem, options)?;
        let mut spent = Duration::ZERO;
        let stop = loop {
            let (start, before) = (Instant::now(), solver.iterations().len());
            let stop = solver.iterate()?;
            // A step that was not worth trying is no iteration.
            if stop.is_none() || solver.iterations().len() > before {
                spent += start.elapsed();
            }
            if let Some(stop) = stop {
                break stop;
            }
        };
        times.push(1e3 * spent.as_secs_f64() / solver.iterations().len().max(1) as f64);
        if began.elapsed() > Duration::from_secs(1) && times.len() > 2 {
            break solver.report(stop);
        }
    };
    println!("iteration  cost            gradient    damping    gain");
    for (number, step) in report.iterations.iter().enumerate() {
        let verdict = if step.accepted { "" } else { "  rejected" };
        println!(
            "{number:9}  {:.8e}  {:.3e}  {:.3e}  {:6.3}{verdict}",
            step.cost,
            step.gradient_norm,
            step.damping,
            step.gain_ratio.unwrap_or(f64::NAN)
        );
    }
    println!("{} unknowns, {} after elimination", report.full_dim, report.reduced_dim);
    println!("{:?}; stopped because {}", report.dropped, report.stop);
    times.sort_by(f64::total_cmp);
    println!(
        "iterations {}  cost {:.8e}  ms_per_iteration {:.4}",
        report.iterations.len(),
        report.cost,
        times[times.len() / 2]
    );
    Ok(())
}
