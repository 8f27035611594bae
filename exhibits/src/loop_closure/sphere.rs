//! A sphere in rings, whose odometry turns too much to begin with.

use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use nalgebra::{Isometry3, Rotation3, Vector3};
use vislam::least_squares::{Kernel, Options, Report};
use vislam::loop_closure::{
    PoseGraph, SolvedGraph, SpatialGraph, chordal_initialization, pose_graph_options,
};

use super::draws::measure;
use crate::chapter::Chapter;
use crate::random::Random;

const RINGS: usize = 16;
const IN_RING: usize = 24;
const RADIUS: f64 = 10.0;
/// Standard deviations along each axis, in metres, and about each, in radians.
const NOISE: [f64; 2] = [0.1, 0.12];

/// Poses on a sphere, from pole to pole in a spiral; nose ahead.
fn places() -> Vec<Isometry3<f64>> {
    let place = |number: usize| {
        let height = PI * (number as f64 + 0.5) / (RINGS * IN_RING) as f64;
        let around = TAU * number as f64 / IN_RING as f64;
        RADIUS
            * Vector3::new(height.sin() * around.cos(), height.sin() * around.sin(), height.cos())
    };
    let pose = |number: usize| {
        let (here, next) = (place(number), place(number + 1));
        let up = here.normalize();
        let ahead = (next - here - up * up.dot(&(next - here))).normalize();
        let rotation = Rotation3::from_basis_unchecked(&[ahead, up.cross(&ahead), up]);
        Isometry3::from_parts(here.into(), rotation.into())
    };
    (0..RINGS * IN_RING).map(pose).collect()
}

/// Each pose as measured from the one before it and from its neighbour in the ring above, and where they are.
fn graph() -> (Vec<Isometry3<f64>>, SpatialGraph) {
    let (places, mut random) = (places(), Random::new(17));
    let chain = (1..places.len()).map(|number| [number - 1, number]);
    let above = (IN_RING..places.len()).map(|number| [number - IN_RING, number]);
    let measurements =
        chain.chain(above).map(|pair| measure(&places, pair, NOISE, &mut random)).collect();
    let graph = PoseGraph { poses: places.clone(), measurements };
    (places, graph)
}

/// A search from poses.
pub struct Search {
    pub begin: Vec<Isometry3<f64>>,
    pub found: Vec<Isometry3<f64>>,
    /// The cost at the beginning and after each step that was taken.
    pub costs: Vec<f64>,
}

/// The searches from odometry and from the chord.
pub fn searches() -> &'static [Search; 2] {
    static SEARCHES: OnceLock<[Search; 2]> = OnceLock::new();
    SEARCHES.get_or_init(|| {
        let (_, graph) = graph();
        let odometry = graph.chained().expect("it is connected");
        let chordal = chordal_initialization(&graph).expect("it is connected");
        [odometry, chordal].map(|begin| search(&graph, begin))
    })
}

fn search(graph: &SpatialGraph, begin: Vec<Isometry3<f64>>) -> Search {
    let options = Options { decrease_tolerance: 1e-9, ..pose_graph_options() };
    let solved = graph.with_poses(begin.clone()).solve(|_| Kernel::Squared, &options);
    let SolvedGraph { poses, report } = solved.expect("it is connected");
    Search { begin, found: poses, costs: costs(&report) }
}

fn costs(report: &Report) -> Vec<f64> {
    let before = report.iterations.iter().filter(|step| step.accepted).map(|step| step.cost);
    before.chain([report.cost]).collect()
}

pub fn numbers(chapter: &mut Chapter) {
    let (_, graph) = graph();
    chapter.number("sphere_poses", graph.poses.len() as f64, "", 0);
    chapter.number("sphere_measurements", graph.measurements.len() as f64, "", 0);
    chapter.number("sphere_noise", 1e3 * NOISE[1], "mrad", 0);
    let [odometry, chordal] = searches();
    let (first, last) = (|s: &Search| s.costs[0], |s: &Search| s.costs[s.costs.len() - 1]);
    chapter.number("sphere_odometry", first(odometry), "", 0);
    chapter.number("sphere_chordal", first(chordal), "", 0);
    chapter.number("sphere_minimum", last(chordal), "", 1);
    chapter.number("sphere_other", last(odometry), "", 1);
    chapter.number("steps_odometry", (odometry.costs.len() - 1) as f64, "", 0);
    chapter.number("steps_chordal", (chordal.costs.len() - 1) as f64, "", 0);
}
