//! Variables that are taken out, and what is kept of what their factors said.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix6, SVector, Vector3};
use vislam::factors::Prior;
use vislam::least_squares::{
    Kernel, Key, LinearPrior, Options, Problem, ProblemError, SolveError, Values, eliminate,
};
use vislam::manifold::se3;

use super::{Between, Draws};

/// Poses, and which of them were measured against each other: neighbours and a few far apart.
struct Graph {
    poses: Vec<Isometry3<f64>>,
    measured: Vec<(usize, usize, Isometry3<f64>)>,
}

impl Graph {
    fn new(count: usize) -> Self {
        let mut draws = Draws::new(40);
        let truth: Vec<_> = (0..count).map(|_| se3::exp(&(2.0 * draws.vector::<6>()))).collect();
        let neighbours = (1..count).map(|second| (second - 1, second));
        let far = (0..count / 2).map(|first| (first, first + count / 2));
        let measure = |(first, second): (usize, usize)| {
            let between = truth[first].inv_mul(&truth[second]);
            (first, second, se3::retract(&between, &(0.02 * draws.vector::<6>())))
        };
        let measured = neighbours.chain(far).map(measure).collect();
        Self { poses: truth, measured }
    }

    /// The problem of these poses, with the measurements between them, and the keys by pose. The
    /// first pose has a prior as long as it is there.
    fn problem(
        &self,
        start: &[Isometry3<f64>],
        which: impl Fn(usize) -> bool,
    ) -> (Problem, Vec<Option<Key<Isometry3<f64>>>>) {
        let mut problem = Problem::new();
        let add = |(index, pose)| which(index).then(|| problem.add_variable(pose));
        let keys: Vec<_> = start.iter().copied().enumerate().map(add).collect();
        if let Some(variable) = keys[0] {
            let sqrt_information = 10.0 * Matrix6::identity();
            let prior = Prior { variable, anchor: self.poses[0], sqrt_information };
            problem.add_factor(prior, Kernel::Squared).unwrap();
        }
        for (first, second, measured) in &self.measured {
            if let (Some(first), Some(second)) = (keys[*first], keys[*second]) {
                let between = Between { poses: [first, second], measured: *measured };
                problem.add_factor(between, Kernel::Squared).unwrap();
            }
        }
        (problem, keys)
    }
}

/// The estimate of all poses, and the condition number of its Hessian.
fn solved(graph: &Graph) -> (Values, f64) {
    let (problem, _) = graph.problem(&graph.poses, |_| true);
    let values = problem.solve(&Options::default()).unwrap().values;
    let (jacobian, _) = problem.jacobian(&values).unwrap();
    let singular = jacobian.singular_values();
    (values, (singular.max() / singular.min()).powi(2))
}

fn start_of(values: &Values) -> Vec<Isometry3<f64>> {
    values.of_kind().to_vec()
}

#[test]
fn poses_that_are_taken_out_in_any_order_leave_the_marginals_of_the_others() {
    let graph = Graph::new(12);
    let (values, condition) = solved(&graph);
    let (whole, keys) = graph.problem(&start_of(&values), |_| true);
    let expected = whole.covariance(&values).unwrap();
    let out = [vec![0, 1, 2], vec![7, 3, 0, 10], vec![11], vec![4, 5, 6, 7, 8, 9, 10, 11]];
    for out in &out {
        let prior = LinearPrior::marginalize(&whole, &values, out).unwrap();
        let stays = |index: usize| !out.contains(&index);
        let (mut rest, new) = graph.problem(&start_of(&values), stays);
        let number = |old: usize| new[old].expect("it stays").index();
        rest.add_prior(prior.renumbered(number)).unwrap();
        let found = rest.covariance(rest.values()).unwrap();
        for index in (0..12).filter(|index| stays(*index)) {
            let one = expected.of(keys[index].unwrap()).unwrap();
            let other = found.of(new[index].unwrap()).unwrap();
            let off = (&one - other).norm() / one.norm();
            assert!(off < 10.0 * f64::EPSILON * condition, "pose {index}: {off:e}");
        }
        let gradient = rest.linearize(rest.values()).unwrap().gradient_norm();
        assert!(gradient < 1e-6, "the estimate is that of the whole: {gradient:e}");
    }
}

