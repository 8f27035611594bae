//! The graph as one would write it with factrs, of its own parts where it has them.
//!
//! What does not go together does not compile:
//!
//! ```compile_fail,E0277
//! use factrs::core::{Values, VectorVar3};
//! use factrs_graph::graph::X;
//!
//! Values::new().insert(X(0), VectorVar3::new(1.0, 0.0, 0.0));
//! ```
//!
//! while a velocity goes where velocities belong:
//!
//! ```
//! use factrs::core::{Values, VectorVar3};
//! use factrs_graph::graph::V;
//!
//! Values::new().insert(V(0), VectorVar3::new(1.0, 0.0, 0.0));
//! ```

use factrs::assign_symbols;
use factrs::core::{GaussNewton, GaussianNoise, Graph, Huber, PriorResidual, Values};
use factrs::fac;
use factrs::linalg::{Matrix3, Vector};
use factrs::optimizers::OptError;
use factrs::residuals::{Accel, Gravity, Gyro, ImuCovariance, ImuPreintegrator};
use factrs::traits::{Optimizer, Variable};
use factrs::variables::{ImuBias, SE3, VectorVar3};
use vislam::inertial::{ImuBias as OurBias, ImuNoise, ImuSample};

use crate::convert;
use crate::reprojection::Reprojection;
use crate::two_keyframes::{BIAS, Estimate, HUBER, STATE, STEP, Scene};

// ANCHOR: symbols
// A key knows the type of its variable: a velocity does not go where a pose belongs, nor compile.
assign_symbols!(X: SE3; V: VectorVar3; B: ImuBias; L: VectorVar3);
// ANCHOR_END: symbols

// ANCHOR: values
/// Where the search begins.
pub fn values(guess: &Estimate) -> Values {
    let mut values = Values::new();
    for (k, (state, bias)) in (0..).zip(guess.states.iter().zip(&guess.biases)) {
        values.insert(X(k), convert::pose(&state.pose()));
        values.insert(V(k), convert::point(&state.velocity));
        values.insert(B(k), convert::bias(bias));
    }
    for (j, landmark) in (0..).zip(&guess.landmarks) {
        values.insert(L(j), convert::point(landmark));
    }
    values
}
// ANCHOR_END: values

/// What says how noisy the gyroscope is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GyroNoise {
    /// The field of that name, which version 0.3.0 does not read.
    Named,
    /// The field for the uncertainty of the first bias, which enters in the same place.
    Moved,
}

// ANCHOR: covariance
/// The covariances of a reading and of the step of a bias, from densities.
pub fn covariance(noise: &ImuNoise, gyro: GyroNoise) -> ImuCovariance {
    let times = |variance: f64| Matrix3::identity() * variance;
    let of_gyro = times(noise.gyro.powi(2) / STEP);
    let (cov_gyro, cov_winit) = match gyro {
        GyroNoise::Named => (of_gyro, times(0.0)),
        GyroNoise::Moved => (times(0.0), of_gyro),
    };
    ImuCovariance {
        cov_accel: times(noise.accelerometer.powi(2) / STEP),
        cov_gyro,
        cov_winit,
        cov_gyro_bias: times(noise.gyro_walk.powi(2) * STEP),
        cov_accel_bias: times(noise.accelerometer_walk.powi(2) * STEP),
        cov_integration: times(0.0),
        cov_ainit: times(0.0),
    }
}
// ANCHOR_END: covariance

/// A reading, its parts apart as factrs has them.
pub fn reading(sample: &ImuSample) -> (Gyro, Accel) {
    (Gyro(convert::vector(&sample.gyro)), Accel(convert::vector(&sample.accelerometer)))
}

// ANCHOR: preintegrator
/// Readings, summed up by factrs.
pub fn preintegrator(
    readings: &[ImuSample],
    bias: &OurBias,
    covariance: ImuCovariance,
) -> ImuPreintegrator {
    let mut sums = ImuPreintegrator::new(covariance, convert::bias(bias), Gravity::down());
    for sample in readings {
        let (gyro, accel) = reading(sample);
        sums.integrate(&gyro, &accel, STEP);
    }
    sums
}
// ANCHOR_END: preintegrator

