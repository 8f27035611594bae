//! The multi-state constraint Kalman filter: a track's constraints against the problem that keeps
//! its landmark, and the filter on simulated flights.

#[allow(dead_code)]
#[path = "../examples/filter.rs"]
mod filter;
#[path = "msckf/passing.rs"]
mod passing;

use filter::{flight, start};
use nalgebra::{DMatrix, DVector, Isometry3, SMatrix, SVector, Vector1, Vector2, Vector3};
use passing::{CAMERA, PARALLAX, SIGMA, normal, pass};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use vislam::consistency::Policy;
use vislam::datasets::tracks::{Feature, Picture};
use vislam::factors::PixelByBody;
use vislam::filtering::{Belief, Form, attitude_in_world, nees};
use vislam::inertial::{
    Calibrated, GRAVITY, ImuNoise, ImuSample, NavState, StampedSample, WindowError,
};
use vislam::least_squares::{Kernel, Manifold, Problem};
use vislam::msckf::{
    LandmarkError, LinearizedTrack, Msckf, MsckfError, MsckfOptions, PictureReport, Rest, Rows,
    Sight, Start, TrackError, WindowPolicy, landmark,
};
use vislam::simulation::{Flight, FlightRecording, Trajectory};
use vislam::two_views::TriangulationError;

fn linearized(sights: &[Sight], extrinsics: &Isometry3<f64>) -> (LinearizedTrack, Vector3<f64>) {
    let point = landmark(sights, extrinsics, (&CAMERA, SIGMA), PARALLAX).unwrap();
    let mut track = LinearizedTrack::default();
    track.linearize(sights, &point, extrinsics, (&CAMERA, SIGMA)).unwrap();
    (track, point)
}

/// The rows of a track: by the landmark, by poses and camera, and the residual.
fn parts(track: &LinearizedTrack, from: usize) -> (DMatrix<f64>, DMatrix<f64>, DVector<f64>) {
    let rows: Vec<&[f64]> = track.rows().from(from).collect();
    let width = track.rows().width();
    let part = |start: usize, end: usize| {
        DMatrix::from_fn(rows.len(), end - start, |row, column| rows[row][start + column])
    };
    (part(0, 3), part(3, width - 1), part(width - 1, width).column(0).into_owned())
}

#[test]
fn the_rows_of_a_track_are_those_of_the_shared_factor() {
    let (sights, extrinsics) = pass(6, 1);
    let (track, point) = linearized(&sights, &extrinsics);
    let (by_landmark, by_poses, residual) = parts(&track, 0);
    let (expected, expected_residual) = pixels(&sights, &extrinsics, &point);
    assert_eq!((expected.columns(36, 3) - by_landmark).amax(), 0.0);
    assert_eq!((expected.columns(0, 36) - by_poses.columns(0, 36)).amax(), 0.0);
    assert_eq!((expected_residual - residual).amax(), 0.0);
}

/// Jacobian and residual of the pixels as a problem has them: six columns a pose, then the landmark.
fn pixels(
    sights: &[Sight],
    extrinsics: &Isometry3<f64>,
    point: &Vector3<f64>,
) -> (DMatrix<f64>, DVector<f64>) {
    let mut problem = Problem::new();
    let states: Vec<_> =
        sights.iter().map(|sight| problem.add_variable(sight.pose.at_rest())).collect();
    let landmark = problem.add_variable(*point);
    let extrinsics = problem.add_variable(*extrinsics);
    let time_offset = problem.add_variable(Vector1::zeros());
    problem.hold(extrinsics).unwrap();
    problem.hold(time_offset).unwrap();
    for (state, sight) in states.iter().zip(sights) {
        problem.hold_coordinates(*state, 3..6).unwrap();
        let factor = PixelByBody {
            state: *state,
            landmark,
            extrinsics,
            time_offset,
            camera: CAMERA,
            angular_velocity: Vector3::zeros(),
            pixel: sight.pixel,
            inverse_sigma: 1.0 / SIGMA,
        };
        problem.add_factor(factor, Kernel::Squared).unwrap();
    }
    problem.jacobian(problem.values()).unwrap()
}

