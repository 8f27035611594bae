//! What a problem can move, what it holds, and what it moves together.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Matrix6, Rotation3, SMatrix, Vector2, Vector3, Vector6,
};
use vislam::bundle_adjustment::{BalCamera, Posed, PosedPinhole};
use vislam::factors::{MovingCamera, Prior};
use vislam::inertial::{Gravity, ImuBias, NavState};
use vislam::least_squares::{
    Factor, Kernel, Key, Manifold, Options, Problem, ProblemError, SolveError, Values,
};
use vislam::manifold::{se3, so3};
use vislam::reprojection::Pinhole;

use super::{Draws, Linear, Observation, distances, loop_of_poses};

const PINHOLE: Pinhole = Pinhole { fx: 400.0, fy: 410.0, cx: 320.0, cy: 240.0 };

fn local<V: Manifold>(from: &V, to: &V) -> DVector<f64> {
    let mut step = DVector::zeros(from.dimension());
    from.local(to, step.as_mut_slice());
    step
}

fn random_step(dimension: usize, draws: &mut Draws) -> DVector<f64> {
    DVector::from_fn(dimension, |_, _| draws.number())
}

/// Everything that is asked of a kind of variable.
fn is_a_manifold<V: Manifold>(draw: impl Fn(&mut Draws) -> V) {
    let mut draws = Draws::new(20);
    for _ in 0..100 {
        let value = draw(&mut draws);
        let dimension = value.dimension();
        let zero = DVector::zeros(dimension);
        assert!(local(&value, &value.retract(zero.as_slice())).amax() < 1e-14, "stays at zero");

        let step = random_step(dimension, &mut draws);
        let to = value.retract(step.as_slice());
        assert_eq!(to.dimension(), dimension);
        assert_abs_diff_eq!(local(&value, &to), step, epsilon = 1e-11);

        let mut jacobian = DMatrix::zeros(dimension, dimension);
        value.local_jacobian(&to, jacobian.as_mut_slice());
        for axis in 0..dimension {
            let moved = |size: f64| {
                let mut step = zero.clone();
                step[axis] = size;
                local(&value, &to.retract(step.as_slice()))
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert_abs_diff_eq!(slope, jacobian.column(axis).into_owned(), epsilon = 1e-7);
        }
    }
}

#[test]
fn gravity_keeps_its_length_and_local_undoes_its_retract() {
    is_a_manifold(|draws| Gravity(9.81 * draws.vector::<3>().normalize()));
    assert_eq!(Gravity(Vector3::zeros()).retract(&[0.1, 0.2]), Gravity(Vector3::zeros()));
    assert_eq!(Gravity(Vector3::zeros()).by_step().amax(), 0.0);
    let mut draws = Draws::new(21);
    for _ in 0..100 {
        let gravity = Gravity(9.81 * draws.vector::<3>().normalize());
        let moved = gravity.retract(draws.vector::<2>().as_slice());
        assert_abs_diff_eq!(moved.0.norm(), 9.81, epsilon = 1e-13);
        let slope = |axis: usize, size: f64| {
            let mut step = [0.0; 2];
            step[axis] = size;
            gravity.retract(&step).0
        };
        for axis in 0..2 {
            let slope = (slope(axis, 1e-5) - slope(axis, -1e-5)) / 2e-5;
            assert_abs_diff_eq!(slope, gravity.by_step().column(axis).into_owned(), epsilon = 1e-8);
        }
    }
}

#[test]
fn local_undoes_retract_and_its_jacobian_is_its_derivative_for_vectors_and_biases() {
    is_a_manifold(|draws| draws.vector::<4>());
    is_a_manifold(|draws| ImuBias::from_vector(&draws.vector()));
}

#[test]
fn local_undoes_retract_and_its_jacobian_is_its_derivative_for_rotations_and_poses() {
    is_a_manifold(|draws| so3::exp(&(2.0 * draws.vector())));
    is_a_manifold(|draws| se3::exp(&(2.0 * draws.vector())));
}

fn state(draws: &mut Draws) -> NavState {
    NavState {
        world_from_body: so3::exp(&(2.0 * draws.vector())),
        velocity: 3.0 * draws.vector::<3>(),
        position: 5.0 * draws.vector::<3>(),
    }
}

#[test]
fn local_undoes_retract_and_its_jacobian_is_its_derivative_for_states() {
    is_a_manifold(state);
}

fn camera(draws: &mut Draws) -> PosedPinhole {
    Posed { intrinsics: PINHOLE, camera_from_world: se3::exp(&(2.0 * draws.vector())) }
}

#[test]
fn local_undoes_retract_and_its_jacobian_is_its_derivative_for_cameras() {
    is_a_manifold(|draws| MovingCamera::<_, 6>(camera(draws)));
    is_a_manifold(|draws| {
        let vector = draws.vector::<9>();
        let radial = [0.01 * vector[7], 0.001 * vector[8]];
        let rotation = Rotation3::new(vector.fixed_rows::<3>(0).into_owned());
        let translation = vector.fixed_rows::<3>(3).into_owned();
        let focal_length = 500.0 + 100.0 * vector[6];
        MovingCamera::<BalCamera, 9>(BalCamera { rotation, translation, focal_length, radial })
    });
}

#[test]
fn poses_and_rotations_move_on_the_right_and_vectors_by_addition() {
    let mut draws = Draws::new(9);
    let (pose, step): (Isometry3<f64>, Vector6<f64>) = (se3::exp(&draws.vector()), draws.vector());
    assert_relative_eq!(pose.retract(step.as_slice()), pose * se3::exp(&step), epsilon = 1e-15);
    let (rotation, turn): (_, Vector3<f64>) = (so3::exp(&draws.vector()), draws.vector());
    assert_relative_eq!(rotation.retract(turn.as_slice()), rotation * so3::exp(&turn));
    assert_eq!(Vector2::new(1.0, 2.0).retract(&[0.5, -0.5]), Vector2::new(1.5, 1.5));
}

#[test]
fn values_of_several_kinds_move_and_are_compared_together() {
    let mut draws = Draws::new(21);
    let mut values = Values::new();
    values.add(draws.vector::<2>());
    let pose = values.add(se3::exp(&draws.vector()));
    let last = values.add(draws.vector::<2>());
    assert_eq!(values.coordinates_of(last.index()), Some(8..10));
    let step = random_step(values.dimension(), &mut draws);
    let moved = values.retract(step.as_slice());
    let back = DVector::from_vec(values.local(&moved));
    assert_abs_diff_eq!(back, step, epsilon = 1e-13);
    assert_eq!(moved[pose], values[pose].retract(&step.as_slice()[2..8]));
    assert!(values.fits(&moved));
    assert_eq!(values.key::<Vector2<f64>>(2), Some(last));
    assert_eq!(values.key::<Vector2<f64>>(1), None, "that is a pose");
}

#[test]
fn a_value_of_another_dimension_is_not_taken() {
    let mut values = Values::new();
    let group = values.add(PoseAndLandmarks::at_origin(2));
    assert!(!values.set(group, PoseAndLandmarks::at_origin(3)));
    assert!(values.set(group, PoseAndLandmarks::at_origin(2)));
}

#[test]
fn held_coordinates_do_not_move_and_have_no_column() {
    let mut draws = Draws::new(22);
    let (start, anchor) = (state(&mut draws), state(&mut draws));
    let mut problem = Problem::new();
    let body = problem.add_variable(start);
    let other = problem.add_variable(draws.vector::<3>());
    problem.hold_coordinates(body, 3..6).unwrap();
    let sqrt_information = SMatrix::<f64, 9, 9>::identity();
    let prior = Prior { variable: body, anchor, sqrt_information };
    problem.add_factor(prior, Kernel::Squared).unwrap();
    let prior =
        Prior { variable: other, anchor: Vector3::zeros(), sqrt_information: Matrix3::identity() };
    problem.add_factor(prior, Kernel::Squared).unwrap();

    let columns = problem.columns();
    assert_eq!(columns.count, 9);
    assert_eq!(columns.of[3..6], [None; 3]);
    assert_eq!(columns.of[6..12], [3, 4, 5, 6, 7, 8].map(Some));
    let found = problem.solve(&Options::default()).unwrap().values;
    assert_eq!(found[body].velocity, start.velocity);
    assert_abs_diff_eq!(found[body].position, anchor.position, epsilon = 1e-7);
    assert_abs_diff_eq!(found[other], Vector3::zeros(), epsilon = 1e-7);
    let covariance = problem.covariance(&found).unwrap();
    assert_eq!(covariance.of(body).unwrap().shape(), (6, 6));
    assert_eq!(covariance.between(body, other).unwrap().shape(), (6, 3));
}

#[test]
fn a_coordinate_that_does_not_exist_cannot_be_held() {
    let mut problem = Problem::new();
    let spot = problem.add_variable(Vector2::<f64>::zeros());
    let refused = problem.hold_coordinates(spot, 1..3);
    assert_eq!(refused, Err(ProblemError::NoSuchCoordinate { coordinate: 2, dimension: 2 }));
    let backwards = std::ops::Range { start: 2, end: 1 };
    assert_eq!(problem.hold_coordinates(spot, backwards), Ok(()));
}

/// Three vectors and linear measurements of them, enough for all or for fewer.
fn three_vectors(seed: u64) -> (Problem, [Key<Vector3<f64>>; 3]) {
    let mut draws = Draws::new(seed);
    let mut problem = Problem::new();
    let vectors = [(); 3].map(|()| problem.add_variable(draws.vector::<3>()));
    for _ in 0..6 {
        let blocks = [(); 3].map(|()| Matrix3::from_fn(|_, _| draws.number()));
        let linear = Linear { vectors, blocks, measured: draws.vector() };
        problem.add_factor(linear, Kernel::Squared).unwrap();
    }
    (problem, vectors)
}

#[test]
fn tied_variables_move_by_the_same_step_and_share_their_columns() {
    for (follower, leader) in [(0, 1), (2, 0), (1, 2)] {
        let (free, _) = three_vectors(23);
        let (separate, residual) = free.jacobian(free.values()).unwrap();
        let (mut tied, vectors) = three_vectors(23);
        tied.tie(vectors[follower], vectors[leader]).unwrap();
        let columns = tied.columns();
        let shared = |vector: usize| &columns.of[3 * vector..3 * vector + 3];
        assert_eq!(columns.count, 6);
        assert_eq!(shared(follower), shared(leader));

        // By hand: the columns of both are added.
        let mut jacobian = DMatrix::zeros(18, 6);
        for (coordinate, column) in columns.of.iter().enumerate() {
            let mut sum = jacobian.column_mut(column.unwrap());
            sum += separate.column(coordinate);
        }
        let solution = tied.solve(&Options::gauss_newton()).unwrap();
        let step = -jacobian.svd(true, true).solve(&residual, 1e-14).unwrap();
        for (vector, key) in vectors.into_iter().enumerate() {
            let moved = solution.values[key] - tied.values()[key];
            let expected = step.fixed_rows::<3>(shared(vector)[0].unwrap());
            assert_abs_diff_eq!(moved, expected.into_owned(), epsilon = 1e-12);
        }
    }
}

#[test]
fn a_variable_that_is_tied_to_one_that_is_held_is_held() {
    let (mut problem, vectors) = three_vectors(24);
    problem.hold(vectors[1]).unwrap();
    problem.tie(vectors[0], vectors[1]).unwrap();
    let solution = problem.solve(&Options::gauss_newton()).unwrap();
    for vector in &vectors[..2] {
        assert_eq!(solution.values[*vector], problem.values()[*vector]);
    }
    assert_ne!(solution.values[vectors[2]], problem.values()[vectors[2]]);
}

#[test]
fn whichever_of_tied_variables_is_held_holds_them_all() {
    let (mut problem, vectors) = three_vectors(24);
    problem.tie(vectors[0], vectors[1]).unwrap();
    problem.hold(vectors[0]).unwrap();
    let solution = problem.solve(&Options::gauss_newton()).unwrap();
    for vector in &vectors[..2] {
        assert_eq!(solution.values[*vector], problem.values()[*vector]);
    }
}

#[test]
fn poses_on_one_rig_keep_what_is_between_them() {
    let (mut problem, poses, _) = loop_of_poses(5, 0.0);
    problem.hold(poses[0]).unwrap();
    problem.tie(poses[2], poses[1]).unwrap();
    let before = problem.values();
    let solution = problem.solve(&Options::default()).unwrap();
    let step = |pose| se3::local(&before[pose], &solution.values[pose]);
    assert!(step(poses[1]).norm() > 0.01);
    assert_abs_diff_eq!(step(poses[1]), step(poses[2]), epsilon = 1e-12);
}

#[test]
fn variables_of_other_dimensions_cannot_be_tied() {
    let mut problem = Problem::new();
    let small = problem.add_variable(PoseAndLandmarks::at_origin(1));
    let large = problem.add_variable(PoseAndLandmarks::at_origin(2));
    assert_eq!(problem.tie(small, large), Err(ProblemError::Tied { own: 9, other: 12 }));
}

#[test]
fn the_factors_of_each_kind_of_variable_meet_in_one_system() {
    // A pose and a point that know nothing of each other: the Hessian has two blocks.
    let mut draws = Draws::new(25);
    let mut problem = Problem::new();
    let pose = problem.add_variable(se3::exp(&draws.vector()));
    let point = problem.add_variable(draws.vector::<3>());
    let anchor = problem.values()[pose];
    let prior = Prior { variable: pose, anchor, sqrt_information: Matrix6::identity() };
    problem.add_factor(prior, Kernel::Squared).unwrap();
    let prior = Prior {
        variable: point,
        anchor: Vector3::zeros(),
        sqrt_information: 2.0 * Matrix3::identity(),
    };
    problem.add_factor(prior, Kernel::Squared).unwrap();
    let mut expected = DMatrix::identity(9, 9);
    expected.view_mut((6, 6), (3, 3)).fill_diagonal(4.0);
    let hessian = problem.linearize(problem.values()).unwrap().hessian;
    assert_abs_diff_eq!(hessian, expected, epsilon = 1e-12);

    // An observation couples them, and nothing else.
    let observation = Observation { pose, point, in_body: draws.vector() };
    let (here, there) = (problem.values()[pose], problem.values()[point]);
    let (_, (by_pose, by_point)) = observation.linearize((&here, &there)).unwrap();
    problem.add_factor(observation, Kernel::Squared).unwrap();
    let hessian = problem.linearize(problem.values()).unwrap().hessian;
    let coupling = hessian.fixed_view::<6, 3>(0, 6).into_owned();
    assert_abs_diff_eq!(coupling, by_pose.transpose() * by_point, epsilon = 1e-12);
}

/// A pose and landmarks that retract together, as many as there are: the right-invariant group of
/// filters. A step (φ, ρ₀, ρ₁, …) moves it on the left, in the world: each position p becomes
/// exp(φ) p + J(φ) ρ, with the left Jacobian J.
#[derive(Debug, Clone, PartialEq)]
struct PoseAndLandmarks {
    world_from_body: Rotation3<f64>,
    /// Where the body is, and then where the landmarks are.
    positions: Vec<Vector3<f64>>,
}

impl PoseAndLandmarks {
    fn at_origin(landmarks: usize) -> Self {
        let positions = vec![Vector3::zeros(); 1 + landmarks];
        Self { world_from_body: Rotation3::identity(), positions }
    }
}

impl Manifold for PoseAndLandmarks {
    fn dimension(&self) -> usize {
        3 + 3 * self.positions.len()
    }

    fn retract(&self, step: &[f64]) -> Self {
        let phi = Vector3::from_column_slice(&step[..3]);
        let (turn, along) = (so3::exp(&phi), so3::left_jacobian(&phi));
        let moved = |(position, rho): (&Vector3<f64>, &[f64])| {
            turn * position + along * Vector3::from_column_slice(rho)
        };
        Self {
            world_from_body: turn * self.world_from_body,
            positions: self.positions.iter().zip(step[3..].chunks(3)).map(moved).collect(),
        }
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        let turn = to.world_from_body * self.world_from_body.inverse();
        let phi = so3::log(&turn);
        step[..3].copy_from_slice(phi.as_slice());
        let back = so3::left_jacobian_inverse(&phi);
        let pairs = self.positions.iter().zip(&to.positions);
        for (rho, (from, to)) in step[3..].chunks_mut(3).zip(pairs) {
            rho.copy_from_slice((back * (to - turn * from)).as_slice());
        }
    }

    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        let mut step = vec![0.0; self.dimension()];
        self.local(to, &mut step);
        let phi = Vector3::from_column_slice(&step[..3]);
        let mut jacobian = DMatrix::zeros(step.len(), step.len());
        let by_phi = so3::left_jacobian_inverse(&phi);
        jacobian.view_mut((0, 0), (3, 3)).copy_from(&by_phi);
        for at in (3..step.len()).step_by(3) {
            let twist = Vector6::from_row_slice(&[&step[at..at + 3], &step[..3]].concat());
            let of_pose = se3::left_jacobian_inverse(&twist);
            jacobian.view_mut((at, at), (3, 3)).copy_from(&of_pose.fixed_view::<3, 3>(0, 0));
            jacobian.view_mut((at, 0), (3, 3)).copy_from(&of_pose.fixed_view::<3, 3>(0, 3));
        }
        into.copy_from_slice(jacobian.as_slice());
    }
}

