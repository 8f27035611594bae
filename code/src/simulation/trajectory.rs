//! Trajectories that are known exactly at every time, and what a perfect sensor reads on them.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Rotation3, Vector3};

use crate::inertial::{ImuSample, NavState};

// ANCHOR: scalar_trajectory
/// One coordinate as a function of time, c + r t + a t²/2 + A sin(ω t + θ), with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ScalarTrajectory {
    /// Its value c, in its unit.
    pub value: f64,
    /// Its rate r, per second.
    pub rate: f64,
    /// Its acceleration a, per second squared.
    pub acceleration: f64,
    /// The amplitude A of its oscillation, in its unit.
    pub amplitude: f64,
    /// The angular frequency ω of its oscillation, in rad/s.
    pub frequency: f64,
    /// The phase θ of its oscillation, in radians.
    pub phase: f64,
}
// ANCHOR_END: scalar_trajectory

impl ScalarTrajectory {
    // ANCHOR: scalar_trajectory_at
    /// Value, first and second derivative after `t` seconds.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let Self { value, rate, acceleration, amplitude, frequency, phase } = *self;
        let (sin, cos) = (frequency * t + phase).sin_cos();
        [
            value + rate * t + 0.5 * acceleration * t * t + amplitude * sin,
            rate + acceleration * t + amplitude * frequency * cos,
            acceleration - amplitude * frequency * frequency * sin,
        ]
    }
    // ANCHOR_END: scalar_trajectory_at

    /// A coordinate that stays as it is.
    pub fn constant(value: f64) -> Self {
        Self { value, ..Self::default() }
    }

    /// A coordinate that begins at zero and changes at a rate.
    pub fn linear(rate: f64) -> Self {
        Self { rate, ..Self::default() }
    }

    /// An oscillation A sin(ω t + θ).
    pub fn wave(amplitude: f64, frequency: f64, phase: f64) -> Self {
        Self { amplitude, frequency, phase, ..Self::default() }
    }
}

/// Euler angles of the body in the world, in radians: the rotation is
/// `Rz(yaw) Ry(pitch) Rx(roll)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EulerAngles {
    /// About the vertical.
    pub yaw: ScalarTrajectory,
    /// About the axis to the left, after the yaw.
    pub pitch: ScalarTrajectory,
    /// About the axis ahead, after yaw and pitch.
    pub roll: ScalarTrajectory,
}

// ANCHOR: trajectory
/// A trajectory by formula: the three coordinates of the position in the world, in metres, and
/// the angles.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Trajectory {
    /// Coordinates in the world, in metres.
    pub position: [ScalarTrajectory; 3],
    /// How the body is turned.
    pub angles: EulerAngles,
    /// Spans of seconds in which the body stands wherever it is then, in order and two seconds apart or more.
    /// In the second before and the second after it changes its pace.
    pub stands: &'static [[f64; 2]],
}

/// The kinematics of a body at one time: its state, and the rates at which that changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematics {
    /// Where the body is, how it is turned and how fast it goes.
    pub state: NavState,
    /// Its angular velocity, in the body frame, in rad/s.
    pub angular_velocity: Vector3<f64>,
    /// Its acceleration, in the world, in m/s².
    pub acceleration: Vector3<f64>,
}
// ANCHOR_END: trajectory

/// How long a stand has held a body back after `t` seconds, with derivatives: it slows down in the second before
/// and speeds up in the second after, both by 3 u² - 2 u³.
fn stood(&[from, to]: &[f64; 2], t: f64) -> [f64; 3] {
    let since = |t: f64| {
        let u = t.clamp(0.0, 1.0);
        [
            u * u * u * (1.0 - 0.5 * u) + (t - u).max(0.0),
            u * u * (3.0 - 2.0 * u),
            6.0 * u * (1.0 - u),
        ]
    };
    let (slowed, sped) = (since(t - from + 1.0), since(t - to));
    std::array::from_fn(|at| slowed[at] - sped[at])
}

impl Kinematics {
    // ANCHOR: perfect_sample
    /// What a perfect sensor reads. Implements {eq:inertial-specific-force}.
    pub fn sample(&self, gravity: &Vector3<f64>) -> ImuSample {
        let body_from_world = self.state.world_from_body.inverse();
        let accelerometer = body_from_world * (self.acceleration - gravity);
        ImuSample { gyro: self.angular_velocity, accelerometer }
    }
    // ANCHOR_END: perfect_sample
}

impl Trajectory {
    // ANCHOR: kinematics
    /// State and rates after `t` seconds.
    pub fn at(&self, t: f64) -> Kinematics {
        let [x, y, z] = self.position.map(|coordinate| self.paced(&coordinate, t));
        let [yaw, yaw_rate, _] = self.paced(&self.angles.yaw, t);
        let [pitch, pitch_rate, _] = self.paced(&self.angles.pitch, t);
        let [roll, roll_rate, _] = self.paced(&self.angles.roll, t);
        let about_z = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
        let about_y = Rotation3::from_axis_angle(&Vector3::y_axis(), pitch);
        let about_x = Rotation3::from_axis_angle(&Vector3::x_axis(), roll);
        // Each rate turns about its axis as the later rotations leave it.
        let yawing = about_y.inverse() * Vector3::z() * yaw_rate;
        let pitching = about_x.inverse() * (Vector3::y() * pitch_rate + yawing);
        Kinematics {
            state: NavState {
                world_from_body: about_z * about_y * about_x,
                velocity: Vector3::new(x[1], y[1], z[1]),
                position: Vector3::new(x[0], y[0], z[0]),
            },
            angular_velocity: Vector3::x() * roll_rate + pitching,
            acceleration: Vector3::new(x[2], y[2], z[2]),
        }
    }
    // ANCHOR_END: kinematics

