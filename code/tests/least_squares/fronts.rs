//! Elimination in any order.

use nalgebra::{DMatrix, DVector, Isometry3, SMatrix, Vector3};
use vislam::factors::Prior;
use vislam::inertial::{ImuBias, NavState};
use vislam::least_squares::{
    Dense, Fronts, Kernel, Key, LinearSystem, Manifold, Point, Problem, SolveError,
};
use vislam::observability::{BiasAssumption, UnknownCalibration};
use vislam::simulation::{Flight, Trajectory, landmarks_around};

use super::{Between, Draws};

/// The variables of one kind.
fn of_kind<V: Manifold>(problem: &Problem) -> Vec<Key<V>> {
    (0..problem.values().len()).filter_map(|index| problem.values().key(index)).collect()
}

fn hold_near<V: Manifold, const N: usize>(problem: &mut Problem, variable: Key<V>, sigma: f64) {
    let anchor = problem.values()[variable].clone();
    let sqrt_information = SMatrix::<f64, N, N>::identity() / sigma;
    problem.add_factor(Prior { variable, anchor, sqrt_information }, Kernel::Squared).unwrap();
}

/// A flight with biases that walk and a calibration that is unknown, away from the truth, and its
/// states and biases in order.
fn window() -> (Problem, Vec<usize>) {
    window_of(UnknownCalibration { extrinsics: true, time_offset: true })
}

fn window_of(calibration: UnknownCalibration) -> (Problem, Vec<usize>) {
    let flight = Flight { pixel_sigma: 0.5, ..Flight::brief(Trajectory::figure_eight()) };
    let assumption = BiasAssumption { walk: Some(flight.noise), ..BiasAssumption::CONSTANT };
    let landmarks = landmarks_around(&Vector3::zeros(), 60);
    let mut window = flight.window(&landmarks, assumption).unwrap();
    window.calibration = calibration;
    let mut problem = window.problem().unwrap();
    let (states, biases) = (of_kind::<NavState>(&problem), of_kind::<ImuBias>(&problem));
    hold_near::<_, 9>(&mut problem, states[0], 0.01);
    hold_near::<_, 6>(&mut problem, biases[0], 0.01);
    for rig in of_kind::<Isometry3<f64>>(&problem) {
        hold_near::<_, 6>(&mut problem, rig, 0.01);
    }
    let mut draws = Draws::new(7);
    let step: Vec<f64> = (0..problem.values().dimension()).map(|_| 2e-3 * draws.number()).collect();
    problem.set_values(problem.values().retract(&step)).unwrap();
    let pairs = states.iter().zip(&biases);
    let trunk = pairs.flat_map(|(state, bias)| [state.index(), bias.index()]).collect();
    (problem, trunk)
}

/// One step of a system from where the problem stands, by coordinates, and its prediction.
fn step(problem: &Problem, mut system: impl LinearSystem, damping: f64) -> (Vec<f64>, [f64; 3]) {
    let at = Point { values: problem.values(), frozen: None };
    system.linearize(problem, at).unwrap();
    let mut step = vec![0.0; problem.values().dimension()];
    let prediction = system.step(damping, &mut step).unwrap();
    (step, [prediction.step_norm, prediction.predicted_decrease, prediction.gradient_norm])
}

fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut draws = Draws::new(seed);
    let mut keys: Vec<(f64, usize)> = (0..count).map(|index| (draws.number(), index)).collect();
    keys.sort_by(|one, other| one.0.total_cmp(&other.0));
    keys.into_iter().map(|(_, index)| index).collect()
}

#[test]
fn every_order_of_elimination_gives_the_step_of_the_dense_system() {
    let (problem, trunk) = window();
    let orders = [
        Fronts::order_along(&problem, &trunk).unwrap(),
        shuffled(problem.values().len(), 1),
        shuffled(problem.values().len(), 2),
        Vec::new(),
    ];
    for damping in [0.0, 1e-4, 1.0] {
        let (expected, says) = step(&problem, Dense::new(&problem).unwrap(), damping);
        let size = expected.iter().fold(0.0, |most: f64, number| most.max(number.abs()));
        for order in &orders {
            let (found, also) = step(&problem, Fronts::in_order(&problem, order).unwrap(), damping);
            let pairs = expected.iter().zip(&found);
            let off = pairs.fold(0.0, |most: f64, (one, other)| most.max((one - other).abs()));
            assert!(off < 1e-7 * size, "{off:e} of {size:e} with damping {damping}");
            for (one, other) in says.iter().zip(also) {
                assert!((one / other - 1.0).abs() < 1e-8, "{one} and {other}");
            }
        }
    }
}

