//! Linearization points that somebody froze.

use approx::assert_abs_diff_eq;
use nalgebra::{DMatrix, Vector2, Vector3};
use vislam::least_squares::{Kernel, Key, Options, Problem, ProblemError, Stop, Values};

use super::{Draws, POSTS, Tape, distances, scalar, three_tapes};

/// The directions from the posts to a spot, over the standard deviation: the Jacobian by hand.
fn directions(spot: &Vector2<f64>) -> DMatrix<f64> {
    let rows = POSTS.map(|post| (spot - post).normalize().transpose() / 0.05);
    DMatrix::from_fn(3, 2, |row, column| rows[row][column])
}

#[test]
fn residuals_are_taken_at_the_values_and_derivatives_at_the_frozen_point() {
    let (at, frozen_at) = (Vector2::new(3.0, 4.0), Vector2::new(2.0, 5.0));
    let (mut problem, spot) = three_tapes(at, Kernel::Squared);
    problem.freeze(spot, frozen_at).unwrap();
    let (jacobian, residual) = problem.jacobian(problem.values()).unwrap();
    assert_abs_diff_eq!(jacobian, directions(&frozen_at), epsilon = 1e-12);
    let measured = [5.18, 4.94, 4.87];
    for ((post, measured), residual) in POSTS.iter().zip(measured).zip(residual.iter()) {
        assert_abs_diff_eq!(((at - post).norm() - measured) / 0.05, *residual, epsilon = 1e-12);
    }
    let system = problem.linearize(problem.values()).unwrap();
    assert_abs_diff_eq!(system.gradient, jacobian.tr_mul(&residual), epsilon = 1e-9);
    assert_abs_diff_eq!(system.hessian, jacobian.tr_mul(&jacobian), epsilon = 1e-9);
    assert_abs_diff_eq!(system.cost, 0.5 * residual.norm_squared(), epsilon = 1e-12);
}

#[test]
fn what_is_not_frozen_is_linearized_where_it_stands() {
    let mut draws = Draws::new(30);
    let points: Vec<Vector3<f64>> = (0..4).map(|_| draws.vector()).collect();
    let old: Vector3<f64> = draws.vector();
    let (mut problem, keys) = distances(&points);
    problem.freeze(keys[2], old).unwrap();
    let moved: Vec<f64> = (0..12).map(|_| 0.3 * draws.number()).collect();
    let values = problem.values().retract(&moved);
    let (jacobian, residual) = problem.jacobian(&values).unwrap();

    let (usual, _) = distances(&points);
    let mut mixed = values.clone();
    mixed.set(keys[2], old);
    assert_eq!(jacobian, usual.jacobian(&mixed).unwrap().0);
    assert_eq!(residual, usual.jacobian(&values).unwrap().1);
}

/// What the cost is after every step of a search, and why it stopped.
fn costs(problem: &Problem) -> (Vec<f64>, Values, Stop) {
    let solution = problem.solve(&Options::default()).unwrap();
    let costs = solution.report.iterations.iter().map(|iteration| iteration.cost);
    let costs = costs.chain([solution.report.cost]).collect();
    (costs, solution.values, solution.report.stop)
}

/// Three tapes that agree, so that every Jacobian that is not far off leads to the spot.
fn agreeing_tapes(start: Vector2<f64>, truth: Vector2<f64>) -> (Problem, Key<Vector2<f64>>) {
    let mut problem = Problem::new();
    let spot = problem.add_variable(start);
    for post in POSTS {
        let tape = Tape { spot, post, measured: (truth - post).norm(), sigma: 0.05 };
        problem.add_factor(tape, Kernel::Squared).unwrap();
    }
    (problem, spot)
}

#[test]
fn a_jacobian_from_nearby_still_leads_down_to_the_spot() {
    let truth = Vector2::new(3.2, 4.1);
    let (mut problem, spot) = agreeing_tapes(Vector2::new(2.0, 5.5), truth);
    problem.freeze(spot, Vector2::new(2.0, 5.5)).unwrap();
    let (costs, values, stop) = costs(&problem);
    assert!(costs.is_sorted_by(|before, after| after <= before), "{costs:?}");
    assert!(stop.is_convergence(), "{stop}");
    assert_abs_diff_eq!(values[spot], truth, epsilon = 1e-6);
}

#[test]
fn where_measurements_disagree_the_search_descends_until_the_frozen_jacobian_has_no_more_to_give() {
    let (mut problem, spot) = three_tapes(Vector2::new(2.0, 5.5), Kernel::Squared);
    let best = problem.solve(&Options::default()).unwrap().report.cost;
    problem.freeze(spot, Vector2::new(2.0, 5.5)).unwrap();
    let (costs, _, _) = costs(&problem);
    assert!(costs.is_sorted_by(|before, after| after <= before), "{costs:?}");
    let last = costs[costs.len() - 1];
    assert!(last >= best && last < 1e-2 * costs[0], "{best} {costs:?}");
}

#[test]
fn a_frozen_point_on_the_other_side_lets_nothing_descend_and_the_report_says_so() {
    // The slope of x² − 4 at −1 leads away from the root at 2.
    let (mut problem, number) = scalar(3.0, |x| Some((x * x - 4.0, 2.0 * x)));
    problem.freeze(number, nalgebra::Vector1::new(-1.0)).unwrap();
    let (costs, values, stop) = costs(&problem);
    assert_eq!(stop, Stop::NoDescentAtFrozenPoint);
    assert!(!stop.is_convergence());
    assert!(stop.to_string().contains("frozen Jacobian"), "{stop}");
    assert_eq!(values[number].x, 3.0);
    assert!(costs.iter().all(|cost| *cost == costs[0]));
}

#[test]
fn a_frozen_point_of_another_dimension_is_refused() {
    let mut problem = Problem::new();
    let group = problem.add_variable(Lengths(vec![1.0, 2.0]));
    let refused = problem.freeze(group, Lengths(vec![1.0]));
    assert!(matches!(refused, Err(ProblemError::NoSuchVariable { .. })), "{refused:?}");
}

/// As many numbers as there are.
#[derive(Clone)]
struct Lengths(Vec<f64>);

impl vislam::least_squares::Manifold for Lengths {
    fn dimension(&self) -> usize {
        self.0.len()
    }

    fn retract(&self, step: &[f64]) -> Self {
        Self(self.0.iter().zip(step).map(|(length, step)| length + step).collect())
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        for (step, (from, to)) in step.iter_mut().zip(self.0.iter().zip(&to.0)) {
            *step = to - from;
        }
    }

    fn local_jacobian(&self, _to: &Self, into: &mut [f64]) {
        into.copy_from_slice(DMatrix::identity(self.0.len(), self.0.len()).as_slice());
    }
}