#[test]
fn one_after_the_other_is_as_good_as_all_at_once() {
    let graph = Graph::new(10);
    let (values, _) = solved(&graph);
    let (whole, _) = graph.problem(&start_of(&values), |_| true);
    let at_once = LinearPrior::marginalize(&whole, &values, &[0, 1, 2, 3]).unwrap();

    let mut prior: Option<LinearPrior> = None;
    for gone in 0..4 {
        // The graph without what has gone, and with what was kept of it.
        let (mut problem, keys) = graph.problem(&start_of(&values), |index| index >= gone);
        if let Some(prior) = prior.take() {
            problem.add_prior(prior.renumbered(|old| keys[old].unwrap().index())).unwrap();
        }
        let number = keys[gone].unwrap().index();
        let kept = LinearPrior::marginalize(&problem, problem.values(), &[number]).unwrap();
        prior = Some(kept.renumbered(|new| new + gone));
    }
    let stepwise = prior.unwrap();
    assert_eq!(at_once.variables(), stepwise.variables());
    let information = |prior: &LinearPrior| prior.root().tr_mul(prior.root());
    let gradient = |prior: &LinearPrior| prior.root().tr_mul(prior.offset());
    let (one, other) = (information(&at_once), information(&stepwise));
    assert!((&one - &other).norm() < 1e-9 * one.norm());
    assert!((gradient(&at_once) - gradient(&stepwise)).norm() < 1e-9 * one.norm());
}

/// The prior that two poses leave to their neighbours, and the problem of these.
fn prior_alone(freeze: bool) -> (Problem, DMatrix<f64>, Vec<Key<Isometry3<f64>>>) {
    let graph = Graph::new(6);
    let (values, _) = solved(&graph);
    let (whole, _) = graph.problem(&start_of(&values), |_| true);
    let prior = LinearPrior::marginalize(&whole, &values, &[0, 1]).unwrap();
    let root = prior.root().clone();
    let mut problem = Problem::new();
    let anchors: Vec<Isometry3<f64>> = start_of(&values);
    let old = prior.variables().to_vec();
    let keys: Vec<_> = old.iter().map(|old| problem.add_variable(anchors[*old])).collect();
    problem.add_prior(prior.renumbered(|v| old.iter().position(|o| *o == v).unwrap())).unwrap();
    if freeze {
        for (key, old) in keys.iter().zip(&old) {
            problem.freeze(*key, anchors[*old]).unwrap();
        }
    }
    (problem, root, keys)
}

#[test]
fn its_jacobian_is_its_derivative_and_its_root_where_it_is_frozen() {
    let mut draws = Draws::new(41);
    let (problem, root, keys) = prior_alone(false);
    let (frozen, ..) = prior_alone(true);
    for _ in 0..1000 {
        let step: Vec<f64> = (0..6 * keys.len()).map(|_| 0.8 * draws.number()).collect();
        let values = problem.values().retract(&step);
        let (jacobian, residual) = problem.jacobian(&values).unwrap();
        assert_eq!(residual, problem.residual(&values).unwrap());
        for column in 0..step.len() {
            let moved = |size: f64| {
                let mut one = vec![0.0; step.len()];
                one[column] = size;
                problem.residual(&values.retract(&one)).unwrap()
            };
            let slope: DVector<f64> = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((slope - jacobian.column(column)).norm() < 1e-6);
        }
        let (jacobian, also) = frozen.jacobian(&values).unwrap();
        assert!((jacobian - &root).norm() < 1e-12 * root.norm());
        assert_eq!(residual, also);
    }
}

#[test]
fn a_problem_from_which_poses_are_taken_goes_on_with_the_others() {
    let graph = Graph::new(10);
    let (values, condition) = solved(&graph);
    let (mut problem, keys) = graph.problem(&start_of(&values), |_| true);
    let keys: Vec<_> = keys.into_iter().map(Option::unwrap).collect();
    let expected = problem.covariance(&values).unwrap();
    let numbers = problem.len();
    for out in [0, 4, 1] {
        let named = problem.marginalize(&values, &[keys[out].index()]).unwrap();
        assert!(!named.is_empty() && !named.contains(&keys[out].index()));
        let found = problem.covariance(problem.values()).unwrap();
        for index in (0..10).filter(|index| ![0, out, 1, 4].contains(index)) {
            let (one, other) = (expected.of(keys[index]), found.of(keys[index]));
            let (one, other) = (one.unwrap(), other.unwrap());
            let off = (&one - other).norm() / one.norm();
            assert!(off < 10.0 * f64::EPSILON * condition, "pose {index}: {off:e}");
        }
    }
    assert!(problem.len() < numbers, "factors have gone");
    let solution = problem.solve(&Options::default()).unwrap();
    let moved = values.local(&solution.values);
    assert!(moved.iter().all(|step| step.abs() < 1e-6), "the estimate is that of the whole");
    assert_eq!(solution.values[keys[4]], values[keys[4]]);
}