#[test]
fn a_landmark_at_infinity_takes_nothing_of_what_is_known_of_a_state() {
    let known = UnknownCalibration { extrinsics: false, time_offset: false };
    let unknown = UnknownCalibration { extrinsics: true, time_offset: true };
    for calibration in [known, unknown] {
        let count = of_kind::<Vector3<f64>>(&window_of(calibration).0).len();
        let tried = (0..count).filter(|number| is_harmless(window_of(calibration), *number));
        let tried = tried.count();
        assert!(tried > 8, "{tried}");
    }
}

/// Whether a landmark at infinity is harmless to the newest state; not where no camera could see it there.
fn is_harmless((mut problem, trunk): (Problem, Vec<usize>), number: usize) -> bool {
    let landmark = of_kind::<Vector3<f64>>(&problem)[number];
    let mut values = problem.values().clone();
    let place = 1e9 * values[landmark];
    assert!(values.set(landmark, place));
    problem.set_values(values).unwrap();
    let newest = &trunk[trunk.len() - 2..];
    let known = |problem: &Problem| {
        let order = Fronts::order_along(problem, &trunk).unwrap();
        let mut fronts = Fronts::in_order(problem, &order).unwrap();
        let at = Point { values: problem.values(), frozen: None };
        fronts.linearize(problem, at).ok()??;
        let mut step = vec![0.0; problem.values().dimension()];
        assert!(fronts.step(1e-6, &mut step).is_some());
        Some(fronts.covariance_of(problem, newest).expect("what is known").diagonal())
    };
    let Some(free) = known(&problem) else { return false };
    problem.hold(landmark).unwrap();
    let held = known(&problem).unwrap();
    assert!(free.iter().zip(&held).all(|(free, held)| free >= &(0.999 * held)), "{free} {held}");
    assert!(free.iter().zip(&held).all(|(free, held)| *free < 100.0 * held), "{free} {held}");
    true
}

#[test]
fn a_covariance_is_that_of_the_last_linearization_whatever_step_was_taken_before() {
    let (mut problem, trunk) = window();
    let newest = &trunk[trunk.len() - 2..];
    let order = Fronts::order_along(&problem, &trunk).unwrap();
    let mut fronts = Fronts::in_order(&problem, &order).unwrap();
    assert_eq!(fronts.covariance_of(&problem, newest), None);
    let beyond = problem.values().len();
    let covariance = |problem: &Problem, fronts: &mut Fronts, damping: Option<f64>| {
        let at = Point { values: problem.values(), frozen: None };
        fronts.linearize(problem, at).unwrap();
        let mut step = vec![0.0; problem.values().dimension()];
        if let Some(damping) = damping {
            assert!(fronts.step(damping, &mut step).is_some());
        }
        fronts.covariance_of(problem, newest).unwrap()
    };
    covariance(&problem, &mut fronts, Some(0.0));
    assert_eq!(fronts.covariance_of(&problem, &[newest[0], beyond]), None);
    let step: Vec<f64> =
        (0..problem.values().dimension()).map(|at| 0.02 * (at as f64).sin()).collect();
    problem.set_values(problem.values().retract(&step)).unwrap();
    let expected =
        covariance(&problem, &mut Fronts::in_order(&problem, &order).unwrap(), Some(0.0));
    for damping in [None, Some(1.0)] {
        let found = covariance(&problem, &mut fronts, damping);
        assert!((&found - &expected).amax() <= 1e-9 * expected.amax(), "after {damping:?}");
    }
}

#[test]
fn fronts_give_the_covariance_of_the_dense_system() {
    let (problem, trunk) = window();
    let dense = problem.covariance(problem.values()).unwrap();
    let at = Point { values: problem.values(), frozen: None };
    let condition = {
        let (jacobian, _) = problem.jacobian(problem.values()).unwrap();
        let lengths =
            DVector::from_iterator(jacobian.ncols(), jacobian.column_iter().map(|c| c.norm()));
        let values =
            (jacobian * DMatrix::from_diagonal(&lengths.map(f64::recip))).singular_values();
        (values.max() / values.min()).powi(2)
    };
    for order in
        [Fronts::order_along(&problem, &trunk).unwrap(), shuffled(problem.values().len(), 3)]
    {
        let fronts = Fronts::in_order(&problem, &order).unwrap().covariance(&problem, at).unwrap();
        let mut most: f64 = 0.0;
        let mut compare = |one: DMatrix<f64>, other: DMatrix<f64>| {
            most = most.max((&one - &other).norm() / one.norm());
        };
        for state in of_kind::<NavState>(&problem) {
            compare(dense.of(state).unwrap(), fronts.of(state).unwrap());
        }
        for landmark in of_kind::<Vector3<f64>>(&problem) {
            compare(dense.of(landmark).unwrap(), fronts.of(landmark).unwrap());
        }
        assert!(most < 10.0 * f64::EPSILON * condition, "{most:e} at a condition of {condition:e}");
    }
    let order = Fronts::order_along(&problem, &trunk).unwrap();
    let fronts = Fronts::in_order(&problem, &order).unwrap().covariance(&problem, at).unwrap();
    let states = of_kind::<NavState>(&problem);
    let met = fronts.between(states[3], states[4]).unwrap();
    let expected = dense.between(states[3], states[4]).unwrap();
    assert!((&met - &expected).norm() < 1e-6 * expected.norm());
    assert_eq!(fronts.between(states[0], states[8]), None);
}