#[test]
fn the_constraints_name_no_landmark_and_have_white_noise() {
    for poses in [3, 5, 11, 20, 30] {
        let (sights, extrinsics) = pass(poses, 2);
        let (mut track, _) = linearized(&sights, &extrinsics);
        let (by_landmark, by_poses, residual) = parts(&track, 0);
        track.project(10.0).unwrap();
        assert_eq!(track.constraints().count(), 2 * poses - 3);
        let (left, turned, turned_residual) = parts(&track, 0);
        assert!(left.rows(3, 2 * poses - 3).amax() < 1e-12 * by_landmark.amax());
        // Rotations keep all inner products.
        let whole = |a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DVector<f64>| {
            let mut whole = DMatrix::zeros(a.nrows(), a.ncols() + b.ncols() + 1);
            whole.columns_mut(0, 3).copy_from(a);
            whole.columns_mut(3, b.ncols()).copy_from(b);
            whole.set_column(a.ncols() + b.ncols(), c);
            whole.tr_mul(&whole)
        };
        let before = whole(&by_landmark, &by_poses, &residual);
        let after = whole(&left, &turned, &turned_residual);
        assert!((&before - after).amax() < 1e-13 * before.amax(), "{poses}");
    }
}

#[test]
fn the_normal_equations_of_the_constraints_are_the_schur_complement() {
    for poses in 3..=30 {
        let (sights, extrinsics) = pass(poses, 3);
        let (mut track, _) = linearized(&sights, &extrinsics);
        let (f, x, r) = parts(&track, 0);
        let singular_values = f.clone().singular_values();
        let condition = singular_values.max() / singular_values.min();
        let eliminated = (f.tr_mul(&f)).cholesky().unwrap();
        let schur = x.tr_mul(&x) - x.tr_mul(&f) * eliminated.solve(&f.tr_mul(&x));
        let gradient = x.tr_mul(&r) - x.tr_mul(&f) * eliminated.solve(&f.tr_mul(&r));
        track.project(10.0).unwrap();
        let (_, x, r) = parts(&track, 3);
        let tolerance = 100.0 * f64::EPSILON * condition * condition;
        assert!((x.tr_mul(&x) - &schur).norm() < tolerance * schur.norm(), "{poses}");
        assert!((x.tr_mul(&r) - &gradient).norm() < tolerance * schur.norm().sqrt() * r.norm());
    }
}

#[test]
fn the_correction_is_one_step_of_gauss_and_newton_with_the_landmark_kept() {
    for poses in 3..=30 {
        let (sights, extrinsics) = pass(poses, 4);
        let (mut track, point) = linearized(&sights, &extrinsics);
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let dimension = 6 * poses;
        let root = DMatrix::from_fn(dimension + 4, dimension, |_, _| 0.01 * normal(&mut random));
        let covariance = root.tr_mul(&root);
        let mut belief = Belief::new();
        belief.add(DVectorLike::new(dimension), &covariance).unwrap();
        track.project(10.0).unwrap();
        let (_, by_poses, residual) = parts(&track, 3);
        let jacobian = by_poses.columns(0, dimension).into_owned();
        let step = belief.correct(&jacobian, &residual, Form::Difference).unwrap().step;
        let after = belief.covariance().clone();
        // With the landmark as a variable, of which nothing is known beforehand.
        let (whole, residual) = pixels(&sights, &extrinsics, &point);
        let mut hessian = whole.tr_mul(&whole);
        let mut own = hessian.view_mut((0, 0), (dimension, dimension));
        own += covariance.try_inverse().unwrap();
        let expected = hessian.clone().try_inverse().unwrap();
        let newton = -&expected * whole.tr_mul(&residual);
        for at in 0..dimension {
            let sigma = expected[(at, at)].sqrt();
            assert!((step[at] - newton[at]).abs() < 1e-9 * sigma, "{poses}, {at}");
        }
        let kept = expected.view((0, 0), (dimension, dimension));
        assert!((after - kept).norm() < 1e-9 * kept.norm(), "{poses}");
    }
}

/// A vector whose length is known when it runs.
#[derive(Clone)]
struct DVectorLike(DVector<f64>);

