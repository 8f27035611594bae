//! Public pose graphs: their minimum, where to begin, whether it is the lowest one, and the time of each.
//!
//! ```text
//! cargo run --release -p vislam --example pose_graphs -- FOLDER
//! ```
//!
//! The folder holds `sphere2500.txt` and `w10000.graph`, as that of the examples which come with GTSAM
//! does. `pose_graphs_gtsam.py` asks GTSAM the same, and says it in the same lines: a name and a number.
//! Costs are half the sum of squares, times the least of a few calls, in milliseconds. The sphere is read
//! as it is written and as GTSAM reads it, with the translation's information for the rotation.

use std::error::Error;
use std::time::Instant;

use nalgebra::Matrix6;
use vislam::datasets::pose_graph::{read_planar_graph, read_pose_graph};
use vislam::factors::GraphPose;
use vislam::least_squares::{Kernel, Method, Options};
use vislam::loop_closure::{
    Certificate, PoseGraph, SpatialGraph, certify, chordal_initialization, pose_graph_options,
};

/// Names and numbers.
pub struct Lines(pub Vec<(String, f64)>);

impl Lines {
    fn add(&mut self, name: &str, what: &str, value: f64) {
        self.0.push((format!("{name}.{what}"), value));
    }

    /// What a call gives, and the least time of three.
    fn timed<T>(&mut self, name: &str, call: impl Fn() -> T) -> T {
        let mut best = f64::INFINITY;
        let mut once = || {
            let begin = Instant::now();
            let result = call();
            best = best.min(1e3 * begin.elapsed().as_secs_f64());
            result
        };
        let (_, _, result) = (once(), once(), once());
        self.add(name, "ms", best);
        result
    }

    /// Gauss-Newton and Levenberg-Marquardt, until the cost falls by less than a billionth.
    fn solve<P: GraphPose<D>, const D: usize>(
        &mut self,
        name: &str,
        graph: &PoseGraph<P, D>,
    ) -> Result<(), Box<dyn Error>> {
        self.add(name, "start", graph.cost()?);
        let ways =
            [("gauss_newton", Method::GaussNewton), ("levenberg", pose_graph_options().method)];
        for (way, method) in ways {
            let options = Options { method, decrease_tolerance: 1e-9, ..Options::default() };
            let name = format!("{name}.{way}");
            let report = self.timed(&name, || graph.solve(|_| Kernel::Squared, &options))?.report;
            self.add(&name, "cost", report.cost);
            self.add(&name, "steps", report.iterations.len() as f64);
        }
        Ok(())
    }
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

/// All that there is to say of the graphs with these texts.
pub fn measured(sphere: &str, plane: &str) -> Result<Lines, Box<dyn Error>> {
    let mut lines = Lines(Vec::new());
    let graph = lines.timed("sphere.reading", || read_pose_graph(sphere))?.graph;
    for (name, graph) in [("sphere", graph.clone()), ("sphere_as_read", exchanged(&graph))] {
        lines.solve(&format!("{name}.chained"), &graph)?;
        let begin = lines.timed(&format!("{name}.chord"), || chordal_initialization(&graph))?;
        lines.solve(&format!("{name}.chordal"), &graph.with_poses(begin))?;
    }
    let graph = graph.isotropic();
    let graph = graph.with_poses(chordal_initialization(&graph)?);
    let solved = lines.timed("isotropic", || graph.solve_chordal(&pose_graph_options()))?;
    let certificate = lines.timed("certificate", || certify(&graph, &solved.poses, 1e-10))?;
    if let Certificate::Certified { cost, lower_bound, .. } = certificate {
        lines.add("certificate", "cost", cost);
        lines.add("certificate", "gap", (cost - lower_bound) / cost);
    }
    let graph = lines.timed("plane.reading", || read_planar_graph(plane))?.graph;
    lines.solve("plane", &graph)?;
    Ok(lines)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("name the folder of the pose graphs")?;
    let text = |name: &str| std::fs::read_to_string(format!("{folder}/{name}"));
    for (name, value) in measured(&text("sphere2500.txt")?, &text("w10000.graph")?)?.0 {
        println!("{name} {value:.9e}");
    }
    Ok(())
}
