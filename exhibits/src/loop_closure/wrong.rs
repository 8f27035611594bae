//! Wrong loops: two sides of the hall that look the same.

use std::sync::OnceLock;

use nalgebra::Isometry3;
use vislam::filtering::chi_square_quantile;
use vislam::least_squares::Kernel;
use vislam::loop_closure::{
    Graduation, SpatialGraph, UprightGraph, UprightPose, pose_graph_options,
};

use super::flight::shown;
use crate::chapter::Chapter;

/// Every so many of the flight's loops are kept.
const EVERY: usize = 6;
/// Half a round, in keyframes.
const HALF: usize = 39;
/// A number without a common factor with that of the loops.
const SPREAD: usize = 37;
/// How many wrong loops there are.
pub const COUNTS: [usize; 8] = [0, 1, 3, 7, 15, 31, 63, 110];
/// A right loop passes with this probability.
const PASSES: f64 = 0.999;

/// What is done about wrong loops.
pub const WAYS: [&str; 5] = ["least squares", "Huber", "Cauchy", "switches", "graduated"];

/// Odometry, right loops and so many wrong ones: what was measured between two keyframes is taken for the second and
/// one half a round from the first. Which ones are mistaken is spread over the flight.
fn graph(wrong: usize) -> SpatialGraph {
    let closed = shown();
    let all = closed.loops();
    let mut graph = closed.keyframes.odometry.clone();
    graph.measurements.extend(all.iter().step_by(EVERY).cloned());
    let is_mistaken = |at: &usize| (at * SPREAD) % all.len() < wrong;
    let mistaken = (0..all.len()).filter(is_mistaken).map(|at| {
        let mut mistaken = all[at].clone();
        mistaken.first = mistaken.first.checked_sub(HALF).unwrap_or(mistaken.first + HALF);
        mistaken
    });
    graph.measurements.extend(mistaken);
    graph
}

/// The threshold of a right loop's squared error.
fn limit() -> f64 {
    chi_square_quantile(PASSES, 4).expect("a probability")
}

/// Where a way leads with so many wrong loops.
pub struct Outcome {
    /// The root of the mean square of the positions' errors in metres.
    pub error: f64,
    /// How many right and how many wrong loops count for more than half, where a way decides on loops.
    pub believed: [usize; 2],
}

/// All ways begin at the odometry and have the same threshold.
fn outcome(way: usize, wrong: usize) -> Outcome {
    let graph = graph(wrong).upright();
    let loops = graph.loops();
    let (options, limit) = (pose_graph_options(), limit());
    let threshold = limit.sqrt();
    let with = |kernel: Kernel| (with_kernel(&graph, kernel), Vec::new());
    let (poses, weights) = match way {
        0 => with(Kernel::Squared),
        1 => with(Kernel::Huber(threshold)),
        2 => with(Kernel::Cauchy(threshold)),
        3 => {
            let solved = graph.solve_switched(&loops, limit, &options).expect("connected");
            (solved.poses, solved.switches)
        }
        _ => {
            let graduation = Graduation::with_threshold(threshold);
            let solved = graph.solve_graduated(&loops, &graduation, &options).expect("connected");
            (solved.poses, solved.weights)
        }
    };
    let right = loops.len() - wrong;
    let believed = |weights: &[f64]| weights.iter().filter(|weight| **weight > 0.5).count();
    let (of_right, of_wrong) = weights.split_at(right.min(weights.len()));
    Outcome { error: error(&poses), believed: [of_right, of_wrong].map(believed) }
}

/// The poses with a kernel for each loop.
fn with_kernel(graph: &UprightGraph, kernel: Kernel) -> Vec<UprightPose> {
    let loops = graph.loops();
    let of = |number: usize| if loops.contains(&number) { kernel } else { Kernel::Squared };
    graph.solve(of, &pose_graph_options()).expect("connected").poses
}

/// The root of the mean square of the positions' errors in metres.
fn error(poses: &[UprightPose]) -> f64 {
    let poses: Vec<Isometry3<f64>> =
        poses.iter().map(|UprightPose { world_from_body }| *world_from_body).collect();
    shown().errors_of(&poses).position
}

/// By way and by count.
pub fn all() -> &'static [[Outcome; COUNTS.len()]; WAYS.len()] {
    static ALL: OnceLock<[[Outcome; COUNTS.len()]; WAYS.len()]> = OnceLock::new();
    ALL.get_or_init(|| std::array::from_fn(|way| COUNTS.map(|wrong| outcome(way, wrong))))
}

/// Nearly as many wrong loops as right ones.
const MANY: usize = 4;

pub fn numbers(chapter: &mut Chapter) {
    let right = graph(0).loops().len();
    chapter.number("right_loops", right as f64, "", 0);
    let most = graph(COUNTS[COUNTS.len() - 1]).loops().len() - right;
    chapter.number("wrong_most", most as f64, "", 0);
    chapter.number("passes", 100.0 * PASSES, "%", 1);
    chapter.number("threshold", limit().sqrt(), "", 1);
    let [squares, huber, cauchy, switches, graduated] = all();
    chapter.number("wrong_none", 100.0 * squares[0].error, "cm", 0);
    chapter.number("wrong_one", squares[1].error, "m", 1);
    chapter.number("huber_one", 100.0 * huber[1].error, "cm", 0);
    chapter.number("wrong_many", COUNTS[MANY] as f64, "", 0);
    chapter.number("huber_many", huber[MANY].error, "m", 1);
    let tight = error(&with_kernel(&graph(0).upright(), Kernel::Cauchy(1.0)));
    chapter.number("cauchy_tight", 100.0 * tight, "cm", 0);
    chapter.number("cauchy_many", 100.0 * cauchy[MANY].error, "cm", 0);
    chapter.number("switches_none", 100.0 * switches[0].error, "cm", 0);
    chapter.number("switches_right", switches[0].believed[0] as f64, "", 0);
    chapter.number("switches_many", 100.0 * switches[MANY].error, "cm", 0);
    chapter.number("graduated_none", 100.0 * graduated[0].error, "cm", 0);
    chapter.number("graduated_many", 100.0 * graduated[MANY].error, "cm", 0);
    chapter.number("graduated_right", graduated[MANY].believed[0] as f64, "", 0);
    let with_wrong = graduated.iter().skip(1);
    let let_in = with_wrong.map(|outcome| outcome.believed[1]).max().unwrap_or(0);
    chapter.number("graduated_wrong", let_in as f64, "", 0);
}
