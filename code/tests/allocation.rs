//! A search takes its memory once. What an iteration allocates would be noticed by whoever has to
//! be ready for the next picture.

#[allow(dead_code)]
#[path = "../examples/filter.rs"]
mod filter;
#[allow(dead_code)]
#[path = "../examples/window.rs"]
mod window;

use nalgebra::{Isometry3, Vector2, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::bundle_adjustment::{Camera, Posed};
use vislam::factors::{MovingCamera, PixelByCamera};
use vislam::initialization::Sensors;
use vislam::least_squares::{
    Dense, Fronts, Kernel, LandmarkElimination, LinearSystem, Method, Options, Problem, Search,
};
use vislam::manifold::se3;
use vislam::odometry::{Estimator, Odometry, OdometryOptions};
use vislam::reprojection::Pinhole;
use vislam::simulation::FlightRecording;
use vislam::smoother::{Smoother, SmootherOptions};

const PINHOLE: Pinhole = Pinhole { fx: 400.0, fy: 410.0, cx: 320.0, cy: 240.0 };

/// Six cameras that see forty points, with noise. One of them is held, and the others begin so far
/// off that some steps are refused.
fn cameras_and_points() -> Problem {
    let mut draws = ChaCha8Rng::seed_from_u64(51);
    let mut number = move || draws.random_range(-1.0..1.0);
    let mut problem = Problem::new();
    let (mut truth, mut cameras) = (Vec::new(), Vec::new());
    for index in 0..6 {
        let ahead = Isometry3::translation(0.0, 0.0, 6.0);
        let camera_from_world = se3::retract(&ahead, &(0.5 * Vector6::from_fn(|_, _| number())));
        let camera = Posed { intrinsics: PINHOLE, camera_from_world };
        let off = if index == 0 { 0.0 } else { 0.8 };
        let start = camera.retract(&(off * Vector6::from_fn(|_, _| number())));
        cameras.push(problem.add_variable(MovingCamera::<_, 6>(start)));
        truth.push(camera);
    }
    problem.hold(cameras[0]).unwrap();
    for _ in 0..40 {
        let place = 2.0 * Vector3::from_fn(|_, _| number());
        let landmark = problem.add_variable(place + Vector3::from_fn(|_, _| number()));
        for (camera, truth) in cameras.iter().zip(&truth) {
            let pixel = truth.project(&place).unwrap() + Vector2::from_fn(|_, _| number());
            let factor = PixelByCamera { camera: *camera, landmark, pixel, inverse_sigma: 1.0 };
            problem.add_factor(factor, Kernel::Huber(1.345)).unwrap();
        }
    }
    problem
}

/// How often each iteration of a search allocates, from the second on.
fn each_iteration<S: LinearSystem>(problem: &Problem, system: S) -> Vec<u64> {
    let method = Method::LevenbergMarquardt { initial_damping: 1e-9 };
    let options = Options { method, decrease_tolerance: 0.0, ..Options::default() };
    let mut search = Search::new(problem, system, &options).unwrap();
    let mut counts = Vec::new();
    loop {
        let mut stop = None;
        let counted = allocation_counter::measure(|| stop = search.iterate(problem).unwrap());
        if stop.is_some() {
            break;
        }
        counts.push(counted.count_total);
    }
    let iterations = search.iterations();
    let refused = iterations.iter().filter(|iteration| !iteration.accepted).count();
    assert!(refused > 0 && iterations.len() > refused + 3, "{refused} of {}", iterations.len());
    counts.split_off(1)
}

#[test]
fn an_iteration_with_the_landmarks_eliminated_allocates_nothing() {
    let problem = cameras_and_points();
    let system = LandmarkElimination::<6>::new::<Vector3<f64>>(&problem).unwrap();
    let counts = each_iteration(&problem, system);
    assert!(counts.iter().all(|count| *count == 0), "{counts:?}");
}

#[test]
fn an_iteration_of_a_window_with_the_landmarks_first_allocates_nothing() {
    let (_, known, mut window) = window::without_priors().unwrap();
    window.add_priors(&known).unwrap();
    let options = Options { decrease_tolerance: 0.0, ..Options::default() };
    let system = window.landmarks_first().unwrap();
    let mut search = Search::new(&window.problem, system, &options).unwrap();
    search.iterate(&window.problem).unwrap();
    for _ in 0..4 {
        let once = || assert!(search.iterate(&window.problem).unwrap().is_none());
        assert_eq!(allocation_counter::measure(once).count_total, 0);
    }
}

#[test]
fn an_iteration_with_fronts_allocates_nothing() {
    let problem = cameras_and_points();
    let counts = each_iteration(&problem, Fronts::new(&problem).unwrap());
    assert!(counts.iter().all(|count| *count == 0), "{counts:?}");
}

#[test]
fn an_iteration_of_the_dense_system_allocates_nothing() {
    let problem = cameras_and_points();
    let counts = each_iteration(&problem, Dense::new(&problem).unwrap());
    assert!(counts.iter().all(|count| *count == 0), "{counts:?}");
}

/// How many bytes an odometry holds after each call.
fn held<T>(calls: impl Iterator<Item = T>, mut call: impl FnMut(T)) -> Vec<i64> {
    let holds = |sum: &mut i64, given| {
        *sum += allocation_counter::measure(|| call(given)).bytes_current;
        Some(*sum)
    };
    calls.scan(0, holds).collect()
}

fn most(bytes: &[i64]) -> i64 {
    bytes.iter().copied().max().expect("there are some")
}

#[test]
fn an_estimator_that_flies_on_holds_no_more_than_before() {
    let recording = filter::flown(&filter::flight(120.0), 1).unwrap();
    let start = filter::start(&recording, 1);
    for estimator in [Estimator::Smoother, Estimator::Msckf] {
        let options = OdometryOptions::new(Sensors::of_flight(&recording.flight), estimator);
        let mut odometry = Odometry::begun(options, &start).unwrap();
        let mut readings = recording.readings.iter().peekable();
        let held = held(recording.pictures[1..].iter(), |picture| {
            let until = picture.nanoseconds + 5_000_000;
            while let Some(reading) = readings.next_if(|next| next.nanoseconds <= until) {
                odometry.reading(*reading).unwrap();
            }
            odometry.picture(picture).unwrap();
        });
        // It has all it needs after some seconds; from then on it breathes.
        let (early, late) = (most(&held[300..600]), most(&held[900..]));
        assert!(late <= early + 32_768, "{estimator}: {early} bytes in a minute, {late} in two");
    }
}

#[test]
fn readings_without_pictures_are_not_kept_for_ever() {
    let recording = filter::flown(&filter::flight(120.0), 1).unwrap();
    let sensors = Sensors::of_flight(&recording.flight);
    let mut odometry = Odometry::new(OdometryOptions::new(sensors, Estimator::Smoother));
    let held = held(recording.readings.iter(), |reading| {
        odometry.reading(*reading).unwrap();
    });
    let (early, late) = (most(&held[..held.len() / 2]), most(&held[held.len() / 2..]));
    assert!(late <= early, "{early} bytes in a minute, {late} in two");
}

/// How often each picture of a flight makes a smoother allocate, and how many bytes in all.
fn each_picture(recording: &FlightRecording, options: SmootherOptions) -> Vec<(u64, u64)> {
    let mut smoother = Smoother::new(options, &filter::start(recording, 1)).unwrap();
    let mut readings = recording.readings.iter().peekable();
    let rig = recording.flight.rig;
    let each = recording.pictures[1..].iter().map(|picture| {
        let until = rig.imu_nanoseconds(picture.nanoseconds);
        while smoother.last_reading().is_none_or(|last| last < until) {
            smoother.reading(*readings.next().unwrap()).unwrap();
        }
        let counted = allocation_counter::measure(|| {
            smoother.picture(picture).unwrap();
        });
        (counted.count_total, counted.bytes_total)
    });
    each.collect()
}

#[test]
fn a_picture_of_a_smoother_that_flies_on_allocates_no_more_than_stated() {
    let recording = filter::flown(&filter::flight(20.0), 1).unwrap();
    let new = SmootherOptions::new(Sensors::of_flight(&recording.flight));
    let each = each_picture(&recording, new);
    // Of a window of 20 states, 70 landmarks and 700 pixels, which other ones leave with every picture.
    let late = &each[100..];
    let most = |number: fn(&(u64, u64)) -> u64| late.iter().map(number).max().unwrap();
    let (count, bytes) = (most(|each| each.0), most(|each| each.1));
    assert!(count < 4000 && bytes < 4_500_000, "{count} allocations, {bytes} bytes");
}
