//! Least squares on problems whose answer is known.

#[path = "least_squares/fronts.rs"]
mod fronts;
#[path = "least_squares/frozen.rs"]
mod frozen;
#[path = "least_squares/linear_prior.rs"]
mod linear_prior;
#[path = "least_squares/null_space.rs"]
mod null_space;
#[path = "least_squares/variables.rs"]
mod variables;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix1, Matrix2, Matrix3, Matrix3x6, Matrix6, Rotation3,
    RowVector2, RowVector3, SVector, Vector1, Vector2, Vector3, Vector6,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::factors::Prior;
use vislam::least_squares::{
    Factor, Kernel, Key, LandmarkElimination, Method, Options, Problem, ProblemError, SolveError,
    Stop, Values, WhiteningError, sqrt_information,
};
use vislam::manifold::{se3, so3};

/// The distance from a known post to an unknown spot, measured with standard deviation `sigma`, all in metres.
struct Tape {
    spot: Key<Vector2<f64>>,
    post: Vector2<f64>,
    measured: f64,
    sigma: f64,
}

// ANCHOR: tape
impl Factor<1> for Tape {
    type Variables = (Vector2<f64>,);
    type Jacobians = (RowVector2<f64>,);

    fn variables(&self) -> (Key<Vector2<f64>>,) {
        (self.spot,)
    }

    fn residual(&self, spot: (&Vector2<f64>,)) -> Option<Vector1<f64>> {
        self.linearize(spot).map(|(residual, _)| residual)
    }

    fn linearize(&self, (spot,): (&Vector2<f64>,)) -> Option<(Vector1<f64>, (RowVector2<f64>,))> {
        let from_post = spot - self.post;
        let direction = from_post.try_normalize(0.0)?; // at the post there is no derivative
        let residual = (from_post.norm() - self.measured) / self.sigma;
        Some((Vector1::new(residual), (direction.transpose() / self.sigma,)))
    }
}
// ANCHOR_END: tape

const POSTS: [Vector2<f64>; 3] =
    [Vector2::new(0.0, 0.0), Vector2::new(6.0, 0.0), Vector2::new(3.0, 9.0)];
const MEASURED: [f64; 3] = [5.18, 4.94, 4.87];

// ANCHOR: three_tapes
/// A spot to be found with three tapes, each good to five centimetres.
fn three_tapes(start: Vector2<f64>, kernel: Kernel) -> (Problem, Key<Vector2<f64>>) {
    let mut problem = Problem::new();
    let spot = problem.add_variable(start);
    for (post, measured) in POSTS.into_iter().zip(MEASURED) {
        let tape = Tape { spot, post, measured, sigma: 0.05 };
        problem.add_factor(tape, kernel).expect("the spot is a variable");
    }
    (problem, spot)
}
// ANCHOR_END: three_tapes

// ANCHOR: worked_example
#[test]
fn three_tapes_place_the_point_as_computed_by_hand() {
    let (problem, spot) = three_tapes(Vector2::new(3.0, 4.0), Kernel::Squared);
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
    assert_abs_diff_eq!(solution.values[spot], Vector2::new(3.1996, 4.0987), epsilon = 1e-4);
    let covariance = problem.covariance(&solution.values).unwrap();
    assert!((covariance.of(spot).unwrap()[(0, 0)].sqrt() - 0.06).abs() < 0.005);
}
// ANCHOR_END: worked_example

/// A sum of three vectors, each times a matrix, less what was measured.
struct Linear {
    vectors: [Key<Vector3<f64>>; 3],
    blocks: [Matrix3<f64>; 3],
    measured: Vector3<f64>,
}

type ThreeVectors<'a> = (&'a Vector3<f64>, &'a Vector3<f64>, &'a Vector3<f64>);

impl Factor<3> for Linear {
    type Variables = (Vector3<f64>, Vector3<f64>, Vector3<f64>);
    type Jacobians = (Matrix3<f64>, Matrix3<f64>, Matrix3<f64>);

    fn variables(&self) -> (Key<Vector3<f64>>, Key<Vector3<f64>>, Key<Vector3<f64>>) {
        self.vectors.into()
    }

    fn residual(&self, (x, y, z): ThreeVectors) -> Option<Vector3<f64>> {
        let [a, b, c] = self.blocks;
        Some(a * x + b * y + c * z - self.measured)
    }

    fn linearize(&self, vectors: ThreeVectors) -> Option<(Vector3<f64>, Self::Jacobians)> {
        Some((self.residual(vectors)?, self.blocks.into()))
    }
}

