//! Each factor against what it measures: derivatives by central differences, where it stands and
//! where somebody froze its linearization point.

use nalgebra::{
    DMatrix, Isometry3, Matrix6, Rotation3, SVector, Vector1, Vector2, Vector3, Vector6,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::factors::{
    AnchorChange, AnchoredPixel, BiasWalkFactor, CombinedInertialFactor, InertialFactor,
    PixelAtAnchor, PixelByAnchor, PixelByBody, PoseUpToScale, Prior, RelativePose, StereoByPose,
};
use vislam::inertial::{BodyPose, GRAVITY, Gravity, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::least_squares::{Factor, Kernel, Key, Manifold, Problem, Values};
use vislam::manifold::{se3, so3};
use vislam::preintegration::{
    CombinedPreintegrated, CombinedPreintegrator, Matrix9x6, Preintegrated, preintegrate,
};
use vislam::reprojection::{CameraModel, DistortedPinhole, Pinhole, RadialTangential, RigCamera};
use vislam::two_views::{StereoFactor, StereoPinhole};

const STATES: usize = 1000;
const PINHOLE: Pinhole = Pinhole { fx: 400.0, fy: 410.0, cx: 320.0, cy: 240.0 };

struct Draws(ChaCha8Rng);

impl Draws {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn number(&mut self, size: f64) -> f64 {
        self.0.random_range(-size..size)
    }

    fn vector<const N: usize>(&mut self, size: f64) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.number(size))
    }

    fn state(&mut self) -> NavState {
        NavState {
            world_from_body: so3::exp(&self.vector(2.0)),
            velocity: self.vector(3.0),
            position: self.vector(5.0),
        }
    }

    fn bias(&mut self) -> ImuBias {
        ImuBias { gyro: self.vector(0.02), accelerometer: self.vector(0.2) }
    }

    /// A pose of the camera in the body, near the identity.
    fn extrinsics(&mut self) -> Isometry3<f64> {
        se3::exp(&self.vector(0.2))
    }

    /// Small, as one of an estimator that has nearly converged.
    fn nearby<V: Manifold>(&mut self, value: &V) -> V {
        let step: Vec<f64> = (0..value.dimension()).map(|_| self.number(0.02)).collect();
        value.retract(&step)
    }
}

/// The Jacobian of a problem by central differences, each residual at its values.
fn differences(problem: &Problem, at: &Values) -> DMatrix<f64> {
    let columns = problem.columns();
    let residual = |column: usize, step: f64| {
        let mut by_column = vec![0.0; columns.count];
        by_column[column] = step;
        let mut coordinates = vec![0.0; at.dimension()];
        columns.spread(&by_column, &mut coordinates);
        problem.jacobian(&at.retract(&coordinates)).unwrap().1
    };
    let step = 1e-5;
    let slopes: Vec<_> = (0..columns.count)
        .map(|column| (residual(column, step) - residual(column, -step)) / (2.0 * step))
        .collect();
    DMatrix::from_columns(&slopes)
}

/// Compares a problem's Jacobian with differences at its values, and, with every linearization
/// point frozen at `frozen`, with differences there, while residuals stay those of the values.
fn compare(problem: &mut Problem, freeze: impl Fn(&mut Problem), frozen: &Values, tolerance: f64) {
    let values = problem.values().clone();
    let (here, residual) = problem.jacobian(&values).unwrap();
    let expected = differences(problem, &values);
    assert!((&here - &expected).amax() < tolerance * expected.amax(), "{here}{expected}");
    let elsewhere = differences(problem, frozen);
    freeze(problem);
    let (held, same) = problem.jacobian(&values).unwrap();
    assert_eq!(same, residual);
    assert!((&held - &elsewhere).amax() < tolerance * elsewhere.amax(), "{held}{elsewhere}");
}

/// Adds a variable, and freezes it where a second draw has it.
struct Frozen {
    values: Values,
}

impl Frozen {
    fn new() -> Self {
        Self { values: Values::new() }
    }

    fn add<V: Manifold>(&mut self, draws: &mut Draws, problem: &mut Problem, value: V) -> Key<V> {
        self.values.add(draws.nearby(&value));
        problem.add_variable(value)
    }

