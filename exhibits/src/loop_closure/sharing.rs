//! How a chain shares the gap of its loop.

use nalgebra::{DMatrix, Isometry2, Matrix3, Vector2, Vector3};
use vislam::least_squares::{Kernel, Options};
use vislam::loop_closure::{GraphProblem, PlanarGraph, PoseGraph, RelativeMeasurement};

use super::STATES;
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Shared); 4] = [
        ("every step takes the same part", |chain, closing, k| {
            let [_, variance] = shared(chain, closing, k);
            [(k + 1) as f64 / chain.len() as f64, variance]
        }),
        ("the loop taken for certain", |chain, _, k| shared(chain, 0.0, k)),
        ("as unsure as without the loop", |chain, closing, k| {
            [shared(chain, closing, k)[0], before(chain, k)]
        }),
        ("the gap left behind", |chain, closing, k| {
            let [part, variance] = shared(chain, closing, k);
            [1.0 - part, variance]
        }),
    ];
    chapter.equation("gap-shared", gap_shared, shared, &mutants);
    let steps = [1.0; STEPS];
    chapter.number("chain_steps", STEPS as f64, "", 0);
    let sigma = |k: usize| shared(&steps, 0.0, k)[1].sqrt();
    chapter.number("chain_before", before(&steps, STEPS - 1).sqrt(), "", 0);
    chapter.number("chain_middle", sigma(STEPS / 2 - 1), "", 0);
}

/// The steps of the example.
const STEPS: usize = 100;

/// The variances of a chain's steps, that of the closing measurement, and which pose: the part of the gap by which
/// it moves, and its variance then.
type Shared = fn(&[f64], f64, usize) -> [f64; 2];

/// The variance of a pose by the steps until then.
fn before(chain: &[f64], k: usize) -> f64 {
    chain[..=k].iter().sum()
}

fn shared(chain: &[f64], closing: f64, k: usize) -> [f64; 2] {
    let part = before(chain, k) / (before(chain, chain.len() - 1) + closing);
    [part, before(chain, k) * (1.0 - part)]
}

fn measurement(
    pair: [usize; 2],
    along: f64,
    variance: f64,
) -> RelativeMeasurement<Isometry2<f64>, 3> {
    RelativeMeasurement {
        first: pair[0],
        second: pair[1],
        measured: Isometry2::new(Vector2::new(along, 0.0), 0.0),
        information: Matrix3::from_diagonal(&Vector3::new(1.0 / variance, 1.0, 1.0)),
    }
}

fn gap_shared(formula: Shared) -> Comparison {
    let against = "the pose graph of a straight chain, and the inverse of its Hessian";
    Comparison::relative(against, 1e-6).over(STATES, 83, |random| {
        let steps = 6;
        let chain: Vec<f64> = (0..steps).map(|_| random.logarithmic(0.1..10.0)).collect();
        let (closing, gap) = (random.logarithmic(0.1..10.0), random.uniform(0.5..2.0));
        let mut measurements: Vec<_> =
            (0..steps).map(|k| measurement([k, k + 1], 2.0, chain[k])).collect();
        measurements.push(measurement([0, steps], 2.0 * steps as f64 + gap, closing));
        let place = |k: usize| Isometry2::new(Vector2::new(2.0 * k as f64, 0.0), 0.0);
        let graph: PlanarGraph =
            PoseGraph { poses: (0..=steps).map(place).collect(), measurements };
        let GraphProblem { problem, poses } = graph.problem(|_| Kernel::Squared).expect("a graph");
        let values = problem.solve(&Options::default()).expect("determined").values;
        let covariance = problem.covariance(&values).expect("determined");
        let own = |k: usize| {
            let shift = values[poses[k + 1]].translation.x - 2.0 * (k + 1) as f64;
            let matrix: DMatrix<f64> = covariance.of(poses[k + 1]).expect("a variable");
            [shift / gap, matrix[(0, 0)]]
        };
        let found: Vec<f64> = (0..steps).flat_map(|k| formula(&chain, closing, k)).collect();
        (found, (0..steps).flat_map(own).collect::<Vec<f64>>())
    })
}
