//! The window of `examples/window.rs`, with every system and with what is known of it changed.

#[allow(dead_code)]
#[path = "../examples/window.rs"]
mod window;

mod measured;

use measured::data;
use nalgebra::{Isometry3, Matrix6, Vector2, Vector3};
use vislam::datasets::euroc::{GroundTruth, read_ground_truth};
use vislam::datasets::recording::read_recording;
use vislam::datasets::tracks::Picture;
use vislam::factors::{PixelByBody, Prior};
use vislam::inertial::{CameraImu, ImuNoise, NavState};
use vislam::least_squares::{
    Covariance, Dense, Fronts, Kernel, Key, LandmarkElimination, LinearSystem, Options, Problem,
    Solution, SolveError, Values,
};
use vislam::reprojection::Pinhole;
use window::{Known, Sensors, Window, solve, tracks, without_priors};

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

/// A cost of a thousand has no digits for less than √(2 · 10³ ε) = 7e-7 of a standard deviation.
const SAME: f64 = 5e-6;

/// The values at the minimum. A cost decides between two of them only to the root of its last digit,
/// so the last steps are taken whatever it says.
fn solved(problem: &mut Problem, system: impl LinearSystem + Clone) -> Values {
    let start = problem.values().clone();
    let near = problem.solve_with(system.clone(), &exactly()).unwrap().values;
    problem.set_values(near).unwrap();
    let last = Options { max_iterations: 4, ..Options::gauss_newton() };
    let exact = problem.solve_with(system, &Options { decrease_tolerance: 0.0, ..last }).unwrap();
    problem.set_values(start).unwrap();
    exact.values
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

/// What the dense system finds.
struct Reference {
    values: Values,
    covariance: Covariance,
    least: f64,
}

impl Reference {
    fn of(problem: &mut Problem) -> Self {
        let dense = Dense::new(problem).unwrap();
        let values = solved(problem, dense);
        let covariance = problem.covariance(&values).unwrap();
        let least = problem.null_space(&values).unwrap().least_seen.unwrap();
        Self { values, covariance, least }
    }

    /// That another system ends there too, and is as sure of it.
    fn assert_same(&self, problem: &mut Problem, system: impl LinearSystem + Clone) {
        let moved = self.values.local(&solved(problem, system.clone()));
        let covariance = problem.covariance_with(system, &self.values).unwrap();
        assert_alike(&moved, SAME, [&self.covariance, &covariance], &self.values, self.least);
    }
}

/// That eliminating the landmarks first gives what the dense system does.
fn assert_landmarks_first(window: &mut Window) {
    let system = window.landmarks_first().unwrap();
    let nowhere = Options { max_iterations: 0, ..Options::default() };
    let all_at_once = window.problem.solve(&nowhere).unwrap().report.gradient_norm;
    let found = window.problem.solve_with(system.clone(), &nowhere).unwrap().report.gradient_norm;
    assert!((found / all_at_once - 1.0).abs() < 1e-9, "{found} {all_at_once}");
    Reference::of(&mut window.problem).assert_same(&mut window.problem, system);
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

        let along = Fronts::order_along(&window.problem, &window.tiles().concat()).unwrap();
        let along = Fronts::in_order(&window.problem, &along).unwrap();
        let fronts = Fronts::new(&window.problem).unwrap();
        let landmarks_first = window.landmarks_first().unwrap();
        let reference = Reference::of(&mut window.problem);
        reference.assert_same(&mut window.problem, along);
        reference.assert_same(&mut window.problem, fronts);
        reference.assert_same(&mut window.problem, landmarks_first);
    }
}