// ANCHOR: graph
/// The graph: readings, pixels and priors.
pub fn graph(scene: &Scene, gyro: GyroNoise) -> Graph {
    let mut graph = Graph::new();
    let covariance = covariance(&scene.noise, gyro);
    let sums = preintegrator(&scene.readings, &scene.known_bias, covariance);
    graph.add_factor(sums.build(X(0), V(0), B(0), X(1), V(1), B(1)));
    add_pixels(&mut graph, scene, HUBER);
    add_priors(&mut graph, scene);
    graph
}

pub fn add_pixels(graph: &mut Graph, scene: &Scene, threshold: f64) {
    let camera_from_body = convert::pose(&scene.body_from_camera.inverse());
    for (j, pixels) in (0..).zip(&scene.pixels) {
        for (k, pixel) in (0..).zip(pixels) {
            let (camera, camera_from_body) = (scene.camera, camera_from_body.clone());
            let residual = Reprojection { camera, camera_from_body, pixel: (*pixel).into() };
            let sigma = scene.pixel_sigma;
            graph.add_factor(fac![residual, (X(k), L(j)), sigma as std, Huber::new(threshold)]);
        }
    }
}
// ANCHOR_END: graph

// ANCHOR: priors
/// What is known of the first keyframe. In a pose the turn comes first, and our order is turn, velocity, position.
pub fn add_priors(graph: &mut Graph, scene: &Scene) {
    let [a, b, c, u, v, w, x, y, z] = STATE;
    let noise = |sigmas: [f64; 6]| GaussianNoise::from_vec_sigma(Vector::from(sigmas).as_view());
    let speed = GaussianNoise::from_vec_sigma(Vector::from([u, v, w]).as_view());
    let state = &scene.known_state;
    let (pose, velocity) = (convert::pose(&state.pose()), convert::point(&state.velocity));
    let bias = convert::bias(&scene.known_bias);
    graph.add_factor(fac![PriorResidual::new(pose), X(0), noise([a, b, c, x, y, z])]);
    graph.add_factor(fac![PriorResidual::new(velocity), V(0), speed]);
    graph.add_factor(fac![PriorResidual::new(bias), B(0), noise(BIAS)]);
}
// ANCHOR_END: priors

// ANCHOR: solve
/// The minimum, by steps of Gauss-Newton from the guess, until the cost falls by less than a millionth.
pub fn solve(graph: Graph, guess: &Estimate) -> Result<Estimate, OptError> {
    let found = GaussNewton::new_default(graph).optimize(values(guess))?;
    Ok(estimate(&found, guess.landmarks.len()))
}
// ANCHOR_END: solve

/// Steps after which nothing moves any more but by rounding.
const STEPS: usize = 40;

/// The minimum to the last digits. Rounding moves the cost by more than a small tolerance, so that what stops a search
/// is of no use here, and steps are counted.
pub fn solve_exactly(graph: Graph, guess: &Estimate) -> Result<Estimate, OptError> {
    let (mut search, mut found) = (GaussNewton::new_default(graph), values(guess));
    search.init(&found);
    for number in 0..STEPS {
        found = search.step(found, number)?.0;
    }
    Ok(estimate(&found, guess.landmarks.len()))
}

/// What values say, in our types.
pub fn estimate(values: &Values, landmarks: usize) -> Estimate {
    fn of<V: Variable<T = f64, Alias<f64> = V> + 'static>(
        values: &Values,
        key: impl factrs::containers::TypedSymbol<V>,
    ) -> &V {
        values.get(key).expect("a solution has the variables of the guess")
    }
    Estimate {
        states: [0, 1].map(|k| convert::our_state(of(values, X(k)), of(values, V(k)))),
        biases: [0, 1].map(|k| convert::our_bias(of(values, B(k)))),
        landmarks: (0..landmarks as u32)
            .map(|j| convert::our_vector(&of::<VectorVar3>(values, L(j)).0))
            .collect(),
    }
}