    fn freeze<V: Manifold>(&self, problem: &mut Problem, key: Key<V>) {
        problem.freeze(key, self.values[key].clone()).unwrap();
    }
}

fn pixels_of_a_body<M: vislam::reprojection::CameraModel>(camera: M, seed: u64) {
    let mut draws = Draws::new(seed);
    for _ in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let (state, extrinsics) = (draws.state(), draws.extrinsics());
        let offset = Vector1::new(draws.number(0.02));
        let ahead = Vector3::new(draws.number(1.0), draws.number(1.0), 5.0);
        let world_from_camera = state.pose() * extrinsics;
        let landmark = se3::transform(&world_from_camera, &ahead);
        let factor = PixelByBody {
            state: frozen.add(&mut draws, &mut problem, state),
            landmark: frozen.add(&mut draws, &mut problem, landmark),
            extrinsics: frozen.add(&mut draws, &mut problem, extrinsics),
            time_offset: frozen.add(&mut draws, &mut problem, offset),
            camera: camera.clone(),
            angular_velocity: draws.vector(0.5),
            pixel: Vector2::new(320.0, 240.0),
            inverse_sigma: 1.3,
        };
        let (state, landmark, extrinsics, time_offset) = factor.variables();
        problem.add_factor(factor, Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| {
            frozen.freeze(problem, state);
            frozen.freeze(problem, landmark);
            frozen.freeze(problem, extrinsics);
            frozen.freeze(problem, time_offset);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-7);
    }
}

#[test]
fn a_pixel_of_a_moving_body_has_the_slopes_of_its_residual() {
    pixels_of_a_body(PINHOLE, 1);
}

#[test]
fn a_pixel_behind_a_lens_has_them_too() {
    let lens = RadialTangential::new(-0.28, 0.07, 1e-4, 2e-5, 0.0).unwrap();
    pixels_of_a_body(DistortedPinhole { pinhole: PINHOLE, lens }, 2);
}

#[test]
fn a_late_clock_shows_the_landmark_from_where_the_body_has_gone() {
    let mut problem = Problem::new();
    let state = NavState { velocity: Vector3::new(2.0, 0.0, 0.0), ..NavState::origin() };
    let factor = PixelByBody {
        state: problem.add_variable(state),
        landmark: problem.add_variable(Vector3::new(0.0, 0.0, 4.0)),
        extrinsics: problem.add_variable(Isometry3::identity()),
        time_offset: problem.add_variable(Vector1::new(0.01)),
        camera: PINHOLE,
        angular_velocity: Vector3::zeros(),
        pixel: Vector2::new(320.0, 240.0),
        inverse_sigma: 1.0,
    };
    problem.add_factor(factor, Kernel::Squared).unwrap();
    let (_, residual) = problem.jacobian(problem.values()).unwrap();
    // Two centimetres to the right at four metres: two pixels to the left.
    assert!((residual - Vector2::new(-2.0, 0.0)).norm() < 1e-9);
}

/// The second camera of a rig, a step to the right and turned a little.
fn second_camera(draws: &mut Draws) -> RigCamera {
    let shift = Vector3::new(-0.11, 0.02, 0.01);
    let camera_from_first = Isometry3::new(shift, draws.vector(0.1));
    RigCamera { camera: PINHOLE, camera_from_first }
}

/// The factor of a landmark that lies before the anchor at this inverse depth, and the problem with it.
fn anchored(
    draws: &mut Draws,
    inverse_depth: f64,
    camera: RigCamera,
) -> (Problem, Frozen, PixelByAnchor) {
    let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
    let (anchor, extrinsics) = (draws.state(), draws.extrinsics());
    let turn = so3::exp(&draws.vector(0.2));
    let state = NavState {
        world_from_body: anchor.world_from_body * turn,
        velocity: draws.vector(3.0),
        position: anchor.position + draws.vector::<3>(0.5),
    };
    let landmark = Vector3::new(draws.number(0.2), draws.number(0.2), inverse_depth);
    let offset = Vector1::new(draws.number(0.02));
    let factor = PixelByAnchor {
        anchor: frozen.add(draws, &mut problem, anchor),
        state: frozen.add(draws, &mut problem, state),
        landmark: frozen.add(draws, &mut problem, landmark),
        extrinsics: frozen.add(draws, &mut problem, extrinsics),
        time_offset: frozen.add(draws, &mut problem, offset),
        camera,
        angular_velocities: [draws.vector(0.5), draws.vector(0.5)],
        pixel: Vector2::new(320.0, 240.0),
        inverse_sigma: 1.3,
    };
    problem.add_factor(factor, Kernel::Squared).unwrap();
    (problem, frozen, factor)
}