/// The window with a second camera, in the place of the first and with a calibration of its own,
/// that sees every other landmark.
fn of_two_cameras() -> (Window, Key<Isometry3<f64>>) {
    let (recording, known, mut window) = without_priors().unwrap();
    window.add_priors(&known).unwrap();
    let sensors = Sensors::from(&recording);
    let extrinsics = window.problem.add_variable(known.rig.body_from_camera);
    let anchor = known.rig.body_from_camera;
    let prior =
        Prior { variable: extrinsics, anchor, sqrt_information: 50.0 * Matrix6::identity() };
    window.problem.add_factor(prior, Kernel::Squared).unwrap();
    for (track, landmark) in window.landmarks.iter().step_by(2) {
        for &(k, pixel) in &tracks(&sensors)[track] {
            let factor = PixelByBody {
                state: window.states[k],
                landmark: *landmark,
                extrinsics,
                time_offset: window.time_offset,
                camera: sensors.camera,
                angular_velocity: Vector3::zeros(),
                pixel: pixel + Vector2::new(0.3, -0.2),
                inverse_sigma: 1.0 / sensors.pixel_sigma,
            };
            window.problem.add_factor(factor, Kernel::Squared).unwrap();
        }
    }
    (window, extrinsics)
}

#[test]
fn two_calibrations_stand_in_one_border() {
    let (mut window, _) = of_two_cameras();
    assert_landmarks_first(&mut window);
    let (mut tied, second) = of_two_cameras();
    tied.problem.tie(second, tied.extrinsics).unwrap();
    assert_landmarks_first(&mut tied);
}

#[test]
fn some_coordinates_of_a_state_and_of_the_border_may_be_held() {
    let mut window = example();
    window.problem.hold(window.biases[3]).unwrap();
    window.problem.hold_coordinates(window.states[0], 6..9).unwrap();
    window.problem.hold_coordinates(window.extrinsics, 3..6).unwrap();
    assert_landmarks_first(&mut window);
}

#[test]
fn tiles_that_do_not_fit_are_refused() {
    type Tiles = LandmarkElimination<15, 9>;
    let mut window = example();
    let refused = |window: &Window, tiles: &[Vec<usize>]| {
        Tiles::in_tiles::<Vector3<f64>>(&window.problem, tiles).unwrap_err()
    };
    let mut wide = window.tiles();
    wide[0].push(window.extrinsics.index());
    let variable = window.extrinsics.index();
    let error = refused(&window, &wide);
    assert_eq!(error, SolveError::Block { variable, found: 21, dimension: 15 });

    let missing = window.problem.values().len();
    let error = refused(&window, &[vec![missing]]);
    assert_eq!(error, SolveError::NoSuchVariable { variable: missing });

    let biases_first: Vec<_> =
        window.tiles().into_iter().map(|tile| tile.into_iter().rev().collect()).collect();
    let said = refused(&window, &biases_first).to_string();
    assert!(said.ends_with("sees a landmark and another part of a tile than the first"), "{said}");

    // What is left of the oldest state names all landmarks that it saw.
    let values = window.problem.values().clone();
    window.take_out_oldest(&values).unwrap();
    let said = refused(&window, &window.tiles()).to_string();
    assert!(said.ends_with("sees two landmarks; only factors of one can be eliminated"), "{said}");
}

#[test]
fn what_is_taken_out_leaves_the_estimate_and_its_covariance() {
    let mut window = example();
    let fronts = Fronts::new(&window.problem).unwrap();
    let values = solved(&mut window.problem, fronts);
    let before =
        window.problem.covariance_with(Fronts::new(&window.problem).unwrap(), &values).unwrap();
    let least = window.problem.null_space(&values).unwrap().least_seen.unwrap();
    for _ in 0..3 {
        window.take_out_oldest(&values).unwrap();
        let fronts = Fronts::new(&window.problem).unwrap();
        let after = solved(&mut window.problem, fronts);
        let covariance =
            window.problem.covariance_with(Fronts::new(&window.problem).unwrap(), &values).unwrap();
        let moved = values.local(&after);
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
    let along = in_order(&Fronts::order_along(problem, &window.tiles().concat()).unwrap());
    let landmarks = window.landmarks.values().map(Key::index);
    let first = in_order(&landmarks.chain(window.tiles().concat()).collect::<Vec<_>>());
    assert!(along.widest() < 140, "{} columns", along.widest());
    assert!(along.products() < 25_000_000, "{} products", along.products());
    assert!(first.products() > 50 * along.products(), "{} products", first.products());
    let by_degree = Fronts::new(problem).unwrap().products();
    assert!(by_degree < 2 * along.products(), "{by_degree} products");
}