impl DVectorLike {
    fn new(dimension: usize) -> Self {
        Self(DVector::zeros(dimension))
    }
}

impl Manifold for DVectorLike {
    fn dimension(&self) -> usize {
        self.0.len()
    }

    fn retract(&self, step: &[f64]) -> Self {
        Self(&self.0 + DVector::from_row_slice(step))
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        step.copy_from_slice((&to.0 - &self.0).as_slice());
    }

    fn local_jacobian(&self, _to: &Self, into: &mut [f64]) {
        into.copy_from_slice(DMatrix::<f64>::identity(self.0.len(), self.0.len()).as_slice());
    }
}

#[test]
fn a_track_without_parallax_has_no_landmark_and_one_with_little_lacks_rank() {
    let (mut sights, extrinsics) = pass(6, 6);
    let (track, point) = linearized(&sights, &extrinsics);
    let mut projected = track.clone();
    let refused = projected.project(1e-3);
    assert!(matches!(refused, Err(TrackError::Rank { largest: 1e-3, .. })), "{refused:?}");
    let mut root = track.clone();
    root.project(10.0).unwrap();
    let (by_landmark, ..) = parts(&track, 0);
    let information = by_landmark.tr_mul(&by_landmark);
    let squared = root.landmark_root().tr_mul(&root.landmark_root());
    assert!((information - DMatrix::from_column_slice(3, 3, squared.as_slice())).amax() < 1e-9);
    // From one place all rays of a landmark are one ray.
    let first = sights[0];
    sights.fill(first);
    let missing = landmark(&sights, &extrinsics, (&CAMERA, SIGMA), PARALLAX);
    assert!(
        matches!(missing, Err(LandmarkError::Triangulation(TriangulationError::NoBaseline { .. }))),
        "{missing:?}"
    );
    let mut track = track;
    track.linearize(&sights, &point, &extrinsics, (&CAMERA, SIGMA)).unwrap();
    assert!(matches!(track.project(10.0), Err(TrackError::Rank { .. })));
    let behind =
        track.linearize(&sights, &Vector3::new(0.0, 0.0, -5.0), &extrinsics, (&CAMERA, 1.0));
    assert_eq!(behind, Err(TrackError::Behind { sight: 0 }));
}

fn flown(flight: &Flight, seed: u64) -> FlightRecording {
    filter::flown(flight, seed).unwrap()
}

fn fly(
    recording: &FlightRecording,
    options: MsckfOptions,
    start: &Start,
    visit: impl FnMut(usize, &Msckf, &PictureReport),
) -> Msckf {
    filter::fly(recording, options, start, visit).unwrap()
}

fn position_error(recording: &FlightRecording, number: usize, filter: &Msckf) -> f64 {
    (recording.truth.states[number].position - filter.state().position).norm()
}

/// The normalized error squared of state and biases, divided by their number.
fn normalized(recording: &FlightRecording, number: usize, filter: &Msckf) -> f64 {
    let mut error = SVector::<f64, 15>::zeros();
    let (truth, bias) = (recording.truth.states[number], recording.truth.biases[number]);
    filter.state().local(&truth, &mut error.as_mut_slice()[..9]);
    filter.bias().local(&bias, &mut error.as_mut_slice()[9..]);
    nees(&error, &filter.covariance()).unwrap()
}

#[test]
fn a_flight_is_followed_and_its_errors_are_as_large_as_believed() {
    let mut sum = 0.0;
    let flights = 8;
    for seed in 0..flights {
        let recording = flown(&flight(20.0), seed);
        let options = MsckfOptions::of_flight(&recording.flight);
        let filter = fly(&recording, options, &start(&recording, seed), |number, filter, _| {
            assert!(position_error(&recording, number, filter) < 0.3, "{seed}, {number}");
        });
        sum += normalized(&recording, recording.pictures.len() - 1, &filter);
    }
    // 120 degrees of freedom: 0.69 to 1.36 except once in a thousand.
    let mean = sum / flights as f64;
    assert!((0.69..1.36).contains(&mean), "{mean}");
}