fn pose_and_landmarks(landmarks: usize, draws: &mut Draws) -> PoseAndLandmarks {
    let world_from_body = so3::exp(&(2.0 * draws.vector()));
    let positions = (0..=landmarks).map(|_| 3.0 * draws.vector::<3>()).collect();
    PoseAndLandmarks { world_from_body, positions }
}

/// Where the body sees one of the landmarks: Rᵀ (l − p). `C` is the dimension of the group.
struct Seen<const C: usize> {
    group: Key<PoseAndLandmarks>,
    landmark: usize,
    in_body: Vector3<f64>,
}

impl<const C: usize> Factor<3> for Seen<C> {
    type Variables = (PoseAndLandmarks,);
    type Jacobians = (SMatrix<f64, 3, C>,);

    fn variables(&self) -> (Key<PoseAndLandmarks>,) {
        (self.group,)
    }

    fn residual(&self, (group,): (&PoseAndLandmarks,)) -> Option<Vector3<f64>> {
        let away = group.positions.get(1 + self.landmark)? - group.positions[0];
        Some(group.world_from_body.inverse() * away - self.in_body)
    }

    fn linearize(
        &self,
        (group,): (&PoseAndLandmarks,),
    ) -> Option<(Vector3<f64>, (SMatrix<f64, 3, C>,))> {
        // The turn of the group turns the body and what it sees alike.
        let body_from_world = group.world_from_body.inverse().into_inner();
        let mut by_group = SMatrix::<f64, 3, C>::zeros();
        by_group.fixed_view_mut::<3, 3>(0, 3).copy_from(&-body_from_world);
        let mut by_landmark = by_group.fixed_view_mut::<3, 3>(0, 6 + 3 * self.landmark);
        by_landmark.copy_from(&body_from_world);
        Some((self.residual((group,))?, (by_group,)))
    }
}