#[test]
fn a_pixel_of_an_anchored_landmark_has_the_slopes_of_its_residual_at_any_distance_and_beyond() {
    let mut draws = Draws::new(21);
    for number in 0..STATES {
        let inverse_depth = [0.2, 1e-3, 0.0, -0.01][number % 4];
        let second = second_camera(&mut draws);
        let camera = if number % 3 == 0 { second } else { RigCamera::first(PINHOLE) };
        let (mut problem, frozen, factor) = anchored(&mut draws, inverse_depth, camera);
        let freeze = |problem: &mut Problem| {
            frozen.freeze(problem, factor.anchor);
            frozen.freeze(problem, factor.state);
            frozen.freeze(problem, factor.landmark);
            frozen.freeze(problem, factor.extrinsics);
            frozen.freeze(problem, factor.time_offset);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-7);
    }
}

#[test]
fn an_anchored_landmark_is_seen_where_the_point_that_it_stands_for_is_seen() {
    let mut draws = Draws::new(22);
    for _ in 0..100 {
        let camera = second_camera(&mut draws);
        let (mut problem, _, factor) = anchored(&mut draws, 0.2, camera);
        let values = problem.values();
        let (offset, extrinsics) = (values[factor.time_offset], values[factor.extrinsics]);
        let (anchor, landmark) = (values[factor.anchor], values[factor.landmark]);
        let turned = so3::exp(&(offset.x * factor.angular_velocities[0]));
        let at_exposure = NavState {
            world_from_body: anchor.world_from_body * turned,
            position: anchor.position + offset.x * anchor.velocity,
            ..anchor
        };
        let point = landmark.xy().push(1.0) / landmark.z;
        let in_world = se3::transform(&(at_exposure.pose() * extrinsics), &point);
        let point = PixelByBody {
            state: factor.state,
            landmark: problem.add_variable(in_world),
            extrinsics: factor.extrinsics,
            time_offset: factor.time_offset,
            camera,
            angular_velocity: factor.angular_velocities[1],
            pixel: factor.pixel,
            inverse_sigma: factor.inverse_sigma,
        };
        problem.add_factor(point, Kernel::Squared).unwrap();
        let (_, residual) = problem.jacobian(problem.values()).unwrap();
        assert!((residual.rows(0, 2) - residual.rows(2, 2)).norm() < 1e-9, "{residual}");
    }
}

#[test]
fn a_pixel_in_the_anchor_itself_has_the_slopes_of_its_residual_and_asks_for_no_pose() {
    let mut draws = Draws::new(23);
    for number in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let inverse_depth = [0.2, 1e-3, 0.0, -0.01][number % 4];
        let value = Vector3::new(draws.number(0.2), draws.number(0.2), inverse_depth);
        let landmark = frozen.add(&mut draws, &mut problem, value);
        let camera = second_camera(&mut draws);
        let (pixel, inverse_sigma) = (Vector2::new(320.0, 240.0), 1.3);
        let factor = PixelAtAnchor { landmark, camera, pixel, inverse_sigma };
        problem.add_factor(factor, Kernel::Squared).unwrap();
        let (_, residual) = problem.jacobian(problem.values()).unwrap();
        let body = BodyPose::from(&draws.state());
        let general = AnchoredPixel { camera: &camera, pixel, inverse_sigma };
        let general = general.residual((&body, &body, &draws.extrinsics(), &value)).unwrap();
        assert!((residual - general).norm() < 1e-9);
        let freeze = |problem: &mut Problem| frozen.freeze(problem, landmark);
        compare(&mut problem, freeze, &frozen.values, 1e-7);
    }
}