#[test]
fn without_pictures_the_same_flight_is_lost() {
    let mut recording = flown(&flight(20.0), 1);
    recording.pictures.iter_mut().for_each(|picture| picture.features.clear());
    let options = MsckfOptions::of_flight(&recording.flight);
    let filter = fly(&recording, options, &start(&recording, 1), |_, _, _| ());
    assert!(position_error(&recording, recording.pictures.len() - 1, &filter) > 3.0);
}

#[test]
fn outliers_are_gated_and_named() {
    let recording = flown(&Flight { outliers: 0.02, ..flight(20.0) }, 2);
    let options = MsckfOptions::of_flight(&recording.flight);
    let mut refused = 0;
    let filter = fly(&recording, options, &start(&recording, 2), |_, _, report| {
        refused += report.refused.gated + report.refused.landmark + report.refused.unmet;
    });
    assert!(refused > 50, "{refused}");
    assert!(position_error(&recording, recording.pictures.len() - 1, &filter) < 0.3);
}

#[test]
fn calibration_and_clock_are_found_on_the_way() {
    let mut flight = flight(30.0);
    flight.rig.time_offset = 0.02;
    let recording = flown(&flight, 3);
    let mut start = start(&recording, 3);
    start.rig.time_offset = 0.0;
    let off = Isometry3::new(Vector3::new(0.02, -0.02, 0.02), Vector3::new(0.01, -0.01, 0.01));
    start.rig.body_from_camera *= off;
    start.nanoseconds = 0;
    let calibrated = Calibrated { extrinsics: Some([0.02, 0.01]), time_offset: Some(0.02) };
    let options = MsckfOptions { calibrated, ..MsckfOptions::of_flight(&flight) };
    // The first picture was taken before the readings begin on the believed clock,
    let mut recording = recording;
    // and the last one may be after their end on the clock that is found.
    recording.pictures.pop();
    recording.pictures.remove(0);
    recording.truth.states.remove(0);
    recording.truth.biases.remove(0);
    let filter = fly(&recording, options, &start, |_, _, _| ());
    let rig = filter.rig();
    let variance = |at: usize| filter.belief().covariance()[(at, at)];
    let left = rig.body_from_camera.inverse() * flight.rig.body_from_camera;
    assert!((rig.time_offset - 0.02).abs() < 1e-3, "{}", rig.time_offset);
    assert!((rig.time_offset - 0.02).abs() < 4.0 * variance(21).sqrt());
    assert!(left.translation.vector.norm() < 0.01, "{}", left.translation.vector);
    assert!(left.rotation.angle() < 2e-3, "{}", left.rotation.angle());
    let error = position_error(&recording, recording.pictures.len() - 1, &filter);
    assert!(error < 0.3, "{error}");
}

/// A flight about one spot, which sees the same landmarks all the time.
fn hover(seconds: f64) -> FlightRecording {
    let motion = Trajectory::about_one_spot();
    let flight = Flight { seconds, picture_rate: 5.0, tracks: 24, ..Flight::new(motion) };
    flight.record(&flight.room(2.5, 250, 4).unwrap(), 4).unwrap()
}

/// The least standard deviation of yaw that is possible when no measurement says anything of yaw and
/// place: what the start itself says of a turn of everything about the vertical.
fn least_sigma_of_yaw(start: &Start) -> f64 {
    let NavState { world_from_body, velocity, position } = start.state;
    let up = Vector3::z();
    let mut free = SMatrix::<f64, 15, 4>::zeros();
    free.fixed_view_mut::<3, 1>(0, 0).copy_from(&(world_from_body.inverse() * up));
    free.fixed_view_mut::<3, 1>(3, 0).copy_from(&up.cross(&velocity));
    free.fixed_view_mut::<3, 1>(6, 0).copy_from(&up.cross(&position));
    free.fixed_view_mut::<3, 3>(6, 1).fill_with_identity();
    let information = free.transpose() * start.covariance.try_inverse().unwrap() * free;
    information.try_inverse().unwrap()[(0, 0)].sqrt()
}

