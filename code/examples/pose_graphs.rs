//! Public pose graphs: their minimum, where to begin, whether it is the lowest one, and the time of each.
//!
//! ```text
//! cargo run --release -p vislam --example pose_graphs -- FOLDER
//! ```
//!
//! The folder holds `sphere2500.txt` and `w10000.graph`, as that of the examples which come with GTSAM
//! does. `pose_graphs_gtsam.py` asks GTSAM the same.

use std::error::Error;
use std::time::Instant;

use nalgebra::Matrix6;
use vislam::datasets::pose_graph::{read_planar_graph, read_pose_graph};
use vislam::factors::GraphPose;
use vislam::least_squares::{Kernel, Method, Options};
use vislam::loop_closure::{
    PoseGraph, SpatialGraph, certify, chordal_initialization, pose_graph_options,
};

/// The least time of three calls.
fn timed<T>(what: &str, call: impl Fn() -> T) -> T {
    let mut best = f64::INFINITY;
    let mut once = || {
        let begin = Instant::now();
        let result = call();
        best = best.min(1e3 * begin.elapsed().as_secs_f64());
        result
    };
    let (_, _, result) = (once(), once(), once());
    println!("  {what}: {best:.0} ms");
    result
}

/// Gauss-Newton and Levenberg-Marquardt, until the cost falls by less than a billionth.
fn solve<P: GraphPose<D>, const D: usize>(
    name: &str,
    graph: &PoseGraph<P, D>,
) -> Result<(), Box<dyn Error>> {
    println!("{name}: {:.9e} at first", graph.cost()?);
    for (name, method) in [
        ("Gauss-Newton", Method::GaussNewton),
        ("Levenberg-Marquardt", pose_graph_options().method),
    ] {
        let options = Options { method, decrease_tolerance: 1e-9, ..Options::default() };
        let solved = timed(name, || graph.solve(|_| Kernel::Squared, &options))?;
        let report = solved.report;
        println!(
            "    {:.9e} after {} steps, {}",
            report.cost,
            report.iterations.len(),
            report.stop
        );
    }
    Ok(())
}

/// Blocks of information exchanged, as GTSAM reads `EDGE3`.
fn exchanged(graph: &SpatialGraph) -> SpatialGraph {
    let mut graph = graph.clone();
    for measurement in &mut graph.measurements {
        let written = measurement.information;
        measurement.information =
            Matrix6::from_fn(|row, column| written[((row + 3) % 6, (column + 3) % 6)]);
    }
    graph
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("name the folder of the pose graphs")?;
    let text = std::fs::read_to_string(format!("{folder}/sphere2500.txt"))?;
    let graph = timed("reading", || read_pose_graph(&text))?.graph;
    for (name, graph) in [("as written", graph.clone()), ("as GTSAM reads it", exchanged(&graph))] {
        solve(&format!("sphere2500 {name}, chained"), &graph)?;
        let poses = timed("chordal initialization", || chordal_initialization(&graph))?;
        solve(&format!("sphere2500 {name}, chordal"), &graph.with_poses(poses))?;
    }
    println!("sphere2500, isotropic");
    let graph = graph.isotropic();
    let graph = graph.with_poses(chordal_initialization(&graph)?);
    let solved = timed("chordal cost", || graph.solve_chordal(&pose_graph_options()))?;
    println!("    {} steps, {}", solved.report.iterations.len(), solved.report.stop);
    let certificate = timed("certificate", || certify(&graph, &solved.poses, 1e-10))?;
    println!("    {certificate:?}");
    let text = std::fs::read_to_string(format!("{folder}/w10000.graph"))?;
    let graph = timed("reading", || read_planar_graph(&text))?.graph;
    solve("w10000", &graph)
}