/// The landmark of a pixel, carried over to where the pixel was seen: the factor, and the value to which
/// it draws.
fn carried_over(problem: &mut Problem, pixel: &PixelByAnchor) -> (AnchorChange, Vector3<f64>) {
    let begin = problem.values()[pixel.landmark];
    let change = AnchorChange {
        anchors: [pixel.anchor, pixel.state],
        landmarks: [pixel.landmark, problem.add_variable(begin)],
        extrinsics: pixel.extrinsics,
        time_offset: pixel.time_offset,
        angular_velocities: pixel.angular_velocities,
        inverse_sigma: 1.0,
    };
    let values = problem.values();
    let (anchor, state) = (&values[pixel.anchor], &values[pixel.state]);
    let (extrinsics, offset) = (&values[pixel.extrinsics], &values[pixel.time_offset]);
    let off = change.residual((anchor, state, &begin, &begin, extrinsics, offset)).unwrap();
    (change, begin + off)
}

#[test]
fn a_landmark_of_two_anchors_is_seen_at_the_same_pixel_from_either() {
    let mut draws = Draws::new(24);
    for number in 0..100 {
        let inverse_depth = [0.2, 1e-3, 0.0, -0.01][number % 4];
        let camera = second_camera(&mut draws);
        let (mut problem, _, pixel) = anchored(&mut draws, inverse_depth, camera);
        let (change, place) = carried_over(&mut problem, &pixel);
        let landmark = problem.add_variable(place);
        let PixelByAnchor { camera, pixel, inverse_sigma, .. } = pixel;
        let seen = PixelAtAnchor { landmark, camera, pixel, inverse_sigma };
        problem.add_factor(seen, Kernel::Squared).unwrap();
        let tied = AnchorChange { landmarks: [change.landmarks[0], landmark], ..change };
        problem.add_factor(tied, Kernel::Squared).unwrap();
        let (_, residual) = problem.jacobian(problem.values()).unwrap();
        assert!((residual.rows(0, 2) - residual.rows(2, 2)).norm() < 1e-9, "{residual}");
        assert!(residual.rows(4, 3).norm() < 1e-12, "{residual}");
    }
}