#[test]
fn kept_landmarks_say_nothing_of_yaw_if_derivatives_are_taken_at_first_estimates() {
    let recording = hover(10.0);
    let mut start = start(&recording, 4);
    start.covariance[(2, 2)] = 0.03 * 0.03;
    let sigma_of_yaw = |policy: Policy| {
        let options = MsckfOptions {
            landmarks: 24,
            linearization: policy.into(),
            ..MsckfOptions::of_flight(&recording.flight)
        };
        let filter = fly(&recording, options, &start, |_, _, _| ());
        let own = filter.covariance();
        attitude_in_world(filter.state(), &own.fixed_view::<3, 3>(0, 0))[(2, 2)].sqrt()
    };
    let least = least_sigma_of_yaw(&start);
    let first = sigma_of_yaw(Policy::FirstEstimates);
    let latest = sigma_of_yaw(Policy::Standard);
    assert!((1.0..1.01).contains(&(first / least)), "{first} {least}");
    assert!(latest < 0.5 * least, "{latest} {least}");
}

#[test]
fn a_landmark_that_enters_the_state_and_is_not_seen_again_changes_nothing() {
    let mut recording = flown(&flight(10.0), 6);
    let clones = 6;
    // A track gets another name after as many pictures as the window has poses.
    for (number, picture) in recording.pictures.iter_mut().enumerate() {
        for feature in &mut picture.features {
            feature.track += 1000 * (number / clones);
        }
    }
    let flown = |landmarks| {
        let told = MsckfOptions { clones, landmarks, ..MsckfOptions::of_flight(&recording.flight) };
        fly(&recording, told, &start(&recording, 6), |_, _, _| ())
    };
    let (without, with) = (flown(0), flown(20));
    assert!((without.state().position - with.state().position).norm() < 1e-9);
    let (one, other) = (without.covariance(), with.covariance());
    assert!((one - other).norm() < 1e-9 * one.norm());
}

#[test]
fn a_body_at_rest_stays_where_it_is_and_keeps_its_window() {
    let rest = Rest { motion: 3.0, velocity_sigma: 0.01, turning_sigma: 0.01 };
    let hover = Flight { motion: Trajectory::hover(), ..flight(60.0) };
    let recording = flown(&hover, 5);
    let told = |rest| MsckfOptions { rest, ..MsckfOptions::of_flight(&recording.flight) };
    let mut resting = 0;
    let last = recording.pictures.len() - 1;
    let filter = fly(&recording, told(Some(rest)), &start(&recording, 5), |_, _, report| {
        resting += usize::from(report.at_rest);
    });
    assert_eq!(resting, last);
    assert!(position_error(&recording, last, &filter) < 0.1);
    let adrift = fly(&recording, told(None), &start(&recording, 5), |_, _, _| ());
    assert!(position_error(&recording, last, &adrift) > 1.0);
}

#[test]
fn by_a_poor_gyroscope_at_rest_its_bias_is_known_no_worse_than_is_said() {
    let rest = Rest { motion: 3.0, velocity_sigma: 0.01, turning_sigma: 1e-3 };
    let noise = ImuNoise::mems();
    let hover = Flight { motion: Trajectory::hover(), noise, ..flight(10.0) };
    let mut squares = 0.0;
    for seed in 0..20 {
        let recording = flown(&hover, seed);
        let told = MsckfOptions { rest: Some(rest), ..MsckfOptions::of_flight(&recording.flight) };
        let filter = fly(&recording, told, &start(&recording, seed), |_, _, _| ());
        let truth = recording.truth.biases[recording.pictures.len() - 1].gyro;
        let off = filter.bias().gyro - truth;
        let covariance = filter.covariance();
        squares += nees(&off, &covariance.fixed_view::<3, 3>(9, 9)).unwrap();
    }
    // The body rests better than the filter is told, so it is too modest.
    assert!(squares / 60.0 < 1.3, "{}", squares / 60.0);
}

#[test]
fn either_window_policy_follows_the_flight_within_its_size() {
    for policy in [WindowPolicy::Oldest, WindowPolicy::Thin] {
        let recording = flown(&flight(20.0), 6);
        let options = MsckfOptions { policy, ..MsckfOptions::of_flight(&recording.flight) };
        fly(&recording, options, &start(&recording, 6), |number, filter, _| {
            assert!(filter.belief().dimension() <= 15 + 6 * 11);
            let error = position_error(&recording, number, filter);
            assert!(error < 0.3, "{policy:?} {number} {error}");
        });
    }
}