/// A group of three landmarks, all of them seen.
fn seen_group(
    start: PoseAndLandmarks,
    truth: &PoseAndLandmarks,
) -> (Problem, Key<PoseAndLandmarks>) {
    let mut problem = Problem::new();
    let group = problem.add_variable(start);
    for landmark in 0..3 {
        let away = truth.positions[1 + landmark] - truth.positions[0];
        let in_body = truth.world_from_body.inverse() * away;
        problem.add_factor(Seen::<15> { group, landmark, in_body }, Kernel::Squared).unwrap();
    }
    (problem, group)
}

#[test]
fn a_group_of_any_size_is_one_variable() {
    for landmarks in 0..4 {
        is_a_manifold(|draws| pose_and_landmarks(landmarks, draws));
    }
}

#[test]
fn a_group_is_found_from_what_the_body_sees_and_a_prior_on_all_of_it() {
    let mut draws = Draws::new(26);
    let truth = pose_and_landmarks(3, &mut draws);
    let start = truth.retract((0.5 * random_step(15, &mut draws)).as_slice());
    let (mut problem, group) = seen_group(start, &truth);
    let sqrt_information = SMatrix::<f64, 15, 15>::identity();
    let prior = Prior { variable: group, anchor: truth.clone(), sqrt_information };
    problem.add_factor(prior, Kernel::Squared).unwrap();
    let solution = problem.solve(&Options::default()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    assert!(local(&truth, &solution.values[group]).norm() < 1e-7);
}

#[test]
fn what_is_free_of_a_group_is_the_same_wherever_it_is() {
    let mut draws = Draws::new(27);
    let truth = pose_and_landmarks(3, &mut draws);
    for _ in 0..5 {
        let (problem, _) = seen_group(pose_and_landmarks(3, &mut draws), &truth);
        let null_space = problem.null_space(problem.values()).unwrap();
        assert_eq!(null_space.nullity(), 6);
        for axis in 0..3 {
            let turn = DVector::from_fn(15, |row, _| f64::from(row == axis));
            let shift = DVector::from_fn(15, |row, _| f64::from(row >= 3 && row % 3 == axis));
            assert!(null_space.leaves(&turn) < 1e-12);
            assert!(null_space.leaves(&shift) < 1e-12);
        }
    }
}

#[test]
fn a_group_of_the_wrong_size_for_its_factor_is_refused() {
    let mut problem = Problem::new();
    let group = problem.add_variable(PoseAndLandmarks::at_origin(2));
    let seen = Seen::<15> { group, landmark: 0, in_body: Vector3::zeros() };
    let refused = problem.add_factor(seen, Kernel::Squared);
    let columns = ProblemError::Columns { factor: 0, slot: 0, columns: 15, dimension: 12 };
    assert_eq!(refused, Err(columns));
}

#[test]
fn factors_of_one_type_keep_their_numbers_whatever_stands_between_them() {
    let (mut problem, points) = distances(&[Vector3::zeros(), Vector3::x(), Vector3::y()]);
    let prior = Prior {
        variable: points[0],
        anchor: Vector3::zeros(),
        sqrt_information: Matrix3::identity(),
    };
    assert_eq!(problem.add_factor(prior, Kernel::Squared), Ok(3));
    let twin = super::Distance { points: [points[0], points[1]], measured: f64::NAN };
    assert_eq!(problem.add_factor(twin, Kernel::Squared), Ok(4));
    let error = problem.linearize(problem.values()).unwrap_err();
    assert_eq!(error, SolveError::NotFinite { factor: 4 });
}
