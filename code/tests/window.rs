//! The window of `examples/window.rs`, with every system and with what is known of it changed.

#[allow(dead_code)]
#[path = "../examples/window.rs"]
mod window;

mod measured;

use measured::data;
use vislam::datasets::euroc::{GroundTruth, read_ground_truth};
use vislam::datasets::recording::read_recording;
use vislam::datasets::tracks::Picture;
use vislam::inertial::{CameraImu, ImuNoise, NavState};
use vislam::least_squares::{
    Covariance, Dense, Fronts, Key, LinearSystem, Options, Problem, Solution, Values,
};
use vislam::reprojection::Pinhole;
use window::{Known, Sensors, Window, solve, without_priors};

/// The window of the example, with priors.
fn example() -> Window {
    let (_, known, mut window) = without_priors().unwrap();
    window.add_priors(&known).unwrap();
    window
}

/// To the last digit that there is.
fn exactly() -> Options {
    Options { decrease_tolerance: 1e-15, gradient_tolerance: 1e-10, ..Options::default() }
}

fn solved(problem: &Problem, system: impl LinearSystem) -> Solution {
    problem.solve_with(system, &exactly()).unwrap()
}

/// That no variable moved by more than a part of its standard deviation, and that every covariance
/// among the first is the same among the second, to rounding by the least singular value that is seen.
fn assert_alike(
    moved: &[f64],
    most: f64,
    [first, second]: [&Covariance; 2],
    values: &Values,
    least: f64,
) {
    for at in 0..values.len() {
        let Some(one) = first.of_number(at) else { continue };
        let two = second.of_number(at).unwrap();
        let coordinates = values.coordinates_of(at).unwrap();
        for (step, variance) in moved[coordinates].iter().zip(one.diagonal().iter()) {
            assert!(step.abs() < most * variance.sqrt(), "variable {at}: {step:e}");
        }
        let off = (&one - two).norm() / one.norm();
        assert!(off < 10.0 * f64::EPSILON / least.powi(2), "variable {at}: {off:e}");
    }
}

#[test]
fn the_window_is_as_large_as_it_says_and_converges() {
    let window = example();
    assert_eq!((window.states.len(), window.landmarks.len()), (10, 200));
    let Solution { report, .. } = solve(&window.problem).unwrap();
    assert!(report.stop.is_convergence(), "{}", report.stop);
    let freedom = (window.problem.rows() - window.problem.columns().count) as f64;
    assert!((2.0 * report.cost - freedom).abs() < 4.0 * (2.0 * freedom).sqrt());
}

#[test]
fn without_priors_the_window_may_be_shifted_and_turned_and_nothing_else() {
    let (_, _, mut window) = without_priors().unwrap();
    let (free, named) = window.free().unwrap();
    assert_eq!((free, named.len()), (6, 6));
    window.problem.hold(window.gravity).unwrap();
    let (free, named) = window.free().unwrap();
    assert_eq!(
        (free, named),
        (4, vec!["shift along x", "shift along y", "shift along z", "turn about z"])
    );
}

#[test]
fn all_systems_give_one_estimate_and_one_covariance() {
    for known in [
        [false; 3],
        [true, true, true],
        [true, false, false],
        [false, true, false],
        [false, false, true],
    ] {
        let mut window = example();
        let problem = &mut window.problem;
        let [extrinsics, time_offset, gravity] = known;
        extrinsics.then(|| problem.hold(window.extrinsics).unwrap());
        time_offset.then(|| problem.hold(window.time_offset).unwrap());
        gravity.then(|| problem.hold(window.gravity).unwrap());

        let along = Fronts::order_along(&window.problem, &window.trunk()).unwrap();
        let along = || Fronts::in_order(&window.problem, &along).unwrap();
        let dense = solved(&window.problem, Dense::new(&window.problem).unwrap());
        let covariance = window.problem.covariance(&dense.values).unwrap();
        let least = window.problem.null_space(&dense.values).unwrap().least_seen.unwrap();
        for (other, system) in [
            (solved(&window.problem, along()), along()),
            (
                solved(&window.problem, Fronts::new(&window.problem).unwrap()),
                Fronts::new(&window.problem).unwrap(),
            ),
        ] {
            let moved = dense.values.local(&other.values);
            let also = window.problem.covariance_with(system, &dense.values).unwrap();
            assert_alike(&moved, 1e-6, [&covariance, &also], &dense.values, least);
        }
    }
}

#[test]
fn what_is_taken_out_leaves_the_estimate_and_its_covariance() {
    let mut window = example();
    let values = solved(&window.problem, Fronts::new(&window.problem).unwrap()).values;
    let before =
        window.problem.covariance_with(Fronts::new(&window.problem).unwrap(), &values).unwrap();
    let least = window.problem.null_space(&values).unwrap().least_seen.unwrap();
    for _ in 0..3 {
        window.take_out_oldest(&values).unwrap();
        let after = solved(&window.problem, Fronts::new(&window.problem).unwrap());
        let covariance =
            window.problem.covariance_with(Fronts::new(&window.problem).unwrap(), &values).unwrap();
        let moved = values.local(&after.values);
        assert_alike(&moved, 1e-5, [&covariance, &before], &values, least);
    }
}

#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn half_a_minute_of_a_real_flight_has_narrow_fronts_along_it() {
    let recording = read_recording(&data("V1_01_30s_imu_and_tracks.csv")).unwrap();
    let truth = read_ground_truth(&data("V1_01_groundtruth_20hz.csv")).unwrap();
    let pictures: Vec<Picture> = recording.pictures.iter().step_by(2).cloned().collect();
    let near = |picture: &Picture| {
        let away = |truth: &&GroundTruth| truth.nanoseconds.abs_diff(picture.nanoseconds);
        *truth.iter().min_by_key(away).expect("there are states")
    };
    let guess: Vec<NavState> = pictures.iter().map(|picture| near(picture).state).collect();
    let rig = CameraImu { body_from_camera: recording.body_from_camera, time_offset: 0.0 };
    let known = Known { state: guess[0], bias: near(&pictures[0]).bias, rig };
    let sensors = Sensors {
        readings: &recording.samples,
        pictures: &pictures,
        camera: Pinhole { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 },
        noise: ImuNoise::euroc(),
        pixel_sigma: 1.0 / recording.camera.fx,
    };
    let mut window = Window::new(&sensors, &guess, &known).unwrap();
    window.add_priors(&known).unwrap();
    assert_eq!(window.states.len(), 301);
    let problem = &window.problem;
    let in_order = |order: &[usize]| Fronts::in_order(problem, order).unwrap();
    let along = in_order(&Fronts::order_along(problem, &window.trunk()).unwrap());
    let landmarks = window.landmarks.values().map(Key::index);
    let first = in_order(&landmarks.chain(window.trunk()).collect::<Vec<_>>());
    assert!(along.widest() < 140, "{} columns", along.widest());
    assert!(along.products() < 25_000_000, "{} products", along.products());
    assert!(first.products() > 50 * along.products(), "{} products", first.products());
    let by_degree = Fronts::new(problem).unwrap().products();
    assert!(by_degree < 2 * along.products(), "{by_degree} products");
}
