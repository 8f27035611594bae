//! Random readings, and what they lead to by ways that are not those of the library.

use nalgebra::{Rotation3, SMatrix, UnitQuaternion, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::preintegration::{Deltas, Preintegrated, Vector9, preintegrate};
use vislam::simulation::{EulerAngles, ScalarTrajectory, Trajectory};

use crate::comparison::Values;
use crate::preintegration::oracle::stack;
use crate::random::Random;

/// Readings of equal steps and the bias that is subtracted from them.
pub struct Readings {
    pub samples: Vec<ImuSample>,
    pub dt: f64,
    pub bias: ImuBias,
}

impl Readings {
    /// Those of a random motion, between a quarter and a whole second long.
    pub fn random(random: &mut Random) -> Self {
        let dt = random.logarithmic(0.005..0.02);
        let samples = motion(random).samples(&GRAVITY, dt, 50);
        Self { samples, dt, bias: bias(random, 0.1, 0.5) }
    }

    /// The library's sums.
    pub fn summed(&self) -> Preintegrated {
        summed(&self.samples, self.dt, &self.bias)
    }

    /// Where they lead from a state.
    pub fn walked(&self, first: &NavState, gravity: &Vector3<f64>) -> NavState {
        self.walked_with(&self.bias, first, gravity)
    }

    /// Where they lead from a state with another bias, in the world and with quaternions.
    fn walked_with(&self, bias: &ImuBias, first: &NavState, gravity: &Vector3<f64>) -> NavState {
        let NavState { world_from_body, mut velocity, mut position } = *first;
        let mut attitude = UnitQuaternion::from_rotation_matrix(&world_from_body);
        for sample in &self.samples {
            let acceleration = attitude * (sample.accelerometer - bias.accelerometer) + gravity;
            position += self.dt * velocity + 0.5 * self.dt * self.dt * acceleration;
            velocity += self.dt * acceleration;
            attitude *= UnitQuaternion::from_scaled_axis(self.dt * (sample.gyro - bias.gyro));
        }
        NavState { world_from_body: attitude.to_rotation_matrix(), velocity, position }
    }

    /// The deltas with another bias: a walk from the origin without gravity.
    pub fn deltas_with(&self, bias: &ImuBias) -> Deltas {
        let end = self.walked_with(bias, &NavState::origin(), &Vector3::zeros());
        let NavState { world_from_body, velocity, position } = end;
        Deltas { rotation: world_from_body, velocity, position }
    }
}

/// The library's sums with the noise of a poor sensor.
pub fn summed(samples: &[ImuSample], dt: f64, bias: &ImuBias) -> Preintegrated {
    preintegrate(samples, dt, bias, &ImuNoise::mems()).expect("the readings are finite")
}

/// The left sides of the deltas, for two states that are `t` seconds apart.
pub fn deltas_of_states(
    first: &NavState,
    second: &NavState,
    gravity: &Vector3<f64>,
    t: f64,
) -> Deltas {
    let turned = first.world_from_body.transpose();
    let coasted = first.position + first.velocity * t + gravity * (t * t / 2.0);
    Deltas {
        rotation: turned * second.world_from_body,
        velocity: turned * (second.velocity - first.velocity - gravity * t),
        position: turned * (second.position - coasted),
    }
}

/// The deltas of a motion's first second, from its formulas and not from readings.
pub fn true_deltas(motion: &Trajectory) -> Deltas {
    deltas_of_states(&motion.at(0.0).state, &motion.at(1.0).state, &GRAVITY, 1.0)
}

impl Values for Deltas {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        (self.rotation, self.velocity, self.position).append_to(numbers);
    }
}

/// The rotation vector, by way of a quaternion.
pub fn rotation_vector(rotation: &Rotation3<f64>) -> Vector3<f64> {
    UnitQuaternion::from_rotation_matrix(rotation).scaled_axis()
}

/// (φ, v, p) from one to the other.
pub fn difference(from: &Deltas, to: &Deltas) -> Vector9 {
    let phi = rotation_vector(&(from.rotation.transpose() * to.rotation));
    stack(&phi, &(to.velocity - from.velocity), &(to.position - from.position))
}

/// The derivative at zero of a function of `N` numbers, by central differences extrapolated to a
/// step of zero.
pub fn slopes<const N: usize>(
    step: f64,
    function: impl Fn(&SMatrix<f64, N, 1>) -> Vector9,
) -> SMatrix<f64, 9, N> {
    let central = |axis: usize, h: f64| {
        let at = SMatrix::from_fn(|k, _| if k == axis { h } else { 0.0 });
        (function(&at) - function(&-at)) / (2.0 * h)
    };
    let extrapolated = |axis| (4.0 * central(axis, step) - central(axis, 2.0 * step)) / 3.0;
    SMatrix::from_columns(&std::array::from_fn::<_, N, _>(extrapolated))
}

/// The derivative of the deltas by the bias, by walking again.
pub fn bias_slopes(readings: &Readings) -> SMatrix<f64, 9, 6> {
    let here = readings.deltas_with(&readings.bias);
    slopes::<6>(1e-3, |step| {
        let moved = ImuBias::from_vector(&(readings.bias.vector() + step));
        difference(&here, &readings.deltas_with(&moved))
    })
}

fn coordinate(random: &mut Random, size: f64) -> ScalarTrajectory {
    ScalarTrajectory {
        value: random.uniform(-size..size),
        rate: random.uniform(-size..size),
        acceleration: random.uniform(-size..size),
        amplitude: random.uniform(-size..size),
        frequency: random.uniform(-3.0..3.0),
        phase: random.uniform(-3.0..3.0),
    }
}

pub fn motion(random: &mut Random) -> Trajectory {
    let position = [2.0, 2.0, 2.0].map(|size| coordinate(random, size));
    let [yaw, pitch, roll] = [0.8, 0.4, 0.8].map(|size| coordinate(random, size));
    Trajectory { position, angles: EulerAngles { yaw, pitch, roll }, ..Trajectory::default() }
}

/// A bias of the gyroscope alone.
pub fn gyro_bias(gyro: Vector3<f64>) -> ImuBias {
    ImuBias { gyro, ..ImuBias::default() }
}

pub fn bias(random: &mut Random, gyro: f64, accelerometer: f64) -> ImuBias {
    ImuBias { gyro: random.direction(gyro), accelerometer: random.direction(accelerometer) }
}

pub fn state(random: &mut Random) -> NavState {
    NavState {
        world_from_body: random.rotation(3.0),
        velocity: random.direction(3.0),
        position: random.direction(10.0),
    }
}