#[test]
fn of_as_many_poses_thinned_ones_know_more_and_landmarks_enter_all_the_same() {
    let flights: Vec<FlightRecording> = (0..4).map(|seed| flown(&flight(30.0), seed)).collect();
    let error = |policy| {
        let mut squares = 0.0;
        for (seed, recording) in (0..).zip(&flights) {
            let options = MsckfOptions { policy, ..MsckfOptions::of_flight(&recording.flight) };
            fly(recording, options, &start(recording, seed), |number, filter, _| {
                squares += position_error(recording, number, filter).powi(2);
            });
        }
        squares
    };
    let [thin, oldest] = [WindowPolicy::Thin, WindowPolicy::Oldest].map(error);
    assert!(thin < oldest, "{thin} {oldest}");
    let thinned = MsckfOptions {
        policy: WindowPolicy::Thin,
        landmarks: 20,
        ..MsckfOptions::of_flight(&flights[0].flight)
    };
    let filter = fly(&flights[0], thinned, &start(&flights[0], 0), |_, _, _| ());
    assert!(filter.belief().dimension() > 15 + 6 * 11);
}

#[test]
fn tracks_that_stay_in_view_correct_again_and_again_where_poses_are_thinned() {
    let recording = hover(30.0);
    let options =
        MsckfOptions { policy: WindowPolicy::Thin, ..MsckfOptions::of_flight(&recording.flight) };
    fly(&recording, options, &start(&recording, 4), |number, filter, _| {
        let error = position_error(&recording, number, filter);
        assert!(error < 0.3, "{number} {error}");
    });
}

#[test]
fn both_forms_fly_alike() {
    let recording = flown(&flight(10.0), 7);
    let end = |form| {
        let options = MsckfOptions { form, ..MsckfOptions::of_flight(&recording.flight) };
        *fly(&recording, options, &start(&recording, 7), |_, _, _| ()).state()
    };
    let apart = (end(Form::Joseph).position - end(Form::Difference).position).norm();
    assert!(apart < 1e-5, "{apart}");
}

#[test]
fn what_comes_late_or_too_early_is_refused_and_nothing_is_lost() {
    let recording = flown(&flight(2.0), 8);
    let options = MsckfOptions::of_flight(&recording.flight);
    let mut filter = Msckf::new(options, &start(&recording, 8)).unwrap();
    let reading = |nanoseconds| StampedSample {
        nanoseconds,
        sample: ImuSample { gyro: Vector3::zeros(), accelerometer: -GRAVITY },
    };
    filter.reading(reading(0)).unwrap();
    assert_eq!(filter.reading(reading(0)), Err(MsckfError::Late { nanoseconds: 0, last: 0 }));
    let picture = Picture { nanoseconds: 100_000_000, features: Vec::new() };
    assert!(matches!(filter.picture(&picture), Err(MsckfError::Readings(_))));
    (1..=21).for_each(|k| filter.reading(reading(5_000_000 * k)).unwrap());
    filter.picture(&picture).unwrap();
    assert!(matches!(filter.picture(&picture), Err(MsckfError::Readings(_))));
    let earlier = Picture { nanoseconds: 50_000_000, features: Vec::new() };
    assert!(matches!(filter.picture(&earlier), Err(MsckfError::Readings(_))));
    let pixel = Vector2::new(f64::NAN, 0.0);
    let broken = vec![Feature { track: 3, pixel, right: None }];
    let state: NavState = *filter.state();
    (22..=101).for_each(|k| filter.reading(reading(5_000_000 * k)).unwrap());
    for k in 2..=5 {
        let features = broken.clone();
        filter.picture(&Picture { nanoseconds: 100_000_000 * k, features }).unwrap();
    }
    assert!(state.position.iter().chain(&filter.state().position).all(|x| x.is_finite()));
}