#[test]
fn a_change_of_the_anchor_has_the_slopes_of_its_residual() {
    let mut draws = Draws::new(25);
    for number in 0..STATES {
        let inverse_depth = [0.2, 1e-3, 0.0, -0.01][number % 4];
        let first = RigCamera::first(PINHOLE);
        let (mut problem, mut frozen, pixel) = anchored(&mut draws, inverse_depth, first);
        let (change, place) = carried_over(&mut problem, &pixel);
        let [known, landmark] = change.landmarks;
        frozen.values.add(draws.nearby(&place));
        problem.take_factors(Kernel::Squared, |_: &PixelByAnchor| true);
        problem.add_factor(change, Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| {
            change.anchors.iter().for_each(|anchor| frozen.freeze(problem, *anchor));
            frozen.freeze(problem, known);
            frozen.freeze(problem, landmark);
            frozen.freeze(problem, change.extrinsics);
            frozen.freeze(problem, change.time_offset);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-7);
    }
}

#[test]
fn a_landmark_behind_a_camera_has_no_pixel_whichever_way_it_is_written() {
    let camera = RigCamera::first(PINHOLE);
    assert!(camera.project_cam(&Vector3::new(0.0, 0.0, -1.0)).is_none());
    assert!(camera.project_scaled(&Vector3::new(0.0, 0.0, 0.01), 1.0).is_none());
    assert!(camera.project_scaled(&Vector3::new(0.0, 0.0, 0.01), 0.1).is_some());
    assert!(camera.project_scaled(&Vector3::new(0.0, 0.0, -1.0), 0.0).is_none());
}

#[test]
fn a_pose_up_to_scale_has_the_slopes_of_its_residual() {
    let mut draws = Draws::new(14);
    for _ in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let (state, body_from_camera) = (draws.state(), draws.extrinsics());
        let log_scale = Vector1::new(draws.number(1.0));
        // What the picture says, off by a little.
        let mut map_from_camera = state.pose() * body_from_camera;
        map_from_camera.translation.vector *= (-log_scale.x).exp();
        let factor = PoseUpToScale {
            state: frozen.add(&mut draws, &mut problem, state),
            log_scale: frozen.add(&mut draws, &mut problem, log_scale),
            map_from_camera: draws.nearby(&map_from_camera),
            body_from_camera,
            inverse_turn: 1.7,
            inverse_shift: 0.6,
        };
        let (state, log_scale) = factor.variables();
        problem.add_factor(factor, Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| {
            frozen.freeze(problem, state);
            frozen.freeze(problem, log_scale);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-7);
    }
}

#[test]
fn a_stereo_observation_has_the_slopes_of_its_residual() {
    let camera = StereoPinhole::new(PINHOLE, 0.12).unwrap();
    let mut draws = Draws::new(4);
    for _ in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let pose = se3::exp(&draws.vector(1.0));
        let ahead = Vector3::new(draws.number(1.0), draws.number(1.0), 5.0);
        let landmark = se3::transform(&pose.inverse(), &ahead);
        let seen = Vector3::new(320.0, 240.0, 310.0);
        let factor = StereoByPose {
            pose: frozen.add(&mut draws, &mut problem, pose),
            landmark: frozen.add(&mut draws, &mut problem, landmark),
            camera,
            observed: StereoFactor::new(0, 0, seen, 0.8).unwrap(),
        };
        let (pose, landmark) = factor.variables();
        problem.add_factor(factor, Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| {
            frozen.freeze(problem, pose);
            frozen.freeze(problem, landmark);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-7);
    }
}

/// Readings of half a second.
fn interval(draws: &mut Draws) -> Preintegrated {
    let samples: Vec<_> = (0..20)
        .map(|_| ImuSample { gyro: draws.vector(1.0), accelerometer: draws.vector(5.0) - GRAVITY })
        .collect();
    preintegrate(&samples, 0.025, &draws.bias(), &ImuNoise::mems()).unwrap()
}

#[test]
fn readings_have_the_slopes_of_their_residual() {
    let mut draws = Draws::new(5);
    for _ in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let preintegrated = interval(&mut draws);
        let (state, bias) = (draws.state(), draws.bias());
        let next = draws.nearby(&preintegrated.predict(&state, &GRAVITY, &bias));
        let first = frozen.add(&mut draws, &mut problem, state);
        let second = frozen.add(&mut draws, &mut problem, next);
        let bias = frozen.add(&mut draws, &mut problem, bias);
        let gravity = frozen.add(&mut draws, &mut problem, Gravity(GRAVITY));
        let factor = InertialFactor::new([first, second], bias, gravity, preintegrated).unwrap();
        problem.add_factor(factor, Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| {
            frozen.freeze(problem, first);
            frozen.freeze(problem, second);
            frozen.freeze(problem, bias);
            frozen.freeze(problem, gravity);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-6);
    }
}

#[test]
fn a_walk_of_the_bias_has_the_slopes_of_its_residual() {
    let mut draws = Draws::new(6);
    for _ in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let value = draws.bias();
        let first = frozen.add(&mut draws, &mut problem, value);
        let value = draws.bias();
        let second = frozen.add(&mut draws, &mut problem, value);
        let factor = BiasWalkFactor::new([first, second], &ImuNoise::euroc(), 0.5).unwrap();
        problem.add_factor(factor, Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| {
            frozen.freeze(problem, first);
            frozen.freeze(problem, second);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-7);
    }
}

/// Readings of half a second whose bias walks.
fn walking(draws: &mut Draws) -> CombinedPreintegrated {
    let mut sums = CombinedPreintegrator::new(&draws.bias(), &ImuNoise::mems()).unwrap();
    for _ in 0..20 {
        let (gyro, accelerometer) = (draws.vector(1.0), draws.vector(5.0) - GRAVITY);
        sums.integrate(&ImuSample { gyro, accelerometer }, 0.025).unwrap();
    }
    sums.finish().unwrap()
}

#[test]
fn readings_whose_bias_walks_have_the_slopes_of_their_residual() {
    let mut draws = Draws::new(13);
    for _ in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let preintegrated = walking(&mut draws);
        let (state, value) = (draws.state(), draws.bias());
        let next = draws.nearby(&preintegrated.sums.predict(&state, &GRAVITY, &value));
        let first = frozen.add(&mut draws, &mut problem, state);
        let second = frozen.add(&mut draws, &mut problem, next);
        let bias = frozen.add(&mut draws, &mut problem, value);
        let value = draws.bias();
        let later = frozen.add(&mut draws, &mut problem, value);
        let (states, biases) = ([first, second], [bias, later]);
        let gravity = frozen.add(&mut draws, &mut problem, Gravity(GRAVITY));
        let factor = CombinedInertialFactor::new(states, biases, gravity, &preintegrated).unwrap();
        problem.add_factor(factor, Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| {
            frozen.freeze(problem, first);
            frozen.freeze(problem, second);
            frozen.freeze(problem, bias);
            frozen.freeze(problem, later);
            frozen.freeze(problem, gravity);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-6);
    }
}

#[test]
fn without_covariance_between_them_deltas_and_walk_are_two_factors() {
    let mut draws = Draws::new(14);
    let (mut apart, mut together) = (Problem::new(), Problem::new());
    let (values, biases) = ([draws.state(), draws.state()], [draws.bias(), draws.bias()]);
    let combined = walking(&mut draws);
    let sums = combined.sums;
    let states = values.map(|state| apart.add_variable(state));
    let keys = biases.map(|bias| apart.add_variable(bias));
    let apart_gravity = apart.add_variable(Gravity(GRAVITY));
    let readings = InertialFactor::new(states, keys[0], apart_gravity, sums).unwrap();
    apart.add_factor(readings, Kernel::Squared).unwrap();
    let walk = BiasWalkFactor::new(keys, &ImuNoise::mems(), sums.duration).unwrap();
    apart.add_factor(walk, Kernel::Squared).unwrap();

    let states = values.map(|state| together.add_variable(state));
    let keys = biases.map(|bias| together.add_variable(bias));
    let with_bias = Matrix9x6::zeros();
    let dropped = CombinedPreintegrated { with_bias, ..combined };
    let gravity = together.add_variable(Gravity(GRAVITY));
    let factor = CombinedInertialFactor::new(states, keys, gravity, &dropped).unwrap();
    together.add_factor(factor, Kernel::Squared).unwrap();
    let [(one, first), (two, second)] =
        [&apart, &together].map(|problem| problem.jacobian(problem.values()).unwrap());
    assert!((&one - &two).amax() < 1e-12 * one.amax());
    assert!((&first - &second).amax() < 1e-12 * first.amax());
    let factor = CombinedInertialFactor::new(states, keys, gravity, &combined).unwrap();
    let fall = Gravity(GRAVITY);
    let found = factor.residual((&values[0], &biases[0], &values[1], &biases[1], &fall)).unwrap();
    assert!((found.norm() / first.norm() - 1.0).abs() > 1e-3, "the covariance between them counts");
}

#[test]
fn gravity_that_falls_upward_is_half_a_turn_away() {
    let (down, mut step) = (Gravity(GRAVITY), [0.0; 2]);
    down.local(&Gravity(-GRAVITY), &mut step);
    assert!((step[0].hypot(step[1]) - std::f64::consts::PI).abs() < 1e-12);
    assert!((down.retract(&step).0 + GRAVITY).norm() < 1e-12);
}

fn prior_of<V: Manifold, const N: usize>(draw: impl Fn(&mut Draws) -> V, seed: u64) {
    let mut draws = Draws::new(seed);
    for _ in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let anchor = draw(&mut draws);
        let step: Vec<f64> = (0..N).map(|_| draws.number(0.8)).collect();
        let variable = frozen.add(&mut draws, &mut problem, anchor.retract(&step));
        let sqrt_information = nalgebra::SMatrix::<f64, N, N>::from_fn(|_, _| draws.number(1.0));
        let prior = Prior { variable, anchor, sqrt_information };
        problem.add_factor(prior, Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| frozen.freeze(problem, variable);
        compare(&mut problem, freeze, &frozen.values, 1e-7);
    }
}

#[test]
fn a_prior_has_the_slopes_of_its_residual_whatever_it_is_about() {
    prior_of::<Vector3<f64>, 3>(|draws| draws.vector(2.0), 7);
    prior_of::<Rotation3<f64>, 3>(|draws| so3::exp(&draws.vector(2.0)), 8);
    prior_of::<Isometry3<f64>, 6>(|draws| se3::exp(&draws.vector(1.5)), 9);
    prior_of::<NavState, 9>(Draws::state, 10);
    prior_of::<ImuBias, 6>(Draws::bias, 11);
}

#[test]
fn a_state_and_a_bias_are_found_from_pixels_and_readings_together() {
    let mut draws = Draws::new(12);
    let preintegrated = interval(&mut draws);
    let truth = NavState::origin();
    let bias = preintegrated.bias;
    let next = preintegrated.predict(&truth, &GRAVITY, &bias);
    let mut problem = Problem::new();
    let first = problem.add_variable(truth);
    let second = problem.add_variable(draws.nearby(&next));
    let start = ImuBias { gyro: bias.gyro, accelerometer: bias.accelerometer + draws.vector(0.01) };
    let bias_key = problem.add_variable(start);
    let extrinsics = problem.add_variable(Isometry3::identity());
    let time_offset = problem.add_variable(Vector1::new(0.0));
    problem.hold(first).unwrap();
    problem.hold(extrinsics).unwrap();
    problem.hold(time_offset).unwrap();
    let gravity = problem.add_variable(Gravity(GRAVITY));
    problem.hold(gravity).unwrap();
    let readings = InertialFactor::new([first, second], bias_key, gravity, preintegrated).unwrap();
    problem.add_factor(readings, Kernel::Squared).unwrap();
    let sqrt_information = Matrix6::from_diagonal(&Vector6::new(1e3, 1e3, 1e3, 1e2, 1e2, 1e2));
    let known = Prior { variable: bias_key, anchor: bias, sqrt_information };
    problem.add_factor(known, Kernel::Squared).unwrap();
    for _ in 0..12 {
        let ahead = Vector3::new(draws.number(1.0), draws.number(1.0), 4.0 + draws.number(1.0));
        let landmark = problem.add_variable(ahead + draws.vector::<3>(0.05));
        for (key, state) in [(first, &truth), (second, &next)] {
            let camera_from_world = state.pose().inverse();
            let Some(pixel) = PINHOLE.project(&camera_from_world, &ahead) else { continue };
            let factor = PixelByBody {
                state: key,
                landmark,
                extrinsics,
                time_offset,
                camera: PINHOLE,
                angular_velocity: Vector3::zeros(),
                pixel,
                inverse_sigma: 1.0,
            };
            problem.add_factor(factor, Kernel::Squared).unwrap();
        }
    }
    let solution = problem.solve(&Default::default()).unwrap();
    assert!(solution.report.stop.is_convergence(), "{}", solution.report.stop);
    let mut error = [0.0; 9];
    solution.values[second].local(&next, &mut error);
    assert!(error.iter().all(|number| number.abs() < 1e-6), "{error:?}");
    assert!((solution.values[bias_key].vector() - bias.vector()).norm() < 1e-6);
    assert!(problem.covariance(&solution.values).is_ok());
}

#[test]
fn odometry_has_the_slopes_of_its_residual_and_does_not_notice_where_the_world_is() {
    let mut draws = Draws::new(19);
    for _ in 0..STATES {
        let (mut problem, mut frozen) = (Problem::new(), Frozen::new());
        let poses = [0, 1].map(|_| se3::exp(&draws.vector(1.5)));
        let [first, second] = poses.map(|pose| frozen.add(&mut draws, &mut problem, pose));
        let measured = draws.nearby(&(poses[1] * poses[0].inverse()));
        let sqrt_information = Matrix6::from_fn(|_, _| draws.number(1.0));
        let odometry = RelativePose { first, second, measured, sqrt_information };
        problem.add_factor(odometry.clone(), Kernel::Squared).unwrap();
        let freeze = |problem: &mut Problem| {
            frozen.freeze(problem, first);
            frozen.freeze(problem, second);
        };
        compare(&mut problem, freeze, &frozen.values, 1e-6);
        let world = se3::exp(&draws.vector(1.5));
        let [one, other] = poses.map(|pose| pose * world);
        let here = odometry.residual((&poses[0], &poses[1])).unwrap();
        let there = odometry.residual((&one, &other)).unwrap();
        assert!((here - there).norm() < 1e-12);
    }
}