#[test]
fn what_is_held_takes_no_factor_with_it_and_what_is_tied_goes_along() {
    let graph = Graph::new(6);
    let (values, _) = solved(&graph);
    let (mut held, keys) = graph.problem(&start_of(&values), |_| true);
    held.hold(keys[2].unwrap()).unwrap();
    let before = (held.len(), held.covariance(&values).unwrap());
    assert_eq!(held.marginalize(&values, &[2]).unwrap(), Vec::<usize>::new());
    assert_eq!(held.len(), before.0);
    assert_eq!(held.covariance(&values).unwrap().matrix(), before.1.matrix());

    let (mut tied, keys) = graph.problem(&start_of(&values), |_| true);
    tied.tie(keys[5].unwrap(), keys[2].unwrap()).unwrap();
    let expected = tied.covariance(&values).unwrap().of(keys[4].unwrap()).unwrap();
    tied.marginalize(&values, &[5]).unwrap();
    assert_eq!(tied.columns().select(6 * 2..6 * 3), Vec::<usize>::new());
    let found = tied.covariance(&values).unwrap().of(keys[4].unwrap()).unwrap();
    assert!((&found - &expected).norm() < 1e-9 * expected.norm());
    let unknown = tied.marginalize(&values, &[17]).unwrap_err();
    assert_eq!(unknown, SolveError::NoSuchVariable { variable: 17 });
}

#[test]
fn what_does_not_fit_is_refused_by_number() {
    let graph = Graph::new(4);
    let (values, _) = solved(&graph);
    let (whole, _) = graph.problem(&start_of(&values), |_| true);
    let beyond = LinearPrior::marginalize(&whole, &values, &[9]).unwrap_err();
    assert_eq!(beyond, SolveError::NoSuchVariable { variable: 9 });
    let prior = || LinearPrior::marginalize(&whole, &values, &[0]).unwrap();
    let mut other = Problem::new();
    for _ in 0..4 {
        other.add_variable(Vector3::<f64>::zeros());
    }
    let refused = other.add_prior(prior()).unwrap_err();
    assert_eq!(refused, ProblemError::NoSuchVariable { variable: 1, variables: 4 });
    let twice = LinearPrior::marginalize(&whole, &values, &[0]).unwrap().renumbered(|_| 1);
    let refused = graph.problem(&start_of(&values), |_| true).0.add_prior(twice).unwrap_err();
    assert!(matches!(refused, ProblemError::RepeatedVariable { variable: 1, .. }), "{refused}");
    let all = LinearPrior::marginalize(&whole, &values, &[0, 1, 2, 3]).unwrap();
    assert!(all.variables().is_empty());
    assert!(matches!(other.add_prior(all), Err(ProblemError::EmptyFactor { .. })));
}

#[test]
fn elimination_leaves_what_the_rows_say_of_the_rest_and_nothing_of_what_is_gone() {
    let mut draws = Draws::new(42);
    let narrow = [(2, 3), (9, 3), (30, 5), (8, 0), (5, 7), (4, 8)].map(|shape| (shape, 8));
    let wide = [((40, 9), 21), ((21, 17), 30), ((3, 16), 24), ((50, 8), 17)];
    for ((rows, gone), width) in narrow.into_iter().chain(wide) {
        let matrix = DMatrix::from_fn(rows, width, |_, _| draws.number());
        let (own, rest) = eliminate(matrix.clone(), gone);
        assert_eq!(own.ncols(), width);
        assert_eq!(rest.ncols(), width - gone);
        let mut all = DMatrix::zeros(own.nrows() + rest.nrows(), width);
        all.rows_mut(0, own.nrows()).copy_from(&own);
        all.view_mut((own.nrows(), gone), rest.shape()).copy_from(&rest);
        assert!((all.tr_mul(&all) - matrix.tr_mul(&matrix)).norm() < 1e-12);
        let is_triangle = |part: &DMatrix<f64>| {
            (0..part.ncols())
                .all(|column| part.column(column).iter().skip(column + 1).all(|x| *x == 0.0))
        };
        assert!(is_triangle(&own) && is_triangle(&rest), "{rows} × {width}");
    }
}

