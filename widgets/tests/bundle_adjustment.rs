//! The widget of bundle adjustment shows what the library's own solver does, and its controls do what
//! they say.

use nalgebra::DMatrix;
use vislam::bundle_adjustment::{Camera, PosedPinhole, Solver, TinyBa};
use vislam::least_squares::{Kernel, Options};
use vislam::simulation::Scene;
use widgets::bundle_adjustment::{BundleAdjustment, Run, Setting, World};
use widgets::{Player, Session, Widget};

type Ba = TinyBa<PosedPinhole, 6>;
type Hand = Session<BundleAdjustment>;

/// More than any solve here takes.
const ENOUGH: f64 = 40.0;
const WORLDS: usize = 3;
const STREET: f64 = 0.0;
const RING: f64 = 1.0;
const STEREO: f64 = 2.0;

fn read(hand: &mut Hand) -> Vec<f64> {
    hand.readings().into_iter().map(|(_, value)| value).collect()
}

fn after(steps: f64, settings: &[(&str, f64)]) -> Vec<f64> {
    let mut hand = Hand::with(settings).expect("controls");
    assert!(hand.set("step", steps));
    read(&mut hand)
}

/// Numbers of a scene: two thousand places and what goes with them.
const MOST: usize = 5000;

/// The readings by their order in the face.
const COST: usize = 0;
const GRADIENT: usize = 1;
const MOVED: usize = 2;
const SIZE: usize = 3;
const CAMERAS: usize = 4;
const RIGHT: usize = 5;
const ALL: usize = 6;

fn near(one: f64, other: f64, tolerance: f64) {
    assert!((one - other).abs() <= tolerance * other.abs().max(1.0), "{one} and {other}");
}

/// A setting of the controls, and the same problem without the widget.
fn setting(controls: [f64; 6]) -> (Setting, Ba) {
    let [world, held, kernel, outliers, start, seed] = controls;
    let all = [0.0, world, held, kernel, outliers, start, seed];
    let (setting, _) = Setting::of(&all).expect("a setting");
    let mut problem = setting.scene().problem;
    problem.huber = match setting.kernel {
        Kernel::Huber(threshold) => Some(threshold),
        _ => None,
    };
    (setting, problem)
}

#[test]
fn the_start_is_that_of_the_ring() {
    let scene = Scene::ring(8, 30, 1.0, 1);
    let mut hand = Hand::new();
    hand.set("world", RING);
    let mut problem = scene.problem.clone();
    for (camera, truth) in problem.cameras.iter_mut().zip(&scene.true_cameras) {
        *camera = truth.retract(&(6.0 * truth.local(camera)));
    }
    for (point, truth) in problem.points.iter_mut().zip(&scene.true_points) {
        *point = truth + 6.0 * (*point - truth);
    }
    let solver = Solver::new(&problem, &Options::default()).expect("a problem");
    let shown = read(&mut hand);
    near(shown[COST], solver.cost(), 1e-9);
    near(shown[GRADIENT], solver.gradient_norm(), 1e-9);
    assert_eq!(shown[MOVED], 0.0);
    assert_eq!(shown[RIGHT], shown[ALL]);
}

#[test]
fn the_page_begins_with_the_street_of_the_figure() {
    let street = Scene::street(10, 2.5, 1.0, 1);
    let start = BundleAdjustment::FACE.controls.iter().map(|control| control.start);
    let (setting, steps) = Setting::of(&start.collect::<Vec<_>>()).expect("a setting");
    assert_eq!(steps, 0);
    let scene = setting.scene();
    assert_eq!(scene.problem.factors, street.problem.factors);
    assert_eq!(scene.problem.fixed, street.problem.fixed);
    assert_eq!(scene.true_cameras, street.true_cameras);
}

#[test]
fn steps_are_those_of_the_solver_of_bundle_adjustment() {
    for world in 0..WORLDS {
        for (held, kernel, outliers) in [(0.0, 0.0, 0.0), (1.0, 1.0, 10.0)] {
            let world = world as f64;
            let (setting, problem) = setting([world, held, kernel, outliers, 4.0, 3.0]);
            let mut solver = Solver::new(&problem, &Options::default()).expect("a problem");
            let mut run = Run::new(setting).expect("a problem");
            for step in 1..=5 {
                run.advance(step);
                let stop = solver.iterate().expect("damped");
                let state = run.states.last().expect("a state");
                near(state.cost, solver.cost(), 1e-9);
                near(state.gradient_norm, solver.gradient_norm(), 1e-9);
                let cameras = state.cameras.iter().zip(solver.cameras());
                cameras.for_each(|(one, other)| assert!(one.local(other).norm() < 1e-9));
                if stop.is_some() {
                    break;
                }
            }
        }
    }
}

