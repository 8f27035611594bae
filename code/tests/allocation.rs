//! A search takes its memory once. What an iteration allocates would be noticed by whoever has to
//! be ready for the next picture.

use nalgebra::{Isometry3, Matrix3, Matrix3x6, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::least_squares::{
    Dense, Factor, Kernel, Key, LandmarkElimination, LinearSystem, Options, Problem, Search,
};
use vislam::manifold::{se3, so3};

/// Where a body sees a point.
struct Sighting {
    pose: Key<Isometry3<f64>>,
    point: Key<Vector3<f64>>,
    in_body: Vector3<f64>,
}

impl Factor<3> for Sighting {
    type Variables = (Isometry3<f64>, Vector3<f64>);
    type Jacobians = (Matrix3x6<f64>, Matrix3<f64>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Vector3<f64>>) {
        (self.pose, self.point)
    }

    fn residual(&self, (pose, point): (&Isometry3<f64>, &Vector3<f64>)) -> Option<Vector3<f64>> {
        Some(se3::transform(&pose.inverse(), point) - self.in_body)
    }

    fn linearize(
        &self,
        (pose, point): (&Isometry3<f64>, &Vector3<f64>),
    ) -> Option<(Vector3<f64>, (Matrix3x6<f64>, Matrix3<f64>))> {
        let residual = self.residual((pose, point))?;
        let mut by_pose = Matrix3x6::zeros();
        by_pose.fixed_columns_mut::<3>(0).copy_from(&-Matrix3::identity());
        by_pose.fixed_columns_mut::<3>(3).copy_from(&so3::hat(&(residual + self.in_body)));
        let by_point = pose.rotation.inverse().to_rotation_matrix().into_inner();
        Some((residual, (by_pose, by_point)))
    }
}

/// Six poses that see forty points, with noise, a first pose that is held and a wide start: some
/// steps are refused.
fn poses_and_points() -> Problem {
    let mut draws = ChaCha8Rng::seed_from_u64(50);
    let mut number = move || draws.random_range(-1.0..1.0);
    let mut problem = Problem::new();
    let truth: Vec<_> =
        (0..6).map(|_| se3::exp(&Vector6::from_fn(|_, _| number()))).collect();
    let mut poses = Vec::new();
    for (index, pose) in truth.iter().enumerate() {
        let off = if index == 0 { 0.0 } else { 1.5 };
        let start = se3::retract(pose, &(off * Vector6::from_fn(|_, _| number())));
        poses.push(problem.add_variable(start));
    }
    problem.hold(poses[0]).unwrap();
    for _ in 0..40 {
        let place = 4.0 * Vector3::from_fn(|_, _| number());
        let point = problem.add_variable(place + Vector3::from_fn(|_, _| number()));
        for (pose, truth) in poses.iter().zip(&truth) {
            let noise = 0.01 * Vector3::from_fn(|_, _| number());
            let in_body = se3::transform(&truth.inverse(), &place) + noise;
            let sighting = Sighting { pose: *pose, point, in_body };
            problem.add_factor(sighting, Kernel::Huber(1.345)).unwrap();
        }
    }
    problem
}

/// How often each iteration of a search allocates, from the second on.
fn each_iteration<S: LinearSystem>(problem: &Problem, system: S) -> Vec<u64> {
    let tight = Options { decrease_tolerance: 0.0, ..Options::default() };
    let mut search = Search::new(problem, system, &tight).unwrap();
    let mut counts = Vec::with_capacity(100);
    loop {
        let mut stop = None;
        let counted = allocation_counter::measure(|| stop = search.iterate(problem).unwrap());
        if stop.is_some() {
            break;
        }
        counts.push(counted.count_total);
    }
    let iterations = search.iterations();
    assert!(iterations.len() > 5 && iterations.iter().any(|iteration| !iteration.accepted));
    counts.remove(0);
    counts
}

#[test]
fn an_iteration_with_the_landmarks_eliminated_allocates_nothing() {
    let problem = poses_and_points();
    let system = LandmarkElimination::<6>::new::<Vector3<f64>>(&problem).unwrap();
    let counts = each_iteration(&problem, system);
    assert!(counts.iter().all(|count| *count == 0), "{counts:?}");
}

#[test]
fn an_iteration_of_the_dense_system_allocates_nothing() {
    let problem = poses_and_points();
    let counts = each_iteration(&problem, Dense::new(&problem).unwrap());
    assert!(counts.iter().all(|count| *count == 0), "{counts:?}");
}
