//! Least squares on problems whose answer is known.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix2, Matrix3, Matrix6, Rotation3, RowVector2, SMatrix,
    SVector, Vector1, Vector2, Vector3, Vector6,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::least_squares::{
    Evaluation, Kernel, Manifold, Method, Options, PoseOrPoint, Problem, ProblemError, Residual,
    SolveError, Stop, Undefined, WhiteningError, sqrt_information,
};
use vislam::manifold::{se3, so3};

/// The distance from a known post to an unknown spot, measured with standard deviation `sigma`, all in metres.
struct Tape {
    spot: [usize; 1],
    post: Vector2<f64>,
    measured: f64,
    sigma: f64,
}

// ANCHOR: tape
impl Residual<Vector2<f64>> for Tape {
    fn variables(&self) -> &[usize] {
        &self.spot
    }

    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&self, values: &[Vector2<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        let from_post = values[self.spot[0]] - self.post;
        let distance = from_post.norm();
        if distance == 0.0 {
            return Err(Undefined); // no direction, hence no derivative
        }
        into.residual(&Vector1::new((distance - self.measured) / self.sigma));
        into.jacobian(0, &(from_post.transpose() / (distance * self.sigma)));
        Ok(())
    }
}
// ANCHOR_END: tape

const POSTS: [Vector2<f64>; 3] =
    [Vector2::new(0.0, 0.0), Vector2::new(6.0, 0.0), Vector2::new(3.0, 9.0)];
const MEASURED: [f64; 3] = [5.18, 4.94, 4.87];

// ANCHOR: three_tapes
/// A spot to be found with three tapes, each good to five centimetres.
fn three_tapes(start: Vector2<f64>, kernel: Kernel) -> Problem<Vector2<f64>> {
    let mut problem = Problem::new();
    let spot = [problem.add_variable(start)];
    for (post, measured) in POSTS.into_iter().zip(MEASURED) {
        let tape = Tape { spot, post, measured, sigma: 0.05 };
        problem.add_residual(tape, kernel).expect("the spot is a variable");
    }
    problem
}
// ANCHOR_END: three_tapes