    /// A coordinate and its derivatives after `t` seconds, some of which the body has stood.
    fn paced(&self, coordinate: &ScalarTrajectory, t: f64) -> [f64; 3] {
        let [time, pace, change] = self.stands.iter().fold([t, 1.0, 0.0], |paced, stand| {
            let stood = stood(stand, t);
            std::array::from_fn(|at| paced[at] - stood[at])
        });
        let [value, first, second] = coordinate.at(time);
        [value, pace * first, pace * pace * second + change * first]
    }

    /// The same, with a stand in each of these spans of seconds.
    pub fn with_stands(self, stands: &'static [[f64; 2]]) -> Self {
        Self { stands, ..self }
    }

    /// What a perfect sensor reads at the times 0, dt, 2 dt, …, `count` of them.
    pub fn samples(&self, gravity: &Vector3<f64>, dt: f64, count: usize) -> Vec<ImuSample> {
        (0..count).map(|k| self.at(k as f64 * dt).sample(gravity)).collect()
    }

    /// Standing still in the air.
    pub fn hover() -> Self {
        Self::default()
    }

    /// Within 1.1 m of one spot, nodding and swinging by three degrees.
    pub fn about_one_spot() -> Self {
        let wave = ScalarTrajectory::wave;
        let angles = EulerAngles {
            yaw: wave(0.05, 0.7, 0.3),
            pitch: wave(0.05, 0.9, 1.0),
            roll: wave(0.05, 1.1, 0.0),
        };
        let position = [wave(0.56, 0.9, 0.0), wave(0.8, 0.6, 1.0), wave(0.56, 0.8, 2.0)];
        Self { position, angles, ..Self::default() }
    }

    /// Turning about the vertical without moving, at `rate` rad/s.
    pub fn turn_on_the_spot(rate: f64) -> Self {
        Self {
            angles: EulerAngles { yaw: ScalarTrajectory::linear(rate), ..EulerAngles::default() },
            ..Self::default()
        }
    }

    // ANCHOR: trajectories
    /// A level circle to the left from the origin, nose ahead, at `speed` m/s and `rate` rad/s.
    /// In the body frame the acceleration is constant. The rate is not zero: a straight line is
    /// [`Trajectory::constant_velocity`].
    pub fn level_turn(speed: f64, rate: f64) -> Self {
        let radius = speed / rate;
        let y =
            ScalarTrajectory { value: radius, ..ScalarTrajectory::wave(radius, rate, -FRAC_PI_2) };
        let position = [ScalarTrajectory::wave(radius, rate, 0.0), y, ScalarTrajectory::default()];
        Self { position, ..Self::turn_on_the_spot(rate) }
    }

    /// A figure-eight, six metres by three, that rises and falls, with the nose swinging and the
    /// body rolling and pitching: every axis turns and accelerates, and nothing stays constant.
    pub fn figure_eight() -> Self {
        let position = [
            ScalarTrajectory::wave(3.0, 0.8, 0.0),
            ScalarTrajectory::wave(1.5, 1.6, 0.0),
            ScalarTrajectory::wave(0.5, 1.1, 0.4),
        ];
        let yaw = ScalarTrajectory::wave(1.0, 0.9, 0.2);
        let pitch = ScalarTrajectory::wave(0.3, 1.3, 1.0);
        let roll = ScalarTrajectory::wave(0.4, 1.7, 0.0);
        Self { position, angles: EulerAngles { yaw, pitch, roll }, ..Self::default() }
    }
    // ANCHOR_END: trajectories

    /// Straight ahead at `velocity` m/s in the world, with the angles given.
    pub fn constant_velocity(velocity: &Vector3<f64>, angles: EulerAngles) -> Self {
        Self {
            position: [0, 1, 2].map(|axis| ScalarTrajectory::linear(velocity[axis])),
            angles,
            ..Self::default()
        }
    }

    /// From rest with a constant `acceleration` in the world, in m/s², with the angles given.
    pub fn constant_acceleration(acceleration: &Vector3<f64>, angles: EulerAngles) -> Self {
        let along = |axis: usize| ScalarTrajectory {
            acceleration: acceleration[axis],
            ..ScalarTrajectory::default()
        };
        Self { position: [0, 1, 2].map(along), angles, ..Self::default() }
    }

    // ANCHOR: body_acceleration
    /// From rest with an `acceleration` that is constant in the frame of a body that turns about
    /// the vertical, in m/s² and at `rate` rad/s. A rate of zero has no such formula: that is
    /// [`Trajectory::constant_acceleration`].
    pub fn constant_body_acceleration(acceleration: &Vector3<f64>, rate: f64) -> Self {
        let size = acceleration.xy().norm();
        let direction = acceleration.y.atan2(acceleration.x);
        // The acceleration is that of a wave; what it leaves at time zero is taken off.
        let level = |phase: f64| {
            let wave = ScalarTrajectory::wave(-size / (rate * rate), rate, phase);
            let [value, speed, _] = wave.at(0.0);
            ScalarTrajectory { value: -value, rate: -speed, ..wave }
        };
        let up = ScalarTrajectory { acceleration: acceleration.z, ..ScalarTrajectory::default() };
        let position = [level(direction + FRAC_PI_2), level(direction), up];
        Self { position, ..Self::turn_on_the_spot(rate) }
    }
    // ANCHOR_END: body_acceleration
}