/// A pose measured against another one, whitened by unit covariance: log(Z⁻¹ Tᵢ⁻¹ Tⱼ).
struct Between {
    poses: [Key<Isometry3<f64>>; 2],
    measured: Isometry3<f64>,
}

type TwoPoses<'a> = (&'a Isometry3<f64>, &'a Isometry3<f64>);

impl Factor<6> for Between {
    type Variables = (Isometry3<f64>, Isometry3<f64>);
    type Jacobians = (Matrix6<f64>, Matrix6<f64>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Isometry3<f64>>) {
        self.poses.into()
    }

    fn residual(&self, (first, second): TwoPoses) -> Option<Vector6<f64>> {
        Some(se3::local(&self.measured, &first.inv_mul(second)))
    }

    fn linearize(&self, (first, second): TwoPoses) -> Option<(Vector6<f64>, Self::Jacobians)> {
        let residual = self.residual((first, second))?;
        let by_second = se3::right_jacobian_inverse(&residual);
        let by_first = -by_second * se3::adjoint(&second.inv_mul(first));
        Some((residual, (by_first, by_second)))
    }
}

/// A direction known in the world and measured in the body: R z − d.
struct Direction {
    rotation: Key<Rotation3<f64>>,
    in_world: Vector3<f64>,
    in_body: Vector3<f64>,
    whitener: Matrix3<f64>,
}

impl Factor<3> for Direction {
    type Variables = (Rotation3<f64>,);
    type Jacobians = (Matrix3<f64>,);

    fn variables(&self) -> (Key<Rotation3<f64>>,) {
        (self.rotation,)
    }

    fn residual(&self, (rotation,): (&Rotation3<f64>,)) -> Option<Vector3<f64>> {
        Some(self.whitener * (rotation * self.in_body - self.in_world))
    }

    fn linearize(
        &self,
        (rotation,): (&Rotation3<f64>,),
    ) -> Option<(Vector3<f64>, (Matrix3<f64>,))> {
        let by_rotation = -self.whitener * rotation.matrix() * so3::hat(&self.in_body);
        Some((self.residual((rotation,))?, (by_rotation,)))
    }
}

/// A residual given by a function of one number, for what no measurement would do.
struct Scalar<F> {
    number: Key<Vector1<f64>>,
    function: F,
}

impl<F: Fn(f64) -> Option<(f64, f64)> + Send + Sync + 'static> Factor<1> for Scalar<F> {
    type Variables = (Vector1<f64>,);
    type Jacobians = (Matrix1<f64>,);

    fn variables(&self) -> (Key<Vector1<f64>>,) {
        (self.number,)
    }

    fn residual(&self, number: (&Vector1<f64>,)) -> Option<Vector1<f64>> {
        self.linearize(number).map(|(residual, _)| residual)
    }

    fn linearize(&self, (number,): (&Vector1<f64>,)) -> Option<(Vector1<f64>, (Matrix1<f64>,))> {
        let (value, slope) = (self.function)(number.x)?;
        Some((Vector1::new(value), (Matrix1::new(slope),)))
    }
}