#[test]
fn elimination_keeps_what_the_rows_say_of_the_rest_where_columns_are_not_independent() {
    let mut draws = Draws::new(43);
    for (rows, gone, rank) in [(12, 3, 2), (12, 4, 1), (9, 3, 0), (6, 5, 3), (40, 19, 11)] {
        let seen = DMatrix::from_fn(rows, rank, |_, _| draws.number());
        let mixing = DMatrix::from_fn(rank, gone, |_, _| draws.number());
        let mut matrix = DMatrix::from_fn(rows, gone + 4, |_, _| draws.number());
        matrix.columns_mut(0, gone).copy_from(&(&seen * mixing));
        let (own, rest) = eliminate(matrix.clone(), gone);
        assert_eq!(own.nrows(), rank);
        // What is left of the others when what the columns that go can explain is taken out.
        let (axes, others) = (seen.qr().q(), matrix.columns(gone, 4));
        let left = others - &axes * axes.tr_mul(&others);
        assert!((rest.tr_mul(&rest) - left.tr_mul(&left)).norm() < 1e-12, "rank {rank}");
    }
}

#[test]
fn elimination_in_single_precision_is_that_in_double_to_its_digits() {
    let mut draws = Draws::new(44);
    let matrix = DMatrix::from_fn(20, 9, |_, _| draws.number());
    let (_, double) = eliminate(matrix.clone(), 4);
    let (_, single) = eliminate(matrix.map(|number| number as f32), 4);
    let off = (single.map(f64::from).abs() - double.abs()).norm() / double.norm();
    assert!(off < 1e-5, "{off:e}");
    assert!(off > 1e-9, "it was computed in single precision: {off:e}");
}

#[test]
fn elimination_of_more_columns_than_there_are_takes_all_of_them() {
    let (own, rest) = eliminate(DMatrix::from_fn(3, 2, |row, column| (row * column) as f64), 5);
    assert_eq!((own.shape(), rest.shape()), ((1, 2), (0, 0)));
    let (own, rest) = eliminate(DMatrix::<f64>::identity(3, 2), 5);
    assert_eq!((own.shape(), rest.shape()), ((2, 2), (0, 0)));
    let (own, rest) = eliminate(DMatrix::<f64>::zeros(0, 4), 1);
    assert_eq!((own.shape(), rest.shape()), ((0, 4), (0, 3)));
}

#[test]
fn a_variable_that_no_factor_names_leaves_nothing() {
    let mut problem = Problem::new();
    let [lonely, known] = [1.0, 2.0].map(|x| problem.add_variable(Vector3::repeat(x)));
    let sqrt_information = nalgebra::Matrix3::identity();
    let prior = Prior { variable: known, anchor: Vector3::zeros(), sqrt_information };
    problem.add_factor(prior, Kernel::Squared).unwrap();
    let kept = LinearPrior::marginalize(&problem, problem.values(), &[lonely.index()]).unwrap();
    assert!(kept.variables().is_empty());
}

/// Poses that are measured against each other alone, without the first: free as a whole.
fn free_graph() -> (Problem, Vec<Key<Isometry3<f64>>>) {
    let graph = Graph::new(10);
    let (problem, keys) = graph.problem(&graph.poses, |index| index > 0);
    (problem, keys.into_iter().flatten().collect())
}

/// Takes two poses out, one after the other, with estimates that move in between, and says what is
/// free in the end.
fn free_after_two_slides(freeze: impl Fn(&mut Problem, &[usize])) -> Option<usize> {
    let (mut problem, keys) = free_graph();
    let mut draws = Draws::new(45);
    let mut moved = |problem: &Problem| {
        let count = problem.values().dimension();
        let step: Vec<f64> = (0..count).map(|_| 0.05 * draws.number()).collect();
        problem.values().retract(&step)
    };
    for key in [keys[0], keys[1]] {
        let values = moved(&problem);
        let named = problem.marginalize(&values, &[key.index()]).unwrap();
        freeze(&mut problem, &named);
    }
    let values = moved(&problem);
    problem.null_space(&values).ok().map(|free| free.nullity())
}

#[test]
fn what_is_free_stays_free_over_two_slides_when_what_was_frozen_first_stays_frozen() {
    let first_estimates = free_after_two_slides(|problem, _| {
        problem.freeze_priors();
    });
    assert_eq!(first_estimates, Some(6));
    assert_ne!(free_after_two_slides(|_, _| ()), Some(6), "derivatives follow the estimate");
    let anew = free_after_two_slides(|problem, named| problem.freeze_here(named).unwrap());
    assert_ne!(anew, Some(6), "the second slide freezes anew what the first one froze");
}

