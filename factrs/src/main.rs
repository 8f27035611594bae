//! What the record `factrs_seeds` asks.
//!
//! ```text
//! cargo run --release -p factrs-graph -- errors SEEDS
//! cargo run --release -p factrs-graph -- times RUNS
//! ```
//!
//! `errors` prints, for each seed and each solver a line: seed, solver, and the squared errors of velocity and biases at
//! the second keyframe, as `two_keyframes::ASKED` has them. `times` prints, for each solver, the least milliseconds
//! that it took to put the graph together and to solve it.

use std::error::Error;
use std::time::Instant;

use factrs_graph::graph::{self, GyroNoise};
use factrs_graph::identical;
use factrs_graph::two_keyframes::{ASKED, Estimate, Graph, HUBER, Scene, squared};
use vislam::least_squares::Kernel;

const USAGE: &str = "usage: factrs-graph errors SEEDS | factrs-graph times RUNS";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["errors", seeds] => errors(seeds.parse()?),
        ["times", runs] => times(runs.parse()?),
        _ => Err(USAGE.into()),
    }
}

/// How one of them puts the graph of a scene together, ready to be solved.
type Made<'a> = Box<dyn FnOnce() -> Result<Estimate, Box<dyn Error>> + 'a>;

fn ours(scene: &Scene) -> Result<Made<'_>, Box<dyn Error>> {
    let graph = Graph::new(scene, Kernel::Huber(HUBER))?;
    Ok(Box::new(move || Ok(graph.solved()?)))
}

fn theirs(scene: &Scene, graph: factrs::core::Graph) -> Made<'_> {
    Box::new(move || graph::solve(graph, &scene.guess).map_err(|error| format!("{error:?}").into()))
}

/// How a solver is called, and how it puts the graph together.
type Solver = (&'static str, fn(&Scene) -> Result<Made<'_>, Box<dyn Error>>);

const SOLVERS: [Solver; 4] = [
    ("ours", ours),
    ("identical", |scene| Ok(theirs(scene, identical::graph(scene)))),
    ("named", |scene| Ok(theirs(scene, graph::graph(scene, GyroNoise::Named)))),
    ("moved", |scene| Ok(theirs(scene, graph::graph(scene, GyroNoise::Moved)))),
];

fn errors(seeds: u64) -> Result<(), Box<dyn Error>> {
    for seed in 0..seeds {
        let scene = Scene::drawn(seed);
        for (name, make) in SOLVERS {
            let off = scene.truth.step_to(&make(&scene)?()?);
            let squares = ASKED.map(|(_, at, _)| squared(&off, at).to_string());
            println!("{seed},{name},{}", squares.join(","));
        }
    }
    Ok(())
}

fn times(runs: usize) -> Result<(), Box<dyn Error>> {
    let scene = Scene::drawn(0);
    let mut least = [[f64::INFINITY; 2]; SOLVERS.len()];
    for _ in 0..runs {
        for (least, (_, make)) in least.iter_mut().zip(SOLVERS) {
            let start = Instant::now();
            let made = make(&scene)?;
            least[0] = least[0].min(1e3 * start.elapsed().as_secs_f64());
            let start = Instant::now();
            made()?;
            least[1] = least[1].min(1e3 * start.elapsed().as_secs_f64());
        }
    }
    for ([made, solved], (name, _)) in least.iter().zip(SOLVERS) {
        println!("{name},{made},{solved}");
    }
    Ok(())
}
