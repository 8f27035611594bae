//! The graph of `examples/two_keyframes.rs`: what is free in it, and how near its estimates come to the bound.

#[allow(dead_code)]
#[path = "../examples/two_keyframes.rs"]
mod two_keyframes;

use two_keyframes::{ASKED, BIAS, Graph, HUBER, STATE, Scene, squared};
use vislam::least_squares::{Kernel, SolveError};

const UNKNOWN: [f64; 9] = [f64::INFINITY; 9];
const UNKNOWN_BIAS: [f64; 6] = [f64::INFINITY; 6];

#[test]
fn forty_eight_unknowns_and_thirty_nine_equations_leave_ten_directions_free() {
    let graph = Graph::measured(&Scene::exact(), Kernel::Squared).unwrap();
    assert_eq!((graph.problem.columns().count, graph.problem.rows()), (48, 39));
    assert_eq!(Graph::free(UNKNOWN, UNKNOWN_BIAS).unwrap(), 10);
}

#[test]
fn only_the_prior_of_the_gyroscope_is_not_needed() {
    assert_eq!(Graph::free(STATE, BIAS).unwrap(), 0);
    let mut bias = BIAS;
    bias[..3].fill(f64::INFINITY);
    assert_eq!(Graph::free(STATE, bias).unwrap(), 0);
    for at in [0, 3, 6] {
        let mut state = STATE;
        state[at..at + 3].fill(f64::INFINITY);
        assert!(Graph::free(state, BIAS).unwrap() > 0, "without what stands at {at}");
    }
}

#[test]
fn the_covariance_without_priors_says_how_much_is_free() {
    let scene = Scene::exact();
    let graph = Graph::measured(&scene, Kernel::Squared).unwrap();
    let refused = graph.problem.covariance(&graph.values(&scene.truth)).err();
    assert!(matches!(refused, Some(SolveError::Singular(system)) if system.free == 10));
}

#[test]
fn exact_measurements_lead_to_the_truth() {
    let scene = Scene::exact();
    let off =
        scene.truth.step_to(&Graph::new(&scene, Kernel::Huber(HUBER)).unwrap().solved().unwrap());
    assert!(off.iter().all(|off| off.abs() < 1e-7), "{off:?}");
}

#[test]
fn least_squares_reaches_the_bound() {
    const SEEDS: u64 = 200;
    let (mut squares, mut bounds) = ([0.0; ASKED.len()], [0.0; ASKED.len()]);
    for scene in (0..SEEDS).map(Scene::drawn) {
        let off =
            scene.truth.step_to(&Graph::new(&scene, Kernel::Squared).unwrap().solved().unwrap());
        let bound = Graph::bound(&scene).unwrap();
        for (number, (_, at, _)) in ASKED.into_iter().enumerate() {
            squares[number] += squared(&off, at);
            bounds[number] += bound[at..at + 3].iter().sum::<f64>();
        }
    }
    for ((name, ..), (square, bound)) in ASKED.into_iter().zip(squares.into_iter().zip(bounds)) {
        let ratio = (square / bound).sqrt();
        assert!((0.9..1.1).contains(&ratio), "{name}: {ratio} times the bound");
    }
}
