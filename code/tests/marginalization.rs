//! What is left of a window when variables leave it, in both forms, and what it costs to forget
//! instead.

#[path = "marginalization/links.rs"]
mod links;
#[path = "marginalization/pattern.rs"]
mod pattern;
#[path = "marginalization/refused.rs"]
mod refused;

use nalgebra::{DMatrix, DVector, Isometry3, Vector3};
use vislam::least_squares::{LinearPrior, Options, Problem};
use vislam::marginalization::{
    Block, Blocks, Couplings, Information, Layout, MarginalizationError, OverConfidence,
    SquareRoot, WindowSigmas, divergence, marginalize,
};

/// Windows in which everything is determined.
fn layouts() -> [(&'static str, Layout); 5] {
    [
        ("chain", Layout::eight_keyframes()),
        ("chain without odometry", Layout::chain(8, 24, 4).without_odometry()),
        ("ring", Layout::ring(8, 12, 4)),
        ("star", Layout::star(8)),
        ("gap", Layout::gap(8, 3)),
    ]
}

/// The window of a layout as measured, in square-root form.
fn window(layout: &Layout, sigmas: &WindowSigmas, seed: u64) -> SquareRoot<f64> {
    let problem = layout.problem(sigmas, seed).unwrap();
    SquareRoot::of_problem(&problem, problem.values()).unwrap()
}

fn usual(layout: &Layout) -> SquareRoot<f64> {
    window(layout, &WindowSigmas::default(), 1)
}

/// The largest singular value of the root over the smallest one.
fn condition(window: &SquareRoot<f64>) -> f64 {
    let singular = window.root().singular_values();
    singular.max() / singular.min()
}

/// Blocks named 0, 1, 2, …
fn blocks(dimensions: &[usize]) -> Blocks {
    let block = |(name, dimension): (usize, &usize)| Block { name, dimension: *dimension };
    Blocks::new(dimensions.iter().enumerate().map(block).collect()).unwrap()
}

/// Numbers with a mean and an information matrix.
fn numbers(matrix: DMatrix<f64>) -> Information<f64> {
    let mean = DVector::from_fn(matrix.nrows(), |row, _| 1.0 + row as f64);
    Information::new(blocks(&vec![1; matrix.nrows()]), matrix.clone(), matrix * mean).unwrap()
}

/// Mean and covariance of some blocks, out of those of all.
fn expected(window: &Information<f64>, names: &[usize]) -> (DVector<f64>, DMatrix<f64>) {
    let columns: Vec<usize> =
        names.iter().flat_map(|name| window.blocks().columns_of(*name).unwrap()).collect();
    let (mean, covariance) = (window.mean().unwrap(), window.covariance().unwrap());
    (mean.select_rows(&columns), covariance.select_rows(&columns).select_columns(&columns))
}

fn names(window: &Information<f64>) -> Vec<usize> {
    window.blocks().names().collect()
}

fn off(found: &DMatrix<f64>, expected: &DMatrix<f64>) -> f64 {
    (found - expected).norm() / expected.norm()
}

#[test]
fn survivors_keep_mean_and_covariance_in_both_forms() {
    for (name, layout) in layouts() {
        let window = usual(&layout);
        let (information, condition) = (window.information(), condition(&window));
        for gone in [vec![0], layout.slide(0), layout.slide(3), vec![layout.landmark(0), 2]] {
            let from_information = marginalize(&information, &gone).unwrap();
            let from_root = window.marginalize(&gone).unwrap().information();
            assert_eq!(from_information.blocks(), from_root.blocks());
            let (mean, covariance) = expected(&information, &names(&from_information));
            for found in [from_information, from_root] {
                let off_covariance = off(&found.covariance().unwrap(), &covariance);
                let off_mean = (found.mean().unwrap() - &mean).norm() / mean.norm();
                let tolerance = 10.0 * f64::EPSILON * condition.powi(2);
                assert!(off_covariance < tolerance, "{name}: {off_covariance:e}");
                assert!(off_mean < tolerance, "{name}: {off_mean:e}");
            }
        }
    }
}

#[test]
fn one_after_the_other_is_as_good_as_all_at_once_in_any_order() {
    for (name, layout) in layouts() {
        let window = usual(&layout);
        let gone = layout.slide(1);
        let reversed: Vec<usize> = gone.iter().rev().copied().collect();
        let information = window.information();
        let at_once = marginalize(&information, &gone).unwrap();
        let mut stepwise = (information.clone(), window.clone());
        for block in &reversed {
            stepwise.0 = marginalize(&stepwise.0, &[*block]).unwrap();
            stepwise.1 = stepwise.1.marginalize(&[*block]).unwrap();
        }
        let others = [
            marginalize(&information, &reversed).unwrap(),
            stepwise.0,
            window.marginalize(&reversed).unwrap().information(),
            stepwise.1.information(),
        ];
        for other in others {
            assert_eq!(at_once.blocks(), other.blocks());
            let off_matrix = off(other.matrix(), at_once.matrix());
            let off_vector = (other.vector() - at_once.vector()).norm() / at_once.vector().norm();
            assert!(off_matrix < 1e-12 && off_vector < 1e-12, "{name}: {off_matrix:e}");
        }
    }
}

#[test]
fn the_order_of_blocks_does_not_matter() {
    let window = usual(&Layout::eight_keyframes());
    let reversed: Vec<usize> = names(&window.information()).into_iter().rev().collect();
    let turned = window.select(&reversed).unwrap();
    let gone = [3, 9, 17];
    let one = marginalize(&window.information(), &gone).unwrap();
    let kept: Vec<usize> = names(&one).into_iter().rev().collect();
    for other in [
        marginalize(&turned.information(), &gone).unwrap(),
        turned.marginalize(&gone).unwrap().information(),
    ] {
        assert_eq!(names(&other), kept);
        assert!(off(other.matrix(), one.select(&kept).unwrap().matrix()) < 1e-13);
    }
}

#[test]
fn the_root_of_a_marginal_is_triangular_and_the_forms_turn_into_each_other() {
    let window = usual(&Layout::eight_keyframes());
    let left = window.marginalize(&[0]).unwrap();
    assert_eq!(left.root().nrows(), left.root().ncols());
    assert_eq!(left.root(), &left.root().upper_triangle());
    let back = SquareRoot::of_information(&left.information()).unwrap();
    let (one, other) = (left.root().abs(), back.root().abs());
    assert!(off(&other, &one) < 1e-10, "roots differ in signs of rows alone");
    assert!((left.offset().abs() - back.offset().abs()).norm() < 1e-8);
    assert!(off(back.information().matrix(), left.information().matrix()) < 1e-14);
}

#[test]
fn what_leaves_a_window_without_having_been_determined_takes_only_what_is_known_with_it() {
    // Two numbers are measured by their difference alone; a third one by its difference from the second.
    let rows = DMatrix::from_row_slice(2, 3, &[-1.0, 1.0, 0.0, 0.0, -1.0, 1.0]);
    let offset = DVector::from_vec(vec![0.3, 0.4]);
    let window = SquareRoot::new(blocks(&[1, 1, 1]), rows, offset).unwrap();
    for left in [
        marginalize(&window.information(), &[1]).unwrap(),
        window.marginalize(&[1]).unwrap().information(),
    ] {
        let difference = DMatrix::from_row_slice(2, 2, &[0.5, -0.5, -0.5, 0.5]);
        assert!((left.matrix() - &difference).norm() < 1e-15);
        assert!((left.vector() - DVector::from_vec(vec![0.35, -0.35])).norm() < 1e-15);
        let refused = left.mean();
        assert!(
            matches!(refused, Err(MarginalizationError::Singular { name: 2, .. })),
            "{refused:?}"
        );
    }
}

// ANCHOR: precision
/// How far the covariance of the survivors is off, by form, in single precision, and whether it is one.
fn single_precision(window: &SquareRoot<f64>, gone: &[usize]) -> [Option<f64>; 2] {
    let truth = window.marginalize(gone).unwrap();
    let covariance = |root: &DMatrix<f64>| {
        let identity = DMatrix::identity(root.ncols(), root.ncols());
        let inverse = root.solve_upper_triangular(&identity)?;
        Some(&inverse * inverse.transpose())
    };
    let truth = covariance(truth.root()).unwrap();
    let single = window.cast::<f32>();
    let root = single.marginalize(gone).unwrap().cast::<f64>();
    let hessian = marginalize(&single.information(), gone).unwrap().cast::<f64>();
    let of_hessian = hessian.matrix().clone().cholesky().map(|factor| factor.inverse());
    [of_hessian, covariance(root.root())].map(|found| Some(off(&found?, &truth)))
}
// ANCHOR_END: precision

/// The median of what twenty windows of the chapter give when their first keyframe is known to
/// `sigma`: the condition number, and the errors of both forms where they have one.
fn medians(sigma: f64) -> (f64, [Vec<f64>; 2]) {
    let layout = Layout::eight_keyframes();
    let sigmas = WindowSigmas { first_keyframe: sigma, ..WindowSigmas::default() };
    let mut conditions = Vec::new();
    let mut errors = [Vec::new(), Vec::new()];
    for seed in 0..20 {
        let window = window(&layout, &sigmas, seed);
        conditions.push(condition(&window));
        let found = single_precision(&window, &layout.slide(0));
        errors.iter_mut().zip(found).for_each(|(errors, found)| errors.extend(found));
    }
    errors.iter_mut().for_each(|errors| errors.sort_by(f64::total_cmp));
    conditions.sort_by(f64::total_cmp);
    (conditions[10], errors)
}

#[test]
fn in_single_precision_the_hessian_loses_digits_with_the_square_of_the_condition_and_the_root_does_not()
 {
    let (well, [hessian_well, root_well]) = medians(0.03);
    let (badly, [hessian_badly, root_badly]) = medians(0.3);
    let digits = (badly / well).log10();
    let lost = |well: &[f64], badly: &[f64]| (badly[10] / well[10]).log10() / digits;
    let (hessian, root) = (lost(&hessian_well, &hessian_badly), lost(&root_well, &root_badly));
    println!(
        "conditions {well:.1e} and {badly:.1e}: Hessian loses {hessian:.2} digits for one, root {root:.2}"
    );
    println!(
        "errors: Hessian {:.1e} {:.1e}, root {:.1e} {:.1e}",
        hessian_well[10], hessian_badly[10], root_well[10], root_badly[10]
    );
    assert!((1.6..2.4).contains(&hessian), "{hessian}");
    assert!((0.6..1.4).contains(&root), "{root}");
}

#[test]
fn where_the_condition_is_worse_the_single_precision_hessian_is_no_gaussian_and_the_root_still_is()
{
    let (condition, [hessian, root]) = medians(10.0);
    println!("condition {condition:.1e}: {} Hessians, root {:.1e}", hessian.len(), root[10]);
    assert!((1e5..1e7).contains(&condition), "{condition:e}");
    assert!(hessian.len() <= 2, "{} of 20 are positive definite", hessian.len());
    assert_eq!(root.len(), 20);
    assert!(root[10] < 0.01, "{:e}", root[10]);
}

/// How far the two forms are apart in double precision, the median of eleven windows, and their
/// condition number.
fn apart(sigma: f64) -> (f64, f64) {
    let layout = Layout::eight_keyframes();
    let sigmas = WindowSigmas { first_keyframe: sigma, ..WindowSigmas::default() };
    let one = |seed| {
        let window = window(&layout, &sigmas, seed);
        let root = window.marginalize(&layout.slide(0)).unwrap();
        let triangle = root.root();
        let identity = DMatrix::identity(triangle.ncols(), triangle.ncols());
        let inverse = triangle.solve_upper_triangular(&identity).unwrap();
        let hessian = marginalize(&window.information(), &layout.slide(0)).unwrap();
        let error = off(&hessian.covariance().unwrap(), &(&inverse * inverse.transpose()));
        (condition(&window), error)
    };
    let (mut conditions, mut errors): (Vec<f64>, Vec<f64>) = (0..11).map(one).unzip();
    conditions.sort_by(f64::total_cmp);
    errors.sort_by(f64::total_cmp);
    (conditions[5], errors[5])
}

#[test]
fn in_double_precision_both_forms_agree_to_the_digits_that_the_hessian_has() {
    let [(well, close), (badly, far)] = [0.1, 30.0].map(apart);
    println!("apart by {close:.1e} at a condition of {well:.1e}, by {far:.1e} at {badly:.1e}");
    assert!(close < f64::EPSILON * well.powi(2) && far < f64::EPSILON * badly.powi(2));
    let lost = (far / close).log10() / (badly / well).log10();
    println!("{lost:.2} digits for one of the condition");
    assert!((1.6..2.4).contains(&lost), "{lost}");
}

#[test]
fn blocks_say_the_same_as_the_prior_of_a_problem() {
    let layout = Layout::eight_keyframes();
    let mut problem = layout.problem(&WindowSigmas::default(), 4).unwrap();
    let values = problem.values().clone();
    let gone = layout.slide(0);
    let window = SquareRoot::of_problem(&problem, &values).unwrap();
    let by_blocks = marginalize(&window.information(), &gone).unwrap();
    let kept = LinearPrior::marginalize(&problem, &values, &gone).unwrap();
    assert_eq!(kept.variables(), [1, 2, 3]);
    problem.marginalize(&values, &gone).unwrap();
    let by_problem = SquareRoot::of_problem(&problem, &values).unwrap().information();
    assert_eq!(by_blocks.blocks(), by_problem.blocks());
    assert!(off(by_problem.matrix(), by_blocks.matrix()) < 1e-13);
    assert!((by_problem.vector() - by_blocks.vector()).norm() < 1e-10 * by_blocks.vector().norm());
}

#[test]
fn a_prior_of_blocks_has_its_minimum_where_the_window_has_it() {
    let layout = Layout::eight_keyframes();
    let whole = layout.problem(&WindowSigmas::default(), 5).unwrap();
    let window = SquareRoot::of_problem(&whole, whole.values()).unwrap();
    let gone = layout.slide(0);
    let mean = window.information().mean().unwrap();
    let left = window.marginalize(&gone).unwrap();
    for prior in [
        left.clone().into_prior(whole.values()).unwrap(),
        left.information().into_prior(whole.values()).unwrap(),
    ] {
        let mut problem = Problem::new();
        for number in 0..whole.values().len() {
            if let Some(key) = whole.values().key::<Isometry3<f64>>(number) {
                problem.add_variable(whole.values()[key]);
            } else if let Some(key) = whole.values().key::<Vector3<f64>>(number) {
                problem.add_variable(whole.values()[key]);
            }
        }
        problem.add_prior(prior).unwrap();
        for number in gone.iter().copied() {
            if let Some(key) = problem.values().key::<Isometry3<f64>>(number) {
                problem.hold(key).unwrap();
            } else if let Some(key) = problem.values().key::<Vector3<f64>>(number) {
                problem.hold(key).unwrap();
            }
        }
        let solution = problem.solve(&Options::default()).unwrap();
        let step = problem.values().local(&solution.values);
        for name in left.blocks().names() {
            let own = whole.values().coordinates_of(name).unwrap();
            let expected = mean.rows_range(window.blocks().columns_of(name).unwrap());
            let found = DVector::from_column_slice(&step[own]);
            assert!((found - expected).norm() < 1e-6 * mean.norm(), "block {name}");
        }
    }
}

#[test]
fn what_is_held_is_no_block_and_part_of_a_variable_is_no_prior() {
    let layout = Layout::chain(4, 8, 3);
    let mut problem = layout.problem(&WindowSigmas::default(), 6).unwrap();
    let pose = |number| problem.values().key::<Isometry3<f64>>(number).unwrap();
    let [first, second] = [pose(0), pose(1)];
    problem.hold(first).unwrap();
    problem.hold_coordinates(second, 3..6).unwrap();
    let window = SquareRoot::of_problem(&problem, problem.values()).unwrap();
    assert_eq!(window.blocks().names().collect::<Vec<_>>(), (1..12).collect::<Vec<_>>());
    assert_eq!(window.blocks().columns_of(1).unwrap(), 0..3);
    let whole = window.marginalize(&[1]).unwrap();
    assert!(whole.into_prior(problem.values()).is_ok());
    let part = window.into_prior(problem.values());
    assert!(matches!(part, Err(MarginalizationError::Prior(_))));
    let swapped = [(11, 6), (2, 3)].map(|(name, dimension)| Block { name, dimension });
    let swapped = Blocks::new(swapped.to_vec()).unwrap();
    let swapped = SquareRoot::new(swapped, DMatrix::identity(9, 9), DVector::zeros(9)).unwrap();
    let swapped = swapped.into_prior(problem.values());
    assert!(matches!(swapped, Err(MarginalizationError::Prior(_))), "{swapped:?}");
}

#[test]
fn what_is_tied_is_one_block_by_the_name_of_the_one_that_leads() {
    let mut problem = Layout::chain(4, 8, 3).problem(&WindowSigmas::default(), 6).unwrap();
    let pose = |number| problem.values().key::<Isometry3<f64>>(number).unwrap();
    let [second, third] = [pose(1), pose(2)];
    problem.tie(second, third).unwrap();
    let window = SquareRoot::of_problem(&problem, problem.values()).unwrap();
    assert!(window.blocks().columns_of(1).is_err());
    let columns = problem.columns();
    let own = window.blocks().columns_of(2).unwrap().collect::<Vec<_>>();
    assert_eq!(own, columns.select(problem.values().coordinates_of(1).unwrap()));
}

#[test]
fn divergence_is_that_of_two_normal_densities_by_quadrature() {
    let normal = |variance: f64, mean: f64| {
        let vector = DVector::from_element(1, mean / variance);
        Information::new(blocks(&[1]), DMatrix::from_element(1, 1, 1.0 / variance), vector).unwrap()
    };
    for [variance, mean, other_variance, other_mean] in
        [[1.0, 0.0, 1.0, 0.0], [1.0, 0.0, 4.0, 1.0], [2.0, -1.0, 0.5, 0.3]]
    {
        let log = |x: f64, variance: f64, mean: f64| {
            -0.5 * ((x - mean).powi(2) / variance + (std::f64::consts::TAU * variance).ln())
        };
        let step = 1e-3;
        let sum: f64 = (-20_000..20_000)
            .map(|at| f64::from(at) * step)
            .map(|x| {
                let known = log(x, variance, mean);
                step * known.exp() * (known - log(x, other_variance, other_mean))
            })
            .sum();
        let (p, q) = (normal(variance, mean), normal(other_variance, other_mean));
        assert!((divergence(&p, &q).unwrap() - sum).abs() < 1e-9, "{sum}");
    }
}

#[test]
fn divergence_does_not_depend_on_units_is_never_negative_and_has_a_direction() {
    let window = usual(&Layout::eight_keyframes()).information();
    let other = self::window(&Layout::eight_keyframes(), &WindowSigmas::default(), 2).information();
    let (there, back) =
        (divergence(&window, &other).unwrap(), divergence(&other, &window).unwrap());
    assert!(there > 0.0 && back > 0.0 && (there - back).abs() > 0.01 * there);
    assert!(divergence(&window, &window).unwrap().abs() < 1e-9);
    let units = DVector::from_fn(window.matrix().nrows(), |row, _| 10_f64.powi(row as i32 % 5 - 2));
    let in_units = |one: &Information<f64>| {
        let scale = DMatrix::from_diagonal(&units);
        let matrix = &scale * one.matrix() * &scale;
        Information::new(one.blocks().clone(), matrix, scale * one.vector()).unwrap()
    };
    let found = divergence(&in_units(&window), &in_units(&other)).unwrap();
    assert!((found / there - 1.0).abs() < 1e-9);
}

#[test]
fn forgetting_a_keyframe_loses_what_marginalizing_it_keeps_and_holding_it_claims_what_nobody_measured()
 {
    let layout = Layout::eight_keyframes();
    for seed in 0..10 {
        let window = window(&layout, &WindowSigmas::default(), seed);
        let kept = marginalize(&window.information(), &[3]).unwrap();
        let forgotten = window.drop_blocks(&[3]).unwrap().information();
        let held = window.information().hold_blocks(&[3]).unwrap();
        let nats = [&forgotten, &held].map(|other| divergence(&kept, other).unwrap());
        let ratios = [&forgotten, &held].map(|other| OverConfidence::of(&kept, other).unwrap());
        println!(
            "forgotten {:.2} nats, ratios {:.2e} to {:.2e}; held {:.2} nats, {:.2e} to {:.2e}",
            nats[0],
            ratios[0].smallest(),
            ratios[0].largest(),
            nats[1],
            ratios[1].smallest(),
            ratios[1].largest(),
        );
        assert!(nats.iter().all(|nats| *nats > 0.1));
        assert!(ratios[0].largest() < 1.0 + 1e-9 && ratios[0].smallest() < 0.9);
        assert!(ratios[1].smallest() > 1.0 - 1e-9 && ratios[1].largest() > 1.1);
        let moved = held.mean().unwrap() - kept.mean().unwrap();
        assert!(moved.norm() < 1e-9 * kept.mean().unwrap().norm());
    }
}

#[test]
fn the_first_keyframe_cannot_be_forgotten_where_all_that_is_known_of_the_world_is_its_prior() {
    let window = usual(&Layout::eight_keyframes());
    let forgotten = window.drop_blocks(&[0]).unwrap().information();
    let kept = marginalize(&window.information(), &[0]).unwrap();
    let refused = divergence(&kept, &forgotten);
    assert!(matches!(refused, Err(MarginalizationError::Singular { .. })), "{refused:?}");
}

#[test]
fn patterns_of_rows_and_of_numbers_are_those_of_the_layout() {
    for (name, layout) in layouts() {
        assert_eq!(Couplings::of(&usual(&layout).information()), layout.couplings(), "{name}");
    }
}
