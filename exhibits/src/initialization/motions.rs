//! Motions whose shape and readings are exact, and what their linear equations say of the scale.

use nalgebra::{DVector, Matrix3, Vector3};
use vislam::inertial::{ImuBias, ImuNoise};
use vislam::initialization::{LinearAlignment, Sensors, VisualMotion, minima_on_sphere};
use vislam::simulation::{EulerAngles, Flight, ScalarTrajectory, Trajectory};

/// Pictures in a second.
pub const RATE: f64 = 10.0;

/// A flight without noise whose camera sits at the body's origin.
fn flight(motion: Trajectory, seconds: f64) -> Flight {
    let noise = ImuNoise { gyro: 0.0, accelerometer: 0.0, gyro_walk: 0.0, accelerometer_walk: 0.0 };
    let flight = Flight { seconds, picture_rate: RATE, imu_rate: 1000.0, ..Flight::new(motion) };
    Flight { noise, tracks: 0, ..flight }
}

/// The linear equations of the first seconds of a motion, in metres.
pub fn equations(motion: Trajectory, seconds: f64) -> LinearAlignment {
    let flight = flight(motion, seconds);
    let recording = flight.record(&[], 0).expect("it can be flown");
    // The covariance of sums needs noise, which the equations do not ask for.
    let sensors = Sensors { noise: ImuNoise::euroc(), ..Sensors::of_flight(&flight) };
    let states = &recording.truth.states;
    let motion = VisualMotion {
        pictures: (0..states.len()).collect(),
        nanoseconds: recording.pictures.iter().map(|picture| picture.nanoseconds).collect(),
        rotations: states.iter().map(|state| state.world_from_body).collect(),
        centres: states.iter().map(|state| state.position).collect(),
        landmarks: Default::default(),
    };
    LinearAlignment::new(&sensors, &recording.readings, &motion, &ImuBias::default())
        .expect("the readings cover the pictures")
}

/// Angles that swing, so that gravity and bias differ.
pub fn swinging() -> EulerAngles {
    let wave = ScalarTrajectory::wave;
    EulerAngles { yaw: wave(0.3, 0.9, 0.2), pitch: wave(0.3, 1.3, 1.0), roll: wave(0.3, 1.7, 0.0) }
}

/// Four motions: one with a single scale, one with two, one whose two are the same, one with any.
pub fn motions() -> [(&'static str, Trajectory); 4] {
    let accelerated = |acceleration| Trajectory::constant_acceleration(&acceleration, swinging());
    [
        ("figure-eight", Trajectory::figure_eight()),
        ("constant acceleration, rising", accelerated(Vector3::new(1.0, 0.0, 3.0))),
        ("constant acceleration, level", accelerated(Vector3::new(1.0, 2.0, 0.0))),
        (
            "constant velocity",
            Trajectory::constant_velocity(&Vector3::new(0.6, 0.3, 0.1), swinging()),
        ),
    ]
}

/// The least root mean square of the rows, in metres, when the scale is held at this many times the
/// true one and the bias is known to be zero.
pub fn misfit(equations: &LinearAlignment, scale: f64) -> f64 {
    let LinearAlignment { matrix, right, gravity } = equations;
    let right: DVector<f64> = right - scale * matrix.column(0);
    // Velocity is eliminated: rows of one axis have the same two columns.
    let (by_velocity, by_gravity) = (matrix.columns(1, 3), matrix.columns(7, 3));
    let square = by_velocity.tr_mul(&by_velocity)[(0, 0)];
    let coupling = by_velocity.tr_mul(&by_gravity);
    let pull: DVector<f64> = by_velocity.tr_mul(&right);
    let rest = by_gravity.tr_mul(&by_gravity) - coupling.tr_mul(&coupling) / square;
    let target = by_gravity.tr_mul(&right) - coupling.tr_mul(&pull) / square;
    let rest = Matrix3::from_fn(|row, column| rest[(row, column)]);
    let target = Vector3::new(target[0], target[1], target[2]);
    // All eigenvalues of the rest are the same, so the least is along the target.
    let found = minima_on_sphere(&rest, &target, *gravity);
    let down = found.map_or(target * (gravity / target.norm()), |(least, _)| least.at);
    let velocity = (pull - coupling * down) / square;
    let left = &right - by_velocity * velocity - by_gravity * down;
    left.norm() / (left.len() as f64).sqrt()
}
