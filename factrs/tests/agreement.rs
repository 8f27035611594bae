//! On identical factors factrs finds what the book's library finds. With its own preintegrator it finds something near.

use std::panic::{AssertUnwindSafe, catch_unwind};

use factrs::containers::ValuesOrder;
use factrs::core::{GaussNewton, Graph as TheirGraph, Values};
use factrs::traits::Optimizer;
use factrs_graph::graph::{self, GyroNoise};
use factrs_graph::identical;
use factrs_graph::two_keyframes::{Estimate, Graph, HUBER, Scene};
use nalgebra::DMatrix;
use vislam::least_squares::{Kernel, SolveError, Spectrum};

const SEEDS: u64 = 20;

fn ours(scene: &Scene) -> Graph {
    Graph::new(scene, Kernel::Huber(HUBER)).unwrap()
}

/// The largest difference between two estimates, and the largest in standard deviations.
fn apart(scene: &Scene, first: &Estimate, second: &Estimate) -> (f64, f64) {
    let (step, bound) = (first.step_to(second), Graph::bound(scene).unwrap());
    let sigmas = step.iter().zip(&bound).map(|(step, variance)| step.abs() / variance.sqrt());
    (step.iter().fold(0.0, |most, step| step.abs().max(most)), sigmas.fold(0.0, f64::max))
}

#[test]
fn identical_factors_cost_the_same_wherever_they_are_asked() {
    for scene in (0..SEEDS).map(Scene::drawn) {
        let (ours, theirs) = (ours(&scene), identical::graph(&scene));
        let mut truth = scene.truth.clone();
        // Their prior of a pose is ours where turn or place is as it is known.
        truth.states[0].position = scene.known_state.position;
        for at in [&scene.guess, &truth] {
            let [cost, their_cost] =
                [ours.problem.cost(&ours.values(at)), theirs.error(&graph::values(at))];
            assert!((cost - their_cost).abs() < 1e-9 * cost, "{cost} here and {their_cost} there");
        }
    }
}

#[test]
fn identical_factors_have_their_minimum_at_the_same_place() {
    for scene in (0..SEEDS).map(Scene::drawn) {
        let theirs = graph::solve_exactly(identical::graph(&scene), &scene.guess).unwrap();
        let (most, sigmas) = apart(&scene, &ours(&scene).solved().unwrap(), &theirs);
        assert!(most < 1e-6, "{most:e}");
        assert!(sigmas < 1e-6, "{sigmas:e}");
    }
}

#[test]
fn the_default_stop_comes_within_a_thousandth_of_a_standard_deviation() {
    for scene in (0..SEEDS).map(Scene::drawn) {
        let theirs = graph::solve(identical::graph(&scene), &scene.guess).unwrap();
        let (_, sigmas) = apart(&scene, &ours(&scene).solved().unwrap(), &theirs);
        assert!(sigmas < 5e-3, "{sigmas:e}");
    }
}

#[test]
fn the_preintegrator_of_factrs_comes_near_when_the_noise_of_the_gyroscope_is_moved() {
    let mean = |gyro| {
        let apart = (0..SEEDS).map(Scene::drawn).map(|scene| {
            let theirs = graph::solve_exactly(graph::graph(&scene, gyro), &scene.guess).unwrap();
            apart(&scene, &ours(&scene).solved().unwrap(), &theirs).1
        });
        apart.sum::<f64>() / SEEDS as f64
    };
    let [named, moved] = [GyroNoise::Named, GyroNoise::Moved].map(mean);
    assert!(moved < 0.15, "{moved} standard deviations");
    assert!(named > 4.0 * moved, "{named} standard deviations, {moved} when it is moved");
}

/// The whitened Jacobian of dual numbers.
fn jacobian(graph: &TheirGraph, values: &Values) -> DMatrix<f64> {
    let order = ValuesOrder::from_values(values);
    let rows = graph.iter().map(|factor| factor.dim_out()).sum();
    let (mut jacobian, mut row) = (DMatrix::zeros(rows, order.dim()), 0);
    for factor in graph.iter() {
        let linear = factor.linearize(values);
        for (number, key) in linear.keys.iter().enumerate() {
            let (block, column) = (linear.a.get_block(number), order.get(*key).unwrap().idx);
            for (i, j) in (0..block.nrows()).flat_map(|i| (0..block.ncols()).map(move |j| (i, j))) {
                jacobian[(row + i, column + j)] = block[(i, j)];
            }
        }
        row += factor.dim_out();
    }
    jacobian
}

#[test]
fn without_priors_the_jacobian_of_dual_numbers_is_singular_by_ten() {
    let scene = Scene::exact();
    let values = graph::values(&scene.truth);
    let jacobian = jacobian(&identical::measured(&scene, HUBER), &values);
    assert_eq!(jacobian.shape(), (39, 48));
    assert_eq!(Spectrum::of(&jacobian).unwrap().null_space().nullity(), 10);
    let with_priors = self::jacobian(&identical::graph(&scene), &values);
    assert_eq!(Spectrum::of(&with_priors).unwrap().null_space().nullity(), 0);
}

#[test]
fn without_priors_ours_says_what_is_free_and_factrs_panics() {
    let scene = Scene::exact();
    let measured = Graph::measured(&scene, Kernel::Squared).unwrap();
    let mut there = Graph::measured(&scene, Kernel::Squared).unwrap();
    there.problem.set_values(measured.values(&scene.truth)).unwrap();
    let refused = there.problem.covariance(there.problem.values()).err();
    assert!(matches!(refused, Some(SolveError::Singular(system)) if system.free == 10));

    let graph = identical::measured(&scene, HUBER);
    let search = || {
        let mut search = GaussNewton::new_default(graph);
        let values = graph::values(&scene.guess);
        search.init(&values);
        search.step(values, 0).map(|_| ())
    };
    assert!(catch_unwind(AssertUnwindSafe(search)).is_err());
}