#[test]
fn an_order_of_variables_that_do_not_exist_is_refused() {
    let (problem, _) = window();
    let beyond = problem.values().len();
    let refused = SolveError::NoSuchVariable { variable: beyond };
    assert_eq!(Fronts::order_along(&problem, &[0, beyond]).unwrap_err(), refused);
    assert_eq!(Fronts::in_order(&problem, &[beyond]).unwrap_err(), refused);
}

/// A wheel of points on a line: a hub that is measured against each of `count` others.
fn wheel(count: usize) -> Problem {
    let mut problem = Problem::new();
    let hub = problem.add_variable(Isometry3::identity());
    hold_near::<_, 6>(&mut problem, hub, 1.0);
    for _ in 0..count {
        let other = problem.add_variable(Isometry3::identity());
        let between = Between { poses: [hub, other], measured: Isometry3::identity() };
        problem.add_factor(between, Kernel::Squared).unwrap();
    }
    problem
}

#[test]
fn fill_in_is_counted() {
    // The triangle of a block of six has 21 numbers, a block below it 36.
    for count in [1, 2, 5, 10] {
        let problem = wheel(count);
        let others: Vec<usize> = (1..=count).collect();
        let spokes_first = Fronts::in_order(&problem, &others).unwrap();
        assert_eq!(spokes_first.stored(), 21 * (count + 1) + 36 * count);
        assert_eq!(spokes_first.widest(), 12);
        let hub_first = Fronts::in_order(&problem, &[]).unwrap();
        let columns = 6 * (count + 1);
        assert_eq!(hub_first.stored(), columns * (columns + 1) / 2, "everything has filled in");
        assert_eq!(hub_first.widest(), columns);
        let sum = |columns: usize| (0..columns).map(|width| width * (width + 1) / 2).sum::<usize>();
        assert_eq!(hub_first.products(), sum(columns));
        assert_eq!(spokes_first.products(), count * (sum(12) - sum(6)) + sum(6));
        assert_eq!(Fronts::new(&problem).unwrap().stored(), spokes_first.stored());
    }
}

#[test]
fn minimum_degree_is_no_worse_than_a_shuffled_order() {
    let (problem, trunk) = window();
    let products = |order: &[usize]| Fronts::in_order(&problem, order).unwrap().products();
    let by_degree = products(&Fronts::order_by_degree(&problem));
    assert_eq!(by_degree, Fronts::new(&problem).unwrap().products());
    assert!(by_degree <= products(&Fronts::order_along(&problem, &trunk).unwrap()));
    for seed in 0..5 {
        assert!(by_degree < products(&shuffled(problem.values().len(), seed)));
    }
}

#[test]
fn a_long_chain_needs_no_deep_stack() {
    let known = || {
        let mut problem = Problem::new();
        let mut pose = problem.add_variable(Isometry3::identity());
        hold_near::<_, 6>(&mut problem, pose, 1.0);
        for _ in 0..3000 {
            let next = problem.add_variable(Isometry3::identity());
            let between = Between { poses: [pose, next], measured: Isometry3::identity() };
            problem.add_factor(between, Kernel::Squared).unwrap();
            pose = next;
        }
        let order: Vec<usize> = (0..problem.values().len()).collect();
        let mut fronts = Fronts::in_order(&problem, &order).unwrap();
        fronts.linearize(&problem, Point { values: problem.values(), frozen: None }).unwrap();
        fronts.covariance_of(&problem, &[1]).is_some()
    };
    let small = std::thread::Builder::new().stack_size(1 << 18);
    assert!(small.spawn(known).unwrap().join().unwrap());
}

#[test]
fn what_nothing_measures_has_no_covariance_whatever_was_asked_before() {
    let mut problem = Problem::new();
    let unseen = problem.add_variable(Vector3::<f64>::zeros());
    let seen = problem.add_variable(Vector3::<f64>::zeros());
    hold_near::<_, 3>(&mut problem, seen, 1.0);
    let mut fronts = Fronts::in_order(&problem, &[unseen.index(), seen.index()]).unwrap();
    fronts.linearize(&problem, Point { values: problem.values(), frozen: None }).unwrap();
    assert_eq!(fronts.covariance_of(&problem, &[unseen.index()]), None);
    assert!(fronts.covariance_of(&problem, &[seen.index()]).is_some());
    assert_eq!(fronts.covariance_of(&problem, &[unseen.index()]), None);
}