#[test]
fn nothing_is_made_up_over_a_gap_into_which_pictures_fall() {
    let flight = Flight { gap: Some([1.0, 1.6]), picture_rate: 20.0, ..flight(3.0) };
    let recording = flown(&flight, 9);
    let options = MsckfOptions::of_flight(&recording.flight);
    let mut filter = Msckf::new(options, &start(&recording, 9)).unwrap();
    let until = (0..).find_map(|number| Some((number, filter.follow(&recording, number).err()?)));
    let (number, error) = until.unwrap();
    assert!((20..=22).contains(&number), "{number}");
    assert!(matches!(error, MsckfError::Readings(WindowError::Gap { .. })), "{error}");
}

#[test]
fn numbers_that_are_none_and_windows_that_are_too_short_are_refused() {
    let recording = flown(&flight(2.0), 8);
    let options =
        MsckfOptions { landmarks: 24, gate: 1.0, ..MsckfOptions::of_flight(&recording.flight) };
    let start = start(&recording, 8);
    for clones in [0, 1, 2] {
        let short = Msckf::new(MsckfOptions { clones, ..options }, &start);
        assert!(matches!(short, Err(MsckfError::Window { .. })), "{clones}");
    }
    for pixel_sigma in [0.0, -1.0, f64::INFINITY] {
        let refused = Msckf::new(MsckfOptions { pixel_sigma, ..options }, &start).err();
        assert_eq!(refused, Some(MsckfError::PixelSigma { sigma: pixel_sigma }));
    }
    let mut filter = Msckf::new(options, &start).unwrap();
    let mut broken = recording.readings[0];
    broken.sample.gyro.x = f64::NAN;
    let refused = filter.reading(broken);
    assert_eq!(refused, Err(MsckfError::Reading { nanoseconds: broken.nanoseconds }));
    let mut recording = recording;
    recording.pictures[15].features.iter_mut().for_each(|feature| feature.pixel.x = f64::NAN);
    for at in 0..recording.pictures.len() {
        filter.follow(&recording, at).unwrap();
    }
    assert!(position_error(&recording, recording.pictures.len() - 1, &filter) < 0.3);
}

#[test]
fn pixels_of_kept_landmarks_count_as_used() {
    let recording = hover(6.0);
    let options = MsckfOptions { landmarks: 24, ..MsckfOptions::of_flight(&recording.flight) };
    let (mut used, mut gated) = (0, 0);
    fly(&recording, options, &start(&recording, 4), |number, _, report| {
        if number > 20 {
            used += report.used;
            gated += report.refused.gated;
        }
    });
    assert!(used > 20 * gated.max(1), "{used} {gated}");
}

#[test]
fn no_columns_are_a_system_without_unknowns() {
    let mut rows = Rows::default();
    rows.compress();
    let (jacobian, residual) = rows.system();
    assert_eq!((jacobian.shape(), residual.len()), ((0, 0), 0));
}

/// What rounding leaves in a column may be so small that its square is zero. The rows are turned all
/// the same, and nothing that they say of the other columns is lost.
#[test]
fn dust_in_a_column_loses_nothing() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    for dust in [0.0, 1e-170, 1e-158, 1e-320] {
        let mut rows = Rows::new(4);
        (0..9).for_each(|_| {
            let numbers: [f64; 4] = std::array::from_fn(|_| normal(&mut random));
            rows.add().copy_from_slice(&[dust * numbers[0], numbers[1], numbers[2], numbers[3]]);
        });
        let products = |rows: &Rows| {
            let (jacobian, residual) = rows.system();
            (jacobian.tr_mul(&jacobian), jacobian.tr_mul(&residual))
        };
        let before = products(&rows);
        rows.compress();
        let after = products(&rows);
        assert!(rows.len() <= 3, "{} rows", rows.len());
        assert!((before.0 - after.0).norm() < 1e-13 && (before.1 - after.1).norm() < 1e-13);
    }
}

#[test]
fn a_start_with_a_number_that_is_none_is_refused() {
    let recording = flown(&flight(2.0), 8);
    let options = MsckfOptions::of_flight(&recording.flight);
    let good = start(&recording, 8);
    let mut covariance = good.covariance;
    covariance[(0, 12)] = f64::NAN;
    let mut state = good.state;
    state.velocity.x = f64::NAN;
    for broken in [Start { covariance, ..good }, Start { state, ..good }] {
        assert_eq!(Msckf::new(options, &broken).err(), Some(MsckfError::Start));
    }
}
