//! Wrong loops: two sides of the hall that look the same.

use std::sync::OnceLock;

use nalgebra::Isometry3;
use vislam::filtering::chi_square_quantile;
use vislam::least_squares::Kernel;
use vislam::loop_closure::{Graduation, SpatialGraph, UprightPose, pose_graph_options};

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

/// The root of the mean square of the positions' errors in metres.
fn error(way: usize, wrong: usize) -> f64 {
    let graph = graph(wrong).upright();
    let loops = graph.loops();
    let options = pose_graph_options();
    let with = |kernel: Kernel| {
        let of = |number: usize| if loops.contains(&number) { kernel } else { Kernel::Squared };
        graph.solve(of, &options).expect("connected").poses
    };
    let poses = match way {
        0 => with(Kernel::Squared),
        1 => with(Kernel::Huber(1.0)),
        2 => with(Kernel::Cauchy(1.0)),
        3 => graph.solve_switched(&loops, limit(), &options).expect("connected").poses,
        _ => {
            let graduation = Graduation::with_threshold(limit().sqrt());
            graph.solve_graduated(&loops, &graduation, &options).expect("connected").poses
        }
    };
    let poses: Vec<Isometry3<f64>> =
        poses.iter().map(|UprightPose { world_from_body }| *world_from_body).collect();
    shown().errors_of(&poses).position
}

/// By way and by count, the errors in metres.
pub fn all() -> &'static [[f64; COUNTS.len()]; WAYS.len()] {
    static ALL: OnceLock<[[f64; COUNTS.len()]; WAYS.len()]> = OnceLock::new();
    ALL.get_or_init(|| std::array::from_fn(|way| COUNTS.map(|wrong| error(way, wrong))))
}

/// Nearly as many wrong loops as right ones.
const MANY: usize = 4;

pub fn numbers(chapter: &mut Chapter) {
    let right = graph(0).loops().len();
    chapter.number("right_loops", right as f64, "", 0);
    let most = graph(COUNTS[COUNTS.len() - 1]).loops().len() - right;
    chapter.number("wrong_most", most as f64, "", 0);
    chapter.number("passes", 100.0 * PASSES, "%", 1);
    let all = all();
    chapter.number("wrong_none", 100.0 * all[0][0], "cm", 0);
    chapter.number("wrong_one", all[0][1], "m", 1);
    chapter.number("huber_one", 100.0 * all[1][1], "cm", 0);
    chapter.number("wrong_many", COUNTS[MANY] as f64, "", 0);
    chapter.number("huber_many", all[1][MANY], "m", 1);
    chapter.number("cauchy_none", 100.0 * all[2][0], "cm", 0);
    chapter.number("switches_none", 100.0 * all[3][0], "cm", 0);
    chapter.number("graduated_many", 100.0 * all[4][MANY], "cm", 0);
}