#[test]
fn the_rmse_is_that_of_the_report() {
    let (_, mut problem) = setting([RING, 0.0, 1.0, 10.0, 6.0, 1.0]);
    let report = problem.solve(&Options::default()).expect("a problem");
    let shown = after(ENOUGH, &[("world", RING), ("kernel", 1.0), ("outliers", 10.0)]);
    near(shown[ALL], report.rmse_px, 1e-9);
    near(shown[COST], report.cost, 1e-9);
}

#[test]
fn blocks_are_where_the_dense_matrices_are_not_zero() {
    for world in 0..WORLDS {
        let (setting, _) = setting([world as f64, 0.0, 0.0, 0.0, 1.0, 2.0]);
        let run = Run::new(setting).expect("a problem");
        let scene = setting.scene();
        let problem = setting.problem(&scene).expect("a problem");
        let (jacobian, _) = problem.jacobian(problem.values()).expect("pixels");
        let whole = jacobian.tr_mul(&jacobian);
        let start = |index: usize| match index.checked_sub(run.rows) {
            None => (6 * index, 6),
            Some(point) => (6 * run.rows + 3 * point, 3),
        };
        let is_there = |matrix: &DMatrix<f64>, [row, column]: [usize; 2]| {
            let ((row, height), (column, width)) = (start(row), start(column));
            matrix.view((row, column), (height, width)).iter().any(|entry| *entry != 0.0)
        };
        let all = |size: usize| (0..size).flat_map(move |row| (0..size).map(move |c| [row, c]));
        let expected = all(run.rows + scene.true_points.len()).filter(|b| is_there(&whole, *b));
        assert_eq!(run.whole, expected.collect::<Vec<_>>());
        // Cameras that share a point, and no others.
        let cameras = 6 * run.rows;
        let coupling = whole.view((0, cameras), (cameras, whole.ncols() - cameras)).into_owned();
        let through = coupling.map(f64::abs) * coupling.map(f64::abs).transpose();
        let expected = all(run.rows).filter(|block| is_there(&through, *block));
        assert_eq!(run.reduced, expected.collect::<Vec<_>>());
    }
}

#[test]
fn everybody_meets_on_the_ring_and_neighbours_on_the_street() {
    let blocks = |world| {
        let run = Run::new(setting([world, 0.0, 0.0, 0.0, 1.0, 2.0]).0).expect("a problem");
        (run.reduced.len(), run.rows * run.rows)
    };
    let ((ring, all), (street, more)) = (blocks(RING), blocks(STREET));
    assert_eq!(ring, all);
    assert!(street < more);
    // A block of the Schur complement for each pair that shares a point, twice, and for each camera.
    let run = Run::new(setting([STREET, 0.0, 0.0, 0.0, 1.0, 2.0]).0).expect("a problem");
    assert_eq!(run.reduced.len(), run.rows + 2 * run.covisible.len());
    assert!(run.covisible.iter().all(|([one, other], _)| other - one <= 5));
}

#[test]
fn a_free_gauge_moves_the_whole_and_changes_neither_cost_nor_shape() {
    for world in 0..WORLDS {
        let world = ("world", world as f64);
        let held = after(ENOUGH, &[world, ("held", 0.0)]);
        let free = after(ENOUGH, &[world, ("held", 1.0)]);
        near(free[COST], held[COST], 1e-7);
        near(free[CAMERAS], held[CAMERAS], 1e-4);
        assert_eq!(held[MOVED], 0.0);
        assert!(free[MOVED] > 1.0, "{} mm", free[MOVED]);
    }
}

#[test]
fn the_solver_converges_where_the_page_begins() {
    for world in 0..WORLDS {
        let setting = setting([world as f64, 1.0, 0.0, 0.0, 6.0, 1.0]).0;
        let mut run = Run::new(setting).expect("a problem");
        run.advance(40);
        let stop = run.ended.flatten().expect("it stops");
        assert!(stop.is_convergence(), "{stop}");
        assert!(run.states.last().expect("a state").cost < run.cost_of_truth);
    }
}

#[test]
fn a_second_lens_measures_the_size() {
    let error = |world| (after(ENOUGH, &[("world", world)])[SIZE] - 1.0).abs();
    assert!(error(STEREO) < 0.005);
    assert!(error(STEREO) < error(RING));
}

#[test]
fn outliers_bend_least_squares_more_than_the_kernels() {
    let end = |kernel, outliers| {
        let ring = ("world", RING);
        after(ENOUGH, &[ring, ("kernel", kernel), ("outliers", outliers), ("start", 1.0)])
    };
    let [clean, squared, huber, cauchy] =
        [end(0.0, 0.0), end(0.0, 15.0), end(1.0, 15.0), end(2.0, 15.0)];
    assert!(clean[CAMERAS] < huber[CAMERAS] && huber[CAMERAS] < squared[CAMERAS]);
    assert!(cauchy[CAMERAS] < huber[CAMERAS]);
    assert!(huber[RIGHT] < squared[RIGHT] && squared[ALL] < huber[ALL]);
    assert_eq!(clean[RIGHT], clean[ALL]);
}

