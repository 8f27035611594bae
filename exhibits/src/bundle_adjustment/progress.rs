//! Solves of the ring and of the street, and how they went.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use vislam::bundle_adjustment::{BaReport, PosedPinhole};
use vislam::least_squares::{Method, Options, Stop};
use vislam::reprojection::ReprojFactor;
use vislam::simulation::Scene;

use super::whole::{Ba, moved, solver};

/// Standard deviation of each coordinate of a pixel.
pub const NOISE: f64 = 1.0;

/// How far the cameras of the street see along it, in metres.
pub const REACH: f64 = 2.5;

/// The damping with which a solve begins when nothing else is said.
pub const DAMPING: f64 = 1e-4;

fn damped_by(initial_damping: f64) -> Options {
    let method = Method::LevenbergMarquardt { initial_damping };
    Options { method, ..Options::large_problem() }
}

/// The ring of the chapter.
pub fn ring() -> Ba {
    Scene::ring(8, 40, NOISE, 1).problem
}

/// A street so short that all of it can be drawn.
pub fn short_street() -> Ba {
    Scene::street(10, REACH, NOISE, 1).problem
}

/// A street that takes longer to solve than the ring.
pub fn street() -> Ba {
    Scene::street(30, REACH, NOISE, 1).problem
}

/// A street that is long enough for its structure to matter.
pub fn long_street() -> Ba {
    Scene::street(200, REACH, NOISE, 1).problem
}

/// The ring, solved until no decrease is left.
pub fn solved_ring() -> &'static BaReport {
    static REPORT: OnceLock<BaReport> = OnceLock::new();
    REPORT.get_or_init(|| solved_from(ring(), DAMPING))
}

/// The street, likewise.
pub fn solved_street() -> &'static BaReport {
    static REPORT: OnceLock<BaReport> = OnceLock::new();
    REPORT.get_or_init(|| solved_from(street(), DAMPING))
}

/// A solve with this damping at the start that goes on until no decrease is left.
pub fn solved_from(mut problem: Ba, damping: f64) -> BaReport {
    let options = Options { decrease_tolerance: 1e-12, ..damped_by(damping) };
    problem.solve(&options).expect("a problem")
}

/// The cameras of the street after so many iterations, from a damping at the start.
pub fn street_cameras(max_iterations: usize, damping: f64) -> Vec<PosedPinhole> {
    let mut problem = street();
    let options = Options { max_iterations, decrease_tolerance: 1e-14, ..damped_by(damping) };
    problem.solve(&options).expect("a problem");
    problem.cameras
}

/// What a report says before anything is solved.
pub fn unsolved(problem: &Ba) -> BaReport {
    solver(problem).report(Stop::IterationLimit)
}

/// The ring with a second camera fixed, which fixes its size; its cost, and the costs at the end of
/// the undamped step and of its opposite.
pub fn step_and_its_opposite() -> [f64; 3] {
    let mut problem = ring();
    problem.fixed[1] = true;
    let solver = solver(&problem);
    let step = solver.step(0.0).expect("nothing is free");
    [solver.cost(), step.cost, unsolved(&moved(&problem, &step, -1.0)).cost]
}

/// The street when its last camera has come back to the first ones and sees one of their points.
pub fn closed(mut street: Ba) -> Ba {
    let seen_by_second = street.factors.iter().filter(|factor| factor.keyframe == 1);
    let nearest = seen_by_second
        .min_by(|a, b| street.points[a.point].x.total_cmp(&street.points[b.point].x))
        .expect("the second camera sees points");
    // Where the pixel is makes no difference to the structure.
    street.factors.push(ReprojFactor { keyframe: street.cameras.len() - 1, ..*nearest });
    street
}

/// The same street with its cameras numbered in no order, except for the first.
pub fn shuffled(street: &Ba) -> Ba {
    let mut shuffled = street.clone();
    let moving = street.cameras.len() - 1;
    // A prime, so that no two cameras get one number.
    let new = |camera: usize| if camera == 0 { 0 } else { 1 + 7919 * (camera - 1) % moving };
    for (camera, pose) in street.cameras.iter().enumerate() {
        shuffled.cameras[new(camera)] = *pose;
    }
    shuffled.factors.iter_mut().for_each(|factor| factor.keyframe = new(factor.keyframe));
    shuffled
}

/// Blocks from the first of each row to its diagonal, when rows are in the order of the cameras.
pub fn blocks_as_numbered(problem: &Ba) -> usize {
    let mut first: Vec<usize> = (0..problem.cameras.len()).collect();
    for (one, other) in shared_points(problem).into_keys() {
        let (later, earlier) = (one.max(other), one.min(other));
        first[later] = first[later].min(earlier);
    }
    let moving = (0..problem.cameras.len()).filter(|camera| !problem.fixed[*camera]);
    moving.map(|camera| camera + 1 - first[camera]).sum()
}

/// How many points each pair of moving cameras shares, by pairs with the larger index first.
pub fn shared_points(problem: &Ba) -> BTreeMap<(usize, usize), usize> {
    let mut seen_by = vec![Vec::new(); problem.points.len()];
    for factor in &problem.factors {
        seen_by[factor.point].push(factor.keyframe);
    }
    let mut shared = BTreeMap::new();
    for cameras in seen_by.iter().filter(|cameras| cameras.len() > 1) {
        let moving: Vec<usize> = cameras.iter().copied().filter(|k| !problem.fixed[*k]).collect();
        for (index, first) in moving.iter().enumerate() {
            for second in &moving[..index] {
                *shared.entry((*first, *second)).or_insert(0) += 1;
            }
        }
    }
    shared
}