// ANCHOR: worked_example
#[test]
fn three_tapes_place_the_point_as_computed_by_hand() {
    let problem = three_tapes(Vector2::new(3.0, 4.0), Kernel::Squared);
    let system = problem.linearize(problem.values()).unwrap();
    // One over the variance is 400; by hand, the entries are sums of 0.6², 0.8² and 1.
    assert_abs_diff_eq!(system.hessian[(0, 0)], 400.0 * 0.72, epsilon = 1e-9);
    assert_abs_diff_eq!(system.hessian[(1, 1)], 400.0 * 2.28, epsilon = 1e-9);
    assert_abs_diff_eq!(system.hessian[(0, 1)], 0.0, epsilon = 1e-9);
    assert_abs_diff_eq!(system.gradient[0], 400.0 * -0.144, epsilon = 1e-9);
    assert_abs_diff_eq!(system.gradient[1], 400.0 * -0.226, epsilon = 1e-9);
    let step = system.step(0.0).unwrap().step;
    assert_abs_diff_eq!(step[0], 0.2, epsilon = 1e-12);
    assert_abs_diff_eq!(step[1], 0.226 / 2.28, epsilon = 1e-12);

    let solution = problem.solve(&Options::gauss_newton()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    assert_abs_diff_eq!(solution.values[0], Vector2::new(3.1996, 4.0987), epsilon = 1e-4);
    let covariance = problem.covariance(&solution.values).unwrap();
    assert!((covariance.of(0).unwrap()[(0, 0)].sqrt() - 0.06).abs() < 0.005);
}
// ANCHOR_END: worked_example

/// The difference of a vector variable to a measured one, or of two of them, with a weight.
struct Linear {
    variables: Vec<usize>,
    blocks: Vec<Matrix3<f64>>,
    measured: Vector3<f64>,
}

impl Residual<Vector3<f64>> for Linear {
    fn variables(&self) -> &[usize] {
        &self.variables
    }

    fn dimension(&self) -> usize {
        3
    }

    fn evaluate(&self, values: &[Vector3<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        let mut residual = -self.measured;
        for (slot, (variable, block)) in self.variables.iter().zip(&self.blocks).enumerate() {
            residual += block * values[*variable];
            into.jacobian(slot, block);
        }
        into.residual(&residual);
        Ok(())
    }
}

/// A pose measured against another one, whitened by unit covariance: log(Z⁻¹ Tᵢ⁻¹ Tⱼ).
struct Between {
    variables: [usize; 2],
    measured: Isometry3<f64>,
}

impl Residual<Isometry3<f64>> for Between {
    fn variables(&self) -> &[usize] {
        &self.variables
    }

    fn dimension(&self) -> usize {
        6
    }

    fn evaluate(&self, values: &[Isometry3<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        let [first, second] = self.variables.map(|variable| values[variable]);
        let relative = first.inv_mul(&second);
        let residual = se3::local(&self.measured, &relative);
        let by_second = se3::right_jacobian_inverse(&residual);
        into.residual(&residual);
        into.jacobian(0, &(-by_second * se3::adjoint(&relative.inverse())));
        into.jacobian(1, &by_second);
        Ok(())
    }
}

/// A direction known in the world and measured in the body: R z − d.
struct Direction {
    rotation: [usize; 1],
    in_world: Vector3<f64>,
    in_body: Vector3<f64>,
    whitener: Matrix3<f64>,
}

impl Residual<Rotation3<f64>> for Direction {
    fn variables(&self) -> &[usize] {
        &self.rotation
    }

    fn dimension(&self) -> usize {
        3
    }

    fn evaluate(&self, values: &[Rotation3<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        let rotation = values[self.rotation[0]];
        into.residual(&(self.whitener * (rotation * self.in_body - self.in_world)));
        into.jacobian(0, &(-self.whitener * rotation.matrix() * so3::hat(&self.in_body)));
        Ok(())
    }
}

/// A residual given by a function of one number, for what no measurement would do.
struct Scalar<F> {
    variables: [usize; 1],
    function: F,
}

impl<F: Fn(f64) -> Option<(f64, f64)>> Residual<Vector1<f64>> for Scalar<F> {
    fn variables(&self) -> &[usize] {
        &self.variables
    }

    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&self, values: &[Vector1<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        let (value, slope) = (self.function)(values[self.variables[0]].x).ok_or(Undefined)?;
        into.residual(&Vector1::new(value));
        into.jacobian(0, &Vector1::new(slope));
        Ok(())
    }
}

/// A problem in one number.
fn scalar(
    start: f64,
    function: impl Fn(f64) -> Option<(f64, f64)> + 'static,
) -> Problem<Vector1<f64>> {
    let mut problem = Problem::new();
    let variables = [problem.add_variable(Vector1::new(start))];
    problem.add_residual(Scalar { variables, function }, Kernel::Squared).unwrap();
    problem
}

/// Random numbers between minus one and one.
struct Draws(ChaCha8Rng);

impl Draws {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn number(&mut self) -> f64 {
        self.0.random_range(-1.0..1.0)
    }

    fn vector<const N: usize>(&mut self) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.number())
    }

    /// Approximately normal: the sum of twelve uniform numbers has unit variance at this scale.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| 0.5 * self.number()).sum()
    }
}

fn linear_problem() -> Problem<Vector3<f64>> {
    let mut draws = Draws::new(1);
    let mut problem = Problem::new();
    let variables: Vec<usize> = (0..3).map(|_| problem.add_variable(draws.vector())).collect();
    for _ in 0..6 {
        let blocks = (0..3).map(|_| Matrix3::from_fn(|_, _| draws.number())).collect();
        let linear = Linear { variables: variables.clone(), blocks, measured: draws.vector() };
        problem.add_residual(linear, Kernel::Squared).unwrap();
    }
    problem
}

#[test]
fn gauss_newton_solves_a_linear_problem_in_one_step() {
    let solution = linear_problem().solve(&Options::gauss_newton()).unwrap();
    assert_eq!(solution.report.iterations.len(), 1);
    assert_eq!(solution.report.stop, Stop::GradientSmall);
    assert_relative_eq!(solution.report.iterations[0].gain_ratio.unwrap(), 1.0, epsilon = 1e-12);
}

#[test]
fn what_is_left_of_a_linear_problem_is_orthogonal_to_the_columns_of_its_jacobian() {
    let problem = linear_problem();
    let solution = problem.solve(&Options::gauss_newton()).unwrap();
    let left = problem.linearize(&solution.values).unwrap();
    assert!(left.gradient.amax() < 1e-13);
    assert!(left.cost > 0.1);
}

#[test]
fn the_kept_values_of_the_problem_do_not_move() {
    let problem = three_tapes(Vector2::new(3.0, 4.0), Kernel::Squared);
    problem.solve(&Options::default()).unwrap();
    assert_eq!(problem.values(), [Vector2::new(3.0, 4.0)]);
}

#[test]
fn a_rotation_is_found_from_directions_and_whatever_the_start() {
    let mut draws = Draws::new(2);
    for _ in 0..20 {
        let truth = Rotation3::new(3.0 * draws.vector::<3>());
        let mut problem = Problem::new();
        let rotation = [problem.add_variable(Rotation3::new(2.0 * draws.vector::<3>()))];
        for _ in 0..4 {
            let in_body = draws.vector::<3>();
            let whitener = sqrt_information(&(0.04 * Matrix3::identity())).unwrap();
            let direction = Direction { rotation, in_world: truth * in_body, in_body, whitener };
            problem.add_residual(direction, Kernel::Squared).unwrap();
        }
        let solution = problem.solve(&Options::default()).unwrap();
        assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
        assert!(so3::local(&truth, &solution.values[0]).norm() < 1e-7);
    }
}

/// Poses on a circle, each measured against the next, the last against the first.
fn loop_of_poses(count: usize, noise: f64) -> (Problem<Isometry3<f64>>, Vec<Isometry3<f64>>) {
    let mut draws = Draws::new(3);
    let truth: Vec<_> = (0..count).map(|_| se3::exp(&(2.0 * draws.vector::<6>()))).collect();
    let mut problem = Problem::new();
    for pose in &truth {
        problem.add_variable(pose.retract((0.3 * draws.vector::<6>()).as_slice()));
    }
    for first in 0..count {
        let second = (first + 1) % count;
        let relative = truth[first].inv_mul(&truth[second]);
        let measured = se3::retract(&relative, &(noise * draws.vector::<6>()));
        let between = Between { variables: [first, second], measured };
        problem.add_residual(between, Kernel::Squared).unwrap();
    }
    (problem, truth)
}

#[test]
fn poses_are_found_from_relative_measurements_once_one_of_them_is_fixed() {
    let (mut problem, truth) = loop_of_poses(5, 0.0);
    problem.set_values([&[truth[0]], &problem.values()[1..]].concat()).unwrap();
    problem.fix(0).unwrap();
    for options in [Options::gauss_newton(), Options::default()] {
        let solution = problem.solve(&options).unwrap();
        assert_eq!(solution.report.free_directions, 0);
        for (found, true_pose) in solution.values.iter().zip(&truth) {
            assert!(se3::local(found, true_pose).norm() < 1e-7);
        }
    }
}

#[test]
fn poses_with_no_anchor_are_free_in_six_directions_and_the_error_says_so() {
    let (problem, _) = loop_of_poses(5, 0.1);
    let error = problem.solve(&Options::gauss_newton()).unwrap_err();
    let sentence = error.to_string();
    let said = "the system leaves 6 of 30 directions free; fix variables or add measurements";
    assert_eq!(sentence, said);
    let SolveError::Singular(singular) = error else { panic!("{sentence}") };
    let system = problem.linearize(problem.values()).unwrap();
    assert_eq!(singular.basis.shape(), (30, 6));
    assert!((&system.hessian * &singular.basis).amax() < 1e-9 * system.hessian.amax());
    let gram = singular.basis.transpose() * &singular.basis;
    assert_abs_diff_eq!(gram, DMatrix::identity(6, 6), epsilon = 1e-12);
}

#[test]
fn damping_solves_a_singular_system_and_the_report_tells() {
    let (problem, _) = loop_of_poses(5, 0.1);
    let solution = problem.solve(&Options::default()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    assert_eq!(solution.report.free_directions, 6);
    let covariance = problem.covariance(&solution.values);
    assert!(matches!(covariance, Err(SolveError::Singular(_))));
}

#[test]
fn the_variance_of_a_distance_is_the_same_whatever_is_held_fixed() {
    let mut draws = Draws::new(10);
    let points: Vec<Vector3<f64>> = (0..6).map(|_| draws.vector::<3>()).collect();
    let between = points[5] - points[3];
    let mut gradient = DVector::zeros(18);
    gradient.fixed_rows_mut::<3>(9).copy_from(&-between.normalize());
    gradient.fixed_rows_mut::<3>(15).copy_from(&between.normalize());
    // Three coordinates of one point, two of a second and one of a third are just enough.
    let variance = |held: [usize; 6]| {
        let hessian = distances(&points).linearize(&points).unwrap().hessian;
        let free: Vec<usize> = (0..18).filter(|row| !held.contains(row)).collect();
        let covariance = hessian.select_rows(&free).select_columns(&free).try_inverse().unwrap();
        let gradient = gradient.select_rows(&free);
        gradient.dot(&(covariance * &gradient))
    };
    let first = variance([0, 1, 2, 3, 4, 6]);
    assert_relative_eq!(first, variance([9, 10, 11, 13, 14, 16]), max_relative = 1e-8);
    assert!(first > 0.1);
}

#[test]
fn levenberg_marquardt_takes_the_same_path_in_every_unit() {
    let in_unit = |unit: f64| {
        let mut problem = Problem::new();
        let spot = [problem.add_variable(unit * Vector2::new(20.0, -3.0))];
        for (post, measured) in POSTS.into_iter().zip(MEASURED) {
            let tape =
                Tape { spot, post: unit * post, measured: unit * measured, sigma: unit * 0.05 };
            problem.add_residual(tape, Kernel::Squared).unwrap();
        }
        problem.solve(&Options::default()).unwrap()
    };
    let (metres, millimetres) = (in_unit(1.0), in_unit(1000.0));
    assert_relative_eq!(1000.0 * metres.values[0], millimetres.values[0], max_relative = 1e-8);
    let pairs = metres.report.iterations.iter().zip(&millimetres.report.iterations);
    for (metre, millimetre) in pairs.take(5) {
        assert_relative_eq!(metre.cost, millimetre.cost, max_relative = 1e-8);
        assert_relative_eq!(metre.step_norm, millimetre.step_norm, max_relative = 1e-8);
    }
}

#[test]
fn negating_every_jacobian_makes_an_undamped_step_raise_the_cost() {
    let problem = scalar(2.0, |x| Some((x - 1.0, 1.0)));
    let backwards = scalar(2.0, |x| Some((x - 1.0, -1.0)));
    let once = Options { max_iterations: 1, ..Options::gauss_newton() };
    assert_eq!(problem.solve(&once).unwrap().report.cost, 0.0);
    assert_eq!(backwards.solve(&once).unwrap().report.cost, 2.0);
}

/// Distance between two points that are both unknown.
struct Distance {
    points: [usize; 2],
    measured: f64,
}

impl Residual<Vector3<f64>> for Distance {
    fn variables(&self) -> &[usize] {
        &self.points
    }

    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&self, values: &[Vector3<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        let between = values[self.points[1]] - values[self.points[0]];
        let distance = between.norm();
        let direction = between.transpose() / distance;
        into.residual(&Vector1::new(distance - self.measured));
        into.jacobian(0, &-direction);
        into.jacobian(1, &direction);
        if distance > 0.0 { Ok(()) } else { Err(Undefined) }
    }
}

/// All distances between points in space.
fn distances(points: &[Vector3<f64>]) -> Problem<Vector3<f64>> {
    let mut problem = Problem::new();
    for point in points {
        problem.add_variable(*point);
    }
    for second in 0..points.len() {
        for first in 0..second {
            let measured = (points[second] - points[first]).norm();
            let distance = Distance { points: [first, second], measured };
            problem.add_residual(distance, Kernel::Squared).unwrap();
        }
    }
    problem
}

#[test]
fn the_free_directions_are_counted_right_whatever_the_units() {
    let mut draws = Draws::new(4);
    for unit in [1e-3, 1.0, 1e3] {
        let points: Vec<Vector3<f64>> = (0..6).map(|_| unit * draws.vector::<3>()).collect();
        let free = |fixed: &[usize]| {
            let mut problem = distances(&points);
            fixed.iter().for_each(|point| problem.fix(*point).unwrap());
            problem.linearize(&points).unwrap().free_directions()
        };
        assert_eq!(free(&[]), 6, "a rigid body in space");
        assert_eq!(free(&[0]), 3, "it may turn about a point");
        assert_eq!(free(&[0, 1]), 1, "it may turn about a line");
        assert_eq!(free(&[0, 1, 2]), 0);
    }
}

#[test]
fn a_variable_that_nothing_measures_is_free_in_all_its_directions() {
    let mut problem = three_tapes(Vector2::new(3.0, 4.0), Kernel::Squared);
    problem.add_variable(Vector2::zeros());
    let error = problem.solve(&Options::gauss_newton()).unwrap_err();
    assert!(error.to_string().contains("2 of 4 directions"), "{error}");
    let solution = problem.solve(&Options::default()).unwrap();
    assert_eq!(solution.values[1], Vector2::zeros());
    assert_eq!(solution.report.free_directions, 2);
}

#[test]
fn a_prior_makes_a_free_system_regular() {
    let (mut problem, truth) = loop_of_poses(4, 0.1);
    let prior = PosePrior { variables: [0], mean: truth[0] };
    problem.add_residual(prior, Kernel::Squared).unwrap();
    let solution = problem.solve(&Options::gauss_newton()).unwrap();
    assert_eq!(solution.report.free_directions, 0);
    assert!(se3::local(&truth[0], &solution.values[0]).norm() < 1e-7, "nothing contradicts it");
}

struct PosePrior {
    variables: [usize; 1],
    mean: Isometry3<f64>,
}

impl Residual<Isometry3<f64>> for PosePrior {
    fn variables(&self) -> &[usize] {
        &self.variables
    }

    fn dimension(&self) -> usize {
        6
    }

    fn evaluate(&self, values: &[Isometry3<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        let residual = se3::local(&self.mean, &values[self.variables[0]]);
        into.residual(&residual);
        into.jacobian(0, &se3::right_jacobian_inverse(&residual));
        Ok(())
    }
}

#[test]
fn gauss_newton_converges_quadratically_where_nothing_contradicts() {
    let truth = Vector2::new(3.2, 4.1);
    let mut problem = Problem::new();
    let spot = [problem.add_variable(Vector2::new(2.0, 6.0))];
    for post in POSTS {
        let measured = (truth - post).norm();
        let tape = Tape { spot, post, measured, sigma: 1.0 };
        problem.add_residual(tape, Kernel::Squared).unwrap();
    }
    let solution = problem.solve(&Options::gauss_newton()).unwrap();
    let steps: Vec<f64> = solution.report.iterations.iter().map(|row| row.step_norm).collect();
    for pair in steps.windows(2).skip(1) {
        assert!(pair[1] < 0.5 * pair[0] * pair[0] + 1e-14, "{steps:?}");
    }
}

#[test]
fn gauss_newton_oscillates_away_where_levenberg_marquardt_arrives() {
    // Far out on the arc tangent, its slope promises a zero far beyond the real one.
    let problem = scalar(2.0, |x| Some((x.atan(), 1.0 / (1.0 + x * x))));
    let gauss_newton = problem.solve(&Options::gauss_newton()).unwrap();
    assert_eq!(gauss_newton.report.stop, Stop::LeftDomain, "{}", gauss_newton.report.stop);
    assert!(gauss_newton.values[0].x.abs() > 1e20);
    let solution = problem.solve(&Options::default()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    assert!(solution.values[0].x.abs() < 1e-7);
    assert!(solution.report.iterations.iter().any(|row| !row.accepted));
}

#[test]
fn levenberg_marquardt_never_raises_the_cost() {
    for start in [Vector2::new(-30.0, 2.0), Vector2::new(3.0, -50.0), Vector2::new(100.0, 100.0)] {
        let solution = three_tapes(start, Kernel::Squared).solve(&Options::default()).unwrap();
        let costs: Vec<f64> = solution.report.iterations.iter().map(|row| row.cost).collect();
        assert!(costs.windows(2).all(|pair| pair[1] <= pair[0]), "{costs:?}");
        assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    }
}

#[test]
fn levenberg_marquardt_stays_where_residuals_have_values() {
    // The root of ln x is at 1; the first Gauss-Newton step from 4 is to a negative number.
    let logarithm = |x: f64| (x > 0.0).then(|| (x.ln(), 1.0 / x));
    let problem = scalar(4.0, logarithm);
    let gauss_newton = problem.solve(&Options::gauss_newton()).unwrap();
    assert_eq!(gauss_newton.report.stop, Stop::LeftDomain);
    assert_eq!(gauss_newton.values[0].x, 4.0);
    assert_eq!(gauss_newton.report.iterations[0].trial_cost, None);
    let solution = problem.solve(&Options::default()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    assert_abs_diff_eq!(solution.values[0].x, 1.0, epsilon = 1e-7);
}

#[test]
fn a_jacobian_of_the_wrong_sign_is_a_stall_and_is_called_one() {
    let problem = scalar(2.0, |x| Some((x - 1.0, -1.0)));
    let solution = problem.solve(&Options::default()).unwrap();
    assert_eq!(solution.report.stop, Stop::Stalled);
    assert!(solution.report.gradient_norm > 0.9);
    assert_eq!(solution.values[0].x, 2.0);
    assert!(solution.report.iterations.iter().all(|row| !row.accepted));
}

#[test]
fn the_iteration_limit_is_not_convergence() {
    let options = Options { max_iterations: 2, ..Options::gauss_newton() };
    let problem = three_tapes(Vector2::new(30.0, -40.0), Kernel::Squared);
    let report = problem.solve(&options).unwrap().report;
    assert_eq!(report.stop, Stop::IterationLimit);
    assert_eq!(report.iterations.len(), 2);
    assert!(!report.stop.is_convergence());
    assert!(report.stop.to_string().starts_with("not converged"));
}

const KERNELS: [Kernel; 3] = [Kernel::Squared, Kernel::Huber(1.345), Kernel::Cauchy(2.385)];

#[test]
fn the_gradient_with_weights_is_the_derivative_of_the_robust_cost() {
    let mut draws = Draws::new(5);
    for kernel in KERNELS {
        for _ in 0..50 {
            let at = Vector2::new(3.0, 4.0) + 2.0 * draws.vector::<2>();
            let problem = three_tapes(at, kernel);
            let gradient = problem.linearize(&[at]).unwrap().gradient;
            for axis in 0..2 {
                let mut step = Vector2::zeros();
                step[axis] = 1e-6;
                let cost = |at| problem.linearize(&[at]).unwrap().cost;
                let slope = (cost(at + step) - cost(at - step)) / 2e-6;
                let tolerance = 1e-5 * (1.0 + gradient.amax());
                assert_abs_diff_eq!(slope, gradient[axis], epsilon = tolerance);
            }
        }
    }
}

#[test]
fn weight_times_norm_is_the_derivative_of_every_kernel() {
    for kernel in KERNELS {
        for norm in [1e-6, 0.5, 1.3, 1.4, 2.0, 10.0, 1e3] {
            let slope = (kernel.cost(norm * (1.0 + 1e-6)) - kernel.cost(norm * (1.0 - 1e-6)))
                / (2e-6 * norm);
            assert_relative_eq!(slope, kernel.influence(norm), max_relative = 1e-6);
        }
        assert_eq!(kernel.weight(0.0), 1.0);
    }
}

#[test]
fn an_outlier_pulls_without_bound_to_a_bound_or_hardly_at_all() {
    let shift = |kernel, outlier| {
        let mut problem = Problem::new();
        let variables = [problem.add_variable(Vector1::new(0.0))];
        for measured in [-0.9, -0.4, 0.0, 0.3, 1.0, outlier] {
            let function = move |x: f64| Some((x - measured, 1.0));
            problem.add_residual(Scalar { variables, function }, kernel).unwrap();
        }
        let solution = problem.solve(&Options::default()).unwrap();
        assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
        solution.values[0].x
    };
    assert_abs_diff_eq!(shift(Kernel::Squared, 1000.0), 1000.0 / 6.0, epsilon = 1e-6);
    let (near, far) = (shift(Kernel::Huber(1.345), 10.0), shift(Kernel::Huber(1.345), 1000.0));
    assert_abs_diff_eq!(near, far, epsilon = 1e-5);
    assert!(far > 0.2);
    assert!(shift(Kernel::Cauchy(2.385), 1000.0).abs() < 0.02);
}

#[test]
fn the_covariance_is_the_scatter_of_estimates() {
    let truth = Vector2::new(3.2, 4.1);
    let mut draws = Draws::new(6);
    let mut scatter = Matrix2::zeros();
    let runs = 4000;
    let estimate = |noise: [f64; 3]| {
        let mut problem = Problem::new();
        let spot = [problem.add_variable(truth)];
        for (post, noise) in POSTS.into_iter().zip(noise) {
            let measured = (truth - post).norm() + 0.05 * noise;
            let tape = Tape { spot, post, measured, sigma: 0.05 };
            problem.add_residual(tape, Kernel::Squared).unwrap();
        }
        let solution = problem.solve(&Options::gauss_newton()).unwrap();
        (solution.values[0], problem.covariance(&[truth]).unwrap().of(0).unwrap().clone_owned())
    };
    for _ in 0..runs {
        let (spot, _) = estimate([(); 3].map(|()| draws.normal()));
        let error = spot - truth;
        scatter += error * error.transpose() / f64::from(runs);
    }
    let (_, covariance) = estimate([0.0; 3]);
    assert_relative_eq!(scatter[(0, 0)], covariance[(0, 0)], max_relative = 0.07);
    assert_relative_eq!(scatter[(1, 1)], covariance[(1, 1)], max_relative = 0.07);
}

#[test]
fn blocks_of_the_covariance_are_found_by_variable_and_fixed_ones_have_none() {
    let (mut problem, _) = loop_of_poses(3, 0.0);
    problem.fix(1).unwrap();
    let covariance = problem.covariance(problem.values()).unwrap();
    let inverse = problem.linearize(problem.values()).unwrap().hessian.try_inverse().unwrap();
    assert_relative_eq!(*covariance.matrix(), inverse, max_relative = 1e-9);
    let between = covariance.between(0, 2).unwrap().clone_owned();
    assert_eq!(between, covariance.matrix().view((0, 6), (6, 6)));
    assert_eq!(covariance.of(2).unwrap(), covariance.matrix().view((6, 6), (6, 6)));
    assert_eq!(covariance.of(1), None);
    assert_eq!(covariance.of(3), None);
    assert_eq!(problem.rows_of(2), Some(6..12));
    assert_eq!(problem.rows_of(1), None);
}

#[test]
fn whitened_noise_has_unit_covariance() {
    let mut draws = Draws::new(7);
    let root = Matrix6::from_fn(|_, _| draws.number());
    let covariance: Matrix6<f64> = root * root.transpose() + 0.1 * Matrix6::identity();
    let whitener = sqrt_information(&covariance).unwrap();
    let whitened = whitener * covariance * whitener.transpose();
    assert_abs_diff_eq!(whitened, Matrix6::identity(), epsilon = 1e-12);
    let information = whitener.transpose() * whitener * covariance;
    assert_abs_diff_eq!(information, Matrix6::identity(), epsilon = 1e-11);
}

#[test]
fn what_is_no_covariance_is_refused_with_a_reason() {
    let of = |entries: [f64; 4]| sqrt_information(&Matrix2::from_row_slice(&entries));
    assert_eq!(of([1.0, 2.0, 2.0, 1.0]), Err(WhiteningError::NotPositiveDefinite));
    assert_eq!(of([1.0, 0.0, 0.0, 0.0]), Err(WhiteningError::NotPositiveDefinite));
    assert_eq!(of([1.0, f64::NAN, 0.0, 1.0]), Err(WhiteningError::NotFinite));
    assert_eq!(of([1.0, 0.5, 0.0, 1.0]), Err(WhiteningError::NotSymmetric { asymmetry: 0.5 }));
}

#[test]
fn an_empty_problem_is_an_error() {
    let mut problem = Problem::<Vector2<f64>>::new();
    assert_eq!(problem.solve(&Options::default()).unwrap_err(), SolveError::NoResiduals);
    problem.add_variable(Vector2::zeros());
    assert_eq!(problem.solve(&Options::default()).unwrap_err(), SolveError::NoResiduals);
    let mut problem = three_tapes(Vector2::zeros(), Kernel::Squared);
    problem.fix(0).unwrap();
    assert_eq!(problem.solve(&Options::default()).unwrap_err(), SolveError::NothingFree);
}

#[test]
fn wrong_indices_and_wrong_kernels_are_refused() {
    let mut problem = Problem::new();
    let spot = problem.add_variable(Vector2::zeros());
    let tape = |spot| Tape { spot: [spot], post: Vector2::x(), measured: 1.0, sigma: 1.0 };
    let missing = ProblemError::NoSuchVariable { variable: 3, variables: 1 };
    assert_eq!(problem.add_residual(tape(3), Kernel::Squared), Err(missing));
    assert_eq!(problem.fix(3), Err(missing));
    for kernel in [Kernel::Huber(0.0), Kernel::Cauchy(-1.0), Kernel::Huber(f64::NAN)] {
        let refused = problem.add_residual(tape(spot), kernel);
        assert!(matches!(refused, Err(ProblemError::Kernel(_))), "{refused:?}");
    }
    let mut points = Problem::new();
    let point = points.add_variable(Vector3::zeros());
    let repeated = Distance { points: [point, point], measured: 1.0 };
    let refused = points.add_residual(repeated, Kernel::Squared);
    assert_eq!(refused, Err(ProblemError::RepeatedVariable { residual: 0, variable: 0 }));
    let sentence = refused.unwrap_err().to_string();
    assert!(sentence.contains("names variable 0 twice"), "{sentence}");
}

/// Writes numbers of any shape.
struct Misshapen<const R: usize, const C: usize> {
    slot: usize,
}

impl<const R: usize, const C: usize> Residual<Vector2<f64>> for Misshapen<R, C> {
    fn variables(&self) -> &[usize] {
        &[0]
    }

    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&self, _: &[Vector2<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        into.residual(&SVector::<f64, R>::repeat(1.0));
        into.jacobian(self.slot, &SMatrix::<f64, 1, C>::repeat(1.0));
        Ok(())
    }
}

#[test]
fn a_residual_of_the_wrong_shape_is_an_error_that_names_it() {
    let long = refusal(Misshapen::<2, 2> { slot: 0 });
    assert_eq!(long, "residual 0 wrote a residual of 2×1 numbers where 1×1 belong");
    let wide = refusal(Misshapen::<1, 3> { slot: 0 });
    assert_eq!(wide, "residual 0 wrote a Jacobian block of 1×3 numbers where 1×2 belong");
    let many = refusal(Misshapen::<1, 2> { slot: 1 });
    assert!(many.contains("one variable too many"), "{many}");
}

/// What solving says about a problem with this residual.
fn refusal(residual: impl Residual<Vector2<f64>> + 'static) -> String {
    let mut problem = Problem::new();
    problem.add_variable(Vector2::zeros());
    problem.add_residual(residual, Kernel::Squared).unwrap();
    problem.solve(&Options::default()).unwrap_err().to_string()
}

#[test]
fn a_start_without_a_value_or_with_nan_is_an_error_that_names_the_residual() {
    let undefined = scalar(-1.0, |x: f64| (x > 0.0).then(|| (x.ln(), 1.0 / x)));
    let error = undefined.solve(&Options::default()).unwrap_err();
    assert_eq!(error, SolveError::Undefined { residual: 0 });
    for (value, slope) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0)] {
        let error = scalar(1.0, move |_| Some((value, slope))).solve(&Options::default());
        assert_eq!(error.unwrap_err(), SolveError::NotFinite { residual: 0 });
    }
    let error = scalar(1.0, |_| Some((1e200, 1.0))).solve(&Options::default()).unwrap_err();
    assert_eq!(error, SolveError::OutOfRange);
}

#[test]
fn wrong_options_and_wrong_values_are_refused() {
    let problem = three_tapes(Vector2::new(3.0, 4.0), Kernel::Squared);
    for initial_damping in [0.0, -1.0, f64::NAN] {
        let method = Method::LevenbergMarquardt { initial_damping };
        let error = problem.solve(&Options { method, ..Options::default() }).unwrap_err();
        assert!(error.to_string().contains("initial_damping"), "{error}");
    }
    let options = Options { step_tolerance: f64::NAN, ..Options::default() };
    assert!(matches!(problem.solve(&options), Err(SolveError::Option { .. })));
    let wrong = SolveError::WrongValues { given: 2, expected: 1 };
    assert_eq!(problem.linearize(&[Vector2::zeros(); 2]), Err(wrong));
}

// ANCHOR: pose_and_point
/// A point, seen from a pose, relative to it: Tᵀ P in body coordinates less what was measured.
struct Sighting {
    variables: [usize; 2],
    in_body: Vector3<f64>,
}

impl Residual<PoseOrPoint> for Sighting {
    fn variables(&self) -> &[usize] {
        &self.variables
    }

    fn dimension(&self) -> usize {
        3
    }

    fn evaluate(&self, values: &[PoseOrPoint], into: &mut Evaluation) -> Result<(), Undefined> {
        let [pose, point] = self.variables.map(|variable| &values[variable]);
        let world_from_body = pose.pose().ok_or(Undefined)?;
        let in_world = point.point().ok_or(Undefined)?;
        let seen = world_from_body.inverse_transform_point(&(*in_world).into()).coords;
        let rotation = world_from_body.rotation.to_rotation_matrix();
        let mut by_pose = SMatrix::<f64, 3, 6>::zeros();
        by_pose.fixed_columns_mut::<3>(0).copy_from(&-Matrix3::identity());
        by_pose.fixed_columns_mut::<3>(3).copy_from(&so3::hat(&seen));
        into.residual(&(seen - self.in_body));
        into.jacobian(0, &by_pose);
        into.jacobian(1, &rotation.matrix().transpose());
        Ok(())
    }
}
// ANCHOR_END: pose_and_point

#[test]
fn poses_and_points_are_variables_of_one_problem() {
    let mut draws = Draws::new(8);
    let poses: Vec<_> = (0..3).map(|_| se3::exp(&draws.vector())).collect();
    let points: Vec<Vector3<f64>> = (0..5).map(|_| 3.0 * draws.vector::<3>()).collect();
    let mut problem = Problem::new();
    for pose in &poses {
        let fixed = pose == &poses[0];
        let away = if fixed { 0.0 } else { 0.2 } * draws.vector::<6>();
        let index = problem.add_variable(PoseOrPoint::Pose(se3::retract(pose, &away)));
        if fixed {
            problem.fix(index).unwrap();
        }
    }
    for (number, point) in points.iter().enumerate() {
        let start = point + 0.3 * draws.vector::<3>();
        let landmark = problem.add_variable(PoseOrPoint::Point(start));
        assert_eq!(landmark, poses.len() + number);
        for (camera, pose) in poses.iter().enumerate() {
            let in_body = pose.inverse_transform_point(&(*point).into()).coords;
            let sighting = Sighting { variables: [camera, landmark], in_body };
            problem.add_residual(sighting, Kernel::Huber(1.0)).unwrap();
        }
    }
    let solution = problem.solve(&Options::default()).unwrap();
    assert_eq!(solution.report.free_directions, 0);
    for (found, pose) in solution.values.iter().zip(&poses) {
        assert!(se3::local(found.pose().unwrap(), pose).norm() < 1e-7);
    }
    for (found, point) in solution.values[poses.len()..].iter().zip(&points) {
        assert!((found.point().unwrap() - point).norm() < 1e-7);
    }
    assert_eq!(solution.values[0].point(), None);
    assert_eq!(solution.values[4].pose(), None);
}

#[test]
fn retraction_by_zero_changes_nothing_and_the_right_one_is_used() {
    let mut draws = Draws::new(9);
    let pose = se3::exp(&draws.vector());
    assert_relative_eq!(pose.retract(&[0.0; 6]), pose, epsilon = 1e-15);
    let step: Vector6<f64> = draws.vector();
    assert_relative_eq!(pose.retract(step.as_slice()), pose * se3::exp(&step), epsilon = 1e-15);
    let rotation = so3::exp(&draws.vector());
    let turn: Vector3<f64> = draws.vector();
    assert_relative_eq!(rotation.retract(turn.as_slice()), rotation * so3::exp(&turn));
    let moved = RowVector2::new(1.0, 2.0).transpose().retract(&[0.5, -0.5]);
    assert_eq!(moved, Vector2::new(1.5, 1.5));
}
