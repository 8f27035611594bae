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
/// Spheres with errors so many times as large, and how many of them.
const LARGER: f64 = 3.0;
const SPHERES: u64 = 10;

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

/// Each pose as measured from the one before it and from its neighbour in the ring above.
fn graph(noise: [f64; 2], seed: u64) -> SpatialGraph {
    let (poses, mut random) = (places(), Random::new(seed));
    let chain = (1..poses.len()).map(|number| [number - 1, number]);
    let above = (IN_RING..poses.len()).map(|number| [number - IN_RING, number]);
    let measurements =
        chain.chain(above).map(|pair| measure(&poses, pair, noise, &mut random)).collect();
    PoseGraph { poses, measurements }
}

/// A search from poses.
pub struct Search {
    pub begin: Vec<Isometry3<f64>>,
    pub found: Vec<Isometry3<f64>>,
    /// The cost at the beginning and after each step that was taken.
    pub costs: Vec<f64>,
}

impl Search {
    fn last(&self) -> f64 {
        self.costs[self.costs.len() - 1]
    }
}

/// The searches from odometry and from the chord.
pub fn searches() -> &'static [Search; 2] {
    static SEARCHES: OnceLock<[Search; 2]> = OnceLock::new();
    SEARCHES.get_or_init(|| both(&graph(NOISE, 17)))
}

fn both(graph: &SpatialGraph) -> [Search; 2] {
    let odometry = graph.chained().expect("it is connected");
    let chordal = chordal_initialization(graph).expect("it is connected");
    [odometry, chordal].map(|begin| search(graph, begin))
}

/// Of spheres with errors so many times as large, how many have a search from odometry, and from the chord, that ends
/// higher than the other.
fn lost(times: f64) -> [usize; 2] {
    let noise = NOISE.map(|sigma| times * sigma);
    let ends = (0..SPHERES).map(|seed| both(&graph(noise, 100 + seed)).map(|search| search.last()));
    ends.fold([0, 0], |[odometry, chordal], [by_odometry, by_chord]| {
        let higher = |a: f64, b: f64| usize::from(a > b * (1.0 + 1e-6));
        [odometry + higher(by_odometry, by_chord), chordal + higher(by_chord, by_odometry)]
    })
}

/// The root of the mean square of the angles between rotations.
fn turned(some: &[Isometry3<f64>], others: &[Isometry3<f64>]) -> f64 {
    let angles = some.iter().zip(others).map(|(a, b)| a.rotation.angle_to(&b.rotation).powi(2));
    (angles.sum::<f64>() / some.len() as f64).sqrt()
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
    let graph = graph(NOISE, 17);
    chapter.number("sphere_poses", graph.poses.len() as f64, "", 0);
    chapter.number("sphere_measurements", graph.measurements.len() as f64, "", 0);
    chapter.number("sphere_noise", 1e3 * NOISE[1], "mrad", 0);
    let [odometry, chordal] = searches();
    chapter.number("sphere_odometry", odometry.costs[0], "", 0);
    chapter.number("sphere_chordal", chordal.costs[0], "", 0);
    chapter.number("sphere_minimum", chordal.last(), "", 1);
    chapter.number("sphere_other", odometry.last(), "", 1);
    chapter.number("chord_turned", 1e3 * turned(&chordal.begin, &chordal.found), "mrad", 0);
    chapter.number("spheres", SPHERES as f64, "", 0);
    let [by_odometry, by_chord] = lost(LARGER);
    chapter.number("larger_noise", 1e3 * LARGER * NOISE[1], "mrad", 0);
    chapter.number("lost_odometry", by_odometry as f64, "", 0);
    chapter.number("lost_chordal", by_chord as f64, "", 0);
    chapter.number("steps_odometry", (odometry.costs.len() - 1) as f64, "", 0);
    chapter.number("steps_chordal", (chordal.costs.len() - 1) as f64, "", 0);
}