#[test]
fn more_outliers_cost_more() {
    let cost = |outliers| after(0.0, &[("outliers", outliers), ("start", 0.0)])[COST];
    assert!(cost(0.0) < cost(5.0) && cost(5.0) < cost(10.0) && cost(10.0) < cost(20.0));
}

#[test]
fn the_start_is_off_by_as_much_as_is_asked_for() {
    let at = |start| after(0.0, &[("start", start)]);
    assert!(at(0.0)[CAMERAS] < 1e-9);
    let [near, far, farthest] = [at(1.0)[CAMERAS], at(4.0)[CAMERAS], at(8.0)[CAMERAS]];
    assert!(0.0 < near && near < far && far < farthest);
    let scene = setting([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]).0.scene();
    let run = Run::new(setting([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]).0).expect("a problem");
    assert!((run.cost_of_truth - at(0.0)[COST]).abs() < 1e-9 * run.cost_of_truth);
    assert_eq!(scene.problem.points, scene.true_points);
}

#[test]
fn another_seed_is_another_scene() {
    assert_ne!(after(3.0, &[("seed", 1.0)]), after(3.0, &[("seed", 2.0)]));
}

#[test]
fn every_pixel_exists_at_every_start() {
    for world in 0..WORLDS {
        for seed in 1..=20 {
            for start in [0.0, 2.0, 4.0, 6.0, 8.0] {
                let (_, problem) = setting([world as f64, 0.0, 0.0, 0.0, start, seed as f64]);
                let solver = Solver::new(&problem, &Options::default()).expect("a problem");
                let report = solver.report(vislam::least_squares::Stop::IterationLimit);
                assert_eq!(report.dropped, Default::default(), "{world} {seed} {start}");
            }
        }
    }
}

#[test]
fn a_state_of_the_controls_has_one_picture() {
    let mut hand = Hand::new();
    hand.set("world", STEREO);
    let straight: Vec<u64> = {
        hand.set("step", 3.0);
        hand.numbers().iter().map(|number| number.to_bits()).collect()
    };
    for (name, value) in [("step", 9.0), ("step", 1.0), ("outliers", 20.0), ("held", 1.0)] {
        hand.set(name, value);
        hand.numbers();
    }
    for (name, value) in [("outliers", 0.0), ("held", 0.0), ("step", 3.0)] {
        hand.set(name, value);
    }
    let again: Vec<u64> = hand.numbers().iter().map(|number| number.to_bits()).collect();
    assert_eq!(straight, again);
}

#[test]
fn no_setting_is_too_much() {
    let controls = BundleAdjustment::FACE.controls;
    let choices: Vec<[f64; 3]> =
        controls.iter().map(|control| [control.least, control.start, control.most]).collect();
    let mut hand = Hand::new();
    for number in 0..3_usize.pow(controls.len() as u32) {
        for (place, control) in controls.iter().enumerate().rev() {
            let value = choices[place][number / 3_usize.pow(place as u32) % 3];
            hand.set(control.name, value);
        }
        let shown = read(&mut hand);
        assert!(shown.iter().all(|value| value.is_finite()), "{:?}: {shown:?}", hand.controls());
        assert!(hand.numbers().len() < MOST);
    }
}

#[test]
fn a_thousand_updates_draw_no_more_than_one() {
    let mut hand = Hand::new();
    let mut most = 0;
    for update in 0..1000 {
        hand.set("world", f64::from(update % 3));
        hand.set("start", f64::from(update % 9));
        hand.set("step", f64::from(update % 7));
        most = most.max(hand.numbers().len());
    }
    assert!(most < MOST, "{most} numbers");
    assert_eq!(World::Street, setting([0.0; 6]).0.world);
}

/// Run by hand: `cargo test -p widgets --test bundle_adjustment -- --ignored --nocapture`.
#[test]
#[ignore = "it measures time"]
fn how_long_an_update_takes() {
    for world in 0..WORLDS {
        let timed = |what: &str, name: &str, value: &dyn Fn(u32) -> f64| {
            let mut hand = Hand::new();
            hand.set("world", world as f64);
            hand.numbers();
            let began = std::time::Instant::now();
            for update in 0..200 {
                hand.set(name, value(update));
                hand.numbers();
            }
            println!("{world} {what}: {:.3} ms", began.elapsed().as_secs_f64() * 5.0);
        };
        timed("other start", "start", &|update| f64::from(update % 8));
        timed("other seed", "seed", &|update| f64::from(1 + update % 20));
        timed("step", "step", &|update| f64::from(update % 30));
    }
}