/// A problem in one number.
fn scalar(
    start: f64,
    function: impl Fn(f64) -> Option<(f64, f64)> + Send + Sync + 'static,
) -> (Problem, Key<Vector1<f64>>) {
    let mut problem = Problem::new();
    let number = problem.add_variable(Vector1::new(start));
    problem.add_factor(Scalar { number, function }, Kernel::Squared).unwrap();
    (problem, number)
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

fn linear_problem() -> Problem {
    let mut draws = Draws::new(1);
    let mut problem = Problem::new();
    let vectors = [(); 3].map(|()| problem.add_variable(draws.vector::<3>()));
    for _ in 0..6 {
        let blocks = [(); 3].map(|()| Matrix3::from_fn(|_, _| draws.number()));
        let linear = Linear { vectors, blocks, measured: draws.vector() };
        problem.add_factor(linear, Kernel::Squared).unwrap();
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
    let (problem, spot) = three_tapes(Vector2::new(3.0, 4.0), Kernel::Squared);
    problem.solve(&Options::default()).unwrap();
    assert_eq!(problem.values()[spot], Vector2::new(3.0, 4.0));
}

#[test]
fn a_rotation_is_found_from_directions_and_whatever_the_start() {
    let mut draws = Draws::new(2);
    for _ in 0..20 {
        let truth = Rotation3::new(3.0 * draws.vector::<3>());
        let mut problem = Problem::new();
        let rotation = problem.add_variable(Rotation3::new(2.0 * draws.vector::<3>()));
        for _ in 0..4 {
            let in_body = draws.vector::<3>();
            let whitener = sqrt_information(&(0.04 * Matrix3::identity())).unwrap();
            let direction = Direction { rotation, in_world: truth * in_body, in_body, whitener };
            problem.add_factor(direction, Kernel::Squared).unwrap();
        }
        let solution = problem.solve(&Options::default()).unwrap();
        assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
        assert!(so3::local(&truth, &solution.values[rotation]).norm() < 1e-7);
    }
}

/// A problem of poses, their keys and where they truly are.
type Loop = (Problem, Vec<Key<Isometry3<f64>>>, Vec<Isometry3<f64>>);

/// Poses on a circle, each measured against the next, the last against the first.
fn loop_of_poses(count: usize, noise: f64) -> Loop {
    let mut draws = Draws::new(3);
    let truth: Vec<_> = (0..count).map(|_| se3::exp(&(2.0 * draws.vector::<6>()))).collect();
    let mut problem = Problem::new();
    let start = |pose| problem.add_variable(se3::retract(pose, &(0.3 * draws.vector::<6>())));
    let poses: Vec<_> = truth.iter().map(start).collect();
    for first in 0..count {
        let second = (first + 1) % count;
        let relative = truth[first].inv_mul(&truth[second]);
        let measured = se3::retract(&relative, &(noise * draws.vector::<6>()));
        let between = Between { poses: [poses[first], poses[second]], measured };
        problem.add_factor(between, Kernel::Squared).unwrap();
    }
    (problem, poses, truth)
}

#[test]
fn poses_are_found_from_relative_measurements_once_one_of_them_is_held() {
    let (mut problem, poses, truth) = loop_of_poses(5, 0.0);
    let mut values = problem.values().clone();
    values.set(poses[0], truth[0]);
    problem.set_values(values).unwrap();
    problem.hold(poses[0]).unwrap();
    for options in [Options::gauss_newton(), Options::default()] {
        let solution = problem.solve(&options).unwrap();
        assert_eq!(problem.null_space(&solution.values).unwrap().nullity(), 0);
        for (pose, true_pose) in poses.iter().zip(&truth) {
            assert!(se3::local(&solution.values[*pose], true_pose).norm() < 1e-7);
        }
    }
}

#[test]
fn poses_with_no_anchor_are_free_in_six_directions_and_the_error_says_so() {
    let (problem, _, _) = loop_of_poses(5, 0.1);
    let error = problem.solve(&Options::gauss_newton()).unwrap_err();
    let sentence = error.to_string();
    let said = "the system leaves 6 of 30 directions free; hold variables or add measurements";
    assert_eq!(sentence, said);
    let SolveError::Singular(singular) = error else { panic!("{sentence}") };
    let system = problem.linearize(problem.values()).unwrap();
    assert_eq!(singular.basis.shape(), (30, 6));
    assert!((&system.hessian * &singular.basis).amax() < 1e-9 * system.hessian.amax());
    let gram = singular.basis.transpose() * &singular.basis;
    assert_abs_diff_eq!(gram, DMatrix::identity(6, 6), epsilon = 1e-12);
}

#[test]
fn damping_solves_a_singular_system_and_the_null_space_tells() {
    let (problem, _, _) = loop_of_poses(5, 0.1);
    let solution = problem.solve(&Options::default()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    assert_eq!(problem.null_space(&solution.values).unwrap().nullity(), 6);
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
        let (problem, _) = distances(&points);
        let hessian = problem.linearize(problem.values()).unwrap().hessian;
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
        let spot = problem.add_variable(unit * Vector2::new(20.0, -3.0));
        for (post, measured) in POSTS.into_iter().zip(MEASURED) {
            let tape =
                Tape { spot, post: unit * post, measured: unit * measured, sigma: unit * 0.05 };
            problem.add_factor(tape, Kernel::Squared).unwrap();
        }
        let solution = problem.solve(&Options::default()).unwrap();
        (solution.values[spot], solution.report.iterations)
    };
    let ((metres, in_metres), (millimetres, in_millimetres)) = (in_unit(1.0), in_unit(1000.0));
    assert_relative_eq!(1000.0 * metres, millimetres, max_relative = 1e-8);
    let pairs = in_metres.iter().zip(&in_millimetres);
    for (metre, millimetre) in pairs.take(5) {
        assert_relative_eq!(metre.cost, millimetre.cost, max_relative = 1e-8);
        assert_relative_eq!(metre.step_norm, millimetre.step_norm, max_relative = 1e-8);
    }
}

#[test]
fn negating_every_jacobian_makes_an_undamped_step_raise_the_cost() {
    let (problem, _) = scalar(2.0, |x| Some((x - 1.0, 1.0)));
    let (backwards, _) = scalar(2.0, |x| Some((x - 1.0, -1.0)));
    let once = Options { max_iterations: 1, ..Options::gauss_newton() };
    assert_eq!(problem.solve(&once).unwrap().report.cost, 0.0);
    assert_eq!(backwards.solve(&once).unwrap().report.cost, 2.0);
}

/// Distance between two points that are both unknown.
struct Distance {
    points: [Key<Vector3<f64>>; 2],
    measured: f64,
}

type TwoPoints<'a> = (&'a Vector3<f64>, &'a Vector3<f64>);

impl Factor<1> for Distance {
    type Variables = (Vector3<f64>, Vector3<f64>);
    type Jacobians = (RowVector3<f64>, RowVector3<f64>);

    fn variables(&self) -> (Key<Vector3<f64>>, Key<Vector3<f64>>) {
        self.points.into()
    }

    fn residual(&self, points: TwoPoints) -> Option<Vector1<f64>> {
        self.linearize(points).map(|(residual, _)| residual)
    }

    fn linearize(&self, (first, second): TwoPoints) -> Option<(Vector1<f64>, Self::Jacobians)> {
        let between = second - first;
        let direction = between.try_normalize(0.0)?.transpose();
        Some((Vector1::new(between.norm() - self.measured), (-direction, direction)))
    }
}

/// All distances between points in space.
fn distances(points: &[Vector3<f64>]) -> (Problem, Vec<Key<Vector3<f64>>>) {
    let mut problem = Problem::new();
    let keys: Vec<_> = points.iter().map(|point| problem.add_variable(*point)).collect();
    for second in 0..points.len() {
        for first in 0..second {
            let measured = (points[second] - points[first]).norm();
            let distance = Distance { points: [keys[first], keys[second]], measured };
            problem.add_factor(distance, Kernel::Squared).unwrap();
        }
    }
    (problem, keys)
}

#[test]
fn the_free_directions_are_counted_right_whatever_the_units() {
    let mut draws = Draws::new(4);
    for unit in [1e-3, 1.0, 1e3] {
        let points: Vec<Vector3<f64>> = (0..6).map(|_| unit * draws.vector::<3>()).collect();
        let free = |held: &[usize]| {
            let (mut problem, keys) = distances(&points);
            held.iter().for_each(|point| problem.hold(keys[*point]).unwrap());
            problem.null_space(problem.values()).unwrap().nullity()
        };
        assert_eq!(free(&[]), 6, "a rigid body in space");
        assert_eq!(free(&[0]), 3, "it may turn about a point");
        assert_eq!(free(&[0, 1]), 1, "it may turn about a line");
        assert_eq!(free(&[0, 1, 2]), 0);
    }
}

#[test]
fn a_variable_that_nothing_measures_is_free_in_all_its_directions() {
    let (mut problem, _) = three_tapes(Vector2::new(3.0, 4.0), Kernel::Squared);
    let unmeasured = problem.add_variable(Vector2::zeros());
    let error = problem.solve(&Options::gauss_newton()).unwrap_err();
    assert!(error.to_string().contains("2 of 4 directions"), "{error}");
    let solution = problem.solve(&Options::default()).unwrap();
    assert_eq!(solution.values[unmeasured], Vector2::zeros());
    assert_eq!(problem.null_space(&solution.values).unwrap().nullity(), 2);
}

#[test]
fn a_prior_makes_a_free_system_regular() {
    let (mut problem, poses, truth) = loop_of_poses(4, 0.1);
    let sqrt_information = Matrix6::identity();
    let prior = Prior { variable: poses[0], anchor: truth[0], sqrt_information };
    problem.add_factor(prior, Kernel::Squared).unwrap();
    let solution = problem.solve(&Options::gauss_newton()).unwrap();
    assert_eq!(problem.null_space(&solution.values).unwrap().nullity(), 0);
    let error = se3::local(&truth[0], &solution.values[poses[0]]);
    assert!(error.norm() < 1e-7, "nothing contradicts the prior");
}

#[test]
fn gauss_newton_converges_quadratically_where_nothing_contradicts() {
    let truth = Vector2::new(3.2, 4.1);
    let mut problem = Problem::new();
    let spot = problem.add_variable(Vector2::new(2.0, 6.0));
    for post in POSTS {
        let measured = (truth - post).norm();
        let tape = Tape { spot, post, measured, sigma: 1.0 };
        problem.add_factor(tape, Kernel::Squared).unwrap();
    }
    let solution = problem.solve(&Options::gauss_newton()).unwrap();
    let steps: Vec<f64> = solution.report.iterations.iter().map(|row| row.step_norm).collect();
    for pair in steps.windows(2).skip(1) {
        assert!(pair[1] < 0.5 * pair[0] * pair[0] + 1e-14, "{steps:?}");
    }
}

#[test]
fn gauss_newton_oscillates_away_where_levenberg_marquardt_arrives() {
    // Far out on the arc tangent, the zero of its tangent lies far beyond the real one.
    let (problem, number) = scalar(2.0, |x| Some((x.atan(), 1.0 / (1.0 + x * x))));
    let gauss_newton = problem.solve(&Options::gauss_newton()).unwrap();
    assert_eq!(gauss_newton.report.stop, Stop::LeftDomain, "{}", gauss_newton.report.stop);
    assert!(gauss_newton.values[number].x.abs() > 1e20);
    let solution = problem.solve(&Options::default()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    assert!(solution.values[number].x.abs() < 1e-7);
    assert!(solution.report.iterations.iter().any(|row| !row.accepted));
}

#[test]
fn levenberg_marquardt_never_raises_the_cost() {
    for start in [Vector2::new(-30.0, 2.0), Vector2::new(3.0, -50.0), Vector2::new(100.0, 100.0)] {
        let (problem, _) = three_tapes(start, Kernel::Squared);
        let solution = problem.solve(&Options::default()).unwrap();
        let costs: Vec<f64> = solution.report.iterations.iter().map(|row| row.cost).collect();
        assert!(costs.windows(2).all(|pair| pair[1] <= pair[0]), "{costs:?}");
        assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    }
}

#[test]
fn levenberg_marquardt_stays_where_residuals_have_values() {
    // The root of ln x is at 1; the first Gauss-Newton step from 4 is to a negative number.
    let logarithm = |x: f64| (x > 0.0).then(|| (x.ln(), 1.0 / x));
    let (problem, number) = scalar(4.0, logarithm);
    let gauss_newton = problem.solve(&Options::gauss_newton()).unwrap();
    assert_eq!(gauss_newton.report.stop, Stop::LeftDomain);
    assert_eq!(gauss_newton.values[number].x, 4.0);
    assert_eq!(gauss_newton.report.iterations[0].trial_cost, None);
    let solution = problem.solve(&Options::default()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    assert_abs_diff_eq!(solution.values[number].x, 1.0, epsilon = 1e-7);
}

#[test]
fn levenberg_marquardt_goes_less_far_where_derivatives_have_no_values() {
    // Below a quarter the residual has a value and no derivative.
    let edge = |x: f64| Some((x, if x < 0.25 { f64::NAN } else { 1.0 }));
    let (problem, number) = scalar(1.0, edge);
    let method = Method::LevenbergMarquardt { initial_damping: 1.0 };
    let solution = problem.solve(&Options { method, ..Options::default() }).unwrap();
    let mut rows = solution.report.iterations.iter();
    assert!(rows.any(|row| !row.accepted && row.gain_ratio.is_some_and(|gain| gain > 0.5)));
    assert_ne!(solution.report.stop, Stop::LeftDomain);
    assert!((0.25..0.3).contains(&solution.values[number].x), "{}", solution.values[number].x);
    let gauss_newton = problem.solve(&Options::gauss_newton()).unwrap();
    assert_eq!(gauss_newton.report.stop, Stop::LeftDomain);
    assert!(!gauss_newton.report.iterations[0].accepted);
    assert_eq!(gauss_newton.values[number].x, 1.0);
}

#[test]
fn a_jacobian_of_the_wrong_sign_is_a_stall_and_is_called_one() {
    let (problem, number) = scalar(2.0, |x| Some((x - 1.0, -1.0)));
    let solution = problem.solve(&Options::default()).unwrap();
    assert_eq!(solution.report.stop, Stop::Stalled);
    assert!(solution.report.gradient_norm > 0.9);
    assert_eq!(solution.values[number].x, 2.0);
    assert!(solution.report.iterations.iter().all(|row| !row.accepted));
}

#[test]
fn the_iteration_limit_is_not_convergence() {
    let options = Options { max_iterations: 2, ..Options::gauss_newton() };
    let (problem, _) = three_tapes(Vector2::new(30.0, -40.0), Kernel::Squared);
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
            let (problem, spot) = three_tapes(at, kernel);
            let gradient = problem.linearize(problem.values()).unwrap().gradient;
            for axis in 0..2 {
                let mut step = Vector2::zeros();
                step[axis] = 1e-6;
                let cost = |at| {
                    let mut values = problem.values().clone();
                    values.set(spot, at);
                    problem.cost(&values)
                };
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
        let number = problem.add_variable(Vector1::new(0.0));
        for measured in [-0.9, -0.4, 0.0, 0.3, 1.0, outlier] {
            let function = move |x: f64| Some((x - measured, 1.0));
            problem.add_factor(Scalar { number, function }, kernel).unwrap();
        }
        let solution = problem.solve(&Options::default()).unwrap();
        assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
        solution.values[number].x
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
        let spot = problem.add_variable(truth);
        for (post, noise) in POSTS.into_iter().zip(noise) {
            let measured = (truth - post).norm() + 0.05 * noise;
            let tape = Tape { spot, post, measured, sigma: 0.05 };
            problem.add_factor(tape, Kernel::Squared).unwrap();
        }
        let found = problem.solve(&Options::gauss_newton()).unwrap().values[spot];
        (found, problem.covariance(problem.values()).unwrap().of(spot).unwrap())
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
fn blocks_of_the_covariance_are_found_by_variable_and_held_ones_have_none() {
    let (mut problem, poses, _) = loop_of_poses(3, 0.0);
    problem.hold(poses[1]).unwrap();
    let covariance = problem.covariance(problem.values()).unwrap();
    let inverse = problem.linearize(problem.values()).unwrap().hessian.try_inverse().unwrap();
    assert_relative_eq!(*covariance.matrix(), inverse, max_relative = 1e-9);
    let between = covariance.between(poses[0], poses[2]).unwrap();
    assert_eq!(between, covariance.matrix().view((0, 6), (6, 6)));
    assert_eq!(covariance.of(poses[2]).unwrap(), covariance.matrix().view((6, 6), (6, 6)));
    assert_eq!(covariance.of(poses[1]), None);
    let (_, others, _) = loop_of_poses(4, 0.0);
    assert_eq!(covariance.of(others[3]), None);
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
    let mut problem = Problem::new();
    assert_eq!(problem.solve(&Options::default()).unwrap_err(), SolveError::NoFactors);
    problem.add_variable(Vector2::zeros());
    assert_eq!(problem.solve(&Options::default()).unwrap_err(), SolveError::NoFactors);
    let (mut problem, spot) = three_tapes(Vector2::zeros(), Kernel::Squared);
    problem.hold(spot).unwrap();
    assert_eq!(problem.solve(&Options::default()).unwrap_err(), SolveError::NothingFree);
}

#[test]
fn keys_of_other_problems_and_wrong_kernels_are_refused() {
    let mut others = Problem::new();
    let strangers = [(); 4].map(|()| others.add_variable(Vector2::zeros()));
    let mut problem = Problem::new();
    let spot = problem.add_variable(Vector2::zeros());
    let tape = |spot| Tape { spot, post: Vector2::x(), measured: 1.0, sigma: 1.0 };
    let missing = ProblemError::NoSuchVariable { variable: 3, variables: 1 };
    assert_eq!(problem.add_factor(tape(strangers[3]), Kernel::Squared), Err(missing));
    assert_eq!(problem.hold(strangers[3]), Err(missing));
    assert_eq!(problem.hold_coordinates(strangers[3], 0..1), Err(missing));
    assert_eq!(problem.tie(spot, strangers[3]), Err(missing));
    assert_eq!(problem.freeze(strangers[3], Vector2::zeros()), Err(missing));
    for kernel in [Kernel::Huber(0.0), Kernel::Cauchy(-1.0), Kernel::Huber(f64::NAN)] {
        let refused = problem.add_factor(tape(spot), kernel);
        assert!(matches!(refused, Err(ProblemError::Kernel(_))), "{refused:?}");
    }
}

#[test]
fn a_key_of_another_kind_is_refused_although_its_number_exists() {
    let mut others = Problem::new();
    let stranger = others.add_variable(Vector3::<f64>::zeros());
    let mut problem = Problem::new();
    problem.add_variable(Vector2::<f64>::zeros());
    let missing = ProblemError::NoSuchVariable { variable: 0, variables: 1 };
    assert_eq!(problem.hold(stranger), Err(missing));
    assert_eq!(problem.values().get(stranger), None);
}

#[test]
fn a_factor_names_no_variable_twice() {
    let mut problem = Problem::new();
    let point = problem.add_variable(Vector3::zeros());
    let repeated = Distance { points: [point, point], measured: 1.0 };
    let refused = problem.add_factor(repeated, Kernel::Squared);
    assert_eq!(refused, Err(ProblemError::RepeatedVariable { factor: 0, variable: 0 }));
    let sentence = refused.unwrap_err().to_string();
    assert!(sentence.contains("names variable 0 twice"), "{sentence}");
}

/// Derivatives of three columns by a variable that moves in two directions. A residual of another
/// length than it says, or derivatives of other rows, would not even compile.
struct TooWide(Key<Vector2<f64>>);

impl Factor<1> for TooWide {
    type Variables = (Vector2<f64>,);
    type Jacobians = (RowVector3<f64>,);

    fn variables(&self) -> (Key<Vector2<f64>>,) {
        (self.0,)
    }

    fn residual(&self, _: (&Vector2<f64>,)) -> Option<Vector1<f64>> {
        Some(Vector1::zeros())
    }

    fn linearize(&self, _: (&Vector2<f64>,)) -> Option<(Vector1<f64>, (RowVector3<f64>,))> {
        Some((Vector1::zeros(), (RowVector3::zeros(),)))
    }
}

#[test]
fn derivatives_must_have_a_column_for_each_coordinate_of_their_variable() {
    let mut problem = Problem::new();
    let spot = problem.add_variable(Vector2::zeros());
    let refused = problem.add_factor(TooWide(spot), Kernel::Squared).unwrap_err();
    assert_eq!(refused, ProblemError::Columns { factor: 0, slot: 0, columns: 3, dimension: 2 });
    let said = "factor 0 has derivatives of 3 columns by its variable 0, whose step has 2 numbers";
    assert_eq!(refused.to_string(), said);
}

#[test]
fn a_start_without_a_value_or_with_nan_is_an_error_that_names_the_factor() {
    let (undefined, _) = scalar(-1.0, |x: f64| (x > 0.0).then(|| (x.ln(), 1.0 / x)));
    let error = undefined.solve(&Options::default()).unwrap_err();
    assert_eq!(error, SolveError::Undefined { factor: 0 });
    for (value, slope) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0)] {
        let (problem, _) = scalar(1.0, move |_| Some((value, slope)));
        let error = problem.solve(&Options::default()).unwrap_err();
        assert_eq!(error, SolveError::NotFinite { factor: 0 });
    }
    let (problem, _) = scalar(1.0, |_| Some((1e200, 1.0)));
    assert_eq!(problem.solve(&Options::default()).unwrap_err(), SolveError::OutOfRange);
}

#[test]
fn a_search_whose_steps_are_used_up_is_not_settled() {
    let (problem, _) = three_tapes(Vector2::new(30.0, 40.0), Kernel::Squared);
    let one = Options { max_iterations: 1, ..Options::default() };
    let refused = problem.solve(&one).unwrap().settled().unwrap_err();
    assert_eq!(refused, SolveError::NotConverged { stop: Stop::IterationLimit });
    assert!(problem.solve(&Options::default()).unwrap().settled().is_ok());
}

#[test]
fn wrong_options_and_wrong_values_are_refused() {
    let (problem, _) = three_tapes(Vector2::new(3.0, 4.0), Kernel::Squared);
    for initial_damping in [-1.0, f64::NAN, 1e13] {
        let method = Method::LevenbergMarquardt { initial_damping };
        let error = problem.solve(&Options { method, ..Options::default() }).unwrap_err();
        let says = |words| error.to_string().contains(words);
        assert!(says("initial_damping") && says("at most"), "{error}");
    }
    let options = Options { step_tolerance: f64::NAN, ..Options::default() };
    assert!(matches!(problem.solve(&options), Err(SolveError::Option { .. })));
    let mut others = Values::new();
    others.add(Vector2::<f64>::zeros());
    others.add(Vector2::<f64>::zeros());
    let wrong = SolveError::WrongValues { given: 2, expected: 1 };
    assert_eq!(problem.linearize(&others), Err(wrong));
}

/// A point, seen from a pose, relative to it: Tᵀ P in body coordinates less what was measured.
struct Observation {
    pose: Key<Isometry3<f64>>,
    point: Key<Vector3<f64>>,
    in_body: Vector3<f64>,
}

type PoseAndPoint<'a> = (&'a Isometry3<f64>, &'a Vector3<f64>);

// ANCHOR: pose_and_point
impl Factor<3> for Observation {
    type Variables = (Isometry3<f64>, Vector3<f64>);
    type Jacobians = (Matrix3x6<f64>, Matrix3<f64>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Vector3<f64>>) {
        (self.pose, self.point)
    }

    fn residual(&self, (pose, point): PoseAndPoint) -> Option<Vector3<f64>> {
        Some(se3::transform(&pose.inverse(), point) - self.in_body)
    }

    fn linearize(&self, (pose, point): PoseAndPoint) -> Option<(Vector3<f64>, Self::Jacobians)> {
        let residual = self.residual((pose, point))?;
        let mut by_pose = Matrix3x6::zeros();
        by_pose.fixed_columns_mut::<3>(0).copy_from(&-Matrix3::identity());
        by_pose.fixed_columns_mut::<3>(3).copy_from(&so3::hat(&(residual + self.in_body)));
        let by_point = pose.rotation.inverse().to_rotation_matrix().into_inner();
        Some((residual, (by_pose, by_point)))
    }
}
// ANCHOR_END: pose_and_point

#[test]
fn poses_and_points_are_variables_of_one_problem() {
    let mut draws = Draws::new(8);
    let true_poses: Vec<_> = (0..3).map(|_| se3::exp(&draws.vector())).collect();
    let true_points: Vec<_> = (0..5).map(|_| 3.0 * draws.vector::<3>()).collect();
    let mut problem = Problem::new();
    let mut poses = vec![problem.add_variable(true_poses[0])];
    problem.hold(poses[0]).unwrap();
    for pose in &true_poses[1..] {
        poses.push(problem.add_variable(se3::retract(pose, &(0.2 * draws.vector::<6>()))));
    }
    let mut points = Vec::new();
    for true_point in &true_points {
        let point = problem.add_variable(true_point + 0.3 * draws.vector::<3>());
        for (&pose, true_pose) in poses.iter().zip(&true_poses) {
            let in_body = se3::transform(&true_pose.inverse(), true_point);
            let observation = Observation { pose, point, in_body };
            problem.add_factor(observation, Kernel::Huber(1.0)).unwrap();
        }
        points.push(point);
    }
    let solution = problem.solve(&Options::default()).unwrap();
    assert_eq!(problem.null_space(&solution.values).unwrap().nullity(), 0);
    for (pose, true_pose) in poses.into_iter().zip(&true_poses) {
        assert!(se3::local(&solution.values[pose], true_pose).norm() < 1e-7);
    }
    for (point, true_point) in points.into_iter().zip(&true_points) {
        assert!((solution.values[point] - true_point).norm() < 1e-7);
    }
    assert_eq!(solution.values.of_kind::<Isometry3<f64>>().len(), 3);
    assert_eq!(solution.values.of_kind::<Vector3<f64>>().len(), 5);
}

#[test]
fn a_search_that_begins_without_a_value_is_refused_by_every_linear_system() {
    let (mut problem, _) = scalar(1.0, |x| Some((x, 1.0)));
    let number = problem.add_variable(Vector1::new(-1.0));
    problem.hold(number).unwrap();
    let function = |x: f64| (x > 0.0).then(|| (x.ln(), 1.0 / x));
    problem.add_factor(Scalar { number, function }, Kernel::Squared).unwrap();
    let of_landmarks = |problem: &Problem| {
        let system = LandmarkElimination::<1>::new::<Vector3<f64>>(problem)?;
        problem.solve_with(system, &Options::default())
    };
    assert_eq!(of_landmarks(&problem).unwrap_err(), SolveError::Undefined { factor: 1 });
    assert_eq!(
        problem.solve(&Options::default()).unwrap_err(),
        SolveError::Undefined { factor: 1 }
    );

    let (problem, _) = scalar(1.0, |_| Some((1.0, f64::NAN)));
    assert_eq!(of_landmarks(&problem).unwrap_err(), SolveError::NotFinite { factor: 0 });
}

#[test]
fn a_problem_that_landmarks_cannot_be_eliminated_from_is_refused_by_name() {
    let mut problem = Problem::new();
    let point = problem.add_variable(Vector2::<f64>::zeros());
    let none = LandmarkElimination::<2>::new::<Vector3<f64>>(&problem);
    assert_eq!(none.unwrap_err(), SolveError::NoFactors);
    let prior =
        Prior { variable: point, anchor: Vector2::x(), sqrt_information: Matrix2::identity() };
    problem.add_factor(prior, Kernel::Squared).unwrap();
    let flat = LandmarkElimination::<6>::new::<Vector2<f64>>(&problem);
    assert_eq!(flat.unwrap_err(), SolveError::Block { variable: 0, found: 2, dimension: 6 });
}