#[test]
fn a_factor_that_comes_later_takes_its_derivatives_where_the_prior_did() {
    let (mut problem, keys) = free_graph();
    let values = problem.values().clone();
    let named = problem.marginalize(&values, &[keys[0].index()]).unwrap();
    assert_eq!(problem.freeze_priors(), named);
    assert_eq!(problem.freeze_priors(), Vec::<usize>::new(), "each is frozen once");
    let known = problem.values().key::<Isometry3<f64>>(named[0]).unwrap();
    let other = keys.iter().rev().find(|key| !named.contains(&key.index())).copied().unwrap();
    let rows = problem.rows();
    let measured = se3::exp(&nalgebra::Vector6::repeat(0.1));
    let later = Between { poses: [known, other], measured };
    problem.add_factor(later, Kernel::Squared).unwrap();

    let step = vec![0.1; problem.values().dimension()];
    let moved = problem.values().retract(&step);
    let mut mixed = moved.clone();
    for number in &named {
        let key = problem.values().key::<Isometry3<f64>>(*number).unwrap();
        mixed.set(key, values[key]);
    }
    let mut alone = Problem::new();
    let poses = [known, other].map(|key| alone.add_variable(mixed[key]));
    alone.add_factor(Between { poses, measured }, Kernel::Squared).unwrap();
    let (expected, _) = alone.jacobian(alone.values()).unwrap();
    let (jacobian, _) = problem.jacobian(&moved).unwrap();
    let columns = problem.columns();
    let found = |key: Key<Isometry3<f64>>| {
        let own = columns.select(moved.coordinates_of(key.index()).unwrap());
        let with = jacobian.select_columns(&own);
        (0..=with.nrows() - 6)
            .map(|row| with.rows(row, 6).into_owned())
            .find(|block| (block - expected.columns(0, 6)).norm() < 1e-12)
    };
    assert_eq!(problem.rows(), rows + 6);
    assert!(found(known).is_some(), "its derivative stands where the prior was taken");
}

#[test]
fn a_prior_may_name_a_variable_without_coordinates() {
    let mut problem = Problem::new();
    let nothing = problem.add_variable(SVector::<f64, 0>::zeros());
    let number = problem.add_variable(SVector::<f64, 1>::zeros());
    let names = [nothing.index(), number.index()];
    let (root, offset) = (DMatrix::from_element(1, 1, 2.0), DVector::from_element(1, -6.0));
    let prior = LinearPrior::of_root(problem.values(), &names, root, offset).unwrap();
    problem.add_prior(prior).unwrap();
    let solution = problem.solve(&Options::default()).unwrap();
    assert!((solution.values[number].x.abs() - 3.0).abs() < 1e-9);
}

#[test]
fn a_prior_of_a_root_is_refused_when_it_does_not_fit() {
    let mut problem = Problem::new();
    let keys = [1.0, 2.0].map(|x| problem.add_variable(Vector3::repeat(x)).index());
    let of_root = |named: &[usize], rows, columns, numbers| {
        let root = DMatrix::from_element(rows, columns, 1.0);
        LinearPrior::of_root(problem.values(), named, root, DVector::zeros(numbers)).err()
    };
    assert_eq!(of_root(&keys, 2, 6, 2), None);
    let root =
        |rows, columns, numbers| Some(ProblemError::Root { rows, columns, numbers, dimension: 6 });
    assert_eq!(of_root(&keys, 2, 5, 2), root(2, 5, 2));
    assert_eq!(of_root(&keys, 2, 6, 3), root(2, 6, 3));
    assert_eq!(of_root(&keys, 0, 6, 0), Some(ProblemError::EmptyFactor { factor: 0 }));
    let twice = ProblemError::RepeatedVariable { factor: 0, variable: 1 };
    assert_eq!(of_root(&[1, 1], 2, 6, 2), Some(twice));
    let unknown = ProblemError::NoSuchVariable { variable: 7, variables: 2 };
    assert_eq!(of_root(&[0, 7], 2, 6, 2), Some(unknown));
    let root = DMatrix::from_element(1, 6, f64::NAN);
    let refused = LinearPrior::of_root(problem.values(), &keys, root, DVector::zeros(1)).err();
    assert!(matches!(refused, Some(ProblemError::Root { .. })));
}
